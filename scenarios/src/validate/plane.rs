//! Rules of two dimensions: what lives in a plane, and how planets lie in it.

use super::{Complaints, named};
use crate::scene::{Orbit, Scene};

/// Two dimensions have gas and dust, and about a star planets in the plane "xy".
pub fn rules(scene: &Scene, complaints: &Complaints<'_>) {
    if scene.domain.dimensions() == 3 {
        return;
    }
    bodies(scene, complaints);
    if scene.gas.as_ref().is_some_and(|gas| gas.disk.is_some()) {
        complaints.say(
            "gas.disk",
            "needs three dimensions; in two give [[gas.block]] or an initial.file",
        );
    }
    let zones = scene.gas.as_ref().and_then(|gas| gas.edge);
    if zones.is_some() && scene.domain.axes[2] {
        complaints.say("gas.edge", "needs in two dimensions domain.plane = \"xy\"");
    }
    if scene.coupling.gas_planetesimals {
        complaints.say("planetesimals.drag.law", "needs three dimensions");
    }
}

fn bodies(scene: &Scene, complaints: &Complaints<'_>) {
    let belt = scene.planetesimals.is_some_and(|bodies| bodies.number > 0);
    let planets = named(complaints.entries, "planet").is_some();
    if belt || (named(complaints.entries, "planetesimals").is_some() && !planets) {
        complaints.say(
            "planetesimals",
            "cannot be modelled in two dimensions, where of bodies star and planets alone are",
        );
    }
    if planets && (scene.domain.axes[2] || scene.star.is_none()) {
        complaints.say(
            "planet",
            "needs in two dimensions domain.plane = \"xy\" and a [star], about which it moves there",
        );
        return;
    }
    for (i, planet) in scene.planets.iter().enumerate() {
        let leaves = match planet.orbit {
            Orbit::Elements { inclination, .. } => (inclination > 0.0).then_some("inclination"),
            Orbit::State { position, velocity } => {
                let off = [(position.z, "position"), (velocity.z, "velocity")];
                (off.into_iter()).find_map(|(z, key)| (z.abs() > 0.0).then_some(key))
            }
        };
        // What was refused is no number.
        if let Some(key) = leaves {
            complaints.say(
                &format!("planet.{i}.{key}"),
                "leads out of the plane that the scene is in",
            );
        }
    }
}
