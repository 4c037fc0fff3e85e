//! The error to be expected of a run, where an order and a size of it are known; elsewhere that it is not.
//!
//! Bodies, s = Omega dt at the closest pericentre: Wisdom-Holman and hybrid maps keep the energy within (m / M) s^2 / 12, m being all bodies' mass
//! (second order; Wisdom & Holman 1991); leapfrog about the star within e s^2; Gauss-Radau at rounding, growing as the root of the steps
//! (Rein & Spiegel 2015). Each is an upper size, within a factor of a few for two planets, and too large for many bodies.

use coupling::System;
use nbody::points::Columns;

use crate::assemble;
use crate::scene::{GravityMethod, Integrator, Opening, Scene, TimeStep};

/// Sentences on the errors of the scene.
pub fn sentences(scene: &Scene, system: &System) -> Vec<String> {
    let mut said = Vec::new();
    if !system.bodies.is_empty() && !system.star.is_empty() {
        said.push(of_bodies(scene, system));
    }
    if !system.gas.is_empty() {
        said.push("gas: second order in the step and, where it is smooth, in h; size unknown: measure it by tridisk trade".to_owned());
    }
    if !system.dust.is_empty() {
        said.push("drag on dust: first order where a step is longer than the stopping time, second elsewhere; size unknown".to_owned());
    }
    let pulled =
        scene.gravity.method == GravityMethod::Tree && system.gas.len() + system.dust.len() > 0;
    if let (true, Opening::ForceError(error), Some(star)) =
        (pulled, scene.gravity.opening, system.star.m.first())
    {
        let sum = |m: &[f64]| m.iter().sum::<f64>();
        let mass =
            sum(&system.gas.particles.m) + sum(&system.dust.particles.m) + sum(&system.bodies.m);
        said.push(format!(
            "tree: force wrong by {error:e} rms, {:.1e} of the star's pull",
            error * mass / star
        ));
    }
    said
}

fn of_bodies(scene: &Scene, system: &System) -> String {
    let (bodies, star) = (&system.bodies, system.star.m[0]);
    let step = match scene.planetesimals.map(|p| p.time_step) {
        Some(TimeStep::Fixed(dt)) => {
            let rates = bodies
                .x
                .iter()
                .map(|x| (system.g * star / (x - system.star.x[0]).norm().powi(3)).sqrt());
            dt * rates.fold(0.0, f64::max)
        }
        _ => scene.accuracy.orbit_step,
    };
    let mass: f64 = bodies.m.iter().sum();
    match assemble::chosen(scene, system) {
        Integrator::WisdomHolman | Integrator::Hybrid => {
            let size = mass / star * step * step / 12.0;
            format!("bodies: second order in the step, energy within {size:.0e}")
        }
        Integrator::Leapfrog => {
            let shape = scene.planetesimals.map_or(0.0, |p| p.eccentricity);
            let planets = scene
                .planets
                .iter()
                .filter_map(|planet| match planet.orbit {
                    crate::scene::Orbit::Elements { eccentricity, .. } => Some(eccentricity),
                    crate::scene::Orbit::State { .. } => None,
                });
            let e = planets.fold(shape, f64::max);
            format!(
                "bodies: second order in the step, energy within {:.0e}, orbits turn by {:.0e} a radian",
                e * step * step,
                step * step / 24.0
            )
        }
        Integrator::GaussRadau => {
            "bodies: 15th order, energy at rounding (1e-15) times the root of the number of steps"
                .to_owned()
        }
        _ => {
            "bodies: fourth order in the step; size unknown: measure it by tridisk trade".to_owned()
        }
    }
}
