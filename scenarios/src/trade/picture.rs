//! The picture of a trade: error against cost, a panel a metric, the frontier as a line.

use std::path::{Path, PathBuf};

use kuva::prelude::{Layout, LinePlot, Plot, ScatterPlot};

use super::results::{ROUNDING, Table};
use crate::plot::save;

/// Draws what can be shown on logarithmic axes; no picture where no metric has two such settings.
pub fn picture(table: &Table, title: &str, path: &Path) -> Result<Option<PathBuf>, String> {
    let mut panels = Vec::new();
    for metric in table.metrics() {
        let points = table.points(metric).into_iter();
        let shown: Vec<(usize, (f64, f64))> = points
            .filter(|point| point.1 > 0.0 && point.2 > ROUNDING)
            .map(|(i, cost, error)| (i, (cost.log10(), error.log10())))
            .collect();
        if shown.len() < 2 {
            continue;
        }
        let front = table.frontier(metric).into_iter();
        let along: Vec<(f64, f64)> = front
            .filter_map(|i| Some(shown.iter().find(|point| point.0 == i)?.1))
            .collect();
        let all: Vec<(f64, f64)> = shown.iter().map(|point| point.1).collect();
        let dots = ScatterPlot::new().with_data(all).with_color("#7f7f7f");
        let mut plots = vec![Plot::Scatter(dots.with_size(5.0))];
        if along.len() > 1 {
            let line = LinePlot::new().with_data(along.clone());
            plots.push(Plot::Line(
                line.with_color("#d62728").with_stroke_width(2.0),
            ));
        }
        let best = ScatterPlot::new().with_data(along).with_color("#d62728");
        plots.push(Plot::Scatter(best.with_size(6.0)));
        let layout = Layout::auto_from_plots(&plots)
            .with_x_label("log CPU time [s]")
            .with_y_label(format!("log error of {}", metric.replace('_', " ")))
            .with_box_axes();
        panels.push((plots, layout));
    }
    if panels.is_empty() {
        return Ok(None);
    }
    let columns = panels.len().min(3);
    save(panels, columns, title, path).map(Some)
}
