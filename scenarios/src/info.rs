//! What a file or a run's folder holds, in words.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use nbody::points::{Dimension, Vec3};

use crate::checkpoint::{Checkpoint, Fact};
use crate::history::{self, operators};
use crate::scene::Scene;
use crate::snapshot::{self, Contents, Particles};
use crate::units::Units;

/// Names of the types of particles.
pub fn population(part_type: usize) -> &'static str {
    match part_type {
        0 => "gas",
        1 => "planetesimals and planets",
        2 => "dust",
        4 => "star",
        _ => "other particles",
    }
}

/// A text about the file or folder; why there is none otherwise.
pub fn describe(path: &Path) -> Result<String, String> {
    if path.is_dir() {
        return folder(path);
    }
    if let Ok(checkpoint) = Checkpoint::open(path) {
        return Ok(of_checkpoint(path, &checkpoint));
    }
    let contents = snapshot::read(path, None).map_err(|error| error.to_string())?;
    Ok(of_snapshot(path, &contents))
}

/// Snapshots of a run's folder in the order of their numbers.
pub fn snapshots(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let wrong = |error: std::io::Error| format!("{}: {error}", folder.display());
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(wrong)? {
        let path = entry.map_err(wrong)?.path();
        let name = path
            .file_name()
            .and_then(|name| name.to_str())
            .unwrap_or_default();
        let number = name
            .strip_prefix("snapshot_")
            .and_then(|rest| rest.strip_suffix(".hdf5"));
        if let Some(number) = number.and_then(|number| number.parse::<u64>().ok()) {
            found.push((number, path));
        }
    }
    found.sort();
    Ok(found.into_iter().map(|(_, path)| path).collect())
}

fn folder(path: &Path) -> Result<String, String> {
    let snapshots = snapshots(path)?;
    let scene = path.join("scene.toml");
    if snapshots.is_empty() && !scene.is_file() {
        return Err(format!(
            "{} is no folder of a run: it has neither scene.toml nor snapshots",
            path.display()
        ));
    }
    let mut text = format!("{}: a run\n", path.display());
    if scene.is_file() {
        match Scene::load(&scene, &[]) {
            Ok(scene) => {
                let time = time(scene.run.end_time, &scene.units);
                line(
                    &mut text,
                    format_args!("scene \"{}\", {}, to {time}", scene.name, scene.title),
                );
            }
            Err(refusal) => line(&mut text, format_args!("{refusal}")),
        }
    }
    line(&mut text, format_args!("{} snapshots", snapshots.len()));
    if let Ok(ledger) = history::read_numbers(&path.join("ledger.csv")) {
        ledger_lines(&mut text, &ledger);
    }
    let checkpoint = path.join("checkpoint.hdf5");
    if let Ok(open) = Checkpoint::open(&checkpoint) {
        text += &of_checkpoint(&checkpoint, &open);
    }
    if let Some(last) = snapshots.last() {
        let contents = snapshot::read(last, None).map_err(|error| error.to_string())?;
        text += &of_snapshot(last, &contents);
    }
    Ok(text)
}

/// What each operator of the run in `folder` has changed since the start, by population, beside what the sums changed by.
pub fn ledger(folder: &Path) -> Result<String, String> {
    const SUMS: [&str; 9] = [
        "mass", "p_x", "p_y", "p_z", "L_x", "L_y", "L_z", "kinetic", "internal",
    ];
    let (time, lines) = operators::last(&folder.join("operators.csv"))?;
    let mut text = format!(
        "{}: changes by operator to time {time}, code units\n",
        folder.display()
    );
    let row = |text: &mut String, words: [&str; 2], cells: &[String]| {
        let cells: Vec<String> = cells.iter().map(|cell| format!("{cell:>10}")).collect();
        line(
            text,
            format_args!("{:14} {:14}{}", words[0], words[1], cells.join(" ")),
        );
    };
    row(
        &mut text,
        ["operator", "population"],
        &SUMS.map(str::to_owned),
    );
    let number = |x: f64| format!("{x:.2e}");
    for (operator, population, sums) in &lines {
        row(&mut text, [operator, population], &sums.map(number));
    }
    let mut whole = [0.0; 9];
    for (_, _, sums) in lines
        .iter()
        .filter(|(operator, ..)| operator != operators::START)
    {
        for (whole, x) in whole.iter_mut().zip(sums) {
            *whole += x;
        }
    }
    row(&mut text, ["all operators", "all"], &whole.map(number));
    let books = changes(&folder.join("ledger.csv"))?;
    row(&mut text, ["the sums", "all"], &books.map(number));
    let unbooked: [f64; 9] = std::array::from_fn(|k| books[k] - whole[k]);
    row(&mut text, ["unbooked", "all"], &unbooked.map(number));
    Ok(text)
}

