//! Integrators: how the bodies move between two kicks, and what belongs to the kick.
//!
//! A coupled step is: open kick (half a step), drift, close kick (half a step). What each integrator takes into its drift, and what it
//! leaves to the kick:
//!
//! | integrator | drift | kick |
//! | --- | --- | --- |
//! | leapfrog | straight lines | everything, the star's pull too ([`central`]) |
//! | Wisdom-Holman | Kepler orbits about the star | everything but the star's pull |
//! | Wisdom-Holman, Jacobi | all bodies and the star on each other, equal steps | nothing |
//! | Gauss-Radau | all bodies and the star on each other, adaptive | gas and dust |

pub mod central;
pub mod gauss_radau;
pub mod hermite;
pub mod hybrid;
pub mod leapfrog;
#[cfg(test)]
mod problems;
pub mod wisdom_holman;

use rayon::prelude::*;

use crate::kepler;
use crate::points::Vec3;
use crate::points::sum::CHUNK;

/// The integrators that a scene can name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Integrator {
    Leapfrog,
    WisdomHolman,
    GaussRadau,
}

impl Integrator {
    /// Whether the star's pull on the bodies, and theirs on the star, belongs to the kick.
    pub fn kicks_by_star(self) -> bool {
        self == Self::Leapfrog
    }

    /// Whether the bodies' pulls on each other belong to the kick.
    pub fn kicks_by_bodies(self) -> bool {
        self != Self::GaussRadau
    }
}

/// Where star and bodies will be at a time inside the step. Buffers are kept between calls.
#[derive(Clone, Debug, Default)]
pub struct Ahead {
    /// Zero without a star.
    pub x_star: Vec3,
    pub v_star: Vec3,
    pub x: Vec<Vec3>,
    pub v: Vec<Vec3>,
}

/// A body that cannot be moved: its place among the bodies, and why. The other bodies may have moved already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stuck {
    pub place: usize,
    pub refusal: kepler::Refusal,
}

/// Changes velocities by accelerations `a` over `dt`.
pub fn kick(v: &mut [Vec3], a: &[Vec3], dt: f64) {
    assert_eq!(v.len(), a.len(), "an acceleration a body");
    v.par_iter_mut()
        .zip(a)
        .with_min_len(CHUNK)
        .for_each(|(v, a)| *v += a * dt);
}
