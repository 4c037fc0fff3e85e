//! Settling: single grains in a thin disk that is a formula, and a layer in a disk of gas particles.
//!
//! Constant St: z'' + z' Omega/St + Omega^2 z = 0. Epstein's law in Gaussian gas, at the terminal speed: 2 St_0 t = E1(z^2/2H^2) - E1(z_0^2/2H^2).
//! The figures of reference are those of both solutions, from an integration in quadruple precision; H/R = 0.01, so that corrections of the
//! star's field are below 1e-3. The layer: 60 000 gas particles, H/R = 0.05, grains of St = 0.1 from a third of the gas's height on; what of the
//! solution at each grain's own Omega is in its z (least squares), and how far it is spread beside that by the noise of the gas.
//! Sources: Dubrulle, Morfill & Sterzik (1995, Icarus 114, 237); Takeuchi & Lin (2002, ApJ 581, 1344).

use std::collections::HashMap;

use nbody::points::Vec3;

use super::{Bar, Row};
use crate::trial::Trial;

/// A grain at R = 1 in a disk of H/R = 0.01.
const GRAIN: &str = r#"
[run]
end_time = 1000.0
[units]
system = "dimensionless"
[star]
mass = 1.0
[surroundings.disk]
surface_density = 1.0
surface_density_slope = -1.0
reference_radius = 1.0
aspect_ratio = 0.01
flaring = 0.0
inner_radius = 0.5
outer_radius = 2.0
[dust]
particles = 1
mass = 1e-12
size = 1.0
[accuracy]
preset = "precise"
"#;

const H: f64 = 0.01;

/// Heights, in scale heights, of a grain that starts at rest at `z0` of them, at `times`.
fn heights(drag: &[String], z0: f64, times: &[f64]) -> Vec<f64> {
    let mut trial = Trial::new(GRAIN, drag, |_| {}).expect("a scene");
    let dust = &mut trial.system.dust;
    dust.particles.x[0] = Vec3::new(1.0, 0.0, z0 * H);
    dust.particles.v[0] = Vec3::y();
    dust.rates.v_pred[0] = Vec3::y();
    let mut found = Vec::new();
    let stops: Vec<f64> = std::iter::once(0.0).chain(times.iter().copied()).collect();
    let done = trial.run(&stops, |stop| {
        found.push(stop.system.dust.particles.x[0].z / H);
    });
    done.expect("a run");
    found.split_off(1)
}

fn constant(stokes: f64) -> Vec<String> {
    vec![
        "dust.drag.law=\"constant-stokes-number\"".to_owned(),
        format!("dust.drag.stokes_number={stokes}"),
    ]
}

const TIMES: [f64; 4] = [1.0, 5.0, 20.0, 100.0];

/// St, and z/z0 at Omega t of [`TIMES`].
const OSCILLATOR: [(f64, [f64; 4]); 4] = [
    (
        0.01,
        [
            0.990147878097,
            0.951319818427,
            0.818796271358,
            0.367879443012,
        ],
    ),
    (
        0.1,
        [
            0.913233658133,
            0.609665399121,
            0.133968214171,
            4.14180463666e-5,
        ],
    ),
    (
        1.0,
        [0.659700153392, -0.074590566595, -2.42939948036e-5, 0.0],
    ),
    (
        10.0,
        [
            0.554991720618,
            0.178785806299,
            0.175099223182,
            0.00513347037504,
        ],
    ),
];

/// St in the midplane, z0, times, heights.
const GAUSSIAN: [(f64, f64, [f64; 3], [f64; 3]); 2] = [
    (
        0.01,
        1.0,
        [10.0, 50.0, 100.0],
        [0.857542245904, 0.518447779898, 0.301353053035],
    ),
    (
        0.001,
        2.5,
        [10.0, 100.0, 500.0],
        [2.15964962171, 1.43033801061, 0.722398729783],
    ),
];

/// z/z0 of a grain of constant St at rest at the start.
pub(super) fn oscillator(stokes: f64, t: f64) -> f64 {
    let a = 0.5 / stokes;
    let q = (a * a - 1.0).abs().sqrt();
    if a > 1.0 {
        0.5 * ((1.0 + a / q) * (-t / (a + q)).exp() + (1.0 - a / q) * (-(a + q) * t).exp())
    } else {
        (-a * t).exp() * ((q * t).cos() + a / q * (q * t).sin())
    }
}