/// What the sums of a `ledger.csv` have changed by from its first row to its last: mass, momentum, angular momentum, kinetic and internal energy.
fn changes(path: &Path) -> Result<[f64; 9], String> {
    let columns = history::read_numbers(path).map_err(|e| format!("{}: {e}", path.display()))?;
    let change = |wanted: &dyn Fn(&str) -> bool| {
        let chosen = columns.iter().filter(|(name, _)| wanted(name));
        chosen
            .map(|(_, values)| match (values.first(), values.last()) {
                (Some(first), Some(last)) => last - first,
                _ => f64::NAN,
            })
            .sum()
    };
    let mut found = [0.0; 9];
    found[0] = change(&|name| name.starts_with("mass_"));
    for (k, axis) in ["x", "y", "z"].iter().enumerate() {
        found[1 + k] = change(&|name| name == format!("momentum_{axis}"));
        found[4 + k] = change(&|name| name == format!("angular_momentum_{axis}"));
    }
    found[7] = change(&|name| name == "kinetic_energy");
    found[8] = change(&|name| name == "internal_energy");
    Ok(found)
}

fn line(text: &mut String, what: std::fmt::Arguments<'_>) {
    writeln!(text, "  {what}").expect("writing to a string does not fail");
}

fn ledger_lines(text: &mut String, ledger: &[(String, Vec<f64>)]) {
    let rows = ledger.first().map_or(0, |column| column.1.len());
    line(text, format_args!("ledger of {rows} rows"));
    for (name, values) in ledger.iter().filter(|(name, _)| name.starts_with("error_")) {
        if let Some(last) = values.last() {
            let largest = values.iter().fold(0.0f64, |most, x| worse(most, x.abs()));
            line(
                text,
                format_args!("  {name}: {last:.2e} at the end, at most {largest:.2e}"),
            );
        }
    }
}

/// The larger, or not-a-number if one of them is.
fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

fn of_checkpoint(path: &Path, checkpoint: &Checkpoint) -> String {
    let mut text = format!("{}: a checkpoint\n", path.display());
    for name in ["time", "step"] {
        match checkpoint.fact(name) {
            Ok(Fact::Real(x)) => line(&mut text, format_args!("{name} {x}")),
            Ok(Fact::Integer(i)) => line(&mut text, format_args!("{name} {i}")),
            _ => {}
        }
    }
    for name in checkpoint.sets() {
        let n = checkpoint.length(&name).unwrap_or(0);
        line(&mut text, format_args!("{name}: {n} entries"));
    }
    text
}

/// A time with the unit that people think in.
fn time(t: f64, units: &Units) -> String {
    match units.symbol(Dimension::TIME) {
        "yr/2pi" => format!("{:.6} yr", t / std::f64::consts::TAU),
        unit => format!("{t} {unit}").trim_end().to_owned(),
    }
}

fn of_snapshot(path: &Path, contents: &Contents) -> String {
    let mut text = format!("{}: a snapshot\n", path.display());
    if !contents.title.is_empty() {
        line(&mut text, format_args!("{}", contents.title));
    }
    line(
        &mut text,
        format_args!("time {}", time(contents.time, &contents.units)),
    );
    for group in contents.groups.iter().filter(|group| !group.is_empty()) {
        of_group(&mut text, group, &contents.units);
    }
    text
}

fn of_group(text: &mut String, group: &Particles, units: &Units) {
    let mass: f64 = group.m.iter().sum();
    let name = population(group.part_type);
    let unit = units.symbol(Dimension::MASS);
    line(
        text,
        format_args!("{name}: {} particles, mass {mass:.6e} {unit}", group.len()),
    );
    let (lo, hi) = extent(&group.x);
    let unit = units.symbol(Dimension::LENGTH);
    line(
        text,
        format_args!(
            "  from ({:.4}, {:.4}, {:.4}) to ({:.4}, {:.4}, {:.4}) {unit}",
            lo.x, lo.y, lo.z, hi.x, hi.y, hi.z
        ),
    );
    for (name, values) in &group.more {
        let (lo, hi) = values
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), &x| {
                (lo.min(x), hi.max(x))
            });
        line(text, format_args!("  {name} from {lo:.4e} to {hi:.4e}"));
    }
}

/// The smallest box that holds all points.
fn extent(x: &[Vec3]) -> (Vec3, Vec3) {
    let start = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    x.iter().fold(start, |(lo, hi), x| (lo.inf(x), hi.sup(x)))
}
