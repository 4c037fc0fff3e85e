//! Results: what each setting costs and how wrong it is, which settings are worth their price, as a table for people and one for programs.

use std::fmt::Write;
use std::path::Path;

use super::errors::{Errors, METRICS};
use super::jackknife::Measured;
use super::settings::Setting;

/// By how many standard errors a setting is to keep within a limit: other seeds have other errors.
const SIGMAS: f64 = 2.0;

/// Errors below this are rounding: none is better than another.
pub const ROUNDING: f64 = 1e-12;

/// What a setting's run gave.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// CPU time of the steps, without the start and the files, s.
    pub cpu_s: f64,
    pub steps: u64,
    /// Particles evaluated and interactions summed over all phases.
    pub targets: u64,
    pub interactions: u64,
    pub errors: Errors,
}

impl Outcome {
    /// A cost that is the same on all machines, in updates of a gas particle, which take what some thousand interactions of the tree do.
    pub fn work(&self) -> f64 {
        self.targets as f64 + 1e-3 * self.interactions as f64
    }
}

/// A line of the table.
pub struct Row {
    pub setting: Setting,
    /// A cell a knob.
    pub values: Vec<String>,
    pub outcome: Result<Outcome, String>,
}

/// What a run's timings say.
pub fn cost(folder: &Path) -> Result<Outcome, String> {
    let path = folder.join("timings.json");
    let wrong = |what: String| format!("{}: {what}", path.display());
    let text = std::fs::read_to_string(&path).map_err(|error| wrong(error.to_string()))?;
    let all: serde_json::Value =
        serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
    let phases = all["phases"]
        .as_object()
        .ok_or_else(|| wrong("has no phases".to_owned()))?;
    let working = || {
        phases
            .iter()
            .filter(|(name, _)| *name != "output")
            .map(|(_, phase)| phase)
    };
    let sum = |key: &str| working().filter_map(|phase| phase[key].as_u64()).sum();
    Ok(Outcome {
        cpu_s: working().filter_map(|phase| phase["cpu_s"].as_f64()).sum(),
        steps: all["steps"].as_u64().unwrap_or(0),
        targets: sum("targets"),
        interactions: sum("interactions"),
        errors: Errors::new(),
    })
}

/// All lines, with the keys of the knobs.
pub struct Table {
    pub keys: Vec<String>,
    pub rows: Vec<Row>,
}

