//! The start of a run: where particles and bodies are and how they move, from parameters and a seed. Code units throughout.

pub mod belt;
pub mod disk;
pub mod from_file;
pub mod glass;
pub mod grains;
pub mod lattice;
pub mod layer;
pub mod strewn;

use gas::Particles;
use nbody::points::{Columns, Vec3};

/// How a kernel measures the room of a particle: `neighbours` in a ball of radius `support` times h.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    pub neighbours: f64,
    /// Radius of the kernel's support by h, h being twice the kernel's standard deviation.
    pub support: f64,
}

impl Default for Resolution {
    /// Wendland C2 in three dimensions with 64 neighbours.
    fn default() -> Self {
        Self {
            neighbours: 64.0,
            support: 0.5 * 15f64.sqrt(),
        }
    }
}

impl Resolution {
    /// h of particles of which one takes up `volume` (an area in two dimensions).
    pub fn smoothing_length(&self, volume: f64, dimensions: usize) -> f64 {
        glass::radius(self.neighbours * volume, dimensions) / self.support
    }
}

/// Equal-mass gas at rest at the points `x`, with ids from `first_id` on and smoothing lengths `h`.
pub fn gas(x: Vec<Vec3>, h: Vec<f64>, mass: f64, first_id: u64) -> Particles {
    assert_eq!(x.len(), h.len(), "a smoothing length a point");
    let n = x.len();
    let mut particles = Particles {
        id: (first_id..).take(n).collect(),
        m: vec![mass; n],
        x,
        h,
        ..Particles::default()
    };
    particles.resize(n);
    particles
}

/// The digits of i in a base, mirrored at the point: a sequence that fills the unit interval evenly at every length.
fn mirrored(mut i: usize, base: usize) -> f64 {
    let (mut value, mut unit) = (0.0, 1.0);
    while i > 0 {
        unit /= base as f64;
        value += unit * (i % base) as f64;
        i /= base;
    }
    value
}
