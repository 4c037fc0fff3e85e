//! The stress of a turbulent disk as an alpha, for R from 0.7 to 1.3.
//!
//! alpha = 2/3 < v_R dv_phi Sigma > / < Sigma c^2 > of velocities, and 2/3 F / (2 pi R^2 Sigma c^2) of the torque F of the gas inside of R on that
//! outside, by gravity, by artificial viscosity and by the pressure of particles across R. All together balance the cooling where the disk is steady
//! and no energy comes or goes as waves.

use std::f64::consts::{PI, TAU};

use coupling::System;
use nbody::points::Vec3;

use super::super::viscous::Inviscid;

const RINGS: usize = 12;
const FIRST: f64 = 0.7;
const WIDTH: f64 = 0.05;
/// Parts of the samples, whose scatter is the error of the mean: longer than the turbulence remembers.
const PARTS: usize = 6;

/// alpha by source, and the mean of Q by mass.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stress {
    pub velocities: f64,
    pub gravity: f64,
    pub viscosity: f64,
    pub pressure: f64,
    pub q: f64,
}

impl Stress {
    pub fn of(system: &System, inviscid: &Inviscid) -> Self {
        let gas = &system.gas;
        let (p, star) = (&gas.particles, (system.star.x[0], system.star.v[0]));
        let pushes = inviscid.pushes(system);
        // Of a ring: mass, and by mass v_R, v_phi, v_R v_phi, c^2; and the torques on what lies outside of its edges.
        let mut rings = [[0.0; 5]; RINGS];
        let mut torques = [[0.0; 3]; RINGS + 1];
        for (i, push) in pushes.iter().enumerate() {
            let (x, v) = (p.x[i] - star.0, p.v[i] - star.1);
            let r = x.norm();
            let (v_r, v_phi) = (x.dot(&v) / r, x.cross(&v).z / r);
            let place = (r - FIRST) / WIDTH;
            // Particles beyond the first edges that lie within theirs feel all gas inside of it: forces among them cancel.
            let torque = |a: Vec3| p.m[i] * x.cross(&a).z;
            let own = [gas.rates.attraction(i), gas.rates.hydro[i] - push, *push].map(torque);
            for (edge, sums) in torques.iter_mut().enumerate() {
                for (sum, torque) in sums.iter_mut().zip(own) {
                    *sum += if place >= edge as f64 { torque } else { 0.0 };
                }
            }
            if (0.0..RINGS as f64).contains(&place) {
                let c2 = gas.derived.cs[i].powi(2);
                // What the mean rotation changes by within a ring is no stress.
                let v_phi = v_phi - r.powf(-0.5);
                let sums = &mut rings[place as usize];
                for (sum, value) in sums.iter_mut().zip([1.0, v_r, v_phi, v_r * v_phi, c2]) {
                    *sum += p.m[i] * value;
                }
            }
        }
        Self::over(&rings, &torques)
    }

    /// The mean over rings by their mass.
    fn over(rings: &[[f64; 5]; RINGS], torques: &[[f64; 3]; RINGS + 1]) -> Self {
        let (mut mean, mut all) = (Self::default(), 0.0);
        for (k, [m, v_r, v_phi, both, c2]) in rings.iter().copied().enumerate() {
            let r = FIRST + (k as f64 + 0.5) * WIDTH;
            // m c^2 / (2 pi R width) is Sigma c^2: F = 2 pi R^2 T.
            let of = |torque: usize| {
                let torque = 0.5 * (torques[k][torque] + torques[k + 1][torque]);
                2.0 / 3.0 * torque * WIDTH / (r * c2) * m
            };
            mean.velocities += 2.0 / 3.0 * (both - v_r * v_phi / m) / c2 * m;
            mean.gravity += of(0);
            mean.viscosity += of(1);
            mean.pressure += of(2);
            let sigma = m / (TAU * r * WIDTH);
            mean.q += (c2 / m).sqrt() * r.powf(-1.5) / (PI * sigma) * m;
            all += m;
        }
        Self {
            velocities: mean.velocities / all,
            gravity: mean.gravity / all,
            viscosity: mean.viscosity / all,
            pressure: mean.pressure / all,
            q: mean.q / all,
        }
    }
}

/// The mean of a quantity over samples in the order of time, and its standard error by the means of their parts.
pub fn mean(samples: &[Stress], of: impl Fn(&Stress) -> f64) -> (f64, f64) {
    let mean = |part: &[Stress]| part.iter().map(&of).sum::<f64>() / part.len() as f64;
    let length = samples.len() / PARTS;
    let all = mean(samples);
    if length == 0 {
        return (all, f64::NAN);
    }
    let parts = samples.chunks_exact(length).take(PARTS).map(mean);
    let scatter: f64 = parts.map(|part| (part - all).powi(2)).sum();
    (all, (scatter / (PARTS * (PARTS - 1)) as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_of_one_stress_have_its_alpha() {
        // v_R v_phi by mass 0.03, mean velocities of 0.1 and 0.2 that are none of it, c^2 = 0.5, and torques 2 pi R^2 alpha Sigma c^2 3/2 of alpha 0.07, 0.01, -0.02.
        let (mut rings, mut torques) = ([[0.0; 5]; RINGS], [[0.0; 3]; RINGS + 1]);
        let sigma = |r: f64| 1.0 / r;
        for (k, ring) in rings.iter_mut().enumerate() {
            let m = TAU
                * WIDTH
                * (FIRST + (k as f64 + 0.5) * WIDTH)
                * sigma(FIRST + (k as f64 + 0.5) * WIDTH);
            *ring = [m, 0.1 * m, 0.2 * m, (0.03 + 0.02) * m, 0.5 * m];
        }
        for (edge, torque) in torques.iter_mut().enumerate() {
            let r = FIRST + edge as f64 * WIDTH;
            let whole = TAU * r * r * 1.5 * sigma(r) * 0.5;
            *torque = [0.07 * whole, 0.01 * whole, -0.02 * whole];
        }
        let found = Stress::over(&rings, &torques);
        for (found, expected) in [
            (found.velocities, 2.0 / 3.0 * 0.03 / 0.5),
            (found.gravity, 0.07),
            (found.viscosity, 0.01),
            (found.pressure, -0.02),
        ] {
            assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
        }
    }

    #[test]
    fn the_error_of_a_mean_is_that_of_its_parts() {
        let sample = |q: f64| Stress {
            q,
            ..Stress::default()
        };
        let samples: Vec<Stress> = (0..60).map(|k| sample(f64::from(k / 10 % 2))).collect();
        let (mean, error) = mean(&samples, |stress| stress.q);
        assert!((mean - 0.5).abs() < 1e-15 && (error - (0.25f64 / 5.0).sqrt()).abs() < 1e-15);
    }
}
