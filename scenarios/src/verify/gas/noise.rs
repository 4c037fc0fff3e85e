//! Noise of particles in steady shear: what pair forces leave where they should cancel, and the energy that they pass about.
//!
//! A cube of isothermal gas in a Keplerian shearing box, c = rho = side = 1, from a glass: the exact forces are none. Of nine runs, three distances of
//! particles by three rates of shear S, means over the second of two orbits, dv = S h the difference of velocity across a particle:
//! - residual force   F = rms m |a|, a the acceleration by pairs
//! - velocity noise   rms |v'|, v' relative to the shear
//! - energy flux      F dv, what a residual force does between neighbours that pass each other; and rms m a.v', what it gives to noise and takes from it
//!
//! Their logarithms are fitted by planes in ln h and ln dv. There is no other speed than c, and no other length than h but the box's, so that at a
//! given dv / c the power of h is 2 of forces and fluxes and 0 of v', whatever makes the noise: that is judged. How they go with dv is
//! the question: Makino (2013, lecture slides) expects a flux of P h^2 dv, by forces P h^2 that do not know dv.

use coupling::System;
use gas::Particles;
use nalgebra::{Matrix3, Vector3};
use nbody::points::Vec3;
use nbody::points::random::Purpose;

use super::{Bar, Row, Scheme};
use crate::initial::lattice::Block;

/// Particles a side, and Omega.
const SIDES: [u32; 3] = [10, 14, 20];
const RATES: [f64; 3] = [0.5, 1.0, 2.0];
const SHEAR: f64 = 1.5;
/// Orbits, of which the second half is looked at, as often.
const ORBITS: f64 = 2.0;
const SAMPLES: usize = 20;

/// What the meter reads.
#[derive(Clone, Copy, Debug, Default)]
struct Noise {
    h: f64,
    dv: f64,
    force: f64,
    velocity: f64,
    power: f64,
}

impl Noise {
    fn of(system: &System) -> Self {
        let (p, domain) = (&system.gas.particles, &system.domain);
        let n = p.x.len() as f64;
        let rate = domain.shear_rate();
        let mut sums = [0.0; 4];
        for (i, a) in system.gas.rates.hydro.iter().enumerate() {
            let v = domain.relative(p.x[i], p.v[i]);
            let values = [
                p.h[i],
                (p.m[i] * a.norm()).powi(2),
                v.norm_squared(),
                (p.m[i] * a.dot(&v)).powi(2),
            ];
            for (sum, value) in sums.iter_mut().zip(values) {
                *sum += value / n;
            }
        }
        let [h, force, velocity, power] = sums;
        Self {
            h,
            dv: rate * h,
            force: force.sqrt(),
            velocity: velocity.sqrt(),
            power: power.sqrt(),
        }
    }

    fn mean(samples: &[Self]) -> Self {
        let mean =
            |of: fn(&Self) -> f64| samples.iter().map(of).sum::<f64>() / samples.len() as f64;
        Self {
            h: mean(|noise| noise.h),
            dv: mean(|noise| noise.dv),
            force: mean(|noise| noise.force),
            velocity: mean(|noise| noise.velocity),
            power: mean(|noise| noise.power),
        }
    }
}

fn scene(side: u32, rate: f64) -> String {
    format!(
        "[run]\nend_time = 1\n[units]\nsystem = \"dimensionless\"\n[domain]\nkind = \"shearing-box\"\nsize = [1, 1, 1]\nrate = {rate}\n\
         shear = {SHEAR}\n[[gas.block]]\nlo = [0, 0, 0]\nhi = [1, 1, 1]\nspacing = {}\ndensity = 1\n\
         [gas.eos]\nkind = \"isothermal\"\nsound_speed = 1\n",
        1.0 / f64::from(side)
    )
}

/// A glass at rest in the shear.
fn settle(gas: &mut Particles, side: u32, rate: f64) {
    let block = Block::new(Vec3::zeros(), Vec3::repeat(1.0));
    gas.x = block.glass(1.0 / f64::from(side), 1, Purpose::GasPositions);
    for (v, x) in gas.v.iter_mut().zip(&gas.x) {
        *v = Vec3::new(0.0, -SHEAR * rate * (x.x - 0.5), 0.0);
    }
}

/// The noise of the second half of a number of orbits.
fn measured(scheme: &Scheme, side: u32, rate: f64, orbits: f64) -> Noise {
    let mut trial = scheme.trial(&scene(side, rate), |gas| settle(gas, side, rate));
    let end = orbits * std::f64::consts::TAU / rate;
    let stop = |k: usize| 0.5 * end * (1.0 + k as f64 / SAMPLES as f64);
    let stops: Vec<f64> = std::iter::once(0.0)
        .chain((1..=SAMPLES).map(stop))
        .collect();
    let mut samples = Vec::new();
    let done = trial.run(&stops, |stop| samples.push(Noise::of(stop.system)));
    done.unwrap_or_else(|fault| panic!("a built-in problem: {fault}"));
    Noise::mean(&samples[1..])
}

/// Constant and slopes of z = a + b x + c y by least squares through (x, y, z), and the standard errors of both slopes.
fn plane(points: &[[f64; 3]]) -> ([f64; 3], [f64; 2]) {
    let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for &[x, y, z] in points {
        let row = Vector3::new(1.0, x, y);
        matrix += row * row.transpose();
        right += z * row;
    }
    let inverse = matrix.try_inverse().expect("points that span a plane");
    let fit = inverse * right;
    let rest = |[x, y, z]: &[f64; 3]| (z - fit[0] - fit[1] * x - fit[2] * y).powi(2);
    let variance = points.iter().map(rest).sum::<f64>() / (points.len() as f64 - 3.0);
    let error = |k: usize| (variance * inverse[(k, k)]).sqrt();
    ([fit[0], fit[1], fit[2]], [error(1), error(2)])
}

