//! A trade: error against cost over settings of a scene, each run in a shortened form and compared with a tighter reference.

pub mod errors;
mod knobs;
mod picture;
mod results;
mod runs;
mod settings;
mod shorten;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use errors::{METRICS, State};
use knobs::Knob;
use results::{Outcome, Row, Table};
use runs::Ended;
use settings::{Setting, Source};

use crate::atomic::publish_bytes;
use crate::document::Entries;
use crate::edit;
use crate::progress::Count;
use crate::reader::nearest;
use crate::run::{Outcome as End, RunError};
use crate::scene::Scene;
use crate::{document, signals};

/// What is traded.
#[derive(Clone, Debug, Default)]
pub struct Request {
    pub scene: PathBuf,
    /// `key=v1,v2,...`; those that suit the scene if empty.
    pub knobs: Vec<String>,
    pub set: Vec<String>,
    /// `metric=value`.
    pub errors: Vec<String>,
    /// A bar for all metrics.
    pub within: Option<f64>,
    /// Whether the cheapest setting within the wanted errors goes into the scene's file.
    pub apply: bool,
    pub output: Option<PathBuf>,
    /// `key=value,...`.
    pub reference: Option<String>,
    pub threads: usize,
    /// CPU time for all runs, s.
    pub budget: f64,
    /// Whether the scene keeps its length and size.
    pub full: bool,
    pub quiet: bool,
}

/// Runs all settings and prints the table.
pub fn trade(request: &Request) -> Result<End, RunError> {
    let limits = limits(request).map_err(RunError::Refused)?;
    let plan = Plan::of(request)?;
    let default = || Path::new("trade").join(&plan.name);
    let folder = request.output.clone().unwrap_or_else(default);
    std::fs::create_dir_all(&folder).map_err(|error| {
        RunError::Refused(format!(
            "the folder {} cannot be used: {error}",
            folder.display()
        ))
    })?;
    println!("{}", plan.sentence);
    println!("reference: {}", plan.reference.words());
    let ended = plan.run(&folder.join("settings"), request);
    let (table, trouble) = plan.table(&ended);
    print!("{}", table.text());
    publish_bytes(&folder.join("trade.csv"), table.csv().as_bytes())?;
    if let Some(scene) = plan.reference.scene.as_deref().ok() {
        publish_bytes(&folder.join("reference.toml"), scene.to_toml().as_bytes())?;
    }
    println!("{}", folder.join("trade.csv").display());
    let drawn = picture::picture(&table, &plan.title, &folder.join("trade.png"));
    if let Some(path) = drawn.map_err(RunError::Failed)? {
        println!("{}", path.display());
    }
    if let Some(signal) = signals::caught() {
        return Ok(End::Interrupted(signal));
    }
    if let Some(sentence) = trouble {
        return Err(RunError::Failed(sentence));
    }
    if limits.is_empty() && request.within.is_none() {
        return Ok(End::Done);
    }
    advise(request, &table, limits)
}

/// Names the cheapest setting within the wanted errors, and applies it if that is wished.
fn advise(
    request: &Request,
    table: &Table,
    limits: Vec<(&'static str, f64)>,
) -> Result<End, RunError> {
    let all = || table.metrics().into_iter();
    let limits = match request.within {
        Some(bar) => all().map(|metric| (metric, bar)).collect(),
        None => limits,
    };
    if let Some((metric, _)) = limits
        .iter()
        .find(|(metric, _)| !table.metrics().contains(metric))
    {
        return Err(RunError::Refused(format!(
            "--error {metric}: the scene has no such error; it has {}",
            table.metrics().join(", ")
        )));
    }
    let said: Vec<String> = limits.iter().map(|(m, x)| format!("{m} {x:e}")).collect();
    let Some(best) = table.cheapest(&limits) else {
        let sentence = format!("no setting is within {}", said.join(", "));
        println!("{sentence}");
        return if request.apply {
            Err(RunError::Failed(sentence))
        } else {
            Ok(End::Done)
        };
    };
    let row = &table.rows[best];
    println!(
        "cheapest within {}: {}",
        said.join(", "),
        row.setting.words()
    );
    if request.apply {
        apply(&request.scene, &row.setting)?;
    }
    Ok(End::Done)
}

/// Writes a setting into the file of the scene.
fn apply(path: &Path, setting: &Setting) -> Result<(), RunError> {
    let read = |error: std::io::Error| RunError::Refused(format!("{}: {error}", path.display()));
    let text = std::fs::read_to_string(path).map_err(read)?;
    let folder = path.parent().unwrap_or(Path::new("."));
    let changed = edit::with_keys(&text, folder, &setting.keys).map_err(RunError::Failed)?;
    publish_bytes(path, changed.as_bytes())?;
    println!("written to {}: {}", path.display(), setting.words());
    Ok(())
}

fn limits(request: &Request) -> Result<Vec<(&'static str, f64)>, String> {
    if request.apply && request.errors.is_empty() && request.within.is_none() {
        return Err(
            "--apply: needs --error METRIC=VALUE or --within VALUE, which say what is good enough"
                .to_owned(),
        );
    }
    let limit = |argument: &String| {
        let (name, value) = argument.split_once('=').unwrap_or((argument, ""));
        let name = name.trim().trim_start_matches("error_");
        let Some(metric) = METRICS.iter().find(|metric| **metric == name) else {
            let near = nearest(name, &METRICS)
                .map_or_else(String::new, |near| format!("the nearest is {near}, "));
            return Err(format!(
                "--error {argument}: is no metric; {near}known are {}",
                METRICS.join(", ")
            ));
        };
        match value.trim().parse::<f64>() {
            Ok(bar) if bar > 0.0 => Ok((*metric, bar)),
            _ => Err(format!(
                "--error {argument}: wanted is {metric}=VALUE with a number greater than 0"
            )),
        }
    };
    if request.within.is_some_and(|bar| bar.is_nan() || bar <= 0.0) {
        return Err("--within: must be a number greater than 0".to_owned());
    }
    request.errors.iter().map(limit).collect()
}

/// Everything that a trade runs.
struct Plan {
    name: String,
    title: String,
    sentence: String,
    keys: Vec<String>,
    own: Entries,
    reference: Setting,
    settings: Vec<Setting>,
    planets: usize,
}

impl Plan {
    fn of(request: &Request) -> Result<Self, RunError> {
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
        let sentence = if request.full {
            "not shortened".to_owned()
        } else {
            let make = |source: &Source| {
                let mut all = vec![source.setting(reference.keys.clone())];
                all.extend(settings(source, &points));
                all
            };
            let sized = ["gas.particles", "dust.particles", "planetesimals.number"];
            let may_thin = knobs.iter().all(|knob| !sized.contains(&knob.key.as_str()));
            let short = shorten::shorten(&source, make, request.budget, may_thin)?;
            source.overrides.extend(short.overrides);
            short.sentence
        };
        Ok(Self {
            name: scene.name.clone(),
            title: scene.title.clone(),
            sentence,
            keys: knobs.into_iter().map(|knob| knob.key).collect(),
            own,
            reference: source.setting(reference.keys),
            settings: settings(&source, &points),
            planets: scene.planets.len(),
        })
    }

    /// Runs the reference and all settings; the reference comes first.
    fn run(&self, folder: &Path, request: &Request) -> Vec<Ended> {
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
    fn table(&self, ended: &[Ended]) -> (Table, Option<String>) {
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
