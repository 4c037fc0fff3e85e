//! Doors: starts that no step can follow are refused: particles at the place of the star, and steps beyond number.

use coupling::System;
use nbody::points::Population;

use crate::populate::Refusal;
use crate::scene::Scene;
use crate::validate;

/// Refuses who stands at the very place of the star, where its pull has no value.
pub(super) fn separate(system: &System) -> Result<(), Refusal> {
    let Some(centre) = system.star.x.first() else {
        return Ok(());
    };
    let (gas, dust, bodies) = (
        &system.gas.particles,
        &system.dust.particles,
        &system.bodies,
    );
    let sets = [
        (Population::Gas, &gas.x, &gas.id),
        (Population::Dust, &dust.x, &dust.id),
        (Population::Planetesimals, &bodies.x, &bodies.id),
    ];
    for (population, x, id) in sets {
        // Closer than any square of a distance says.
        if let Some(i) = x.iter().position(|x| (x - centre).norm_squared() == 0.0) {
            return Err(Refusal(format!(
                "{population} particle {} stands at the very place of the star, where its pull has no value: move it, or give star.accretion_radius",
                id[i]
            )));
        }
    }
    Ok(())
}

/// Refuses steps of which a run would need more than it can do.
pub(super) fn countable(scene: &Scene, system: &System) -> Result<(), Refusal> {
    let end = scene.run.end_time;
    let many = |step: f64| step.is_nan() || end / step > validate::MOST_STEPS;
    let most = validate::MOST_STEPS;
    if many(system.bodies_step) {
        let sentence = format!(
            "bodies need steps of {:e} at their closest pericentre, {:e} of them to run.end_time, where a run does at most {most:e}: give star.accretion_radius, planetesimals.time_step or planetesimals.integrator = \"gauss-radau\"",
            system.bodies_step,
            end / system.bodies_step
        );
        return Err(Refusal(sentence));
    }
    if many(system.longest) {
        let sentence = format!(
            "gas and dust orbit the star so closely that they need steps of {:e}, {:e} of them to run.end_time, where a run does at most {most:e}",
            system.longest,
            end / system.longest
        );
        return Err(Refusal(sentence));
    }
    Ok(())
}
