//! The motion of bodies in a shearing box: free epicycles in Hill's frame, and with vertical gravity oscillations through the middle plane.
//!
//! z'' = -Omega^2 (z - z_0)
//!
//! Both are done exactly, whatever the step is. What the frame, its vertical gravity and the faces give is booked as momentum received.

use nbody::integrators::Ahead;
use nbody::points::hill::Free;
use nbody::points::{Domain, Fault, Vec3};

use super::{Motion, Work};
use crate::System;

/// Along epicycles, wrapped at the faces of the box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Epicycles {
    /// The wanted step of the bodies.
    pub step: f64,
    /// Frequency of the oscillation across the middle plane; zero without vertical gravity.
    pub vertical: f64,
    /// z_0.
    pub middle: f64,
}

impl Epicycles {
    /// The free motion over `dt`.
    fn over(&self, domain: &Domain, dt: f64) -> Course {
        let hill = domain.hill().expect("the frame of a shearing box");
        let (sin, cos) = (self.vertical * dt).sin_cos();
        Course {
            free: hill.free(dt),
            oscillation: (self.vertical > 0.0).then_some([cos, sin]),
            of: *self,
        }
    }
}

/// Free motion over one time.
struct Course {
    free: Free,
    /// Cosine and sine of the vertical phase.
    oscillation: Option<[f64; 2]>,
    of: Epicycles,
}

impl Course {
    fn of(&self, x: Vec3, v: Vec3) -> (Vec3, Vec3) {
        let (mut to, mut fast) = self.free.of(x, v);
        if let Some([cos, sin]) = self.oscillation {
            let (rate, height) = (self.of.vertical, x.z - self.of.middle);
            to.z = self.of.middle + height * cos + v.z / rate * sin;
            fast.z = v.z * cos - rate * height * sin;
        }
        (to, fast)
    }
}

impl Motion for Epicycles {
    fn advance(&mut self, system: &mut System, dt: f64) -> Result<Work, Fault> {
        let domain = system.domain.at(system.clock.time());
        let course = self.over(&domain, dt);
        let (bodies, mut gained) = (&mut system.bodies, Vec3::zeros());
        for ((x, v), &m) in bodies.x.iter_mut().zip(&mut bodies.v).zip(&bodies.m) {
            let before = *v;
            (*x, *v) = course.of(*x, *v);
            *v += domain.wrap(x);
            gained += m * (*v - before);
        }
        system.ledger.receive(gained);
        Ok(Work {
            bodies: system.bodies.x.len(),
            pulls: 0,
        })
    }

    fn own_step(&self) -> Option<f64> {
        Some(self.step)
    }

    fn predict(&self, system: &System, dt: f64, ahead: &mut Ahead) -> Result<(), Fault> {
        let domain = system.domain.at(system.clock.time());
        let course = self.over(&domain, dt);
        let bodies = &system.bodies;
        let seen = bodies.x.iter().zip(&bodies.v).map(|(&x, &v)| {
            let (mut x, mut v) = course.of(x, v);
            v += domain.wrap(&mut x);
            (x, v)
        });
        (ahead.x, ahead.v) = seen.unzip();
        Ok(())
    }
}

#[cfg(test)]
mod tests;
