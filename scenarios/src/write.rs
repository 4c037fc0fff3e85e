//! Writing a scene: TOML with every default written out, which reads back to the same scene.

use std::fmt::{Display, Write};

use nbody::integrators::wisdom_holman::jacobi::{self, Scheme};
use nbody::points::{Boundary, Vec3};

use crate::read::gravity::MASSES;
use crate::scene::{
    Block, BodyDrag, Collisions, Cooling, Coordinates, Disk, DiskAmount, Dust, DustAmount,
    DustDrag, Eos, Formulation, Gas, GravityMethod, Hydro, Integrator, Kernel, Lattice, Opening,
    Orbit, Planet, Planetesimals, Precision, Preset, Scene, Sizes, Snapshots, Softening, Thermal,
    TimeStep, Viscosity,
};
use crate::units::System;

/// A TOML text in the making.
#[derive(Default)]
struct Text(String);

impl Text {
    fn table(&mut self, name: &str) {
        self.line(format_args!("\n[{name}]"));
    }

    fn entry(&mut self, name: &str) {
        self.line(format_args!("\n[[{name}]]"));
    }

    fn line(&mut self, line: impl Display) {
        writeln!(self.0, "{line}").expect("writing to a string does not fail");
    }

    fn raw(&mut self, key: &str, value: impl Display) {
        self.line(format_args!("{key} = {value}"));
    }

    /// Shortest digits that read back to the same bits.
    fn number(&mut self, key: &str, value: f64) {
        self.raw(key, format_args!("{value:?}"));
    }

    fn text(&mut self, key: &str, value: &str) {
        self.raw(key, toml::Value::from(value));
    }

    fn vector(&mut self, key: &str, v: Vec3) {
        self.raw(key, format_args!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z));
    }

    fn time_step(&mut self, step: TimeStep) {
        match step {
            TimeStep::Auto => self.text("time_step", "auto"),
            TimeStep::Fixed(dt) => self.number("time_step", dt),
        }
    }

    fn softening(&mut self, softening: Softening) {
        match softening {
            Softening::SmoothingLength => self.text("softening", "smoothing-length"),
            Softening::Fixed(length) => self.number("softening", length),
        }
    }
}

impl Scene {
    /// The scene as TOML in code units, every default written out.
    pub fn to_toml(&self) -> String {
        let mut text = Text::default();
        text.text("name", &self.name);
        text.text("title", &self.title);
        frame(&mut text, self);
        if let Some(gas) = &self.gas {
            write_gas(&mut text, gas);
        }
        if let Some(dust) = &self.dust {
            write_dust(&mut text, dust);
        }
        if let Some(bodies) = &self.planetesimals {
            write_bodies(&mut text, bodies);
        }
        for planet in &self.planets {
            write_planet(&mut text, planet);
        }
        write_surroundings(&mut text, self);
        forces(&mut text, self);
        text.0
    }
}

fn frame(text: &mut Text, scene: &Scene) {
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
    }
    text.raw("dimensions", scene.domain.dimensions());
    if scene.domain.dimensions() == 2 {
        text.text("plane", if scene.domain.axes[1] { "xy" } else { "xz" });
    }
}

fn write_gas(text: &mut Text, gas: &Gas) {
    text.table("gas");
    if gas.particles > 0 {
        text.raw("particles", gas.particles);
    }
    text.softening(gas.softening);
    write_eos(text, &gas.eos);
    if let Some(disk) = &gas.disk {
        write_disk(text, disk, &gas.eos);
    }
    for entry in &gas.blocks {
        text.entry("gas.block");
        write_block(text, &entry.block);
        match entry.thermal {
            Thermal::Pressure(pressure) => text.number("pressure", pressure),
            Thermal::InternalEnergy(energy) => text.number("internal_energy", energy),
            Thermal::Eos => {}
        }
    }
    text.table("gas.cooling");
    match gas.cooling {
        Cooling::None => text.text("kind", "none"),
    }
    write_hydro(text, &gas.hydro);
    text.table("gas.viscosity");
    let mut viscosity = |kind, alpha, beta| {
        text.text("kind", kind);
        text.number("alpha", alpha);
        text.number("beta", beta);
    };
    match gas.viscosity {
        Viscosity::None => text.text("kind", "none"),
        Viscosity::Constant { alpha, beta } => viscosity("constant", alpha, beta),
        Viscosity::Balsara { alpha, beta } => viscosity("balsara", alpha, beta),
    }
}

