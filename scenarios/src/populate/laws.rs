//! Laws of a scene as the populations' crates have them: of the gas, of drag, and of collisions.

use dust::{Molecules, StoppingLaw};
use gas::cooling::{Duration, Profile};
use gas::eos::tillotson::MATERIALS;
use gas::{Conduction, Cooling, Eos, Hydro};
use nbody::collisions::{Law, Limits, Restitution, Strength};
use nbody::points::Dimension;

use crate::scene::{self, Scene};

/// The adiabatic index that gas of a prescribed temperature counts its internal energy with.
const GAMMA_BOUND: f64 = 5.0 / 3.0;

fn eos(scene: &Scene, eos: &scene::Eos) -> Eos {
    match eos {
        scene::Eos::Ideal { gamma } => Eos::Ideal { gamma: *gamma },
        scene::Eos::Isothermal { sound_speed } => Eos::Isothermal {
            sound_speed: *sound_speed,
            gamma: GAMMA_BOUND,
        },
        scene::Eos::LocallyIsothermal {
            sound_speed,
            exponent,
            reference_radius,
            ..
        } => Eos::LocallyIsothermal {
            sound_speed: *sound_speed,
            radius: *reference_radius,
            exponent: *exponent,
            gamma: GAMMA_BOUND,
        },
        scene::Eos::Barotropic(law) => Eos::Barotropic(*law),
        scene::Eos::Stiffened(law) => Eos::Stiffened(*law),
        scene::Eos::Tillotson { material } => {
            let found = MATERIALS.iter().find(|(name, _)| name == material);
            let (_, law) = found.expect("a material of the list");
            let units = &scene.units;
            let unit = |dimension| units.cgs(dimension);
            Eos::Tillotson(law.in_units(unit(Dimension::DENSITY), unit(Dimension::SPECIFIC_ENERGY)))
        }
        scene::Eos::Tabulated { table, .. } => Eos::Tabulated(table.clone()),
    }
}

/// The settings of the hydrodynamics of a scene's gas.
pub fn hydro(scene: &Scene, gas: &scene::Gas) -> Hydro {
    let eos = eos(scene, &gas.eos);
    Hydro {
        kernel: gas.hydro.kernel,
        neighbours: gas.hydro.neighbours,
        tolerance: gas.hydro.tolerance,
        background_pressure: gas.hydro.background_pressure,
        precision: gas.hydro.precision,
        formulation: gas.hydro.formulation,
        exponent: gas.hydro.exponent,
        grad_h: gas.hydro.grad_h,
        gradient: gas.hydro.gradient,
        viscosity: gas.viscosity,
        reconstruction: gas.reconstruction,
        physical: gas.physical,
        conduction: Conduction {
            alpha: gas.conduction,
        },
        courant: gas.hydro.courant,
        force_factor: scene.accuracy.acceleration_step,
        ..Hydro::new(scene.domain, eos)
    }
}

/// How the scene's gas cools; none if it does not.
pub fn cooling(gas: &scene::Gas) -> Option<Cooling> {
    let scene::Eos::Ideal { gamma } = gas.eos else {
        return None;
    };
    let profile = |towards: &scene::Temperature| Profile {
        sound_speed: towards.sound_speed,
        radius: towards.reference_radius,
        exponent: towards.exponent,
    };
    match &gas.cooling {
        scene::Cooling::None => None,
        scene::Cooling::Beta { beta, floor } => Some(Cooling {
            duration: Duration::Orbital(*beta),
            profile: floor.as_ref().map(profile),
            warms: false,
            gamma,
        }),
        scene::Cooling::Relaxation { time, towards } => Some(Cooling {
            duration: match *time {
                scene::CoolingTime::Orbital(beta) => Duration::Orbital(beta),
                scene::CoolingTime::Time(time) => Duration::Time(time),
            },
            profile: Some(profile(towards)),
            warms: true,
            gamma,
        }),
    }
}

/// Molecules of the scene's gas in its units: mass from the mean molecular weight, cross section of H2.
pub fn molecules(scene: &Scene) -> Molecules {
    let particles = scene.gas.as_ref().and_then(|gas| gas.mean_molecular_weight);
    let formula = (scene.surroundings.disk.as_ref()).map(|disk| disk.mean_molecular_weight);
    molecules_of(scene, particles.or(formula).unwrap_or(2.34))
}

/// Molecules of mean weight `mu`.
fn molecules_of(scene: &Scene, mu: f64) -> Molecules {
    /// Mass of a hydrogen atom, g (CODATA 2018).
    const HYDROGEN: f64 = 1.673_532_84e-24;
    /// Collision cross section of H2, cm^2 (Chapman & Cowling 1970, as used since Nakagawa et al. 1986).
    const CROSS_SECTION: f64 = 2.0e-15;
    let length = scene.units.length;
    Molecules {
        mass: mu * HYDROGEN / scene.units.mass,
        cross_section: CROSS_SECTION / (length * length),
    }
}

/// The law that grains are stopped by.
pub fn dust_law(scene: &Scene, dust: &scene::Dust) -> StoppingLaw {
    match dust.drag {
        scene::DustDrag::None => StoppingLaw::None,
        scene::DustDrag::Epstein => StoppingLaw::Epstein,
        scene::DustDrag::Stokes => StoppingLaw::Stokes(molecules(scene)),
        scene::DustDrag::Auto => StoppingLaw::Auto(molecules(scene)),
        scene::DustDrag::Adachi => StoppingLaw::Adachi(molecules(scene)),
        scene::DustDrag::Quadratic(coefficient) => StoppingLaw::Quadratic(coefficient),
        scene::DustDrag::ConstantStoppingTime(t) => StoppingLaw::ConstantStoppingTime(t),
        scene::DustDrag::ConstantStokesNumber(st) => StoppingLaw::ConstantStokes(st),
    }
}

/// The law that bodies are stopped by.
pub fn body_law(scene: &Scene, bodies: &scene::Planetesimals) -> StoppingLaw {
    stopping_law(bodies.drag, molecules(scene))
}

/// The law that bodies are stopped by in an analytic disk.
pub fn disk_law(scene: &Scene, disk: &scene::GasDisk) -> StoppingLaw {
    stopping_law(disk.drag, molecules_of(scene, disk.mean_molecular_weight))
}

fn stopping_law(drag: scene::BodyDrag, molecules: Molecules) -> StoppingLaw {
    match drag {
        scene::BodyDrag::None => StoppingLaw::None,
        scene::BodyDrag::Adachi => StoppingLaw::Adachi(molecules),
        scene::BodyDrag::ConstantStoppingTime(t) => StoppingLaw::ConstantStoppingTime(t),
        scene::BodyDrag::Quadratic(coefficient) => StoppingLaw::Quadratic(coefficient),
    }
}

/// What happens to bodies that touch; none if nothing does.
pub fn collisions(bodies: &scene::Planetesimals) -> Option<Law> {
    match bodies.collisions {
        scene::Collisions::None => None,
        scene::Collisions::Merge => Some(Law::Merge),
        scene::Collisions::Bounce {
            restitution,
            tangential_restitution,
        } => Some(Law::Bounce(Restitution {
            normal: restitution,
            tangential: tangential_restitution,
        })),
        scene::Collisions::Fragment {
            fragment_mass,
            most_fragments,
            c_star,
            mu,
            reference_density,
        } => Some(Law::Fragment(
            Strength {
                offset: c_star,
                coupling: mu,
                density: reference_density,
            },
            Limits {
                least: fragment_mass,
                most: most_fragments,
            },
        )),
    }
}
