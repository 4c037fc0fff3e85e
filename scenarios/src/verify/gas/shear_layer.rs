//! The smoothed Kelvin-Helmholtz instability of McNally, Lyra & Passy: density 1 : 2, v_x = 0.5 : -0.5, ramps of 0.025, P = 2.5, v_y = 0.01 sin 4 pi x.
//!
//! M(t) = 2 |<v_y exp(4 pi i x)>|, weighted by volume and exp(-4 pi |y - 1/4|), mirrored at y = 1/2. 24 576 and 55 296 particles of equal mass:
//! body-centred slabs of 12 cells of 1/32 and 1/48 stretched in y; and square lattices of up to 256 a side in the plane. Reference: a pseudo-spectral run of 512 modes
//! a side, good to 1e-3.
//! Source: McNally, Lyra & Passy (2012), ApJS 201, 18, equations 1 to 13.

use std::f64::consts::TAU;

use gas::Particles;
use nbody::points::Vec3;

use super::picture::{Window, maps};
use super::{Bar, End, Row, Scheme, order, stretched};

const CELLS: [u32; 2] = [32, 48];
const RAMP: f64 = 0.025;
/// M at times 1 and 1.5.
const TIMES: [f64; 2] = [1.0, 1.5];
const REFERENCE: [f64; 2] = [0.0474846605504, 0.147942929629];

fn scene(cells: u32) -> String {
    let edge = 1.0 / f64::from(cells);
    format!(
        "[run]\nend_time = 1.5\n[units]\nsystem = \"dimensionless\"\n[domain]\nkind = \"periodic\"\nsize = [1, 1, {0}]\n\
         [[gas.block]]\nlo = [0, 0, 0]\nhi = [1, 1, {0}]\nlattice = \"bcc\"\nspacing = {1}\ndensity = 1\npressure = 2.5\n\
         [gas.eos]\ngamma = 1.6666666666666667\n",
        12.0 * edge,
        edge * 0.5f64.cbrt()
    )
}

/// Particles a side in the plane.
const NUMBERS: [u32; 3] = [64, 128, 256];

fn plane(n: u32) -> String {
    format!(
        "[run]\nend_time = 1.5\n[units]\nsystem = \"dimensionless\"\n[domain]\nkind = \"periodic\"\nsize = [1, 1, 1]\n\
         dimensions = 2\n[[gas.block]]\nlo = [0, 0, 0]\nhi = [1, 1, 0]\nlattice = \"cubic\"\nspacing = {}\ndensity = 1\npressure = 2.5\n\
         [gas.eos]\ngamma = 1.6666666666666667\n",
        1.0 / f64::from(n)
    )
}

/// From `a` outside to `b` in the middle layer.
fn ramped(y: f64, a: f64, b: f64) -> f64 {
    // Distance from the middle line; both layers are mirror images.
    let inwards = 0.25 - (y - 0.5).abs();
    let step = 0.5 * (a - b) * (-inwards.abs() / RAMP).exp();
    if inwards < 0.0 { a - step } else { b + step }
}

fn density(y: f64) -> f64 {
    ramped(y, 1.0, 2.0)
}

fn start(gas: &mut Particles) {
    let (place, mass) = stretched(density);
    for i in 0..gas.x.len() {
        let y = place(gas.x[i].y);
        gas.x[i].y = y;
        gas.m[i] *= mass;
        gas.v[i] = Vec3::new(
            ramped(y, 0.5, -0.5),
            0.01 * (2.0 * TAU * gas.x[i].x).sin(),
            0.0,
        );
        gas.u[i] = 2.5 / (2.0 / 3.0 * density(y));
    }
    gas.h.fill(0.0);
}

fn mode(end: &End) -> f64 {
    let (mut sine, mut cosine, mut all) = (0.0, 0.0, 0.0);
    for p in &end.gas {
        let y = p.x.y.min(1.0 - p.x.y);
        let weight = p.volume() * (-2.0 * TAU * (y - 0.25).abs()).exp();
        let (s, c) = (2.0 * TAU * p.x.x).sin_cos();
        sine += weight * p.v.y * s;
        cosine += weight * p.v.y * c;
        all += weight;
    }
    2.0 * sine.hypot(cosine) / all
}

pub fn of(scheme: &Scheme) -> Vec<Row> {
    let slabs = CELLS.map(|cells| scheme.run(&scene(cells), &TIMES, start));
    let shown: Vec<_> = (slabs[0][1..].iter().zip(TIMES))
        .map(|(end, t)| (end, format!("density, t = {t}")))
        .collect();
    maps(scheme, "gas-kelvin-helmholtz", &shown, &Window::UNIT, |p| {
        p.rho
    });
    let row = |k: usize, end: &End, place: &str| {
        let bar = Bar::Reference {
            value: REFERENCE[k],
            good: 0.05,
            acceptable: 0.25,
        };
        let what = format!("amplitude M at t = {}, {place}", TIMES[k]);
        Row::new(what, mode(end), bar)
    };
    let mut rows = Vec::new();
    for slab in &slabs {
        let place = format!("{} particles", slab[0].gas.len());
        rows.extend([0, 1].map(|k| row(k, &slab[k + 1], &place)));
        rows.push(slab[2].energy_error());
    }
    let planes = NUMBERS.map(|n| scheme.run(&plane(n), &TIMES, start));
    for k in 0..2 {
        let place = format!("{} a side in the plane", NUMBERS[2]);
        rows.push(row(k, &planes[2][k + 1], &place));
    }
    for (k, time) in TIMES.iter().enumerate() {
        let error = |ends: &Vec<End>| (mode(&ends[k + 1]) - REFERENCE[k]).abs();
        let errors = planes.each_ref().map(error);
        rows.push(Row::new(
            format!("order of M at t = {time} in the plane"),
            order(&NUMBERS.map(f64::from), &errors),
            Bar::None,
        ));
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_layers_are_those_of_the_paper() {
        // Its equation 1, written out.
        let e = |d: f64| (d / RAMP).exp();
        for (y, rho) in [
            (0.1, 1.0 + 0.5 * e(-0.15)),
            (0.24, 1.0 + 0.5 * e(-0.01)),
            (0.3, 2.0 - 0.5 * e(-0.05)),
            (0.72, 2.0 - 0.5 * e(-0.03)),
            (0.8, 1.0 + 0.5 * e(-0.05)),
        ] {
            assert!((density(y) - rho).abs() < 1e-12, "{y}");
        }
    }
}
