//! Density and kicks of the gas: pair by pair by the impulses of its force sweep, and by gravity.

use gas::Hydro;
use nbody::points::{Fault, Vec3};

use super::Steps;
use super::reaction::{Kicked, Reaction, Weight, receive};
use crate::System;
use crate::gravity::heavies;
use crate::ledger::Scope;
use crate::operator::{Meter, Operator, Phase};

/// Finds density, pressure and what else a gas particle needs before forces.
pub struct Density {
    pub hydro: Hydro,
}

impl Operator for Density {
    fn name(&self) -> &'static str {
        "density"
    }

    fn counted(&self, _: &System) -> bool {
        false
    }

    fn prepare(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<(), Fault> {
        meter.enter(Phase::Density);
        let centre = system
            .seen
            .star_x
            .first()
            .copied()
            .unwrap_or_else(Vec3::zeros);
        self.hydro.domain = system.domain;
        let bound = !self.hydro.eos.is_free();
        system.gas.lean(system.clock.time(), bound);
        let targets = system.gas.density(&self.hydro, &system.clock, centre)?;
        meter.count(targets, 0);
        Ok(())
    }
}

/// Kicks of the gas.
pub struct KickGas {
    pub hydro: Hydro,
    pub reaction: Reaction,
    pub pacing: Steps,
}

impl KickGas {
    /// Lets star and planets react to the pulls that kick at `pace`, and notes the net effect of the field that kicks with `of_field`.
    fn react(
        &self,
        system: &mut System,
        pace: impl Fn(&System, usize) -> Weight + Sync,
        of_field: impl Fn(&System, usize) -> f64 + Sync,
    ) {
        let heavies = heavies(system);
        let memory = std::mem::take(&mut system.given);
        let centre = self.reaction.centre(system);
        let gas = &system.gas.particles;
        let kicked = Kicked {
            x: &gas.x,
            m: &gas.m,
            h: &gas.h,
            gravity: &system.gas.rates.gravity,
            active: system.gas.active_ones(),
        };
        let mut given = (self.reaction).act((system.g, &heavies, memory), &centre, &kicked, |i| {
            pace(system, i)
        });
        if system.gas.has_field() {
            let field = kicked.stray(|i| {
                let ends = system.gas.field_ends(&system.clock, i);
                let weight = if ends { of_field(system, i) } else { 0.0 };
                (system.gas.rates.field[i], weight)
            });
            given.stray = given.stray + field;
        }
        receive(system, heavies, given);
    }
}

impl Operator for KickGas {
    fn name(&self) -> &'static str {
        "kick gas"
    }

    fn scope(&self, system: &System) -> Scope {
        Scope::Near {
            bodies: system.bodies_active() || self.reaction.on[1],
        }
    }

    fn prepare(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<(), Fault> {
        meter.enter(Phase::Hydro);
        self.hydro.domain = system.domain;
        if system.clock.step == 0 {
            // The first step's choice of a step needs accelerations; the weights of closing are still zero.
            system.gas.forces(&self.hydro, &system.clock, &system.clock);
        }
        system.gas.steps(
            &self.hydro,
            &system.clock,
            &system.next,
            &self.pacing.of(system),
        )?;
        let targets = system.gas.forces(&self.hydro, &system.clock, &system.next);
        system.ledger.radiated += system.gas.take_background_work();
        system.gas.stand_upright();
        meter.count(targets, 0);
        Ok(())
    }

    fn close(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Hydro);
        self.react(
            system,
            |s, i| Weight::closing(s, s.gas.particles.begin[i], s.gas.particles.span[i]),
            |s, i| s.gas.field_closing(&s.clock, i),
        );
        let centre = self.reaction.centre(system);
        let heat = system.gas.close(&self.hydro, &system.clock, &centre);
        system.ledger.take(heat);
        Ok(true)
    }

    fn open(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Hydro);
        self.react(
            system,
            |s, i| Weight::opening(s, s.gas.rates.next_span[i]),
            |s, i| s.opening(s.gas.rates.next_field_span[i]),
        );
        let centre = self.reaction.centre(system);
        let (clock, next) = (&system.clock, &system.next);
        let heat = system.gas.open(&self.hydro, clock, next, &centre);
        system.ledger.take(heat);
        Ok(true)
    }
}
