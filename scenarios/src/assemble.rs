//! From a scene to populations (placeholder).

use crate::run::RunError;
use crate::scene::Scene;
use crate::validate::block_number;

/// What will be modelled, and its size.
pub fn outline(scene: &Scene) -> Result<String, RunError> {
    let mut text = String::new();
    let mut add = |name: &str, number: usize, bytes: usize| {
        text += &format!(
            "{name}: {number} particles, {:.1} MB\n",
            (number * bytes) as f64 / 1e6
        );
    };
    if let Some(gas) = &scene.gas {
        let blocks: f64 = gas
            .blocks
            .iter()
            .map(|entry| block_number(scene, &entry.block))
            .sum();
        add("gas", gas.particles + blocks as usize, 400);
    }
    if let Some(dust) = &scene.dust {
        let blocks: f64 = dust
            .blocks
            .iter()
            .map(|block| block_number(scene, block))
            .sum();
        add("dust", dust.particles + blocks as usize, 250);
    }
    if let Some(bodies) = &scene.planetesimals {
        add("planetesimals", bodies.number, 150);
    }
    add("planets", scene.planets.len(), 150);
    Ok(text)
}
