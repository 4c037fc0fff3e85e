//! Radial drift: grains without weight in a disk that is a formula, over one orbit each, and a ring of them in a disk of gas particles.
//!
//! v_r = -2 eta v_K St / (1 + St^2), eta = h^2/2 (p + q/2 + 3/2), Sigma ~ r^-p, T ~ r^-q; to first order in eta. Among gas particles the gas
//! moves radially itself (artificial viscosity), so that of the grains against it is judged: v_r - u_r / (1 + St^2).
//! Sources: Weidenschilling (1977, MNRAS 180, 57); Nakagawa, Sekiya & Hayashi (1986, Icarus 67, 375).

use std::f64::consts::TAU;

use gas::probe::{Probe, Reach};
use nbody::points::Vec3;

use super::settling::LAYER;
use super::{Bar, Row};
use crate::trial::Trial;

const GRAIN: &str = r#"
[run]
end_time = 1e6
[units]
system = "dimensionless"
[star]
mass = 1.0
[surroundings.disk]
surface_density = 1.0
[dust]
particles = 1
mass = 1e-12
scale_height = 0.0
[dust.drag]
law = "constant-stokes-number"
"#;

/// r, h, p, q, St, and v_r of a grain without weight, G = M = 1.
const CASES: [[f64; 6]; 5] = [
    [1.0, 0.033, 1.5, 0.5, 1.0, -0.001769625],
    [1.0, 0.033, 1.5, 0.5, 0.01, -3.53889611039e-5],
    [5.0, 0.05, 1.0, 0.5, 0.1, -0.000304415194957],
    [30.0, 0.08, 1.0, 0.5, 0.1, -0.000318149076307],
    [1.0, 0.05, 1.0, 1.0, 0.1, -0.000742574257426],
];

fn reference(value: f64) -> Bar {
    Bar::Reference {
        value,
        good: 0.02,
        acceptable: 0.03,
    }
}

fn formula(&[r, h, p, q, stokes, exact]: &[f64; 6]) -> Row {
    let overrides = [
        format!("surroundings.disk.surface_density_slope={}", -p),
        format!("surroundings.disk.temperature_slope={}", -q),
        format!("surroundings.disk.aspect_ratio={h}"),
        format!("surroundings.disk.reference_radius={r}"),
        format!("surroundings.disk.inner_radius={}", 0.5 * r),
        format!("surroundings.disk.outer_radius={}", 2.0 * r),
        format!("dust.inner_radius={}", r * (1.0 - 1e-9)),
        format!("dust.outer_radius={}", r * (1.0 + 1e-9)),
        format!("dust.drag.stokes_number={stokes}"),
    ];
    let mut trial = Trial::new(GRAIN, &overrides, |_| {}).expect("a scene");
    let orbit = TAU * r.powf(1.5);
    let mut radii = Vec::new();
    let done = trial.run(&[0.0, orbit], |stop| {
        radii.push(stop.system.dust.particles.x[0].xy().norm());
    });
    done.expect("a run");
    let speed = (radii[1] - radii[0]) / orbit;
    // v_r ~ r^s: what it is at r of the mean over the way.
    let steep = 2.0 * 0.5 * (1.0 - q) - 0.5;
    let mean = (1.0 + 0.5 * (radii[1] / radii[0] - 1.0)).powf(steep);
    let what = format!("r = {r}, h = {h}, p = {p}, q = {q}, St = {stokes}: v_r");
    Row::new(what, speed / mean, reference(exact))
}

/// Mean radial speed of grains against the gas, and what theory says with the gas's own rotation.
fn among_particles() -> Row {
    const STOKES: f64 = 0.1;
    let overrides = ["dust.scale_height=0.1".to_owned()];
    let mut trial = Trial::new(LAYER, &overrides, |_| {}).expect("a scene");
    let neighbours = trial
        .scene
        .gas
        .as_ref()
        .map_or(64.0, |gas| gas.hydro.neighbours);
    let reach = Reach {
        neighbours,
        largest: 0.1,
    };
    let stops: Vec<f64> = (0..=20).map(|k| f64::from(k) * 0.1 * TAU).collect();
    let (mut found, mut exact) = (0.0, 0.0);
    let done = trial.run(&stops, |stop| {
        if stop.books.time < 0.99 * TAU {
            return;
        }
        let (system, mut probe) = (stop.system, Probe::default());
        let p = &system.dust.particles;
        for i in 0..p.x.len() {
            let x = p.x[i];
            let air = probe.sample(&system.gas, &system.domain, x, p.h[i], &reach);
            let r = x.xy().norm();
            let out = Vec3::new(x.x, x.y, 0.0) / r;
            let omega = x.norm().powf(-1.5);
            found += p.v[i].dot(&out) - air.v.dot(&out) / (1.0 + STOKES * STOKES);
            let along = Vec3::new(-out.y, out.x, 0.0);
            let headwind = omega * r - air.v.dot(&along);
            exact -= 2.0 * headwind * STOKES / (1.0 + STOKES * STOKES);
        }
    });
    done.expect("a run");
    let what = "St = 0.1 among 20 000 gas particles: v_r against the gas by the exact one";
    let bar = Bar::Reference {
        value: 1.0,
        good: 0.03,
        acceptable: 0.05,
    };
    Row::new(what, found / exact, bar)
}

pub fn rows() -> Vec<Row> {
    let mut rows: Vec<Row> = CASES.iter().map(formula).collect();
    rows.push(among_particles());
    rows
}
