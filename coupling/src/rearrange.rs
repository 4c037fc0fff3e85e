//! Rearrangement of the gas as an operator, once a base step: when everybody has arrived at its end, all particles are moved, before densities and
//! forces are found there; when everybody's step is closed, velocities and energies are given what keeps the sums (law: [`gas::rearrangement`]).
//!
//! What the moved particles gain or lose in gravity is not made up for: it is in the error of the energy.

use gas::rearrangement::Order;
use gas::{Hydro, Rearrangement};
use nbody::points::Fault;

use crate::System;
use crate::ledger::Census;
use crate::operator::{Meter, Operator, Phase};

/// Rearranges gas.
pub struct RearrangeGas {
    hydro: Hydro,
    law: Rearrangement,
    /// Whether a shift waits for its settlement.
    shifted: bool,
}

impl RearrangeGas {
    pub fn new(hydro: Hydro, order: Order) -> Self {
        Self {
            hydro,
            law: Rearrangement::new(order),
            shifted: false,
        }
    }
}

impl Operator for RearrangeGas {
    fn name(&self) -> &'static str {
        "rearrangement"
    }

    fn counted(&self, _: &System) -> bool {
        false
    }

    fn prepare(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<(), Fault> {
        let dt = system.clock.end - system.clock.start;
        self.shifted = system.clock.synchronous() && dt > 0.0;
        if self.shifted {
            meter.enter(Phase::Hydro);
            self.hydro.domain = system.domain;
            let (crossed, solves) = self.law.shift(&mut system.gas, &self.hydro, dt);
            system.solves = system.solves.and(solves);
            system.ledger.receive(crossed);
            meter.count(0, 0);
        }
        Ok(())
    }

    fn close(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        self.law.begin(&mut system.gas);
        if !std::mem::take(&mut self.shifted) {
            return Ok(false);
        }
        meter.enter(Phase::Hydro);
        let settled = self.law.settle(&mut system.gas, &self.hydro);
        let mut change = Census::default();
        let gas = &mut change.0[0];
        (gas.momentum, gas.angular_momentum) = (settled.momentum, settled.angular_momentum);
        (gas.kinetic, gas.internal) = (settled.kinetic, settled.internal);
        system.ledger.add(self.name(), &change);
        system.ledger.take(settled.heat);
        Ok(true)
    }
}
