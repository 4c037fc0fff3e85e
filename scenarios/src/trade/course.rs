//! The course of a trade: its settings and their reference in a shortened form, their runs, and what these gave.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use super::Request;
use super::errors::{self, State};
use super::knobs::{self, Knob};
use super::results::{self, Outcome, Row, Table};
use super::runs::{self, Ended};
use super::settings::{self, Setting, Source};
use super::shorten::{self, Short};
use crate::document::{self, Entries};
use crate::progress::Count;
use crate::run::RunError;
use crate::scene::Scene;

/// Everything that a trade runs.
pub struct Course {
    pub title: String,
    pub sentence: String,
    /// Where all of it is kept.
    pub folder: PathBuf,
    pub keys: Vec<String>,
    pub own: Entries,
    pub reference: Setting,
    /// Knobs that the reference leaves as they are.
    pub aside: Vec<String>,
    pub settings: Vec<Setting>,
    pub planets: usize,
}

impl Course {
    pub fn of(request: &Request) -> Result<Self, RunError> {
        // Faults of the scene itself are said with file and line.
        let scene = Scene::load(&request.scene, &request.set)
            .map_err(|refusal| RunError::Refused(refusal.to_string()))?;
        let text = std::fs::read_to_string(&request.scene)
            .map_err(|error| RunError::Refused(format!("{}: {error}", request.scene.display())))?;
        let mut source = Source {
            text,
            name: scene.name.clone(),
            folder: request.scene.parent().unwrap_or(Path::new(".")),
            overrides: request.set.clone(),
        };
        let own = document::parse(&scene.to_toml()).unwrap_or_default();
        let (knobs, points) = points(request, &source, &scene, &own).map_err(RunError::Refused)?;
        let given = request.reference.as_deref().filter(|text| *text != "auto");
        let given = given
            .map_or(Ok(Vec::new()), knobs::pairs)
            .map_err(RunError::Refused)?;
        let first = settings(&source, &points);
        settings::refuse_dead(&knobs, &first).map_err(RunError::Refused)?;
        let reference =
            settings::reference(&source, &knobs, &given, &scene).map_err(RunError::Refused)?;
        source.overrides.extend(shorten::quiet());
        let default = || Path::new("trade").join(&scene.name);
        let folder = request.output.clone().unwrap_or_else(default);
        let short = if request.full {
            Short::default()
        } else {
            let make = |source: &Source| {
                let mut all = vec![source.setting(reference.keys.clone())];
                all.extend(settings(source, &points));
                all
            };
            let sized = ["gas.particles", "dust.particles", "planetesimals.number"];
            let may_thin = knobs.iter().all(|knob| !sized.contains(&knob.key.as_str()));
            let of = format!(
                "{source:?} {points:?} {:?} {}",
                reference.keys, request.budget
            );
            shorten::remembered(&folder, &of, || {
                shorten::shorten(&source, make, request.budget, may_thin)
            })?
        };
        source.overrides.extend(short.overrides);
        let left = |key: &String| reference.keys.iter().all(|(known, _)| known != key);
        let keys: Vec<String> = knobs.into_iter().map(|knob| knob.key).collect();
        Ok(Self {
            aside: keys.iter().filter(|key| left(key)).cloned().collect(),
            title: scene.title.clone(),
            sentence: short.sentence,
            folder,
            keys,
            own,
            reference: source.setting(reference.keys),
            settings: settings(&source, &points),
            planets: scene.planets.len(),
        })
    }

    /// The same for one setting, with another seed.
    pub fn with_seed(&self, setting: &Setting, seed: u64) -> Self {
        let seeded = |setting: &Setting| {
            let mut setting = setting.clone();
            if let Ok(scene) = &mut setting.scene {
                scene.run.seed = seed;
            }
            setting
        };
        self.with(seeded(&self.reference), vec![seeded(setting)])
    }

    /// The same for other settings.
    pub fn with(&self, reference: Setting, settings: Vec<Setting>) -> Self {
        Self {
            title: self.title.clone(),
            sentence: self.sentence.clone(),
            folder: self.folder.clone(),
            keys: self.keys.clone(),
            own: self.own.clone(),
            reference,
            aside: self.aside.clone(),
            settings,
            planets: self.planets,
        }
    }

