//! Maps of the column density: the mass of each particle spread over its smoothing length, seen along an axis.

use std::path::{Path, PathBuf};

use kuva::prelude::{ColorMap, Heatmap, Layout, Plot, ScatterPlot};
use nbody::points::{Dimension, Vec3};

use super::{axis, caption, save, star};
use crate::snapshot::{Contents, Particles};

/// Cells along each side of a map.
pub(crate) const CELLS: usize = 240;
/// Sets of at most so many bodies or superparticles are drawn one by one.
const FEW: usize = 5000;
/// Decades below the maximum that are shown.
const DECADES: f64 = 4.0;
/// Support of the kernel by the smoothing length (Wendland C2 in space).
const SUPPORT: f64 = 1.936;

/// A rectangle of the plane of axes a and b.
struct View {
    axes: [usize; 2],
    lo: [f64; 2],
    hi: [f64; 2],
}

impl View {
    fn cell(&self, side: usize) -> f64 {
        (self.hi[side] - self.lo[side]) / CELLS as f64
    }

    /// Coordinates in cells.
    fn place(&self, x: &Vec3) -> [f64; 2] {
        [0, 1].map(|side| (x[self.axes[side]] - self.lo[side]) / self.cell(side))
    }
}

/// Face-on and edge-on maps of a population.
pub fn picture(
    contents: &Contents,
    group: &Particles,
    name: &str,
    path: &Path,
) -> Result<Option<PathBuf>, String> {
    let views = views(contents, group);
    let panels: Vec<_> = views
        .iter()
        .map(|view| panel(contents, group, view))
        .collect();
    if panels.is_empty() {
        return Ok(None);
    }
    let columns = panels.len();
    save(panels, columns, &caption(contents, name), path).map(Some)
}

/// The planes in which the particles are spread out: xy and xz, or the one of a two-dimensional scene.
fn views(contents: &Contents, group: &Particles) -> Vec<View> {
    let centre = star(contents).map_or_else(|| middle(&group.x), |(x, ..)| x);
    let reach: Vec<f64> = (0..3)
        .map(|side| reach(&group.x, side, centre[side]))
        .collect();
    let spread = |side: usize| reach[side] > 0.0;
    [[0, 1], [0, 2]]
        .into_iter()
        .filter(|axes| axes.iter().all(|&side| spread(side)))
        .map(|axes| {
            // Seen from above both sides are equal.
            let wide = reach[0].max(reach[1]);
            let half = axes.map(|side| if side == 2 { reach[2] } else { wide });
            let half = if reach[0] > 2.0 * reach[1] && star(contents).is_none() {
                axes.map(|side| reach[side])
            } else {
                half
            };
            View {
                axes,
                lo: [0, 1].map(|side| centre[axes[side]] - half[side]),
                hi: [0, 1].map(|side| centre[axes[side]] + half[side]),
            }
        })
        .collect()
}

fn middle(x: &[Vec3]) -> Vec3 {
    let start = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    let (lo, hi) = x.iter().fold(start, |(lo, hi), x| (lo.inf(x), hi.sup(x)));
    0.5 * (lo + hi)
}

/// Distance from the centre within which 995 of 1000 particles are, and a margin.
fn reach(x: &[Vec3], side: usize, centre: f64) -> f64 {
    let mut far: Vec<f64> = x.iter().map(|x| (x[side] - centre).abs()).collect();
    far.sort_unstable_by(f64::total_cmp);
    1.08 * far[(far.len() - 1) * 995 / 1000]
}

fn panel(contents: &Contents, group: &Particles, view: &View) -> (Vec<Plot>, Layout) {
    let length = |name| axis(name, Dimension::LENGTH, &contents.units);
    let names = ["x", "y", "z"];
    let (across, up) = (length(names[view.axes[0]]), length(names[view.axes[1]]));
    let scale = across.factor;
    let few = group.len() <= FEW && !group.more.contains_key("SmoothingLengths");
    let (mut plots, title) = if few {
        (vec![points(group, view, scale)], "positions".to_owned())
    } else {
        let density = axis(
            "log column density",
            Dimension::SURFACE_DENSITY,
            &contents.units,
        );
        (
            vec![shades(group, view, scale, density.factor)],
            density.text,
        )
    };
    let heavy = heavy_bodies(contents, view, scale);
    if !heavy.is_empty() {
        let color = if few { "#d62728" } else { "#4fc3f7" };
        plots.push(Plot::Scatter(
            ScatterPlot::new()
                .with_data(heavy)
                .with_color(color)
                .with_size(3.5),
        ));
    }
    let mut layout = Layout::auto_from_plots(&plots)
        .with_title(title)
        .with_title_size(15)
        .with_x_label(across.text)
        .with_y_label(up.text)
        .with_show_grid(false)
        .with_box_axes()
        .with_x_axis_min(scale * view.lo[0])
        .with_x_axis_max(scale * view.hi[0])
        .with_y_axis_min(scale * view.lo[1])
        .with_y_axis_max(scale * view.hi[1]);
    let sides = [0, 1].map(|side| view.hi[side] - view.lo[side]);
    // The panels of shades are square by their size.
    if few && (sides[0] / sides[1] - 1.0).abs() < 0.5 {
        layout = layout.with_equal_aspect();
    }
    (plots, layout)
}

fn points(group: &Particles, view: &View, scale: f64) -> Plot {
    let places = group
        .x
        .iter()
        .map(|x| (scale * x[view.axes[0]], scale * x[view.axes[1]]));
    let inside = |(a, b): &(f64, f64)| {
        (scale * view.lo[0]..scale * view.hi[0]).contains(a)
            && (scale * view.lo[1]..scale * view.hi[1]).contains(b)
    };
    let places: Vec<_> = places.filter(inside).collect();
    Plot::Scatter(
        ScatterPlot::new()
            .with_data(places)
            .with_color("#33415c")
            .with_size(1.3),
    )
}

