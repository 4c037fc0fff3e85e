//! Kicks of the dust by gravity.

use dust::motion::Parts;
use nbody::points::Fault;

use super::Steps;
use super::reaction::{Kicked, Reaction, Weight, receive};
use crate::System;
use crate::gravity::heavies;
use crate::operator::{Meter, Operator, Phase};

/// Kicks of the dust.
pub struct KickDust {
    pub pacing: Steps,
    pub parts: Parts,
    pub reaction: Reaction,
    /// Whether anything pulls the dust; else its kicks change nothing.
    pub pulled: bool,
    /// Places of the dust whose step ends now.
    active: Vec<u32>,
}

impl KickDust {
    pub fn new(pacing: Steps, parts: Parts, reaction: Reaction) -> Self {
        Self {
            pacing,
            parts,
            reaction,
            pulled: true,
            active: Vec::new(),
        }
    }

    fn react(&self, system: &mut System, pace: impl Fn(&System, usize) -> Weight + Sync) {
        if !self.pulled {
            return;
        }
        let heavies = heavies(system);
        let memory = std::mem::take(&mut system.given);
        let centre = self.reaction.centre(system);
        let dust = &system.dust.particles;
        let kicked = Kicked {
            x: &dust.x,
            m: &dust.m,
            h: &dust.h,
            gravity: &system.dust.rates.gravity,
            active: &self.active,
        };
        let given = (self.reaction).act((system.g, &heavies, memory), &centre, &kicked, |i| {
            pace(system, i)
        });
        receive(system, heavies, given);
    }
}

impl Operator for KickDust {
    fn name(&self) -> &'static str {
        "kick dust"
    }

    fn counted(&self, _: &System) -> bool {
        self.pulled
    }

    fn prepare(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<(), Fault> {
        meter.enter(Phase::Dust);
        let pacing = self.pacing.of(system);
        if self.pulled {
            system.list_active_dust(&mut self.active);
        }
        system
            .dust
            .steps(&pacing, self.parts, &system.clock, &system.next)?;
        Ok(())
    }

    fn close(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Dust);
        self.react(system, |s, i| {
            Weight::closing(s, s.dust.particles.begin[i], s.dust.particles.span[i])
        });
        let centre = self.reaction.centre(system);
        let gained = system.dust.close(&system.clock, &centre, &system.domain);
        system.ledger.receive(gained);
        Ok(self.pulled)
    }

    fn open(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Dust);
        self.react(system, |s, i| Weight::opening(s, s.dust.rates.next_span[i]));
        let centre = self.reaction.centre(system);
        let (clock, next) = (&system.clock, &system.next);
        let gained = system.dust.open(clock, next, &centre, &system.domain);
        system.ledger.receive(gained);
        Ok(self.pulled)
    }
}
