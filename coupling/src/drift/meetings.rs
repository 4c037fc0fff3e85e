//! Motions of bodies that meet: the hybrid map with its clusters, and the Hermite integrator.

use nbody::integrators::hermite::{Hermite, Masses};
use nbody::points::Fault;

use super::{Motion, Work, fault};
use crate::System;
use crate::gravity::Meetings;

/// By the hybrid map: Kepler orbits for those alone, an integration for those within each other's cut-off. Pairs that touch are handed on
/// in [`System::touches`].
pub struct Encounters(pub Meetings);

impl Motion for Encounters {
    fn advance(&mut self, system: &mut System, dt: f64) -> Result<Work, Fault> {
        let (star, bodies) = (&mut system.star, &mut system.bodies);
        let mut map = self.0.map();
        let moved = map.drift(star, bodies, system.g, dt);
        moved.map_err(|stuck| fault(system, stuck.place, stuck.reason.to_string()))?;
        system.touches.extend_from_slice(&map.touches);
        Ok(Work {
            bodies: system.bodies.x.len(),
            pulls: 0,
        })
    }
}

/// On each other by the Hermite integrator with individual steps, of sixth order for the star's pull and fourth for the others', by direct sum.
pub struct Blocks {
    hermite: Hermite,
    masses: Masses,
    /// Whether other operators set the bodies' step.
    kicked: bool,
    step: f64,
}

impl Blocks {
    /// `step`: the interval at which its results are wanted.
    pub fn new(kicked: bool, step: f64) -> Self {
        Self {
            hermite: Hermite::default(),
            masses: Masses::default(),
            kicked,
            step,
        }
    }
}

impl Motion for Blocks {
    fn advance(&mut self, system: &mut System, dt: f64) -> Result<Work, Fault> {
        self.masses.g = system.g;
        let (star, bodies) = (&mut system.star, &mut system.bodies);
        let stars = star.x.len();
        let moved = self.masses.drift(&mut self.hermite, star, bodies, dt);
        moved.map_err(|stall| {
            let reason =
                "meets another so closely that no step of the Hermite integrator is short enough";
            fault(
                system,
                stall.place.saturating_sub(stars),
                reason.to_string(),
            )
        })?;
        Ok(Work {
            bodies: system.bodies.x.len(),
            pulls: 0,
        })
    }

    fn own_step(&self) -> Option<f64> {
        (!self.kicked).then_some(self.step)
    }
}
