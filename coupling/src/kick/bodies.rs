//! Kicks of star and bodies.

use nbody::points::Fault;

use super::span;
use crate::System;
use crate::operator::{Meter, Operator, Phase};
use crate::system::Stray;

/// Kicks of star and bodies by what their own integrator does not do; sets their step, and closes the books on the tree's field.
pub struct KickBodies {
    /// Whether pulls are mutual, so that the tree's field should have no net impulse.
    pub mutual: bool,
    /// The wanted step of the bodies' integrator.
    pub step: f64,
}

impl KickBodies {
    fn kick(system: &mut System, weight: f64) {
        for bodies in [&system.star, &system.bodies] {
            let given = (0..bodies.x.len())
                .map(|i| Stray::at(bodies.x[i], bodies.a[i] * (bodies.m[i] * weight)));
            system.stray = given.fold(system.stray, |sum, stray| sum + stray);
        }
        for bodies in [&mut system.star, &mut system.bodies] {
            for (v, a) in bodies.v.iter_mut().zip(&bodies.a) {
                *v += *a * weight;
            }
        }
        system.settle_impulses();
        system.look();
    }
}

impl Operator for KickBodies {
    fn name(&self) -> &'static str {
        "kick bodies"
    }

    fn counted(&self, system: &System) -> bool {
        system.bodies_active()
    }

    fn prepare(&mut self, system: &mut System, _: &mut dyn Meter) -> Result<(), Fault> {
        if system.bodies_active() {
            system.pace.next_span = span(&system.next, self.step)?;
        }
        Ok(())
    }

    fn close(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Bodies);
        let active = system.bodies_active();
        if active {
            Self::kick(system, system.closing(system.pace.begin, system.pace.span));
        }
        if system.clock.synchronous() && self.mutual {
            system.recall_stray();
        }
        Ok(active)
    }

    fn open(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Bodies);
        let active = system.bodies_active();
        if active {
            Self::kick(system, system.opening(system.pace.next_span));
        }
        Ok(active)
    }
}
