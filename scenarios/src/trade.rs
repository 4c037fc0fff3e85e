//! A trade: error against cost over settings of a scene, each run in a shortened form and compared with a tighter reference.

mod course;
pub mod errors;
mod jackknife;
mod knobs;
mod picture;
pub mod presets;
mod results;
mod runs;
mod settings;
mod shorten;
mod tail;

use std::path::{Path, PathBuf};

use course::Course;
use errors::METRICS;
use results::Table;
use settings::Setting;

use crate::atomic::publish_bytes;
use crate::edit;
use crate::reader::nearest;
use crate::run::{Outcome as End, RunError};
use crate::signals;

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
    /// Another seed, with which that setting is to meet them, too.
    pub confirm: Option<u64>,
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
    let course = Course::of(request)?;
    let folder = &course.folder;
    std::fs::create_dir_all(folder).map_err(|error| {
        RunError::Refused(format!(
            "the folder {} cannot be used: {error}",
            folder.display()
        ))
    })?;
    println!("{}", course.sentence);
    println!("reference: {}", course.reference.words());
    if !course.aside.is_empty() {
        println!(
            "no value is known to be tighter of {}: the reference has the scene's own",
            course.aside.join(", ")
        );
    }
    let ended = course.run(&folder.join("settings"), request);
    let (table, trouble) = course.table(&ended);
    print!("{}", table.text());
    for (i, saved) in table.bargains() {
        let words = table.rows[i].setting.words();
        println!(
            "as good as the scene as it is, {:.0} % cheaper: {words}",
            100.0 * saved
        );
    }
    for (metric, spread) in table.spreads() {
        println!(
            "{metric}: a few bodies make most of it; with another seed it may be {spread:.0} times as large, which --error allows for"
        );
    }
    publish_bytes(&folder.join("trade.csv"), table.csv().as_bytes())?;
    if let Ok(scene) = course.reference.scene.as_deref() {
        publish_bytes(&folder.join("reference.toml"), scene.to_toml().as_bytes())?;
    }
    println!("{}", folder.join("trade.csv").display());
    let drawn = picture::picture(&table, &course.title, &folder.join("trade.png"));
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
    advise(request, &course, &table, limits)
}

/// Names the cheapest setting within the wanted errors, and confirms and applies it if that is wished.
fn advise(
    request: &Request,
    course: &Course,
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
    if let Some(seed) = request.confirm {
        confirm(request, course, (&row.setting, &limits), seed)?;
    }
    if request.apply {
        apply(&request.scene, &row.setting)?;
    }
    Ok(End::Done)
}

/// Runs a setting and the reference with another seed; fails if an error is beyond its limit then.
fn confirm(
    request: &Request,
    course: &Course,
    (setting, limits): (&Setting, &[(&'static str, f64)]),
    seed: u64,
) -> Result<(), RunError> {
    let again = course.with_seed(setting, seed);
    let ended = again.run(&course.folder.join("settings"), request);
    let (table, trouble) = again.table(&ended);
    if let Some(sentence) = trouble {
        return Err(RunError::Failed(sentence));
    }
    let found = match table.rows.first().map(|row| &row.outcome) {
        Some(Ok(outcome)) => &outcome.errors,
        Some(Err(sentence)) => return Err(RunError::Failed(sentence.clone())),
        None => return Ok(()),
    };
    let error = |metric: &str| found.get(metric).map_or(f64::NAN, |found| found.error);
    let said: Vec<String> = (limits.iter())
        .map(|(metric, bar)| format!("{metric} {:.2e} of {bar:e}", error(metric)))
        .collect();
    println!("with seed {seed}: {}", said.join(", "));
    let holds = limits.iter().all(|(metric, bar)| error(metric) <= *bar);
    if holds {
        return Ok(());
    }
    let sentence = "the setting does not keep within the wanted errors with the other seed";
    Err(RunError::Failed(sentence.to_owned()))
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
    if request.errors.is_empty() && request.within.is_none() {
        let wishes = [
            (request.apply, "--apply"),
            (request.confirm.is_some(), "--confirm"),
        ];
        if let Some((_, name)) = wishes.iter().find(|(wished, _)| *wished) {
            return Err(format!(
                "{name}: needs --error METRIC=VALUE or --within VALUE, which say what is good enough"
            ));
        }
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
