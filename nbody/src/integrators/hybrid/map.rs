//! The whole step of star and bodies on each other alone: half a kick, the drift, half a kick.

use super::soft::Soft;
use super::{Hybrid, Stuck};
use crate::bodies::Bodies;
use crate::integrators::kick as kick_all;
use crate::points::sum::CHUNK;

/// The step, with the soft field's accelerations kept in the bodies' `a`.
pub struct Map {
    pub hybrid: Hybrid,
    pub soft: Soft,
    pub g: f64,
    pub dt: f64,
}

impl Map {
    /// The soft accelerations at the bodies' places: before the first step, and when bodies have changed.
    pub fn prepare(&mut self, star: &Bodies, bodies: &mut Bodies) {
        self.soft.field(&mut self.hybrid, star, bodies, false);
    }

    /// One step; afterwards `hybrid.touches` holds who touched.
    pub fn step(&mut self, star: &mut Bodies, bodies: &mut Bodies) -> Result<(), Stuck> {
        kick(bodies, 0.5 * self.dt);
        self.hybrid.drift(star, bodies, self.g, self.dt)?;
        self.prepare(star, bodies);
        kick(bodies, 0.5 * self.dt);
        Ok(())
    }
}

fn kick(bodies: &mut Bodies, dt: f64) {
    if bodies.v.len() <= CHUNK {
        bodies
            .v
            .iter_mut()
            .zip(&bodies.a)
            .for_each(|(v, a)| *v += a * dt);
    } else {
        kick_all(&mut bodies.v, &bodies.a, dt);
    }
}
