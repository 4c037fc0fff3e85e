//! What viscosity does to gas in place: its accelerations, by forces with and without it.

use coupling::System;
use gas::{Gas, Hydro, Viscosity};
use nbody::points::Vec3;

use crate::populate;
use crate::trial::Trial;

/// The gas of a trial as it would be without viscosity.
pub struct Inviscid(Hydro);

impl Inviscid {
    pub fn of(trial: &Trial) -> Self {
        let gas = trial.scene.gas.as_ref().expect("a scene of gas");
        Self(Hydro {
            viscosity: Viscosity::None,
            ..populate::hydro(&trial.scene, gas)
        })
    }

    /// Accelerations of a closed system's gas by pressure alone.
    pub fn pushes(&self, system: &System) -> Vec<Vec3> {
        let mut still: Gas = system.gas.clone();
        still.particles.alpha.fill(0.0);
        let hydro = self.0.clone().at(system.clock.time());
        still.forces(&hydro, &system.clock, &system.clock);
        still.rates.hydro
    }

    /// Accelerations by viscosity.
    pub fn drags(&self, system: &System) -> Vec<Vec3> {
        let all = system.gas.rates.hydro.iter();
        let pressure = self.pushes(system);
        all.zip(&pressure).map(|(all, push)| all - push).collect()
    }
}
