//! Profiles: means over rings about the star, or over slices of a scene without one.

use std::path::{Path, PathBuf};

use kuva::prelude::{Layout, LegendPosition, LinePlot, Plot};
use nbody::points::{Dimension, Vec3};

use super::{axis, caption, save, star};
use crate::snapshot::{Contents, Particles};

const BINS: usize = 60;
const COLORS: [(usize, &str, &str); 3] = [
    (0, "gas", "#1f77b4"),
    (2, "dust", "#d62728"),
    (1, "planetesimals", "#2ca02c"),
];

pub fn picture(contents: &Contents, path: &Path) -> Result<Option<PathBuf>, String> {
    let panels = match star(contents) {
        Some((x, v, m)) => about_star(contents, x, v, gravity(contents) * m),
        None => along_box(contents),
    };
    let panels: Vec<_> = panels.into_iter().flatten().collect();
    if panels.is_empty() {
        return Ok(None);
    }
    let columns = panels.len();
    save(panels, columns, &caption(contents, "profiles"), path).map(Some)
}

/// G in code units: that of the scene which the snapshot holds, or of its units.
fn gravity(contents: &Contents) -> f64 {
    let scene = contents
        .scene
        .as_deref()
        .and_then(|text| crate::scene::Scene::parse(text, "", Path::new("."), &[]).ok());
    scene.map_or_else(
        || contents.units.gravitational_constant(),
        |scene| scene.gravity.constant,
    )
}

type Panel = (Vec<Plot>, Layout);
type Curve = Vec<(f64, f64)>;

fn panel(curves: Vec<(Curve, &str, &str)>, x: String, y: String, logs: [bool; 2]) -> Option<Panel> {
    let shown = |(x, y): &(f64, f64)| {
        x.is_finite() && y.is_finite() && (!logs[0] || *x > 0.0) && (!logs[1] || *y > 0.0)
    };
    let mut range = [(f64::INFINITY, f64::NEG_INFINITY); 2];
    let mut plots = Vec::new();
    for (curve, name, color) in curves {
        let curve: Curve = curve.into_iter().filter(shown).collect();
        if curve.len() < 2 {
            continue;
        }
        for (x, y) in &curve {
            range[0] = (range[0].0.min(*x), range[0].1.max(*x));
            range[1] = (range[1].0.min(*y), range[1].1.max(*y));
        }
        let line = LinePlot::new().with_data(curve).with_color(color);
        plots.push(Plot::Line(line.with_stroke_width(2.0).with_legend(name)));
    }
    if plots.is_empty() {
        return None;
    }
    let mut layout = Layout::auto_from_plots(&plots)
        .with_x_label(x)
        .with_y_label(y)
        .with_box_axes()
        .with_legend_position(LegendPosition::OutsideBottomCenter);
    if logs[0] {
        let (lo, hi) = range[0];
        layout = layout
            .with_log_x()
            .with_x_axis_min(lo / 1.05)
            .with_x_axis_max(hi * 1.05);
    }
    if logs[1] {
        let (lo, hi) = range[1];
        layout = layout
            .with_log_y()
            .with_y_axis_min(lo / 1.5)
            .with_y_axis_max(hi * 1.5);
    }
    Some((plots, layout))
}

/// Rings, equal in the logarithm of the radius, between which all populations lie.
struct Rings {
    lo: f64,
    hi: f64,
}

impl Rings {
    fn around(contents: &Contents, centre: Vec3) -> Option<Self> {
        let mut radii: Vec<f64> = COLORS
            .iter()
            .filter_map(|(part_type, ..)| contents.group(*part_type))
            .flat_map(|group| group.x.iter().map(|x| (x - centre).xy().norm()))
            .filter(|r| *r > 0.0)
            .collect();
        radii.sort_unstable_by(f64::total_cmp);
        let last = radii.len().checked_sub(1)?;
        let (lo, hi) = (radii[last / 500], radii[last - last / 500]);
        (hi > lo).then_some(Self { lo, hi })
    }

    fn edge(&self, i: usize) -> f64 {
        self.lo * (self.hi / self.lo).powf(i as f64 / BINS as f64)
    }

    fn middle(&self, i: usize) -> f64 {
        (self.edge(i) * self.edge(i + 1)).sqrt()
    }

    fn ring(&self, r: f64) -> Option<usize> {
        let place = (r / self.lo).ln() / (self.hi / self.lo).ln() * BINS as f64;
        (place >= 0.0 && place < BINS as f64).then_some(place as usize)
    }

    /// Mass-weighted sum of `value` in each ring, and the mass and number there.
    fn sums(&self, group: &Particles, centre: Vec3, value: impl Fn(usize) -> f64) -> Vec<[f64; 3]> {
        let mut sums = vec![[0.0; 3]; BINS];
        for i in 0..group.len() {
            if let Some(ring) = self.ring((group.x[i] - centre).xy().norm()) {
                sums[ring][0] += group.m[i] * value(i);
                sums[ring][1] += group.m[i];
                sums[ring][2] += 1.0;
            }
        }
        sums
    }

    /// Root of the mean of `value` in the rings that hold a few particles.
    fn root_mean(&self, group: &Particles, centre: Vec3, value: impl Fn(usize) -> f64) -> Curve {
        let sums = self.sums(group, centre, value);
        (0..BINS)
            .filter(|&i| sums[i][2] >= 4.0 && sums[i][1] > 0.0)
            .map(|i| (self.middle(i), (sums[i][0] / sums[i][1]).sqrt()))
            .collect()
    }
}