    /// Runs the reference and all settings; the reference comes first.
    pub fn run(&self, folder: &Path, request: &Request) -> Vec<Ended> {
        let all: Vec<&Setting> = std::iter::once(&self.reference)
            .chain(&self.settings)
            .collect();
        // Settings that make the same scene share a run.
        let mut scenes = Vec::new();
        let mut places = BTreeMap::new();
        let shares: Vec<usize> = all
            .iter()
            .map(|setting| {
                let key = setting
                    .scene
                    .as_ref()
                    .map(|scene| scene.to_toml())
                    .map_err(Clone::clone);
                *places.entry(key).or_insert_with(|| {
                    scenes.push(setting.scene.clone().map(|scene| *scene));
                    scenes.len() - 1
                })
            })
            .collect();
        let count = Count::new(scenes.len(), request.quiet);
        let done = AtomicUsize::new(0);
        let tell = |i: usize, ended: &Ended, before: bool| {
            let number = done.fetch_add(1, Ordering::Relaxed) + 1;
            let what = shares.iter().position(|&share| share == i);
            let words = what.map_or_else(String::new, |k| all[k].words());
            let words = if what == Some(0) {
                format!("the reference: {words}")
            } else {
                words
            };
            count.tell(
                number,
                &match (ended, before) {
                    (Ended::Well(_), true) => format!("{words}: done before"),
                    (Ended::Well(_), false) => words,
                    (Ended::Failed(sentence), _) => format!("{words}: failed: {sentence}"),
                    (Ended::Interrupted, _) => format!("{words}: interrupted"),
                },
            );
        };
        let ended = runs::all(&scenes, folder, request.threads, &tell);
        shares
            .into_iter()
            .map(|share| ended[share].clone())
            .collect()
    }

    /// The table of what has ended, and what is wrong with the reference.
    pub fn table(&self, ended: &[Ended]) -> (Table, Option<String>) {
        let g = self
            .reference
            .scene
            .as_ref()
            .map_or(1.0, |scene| scene.gravity.constant);
        let state = |folder: &Path| State::read(folder, g, self.planets);
        let reference = match &ended[0] {
            Ended::Well(folder) => state(folder),
            Ended::Failed(sentence) => Err(sentence.clone()),
            Ended::Interrupted => Err("it was interrupted".to_owned()),
        };
        let outcome = |folder: &Path| -> Result<Outcome, String> {
            let mut outcome = results::cost(folder)?;
            outcome.errors = errors::of_ledger(folder)?;
            if let Ok(reference) = &reference {
                outcome.errors.extend(state(folder)?.errors(reference));
            }
            Ok(outcome)
        };
        let mut rows = Vec::new();
        for (setting, ended) in self.settings.iter().zip(&ended[1..]) {
            let outcome = match ended {
                Ended::Well(folder) => outcome(folder),
                Ended::Failed(sentence) => Err(sentence.clone()),
                Ended::Interrupted => continue,
            };
            let value = |key: &String| {
                let set = setting.keys.iter().find(|(known, _)| known == key);
                set.map_or_else(|| knobs::own(&self.own, key), |(_, value)| value.clone())
            };
            rows.push(Row {
                values: self.keys.iter().map(value).collect(),
                setting: setting.clone(),
                outcome,
            });
        }
        let table = Table {
            keys: self.keys.clone(),
            rows,
        };
        let failed = table.rows.iter().all(|row| row.outcome.is_err());
        let trouble = match reference {
            Err(sentence) => Some(format!(
                "the reference failed, so that only ledgers are compared: {sentence}"
            )),
            Ok(_) if failed => Some("no setting has come to its end".to_owned()),
            Ok(_) => None,
        };
        (table, trouble)
    }
}

type Points = Vec<Vec<(String, String)>>;

/// The knobs, and the settings on their grid.
fn points(
    request: &Request,
    source: &Source,
    scene: &Scene,
    own: &Entries,
) -> Result<(Vec<Knob>, Points), String> {
    if !request.knobs.is_empty() {
        let knobs: Result<Vec<Knob>, String> =
            request.knobs.iter().map(|text| Knob::parse(text)).collect();
        let knobs = knobs?;
        let points = settings::product(&knobs);
        return Ok((knobs, points));
    }
    let mut knobs = knobs::defaults(scene, &source.entries());
    for knob in &mut knobs {
        // What the scene cannot have is not offered.
        let key = knob.key.clone();
        knob.values
            .retain(|value| source.scene(&[(key.clone(), value.clone())]).is_ok());
    }
    knobs.retain(|knob| !knob.values.is_empty());
    if knobs.is_empty() {
        return Err(
            "the scene has no knob by itself; name one by --knob key=value,value".to_owned(),
        );
    }
    let points = settings::star(&knobs, own);
    Ok((knobs, points))
}

fn settings(source: &Source, points: &Points) -> Vec<Setting> {
    points
        .iter()
        .map(|keys| source.setting(keys.clone()))
        .collect()
}
