//! Yee's isentropic vortex in the plane: T = 1 - (gamma - 1) beta^2 / (8 gamma pi^2) exp(1 - r^2), rho = T^(1 / (gamma - 1)), P = rho T,
//! v_phi = r beta / (2 pi) exp((1 - r^2) / 2), beta = 5, gamma = 1.4, in a periodic box of side 10, at t = 10.
//!
//! Particles on a square lattice have the masses of their cells. L1 of density is weighted by area.
//! Source: Yee, Sandham & Djomehri (1999), JCP 150, 199.

use std::f64::consts::{PI, TAU};

use gas::Particles;
use nbody::points::Vec3;

use super::picture::{Profile, profiles};
use super::{Bar, End, Row, Scheme, order};

const BETA: f64 = 5.0;
const GAMMA: f64 = 1.4;
const SIDE: f64 = 10.0;
/// Particles a side.
const NUMBERS: [u32; 3] = [32, 64, 128];

fn scene(n: u32) -> String {
    format!(
        "[run]\nend_time = 10\n[units]\nsystem = \"dimensionless\"\n[domain]\nkind = \"periodic\"\nsize = [{SIDE}, {SIDE}, {SIDE}]\n\
         dimensions = 2\n[[gas.block]]\nlo = [0, 0, 0]\nhi = [{SIDE}, {SIDE}, 0]\nlattice = \"cubic\"\nspacing = {}\ndensity = 1\n\
         pressure = 1\n[gas.eos]\ngamma = {GAMMA}\n",
        SIDE / f64::from(n)
    )
}

fn from_middle(x: Vec3) -> Vec3 {
    x - Vec3::new(0.5 * SIDE, 0.5 * SIDE, x.z)
}

fn temperature(r: f64) -> f64 {
    1.0 - (GAMMA - 1.0) * BETA * BETA / (8.0 * GAMMA * PI * PI) * (1.0 - r * r).exp()
}

fn density(r: f64) -> f64 {
    temperature(r).powf(1.0 / (GAMMA - 1.0))
}

fn speed(r: f64) -> f64 {
    r * BETA / TAU * (0.5 * (1.0 - r * r)).exp()
}

fn start(gas: &mut Particles) {
    for i in 0..gas.x.len() {
        let d = from_middle(gas.x[i]);
        let r = d.norm();
        gas.m[i] *= density(r);
        gas.u[i] = temperature(r) / (GAMMA - 1.0);
        gas.v[i] = Vec3::new(-d.y, d.x, 0.0) * (speed(r) / r);
    }
}

fn l1(end: &End) -> f64 {
    end.mean(|particle| Some((particle.rho - density(from_middle(particle.x).norm())).abs()))
}

pub fn of(scheme: &Scheme) -> Vec<Row> {
    let ends = NUMBERS.map(|n| scheme.end(&scene(n), 10.0, start));
    let errors = ends.each_ref().map(l1);
    let finest = &ends[2];
    profiles(scheme, "gas-yee", "Yee's vortex", || {
        let radii = || (0..=200).map(|k| 0.025 * f64::from(k));
        let near = || {
            finest
                .gas
                .iter()
                .map(|p| (from_middle(p.x), p))
                .filter(|(d, _)| d.norm() < 5.0)
        };
        let around = |d: Vec3, v: Vec3| (d.x * v.y - d.y * v.x) / d.norm();
        vec![
            Profile {
                axes: ["r", "density"],
                points: near().map(|(d, p)| (d.norm(), p.rho)).collect(),
                exact: radii().map(|r| (r, density(r))).collect(),
            },
            Profile {
                axes: ["r", "circular velocity"],
                points: near().map(|(d, p)| (d.norm(), around(d, p.v))).collect(),
                exact: radii().map(|r| (r, speed(r))).collect(),
            },
        ]
    });
    let entropy =
        finest.mean(|p| Some(((GAMMA - 1.0) * p.u * p.rho.powf(1.0 - GAMMA) - 1.0).abs()));
    vec![
        Row::new(
            "L1 of density, 64 a side",
            errors[1],
            Bar::Limit([0.002, 0.008]),
        ),
        Row::new(
            "L1 of density, 128 a side",
            errors[2],
            Bar::Limit([0.0006, 0.005]),
        ),
        Row::new(
            "order of L1 of density",
            order(&NUMBERS.map(f64::from), &errors),
            Bar::Least([1.8, 0.7]),
        ),
        Row::new("mean |P / rho^gamma - 1|", entropy, Bar::None),
        finest.energy_error(),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pressure_holds_the_vortex() {
        let pressure = |r: f64| density(r) * temperature(r);
        for r in [0.3, 1.0, 1.7, 3.0] {
            let slope = (pressure(r + 1e-5) - pressure(r - 1e-5)) / 2e-5;
            assert!(
                (slope - density(r) * speed(r).powi(2) / r).abs() < 1e-8,
                "at {r}"
            );
        }
        // The reference table's middle.
        assert!((density(0.0) - 0.493_807_323_895).abs() < 1e-11);
    }
}
