//! Population of a scene: particles and bodies from generators and from a file.

pub mod growth;
mod laws;
pub mod sublimation;

pub use laws::{body_law, collisions, cooling, disk_law, dust_law, hydro, molecules};

use std::fmt;

use coupling::System;
use coupling::edge::rim::Rim;
use coupling::edge::{Balance, Edges, Zone};
use dust::{Dust, Superparticles};
use gas::{Eos, Gas, Particles};
use nbody::gravity::{Accuracy, Gravity, Method, Settings};
use nbody::points::columns::append;
use nbody::points::random::Purpose;
use nbody::points::{Columns, Vec3};
use nbody::{Bodies, Kind};

use crate::initial::belt::{self, Belt, Body, Centre, Elements};
use crate::initial::disk::Disk;
use crate::initial::grains::{self, Grains};
use crate::initial::lattice::{self, Arrangement};
use crate::initial::strewn::Ring;
use crate::initial::{self, Resolution};
use crate::scene::{self, Scene};

/// Why a start cannot be made: a sentence.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal(pub String);

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// Counts out ids.
struct Ids(u64);

impl Ids {
    fn take(&mut self, n: usize) -> u64 {
        let first = self.0;
        self.0 += n as u64;
        first
    }
}

/// Fills an empty system with what the scene has at its start.
pub fn fill(scene: &Scene, system: &mut System) -> Result<(), Refusal> {
    let mut ids = Ids(1);
    let mut file = match &scene.initial_file {
        Some(path) => crate::initial::from_file::read(path, scene)?,
        None => crate::initial::from_file::Start::default(),
    };
    stars(scene, system, &mut file.star);
    bodies(scene, system, &mut ids, file.bodies);
    let gas = gas(scene, &mut ids, file.gas)?;
    let dust = dust(scene, &mut ids, file.dust, &gas);
    if let Some(scene_gas) = &scene.gas {
        system.gas = Gas::new(gas);
        if let Some(disk) = &scene_gas.disk {
            system.dust = Dust::new(dust);
            balance(scene, disk, system);
            return Ok(());
        }
    }
    system.dust = Dust::new(dust);
    Ok(())
}

fn stars(scene: &Scene, system: &mut System, file: &mut Bodies) {
    if let Some(star) = &scene.star {
        let body = Body {
            kind: Kind::Star,
            mass: star.mass,
            radius: star.accretion_radius,
            density: 0.0,
            softening: 0.0,
        };
        if file.is_empty() {
            belt::place(file, 0, body, (Vec3::zeros(), Vec3::zeros()));
        }
        // The scene's star is what the star is, wherever the file puts it.
        (file.m[0], file.radius[0]) = (star.mass, star.accretion_radius);
    }
    system.star = std::mem::take(file);
}

fn bodies(scene: &Scene, system: &mut System, ids: &mut Ids, mut file: Bodies) {
    let mut bodies = Bodies::default();
    let g = scene.gravity.constant;
    let centre = match system.star.x.first() {
        Some(&x) => Centre {
            x,
            v: system.star.v[0],
            mass: system.star.m[0],
            g,
        },
        None => Centre {
            x: Vec3::zeros(),
            v: Vec3::zeros(),
            mass: 0.0,
            g,
        },
    };
    let softening = scene.planetesimals.as_ref().map_or(0.0, |p| p.softening);
    for planet in &scene.planets {
        let body = Body {
            kind: Kind::Planet,
            mass: planet.mass,
            radius: planet.radius,
            density: planet.density,
            softening,
        };
        let id = ids.take(1);
        match planet.orbit {
            scene::Orbit::State { position, velocity } => {
                let mut v = [Vec3::zeros()];
                streaming(scene, velocity, &[position], &mut v);
                belt::place(&mut bodies, id, body, (position, v[0]))
            }
            scene::Orbit::Elements {
                semi_major_axis,
                eccentricity,
                inclination,
                longitude_of_node: node,
                argument_of_pericentre: pericentre,
                mean_anomaly,
            } => {
                let elements = Elements {
                    semi_major_axis,
                    eccentricity,
                    inclination,
                    node,
                    pericentre,
                    mean_anomaly,
                };
                belt::orbit(&mut bodies, id, body, &elements, &centre);
            }
        }
    }
    if let Some(p) = scene.planetesimals.as_ref().filter(|p| p.number > 0) {
        let belt = Belt {
            number: p.number,
            mass: p.mass,
            density: p.density,
            radius: p.radius,
            softening,
            inner_radius: p.inner_radius,
            outer_radius: p.outer_radius,
            slope: p.slope,
            eccentricity: p.eccentricity,
            inclination: p.inclination,
        };
        let first = ids.take(p.number);
        belt.add_to(&mut bodies, &centre, scene.run.seed, first);
    }
    file.softening.fill(softening);
    let first = ids.take(file.len());
    number(&mut file.id, first);
    let mixture = scene.planetesimals.as_ref().and_then(|p| p.composition);
    let given = std::mem::take(&mut file.composition);
    append(&mut bodies, &file);
    if let Some(mixture) = mixture {
        bodies.composition = vec![Vec3::from(mixture); bodies.len() - given.len()];
        bodies.composition.extend(given);
    }
    system.bodies = bodies;
}