fn about_star(contents: &Contents, x: Vec3, v: Vec3, gm: f64) -> Vec<Option<Panel>> {
    let Some(rings) = Rings::around(contents, x) else {
        return Vec::new();
    };
    let length = axis("r", Dimension::LENGTH, &contents.units);
    let sigma = axis("Σ", Dimension::SURFACE_DENSITY, &contents.units);
    let (mut density, mut thickness, mut shape) = (Vec::new(), Vec::new(), Vec::new());
    let scaled = |curve: Curve, factor: f64| -> Curve {
        curve
            .iter()
            .map(|(r, y)| (r * length.factor, y * factor))
            .collect()
    };
    for (part_type, name, color) in COLORS {
        let Some(group) = contents
            .group(part_type)
            .map(small)
            .filter(|group| group.len() > 1)
        else {
            continue;
        };
        let group = &group;
        density.push((
            scaled(surface_density(&rings, group, x), sigma.factor),
            name,
            color,
        ));
        let height = rings.root_mean(group, x, |i| {
            let d = group.x[i] - x;
            (d.z / d.xy().norm()).powi(2)
        });
        thickness.push((scaled(height, 1.0), name, color));
        if part_type == 1 {
            let orbit = |i: usize| eccentricity_inclination(group.x[i] - x, group.v[i] - v, gm);
            let e = rings.root_mean(group, x, |i| orbit(i)[0].powi(2));
            let inclination = rings.root_mean(group, x, |i| orbit(i)[1].powi(2));
            shape.push((scaled(e, 1.0), "eccentricity", "#9467bd"));
            shape.push((scaled(inclination, 1.0), "inclination [rad]", "#8c564b"));
        }
    }
    vec![
        panel(density, length.text.clone(), sigma.text, [true, true]),
        panel(
            thickness,
            length.text.clone(),
            "rms z / r".into(),
            [true, true],
        ),
        panel(
            shape,
            length.text,
            "rms of planetesimals".into(),
            [true, true],
        ),
    ]
}

/// Without planets: bodies a hundred times as heavy as the middling one.
fn small(group: &Particles) -> Particles {
    let mut sorted = group.m.clone();
    sorted.sort_unstable_by(f64::total_cmp);
    let bar = 100.0 * sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
    let kept: Vec<usize> = (0..group.len()).filter(|&i| group.m[i] <= bar).collect();
    Particles {
        part_type: group.part_type,
        x: kept.iter().map(|&i| group.x[i]).collect(),
        v: kept.iter().map(|&i| group.v[i]).collect(),
        m: kept.iter().map(|&i| group.m[i]).collect(),
        ..Particles::default()
    }
}

fn surface_density(rings: &Rings, group: &Particles, centre: Vec3) -> Curve {
    let sums = rings.sums(group, centre, |_| 1.0);
    (0..BINS)
        .map(|i| {
            let area = std::f64::consts::PI * (rings.edge(i + 1).powi(2) - rings.edge(i).powi(2));
            (rings.middle(i), sums[i][1] / area)
        })
        .collect()
}

fn eccentricity_inclination(x: Vec3, v: Vec3, gm: f64) -> [f64; 2] {
    let l = x.cross(&v);
    let e = v.cross(&l) / gm - x / x.norm();
    [e.norm(), l.xy().norm().atan2(l.z)]
}

/// Means over slices along the longest side.
fn along_box(contents: &Contents) -> Vec<Option<Panel>> {
    let all = || contents.groups.iter().flat_map(|group| &group.x);
    let start = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    let (lo, hi) = all().fold(start, |(lo, hi), x| (lo.inf(x), hi.sup(x)));
    if all().count() < 2 {
        return Vec::new();
    }
    let side = (hi - lo).imax();
    let mean = |group: &Particles, value: &dyn Fn(usize) -> f64| -> Curve {
        let mut sums = vec![[0.0; 2]; BINS];
        let width = (hi[side] - lo[side]) / BINS as f64;
        for i in 0..group.len() {
            let slice = (((group.x[i][side] - lo[side]) / width) as usize).min(BINS - 1);
            sums[slice][0] += value(i);
            sums[slice][1] += 1.0;
        }
        (0..BINS)
            .filter(|&i| sums[i][1] > 0.0)
            .map(|i| (lo[side] + (i as f64 + 0.5) * width, sums[i][0] / sums[i][1]))
            .collect()
    };
    let names = ["x", "y", "z"];
    let length = axis(names[side], Dimension::LENGTH, &contents.units);
    let quantities = [
        ("Densities", "density", Dimension::DENSITY),
        ("Pressures", "pressure", Dimension::PRESSURE),
    ];
    let scaled = |curve: Curve, factor: f64| -> Curve {
        curve
            .iter()
            .map(|(x, y)| (x * length.factor, y * factor))
            .collect()
    };
    let groups = || {
        COLORS.iter().filter_map(|&(part_type, name, color)| {
            contents
                .group(part_type)
                .filter(|group| !group.is_empty())
                .map(|group| (group, name, color))
        })
    };
    let mut panels = Vec::new();
    for (column, name, dimension) in quantities {
        let axis = axis(name, dimension, &contents.units);
        let curves = groups()
            .filter_map(|(group, name, color)| {
                let values = group.more.get(column)?;
                Some((
                    scaled(mean(group, &|i| values[i]), axis.factor),
                    name,
                    color,
                ))
            })
            .collect();
        panels.push(panel(
            curves,
            length.text.clone(),
            axis.text,
            [false, false],
        ));
    }
    let axis = axis(
        &format!("velocity along {}", names[side]),
        Dimension::VELOCITY,
        &contents.units,
    );
    let curves = groups()
        .map(|(group, name, color)| {
            (
                scaled(mean(group, &|i| group.v[i][side]), axis.factor),
                name,
                color,
            )
        })
        .collect();
    panels.push(panel(
        curves,
        length.text.clone(),
        axis.text,
        [false, false],
    ));
    panels
}
