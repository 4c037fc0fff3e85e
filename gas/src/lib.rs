//! Gas: self-gravitating smoothed particle hydrodynamics.

pub mod particles;
pub mod probe;

pub use particles::{Derived, Gas, Particles, Rates};
