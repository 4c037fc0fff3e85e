//! Settings: the points of the grid of knobs, the reference they are compared with, and the scenes that they make.

use std::path::Path;

use super::knobs::{self, Knob};
use crate::document::{self, Entries};
use crate::scene::Scene;

/// A scene with some of its keys set.
#[derive(Clone, Debug)]
pub struct Setting {
    /// Keys and values that differ from the scene's own.
    pub keys: Vec<(String, String)>,
    /// The scene of it in its shortened form, or why there is none.
    pub scene: Result<Box<Scene>, String>,
}

impl Setting {
    /// What is set, in words.
    pub fn words(&self) -> String {
        let said = |(key, value): &(String, String)| format!("{key} = {value}");
        match self.keys.is_empty() {
            true => "the scene as it is".to_owned(),
            false => self.keys.iter().map(said).collect::<Vec<_>>().join(", "),
        }
    }
}

/// A scene's text with what is laid over it for all settings.
#[derive(Clone, Debug)]
pub struct Source<'a> {
    pub text: String,
    pub name: String,
    pub folder: &'a Path,
    /// As of `--set`: those of the user, then those that shorten the scene.
    pub overrides: Vec<String>,
}

impl Source<'_> {
    pub fn scene(&self, keys: &[(String, String)]) -> Result<Scene, String> {
        let mut all = self.overrides.clone();
        all.extend(keys.iter().map(|(key, value)| format!("{key}={value}")));
        Scene::parse(&self.text, &self.name, self.folder, &all).map_err(|problems| {
            let sentences = problems.into_iter().map(|(_, sentence)| sentence);
            sentences.collect::<Vec<_>>().join("; ")
        })
    }

    pub fn setting(&self, keys: Vec<(String, String)>) -> Setting {
        let scene = self.scene(&keys).map(Box::new);
        Setting { keys, scene }
    }

    /// What the text and the overrides say.
    pub fn entries(&self) -> Entries {
        let mut entries = document::parse(&self.text).unwrap_or_default();
        for argument in &self.overrides {
            // What cannot be laid over has been refused with the scene.
            let _ = document::lay_over(&mut entries, argument);
        }
        entries
    }
}

/// Every combination of the knobs' values.
pub fn product(knobs: &[Knob]) -> Vec<Vec<(String, String)>> {
    knobs.iter().fold(vec![Vec::new()], |points, knob| {
        let longer = points.iter().flat_map(|point| {
            knob.values.iter().map(|value| {
                let mut point = point.clone();
                point.push((knob.key.clone(), value.clone()));
                point
            })
        });
        longer.collect()
    })
}

/// The scene as it is, and each knob alone at its other values.
pub fn star(knobs: &[Knob], own: &Entries) -> Vec<Vec<(String, String)>> {
    let mut points = vec![Vec::new()];
    for knob in knobs {
        let has = knobs::own(own, &knob.key);
        let same = |value: &String| {
            *value == has
                || matches!((value.parse::<f64>(), has.parse::<f64>()), (Ok(a), Ok(b)) if a == b)
        };
        for value in knob.values.iter().filter(|value| !same(value)) {
            points.push(vec![(knob.key.clone(), value.clone())]);
        }
    }
    points
}

/// Refuses a knob with a value that no setting can have.
pub fn refuse_dead(knobs: &[Knob], settings: &[Setting]) -> Result<(), String> {
    for knob in knobs {
        for value in &knob.values {
            let pair = (knob.key.clone(), value.clone());
            let with = || settings.iter().filter(|s| s.keys.contains(&pair));
            if with().any(|s| s.scene.is_ok()) {
                continue;
            }
            if let Some(Err(sentence)) = with().map(|s| &s.scene).next() {
                return Err(format!("--knob {}={value}: {sentence}", knob.key));
            }
        }
    }
    Ok(())
}

/// The reference: what the user asks for, and for the other knobs what is tightest; refused combinations lose what was chosen last.
pub fn reference(
    source: &Source,
    knobs: &[Knob],
    given: &[(String, String)],
    scene: &Scene,
) -> Result<Setting, String> {
    let mut keys = given.to_vec();
    for knob in knobs {
        for (key, value) in knobs::tightest(knob, scene) {
            if keys.iter().all(|(known, _)| *known != key) {
                keys.push((key, value));
            }
        }
    }
    loop {
        match source.scene(&keys) {
            Ok(_) => return Ok(source.setting(keys)),
            Err(sentence) if keys.len() <= given.len() => {
                return Err(format!("--reference: {sentence}"));
            }
            Err(_) => drop(keys.pop()),
        }
    }
}