/// Gives ids to what has none (all zero).
fn number(id: &mut [u64], first: u64) {
    if id.iter().all(|&id| id == 0) {
        for (k, id) in id.iter_mut().enumerate() {
            *id = first + k as u64;
        }
    }
}

/// The generator's disk of a scene's disk.
fn disk_of(scene: &Scene, gas: &scene::Gas, disk: &scene::Disk) -> Disk {
    let mut made = Disk {
        particles: gas.particles,
        surface_density: 1.0,
        slope: disk.slope,
        reference_radius: disk.reference_radius,
        inner_radius: disk.inner_radius,
        outer_radius: disk.outer_radius,
        taper: disk.taper,
        aspect_ratio: disk.aspect_ratio,
        exponent: disk.exponent,
        star_mass: scene.star.map_or(0.0, |star| star.mass),
        g: scene.gravity.constant,
    };
    made.surface_density = match disk.amount {
        scene::DiskAmount::SurfaceDensity(sigma) => sigma,
        scene::DiskAmount::Mass(mass) => mass / made.mass(),
    };
    made
}

/// The zones that damp waves at the edges of the scene's gas; none if it has none.
pub fn edges(scene: &Scene, gas: &scene::Gas) -> Option<Edges> {
    let edge = gas.edge?;
    let zones: Vec<Zone> = [edge.inner, edge.outer].into_iter().flatten().collect();
    if zones.is_empty() {
        return None;
    }
    // The rotation that a generated disk has is that about the star alone.
    let alone = gas.disk.filter(|_| !scene.gravity.fluids_pull_gas());
    let balance = alone.map(|disk| -> Balance {
        let made = disk_of(scene, gas, &disk);
        Box::new(move |x| made.rotation(x, 0.0))
    });
    Some(Edges::new(zones, edge.time, balance))
}

/// What holds the inner edge of the scene's disk at the accretion radius; none if nothing does.
pub fn rim(scene: &Scene, gas: &scene::Gas) -> Option<Rim> {
    let (_, disk) = (gas.edge.filter(|edge| edge.supported)?, gas.disk?);
    let made = disk_of(scene, gas, &disk);
    let profile = move |r: f64| {
        let c = made.sound_speed(r);
        [made.sigma(r) / made.scale_height(r), c * c]
    };
    Some(Rim::new(&hydro(scene, gas), Box::new(profile)))
}

fn resolution(scene: &Scene, gas: &scene::Gas) -> Resolution {
    let hydro = hydro(scene, gas);
    Resolution {
        neighbours: hydro.neighbours,
        support: hydro.support(),
    }
}

/// Points of a block and the mass of each.
fn block(
    scene: &Scene,
    block: &scene::Block,
    ids: &mut Ids,
    purpose: Purpose,
) -> (Vec<Vec3>, f64, u64) {
    let space = lattice::Block {
        lo: block.lo,
        hi: block.hi,
        axes: scene.domain.axes,
    };
    let dimensions = scene.domain.dimensions() as f64;
    let x = match block.lattice {
        scene::Lattice::Cubic => space.lattice(Arrangement::Cubic, block.spacing),
        scene::Lattice::Bcc => space.lattice(
            Arrangement::BodyCentred,
            block.spacing * 2f64.powf(1.0 / dimensions),
        ),
        scene::Lattice::Glass => space.glass(block.spacing, scene.run.seed, purpose),
        scene::Lattice::Random => {
            let n = (space.volume() / block.spacing.powf(dimensions)).round() as usize;
            space.random(n, scene.run.seed, purpose, ids.0)
        }
    };
    let mass = block.density * space.volume() / x.len().max(1) as f64;
    let first = ids.take(x.len());
    (x, mass, first)
}

