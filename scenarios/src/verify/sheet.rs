//! A sheet: a razor-thin disk about a star of G M = 1 in the plane, of particles of equal mass on rings, for problems of gas that pulls itself.
//!
//! Each ring holds as many particles as keep them as far apart along it as the rings are, turned by a golden section against the last.
//! Pulls are those of points in space, softened: q^2 = d^2 + 2 L^2 (`nbody::gravity`). A wave exp(i k R) of surface density s in such a sheet
//! has the potential -2 pi G s exp(-k sqrt(2) L) / k: the Hankel transform of 1/q is exp(-k sqrt(2) L) 2 pi / k.

use std::f64::consts::TAU;

use gas::Particles;
use nbody::gravity::{Accuracy, Gravity, Method, Settings};
use nbody::points::{Columns, Vec3};

/// A surface density between two radii.
pub struct Sheet<'a> {
    pub sigma: &'a dyn Fn(f64) -> f64,
    pub inner: f64,
    pub outer: f64,
    pub particles: usize,
    /// L
    pub softening: f64,
}

/// Particles of one radius.
#[derive(Clone, Copy, Debug)]
pub struct Ring {
    pub radius: f64,
    pub first: usize,
    pub particles: usize,
    /// Azimuth of the first.
    pub turn: f64,
    /// Outward acceleration by the whole sheet.
    pub pull: f64,
}

/// A scene of gas in the plane about a star of the mass `star`, swallowed within `accretion_radius`, with further `keys`. The block is for a layout
/// to replace, and last, so that what a block must have can follow: its lattice only says how many particles there are.
pub fn scene(particles: usize, (star, accretion_radius): (f64, f64), keys: &str) -> String {
    format!(
        r#"
title = "Sheet"
[run]
end_time = 1.0
[units]
system = "dimensionless"
[domain]
kind = "open"
dimensions = 2
[star]
mass = {star}
accretion_radius = {accretion_radius}
{keys}
[[gas.block]]
lo = [0.0, 0.0, 0.0]
hi = [{particles}.0, 1.0, 0.0]
spacing = 1.0
density = 1.0
"#
    )
}

/// Shells that the mass is summed in.
const SHELLS: usize = 1 << 15;

impl Sheet<'_> {
    /// Mass inside of the ends of the shells.
    fn masses(&self) -> Vec<f64> {
        let step = (self.outer - self.inner) / SHELLS as f64;
        let mut sums = vec![0.0];
        for shell in 0..SHELLS {
            let r = self.inner + (shell as f64 + 0.5) * step;
            sums.push(sums[shell] + TAU * r * (self.sigma)(r) * step);
        }
        sums
    }

    /// The radius that holds `mass`.
    fn radius(&self, masses: &[f64], mass: f64) -> f64 {
        let shell = masses.partition_point(|&sum| sum <= mass).clamp(1, SHELLS);
        let [below, above] = [masses[shell - 1], masses[shell]];
        let part = (mass - below) / (above - below);
        let step = (self.outer - self.inner) / SHELLS as f64;
        self.inner + (shell as f64 - 1.0 + part) * step
    }

    /// Mass of a particle.
    pub fn mass(&self) -> f64 {
        self.masses()[SHELLS] / self.particles as f64
    }

    /// The rings, with what the sheet pulls them by.
    pub fn rings(&self) -> Vec<Ring> {
        let masses = self.masses();
        let mass = masses[SHELLS] / self.particles as f64;
        let mut rings = Vec::new();
        let (mut first, mut turn) = (0, 0.0);
        while first < self.particles {
            let r = self.radius(&masses, (first as f64 + 0.5) * mass);
            let spacing = (mass / (self.sigma)(r)).sqrt();
            let left = self.particles - first;
            let particles = ((TAU * r / spacing).round() as usize).clamp(1, left);
            let middle = (first as f64 + 0.5 * particles as f64) * mass;
            rings.push(Ring {
                radius: self.radius(&masses, middle),
                first,
                particles,
                turn,
                pull: 0.0,
            });
            turn += TAU * 0.618_033_988_75 / particles as f64;
            first += particles;
        }
        self.pull(&mut rings, mass);
        rings
    }

    /// Finds the mean outward acceleration of each ring.
    fn pull(&self, rings: &mut [Ring], mass: f64) {
        let x: Vec<Vec3> = (rings.iter())
            .flat_map(|ring| (0..ring.particles).map(|i| ring.radius * ring.out(i)))
            .collect();
        let mut solver = Gravity::new(Settings {
            accuracy: Accuracy::ForceError(1e-4),
            method: Method::Automatic,
            constant: 1.0,
        });
        solver.build(&x, &vec![mass; x.len()], &vec![self.softening; x.len()]);
        let mut a = vec![Vec3::zeros(); x.len()];
        let all: Vec<u32> = (0..x.len() as u32).collect();
        solver.field(&all, &mut a, &mut []);
        for ring in rings {
            let own = ring.first..ring.first + ring.particles;
            let sum: f64 = own.map(|i| a[i].dot(&x[i])).sum();
            ring.pull = sum / (ring.radius * ring.particles as f64);
        }
    }

    /// Lays the particles of `rings` out, each ring by `moved` outwards, with the angular momentum by mass `momentum` that it has at rest.
    pub fn lay_out(
        &self,
        gas: &mut Particles,
        rings: &[Ring],
        (momentum, moved): (&[f64], impl Fn(f64) -> f64),
    ) {
        gas.resize(self.particles);
        let mass = self.mass();
        for (ring, l) in rings.iter().zip(momentum) {
            let r = ring.radius + moved(ring.radius);
            for k in 0..ring.particles {
                let i = ring.first + k;
                let out = ring.out(k);
                gas.id[i] = i as u64;
                gas.x[i] = r * out;
                gas.v[i] = l / r * Vec3::new(-out.y, out.x, 0.0);
                gas.m[i] = mass;
                gas.h[i] = 0.0;
            }
        }
    }
}

impl Ring {
    /// The direction from the star to particle `i`.
    fn out(&self, i: usize) -> Vec3 {
        let (sin, cos) = (TAU * i as f64 / self.particles as f64 + self.turn).sin_cos();
        Vec3::new(cos, sin, 0.0)
    }

    /// The angular momentum by mass in balance with the star, the sheet, and the outward acceleration `push`.
    pub fn momentum(&self, push: f64) -> f64 {
        let r = self.radius;
        (r - r.powi(3) * (self.pull + push)).max(0.0).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_have_the_mass_and_the_pull_of_the_sheet() {
        // Mestel's disk pulls as if what lies inside were in the middle, and what lies outside were not there: but for its edges.
        let sheet = Sheet {
            sigma: &|r| 1e-3 / r,
            inner: 0.02,
            outer: 30.0,
            particles: 20_000,
            softening: 0.0,
        };
        let rings = sheet.rings();
        let total: usize = rings.iter().map(|ring| ring.particles).sum();
        assert_eq!(total, 20_000);
        let near = rings
            .iter()
            .filter(|ring| (1.0..3.0).contains(&ring.radius));
        for ring in near {
            let inside = TAU * 1e-3 * (ring.radius - 0.02);
            let counted = sheet.mass() * (ring.first as f64 + 0.5 * ring.particles as f64);
            assert!((counted / inside - 1.0).abs() < 1e-3, "{counted} {inside}");
            let pull = -TAU * 1e-3 / ring.radius;
            assert!(
                (ring.pull / pull - 1.0).abs() < 0.05,
                "{} {pull}",
                ring.pull
            );
        }
    }
}
