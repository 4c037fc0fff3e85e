//! The picture of a trade: error against cost, a panel a metric, the frontier as a line.

use std::path::{Path, PathBuf};

use kuva::prelude::{Layout, LinePlot, Plot, ScatterPlot};

use super::results::Table;
use crate::plot::save;

/// Draws what can be shown on logarithmic axes; no picture where no metric has two such settings.
pub fn picture(table: &Table, title: &str, path: &Path) -> Result<Option<PathBuf>, String> {
    let mut panels = Vec::new();
    for metric in table.metrics() {
        let points = table.points(metric);
        let shown: Vec<(usize, f64, f64)> = points
            .into_iter()
            .filter(|point| point.1 > 0.0 && point.2 > 0.0)
            .collect();
        if shown.len() < 2 {
            continue;
        }
        let front = table.frontier(metric);
        let along = front
            .iter()
            .filter_map(|i| shown.iter().find(|point| point.0 == *i));
        let along: Vec<(f64, f64)> = along.map(|point| (point.1, point.2)).collect();
        let all: Vec<(f64, f64)> = shown.iter().map(|point| (point.1, point.2)).collect();
        let bounds = |of: fn(&(f64, f64)) -> f64| {
            let values = || all.iter().map(of);
            (
                values().fold(f64::INFINITY, f64::min),
                values().fold(0.0, f64::max),
            )
        };
        let (x, y) = (bounds(|p| p.0), bounds(|p| p.1));
        let dots = ScatterPlot::new()
            .with_data(all)
            .with_color("#7f7f7f")
            .with_size(5.0);
        let mut plots = vec![Plot::Scatter(dots)];
        if along.len() > 1 {
            let line = LinePlot::new()
                .with_data(along.clone())
                .with_color("#d62728");
            plots.push(Plot::Line(line.with_stroke_width(2.0)));
        }
        let best = ScatterPlot::new()
            .with_data(along)
            .with_color("#d62728")
            .with_size(6.0);
        plots.push(Plot::Scatter(best));
        let layout = Layout::auto_from_plots(&plots)
            .with_x_label("CPU time [s]")
            .with_y_label(format!("error of {}", metric.replace('_', " ")))
            .with_box_axes()
            .with_log_x()
            .with_log_y()
            .with_x_axis_min(x.0 / 1.3)
            .with_x_axis_max(x.1 * 1.3)
            .with_y_axis_min(y.0 / 2.0)
            .with_y_axis_max(y.1 * 2.0);
        panels.push((plots, layout));
    }
    if panels.is_empty() {
        return Ok(None);
    }
    let columns = panels.len().min(3);
    save(panels, columns, title, path).map(Some)
}
