//! Drifts: everybody moves to the next tick. Star and bodies move by their own integrator when their step ends there; before that
//! they are seen through its prediction.

use nbody::integrators::wisdom_holman;
use nbody::points::Fault;

use crate::System;
use crate::operator::{Meter, Operator, Phase};

/// Moves the gas.
pub struct DriftGas;

impl Operator for DriftGas {
    fn name(&self) -> &'static str {
        "drift gas"
    }

    fn cross(&mut self, system: &mut System, dt: f64, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Hydro);
        let domain = system.domain;
        system.gas.drift(dt, &domain);
        Ok(true)
    }
}

/// Moves the dust.
pub struct DriftDust;

impl Operator for DriftDust {
    fn name(&self) -> &'static str {
        "drift dust"
    }

    fn cross(&mut self, system: &mut System, dt: f64, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Dust);
        let domain = system.domain;
        system.dust.drift(dt, &domain);
        Ok(true)
    }
}

/// The time since the bodies' step began.
fn elapsed(system: &System) -> f64 {
    f64::from(system.clock.tick - system.pace.begin) * system.clock.unit()
}

/// Moves star and bodies by straight lines.
pub struct DriftStraight;

impl Operator for DriftStraight {
    fn name(&self) -> &'static str {
        "drift bodies"
    }

    fn cross(&mut self, system: &mut System, _: f64, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Bodies);
        let dt = elapsed(system);
        let active = system.bodies_active();
        let seen = &mut system.seen;
        for (bodies, x) in [(&mut system.star, &mut seen.star_x), (&mut system.bodies, &mut seen.x)] {
            for ((seen, x), v) in x.iter_mut().zip(&mut bodies.x).zip(&bodies.v) {
                *seen = *x + *v * dt;
                if active {
                    *x = *seen;
                }
            }
        }
        Ok(active)
    }
}

/// Moves star and bodies by the Kepler map of Wisdom & Holman (1991) in democratic heliocentric coordinates.
pub struct DriftKepler;

impl Operator for DriftKepler {
    fn name(&self) -> &'static str {
        "drift bodies"
    }

    fn cross(&mut self, system: &mut System, _: f64, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Bodies);
        let dt = elapsed(system);
        meter.count(system.bodies.x.len(), 0);
        if system.bodies_active() {
            wisdom_holman::drift(&mut system.star, &mut system.bodies, system.g, dt);
            system.look();
            return Ok(true);
        }
        let seen = &mut system.seen;
        wisdom_holman::predict(&system.star, &system.bodies, system.g, dt, seen);
        Ok(false)
    }
}
