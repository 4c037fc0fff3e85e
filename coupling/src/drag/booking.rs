//! Booking: what an exchange moved between populations.

use std::ops::AddAssign;

use nbody::points::Vec3;

/// What one side gained.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Change {
    pub momentum: Vec3,
    /// about the origin
    pub angular_momentum: Vec3,
    /// kinetic energy, by the velocities predicted to now
    pub kinetic: f64,
}

impl Change {
    /// An impulse that changes the velocity `v` of a mass `m` at `x` by `dv`.
    pub fn add(&mut self, (x, v): (Vec3, Vec3), m: f64, dv: Vec3) {
        self.momentum += m * dv;
        self.angular_momentum += m * x.cross(&dv);
        self.kinetic += m * dv.dot(&(v + 0.5 * dv));
    }
}

/// What an exchange moved. `gas.kinetic + immersed.kinetic + heat + radiated = kick`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Booking {
    /// What the gas gained; without reaction, what was given away.
    pub gas: Change,
    pub immersed: Change,
    /// frictional heat that the gas kept
    pub heat: f64,
    /// frictional heat that was radiated
    pub radiated: f64,
    /// What gas bound to a temperature gave off beyond that: heat that pressure was taken to have made of velocities that drag has changed.
    pub work: f64,
    /// Kinetic energy that drag passes to the kick of the same half step; of opposite sign in closing and opening halves.
    pub kick: f64,
    /// Particles at an edge of the gas, which saw it turn rigidly instead of linearly.
    pub rigid: usize,
    /// Particles with so few or so one-sided neighbours that their exchange did not keep angular momentum.
    pub plain: usize,
    /// Particles without gas within reach.
    pub without_gas: usize,
    /// Momentum that the frame of a shearing box made of impulses on gas in mid-step.
    pub frame: Vec3,
}

impl AddAssign for Change {
    fn add_assign(&mut self, other: Self) {
        self.momentum += other.momentum;
        self.angular_momentum += other.angular_momentum;
        self.kinetic += other.kinetic;
    }
}

impl AddAssign for Booking {
    fn add_assign(&mut self, other: Self) {
        self.gas += other.gas;
        self.immersed += other.immersed;
        self.heat += other.heat;
        self.radiated += other.radiated;
        self.work += other.work;
        self.kick += other.kick;
        self.rigid += other.rigid;
        self.plain += other.plain;
        self.without_gas += other.without_gas;
        self.frame += other.frame;
    }
}
