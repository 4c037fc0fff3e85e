//! What the gas holds altogether: the sums that must be conserved.

use std::ops::Add;

use nbody::points::{Vec3, sum};

use crate::Gas;

/// Sums over all gas, code units; angular momentum about the origin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    pub mass: f64,
    pub momentum: Vec3,
    pub angular_momentum: Vec3,
    pub kinetic: f64,
    pub internal: f64,
}

impl Add for Totals {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            mass: self.mass + other.mass,
            momentum: self.momentum + other.momentum,
            angular_momentum: self.angular_momentum + other.angular_momentum,
            kinetic: self.kinetic + other.kinetic,
            internal: self.internal + other.internal,
        }
    }
}

impl Gas {
    /// Sums over all gas; those of velocity and energy belong to one time only when a synchronous step is closed.
    pub fn totals(&self) -> Totals {
        let p = &self.particles;
        sum::ordered(self.len(), Totals::default(), |range| {
            range.fold(Totals::default(), |sum, i| {
                let momentum = p.m[i] * p.v[i];
                sum + Totals {
                    mass: p.m[i],
                    momentum,
                    angular_momentum: p.x[i].cross(&momentum),
                    kinetic: 0.5 * momentum.dot(&p.v[i]),
                    internal: p.m[i] * p.u[i],
                }
            })
        })
    }
}
