//! Bodies of a scene as text, and what surrounds them.

use nbody::integrators::wisdom_holman::jacobi::{self, Scheme};

use super::text::Text;
use crate::scene::{
    BodyDrag, Collisions, Coordinates, Integrator, Orbit, Planet, Planetesimals, Scene,
};
use crate::units::System;

pub fn write_bodies(text: &mut Text, bodies: &Planetesimals) {
    text.table("planetesimals");
    text.raw("number", bodies.number);
    if bodies.number > 0 {
        text.number("mass", bodies.mass);
        text.number("inner_radius", bodies.inner_radius);
        text.number("outer_radius", bodies.outer_radius);
        text.number("slope", bodies.slope);
        text.number("eccentricity", bodies.eccentricity);
        text.number("inclination", bodies.inclination);
        text.number("density", bodies.density);
        if bodies.mass == 0.0 {
            text.number("radius", bodies.radius);
        }
    }
    text.text(
        "integrator",
        match bodies.integrator {
            Integrator::Auto => "auto",
            Integrator::Leapfrog => "leapfrog",
            Integrator::WisdomHolman => "wisdom-holman",
            Integrator::Hermite => "hermite",
            Integrator::Hybrid => "hybrid",
            Integrator::GaussRadau => "gauss-radau",
            Integrator::Epicycles => "epicycles",
        },
    );
    write_coordinates(text, bodies.coordinates);
    if matches!(bodies.integrator, Integrator::Hybrid | Integrator::Auto) {
        text.number("cutoff", bodies.cutoff);
    }
    text.number("softening", bodies.softening);
    text.time_step(bodies.time_step);
    text.table("planetesimals.drag");
    write_body_drag(text, "law", bodies.drag);
    text.table("planetesimals.collisions");
    match bodies.collisions {
        Collisions::None => text.text("outcome", "none"),
        Collisions::Merge => text.text("outcome", "merge"),
        Collisions::Bounce {
            restitution,
            tangential_restitution,
        } => {
            text.text("outcome", "bounce");
            text.number("restitution", restitution);
            text.number("tangential_restitution", tangential_restitution);
        }
        Collisions::Fragment {
            fragment_mass,
            most_fragments,
            c_star,
            mu,
            reference_density,
        } => {
            text.text("outcome", "fragment");
            text.number("fragment_mass", fragment_mass);
            text.raw("most_fragments", most_fragments);
            text.number("c_star", c_star);
            text.number("mu", mu);
            text.number("reference_density", reference_density);
        }
    }
    if let Some([ice, rock, iron]) = bodies.composition {
        text.table("planetesimals.composition");
        text.number("ice", ice);
        text.number("rock", rock);
        text.number("iron", iron);
    }
}

fn write_body_drag(text: &mut Text, key: &str, drag: BodyDrag) {
    match drag {
        BodyDrag::None => text.text(key, "none"),
        BodyDrag::Adachi => text.text(key, "adachi"),
        BodyDrag::ConstantStoppingTime(time) => {
            text.text(key, "constant-stopping-time");
            text.number("stopping_time", time);
        }
        BodyDrag::Quadratic(coefficient) => {
            text.text(key, "quadratic");
            text.number("coefficient", coefficient);
        }
    }
}

pub fn write_surroundings(text: &mut Text, scene: &Scene) {
    let surroundings = &scene.surroundings;
    if let Some(light) = surroundings.speed_of_light {
        text.table("surroundings");
        text.raw("relativity", true);
        if scene.units.system == System::Dimensionless {
            text.number("speed_of_light", light);
        }
    }
    if let Some(oblateness) = &surroundings.oblateness {
        text.table("surroundings.oblateness");
        text.number("j2", oblateness.j2);
        text.number("equatorial_radius", oblateness.equatorial_radius);
        text.vector("pole", oblateness.pole);
    }
    if let Some(disk) = &surroundings.disk {
        text.table("surroundings.disk");
        text.number("surface_density", disk.surface_density);
        text.number("surface_density_slope", disk.slope);
        text.number("reference_radius", disk.reference_radius);
        text.number("aspect_ratio", disk.aspect_ratio);
        text.number("flaring", disk.flaring);
        text.number("inner_radius", disk.inner_radius);
        text.number("outer_radius", disk.outer_radius);
        if let Some(headwind) = disk.headwind {
            text.number("headwind", headwind);
        }
        text.number("mean_molecular_weight", disk.mean_molecular_weight);
        write_body_drag(text, "drag", disk.drag);
        text.raw("migration", disk.migration);
    }
}

fn write_coordinates(text: &mut Text, coordinates: Coordinates) {
    match coordinates {
        Coordinates::DemocraticHeliocentric => text.text("coordinates", "democratic-heliocentric"),
        Coordinates::Jacobi(Scheme { kernel, corrector }) => {
            text.text("coordinates", "jacobi");
            text.raw("corrector", corrector.order());
            let kernel = match kernel {
                jacobi::Kernel::Standard => "standard",
                jacobi::Kernel::Lazy => "lazy",
            };
            text.text("kernel", kernel);
        }
    }
}

pub fn write_planet(text: &mut Text, planet: &Planet) {
    text.entry("planet");
    text.number("mass", planet.mass);
    text.number("radius", planet.radius);
    if planet.density > 0.0 {
        text.number("density", planet.density);
    }
    if let Some(time) = planet.migration_time {
        text.number("migration_time", time);
    }
    match planet.orbit {
        Orbit::Elements {
            semi_major_axis,
            eccentricity,
            inclination,
            longitude_of_node,
            argument_of_pericentre,
            mean_anomaly,
        } => {
            text.number("semi_major_axis", semi_major_axis);
            text.number("eccentricity", eccentricity);
            text.number("inclination", inclination);
            text.number("longitude_of_node", longitude_of_node);
            text.number("argument_of_pericentre", argument_of_pericentre);
            text.number("mean_anomaly", mean_anomaly);
        }
        Orbit::State { position, velocity } => {
            text.vector("position", position);
            text.vector("velocity", velocity);
        }
    }
}