/// A quantity, and the power of h that it should have.
type Quantity = (&'static str, fn(&Noise) -> f64, f64);

const QUANTITIES: [Quantity; 4] = [
    ("residual force", |noise| noise.force, 2.0),
    ("velocity noise", |noise| noise.velocity, 0.0),
    ("energy flux F dv", |noise| noise.force * noise.dv, 2.0),
    ("energy flux rms m a.v'", |noise| noise.power, 2.0),
];

/// The powers of h and of dv that a quantity goes with.
fn powers(runs: &[Noise], (name, of, in_h): Quantity) -> [Row; 2] {
    let point = |noise: &Noise| [noise.h, noise.dv, of(noise)].map(f64::ln);
    let (fit, errors) = plane(&runs.iter().map(point).collect::<Vec<_>>());
    let row = |what: &str, measured, uncertainty, bar| Row {
        uncertainty,
        ..Row::new(format!("{name}: power of {what}"), measured, bar)
    };
    let off = format!("h, less {in_h}");
    [
        row(&off, fit[1] - in_h, errors[0], Bar::Limit([0.2, 0.4])),
        row("dv", fit[2], errors[1], Bar::None),
    ]
}

/// Prints the table of runs.
pub fn of(scheme: &Scheme) -> Vec<Row> {
    println!("| h | dv / c | F by P h^2 | rms v' by dv | rms m a.v' by P h^2 dv |");
    println!("| --- | --- | --- | --- | --- |");
    let cases = (SIDES.into_iter()).flat_map(|side| RATES.map(|rate| (side, rate)));
    let runs: Vec<Noise> = cases
        .map(|(side, rate)| {
            let noise = measured(scheme, side, rate, ORBITS);
            let force = noise.h * noise.h;
            println!(
                "| {:.4} | {:.4} | {:.4} | {:.3} | {:.4} |",
                noise.h,
                noise.dv,
                noise.force / force,
                noise.velocity / noise.dv,
                noise.power / (force * noise.dv)
            );
            noise
        })
        .collect();
    let rows = QUANTITIES.map(|quantity| powers(&runs, quantity));
    rows.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain() -> Scheme {
        Scheme::new(false, &[], None).expect("a scheme")
    }

    #[test]
    fn powers_and_their_errors_are_those_of_a_plane() {
        let runs: Vec<Noise> = (0..9)
            .map(|k| {
                let (h, dv) = (0.1 * 1.5f64.powi(k / 3), 0.2 * 2f64.powi(k % 3));
                let force = 0.3 * h.powf(1.9) * dv.powf(0.7);
                Noise {
                    h,
                    dv,
                    force,
                    ..Noise::default()
                }
            })
            .collect();
        let [in_h, in_dv] = powers(&runs, QUANTITIES[0]);
        assert!((in_h.measured + 0.1).abs() < 1e-10 && (in_dv.measured - 0.7).abs() < 1e-10);
        // z = x with errors of +-1 at x = -1, 1 that no slope can have: residuals 1, variance 4 / (4 - 3), of which x has a fourth.
        let points = [
            [-1.0, -1.0, 0.0],
            [1.0, -1.0, 0.0],
            [-1.0, 1.0, -2.0],
            [1.0, 1.0, 2.0],
        ];
        let (fit, errors) = plane(&points);
        assert!((fit[1] - 1.0).abs() < 1e-12 && fit[2].abs() < 1e-12);
        assert!((errors[0] - 1.0).abs() < 1e-12 && (errors[1] - 1.0).abs() < 1e-12);
    }

    /// A lattice in shear, moved up at 0.04 and, particle by particle, to and fro.
    fn lattice(to_and_fro: f64) -> Noise {
        let (side, rate) = (6, 1.0);
        let mut trial = plain().trial(&scene(side, rate), |gas| {
            for i in 0..gas.x.len() {
                let sign = if gas.id[i] % 2 == 0 { 1.0 } else { -1.0 };
                let shear = -SHEAR * rate * (gas.x[i].x - 0.5);
                gas.v[i] = Vec3::new(0.0, shear + to_and_fro * sign, 0.04);
            }
        });
        let mut noise = Noise::default();
        let done = trial.run(&[0.0], |stop| noise = Noise::of(stop.system));
        done.expect("a lattice at its start");
        noise
    }

    #[test]
    fn the_meter_reads_velocities_relative_to_the_shear_and_no_force_of_a_lattice() {
        let [still, moved] = [0.0, 0.03].map(lattice);
        assert!((still.velocity / 0.04 - 1.0).abs() < 1e-12, "{still:?}");
        assert!((moved.velocity / 0.05 - 1.0).abs() < 1e-12, "{moved:?}");
        assert!((still.dv / (SHEAR * still.h) - 1.0).abs() < 1e-12);
        // What a relative error of 1e-4 of H leaves.
        assert!(still.force < 1e-5 * still.h.powi(2), "{still:?}");
    }

    #[test]
    fn a_sheared_glass_is_noisy_by_a_part_of_the_shear_across_a_particle() {
        let [slow, fast] = [0.5, 2.0].map(|rate| measured(&plain(), 6, rate, 0.5));
        println!("{slow:?}\n{fast:?}");
        for noise in [slow, fast] {
            let (force, velocity) = (noise.force / noise.h.powi(2), noise.velocity / noise.dv);
            assert!((0.01..0.3).contains(&force), "{force}");
            assert!((0.1..2.0).contains(&velocity), "{velocity}");
            assert!(noise.power < 1.5 * noise.force * noise.velocity);
        }
        assert!(fast.force > 1.5 * slow.force);
    }
}
