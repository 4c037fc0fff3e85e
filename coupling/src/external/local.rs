//! What pulls gas and dust in a shearing box beside Coriolis force and tide: the star's vertical gravity, and the pressure gradient of the disk.
//!
//! gas:  a = 2 Omega w e_x - Omega^2 (z - z_0) e_z,   dust:  a = -Omega^2 (z - z_0) e_z
//!
//! w = eta v_K is how much slower than Kepler's the disk turns where there is no dust; a box has no gradient of its own across periodic faces.
//! Source: Bai & Stone (2010), ApJ 722, 1437, section 2.

use nbody::points::{Fault, Vec3};

use crate::System;
use crate::operator::{Meter, Operator, Phase};

/// Pulls that depend on the place alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Local {
    /// Acceleration of the gas by the pressure gradient of the disk, along x.
    pub push: f64,
    /// Acceleration by height; zero without vertical gravity.
    pub square_frequency: f64,
    /// z_0.
    pub middle: f64,
}

impl Local {
    fn vertical(&self, x: Vec3) -> Vec3 {
        Vec3::new(0.0, 0.0, self.square_frequency * (self.middle - x.z))
    }
}

impl Operator for Local {
    fn name(&self) -> &'static str {
        "local forces"
    }

    fn counted(&self, _: &System) -> bool {
        false
    }

    fn prepare(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<(), Fault> {
        meter.enter(Phase::Gravity);
        let push = Vec3::new(self.push, 0.0, 0.0);
        if !system.gas.is_empty() {
            (system.gas).pull(|_, particles, i| push + self.vertical(particles.x[i]));
        }
        let (clock, dust) = (&system.clock, &mut system.dust);
        let p = &dust.particles;
        for (i, pull) in dust.rates.gravity.iter_mut().enumerate() {
            if clock.synchronous() || p.end[i] == clock.tick {
                *pull = self.vertical(p.x[i]);
            }
        }
        Ok(())
    }
}
