//! Rules of a shearing box: how bodies move there, and what lies outside of it.

use nbody::points::Vec3;

use super::Complaints;
use crate::scene::{Collisions, Integrator, Scene};

/// What bodies may be and do in a shearing box.
pub fn rules(scene: &Scene, complaints: &Complaints<'_>) {
    let chosen = scene.planetesimals.as_ref().map(|bodies| bodies.integrator);
    if scene.domain.hill().is_none() {
        if chosen == Some(Integrator::Epicycles) {
            complaints.say(
                "planetesimals.integrator",
                "belongs to domain.kind = \"shearing-box\"",
            );
        }
        return;
    }
    let Some(bodies) = &scene.planetesimals else {
        return;
    };
    if !matches!(bodies.integrator, Integrator::Auto | Integrator::Epicycles) {
        complaints.say(
            "planetesimals.integrator",
            "has no place in a shearing box, whose frame moves bodies; allowed are \"auto\" and \"epicycles\"",
        );
    }
    if bodies.collisions != Collisions::None {
        complaints.say(
            "planetesimals.collisions.outcome",
            "is not available in a shearing box, across whose faces bodies do not look for each other; allowed is \"none\"",
        );
    }
}

pub const OUTSIDE: &str = "lies outside the shearing box, which reaches from 0 to domain.size";

/// Whether a closed domain leaves out `x`.
pub fn outside(scene: &Scene, x: Vec3) -> bool {
    let beyond = |size: Vec3| {
        (0..3).any(|axis| scene.domain.axes[axis] && (x[axis] < 0.0 || x[axis] > size[axis]))
    };
    scene.domain.size().is_some_and(beyond)
}