/// Velocities that a scene gives: in a shearing box relative to the shear.
fn streaming(scene: &Scene, velocity: Vec3, x: &[Vec3], v: &mut [Vec3]) {
    for (v, &x) in v.iter_mut().zip(x) {
        let stream = scene.domain.hill().map_or(0.0, |hill| hill.stream(x));
        *v = velocity + Vec3::y() * stream;
    }
}

fn gas(scene: &Scene, ids: &mut Ids, mut file: Particles) -> Result<Particles, Refusal> {
    let mut all = Particles::default();
    let Some(gas) = &scene.gas else {
        return Ok(all);
    };
    let hydro = hydro(scene, gas);
    if let Some(disk) = &gas.disk {
        let first = ids.take(gas.particles);
        let disk = disk_of(scene, gas, disk);
        if let Some(flaw) = disk.flaw() {
            return Err(Refusal(format!("gas.disk cannot be made: {flaw}")));
        }
        let mut made = disk.gas(resolution(scene, gas), scene.run.seed, first);
        if let Eos::Ideal { gamma } = hydro.eos {
            // Gas whose temperature its place dictates is brought to it by itself.
            for (u, x) in made.u.iter_mut().zip(&made.x) {
                *u = disk.sound_speed(x.xy().norm()).powi(2) / (gamma - 1.0);
            }
        }
        append(&mut all, &made);
    }
    for b in &gas.blocks {
        let (x, mass, first) = block(scene, &b.block, ids, Purpose::GasPositions);
        let n = x.len();
        let h = resolution(scene, gas)
            .smoothing_length(mass / b.block.density, scene.domain.dimensions());
        let mut made = initial::gas(x, vec![h; n], mass, first);
        streaming(scene, b.block.velocity, &made.x, &mut made.v);
        made.u.fill(match b.thermal {
            scene::Thermal::Pressure(p) => {
                let u = hydro.eos.energy(b.block.density, p);
                u.expect("a formula, where a scene may give a pressure")
            }
            scene::Thermal::InternalEnergy(u) => u,
            scene::Thermal::Eos => 0.0,
        });
        append(&mut all, &made);
    }
    let first = ids.take(file.len());
    number(&mut file.id, first);
    append(&mut all, &file);
    sublimation::moisten(scene, &mut all);
    Ok(all)
}

fn dust(scene: &Scene, ids: &mut Ids, mut file: Superparticles, gas: &Particles) -> Superparticles {
    let mut all = Superparticles::default();
    let Some(dust) = &scene.dust else { return all };
    let sizes = match dust.sizes {
        Some(scene::Sizes::One(radius)) => grains::Sizes::One(radius),
        Some(scene::Sizes::Range { min, max, slope }) => {
            grains::Sizes::PowerLaw { min, max, slope }
        }
        None => grains::Sizes::One(0.0),
    };
    let grains = |particles: usize, mass: f64| Grains {
        particles,
        mass,
        sizes,
        material_density: dust.material_density,
        scale_height: dust.scale_height,
    };
    if let (Some(amount), Some(scene_gas)) = (dust.amount, &scene.gas)
        && let Some(disk) = &scene_gas.disk
    {
        let disk = disk_of(scene, scene_gas, disk);
        let mass = match amount {
            scene::DustAmount::DustToGas(ratio) => ratio * gas.m.iter().sum::<f64>(),
            scene::DustAmount::Mass(mass) => mass,
        };
        let dust_disk = Disk {
            inner_radius: dust.inner_radius,
            outer_radius: dust.outer_radius,
            ..disk
        };
        let first = ids.take(dust.particles);
        let velocity = |x: Vec3, _| disk.rotation(x, 0.0);
        let made = grains(dust.particles, mass).disk(
            &dust_disk,
            resolution(scene, scene_gas),
            scene.run.seed,
            first,
            velocity,
        );
        append(&mut all, &made);
    }
    if let (Some(amount), Some(disk)) = (dust.amount, &scene.surroundings.disk) {
        let disk = crate::assemble::gas_disk(disk);
        let ring = Ring {
            disk: &disk,
            inner_radius: dust.inner_radius,
            outer_radius: dust.outer_radius,
            gm: scene.gravity.constant * scene.star.map_or(0.0, |star| star.mass),
        };
        let mass = match amount {
            scene::DustAmount::DustToGas(ratio) => ratio * ring.mass(),
            scene::DustAmount::Mass(mass) => mass,
        };
        let first = ids.take(dust.particles);
        let law = dust_law(scene, dust);
        let made = grains(dust.particles, mass).strewn(&ring, &law, scene.run.seed, first);
        append(&mut all, &made);
    }
    for b in &dust.blocks {
        let (x, mass, first) = block(scene, &b.block, ids, Purpose::DustPositions);
        let n = x.len();
        let own = Grains {
            sizes: b.size.map_or(sizes, grains::Sizes::One),
            material_density: b.material_density.unwrap_or(dust.material_density),
            ..grains(n, mass * n as f64)
        };
        let mut made = own.block(x, first);
        streaming(scene, b.block.velocity, &made.x, &mut made.v);
        if let Some(stopping) = b.stopping {
            made.stopping = vec![stopping; n];
        }
        append(&mut all, &made);
    }
    let first = ids.take(file.len());
    number(&mut file.id, first);
    append(&mut all, &file);
    sublimation::mix(scene, &mut all);
    all
}

