//! The motion of star and bodies on each other by Gauss-Radau, forces by direct sum.

use nbody::integrators::gauss_radau::GaussRadau;
use nbody::points::{Fault, Vec3};

use super::{Motion, Work, fault};
use crate::System;

/// By the Gauss-Radau integrator of 15th order (Everhart 1985; Rein & Spiegel 2015). Its memory is in [`System::memory`].
pub struct Radau {
    /// Whether bodies are kicked from outside, so that the integrator has to take their velocities anew at each tick.
    pub kicked: bool,
    /// The interval at which its results are wanted.
    pub step: f64,
}

impl Motion for Radau {
    fn advance(&mut self, system: &mut System, dt: f64) -> Result<Work, Fault> {
        let n = system.star.x.len() + system.bodies.x.len();
        let begin = system.clock.time() - dt;
        let mut integrator = match GaussRadau::restored(&system.memory) {
            Some(integrator) if !self.kicked && integrator.x().len() == n => integrator,
            _ => GaussRadau::of(begin, &system.star, &system.bodies),
        };
        let pairs = Pairs::of(system);
        let mut sums = 0;
        let done = integrator.advance_to(system.clock.time(), |x, a| {
            sums += 1;
            pairs.add(x, a);
        });
        // Their step is common: no body is the one.
        done.map_err(|stall| fault(system, usize::MAX, stall.to_string()))?;
        integrator.store(&mut system.star, &mut system.bodies);
        system.memory = integrator.state();
        Ok(Work {
            bodies: n,
            pulls: sums * pairs.interactions(),
        })
    }

    fn own_step(&self) -> Option<f64> {
        (!self.kicked).then_some(self.step)
    }
}

/// Masses and softening lengths of star and bodies, for the direct sum. Massless bodies feel, but do not pull.
struct Pairs {
    g: f64,
    m: Vec<f64>,
    softening: Vec<f64>,
    /// Places of those with mass, and of those without.
    massive: Vec<usize>,
    massless: Vec<usize>,
}

impl Pairs {
    fn of(system: &System) -> Self {
        let both = |star: &[f64], bodies: &[f64]| star.iter().chain(bodies).copied().collect();
        let m: Vec<f64> = both(&system.star.m, &system.bodies.m);
        let (massive, massless) = (0..m.len()).partition(|&i| m[i] > 0.0);
        Self {
            g: system.g,
            softening: both(&system.star.softening, &system.bodies.softening),
            m,
            massive,
            massless,
        }
    }

    /// Pulls a sum over all pairs takes; a pair of masses pulls both ways at once.
    fn interactions(&self) -> u64 {
        let massive = self.massive.len() as u64;
        massive * massive.saturating_sub(1) / 2 + massive * self.massless.len() as u64
    }

    fn add(&self, x: &[Vec3], a: &mut [Vec3]) {
        for (k, &i) in self.massive.iter().enumerate() {
            for &j in &self.massive[..k] {
                let f = self.pull(x, i, j);
                a[i] += f * self.m[j];
                a[j] -= f * self.m[i];
            }
        }
        for &i in &self.massless {
            for &j in &self.massive {
                a[i] += self.pull(x, i, j) * self.m[j];
            }
        }
    }

    /// The pull on i towards j by mass of j.
    fn pull(&self, x: &[Vec3], i: usize, j: usize) -> Vec3 {
        let d = x[j] - x[i];
        let soft = self.softening[i] * self.softening[i] + self.softening[j] * self.softening[j];
        let r2 = d.norm_squared() + soft;
        // Points at one place have no direction to pull in.
        if r2 > 0.0 {
            d * (self.g / (r2 * r2.sqrt()))
        } else {
            Vec3::zeros()
        }
    }
}

#[cfg(test)]
mod tests;