impl Table {
    /// Metrics that any setting has.
    pub fn metrics(&self) -> Vec<&'static str> {
        let has = |metric: &&str| {
            let outcomes = self.rows.iter().filter_map(|row| row.outcome.as_ref().ok());
            outcomes
                .into_iter()
                .any(|outcome| outcome.errors.contains_key(*metric))
        };
        METRICS
            .iter()
            .filter(|metric| has(metric))
            .copied()
            .collect()
    }

    /// Cost and error of each setting that has both.
    pub fn points(&self, metric: &str) -> Vec<(usize, f64, f64)> {
        let point = |(i, row): (usize, &Row)| {
            let outcome = row.outcome.as_ref().ok()?;
            let error = outcome.errors.get(metric)?.error;
            error.is_finite().then_some((i, outcome.cpu_s, error))
        };
        self.rows.iter().enumerate().filter_map(point).collect()
    }

    /// Settings than which none is both cheaper and as good, by cost.
    pub fn frontier(&self, metric: &str) -> Vec<usize> {
        let mut points = self.points(metric);
        points
            .iter_mut()
            .for_each(|point| point.2 = point.2.max(ROUNDING));
        points.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.2.total_cmp(&b.2)));
        let mut best = f64::INFINITY;
        let better = points.into_iter().filter(|&(_, _, error)| {
            let better = error < best;
            best = best.min(error);
            better
        });
        better.map(|(i, ..)| i).collect()
    }

    /// The cheapest setting whose errors all stay within their limits, by two standard errors and with other seeds.
    pub fn cheapest(&self, limits: &[(&str, f64)]) -> Option<usize> {
        let within = |i: usize| {
            let keeps = |(metric, limit): &(&str, f64)| {
                let most = self.most(i, metric);
                let elsewhere = || self.measured(i, metric).map(|m| m.spread * m.error);
                most.is_some_and(|error| error <= *limit)
                    && elsewhere().is_some_and(|error| error <= *limit)
            };
            self.rows[i].outcome.is_ok() && limits.iter().all(keeps)
        };
        self.by_cost().into_iter().find(|&i| within(i))
    }

    /// An error of a setting with the standard errors that recommendations count; none if its run has none.
    pub fn most(&self, i: usize, metric: &str) -> Option<f64> {
        let measured = self.measured(i, metric)?;
        Some(match measured.uncertainty {
            // Of a single sample, or none to speak of.
            sigma if sigma.is_nan() => measured.error,
            sigma => measured.error + SIGMAS * sigma,
        })
    }

    fn measured(&self, i: usize, metric: &str) -> Option<&Measured> {
        self.rows[i].outcome.as_ref().ok()?.errors.get(metric)
    }

    /// Metrics that may be larger with other seeds by more than their uncertainties, and by how many times at most.
    pub fn spreads(&self) -> Vec<(&'static str, f64)> {
        let most = |metric: &&'static str| {
            let all = (0..self.rows.len()).filter_map(|i| self.measured(i, metric));
            (*metric, all.map(|m| m.spread).fold(1.0, f64::max))
        };
        let all = self.metrics();
        all.iter().map(most).filter(|(_, s)| *s > 1.0).collect()
    }

    /// For programs.
    pub fn csv(&self) -> String {
        let metrics = self.metrics();
        let mut head: Vec<String> = self.keys.clone();
        head.push("cpu_s".to_owned());
        head.extend(metrics.iter().map(|metric| format!("error_{metric}")));
        head.extend(metrics.iter().map(|metric| format!("uncertainty_{metric}")));
        head.extend(["steps", "targets", "interactions", "frontier", "failure"].map(str::to_owned));
        let fronts: Vec<Vec<usize>> = metrics.iter().map(|m| self.frontier(m)).collect();
        let mut text = line(&head);
        for (i, row) in self.rows.iter().enumerate() {
            let mut cells = row.values.clone();
            match &row.outcome {
                Ok(outcome) => {
                    let of = |metric: &&str| outcome.errors.get(*metric);
                    cells.push(format!("{:?}", outcome.cpu_s));
                    cells.extend(metrics.iter().map(|m| number(of(m).map(|x| x.error))));
                    cells.extend(metrics.iter().map(|m| number(of(m).map(|x| x.uncertainty))));
                    let counts = [outcome.steps, outcome.targets, outcome.interactions];
                    cells.extend(counts.map(|count| count.to_string()));
                    let worth = metrics
                        .iter()
                        .zip(&fronts)
                        .filter(|(_, front)| front.contains(&i));
                    let worth: Vec<&str> = worth.map(|(metric, _)| *metric).collect();
                    cells.extend([worth.join(" "), String::new()]);
                }
                Err(sentence) => {
                    cells.extend(vec![String::new(); 2 * metrics.len() + 5]);
                    cells.push(sentence.clone());
                }
            }
            text += &line(&cells);
        }
        text
    }

    /// For people: a star marks what is on the frontier of its column.
    pub fn text(&self) -> String {
        let (shown, kept): (Vec<_>, Vec<_>) = self
            .metrics()
            .into_iter()
            .partition(|metric| self.is_lost(metric));
        // Where each setting sets one key, a column a key would be all but empty.
        let one = |row: &Row| row.setting.keys.len() <= 1;
        let alone = self.keys.len() > 1 && self.rows.iter().all(one);
        let mut head = match alone {
            true => vec!["setting".to_owned()],
            false => self.keys.clone(),
        };
        head.push("CPU s".to_owned());
        head.extend(shown.iter().map(|metric| metric.replace('_', " ")));
        let mut cells = vec![head];
        let fronts: Vec<Vec<usize>> = shown.iter().map(|m| self.frontier(m)).collect();
        let mut failures = String::new();
        for i in self.by_cost() {
            let row = &self.rows[i];
            let words = row.setting.words();
            let mut line = match alone {
                true => vec![words],
                false => row.values.clone(),
            };
            match &row.outcome {
                Ok(outcome) => {
                    line.push(format!("{:.3}", outcome.cpu_s));
                    let columns = shown.iter().zip(&fronts);
                    line.extend(columns.map(|(m, front)| cell(outcome, m, front.contains(&i))));
                    cells.push(line);
                }
                Err(sentence) => {
                    let words = row.setting.words();
                    writeln!(failures, "failed: {words}: {sentence}").expect("a string grows");
                }
            }
        }
        let mut text = aligned(&cells) + &failures;
        if !kept.is_empty() {
            let names = kept.join(", ").replace('_', " ");
            text += &format!("kept to rounding by all: {names}\n");
        }
        text
    }

    /// Whether any setting errs by more than rounding.
    fn is_lost(&self, metric: &str) -> bool {
        self.points(metric).iter().any(|point| point.2 > ROUNDING)
    }

    fn by_cost(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.rows.len()).collect();
        order.sort_by(|&a, &b| self.cost(a).total_cmp(&self.cost(b)));
        order
    }

    /// CPU time of a setting; infinite if it failed.
    fn cost(&self, i: usize) -> f64 {
        let outcome = self.rows[i].outcome.as_ref();
        outcome.map_or(f64::INFINITY, |outcome| outcome.cpu_s)
    }

    /// Settings that are cheaper than the scene as it is and in no metric worse than it by more than the uncertainties of both, with the
    /// parts of the cost that they save; those of more than what times of one machine scatter.
    pub fn bargains(&self) -> Vec<(usize, f64)> {
        const SCATTER: f64 = 0.1;
        let own = self.rows.iter().position(|row| row.setting.keys.is_empty());
        let Some((own, Ok(base))) = own.map(|own| (own, &self.rows[own].outcome)) else {
            return Vec::new();
        };
        let as_good = |i: usize| {
            let Ok(outcome) = &self.rows[i].outcome else {
                return false;
            };
            base.errors.iter().all(|(metric, theirs)| {
                let Some(mine) = outcome.errors.get(metric) else {
                    return false;
                };
                let both = [mine.uncertainty, theirs.uncertainty];
                let slack = both
                    .iter()
                    .filter(|x| x.is_finite())
                    .map(|x| x * x)
                    .sum::<f64>();
                mine.error <= ROUNDING.max(1.05 * theirs.error + slack.sqrt())
            })
        };
        let saved = |i: usize| 1.0 - self.cost(i) / self.cost(own);
        let cheaper = self.by_cost().into_iter().filter(|&i| saved(i) > SCATTER);
        cheaper
            .filter(|&i| as_good(i))
            .map(|i| (i, saved(i)))
            .collect()
    }
}