/// Adds what the disk's own gravity asks of its rotation: gas and dust of a generated disk turn in balance with all masses.
fn balance(scene: &Scene, disk: &scene::Disk, system: &mut System) {
    let Some(gas) = &scene.gas else { return };
    let made = disk_of(scene, gas, disk);
    let pulls = |source: scene::Mass| scene.gravity.pulls.has(source, scene::Mass::Gas);
    if !scene.gravity.fluids_pull_gas() {
        return;
    }
    let soft = |softening: scene::Softening, h: f64| match softening {
        scene::Softening::SmoothingLength => h,
        scene::Softening::Fixed(length) => length,
    };
    let (g, d) = (&system.gas.particles, &system.dust.particles);
    let x: Vec<Vec3> = g.x.iter().chain(&d.x).copied().collect();
    let weight = |source: scene::Mass, m: f64| if pulls(source) { m } else { 0.0 };
    let m: Vec<f64> =
        g.m.iter()
            .map(|&m| weight(scene::Mass::Gas, m))
            .chain(d.m.iter().map(|&m| weight(scene::Mass::Dust, m)))
            .collect();
    let dust_softening = scene
        .dust
        .as_ref()
        .map_or(scene::Softening::Fixed(0.0), |d| d.softening);
    let softening: Vec<f64> =
        g.h.iter()
            .map(|&h| soft(gas.softening, h))
            .chain(d.h.iter().map(|&h| soft(dust_softening, h)))
            .collect();
    let mut solver = Gravity::new(Settings {
        accuracy: Accuracy::ForceError(1e-3),
        method: Method::Automatic,
        constant: scene.gravity.constant,
    });
    solver.build(&x, &m, &softening);
    let mut a = vec![Vec3::zeros(); x.len()];
    let all: Vec<u32> = (0..x.len() as u32).collect();
    solver.field(&all, &mut a, &mut []);
    let centre = system.star.x.first().copied().unwrap_or_else(Vec3::zeros);
    let drift = system.star.v.first().copied().unwrap_or_else(Vec3::zeros);
    let turn = |x: Vec3, a: Vec3| {
        let r = x - centre;
        let radius = r.x.hypot(r.y).max(f64::MIN_POSITIVE);
        drift + made.rotation(r, (a.x * r.x + a.y * r.y) / radius)
    };
    let n = system.gas.len();
    for i in 0..n {
        system.gas.particles.v[i] = turn(x[i], a[i]);
    }
    for i in 0..system.dust.len() {
        system.dust.particles.v[i] = turn(x[n + i], a[n + i]);
    }
    system.gas.rates.v_pred.clone_from(&system.gas.particles.v);
    system
        .dust
        .rates
        .v_pred
        .clone_from(&system.dust.particles.v);
}
