//! What every particle set shares (`points`: columns, domain, clock, tree, sums, keyed random numbers), and the bodies: star, planets,
//! planetesimals, their gravity, orbits, integrators and collisions.

pub mod bodies;
pub mod collisions;
pub mod encounters;
pub mod gravity;
pub mod integrators;
pub mod kepler;
pub mod orbit;
pub mod points;

pub use bodies::{Bodies, Kind};
