//! Presets derived: the cheapest values of their keys with which shipped scenes keep the errors that a preset promises.
//!
//! From a preset's values as they are, key by key until none changes: each candidate of the key is run with the others as they stand in
//! all scenes, and of those that keep every promise by two standard errors the cheapest is taken, if it is cheaper than the one that the key
//! has by more than a tenth. The reference has half of the shortest steps of all and a tenth of the least errors of the
//! force and of the number of neighbours, and the preset's own neighbours, which are a resolution: no run at one number of
//! particles tells how wrong they are.

mod trial;

use std::path::Path;

use super::Request;
use super::course::Course;
use super::settings::Setting;
use crate::preset::{PRESETS, Values};
use crate::run::{Outcome as End, RunError};
use crate::scene::{Opening, Preset, Scene};
use crate::signals;
use trial::{Trial, told, weigh};

/// Scenes in the folder of the shipped ones, in the form in which they are run: some orbits of the inner edge, or crossings of a kernel, few enough
/// for the noise of particles not to cover what a step does.
pub const SCENES: [(&str, &[&str]); 6] = [
    ("nbody/belt.toml", &["run.end_time=\"1 yr\""]),
    (
        "gas/disk.toml",
        &["run.end_time=\"0.2 yr\"", "gas.particles=4000"],
    ),
    ("coupled/embryo-in-disk.toml", &EMBRYO),
    ("coupled/embryo-in-disk.toml", &with_seed(EMBRYO)),
    ("coupled/minimum-mass-disk.toml", &NEBULA),
    ("coupled/minimum-mass-disk.toml", &with_seed(NEBULA)),
];

const EMBRYO: [&str; 4] = [
    "run.seed=1",
    "run.end_time=\"0.2 yr\"",
    "gas.particles=4000",
    "dust.particles=1000",
];

const NEBULA: [&str; 5] = [
    "run.seed=1",
    "run.end_time=\"0.2 yr\"",
    "gas.particles=4000",
    "dust.particles=1000",
    "planetesimals.number=500",
];

