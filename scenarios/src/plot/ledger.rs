//! The ledger over time: relative errors of what is conserved, and the energies.

use std::path::{Path, PathBuf};

use kuva::prelude::{Layout, LegendPosition, LinePlot, Plot};
use nbody::points::Dimension;

use super::{axis, save};
use crate::history::read_numbers;
use crate::scene::Scene;
use crate::units::{System, Units};

/// Errors below this are rounding, shown at its level.
const ROUNDING: f64 = 1e-17;

pub fn picture(table: &Path, output: &Path) -> Result<Option<PathBuf>, String> {
    let columns = read_numbers(table).map_err(|error| format!("{}: {error}", table.display()))?;
    let column = |name: &str| {
        columns
            .iter()
            .find(|column| column.0 == name)
            .map(|column| &column.1)
    };
    let Some(time) = column("time").filter(|time| time.len() > 1) else {
        return Ok(None);
    };
    let scene = table.with_file_name("scene.toml");
    let scene = Scene::load(&scene, &[]).ok();
    let units = scene
        .as_ref()
        .map_or(Units::new(System::Dimensionless), |scene| scene.units);
    let axis = axis("time", Dimension::TIME, &units);
    let curve = |name: &str, change: &dyn Fn(f64) -> f64| -> Vec<(f64, f64)> {
        let values = column(name).into_iter().flatten();
        let points = time
            .iter()
            .zip(values)
            .map(|(t, y)| (t * axis.factor, change(*y)));
        points.filter(|(_, y)| y.is_finite()).collect()
    };
    let errors = [
        ("error_mass", "mass", "#1f77b4"),
        ("error_momentum", "momentum", "#d62728"),
        ("error_angular_momentum", "angular momentum", "#2ca02c"),
        ("error_energy", "energy", "#9467bd"),
    ];
    let energies = [
        ("kinetic_energy", "kinetic", "#1f77b4"),
        ("internal_energy", "internal", "#d62728"),
        ("potential_energy", "potential", "#2ca02c"),
        ("radiated_energy", "radiated", "#9467bd"),
    ];
    let lines = |list: [(&'static str, &'static str, &'static str); 4],
                 change: &dyn Fn(f64) -> f64|
     -> Vec<Plot> {
        list.into_iter()
            .map(|(column, name, color)| (curve(column, change), name, color))
            .filter(|(points, ..)| points.len() > 1)
            .map(|(points, name, color)| {
                let line = LinePlot::new().with_data(points).with_color(color);
                Plot::Line(line.with_stroke_width(2.0).with_legend(name))
            })
            .collect()
    };
    let mut panels = Vec::new();
    for (plots, label) in [
        (
            lines(errors, &|y| y.abs().max(ROUNDING).log10()),
            "log relative error",
        ),
        (lines(energies, &|y| y), "energy [code units]"),
    ] {
        if plots.is_empty() {
            continue;
        }
        let layout = Layout::auto_from_plots(&plots)
            .with_x_label(axis.text.clone())
            .with_y_label(label)
            .with_box_axes()
            .with_legend_position(LegendPosition::OutsideBottomCenter);
        panels.push((plots, layout));
    }
    if panels.is_empty() {
        return Ok(None);
    }
    let columns = panels.len();
    let title = scene.map_or_else(
        || "Ledger".to_owned(),
        |scene| format!("{}: ledger", scene.title),
    );
    save(panels, columns, &title, &output.join("ledger.png")).map(Some)
}
