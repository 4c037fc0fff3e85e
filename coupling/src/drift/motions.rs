//! Motions of star and bodies along lines and orbits: straight, Kepler's about the star, and the map in Jacobi coordinates.

use nbody::integrators::wisdom_holman::jacobi::{Jacobi, Scheme};
use nbody::integrators::{Ahead, Stuck, leapfrog, wisdom_holman};
use nbody::points::Fault;

use super::{Motion, Work, fault};
use crate::System;

/// Along straight lines.
pub struct Straight;

impl Motion for Straight {
    fn advance(&mut self, system: &mut System, dt: f64) -> Result<Work, Fault> {
        leapfrog::drift(&mut system.star, dt);
        leapfrog::drift(&mut system.bodies, dt);
        Ok(Work {
            bodies: system.bodies.x.len(),
            pulls: 0,
        })
    }

    fn predict(&self, system: &System, dt: f64, ahead: &mut Ahead) -> Result<(), Fault> {
        leapfrog::predict(&system.star, &system.bodies, dt, ahead);
        Ok(())
    }
}

/// By the Kepler map of Wisdom & Holman (1991) in democratic heliocentric coordinates.
pub struct Kepler;

impl Motion for Kepler {
    fn advance(&mut self, system: &mut System, dt: f64) -> Result<Work, Fault> {
        let moved = wisdom_holman::drift(&mut system.star, &mut system.bodies, system.g, dt);
        moved.map_err(|stuck| halted(system, stuck))?;
        Ok(Work {
            bodies: system.bodies.x.len(),
            pulls: 0,
        })
    }
}

/// On each other by a Wisdom-Holman map in Jacobi coordinates, in equal steps of about `step` within each base step. Nothing else may kick
/// the bodies. The map's memory is in [`System::memory`].
pub struct JacobiMap {
    pub scheme: Scheme,
    pub step: f64,
}

impl Motion for JacobiMap {
    fn advance(&mut self, system: &mut System, dt: f64) -> Result<Work, Fault> {
        let (star, bodies) = (&mut system.star, &mut system.bodies);
        let map = Jacobi::restored(self.scheme, system.g, star, bodies, &system.memory);
        let mut map = map.unwrap_or_else(|| Jacobi::of(self.scheme, system.g, star, bodies));
        let steps = (dt / self.step * (1.0 - 1e-12)).ceil().max(1.0);
        let moved = map.advance(dt / steps, steps as u64);
        moved.map_err(|stuck| halted(system, stuck))?;
        let stored = map.store(&mut system.star, &mut system.bodies);
        stored.map_err(|stuck| halted(system, stuck))?;
        system.memory = map.state();
        Ok(Work {
            bodies: system.bodies.x.len() * steps as usize,
            pulls: 0,
        })
    }

    fn own_step(&self) -> Option<f64> {
        Some(f64::INFINITY)
    }

    fn predict(&self, _: &System, _: f64, _: &mut Ahead) -> Result<(), Fault> {
        unreachable!("nobody else ticks")
    }
}

fn halted(system: &System, stuck: Stuck) -> Fault {
    fault(system, stuck.place, stuck.refusal.to_string())
}
