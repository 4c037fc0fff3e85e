//! Dust: superparticles, each standing for a swarm of equal grains.

pub mod coagulation;
pub mod composition;
pub mod motion;
pub mod outcome;
pub mod porosity;
pub mod relative_speed;
pub mod stirring;
pub mod stopping;
pub mod sublimation;
pub mod superparticles;

pub use composition::Materials;
pub use stirring::{Air, Turbulence};
pub use stopping::{Abreast, Ambient, Molecules, Sphere, StoppingLaw};
pub use superparticles::{Derived, Dust, Rates, Superparticles};
