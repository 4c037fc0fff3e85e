//! A particle set: columns of quantities, sorted along a tree's curve, in a domain, on a clock.
//!
//! `gas`, `dust` and the bodies share nothing but this module.

pub mod clock;
pub mod columns;
pub mod domain;
pub mod exponential;
pub mod fault;
pub mod hill;
mod level;
pub mod random;
pub mod sort;
pub mod sum;
pub mod tree;

pub use clock::Clock;
pub use columns::{ColumnMut, ColumnRef, Columns, Dimension, Keep, Label, Scratch};
pub use domain::{Boundary, Domain};
pub use fault::{Fault, Population};
pub use hill::Hill;
pub use tree::{Node, Tree};

/// A vector in space, code units of its quantity.
pub type Vec3 = nalgebra::Vector3<f64>;

/// The length of a vector, also where the squares of its components leave the range of numbers.
pub fn length(v: Vec3) -> f64 {
    let (square, largest) = (v.norm_squared(), v.amax());
    if square.is_normal() || largest == 0.0 || !largest.is_finite() {
        square.sqrt()
    } else {
        largest * (v / largest).norm()
    }
}
