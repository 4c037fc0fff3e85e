//! Verification: built-in problems of physics that take longer than a test should, against their exact or published answers.

mod stirring;

/// A figure of a problem beside what it should be.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    pub what: String,
    pub measured: f64,
    /// Standard error of what was measured; zero if it has none.
    pub uncertainty: f64,
    pub reference: f64,
    /// Largest relative difference that is good, and that is acceptable.
    pub bars: [f64; 2],
}

impl Row {
    /// Difference from the reference, relative to it.
    pub fn difference(&self) -> f64 {
        self.measured / self.reference - 1.0
    }

    fn verdict(&self) -> &'static str {
        let difference = self.difference().abs();
        if difference <= self.bars[0] {
            "good"
        } else if difference <= self.bars[1] {
            "acceptable"
        } else {
            "FAILED"
        }
    }
}

/// A named problem.
pub struct Problem {
    pub name: &'static str,
    pub about: &'static str,
    rows: fn() -> Vec<Row>,
}

pub const PROBLEMS: [Problem; 2] = [
    Problem {
        name: "stirring",
        about: "viscous stirring of 800 equal planetesimals over 150 orbits (Ohtsuki, Stewart & Ida 2002), 3 runs; about 2 minutes",
        rows: stirring::equal_masses,
    },
    Problem {
        name: "stirring-two-masses",
        about: "stirring and dynamical friction between two populations over 100 orbits, 3 runs; about 4 minutes",
        rows: stirring::two_masses,
    },
];

/// Runs the problems named, all if none is; prints a table of each as it is done. Answers whether all were at least acceptable.
pub fn verify(names: &[String]) -> Result<bool, String> {
    let known = PROBLEMS.map(|problem| problem.name);
    if let Some(stranger) = names.iter().find(|name| !known.contains(&name.as_str())) {
        return Err(format!(
            "there is no problem \"{stranger}\"; known are {}",
            known.join(", ")
        ));
    }
    let mut sound = true;
    for problem in &PROBLEMS {
        if !names.is_empty() && !names.iter().any(|name| name == problem.name) {
            continue;
        }
        println!("{}: {}", problem.name, problem.about);
        println!("| | measured | reference | difference | bars | |");
        println!("| --- | --- | --- | --- | --- | --- |");
        for row in (problem.rows)() {
            let verdict = row.verdict();
            sound &= verdict != "FAILED";
            println!(
                "| {} | {:.4e} +- {:.1e} | {:.4e} | {:+.1} % | {:.0} %, {:.0} % | {verdict} |",
                row.what,
                row.measured,
                row.uncertainty,
                row.reference,
                100.0 * row.difference(),
                100.0 * row.bars[0],
                100.0 * row.bars[1],
            );
        }
    }
    Ok(sound)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_judged_by_its_bars_and_a_number_that_is_none_fails() {
        let row = |measured| Row {
            what: String::new(),
            measured,
            uncertainty: 0.0,
            reference: 2.0,
            bars: [0.1, 0.3],
        };
        let verdicts = [2.1, 1.5, 2.7, f64::NAN].map(|measured| row(measured).verdict());
        assert_eq!(verdicts, ["good", "acceptable", "FAILED", "FAILED"]);
    }

    #[test]
    fn an_unknown_problem_is_refused_with_the_known_ones() {
        let refusal = verify(&["stiring".to_string()]).expect_err("no such problem");
        assert!(refusal.contains("\"stiring\"") && refusal.contains("stirring-two-masses"));
    }
}
