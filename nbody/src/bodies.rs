//! Bodies: stars, planets and planetesimals; point masses with a radius.

use std::f64::consts::PI;

use crate::columns;
use crate::points::{Dimension, Label};

/// What a body is, for output and for who pulls whom directly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Planetesimal = 0,
    /// Named one by one in a scene; pulls gas and dust pair by pair instead of through the tree.
    Planet = 1,
    Star = 2,
}

columns! {
    /// State of bodies, code units. `a` holds the accelerations of the last kick by everything but the star.
    pub struct Bodies {
        /// identity
        id: Integer = Label::snapshot("ParticleIDs", Dimension::NONE, "identity"),
        /// position
        x: Vector = Label::snapshot("Coordinates", Dimension::LENGTH, "position"),
        /// velocity
        v: Vector = Label::snapshot("Velocities", Dimension::VELOCITY, "velocity"),
        /// mass
        m: Real = Label::snapshot("Masses", Dimension::MASS, "mass"),
        /// physical radius; for a star the accretion radius
        radius: Real = Label::snapshot("Radii", Dimension::LENGTH, "physical radius; for a star the accretion radius"),
        /// angular momentum of rotation
        spin: Vector = Label::snapshot("Spins", Dimension::ANGULAR_MOMENTUM, "angular momentum of rotation"),
        /// mass fractions of ice, rock and iron; empty unless the scene follows them
        composition: Vector = Label::snapshot("Compositions", Dimension::NONE, "mass fractions of ice, rock and iron").optional(),
        /// material density of a body without mass; zero where mass and radius give it, empty where they do for all
        density: Real = Label::checkpoint("MaterialDensities", Dimension::DENSITY, "material density of a body without mass").optional(),
        /// softening length of gravity (Plummer)
        softening: Real = Label::checkpoint("Softenings", Dimension::LENGTH, "softening length of gravity"),
        /// cut-off radius of the hybrid map; empty without it
        cutoff: Real = Label::checkpoint("Cutoffs", Dimension::LENGTH, "cut-off radius of the hybrid map").optional(),
        /// a [`Kind`]
        kind: Short = Label::checkpoint("Kinds", Dimension::NONE, "0 planetesimal, 1 planet, 2 star"),
        /// smoothing length of the gas around; zero if unknown, empty without gas
        h: Real = Label::checkpoint("SmoothingLengths", Dimension::LENGTH, "smoothing length of the gas around").optional(),
        /// gravitational potential when last reported
        potential: Real = Label::checkpoint("Potentials", Dimension::SPECIFIC_ENERGY, "gravitational potential"),
        /// acceleration at the last kick, without the star's pull
        a: Vector = Label::checkpoint("KickAccelerations", Dimension::ACCELERATION, "acceleration at the last kick, without the star's pull"),
    }
}

impl Bodies {
    /// Mean density of body `i`; zero for a point.
    pub fn mean_density(&self, i: usize) -> f64 {
        let (m, radius) = (self.m[i], self.radius[i]);
        if m == 0.0 || radius == 0.0 {
            self.density.get(i).copied().unwrap_or(0.0)
        } else {
            0.75 * m / (PI * radius.powi(3))
        }
    }
}
