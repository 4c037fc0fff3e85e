//! Rules between the growth of grains and the rest of a scene.

use super::Complaints;
use crate::scene::{Collisional, Dust, DustDrag, Growth, Scene, Sizes};

const PATH: &str = "dust.growth";

pub fn rules(scene: &Scene, dust: &Dust, complaints: &Complaints<'_>) {
    let Some(Growth::Physical(growth)) = &dust.growth else {
        return;
    };
    let rubs = scene.coupling.gas_dust && dust.drag != DustDrag::None;
    if scene.gas.is_some() && !rubs {
        complaints.say(
            PATH,
            "needs drag between gas and dust, by which grains know the gas around",
        );
    }
    if dust.particles > 0 && dust.scale_height == 0.0 {
        complaints.say(
            "dust.scale_height",
            "makes a layer without a volume, in which grains have no number density to grow in",
        );
    }
    let by_molecules = growth.brownian || growth.alpha > 0.0 && growth.reynolds.is_none();
    let molecules = |gas: &crate::scene::Gas| gas.mean_molecular_weight.is_some();
    if by_molecules && !scene.gas.as_ref().is_none_or(molecules) {
        complaints.say(
            PATH,
            "needs a gas with molecules; allowed in this gas.eos are brownian = false and a given reynolds",
        );
    }
    monomers(dust, growth, complaints);
}

fn monomers(dust: &Dust, growth: &Collisional, complaints: &Complaints<'_>) {
    let smallest = match dust.sizes {
        Some(Sizes::One(radius)) => radius,
        Some(Sizes::Range { min, .. }) => min,
        None => f64::INFINITY,
    };
    if growth.monomer_radius > smallest * (1.0 + 1e-9) {
        complaints.say(
            "dust.growth.monomer_radius",
            "must be at most the smallest of dust.size",
        );
    }
}
