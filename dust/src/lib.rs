//! Dust: superparticles, each standing for a swarm of equal grains.

pub mod coagulation;
pub mod motion;
pub mod outcome;
pub mod porosity;
pub mod relative_speed;
pub mod stopping;
pub mod superparticles;

pub use stopping::{Ambient, Molecules, Sphere, StoppingLaw};
pub use superparticles::{Derived, Dust, Rates, Superparticles};
