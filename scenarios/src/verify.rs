//! Verification: built-in problems of physics that take longer than a test should, against their exact or published answers.

mod field_steps;
pub mod gas;
mod orbits;
mod secular;
mod shearing_glass;
mod steps;
mod stirring;
mod wide_disk;

/// A figure of a problem beside what it should be.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    pub what: String,
    pub measured: f64,
    /// Standard error of what was measured; zero if it has none.
    pub uncertainty: f64,
    pub bar: Bar,
}

/// What a figure is judged by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bar {
    /// Largest differences from a value, relative to it, that are good and acceptable.
    Reference {
        value: f64,
        good: f64,
        acceptable: f64,
    },
    /// A value that it should be within two (good) or three (acceptable) of its own standard errors from.
    Statistics(f64),
    /// Largest sizes that are good and acceptable.
    Limit([f64; 2]),
    /// Told for information.
    None,
}

impl Row {
    /// What is judged, and what it may be for good and acceptable.
    fn margins(&self) -> Option<(f64, [f64; 2])> {
        match self.bar {
            Bar::Reference {
                value,
                good,
                acceptable,
            } => Some((self.measured / value - 1.0, [good, acceptable])),
            Bar::Statistics(value) => {
                Some(((self.measured - value) / self.uncertainty, [2.0, 3.0]))
            }
            Bar::Limit(limits) => Some((self.measured, limits)),
            Bar::None => None,
        }
    }

    fn verdict(&self) -> &'static str {
        match self.margins() {
            None => "told",
            Some((size, [good, _])) if size.abs() <= good => "good",
            Some((size, [_, acceptable])) if size.abs() <= acceptable => "acceptable",
            Some(_) => "FAILED",
        }
    }

    /// The figure, what it should be, how far it is from it, and the bars.
    fn cells(&self) -> [String; 4] {
        let measured = if self.uncertainty > 0.0 {
            format!("{:.4e} +- {:.1e}", self.measured, self.uncertainty)
        } else {
            format!("{:.4e}", self.measured)
        };
        let none = String::new;
        match (self.bar, self.margins()) {
            (Bar::Reference { value, .. }, Some((difference, bars))) => [
                measured,
                format!("{value:.4e}"),
                format!("{:+.2} %", 100.0 * difference),
                format!("{} %, {} %", 100.0 * bars[0], 100.0 * bars[1]),
            ],
            (Bar::Statistics(value), Some((errors, bars))) => [
                measured,
                format!("{value:.4e}"),
                format!(
                    "{:+.0} %, {errors:+.1} standard errors",
                    100.0 * (self.measured / value - 1.0)
                ),
                format!("{}, {} standard errors", bars[0], bars[1]),
            ],
            (_, Some((_, [good, acceptable]))) => [
                measured,
                none(),
                none(),
                format!("{good:e}, {acceptable:e}"),
            ],
            (_, None) => [measured, none(), none(), none()],
        }
    }
}

/// A named problem.
pub struct Problem {
    pub name: &'static str,
    pub about: &'static str,
    rows: fn() -> Vec<Row>,
}

pub const PROBLEMS: [Problem; 12] = [
    Problem {
        name: "sod",
        about: "shock tube of 57 600 particles in both precisions; about 1 minute",
        rows: gas::sod,
    },
    Problem {
        name: "gresho",
        about: "vortex of 24 576 particles in both precisions; about 2 minutes",
        rows: gas::gresho,
    },
    Problem {
        name: "evrard",
        about: "cold collapse of 14 328 particles in both precisions; about 2 minutes",
        rows: gas::evrard::rows,
    },
    Problem {
        name: "shearing-glass",
        about: "noise that shear makes of a lattice and of a glass of 400 particles over 10 orbits, by scheme; some minutes",
        rows: shearing_glass::rows,
    },
    Problem {
        name: "wide-disk",
        about: "a gas disk of 1e5 particles without self-gravity through three orbits of its inner edge; about 1 minute",
        rows: wide_disk::rows,
    },
    Problem {
        name: "individual-steps",
        about: "what individual time steps save in a gas disk from 0.1 to 10 au, at equal error, six disks of 20 000 particles; about 5 minutes of two cores",
        rows: steps::rows,
    },
    Problem {
        name: "field-steps",
        about: "steps of the tree's field apart from those of the forces, in a collapse and a disk; about 3 minutes",
        rows: field_steps::rows,
    },
    Problem {
        name: "orbits",
        about: "energy of the outer Solar System by the corrected Jacobi map over 1e6 yr; e = 0.999999 through 1000 pericentres; about 1 minute",
        rows: orbits::rows,
    },
    Problem {
        name: "random-walk",
        about: "energy of Jupiter and Saturn by Gauss-Radau over 1e6 orbits, 2 systems; about 8 minutes of each of two cores",
        rows: orbits::walk,
    },
    Problem {
        name: "secular-frequencies",
        about: "frequencies of the apsides and nodes of the outer Solar System from 5 Myr; about 20 seconds",
        rows: secular::rows,
    },
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
            let [measured, reference, difference, bars] = row.cells();
            println!(
                "| {} | {measured} | {reference} | {difference} | {bars} | {verdict} |",
                row.what
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
        let row = |measured, bar| Row {
            what: String::new(),
            measured,
            uncertainty: 0.1,
            bar,
        };
        let expected = ["good", "acceptable", "FAILED", "FAILED"];
        let reference = Bar::Reference {
            value: 2.0,
            good: 0.1,
            acceptable: 0.3,
        };
        for (bar, figures) in [
            (reference, [2.1, 1.5, 2.7, f64::NAN]),
            (Bar::Statistics(2.0), [2.15, 1.75, 2.31, f64::NAN]),
            (
                Bar::Limit([1e-3, 2e-3]),
                [-0.9e-3, 1.1e-3, -2.1e-3, f64::NAN],
            ),
        ] {
            assert_eq!(figures.map(|figure| row(figure, bar).verdict()), expected);
        }
        assert_eq!(row(1.0, Bar::None).verdict(), "told");
    }

    #[test]
    fn an_unknown_problem_is_refused_with_the_known_ones() {
        let refusal = verify(&["stiring".to_string()]).expect_err("no such problem");
        assert!(refusal.contains("\"stiring\"") && refusal.contains("stirring-two-masses"));
    }
}
