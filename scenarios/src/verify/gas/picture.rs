//! Pictures of the battery: particles as points with the exact answer as a line, and maps of a quantity in a plane.

use kuva::prelude::{ColorMap, Heatmap, Layout, LegendPosition, LinePlot, Plot, ScatterPlot};

use super::{End, Scheme, State};
use crate::plot::map::{CELLS, spread};
use crate::plot::save;

/// Points of a panel; of more particles every so many is drawn.
const MOST: usize = 4000;

/// A quantity of particles against a place, and what it should be.
pub struct Profile {
    pub axes: [&'static str; 2],
    pub points: Vec<(f64, f64)>,
    pub exact: Vec<(f64, f64)>,
}

/// A part of the plane z = const that is shaded.
pub struct Window {
    pub lo: [f64; 2],
    pub hi: [f64; 2],
    /// Of the coordinates across and up.
    pub axes: [usize; 2],
}

impl Window {
    /// The unit square.
    pub const UNIT: Self = Self {
        lo: [0.0; 2],
        hi: [1.0; 2],
        axes: [0, 1],
    };
}

/// Draws profiles side by side, if pictures are wanted.
pub fn profiles(scheme: &Scheme, name: &str, title: &str, profiles: impl FnOnce() -> Vec<Profile>) {
    if let Some(file) = scheme.picture(name) {
        let panels: Vec<_> = profiles().into_iter().map(panel).collect();
        let columns = panels.len();
        say(save(panels, columns, title, &file));
    }
}

/// Draws maps of `value` at each end side by side, if pictures are wanted.
pub fn maps(
    scheme: &Scheme,
    name: &str,
    ends: &[(&End, String)],
    window: &Window,
    value: impl Fn(&State) -> f64,
) {
    if let Some(file) = scheme.picture(name) {
        let panels: Vec<_> = ends
            .iter()
            .map(|(end, title)| shades(end, window, title, &value))
            .collect();
        let columns = panels.len();
        say(save(panels, columns, name, &file));
    }
}

/// A picture that cannot be written is no failure of the physics.
fn say(saved: Result<std::path::PathBuf, String>) {
    if let Err(sentence) = saved {
        eprintln!("no picture: {sentence}");
    }
}

fn panel(profile: Profile) -> (Vec<Plot>, Layout) {
    let every = profile.points.len().div_ceil(MOST).max(1);
    let points = profile.points.into_iter().step_by(every);
    let mut plots = vec![Plot::Scatter(
        ScatterPlot::new()
            .with_data(points)
            .with_color("#1f77b4")
            .with_size(1.3)
            .with_legend("particles"),
    )];
    if profile.exact.len() > 1 {
        let line = LinePlot::new()
            .with_data(profile.exact)
            .with_color("#d62728");
        plots.push(Plot::Line(line.with_stroke_width(1.5).with_legend("exact")));
    }
    let [x, y] = profile.axes;
    let layout = Layout::auto_from_plots(&plots)
        .with_x_label(x)
        .with_y_label(y)
        .with_box_axes()
        .with_legend_position(LegendPosition::OutsideBottomCenter);
    (plots, layout)
}

fn shades(
    end: &End,
    window: &Window,
    title: &str,
    value: &impl Fn(&State) -> f64,
) -> (Vec<Plot>, Layout) {
    let cell = [0, 1].map(|side| (window.hi[side] - window.lo[side]) / CELLS as f64);
    let empty = || vec![vec![0.0; CELLS]; CELLS];
    let (mut sums, mut volumes) = (empty(), empty());
    for particle in &end.gas {
        let place =
            [0, 1].map(|side| (particle.x[window.axes[side]] - window.lo[side]) / cell[side]);
        let width = cell.map(|cell| (1.2 * particle.h / cell).clamp(0.8, CELLS as f64));
        let volume = particle.volume();
        spread(&mut sums, place, width, volume * value(particle));
        spread(&mut volumes, place, width, volume);
    }
    for (sum, volume) in sums.iter_mut().flatten().zip(volumes.iter().flatten()) {
        *sum /= if *volume > 0.0 { *volume } else { 1.0 };
    }
    let plots = vec![Plot::Heatmap(
        Heatmap::new()
            .with_data(sums)
            .with_color_map(ColorMap::Inferno)
            .with_x_range(window.lo[0], window.hi[0])
            .with_y_range(window.lo[1], window.hi[1])
            .with_cell_size(1.0),
    )];
    let names = ["x", "y", "z"];
    let layout = Layout::auto_from_plots(&plots)
        .with_title(title)
        .with_title_size(15)
        .with_x_label(names[window.axes[0]])
        .with_y_label(names[window.axes[1]])
        .with_show_grid(false)
        .with_box_axes()
        .with_x_axis_min(window.lo[0])
        .with_x_axis_max(window.hi[0])
        .with_y_axis_min(window.lo[1])
        .with_y_axis_max(window.hi[1]);
    (plots, layout)
}
