//! The frame of a scene as text: the run, its domain and star, its forces.

use nbody::points::Boundary;

use super::text::Text;
use crate::read::gravity::MASSES;
use crate::scene::{GravityMethod, Mass, Opening, Scene, Snapshots};
use crate::units::System;

pub fn frame(text: &mut Text, scene: &Scene) {
    text.table("run");
    text.number("end_time", scene.run.end_time);
    match &scene.run.snapshots {
        Snapshots::None => text.text("snapshots", "none"),
        Snapshots::Every(interval) => text.number("snapshots", *interval),
        Snapshots::At(times) => text.raw("snapshots", format_args!("{times:?}")),
    }
    text.raw(
        "checkpoint",
        format_args!("\"{:?} s\"", scene.run.checkpoint),
    );
    text.raw("seed", scene.run.seed);
    text.time_step(scene.run.time_step);
    text.raw("write_accelerations", scene.run.write_accelerations);

    text.table("units");
    text.text(
        "system",
        match scene.units.system {
            System::Astronomical => "astronomical",
            System::Dimensionless => "dimensionless",
            System::Cgs => "cgs",
        },
    );
    domain(text, scene);
    if let Some(path) = &scene.initial_file {
        text.table("initial");
        text.text("file", &path.to_string_lossy());
    }
    if let Some(star) = &scene.star {
        text.table("star");
        text.number("mass", star.mass);
        text.number("accretion_radius", star.accretion_radius);
    }
}

fn domain(text: &mut Text, scene: &Scene) {
    text.table("domain");
    match scene.domain.boundary {
        Boundary::Open => text.text("kind", "open"),
        Boundary::Periodic { size } => {
            text.text("kind", "periodic");
            text.vector("size", size);
        }
        Boundary::Shearing { size, hill, .. } => {
            text.text("kind", "shearing-box");
            text.vector("size", size);
            text.number("rate", hill.rate);
            text.number("shear", hill.shear);
            text.raw("vertical_gravity", scene.local.vertical_gravity);
            text.number("headwind", scene.local.headwind);
        }
    }
    text.raw("dimensions", scene.domain.dimensions());
    if scene.domain.dimensions() == 2 {
        text.text("plane", if scene.domain.axes[1] { "xy" } else { "xz" });
    }
}

pub fn forces(text: &mut Text, scene: &Scene) {
    text.table("gravity");
    let gravity = &scene.gravity;
    text.text(
        "method",
        match gravity.method {
            GravityMethod::Tree => "tree",
            GravityMethod::Direct => "direct",
            GravityMethod::None => "none",
        },
    );
    match gravity.opening {
        Opening::ForceError(error) => text.number("force_error", error),
        Opening::Angle(angle) => text.number("opening_angle", angle),
    }
    text.number("constant", gravity.constant);
    if scene.has(Mass::Gas) {
        text.raw("separate_steps", gravity.separate_steps);
    }
    if gravity.method != GravityMethod::None {
        text.table("gravity.pulls");
        for (name, source) in MASSES.into_iter().filter(|(_, mass)| scene.has(*mass)) {
            let targets: Vec<&str> = MASSES
                .into_iter()
                .filter(|(_, target)| gravity.pulls.has(source, *target))
                .map(|(name, _)| name)
                .collect();
            text.raw(name, format_args!("{targets:?}"));
        }
    }
    text.table("coupling");
    let pairs = [
        ("gas-dust", scene.coupling.gas_dust),
        ("gas-planetesimals", scene.coupling.gas_planetesimals),
    ];
    let on: Vec<&str> = pairs
        .iter()
        .filter(|pair| pair.1)
        .map(|pair| pair.0)
        .collect();
    text.raw("drag", format_args!("{on:?}"));
    text.raw("feedback", scene.coupling.feedback);
    text.number("heat_share", scene.coupling.heat_share);
    text.raw("mixtures", scene.coupling.mixtures);
    if let Some(tolerance) = scene.coupling.tolerance {
        text.number("tolerance", tolerance);
    }
    text.table("accuracy");
    text.text("preset", scene.accuracy.preset.name());
    text.number("acceleration_step", scene.accuracy.acceleration_step);
    text.number("orbit_step", scene.accuracy.orbit_step);
}
