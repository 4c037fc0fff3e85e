//! A sound wave of amplitude 0.001 that runs once through a periodic box, gamma = 5/3, c = 1.
//!
//! A simple wave: u(x, t) = A sin k(x - (1 + (gamma + 1)/2 u) t), rho = (1 + (gamma - 1)/2 u)^(2 / (gamma - 1)), of one entropy, so that
//! steepening is no error. Phase speed and what is left of the amplitude by projection on sine and cosine; L1 of velocity by A.
//! Source: Landau & Lifshitz, Fluid Mechanics, section 101.

use std::f64::consts::TAU;

use gas::Particles;
use nbody::points::Vec3;

use super::picture::{Profile, profiles};
use super::{Bar, End, Row, Scheme, order, stretched};

const AMPLITUDE: f64 = 1e-3;
const GAMMA: f64 = 5.0 / 3.0;
/// Cells of the body-centred lattice a wavelength: 32, 64 and 128 distances of a cubic one.
const CELLS: [u32; 3] = [25, 51, 102];
const ACROSS: u32 = 8;

fn scene(cells: u32) -> String {
    let edge = 1.0 / f64::from(cells);
    let width = f64::from(ACROSS) * edge;
    format!(
        "[run]\nend_time = 1\n[units]\nsystem = \"dimensionless\"\n[domain]\nkind = \"periodic\"\nsize = [1, {width}, {width}]\n\
         [[gas.block]]\nlo = [0, 0, 0]\nhi = [1, {width}, {width}]\nlattice = \"bcc\"\nspacing = {}\ndensity = 1\npressure = {}\n\
         [gas.eos]\ngamma = {GAMMA}\n",
        edge * 0.5f64.cbrt(),
        1.0 / GAMMA
    )
}

fn density(u: f64) -> f64 {
    (1.0 + 0.5 * (GAMMA - 1.0) * u).powf(2.0 / (GAMMA - 1.0))
}

/// The velocity that solves the wave's equation.
fn velocity(x: f64, t: f64) -> f64 {
    (0..60).fold(0.0, |u, _| {
        AMPLITUDE * (TAU * (x - (1.0 + 0.5 * (GAMMA + 1.0) * u) * t)).sin()
    })
}

fn start(gas: &mut Particles) {
    let (place, mass) = stretched(|x| density(velocity(x, 0.0)));
    for i in 0..gas.x.len() {
        gas.x[i].x = place(gas.x[i].x);
        let u = velocity(gas.x[i].x, 0.0);
        gas.m[i] *= mass;
        gas.v[i] = Vec3::new(u, 0.0, 0.0);
        gas.u[i] = density(u).powf(GAMMA - 1.0) / (GAMMA * (GAMMA - 1.0));
    }
}

/// The wave's phase by a period, and its amplitude by that of the start.
fn mode(end: &End) -> [f64; 2] {
    let part = |f: fn(f64) -> f64| 2.0 * end.mean(|p| Some(p.v.x * f(TAU * p.x.x)));
    let (sine, cosine) = (part(f64::sin), part(f64::cos));
    [(-cosine).atan2(sine) / TAU, sine.hypot(cosine) / AMPLITUDE]
}

fn l1(end: &End) -> f64 {
    end.mean(|p| Some((p.v.x - velocity(p.x.x, 1.0)).abs())) / AMPLITUDE
}

pub fn of(scheme: &Scheme) -> Vec<Row> {
    let ends = CELLS.map(|cells| scheme.end(&scene(cells), 1.0, start));
    profiles(scheme, "gas-wave", "sound wave after one period", || {
        let profile = |end: &End| Profile {
            axes: ["x", "velocity / 0.001"],
            points: (end.gas.iter())
                .map(|p| (p.x.x, p.v.x / AMPLITUDE))
                .collect(),
            exact: (0..=200)
                .map(|k| 0.005 * f64::from(k))
                .map(|x| (x, velocity(x, 1.0) / AMPLITUDE))
                .collect(),
        };
        ends.iter().map(profile).collect()
    });
    let [phase, left] = mode(&ends[1]);
    let errors = ends.each_ref().map(l1);
    vec![
        Row::new(
            "phase speed, 64 a wavelength, error",
            phase,
            Bar::Limit([0.003, 0.02]),
        ),
        Row::new(
            "amplitude lost in a period, 64 a wavelength",
            1.0 - left,
            Bar::Limit([0.01, 0.1]),
        ),
        Row::new(
            "L1 of velocity by the amplitude, 64 a wavelength",
            errors[1],
            Bar::None,
        ),
        Row::new("the same, 128 a wavelength", errors[2], Bar::None),
        Row::new(
            "order of L1 of velocity",
            order(&CELLS.map(f64::from), &errors),
            Bar::None,
        ),
        ends[1].energy_error(),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_wave_obeys_the_equations_of_gas_of_one_entropy() {
        // d rho/dt + d(rho u)/dx = 0, du/dt + u du/dx + (1/rho) dP/dx = 0, to second order in d.
        let d = 1e-5;
        let slope = |f: &dyn Fn(f64) -> f64| (f(d) - f(-d)) / (2.0 * d);
        for (x, t) in [(0.1, 0.3), (0.45, 1.0), (0.8, 0.7)] {
            let rho = |x: f64, t: f64| density(velocity(x, t));
            let u = velocity(x, t);
            let mass = slope(&|s| rho(x, t + s)) + slope(&|s| rho(x + s, t) * velocity(x + s, t));
            let push = slope(&|s| rho(x + s, t).powf(GAMMA) / GAMMA) / rho(x, t);
            let momentum =
                slope(&|s| velocity(x, t + s)) + u * slope(&|s| velocity(x + s, t)) + push;
            assert!(
                mass.abs() < 1e-9 && momentum.abs() < 1e-9,
                "{mass:e} {momentum:e}"
            );
        }
    }
}