/// The part of H by which heights may be off.
const PART: [f64; 2] = [0.01, 0.03];

fn formula_rows() -> Vec<Row> {
    let mut rows = Vec::new();
    let mut add = |what: String, found: f64, exact: f64| {
        // Relative errors of heights that there still are; of the rest the absolute one.
        rows.push(if exact.abs() > 0.1 {
            let bar = Bar::Reference {
                value: exact,
                good: PART[0],
                acceptable: PART[1],
            };
            Row::new(what, found, bar)
        } else {
            let what = format!("{what}, error by z0");
            Row::new(what, found - exact, Bar::Limit([1e-3, 3e-3]))
        });
    };
    for (stokes, exact) in OSCILLATOR {
        let found = heights(&constant(stokes), 1.0, &TIMES);
        for ((t, found), exact) in TIMES.iter().zip(found).zip(exact) {
            add(format!("St = {stokes}, Omega t = {t}: z/z0"), found, exact);
        }
    }
    for (stokes, z0, times, exact) in GAUSSIAN {
        // St = (pi/2) s rho_s / Sigma.
        let density = stokes * 2.0 / std::f64::consts::PI;
        let law = [
            "dust.drag.law=\"epstein\"".to_owned(),
            format!("dust.material_density={density}"),
        ];
        let found = heights(&law, z0, &times);
        for ((t, found), exact) in times.iter().zip(found).zip(exact) {
            let what = format!("Epstein, St = {stokes} in the midplane, Omega t = {t}: z/H");
            add(what, found, exact);
        }
    }
    rows
}

/// A disk of gas particles with a layer of grains of St = 0.1 that feel no mass but the star's.
pub(super) const LAYER: &str = r#"
[run]
end_time = 100.0
[units]
system = "dimensionless"
[star]
mass = 1.0
[gas]
particles = 20000
[gas.disk]
surface_density = 1e-4
slope = -1.0
reference_radius = 1.0
inner_radius = 0.7
outer_radius = 1.5
[gas.eos]
kind = "locally-isothermal"
aspect_ratio = 0.05
exponent = 0.5
reference_radius = 1.0
[dust]
particles = 4000
dust_to_gas = 1e-6
scale_height = 0.33
inner_radius = 0.95
outer_radius = 1.15
[dust.drag]
law = "constant-stokes-number"
stokes_number = 0.1
[coupling]
feedback = false
[gravity]
pulls = { gas = [], dust = [] }
"#;

fn layer_rows() -> Vec<Row> {
    let finer = ["gas.particles=60000".to_owned()];
    let mut trial = Trial::new(LAYER, &finer, |_| {}).expect("a scene");
    let mut start: HashMap<u64, Vec3> = HashMap::new();
    let mut rows = Vec::new();
    let done = trial.run(&[0.0, 2.5, 5.0], |stop| {
        let p = &stop.system.dust.particles;
        if start.is_empty() {
            start.extend(p.id.iter().copied().zip(p.x.iter().copied()));
            return;
        }
        let t = stop.books.time;
        let [mut product, mut square, mut found] = [0.0; 3];
        for (id, x) in p.id.iter().zip(&p.x) {
            let from = start[id];
            let exact = from.z * oscillator(0.1, from.norm().powf(-1.5) * t);
            product += x.z * exact;
            square += exact * exact;
            found += x.z * x.z;
        }
        let bar = Bar::Reference {
            value: 1.0,
            good: 0.03,
            acceptable: 0.05,
        };
        let what = format!("layer in gas particles, Omega t = {t}: z by the exact one");
        rows.push(Row::new(what, product / square, bar));
        let spread = ((found - product * product / square) / p.x.len() as f64).sqrt();
        let what = format!("layer in gas particles, Omega t = {t}: spread beside it, by H");
        rows.push(Row::new(what, spread / 0.05, Bar::None));
    });
    done.expect("a run");
    rows
}

pub fn rows() -> Vec<Row> {
    let mut rows = formula_rows();
    rows.extend(layer_rows());
    rows
}
