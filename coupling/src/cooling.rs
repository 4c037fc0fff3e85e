//! Cooling of the gas as an operator: after all else at the end of each particle's step, and in the prediction of the next.
//!
//! It closes what the others' second halves have made of the step (law and order: [`gas::cooling`]), so that gas of a short cooling time
//! is seen at the temperature that it has. What it takes is radiated energy of the ledger.

use gas::Cooling;
use nbody::points::clock::Centre;
use nbody::points::{Fault, Vec3};

use crate::System;
use crate::ledger::Census;
use crate::operator::{Meter, Operator, Phase};

/// Cools gas about the star.
pub struct CoolGas {
    pub cooling: Cooling,
}

impl CoolGas {
    fn centre(system: &System) -> (Centre, Vec3) {
        match (system.seen.star_x.first(), system.seen.star_v.first()) {
            (Some(&x), Some(&v)) => {
                let gm = system.g * system.star.m[0];
                (Centre { x, gm }, v)
            }
            _ => (Centre::default(), Vec3::zeros()),
        }
    }
}

impl Operator for CoolGas {
    fn name(&self) -> &'static str {
        "cooling"
    }

    fn counted(&self, _: &System) -> bool {
        false
    }

    fn close(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Hydro);
        let (centre, drift) = Self::centre(system);
        let heat = system
            .gas
            .cool(&self.cooling, &system.clock, &centre, drift);
        let mut change = Census::default();
        change.0[0].internal = -heat.radiated;
        system.ledger.add(self.name(), &change);
        system.ledger.take(heat);
        Ok(true)
    }

    fn open(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Hydro);
        let (centre, drift) = Self::centre(system);
        system
            .gas
            .foresee(&self.cooling, &system.next, &centre, drift);
        Ok(false)
    }
}
