//! The history of operators (`operators.csv`): what each has changed since the start, by population, at each report.
//!
//! All operators together, with the start, make the sums of `ledger.csv`. Potential energy belongs to no operator. Code units.

use std::io;
use std::path::Path;

use coupling::ledger::{Census, Entry, Totals};

use super::{Table, cell};

/// Columns of `operators.csv`.
pub const HEAD: [&str; 12] = [
    "time",
    "operator",
    "population",
    "mass",
    "momentum_x",
    "momentum_y",
    "momentum_z",
    "angular_momentum_x",
    "angular_momentum_y",
    "angular_momentum_z",
    "kinetic_energy",
    "internal_energy",
];

/// The operator under whose name the sums at the start stand.
pub const START: &str = "start";

fn numbers(t: &Totals) -> [f64; 9] {
    let (p, l) = (t.momentum, t.angular_momentum);
    [t.mass, p.x, p.y, p.z, l.x, l.y, l.z, t.kinetic, t.internal]
}

/// Adds a line an operator and population that it has changed, and before them the sums at the start.
pub fn push(time: f64, start: &Census, entries: &[Entry], table: &mut Table) -> io::Result<()> {
    let start = Entry {
        operator: START.to_owned(),
        change: *start,
    };
    for entry in std::iter::once(&start).chain(entries) {
        for (population, totals) in Census::NAMES.iter().zip(&entry.change.0) {
            let numbers = numbers(totals);
            if numbers == [0.0; 9] {
                continue;
            }
            let words = [cell(time), entry.operator.clone(), population.to_string()];
            let cells: Vec<String> = words.into_iter().chain(numbers.map(cell)).collect();
            table.push(&cells)?;
        }
    }
    Ok(())
}

/// A line of the last report: operator, population, and the nine sums.
pub type Line = (String, String, [f64; 9]);

/// The lines of the last report in `operators.csv`, with its time.
pub fn last(path: &Path) -> Result<(f64, Vec<Line>), String> {
    let wrong = |what: &str| format!("{}: {what}", path.display());
    let text = std::fs::read_to_string(path).map_err(|error| wrong(&error.to_string()))?;
    let mut lines = text.lines();
    if lines.next() != Some(HEAD.join(",").as_str()) {
        return Err(wrong("has other columns than this version writes"));
    }
    let (mut time, mut found) = (f64::NAN, Vec::new());
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |k: usize| cells.get(k).and_then(|cell| cell.parse::<f64>().ok());
        let sums: Option<Vec<f64>> = (3..HEAD.len()).map(number).collect();
        let sums = sums.and_then(|sums| <[f64; 9]>::try_from(sums).ok());
        let (Some(at), Some(sums)) = (number(0), sums) else {
            return Err(wrong(&format!("has a line that is none: {line}")));
        };
        if at != time {
            time = at;
            found.clear();
        }
        found.push((cells[1].to_owned(), cells[2].to_owned(), sums));
    }
    if found.is_empty() {
        return Err(wrong("has no report yet"));
    }
    Ok((time, found))
}
