//! Trials of a key of a preset: what its candidates cost and how far they keep the promise, and which it is to have.

use super::{Key, SCENES};
use crate::preset::promised;
use crate::run::RunError;
use crate::scene::Preset;
use crate::trade::errors::METRICS;
use crate::trade::results::Table;

/// The gain in cost for which a value is changed.
const WORTH: f64 = 1.1;

/// How values fared in all scenes.
#[derive(Clone, Debug)]
pub struct Trial {
    pub value: f64,
    /// Work in each scene.
    pub work: [f64; SCENES.len()],
    /// The largest error, two standard errors included, by what is promised; infinite if a run failed.
    pub worst: f64,
    /// Where that is.
    pub place: String,
}

impl Trial {
    /// Work by that of another, mean over the scenes.
    pub fn cost(&self, other: &Self) -> f64 {
        let each = self.work.iter().zip(&other.work);
        each.map(|(a, b)| a / b).sum::<f64>() / self.work.len() as f64
    }
}

/// Adds what one scene has to say.
pub fn weigh(trials: &mut [Trial], table: &Table, preset: Preset, place: usize) {
    let file = SCENES[place].0;
    for (i, trial) in trials.iter_mut().enumerate() {
        for metric in METRICS {
            let Some(bar) = promised(metric, preset) else {
                continue;
            };
            let ratio = table.most(i, metric).map(|error| error / bar);
            if ratio.is_some_and(|ratio| ratio > trial.worst) {
                trial.worst = ratio.unwrap_or(f64::INFINITY);
                trial.place = format!("{metric} of {file}");
            }
        }
        match &table.rows[i].outcome {
            Ok(outcome) => trial.work[place] = outcome.work(),
            Err(sentence) => {
                (trial.worst, trial.place) = (f64::INFINITY, format!("{file}: {sentence}"));
            }
        }
    }
}

/// The candidate that a key is to have in place of `own`.
fn choice(trials: &[Trial], own: f64) -> Option<&Trial> {
    let kept = || trials.iter().filter(|trial| trial.worst <= 1.0);
    let first = trials.first()?;
    let cost = |trial: &Trial| trial.cost(first);
    let best = kept().min_by(|a, b| cost(a).total_cmp(&cost(b)))?;
    let as_cheap = |trial: &&Trial| trial.value == own && cost(trial) <= WORTH * cost(best);
    Some(kept().find(as_cheap).unwrap_or(best))
}

/// Prints the trials of a key and says which it is to have in place of `own`.
pub fn told(preset: &str, key: &Key, trials: &[Trial], own: f64) -> Result<Trial, RunError> {
    let chosen = choice(trials, own);
    for trial in trials {
        let mark = match chosen {
            Some(chosen) if chosen.value == trial.value => " *",
            _ => "",
        };
        let cost = trial.cost(&trials[0]);
        println!(
            "{preset}: {} = {:e}: cost {cost:.2}, {:.2} of its promise ({}){mark}",
            key.name, trial.value, trial.worst, trial.place
        );
    }
    chosen.cloned().ok_or_else(|| {
        let name = key.name;
        let sentence = format!("preset {preset}: no value of {name} keeps the promise");
        RunError::Failed(sentence)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trial(value: f64, cost: f64, worst: f64) -> Trial {
        Trial {
            value,
            work: [cost; SCENES.len()],
            worst,
            place: String::new(),
        }
    }

    #[test]
    fn the_cheapest_that_keeps_its_promise_is_chosen() {
        let rising = [
            trial(0.4, 1.0, 3.0),
            trial(0.2, 2.0, 0.9),
            trial(0.1, 4.0, 0.2),
        ];
        for own in [0.4, 0.2, 0.1] {
            assert_eq!(choice(&rising, own).map(|trial| trial.value), Some(0.2));
        }
        let free = [trial(0.4, 1.0, 0.9), trial(0.2, 1.02, 0.5)];
        assert_eq!(choice(&free, 0.2).map(|trial| trial.value), Some(0.2));
        for worst in [1.1, f64::NAN] {
            assert!(choice(&[trial(0.1, 1.0, worst)], 0.1).is_none());
        }
    }
}
