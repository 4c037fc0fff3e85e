//! Growth of grains as an operator: collisions over the second half of a base step at its end, and over the first half of the next.
//!
//! It stands first in the list: it closes after all others and opens before them, so a base step reads growth | kick drag drift drag kick |
//! growth, with everybody at one time at either end. Each half is the exact process in the gas and the places of its end of the step
//! (law: [`dust::coagulation`]), so the composition is of second order in the base step (Strang 1968), for the expected sizes. Base steps
//! are a part of 1/Omega, growth takes hundreds of those.
//! Nothing that the ledger counts changes: swarms keep mass and velocity. Gas density, sound speed and velocity around a grain are
//! those that its drag found, and stopping times of grains that changed are found anew.

use dust::coagulation::{Coagulation, Kernel, MOST, Place};
use nbody::points::{Fault, Population, Vec3};

use crate::System;
use crate::operator::{Meter, Operator, Phase};

/// Collisions of grains.
pub struct GrowDust {
    coagulation: Coagulation,
}

impl GrowDust {
    pub fn new(kernel: Kernel, seed: u64) -> Self {
        Self {
            coagulation: Coagulation::new(kernel, seed),
        }
    }

    /// Whether collisions need to know the gas.
    fn sees_gas(&self) -> bool {
        matches!(self.coagulation.kernel, Kernel::Physical(_))
    }

    fn act(
        &mut self,
        system: &mut System,
        dt: f64,
        step: u64,
        meter: &mut dyn Meter,
    ) -> Result<(), Fault> {
        meter.enter(Phase::Dust);
        let centre = system.seen.star_x.first().copied();
        let gm = system.star.m.first().map_or(0.0, |m| system.g * m);
        let rate = system.domain.hill().map_or(0.0, |hill| hill.rate);
        let middle = match (centre, system.domain.size()) {
            (Some(x), _) => x.z,
            (None, Some(size)) => 0.5 * size.z,
            (None, None) => 0.0,
        };
        let x = std::mem::take(&mut system.dust.particles.x);
        let place = |i: usize| Place {
            omega: centre.map_or(rate, |c: Vec3| (gm / (x[i] - c).norm().powi(3)).sqrt()),
            height: x[i].z - middle,
        };
        let tally = self.coagulation.advance(&mut system.dust, &place, dt, step);
        system.dust.particles.x = x;
        system.ledger.whole += tally.whole;
        meter.count(system.dust.len(), tally.total());
        if tally.crowded == 0 {
            return Ok(());
        }
        Err(Fault::Stuck {
            population: Population::Dust,
            id: system.dust.particles.id[0],
            reason: format!(
                "in {} cells of grains more than {MOST:e} collisions would fall into a step of {dt:e}",
                tally.crowded
            ),
            time: system.clock.time(),
        })
    }
}

impl Operator for GrowDust {
    fn name(&self) -> &'static str {
        "growth"
    }

    fn counted(&self, _: &System) -> bool {
        false
    }

    fn prepare(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<(), Fault> {
        if !system.clock.synchronous() {
            return Ok(());
        }
        meter.enter(Phase::Dust);
        let (dust, domain) = (&mut system.dust, &system.domain);
        (self.coagulation.cells).divide(&dust.particles.x, &dust.tree, domain);
        if self.sees_gas() {
            // Filled by drag before they are looked at.
            let n = dust.particles.x.len();
            dust.derived.c_gas.resize(n, 0.0);
            dust.derived.slip.resize(n, Vec3::zeros());
        }
        Ok(())
    }

    fn close(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        let dt = system.clock.end - system.clock.start;
        if system.clock.synchronous() && dt > 0.0 {
            self.act(system, 0.5 * dt, 2 * system.clock.step, meter)?;
        }
        Ok(false)
    }

    fn open(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        if system.clock.synchronous() {
            let dt = system.next.end - system.next.start;
            self.act(system, 0.5 * dt, 2 * system.clock.step + 1, meter)?;
        }
        Ok(false)
    }
}