/// The same with another seed: what errors of the force do to bodies differs from one to the other.
const fn with_seed<const N: usize>(mut set: [&'static str; N]) -> [&'static str; N] {
    set[0] = "run.seed=2";
    set
}

/// What no preset reaches.
const REFERENCE: Values = Values {
    force_error: 1e-7,
    courant: 0.0375,
    tolerance: 1e-9,
    acceleration_step: 0.0375,
    orbit_step: 0.0125,
};

/// A key that presets set, and its candidates from the loosest.
struct Key {
    name: &'static str,
    candidates: [f64; 5],
    of: fn(&mut Values) -> &mut f64,
}

const KEYS: [Key; 5] = [
    Key {
        name: "accuracy.orbit_step",
        candidates: [0.4, 0.2, 0.1, 0.05, 0.025],
        of: |values| &mut values.orbit_step,
    },
    Key {
        name: "gas.hydro.courant",
        candidates: [0.6, 0.4, 0.25, 0.15, 0.075],
        of: |values| &mut values.courant,
    },
    Key {
        name: "gravity.force_error",
        candidates: [1e-1, 1e-2, 1e-3, 1e-4, 1e-6],
        of: |values| &mut values.force_error,
    },
    Key {
        name: "accuracy.acceleration_step",
        candidates: [0.6, 0.4, 0.25, 0.15, 0.075],
        of: |values| &mut values.acceleration_step,
    },
    Key {
        name: "gas.hydro.tolerance",
        candidates: [1e-2, 1e-3, 1e-4, 1e-6, 1e-8],
        of: |values| &mut values.tolerance,
    },
];

/// Rounds over all keys, after which a preset that still changes is given up.
const ROUNDS: usize = 4;

/// A preset as the program has it and as it was found, and how the latter fared.
struct Derived {
    name: &'static str,
    own: Values,
    values: Values,
    trial: Trial,
}

/// Derives all presets from the shipped scenes in `folder` and prints them beside those that the program has.
pub fn derive(request: &Request, folder: &Path) -> Result<End, RunError> {
    let mut found = Vec::new();
    for (name, preset) in PRESETS {
        let bases = bases(request, folder, name)?;
        match settled(request, &bases, (name, preset))? {
            Some(derived) => found.push(derived),
            None => return Ok(signals::caught().map_or(End::Done, End::Interrupted)),
        }
    }
    print!("{}", table(&found));
    Ok(End::Done)
}

/// The values at which a preset settles; none after a signal.
fn settled(
    request: &Request,
    bases: &[Course],
    (name, preset): (&'static str, Preset),
) -> Result<Option<Derived>, RunError> {
    let own = preset.values();
    let mut values = own;
    for _ in 0..ROUNDS {
        let (before, mut last) = (values, None);
        for key in &KEYS {
            let trials = trials(request, bases, preset, (key, values))?;
            if signals::caught().is_some() {
                return Ok(None);
            }
            let value = (key.of)(&mut values);
            let trial = told(name, key, &trials, *value)?;
            *value = trial.value;
            last = Some(trial);
        }
        if let Some(trial) = last.filter(|_| values == before) {
            return Ok(Some(Derived {
                name,
                own,
                values,
                trial,
            }));
        }
    }
    let sentence = format!("preset {name} does not settle in {ROUNDS} rounds");
    Err(RunError::Failed(sentence))
}

/// The scenes with a preset, in the form in which they are run.
fn bases(request: &Request, folder: &Path, preset: &str) -> Result<Vec<Course>, RunError> {
    let of = |(file, set): &(&str, &[&str])| {
        let words = |word: &&str| (*word).to_owned();
        let kept = request.output.clone();
        let kept = kept.unwrap_or_else(|| Path::new("trade").join("presets"));
        Course::of(&Request {
            scene: folder.join(file),
            knobs: vec![format!("accuracy.preset={preset}")],
            set: set.iter().map(words).collect(),
            output: Some(kept.join(Path::new(file).with_extension(""))),
            full: true,
            ..request.clone()
        })
    };
    SCENES.iter().map(of).collect()
}

/// All candidates of a key, the others as in `values`.
fn trials(
    request: &Request,
    bases: &[Course],
    preset: Preset,
    (key, values): (&Key, Values),
) -> Result<Vec<Trial>, RunError> {
    let trial = |&value: &f64| Trial {
        value,
        work: [0.0; SCENES.len()],
        worst: 0.0,
        place: String::new(),
    };
    let mut trials: Vec<Trial> = key.candidates.iter().map(trial).collect();
    for (place, base) in bases.iter().enumerate() {
        let with = |value: &f64| {
            let mut values = values;
            *(key.of)(&mut values) = *value;
            laid(&base.settings[0], values)
        };
        let settings = key.candidates.iter().map(with).collect();
        let course = base.with(laid(&base.settings[0], REFERENCE), settings);
        let ended = course.run(&course.folder.join("settings"), request);
        if signals::caught().is_some() {
            return Ok(trials);
        }
        let (table, trouble) = course.table(&ended);
        if let Some(sentence) = trouble {
            let file = SCENES[place].0;
            return Err(RunError::Failed(format!("{file}: {sentence}")));
        }
        weigh(&mut trials, &table, preset, place);
    }
    Ok(trials)
}

/// A scene with the values of a preset.
fn laid(setting: &Setting, values: Values) -> Setting {
    let mut setting = setting.clone();
    if let Ok(scene) = &mut setting.scene {
        lay(scene, values);
    }
    setting
}

fn lay(scene: &mut Scene, values: Values) {
    scene.accuracy.orbit_step = values.orbit_step;
    scene.accuracy.acceleration_step = values.acceleration_step;
    scene.gravity.opening = Opening::ForceError(values.force_error);
    if let Some(gas) = &mut scene.gas {
        gas.hydro.courant = values.courant;
        gas.hydro.tolerance = values.tolerance;
    }
}

/// The presets as they were found, with the program's own value where that is another.
fn table(found: &[Derived]) -> String {
    let line = |name: &str, cell: &dyn Fn(&Derived) -> String| {
        let cells: Vec<String> = found.iter().map(cell).collect();
        format!("| {name} | {} |\n", cells.join(" | "))
    };
    let mut text = line("key", &|preset| preset.name.to_owned());
    text += &line("---", &|_| "---".to_owned());
    for key in &KEYS {
        text += &line(key.name, &|preset| {
            let [own, derived] =
                [preset.own, preset.values].map(|mut values| *(key.of)(&mut values));
            match own == derived {
                true => format!("{derived:?}"),
                false => format!("{derived:?} (has {own:?})"),
            }
        });
    }
    text += &line("work", &|preset| {
        format!("{:.2}", preset.trial.cost(&found[0].trial))
    });
    text += &line("largest error by its promise", &|preset| {
        format!("{:.2} ({})", preset.trial.worst, preset.trial.place)
    });
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_of_a_preset_is_a_candidate() {
        for (name, preset) in PRESETS {
            for key in &KEYS {
                let own = *(key.of)(&mut preset.values());
                assert!(key.candidates.contains(&own), "{name}: {}", key.name);
                assert!(*(key.of)(&mut REFERENCE.clone()) < key.candidates[4]);
            }
        }
    }
}
