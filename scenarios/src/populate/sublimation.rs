//! Sublimation: from a scene's composition of grains to the columns that it fills and the laws of its water.

use coupling::sublimation::Phases;
use dust::Superparticles;
use dust::sublimation::{MOLECULE, SATURATION, Water};
use gas::{Hydro, Particles};
use nbody::points::{Columns, Dimension, Vec3};

use super::molecules;
use crate::read::composition::materials;
use crate::scene::Scene;

/// Boltzmann's constant, erg/K (SI 2019).
const BOLTZMANN: f64 = 1.380_649e-16;
/// A pascal, erg/cm^3.
const PASCAL: f64 = 10.0;

/// Kelvins by the square of the isothermal sound speed of the scene's gas, in code units.
pub fn kelvins(scene: &Scene) -> f64 {
    let speed = scene.units.length / scene.units.time;
    molecules(scene).mass * scene.units.mass * speed * speed / BOLTZMANN
}

/// How ice sublimates in the scene's gas; none if it does not.
pub fn phases(scene: &Scene, hydro: &Hydro) -> Option<Phases> {
    let composition = scene.dust.as_ref()?.composition?;
    if !composition.sublimation {
        return None;
    }
    let materials = materials(&scene.units);
    let speed = scene.units.length / scene.units.time;
    let [log, rest @ ..] = SATURATION;
    let unit = scene.units.cgs(Dimension::PRESSURE) / PASCAL;
    Some(Phases {
        water: Water {
            ice: materials.ice(),
            gas_constant: BOLTZMANN / MOLECULE / (speed * speed),
            saturation: [log - unit.ln(), rest[0], rest[1], rest[2]],
        },
        materials,
        kelvins: kelvins(scene),
        neighbours: hydro.neighbours,
        heat_share: match hydro.eos.is_free() {
            true => scene.coupling.heat_share,
            false => 0.0,
        },
    })
}

/// Gives the grains their composition, those that have none of their own, and the density that follows.
pub fn mix(scene: &Scene, dust: &mut Superparticles) {
    let Some(composition) = scene.dust.as_ref().and_then(|dust| dust.composition) else {
        return;
    };
    let materials = materials(&scene.units);
    dust.composition.resize(dust.len(), Vec3::zeros());
    let grains = dust.composition.iter_mut().zip(&mut dust.grain_density);
    for (fractions, density) in grains {
        if *fractions == Vec3::zeros() {
            *fractions = Vec3::from(composition.fractions);
        }
        *density = materials.density(*fractions);
    }
}

/// Makes room for the vapour in the gas, where ice sublimates; what a file brings of it stays.
pub fn moisten(scene: &Scene, gas: &mut Particles) {
    let composition = scene.dust.as_ref().and_then(|dust| dust.composition);
    if composition.is_some_and(|composition| composition.sublimation) {
        gas.vapour.resize(gas.len(), 0.0);
    }
}
