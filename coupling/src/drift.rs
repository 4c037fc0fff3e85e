//! Drifts: everybody moves to the next tick. Star and bodies move by their own integrator when their step ends there; before that
//! they are seen through its prediction.

mod epicycles;
mod meetings;
mod motions;
mod radau;

use nbody::integrators::{Ahead, wisdom_holman};
use nbody::points::{Fault, Population};

use crate::System;
use crate::operator::{Meter, Operator, Phase};

pub use epicycles::Epicycles;
pub use meetings::{Blocks, Encounters};
pub use motions::{JacobiMap, Kepler, Straight};
pub use radau::Radau;

/// Moves the gas: all of it at the ticks at which somebody looks at it, else only what gas that is active may meet.
pub struct DriftGas {
    /// Whether others look at all gas at every tick.
    pub always: bool,
    /// Whether gas, dust and bodies look at all gas when they feel the field: gas at the end of its step, or of that of the field.
    pub observers: [bool; 3],
}

impl Operator for DriftGas {
    fn name(&self) -> &'static str {
        "drift gas"
    }

    fn between_ticks(&self) -> bool {
        true
    }

    fn counted(&self, _: &System) -> bool {
        false
    }

    fn cross(&mut self, system: &mut System, _: f64, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Hydro);
        if self.always || system.clock.synchronous() || system.feels(self.observers) {
            system.gas.arrive(&system.domain, &system.clock);
        }
        Ok(true)
    }
}

/// Moves the dust.
pub struct DriftDust;

impl Operator for DriftDust {
    fn name(&self) -> &'static str {
        "drift dust"
    }

    fn between_ticks(&self) -> bool {
        true
    }

    /// Straight flight changes nothing that is counted.
    fn counted(&self, _: &System) -> bool {
        false
    }

    fn cross(
        &mut self,
        system: &mut System,
        dt: f64,
        meter: &mut dyn Meter,
    ) -> Result<bool, Fault> {
        meter.enter(Phase::Dust);
        let domain = system.domain;
        system.dust.drift(dt, &domain);
        Ok(false)
    }
}

/// What an integrator did.
#[derive(Clone, Copy, Debug, Default)]
pub struct Work {
    pub bodies: usize,
    /// Pulls between pairs.
    pub pulls: u64,
}

/// How star and bodies move over a step of theirs.
pub trait Motion: Send {
    /// Moves star and bodies by `dt`, the whole of their step.
    fn advance(&mut self, system: &mut System, dt: f64) -> Result<Work, Fault>;

    /// The interval at which the motion itself wants its step to end; none if kicks set the step.
    fn own_step(&self) -> Option<f64> {
        None
    }

    /// Where star and bodies are `dt` after the beginning of their step, before its end: where the Kepler map would take them.
    fn predict(&self, system: &System, dt: f64, ahead: &mut Ahead) -> Result<(), Fault> {
        let (star, bodies) = (&system.star, &system.bodies);
        let seen = wisdom_holman::predict(star, bodies, system.g, dt, ahead);
        seen.map_err(|stuck| fault(system, stuck.place, stuck.refusal.to_string()))
    }
}

/// Moves star and bodies.
pub struct DriftBodies<M> {
    motion: M,
    ahead: Ahead,
}

impl<M> DriftBodies<M> {
    pub fn new(motion: M) -> Self {
        Self {
            motion,
            ahead: Ahead::default(),
        }
    }
}

impl<M: Motion> Operator for DriftBodies<M> {
    fn name(&self) -> &'static str {
        "drift bodies"
    }

    fn between_ticks(&self) -> bool {
        true
    }

    fn counted(&self, system: &System) -> bool {
        system.bodies_active()
    }

    fn prepare(&mut self, system: &mut System, _: &mut dyn Meter) -> Result<(), Fault> {
        if let Some(step) = self.motion.own_step().filter(|_| system.bodies_active()) {
            system.pace.next_span = crate::kick::span(&system.next, step)?;
        }
        Ok(())
    }

    fn cross(&mut self, system: &mut System, _: f64, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Bodies);
        // Since their step began.
        let dt = f64::from(system.clock.tick - system.pace.begin) * system.clock.unit();
        if system.bodies_active() {
            let work = self.motion.advance(system, dt)?;
            meter.count(work.bodies, work.pulls);
            system.look();
            return Ok(true);
        }
        meter.count(system.bodies.x.len(), 0);
        self.motion.predict(system, dt, &mut self.ahead)?;
        let seen = &mut system.seen;
        seen.x.clone_from(&self.ahead.x);
        seen.v.clone_from(&self.ahead.v);
        seen.star_x.fill(self.ahead.x_star);
        seen.star_v.fill(self.ahead.v_star);
        Ok(false)
    }
}

/// A body that its integrator cannot move: its place and why.
fn fault(system: &System, place: usize, reason: String) -> Fault {
    Fault::Stuck {
        population: Population::Planetesimals,
        id: system.bodies.id.get(place).copied().unwrap_or(0),
        reason,
        time: system.clock.time(),
    }
}
