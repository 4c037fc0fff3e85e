//! Dust: superparticles, each standing for a swarm of equal grains.

pub mod motion;
pub mod superparticles;

pub use superparticles::{Derived, Dust, Rates, Superparticles};
