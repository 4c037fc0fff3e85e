//! Choice: the integrator of bodies that a scene names, or the one that suits it at its start.

use coupling::System;
use nbody::points::Columns;

use crate::scene::{Integrator, Scene};
use crate::validate;

/// The integrators that a run can choose, by their numbers in checkpoints.
const CHOICES: [(u64, Integrator, &str); 5] = [
    (1, Integrator::WisdomHolman, "wisdom-holman"),
    (2, Integrator::Hybrid, "hybrid"),
    (3, Integrator::GaussRadau, "gauss-radau"),
    (4, Integrator::Leapfrog, "leapfrog"),
    (5, Integrator::Epicycles, "epicycles"),
];

/// The integrator of an assembled system.
pub fn chosen(scene: &Scene, system: &System) -> Integrator {
    let wanted = scene
        .planetesimals
        .map_or(Integrator::Auto, |p| p.integrator);
    let known = CHOICES.iter().find(|choice| choice.0 == system.chosen);
    match (wanted, known) {
        (Integrator::Auto, Some(&(_, choice, _))) => choice,
        _ => wanted,
    }
}

/// The integrator that the scene names, or the one that suits it at its start.
pub(super) fn integrator(
    scene: &Scene,
    system: &mut System,
    remarks: &mut Vec<String>,
) -> Integrator {
    let wanted = scene
        .planetesimals
        .as_ref()
        .map_or(Integrator::Auto, |p| p.integrator);
    if wanted != Integrator::Auto {
        return wanted;
    }
    let known = CHOICES.iter().find(|choice| choice.0 == system.chosen);
    if let Some(&(_, choice, _)) = known {
        return choice;
    }
    let (choice, reason) = suitable(scene, system);
    let named = CHOICES.iter().find(|named| named.1 == choice);
    let &(number, _, name) = named.expect("a number for each choice");
    system.chosen = number;
    if !system.bodies.is_empty() {
        remarks.push(format!("integrator of bodies: {name}, since {reason}"));
    }
    choice
}

/// The integrator that suits the system, and why.
fn suitable(scene: &Scene, system: &System) -> (Integrator, &'static str) {
    let few = system.bodies.len() <= 16 && system.gas.is_empty() && system.dust.is_empty();
    if scene.domain.hill().is_some() {
        (Integrator::Epicycles, "the box is a shearing box")
    } else if !system.star.is_empty() {
        if validate::all_bodies_pull(scene) && orbits_meet(system) {
            (
                Integrator::Hybrid,
                "a star dominates and bodies with mass can meet",
            )
        } else {
            (Integrator::WisdomHolman, "a star dominates")
        }
    } else if few {
        (
            Integrator::GaussRadau,
            "there is no star and there are few bodies",
        )
    } else {
        (Integrator::Leapfrog, "there is no star")
    }
}

/// Whether the distances from the star of two bodies that pull come within three mutual Hill radii of each other, and softening leaves
/// that to be felt.
fn orbits_meet(system: &System) -> bool {
    let (star, bodies) = (&system.star, &system.bodies);
    let mu = system.g * star.m[0];
    let mut ranges: Vec<[f64; 2]> = (0..bodies.len())
        .filter(|&i| bodies.m[i] > 0.0 && mu > 0.0)
        .map(|i| {
            let (x, v) = (bodies.x[i] - star.x[0], bodies.v[i] - star.v[0]);
            let p = x.cross(&v).norm_squared() / mu;
            let beta = 2.0 * mu / x.norm() - v.norm_squared();
            let e = (1.0 - p * beta / mu).max(0.0).sqrt();
            let far = if e < 1.0 {
                p / (1.0 - e)
            } else {
                f64::INFINITY
            };
            // Half of a mutual Hill radius of equals each.
            let hill = p * (bodies.m[i] / (3.0 * star.m[0])).cbrt();
            let reach = if bodies.softening[i] < hill {
                1.5 * 2f64.cbrt() * hill
            } else {
                0.0
            };
            [p / (1.0 + e) - reach, far + reach]
        })
        .collect();
    ranges.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut furthest = f64::NEG_INFINITY;
    ranges.iter().any(|&[near, far]| {
        let meets = near <= furthest;
        furthest = furthest.max(far);
        meets
    })
}