/// Error with uncertainty and mark.
fn cell(outcome: &Outcome, metric: &str, worth: bool) -> String {
    let mark = if worth { "*" } else { " " };
    match outcome.errors.get(metric) {
        None => "-".to_owned(),
        Some(measured) if measured.uncertainty.is_finite() => {
            format!(
                "{:.2e} ± {:.0e}{mark}",
                measured.error, measured.uncertainty
            )
        }
        Some(measured) => format!("{:.2e}{mark}", measured.error),
    }
}

fn aligned(cells: &[Vec<String>]) -> String {
    let columns = cells.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        let lengths = cells
            .iter()
            .filter_map(|line| Some(line.get(column)?.chars().count()));
        lengths.max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for line in cells {
        let padded = line
            .iter()
            .zip(&widths)
            .map(|(cell, width)| format!("{cell:>width$}"));
        text += padded.collect::<Vec<_>>().join("  ").trim_end();
        text.push('\n');
    }
    text
}

fn number(x: Option<f64>) -> String {
    x.filter(|x| x.is_finite())
        .map_or_else(String::new, |x| format!("{x:?}"))
}

fn line(cells: &[String]) -> String {
    let quoted = |cell: &String| match cell.contains([',', '"', '\n']) {
        true => format!("\"{}\"", cell.replace('"', "\"\"").replace('\n', " ")),
        false => cell.clone(),
    };
    cells.iter().map(quoted).collect::<Vec<_>>().join(",") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(cpu_s: f64, energy: f64) -> Row {
        let measured = Measured {
            error: energy,
            uncertainty: f64::NAN,
            spread: 1.0,
        };
        Row {
            setting: Setting {
                keys: Vec::new(),
                scene: Err("none".to_owned()),
            },
            values: vec!["a,b".to_owned()],
            outcome: Ok(Outcome {
                cpu_s,
                errors: [("energy", measured)].into(),
                ..Outcome::default()
            }),
        }
    }

    #[test]
    fn the_frontier_holds_what_nothing_cheaper_matches() {
        let mut failed = row(0.0, 0.0);
        failed.outcome = Err("NaN, at once".to_owned());
        let rows = vec![
            row(3.0, 1e-3),
            row(1.0, 1e-2),
            row(2.0, 2e-2),
            failed,
            row(4.0, 1e-3),
            row(0.5, f64::NAN),
        ];
        let table = Table {
            keys: vec!["key".to_owned()],
            rows,
        };
        assert_eq!(table.frontier("energy"), [1, 0]);
        assert_eq!(table.cheapest(&[("energy", 1.5e-2)]), Some(1));
        assert_eq!(table.cheapest(&[("energy", 1e-4)]), None);
        assert_eq!(table.cheapest(&[("position", 1.0)]), None);
        let csv = table.csv();
        let widths: Vec<usize> = csv
            .lines()
            .map(|line| {
                line.replace("\"a,b\"", "ab")
                    .replace("\"NaN, at once\"", "x")
                    .split(',')
                    .count()
            })
            .collect();
        assert!(widths.iter().all(|&width| width == widths[0]), "{csv}");
        assert!(
            table
                .text()
                .contains("failed: the scene as it is: NaN, at once")
        );
    }
}
