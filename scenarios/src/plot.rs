//! Pictures of a snapshot and of a run: column densities, radial profiles, the ledger over time.

mod ledger;
pub(crate) mod map;
mod profile;

use std::path::{Path, PathBuf};

use kuva::PngBackend;
use kuva::prelude::{Figure, Layout, Plot};
use nbody::points::Dimension;

use crate::atomic::publish_bytes;
use crate::info::snapshots;
use crate::snapshot::{self, Contents};
use crate::units::{System, Units};

/// Draws what the file or folder holds; the pictures' paths.
pub fn draw(path: &Path, output: Option<&Path>) -> Result<Vec<PathBuf>, String> {
    let folder = path.is_dir();
    let home = if folder { Some(path) } else { path.parent() };
    let output = output.or(home).unwrap_or(Path::new(".")).to_path_buf();
    std::fs::create_dir_all(&output).map_err(|error| format!("{}: {error}", output.display()))?;
    let mut pictures = Vec::new();
    let newest = if folder {
        snapshots(path)?.pop()
    } else {
        Some(path.to_path_buf())
    };
    if let Some(newest) = newest {
        pictures.extend(of_snapshot(&newest, &output)?);
    }
    let table = path.join("ledger.csv");
    if folder && table.is_file() {
        pictures.extend(ledger::picture(&table, &output)?);
    }
    if pictures.is_empty() {
        return Err(format!(
            "{} holds nothing to draw: neither snapshots nor a ledger",
            path.display()
        ));
    }
    Ok(pictures)
}

fn of_snapshot(path: &Path, output: &Path) -> Result<Vec<PathBuf>, String> {
    let contents = snapshot::read(path, None).map_err(|error| error.to_string())?;
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let mut pictures = Vec::new();
    for group in contents.groups.iter().filter(|group| group.len() > 1) {
        let name = match group.part_type {
            0 => "gas",
            1 => "planetesimals",
            2 => "dust",
            _ => continue,
        };
        let file = output.join(format!("{stem}_{name}.png"));
        pictures.extend(map::picture(&contents, group, name, &file)?);
    }
    let file = output.join(format!("{stem}_profiles.png"));
    pictures.extend(profile::picture(&contents, &file)?);
    Ok(pictures)
}

/// Saves panels, `columns` side by side.
pub(crate) fn save(
    panels: Vec<(Vec<Plot>, Layout)>,
    columns: usize,
    title: &str,
    path: &Path,
) -> Result<PathBuf, String> {
    let rows = panels.len().div_ceil(columns);
    let (plots, layouts): (Vec<_>, Vec<_>) = panels.into_iter().unzip();
    let figure = Figure::new(rows, columns)
        .with_title(title)
        .with_title_size(18)
        .with_cell_size(520.0, 452.0)
        .with_plots(plots)
        .with_layouts(layouts);
    let image = PngBackend::new()
        .with_scale(2.0)
        .render_scene(&figure.render())?;
    publish_bytes(path, &image).map_err(|error| format!("{}: {error}", path.display()))?;
    Ok(path.to_path_buf())
}

/// How pictures name quantities, and by what code units are multiplied for it.
struct Axis {
    text: String,
    factor: f64,
}

fn axis(name: &str, dimension: Dimension, units: &Units) -> Axis {
    let (unit, factor) = match (units.system, dimension) {
        (System::Astronomical, Dimension::LENGTH) => ("au", 1.0),
        (System::Astronomical, Dimension::TIME) => ("yr", 1.0 / std::f64::consts::TAU),
        (System::Dimensionless, _) => ("", 1.0),
        (_, Dimension::LENGTH) => ("cm", units.cgs(dimension)),
        (_, Dimension::TIME) => ("s", units.cgs(dimension)),
        (_, Dimension::SURFACE_DENSITY) => ("g/cm²", units.cgs(dimension)),
        (_, Dimension::DENSITY) => ("g/cm³", units.cgs(dimension)),
        (_, Dimension::PRESSURE) => ("erg/cm³", units.cgs(dimension)),
        (_, Dimension::VELOCITY) => ("km/s", units.cgs(dimension) * 1e-5),
        _ => ("", 1.0),
    };
    let text = if unit.is_empty() {
        name.to_owned()
    } else {
        format!("{name} [{unit}]")
    };
    Axis { text, factor }
}

/// Title of a snapshot's pictures.
fn caption(contents: &Contents, what: &str) -> String {
    let axis = axis("", Dimension::TIME, &contents.units);
    let time = contents.time * axis.factor;
    let unit = axis.text.trim().trim_matches(['[', ']']).to_owned();
    let title = if contents.title.is_empty() {
        String::new()
    } else {
        format!("{}: ", contents.title)
    };
    format!("{title}{what}, t = {time:.4} {unit}")
        .trim_end()
        .to_owned()
}

/// The star's position and mass, if the snapshot has one.
fn star(contents: &Contents) -> Option<(nbody::points::Vec3, nbody::points::Vec3, f64)> {
    let group = contents.group(4)?;
    Some((*group.x.first()?, *group.v.first()?, *group.m.first()?))
}

#[cfg(test)]
mod tests;
