//! Rules between the composition of grains and the rest of a scene.

use super::Complaints;
use crate::scene::{Dust, Scene};

const PATH: &str = "dust.composition";

pub fn rules(scene: &Scene, dust: &Dust, complaints: &Complaints<'_>) {
    let Some(composition) = &dust.composition else {
        return;
    };
    if dust.growth.is_some() {
        complaints.say(
            PATH,
            "cannot stand beside dust.growth, in which grains of different mixtures would stick together",
        );
    }
    for (i, block) in dust.blocks.iter().enumerate() {
        if block.material_density.is_some() {
            complaints.say(
                &format!("dust.block.{i}.material_density"),
                "follows from dust.composition: give one of them",
            );
        }
    }
    if !composition.sublimation {
        return;
    }
    if scene.domain.hill().is_some() {
        complaints.say(
            PATH,
            "has no sublimation in a shearing box, whose images have different velocities; allowed there is sublimation = false",
        );
    }
    let molecules = |gas: &crate::scene::Gas| gas.mean_molecular_weight.is_some();
    if !scene.gas.as_ref().is_none_or(molecules) {
        complaints.say(
            PATH,
            "needs a gas with molecules, whose temperature is known; allowed in this gas.eos is sublimation = false",
        );
    }
    let sized = dust.sizes.is_some() || scene.initial_file.is_some();
    if !sized && (dust.particles > 0 || dust.blocks.iter().any(|block| block.size.is_none())) {
        complaints.say(
            PATH,
            "needs dust.size: ice sublimates from the surface of grains",
        );
    }
}
