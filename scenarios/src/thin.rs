//! Thinning: overrides that leave a part of the particles that a scene's generators make, with the same mass in all.

use crate::document::{self, Entries};
use crate::scene::Scene;

/// Particles of a population below which none are taken away.
const FEWEST: usize = 1000;

/// As of `--set`; `given` is what the scene's file says. Particles of files and blocks stay.
pub fn thinned(scene: &Scene, given: &Entries, part: f64) -> Vec<String> {
    let fewer = |number: usize| -> Option<usize> {
        let wanted = (number as f64 * part).round() as usize;
        (number > FEWEST).then_some(wanted.max(FEWEST))
    };
    let mut overrides = Vec::new();
    if let Some(number) = scene.gas.as_ref().and_then(|gas| fewer(gas.particles)) {
        overrides.push(format!("gas.particles={number}"));
    }
    if let Some(number) = scene.dust.as_ref().and_then(|dust| fewer(dust.particles)) {
        overrides.push(format!("dust.particles={number}"));
    }
    if let Some((bodies, number)) = scene
        .planetesimals
        .and_then(|p| Some((p, fewer(p.number)?)))
    {
        overrides.push(format!("planetesimals.number={number}"));
        let each = document::value(given, "planetesimals.mass").is_some();
        if each && bodies.mass > 0.0 {
            let mass = bodies.mass * bodies.number as f64 / number as f64;
            overrides.push(format!("planetesimals.mass={mass:?}"));
        }
    }
    overrides
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fewer_planetesimals_weigh_as_much() {
        let text = "[run]\nend_time = 1\n[star]\nmass = 1\n[planetesimals]\nnumber = 5000\nmass = \"1e-4 Mearth\"\ninner_radius = 1\nouter_radius = 2\n";
        let read = |more: &[String]| {
            Scene::parse(text, "scene", std::path::Path::new("."), more).expect("a scene")
        };
        let whole = read(&[]);
        let given = document::parse(text).expect("TOML");
        let mass = |scene: &Scene| {
            let bodies = scene.planetesimals.expect("planetesimals");
            (bodies.number, bodies.number as f64 * bodies.mass)
        };
        let overrides = thinned(&whole, &given, 0.3);
        let (number, sum) = mass(&read(&overrides));
        assert_eq!(number, 1500);
        assert!((sum / mass(&whole).1 - 1.0).abs() < 1e-14);
        // None are left out where there are few.
        assert_eq!(mass(&read(&thinned(&whole, &given, 1e-3))).0, FEWEST);
    }
}
