//! Swarm: a superparticle as the exchange of ice and vapour sees it.

use std::f64::consts::PI;

use dust::sublimation::{Share, Water};

use super::Phases;
use crate::System;

/// A superparticle as the exchange sees it.
pub struct Swarm {
    number: f64,
    radius: f64,
    core: f64,
    ice: f64,
    water: Water,
}

impl Swarm {
    pub fn of(system: &System, phases: &Phases, i: usize) -> Self {
        let p = &system.dust.particles;
        let (radius, fractions) = (p.grain_radius[i], p.composition[i]);
        let volume = 4.0 / 3.0 * PI * radius.powi(3);
        Self {
            number: p.m[i] / (volume * phases.materials.density(fractions)),
            radius,
            core: radius * phases.materials.core(fractions),
            ice: fractions.x * p.m[i],
            water: phases.water,
        }
    }

    /// So large a part of it.
    pub fn share(&self, part: f64) -> Share {
        let (number, ice) = (part * self.number, part * self.ice);
        Share::new(number, self.radius, self.core, ice, &self.water)
    }
}
