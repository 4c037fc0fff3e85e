//! A disk without self-gravity through three orbits of its inner edge: 1e5 particles, 10 to 100 au, H/R = 0.05 at 10 au.
//!
//! Rings of equal width in R. Change of the surface density: |Sigma / Sigma_0 - 1|, averaged over the rings. Thickness: the root of the mean
//! of z^2 of a ring by H (1 + 9/4 (H/R)^2), H = c_s / Omega at its radius: exp((1/sqrt(1 + z^2/R^2) - 1) / (H/R)^2), the atmosphere in a
//! star's whole pull, is that much (1.8 % in the last ring) thicker than a Gaussian of H.
//!
//! Twice: with the scene's cubic spline and open edge, as others ran it, and with what keeps such a disk quiet: a wide kernel, Balsara's
//! switch, and an inner edge that is held.

use std::f64::consts::TAU;

use coupling::System;

use super::{Bar, Row};
use crate::trial::Trial;

const SCENE: &str = include_str!("../../../tests/benches/wide-disk.toml");
const RINGS: usize = 18;
const INNER: f64 = 10.0;
const OUTER: f64 = 100.0;
/// H/R = 0.05 (R / 10)^0.25.
const ASPECT: f64 = 0.05;
/// What keeps the disk quiet.
const QUIET: [&str; 4] = [
    "gas.hydro.kernel=\"wendland-c4\"",
    "gas.hydro.neighbours=120",
    "gas.viscosity.kind=\"balsara\"",
    "gas.edge={ inner = \"supported\", inner_radius = \"13 au\", time = 0.1 }",
];

pub fn rows() -> Vec<Row> {
    let mut rows = disk("quiet", &QUIET.map(str::to_owned));
    rows.extend(disk("plain", &[]));
    rows
}

/// The disk with these keys instead of the scene's.
fn disk(name: &str, keys: &[String]) -> Vec<Row> {
    let trial = Trial::new(SCENE, keys, |_| {});
    let mut trial = trial.unwrap_or_else(|refusal| panic!("a built-in scene: {refusal}"));
    let orbit = TAU * INNER.powf(1.5);
    let stops: Vec<f64> = (0..=12).map(|k| 0.25 * f64::from(k) * orbit).collect();
    let (mut start, mut last) = (Vec::new(), Vec::new());
    let (mut thin, mut thick, mut angular) = ([f64::INFINITY; RINGS], [0.0f64; RINGS], 0.0);
    let done = trial.run(&stops, |stop| {
        let rings = rings(stop.system);
        for (k, ring) in rings.iter().enumerate() {
            thin[k] = thin[k].min(ring.thickness);
            thick[k] = thick[k].max(ring.thickness);
        }
        let masses: Vec<f64> = rings.iter().map(|ring| ring.mass).collect();
        if start.is_empty() {
            start.clone_from(&masses);
        }
        last = masses;
        angular = stop.books.error_angular_momentum;
    });
    done.unwrap_or_else(|fault| panic!("a built-in problem: {fault}"));
    let changes: Vec<f64> = (start.iter().zip(&last))
        .map(|(before, after)| (after / before - 1.0).abs())
        .collect();
    let row = |what: &str, measured, bar| Row {
        what: format!("{name}: {what}"),
        measured,
        uncertainty: 0.0,
        bar,
    };
    let mean = |changes: &[f64]| changes.iter().sum::<f64>() / changes.len() as f64;
    let about_one = Bar::Reference {
        value: 1.0,
        good: 0.03,
        acceptable: 0.12,
    };
    // Phantom: 3.6e-6, 1.35 %, 40 % and 1.12 in 202 CPU s.
    vec![
        row(
            "error of the angular momentum",
            angular,
            Bar::Limit([1e-7, 3.6e-6]),
        ),
        row(
            "mean change of surface density",
            mean(&changes),
            Bar::Limit([0.01, 0.0135]),
        ),
        row(
            "the same without the first and the last ring",
            mean(&changes[1..RINGS - 1]),
            Bar::Limit([0.01, 0.0135]),
        ),
        row(
            "change in the first ring",
            changes[0],
            Bar::Limit([0.1, 0.4]),
        ),
        row("change in the last ring", changes[RINGS - 1], Bar::None),
        row(
            "largest z/H of a ring",
            thick.iter().copied().fold(0.0, f64::max),
            about_one,
        ),
        row(
            "least z/H of a ring",
            thin.iter().copied().fold(f64::INFINITY, f64::min),
            about_one,
        ),
        row(
            "largest z/H but for the first and the last ring",
            thick[1..RINGS - 1].iter().copied().fold(0.0, f64::max),
            about_one,
        ),
        row(
            "least z/H but for the first and the last ring",
            thin[1..RINGS - 1]
                .iter()
                .copied()
                .fold(f64::INFINITY, f64::min),
            about_one,
        ),
        row("CPU time, s", trial.cpu_s(), Bar::None),
        row(
            "CPU time an update, us",
            trial.cpu_s() / trial.updates() as f64 * 1e6,
            Bar::None,
        ),
    ]
}

/// What is in a ring.
#[derive(Clone, Copy, Default)]
struct Ring {
    mass: f64,
    thickness: f64,
}

fn rings(system: &System) -> [Ring; RINGS] {
    let gas = &system.gas.particles;
    let star = system.star.x[0];
    let mut rings = [Ring::default(); RINGS];
    for (x, m) in gas.x.iter().zip(&gas.m) {
        let d = x - star;
        let r = d.xy().norm();
        let place = (r - INNER) / (OUTER - INNER) * RINGS as f64;
        if (0.0..RINGS as f64).contains(&place) {
            let ring = &mut rings[place as usize];
            let aspect = ASPECT * (r / INNER).powf(0.25);
            let h = aspect * r * (1.0 + 2.25 * aspect * aspect);
            ring.mass += m;
            ring.thickness += m * (d.z / h).powi(2);
        }
    }
    rings.map(|ring| Ring {
        thickness: (ring.thickness / ring.mass).sqrt(),
        ..ring
    })
}
