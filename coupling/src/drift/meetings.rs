//! Drifts of bodies that meet: the hybrid map with its clusters, and the Hermite integrator.

use nbody::integrators::hermite::{Hermite, Masses};
use nbody::points::{Fault, Population};

use super::{DriftKepler, elapsed};
use crate::System;
use crate::gravity::Meetings;
use crate::operator::{Meter, Operator, Phase};

fn stuck(system: &System, place: usize, reason: String) -> Fault {
    Fault::Stuck {
        population: Population::Planetesimals,
        id: system.bodies.id.get(place).copied().unwrap_or(0),
        reason,
        time: system.clock.time(),
    }
}

/// Moves star and bodies by the hybrid map: Kepler orbits for those alone, an integration for those within each other's cut-off.
/// Pairs that touch are handed on in [`System::touches`].
pub struct DriftHybrid {
    meetings: Meetings,
    kepler: DriftKepler,
}

impl DriftHybrid {
    pub fn new(meetings: Meetings) -> Self {
        Self {
            meetings,
            kepler: DriftKepler::default(),
        }
    }
}

impl Operator for DriftHybrid {
    fn name(&self) -> &'static str {
        "drift bodies"
    }

    fn cross(
        &mut self,
        system: &mut System,
        dt: f64,
        meter: &mut dyn Meter,
    ) -> Result<bool, Fault> {
        if !system.bodies_active() {
            return self.kepler.cross(system, dt, meter);
        }
        meter.enter(Phase::Bodies);
        let dt = elapsed(system);
        meter.count(system.bodies.x.len(), 0);
        let (star, bodies) = (&mut system.star, &mut system.bodies);
        let mut map = self.meetings.map();
        let moved = map.drift(star, bodies, system.g, dt);
        moved.map_err(|s| stuck(system, s.place, s.reason.to_string()))?;
        system.touches.extend_from_slice(&map.touches);
        system.look();
        Ok(true)
    }
}

/// Moves star and bodies on each other by the Hermite integrator of fourth order with individual steps, forces by direct sum.
///
/// Between the bodies' ticks they are seen where the Kepler map would take them.
pub struct DriftHermite {
    hermite: Hermite,
    masses: Masses,
    /// Whether other operators set the bodies' step.
    kicked: bool,
    step: f64,
    kepler: DriftKepler,
}

impl DriftHermite {
    /// `step`: the interval at which its results are wanted.
    pub fn new(kicked: bool, step: f64) -> Self {
        Self {
            hermite: Hermite::default(),
            masses: Masses::default(),
            kicked,
            step,
            kepler: DriftKepler::default(),
        }
    }
}

impl Operator for DriftHermite {
    fn name(&self) -> &'static str {
        "drift bodies"
    }

    fn prepare(&mut self, system: &mut System, _: &mut dyn Meter) -> Result<(), Fault> {
        if !self.kicked && system.bodies_active() {
            system.pace.next_span = crate::kick::span(&system.next, self.step)?;
        }
        Ok(())
    }

    fn cross(
        &mut self,
        system: &mut System,
        dt: f64,
        meter: &mut dyn Meter,
    ) -> Result<bool, Fault> {
        if !system.bodies_active() {
            return self.kepler.cross(system, dt, meter);
        }
        meter.enter(Phase::Bodies);
        let dt = elapsed(system);
        meter.count(system.bodies.x.len(), 0);
        self.masses.g = system.g;
        let (star, bodies) = (&mut system.star, &mut system.bodies);
        let stars = star.x.len();
        let moved = self.masses.drift(&mut self.hermite, star, bodies, dt);
        moved.map_err(|stall| {
            let reason =
                "meets another so closely that no step of the Hermite integrator is short enough";
            stuck(
                system,
                stall.place.saturating_sub(stars),
                reason.to_string(),
            )
        })?;
        system.look();
        Ok(true)
    }
}
