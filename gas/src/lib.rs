//! Gas: self-gravitating smoothed particle hydrodynamics.

pub mod particles;

pub use particles::{Derived, Gas, Particles, Rates};