fn write_eos(text: &mut Text, eos: &Eos) {
    text.table("gas.eos");
    let weight = match *eos {
        Eos::Ideal {
            gamma,
            mean_molecular_weight,
        } => {
            text.text("kind", "ideal");
            text.number("gamma", gamma);
            mean_molecular_weight
        }
        Eos::Isothermal {
            sound_speed,
            mean_molecular_weight,
        } => {
            text.text("kind", "isothermal");
            text.number("sound_speed", sound_speed);
            mean_molecular_weight
        }
        Eos::LocallyIsothermal {
            aspect_ratio,
            exponent,
            reference_radius,
            mean_molecular_weight,
            ..
        } => {
            text.text("kind", "locally-isothermal");
            text.number("aspect_ratio", aspect_ratio);
            text.number("exponent", exponent);
            text.number("reference_radius", reference_radius);
            mean_molecular_weight
        }
    };
    text.number("mean_molecular_weight", weight);
}

fn write_disk(text: &mut Text, disk: &Disk, eos: &Eos) {
    text.table("gas.disk");
    match disk.amount {
        DiskAmount::SurfaceDensity(sigma) => text.number("surface_density", sigma),
        DiskAmount::Mass(mass) => text.number("mass", mass),
    }
    text.number("slope", disk.slope);
    text.number("reference_radius", disk.reference_radius);
    if matches!(eos, Eos::Ideal { .. }) {
        text.number("aspect_ratio", disk.aspect_ratio);
        text.number("exponent", disk.exponent);
    }
    text.number("inner_radius", disk.inner_radius);
    text.number("outer_radius", disk.outer_radius);
    text.number("taper", disk.taper);
}

fn write_block(text: &mut Text, block: &Block) {
    text.vector("lo", block.lo);
    text.vector("hi", block.hi);
    text.number("spacing", block.spacing);
    text.text(
        "lattice",
        match block.lattice {
            Lattice::Cubic => "cubic",
            Lattice::Bcc => "bcc",
            Lattice::Random => "random",
        },
    );
    text.number("density", block.density);
    text.vector("velocity", block.velocity);
}

fn write_hydro(text: &mut Text, hydro: &Hydro) {
    text.table("gas.hydro");
    match hydro.formulation {
        Formulation::Density => text.text("formulation", "density"),
    }
    text.text(
        "kernel",
        match hydro.kernel {
            Kernel::WendlandC2 => "wendland-c2",
            Kernel::CubicSpline => "cubic-spline",
        },
    );
    text.number("neighbours", hydro.neighbours);
    text.number("courant", hydro.courant);
    text.number("tolerance", hydro.tolerance);
    text.text(
        "precision",
        match hydro.precision {
            Precision::Single => "single",
            Precision::Double => "double",
        },
    );
}

fn write_dust(text: &mut Text, dust: &Dust) {
    text.table("dust");
    if dust.particles > 0 {
        text.raw("particles", dust.particles);
        text.number("scale_height", dust.scale_height);
        text.number("inner_radius", dust.inner_radius);
        text.number("outer_radius", dust.outer_radius);
    }
    text.softening(dust.softening);
    match dust.amount {
        Some(DustAmount::DustToGas(ratio)) => text.number("dust_to_gas", ratio),
        Some(DustAmount::Mass(mass)) => text.number("mass", mass),
        None => {}
    }
    match dust.sizes {
        Some(Sizes::One(radius)) => text.number("size", radius),
        Some(Sizes::Range { min, max, slope }) => text.raw(
            "size",
            format_args!("{{ min = {min:?}, max = {max:?}, slope = {slope:?} }}"),
        ),
        None => {}
    }
    text.number("material_density", dust.material_density);
    for block in &dust.blocks {
        text.entry("dust.block");
        write_block(text, block);
    }
    text.table("dust.drag");
    match dust.drag {
        DustDrag::None => text.text("law", "none"),
        DustDrag::Epstein => text.text("law", "epstein"),
        DustDrag::ConstantStoppingTime(time) => {
            text.text("law", "constant-stopping-time");
            text.number("stopping_time", time);
        }
        DustDrag::ConstantStokesNumber(stokes) => {
            text.text("law", "constant-stokes-number");
            text.number("stokes_number", stokes);
        }
    }
}