fn shades(group: &Particles, view: &View, scale: f64, factor: f64) -> Plot {
    Plot::Heatmap(
        Heatmap::new()
            .with_data(logarithm(&column_density(group, view), factor))
            .with_color_map(ColorMap::Inferno)
            .with_x_range(scale * view.lo[0], scale * view.hi[0])
            .with_y_range(scale * view.lo[1], scale * view.hi[1])
            .with_cell_size(1.0),
    )
}

/// Star and planets: bodies a hundred times as heavy as the middling one, if they lie in the view.
fn heavy_bodies(contents: &Contents, view: &View, scale: f64) -> Vec<(f64, f64)> {
    let mut places: Vec<Vec3> = star(contents).iter().map(|(x, ..)| *x).collect();
    if let Some(bodies) = contents.group(1) {
        let mut sorted = bodies.m.clone();
        sorted.sort_unstable_by(f64::total_cmp);
        let middling = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
        let few = bodies.len() < 20;
        let heavy = bodies
            .x
            .iter()
            .zip(&bodies.m)
            .filter(|(_, m)| few || **m > 100.0 * middling);
        places.extend(heavy.map(|(x, _)| *x));
    }
    places
        .iter()
        .filter(|x| view.place(x).iter().all(|&c| c >= 0.0 && c < CELLS as f64))
        .map(|x| (scale * x[view.axes[0]], scale * x[view.axes[1]]))
        .collect()
}

fn logarithm(columns: &[Vec<f64>], factor: f64) -> Vec<Vec<f64>> {
    let largest = columns.iter().flatten().copied().fold(0.0, f64::max);
    let floor = (largest * factor).log10() - DECADES;
    let log = |sigma: &f64| (sigma * factor).log10().max(floor);
    columns
        .iter()
        .map(|row| row.iter().map(log).collect())
        .collect()
}

/// Mass an area in each cell, row by row upwards.
fn column_density(group: &Particles, view: &View) -> Vec<Vec<f64>> {
    let lengths = group
        .more
        .get("SmoothingLengths")
        .filter(|h| h.iter().any(|&h| h > 0.0));
    let spacing = if lengths.is_none() {
        spacings(group, view)
    } else {
        Vec::new()
    };
    let area = view.cell(0) * view.cell(1);
    let mut columns = vec![vec![0.0; CELLS]; CELLS];
    for i in 0..group.len() {
        let width = match lengths {
            Some(h) => [0, 1].map(|side| SUPPORT * h[i] / view.cell(side)),
            None => [2.5 * spacing[i]; 2],
        };
        let width = width.map(|width| width.clamp(0.8, CELLS as f64));
        spread(
            &mut columns,
            view.place(&group.x[i]),
            width,
            group.m[i] / area,
        );
    }
    columns
}

/// Adds `amount`, spread over the cells within `width` cells of the place; all of it, whatever the width.
pub(crate) fn spread(columns: &mut [Vec<f64>], place: [f64; 2], width: [f64; 2], amount: f64) {
    let range = |side: usize| {
        let lo = (place[side] - width[side]).floor() as i64;
        let hi = (place[side] + width[side]).ceil() as i64;
        lo..=hi
    };
    let weight = |i: i64, j: i64| {
        let a = (i as f64 + 0.5 - place[0]) / width[0];
        let b = (j as f64 + 0.5 - place[1]) / width[1];
        let inside = (1.0 - a * a - b * b).max(0.0);
        inside * inside * inside
    };
    let mut sum = 0.0;
    for j in range(1) {
        for i in range(0) {
            sum += weight(i, j);
        }
    }
    if sum == 0.0 {
        return;
    }
    let cells = 0..CELLS as i64;
    for j in range(1).filter(|j| cells.contains(j)) {
        for i in range(0).filter(|i| cells.contains(i)) {
            columns[j as usize][i as usize] += amount * weight(i, j) / sum;
        }
    }
}

/// Distance between neighbours in the view in cells, from the counts in coarse cells.
fn spacings(group: &Particles, view: &View) -> Vec<f64> {
    const COARSE: usize = 40;
    let by = (CELLS / COARSE) as f64;
    let coarse = |x: &Vec3| {
        let place = view.place(x).map(|c| (c / by).floor() as i64);
        let inside = place.iter().all(|c| (0..COARSE as i64).contains(c));
        inside.then(|| place[1] as usize * COARSE + place[0] as usize)
    };
    let mut counts = vec![0u32; COARSE * COARSE];
    for x in &group.x {
        if let Some(cell) = coarse(x) {
            counts[cell] += 1;
        }
    }
    let spacing = |x: &Vec3| coarse(x).map_or(by, |cell| by / f64::from(counts[cell]).sqrt());
    group.x.iter().map(spacing).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_holds_the_mass_of_its_particles() {
        let view = View {
            axes: [0, 1],
            lo: [-1.0, -2.0],
            hi: [1.0, 2.0],
        };
        let mut group = Particles {
            x: vec![Vec3::new(0.1, 0.2, 0.0), Vec3::new(-0.5, 1.0, 3.0)],
            m: vec![1.0, 2.0],
            ..Particles::default()
        };
        for h in [0.0, 1e-6, 0.02, 0.2] {
            group.more.insert("SmoothingLengths", vec![h; 2]);
            let area = view.cell(0) * view.cell(1);
            let mass: f64 = column_density(&group, &view).iter().flatten().sum::<f64>() * area;
            assert!((mass - 3.0).abs() < 1e-12, "{h}: {mass}");
        }
    }
}