fn write_bodies(text: &mut Text, bodies: &Planetesimals) {
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

fn write_surroundings(text: &mut Text, scene: &Scene) {
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

fn write_planet(text: &mut Text, planet: &Planet) {
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

fn forces(text: &mut Text, scene: &Scene) {
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
    text.table("accuracy");
    text.text(
        "preset",
        match scene.accuracy.preset {
            Preset::Draft => "draft",
            Preset::Standard => "standard",
            Preset::Precise => "precise",
        },
    );
    text.number("acceleration_step", scene.accuracy.acceleration_step);
    text.number("orbit_step", scene.accuracy.orbit_step);
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn reads_back(text: &str) {
        let scene = Scene::parse(text, "trial", Path::new("."), &[]);
        let scene = scene.unwrap_or_else(|problems| panic!("{problems:?}"));
        let written = scene.to_toml();
        let again = Scene::parse(&written, "other", Path::new("/"), &[]);
        let again = again.unwrap_or_else(|problems| panic!("{problems:?} in {written}"));
        assert_eq!(again, scene, "{written}");
        assert_eq!(again.to_toml(), written);
    }

    #[test]
    fn a_full_disk_reads_back() {
        reads_back(
            r#"
            title = "a \"quoted\" title"
            [run]
            end_time = "10 yr"
            snapshots = [0.0, "1 yr"]
            checkpoint = "5 min"
            time_step = "0.1 day"
            [star]
            mass = "1 Msun"
            accretion_radius = "0.05 au"
            [gas]
            particles = 50000
            [gas.disk]
            surface_density = "1700 g/cm^2"
            inner_radius = 0.5
            outer_radius = "2 au"
            [gas.eos]
            kind = "locally-isothermal"
            aspect_ratio = 0.033
            [dust]
            particles = 20000
            size = { min = "1 um", max = "1 mm" }
            [planetesimals]
            number = 2000
            total_mass = "1 Mearth"
            inner_radius = 0.7
            outer_radius = 1.3
            [planetesimals.collisions]
            outcome = "merge"
            [[planet]]
            mass = "1 Mearth"
            semi_major_axis = "1 au"
            inclination = "30 deg"
            [[planet]]
            mass = "1 Mjup"
            position = [5.2, 0, 0]
            velocity = ["0 km/s", "13 km/s", 0]
            [gravity]
            pulls = { planetesimals = [] }
            [accuracy]
            preset = "draft"
            "#,
        );
    }

    #[test]
    fn a_shock_tube_reads_back() {
        reads_back(
            r#"
            [run]
            end_time = 0.2
            snapshots = "none"
            [units]
            system = "dimensionless"
            [domain]
            kind = "periodic"
            size = [2, 1, 1]
            dimensions = 2
            plane = "xz"
            [[gas.block]]
            lo = [0, 0, 0]
            hi = [1, 0, 1]
            spacing = 0.1
            density = 1
            pressure = 1
            [[gas.block]]
            lo = [1, 0, 0]
            hi = [2, 0, 1]
            spacing = 0.2
            density = 0.25
            internal_energy = 1.3
            velocity = [0.1, 0.2, 0.3]
            [[dust.block]]
            lo = [0, 0, 0]
            hi = [1, 0, 1]
            spacing = 0.1
            lattice = "random"
            density = 1
            [dust.drag]
            law = "constant-stopping-time"
            stopping_time = 0.1
            [gas.viscosity]
            kind = "none"
            "#,
        );
    }

    #[test]
    fn bodies_alone_read_back() {
        reads_back(
            r#"
            [run]
            end_time = 1
            [units]
            system = "cgs"
            [[planet]]
            mass = "1 Msun"
            position = ["1 au", 0, 0]
            velocity = [0, 0, 0]
            [planetesimals]
            integrator = "gauss-radau"
            [gravity]
            method = "direct"
            opening_angle = 0.5
            "#,
        );
    }
}
