//! Rules between keys: what each value allows by itself, but not all of them together.
//!
//! A value that has already been refused stands here as not-a-number, which breaks no rule.

mod composition;
mod frame;
mod growth;
mod plane;

use crate::document::{Entries, Node, Place, Value};
use crate::reader::Door;
use crate::scene::{
    Block, BodyDrag, Collisions, Coordinates, Disk, DiskAmount, Dust, DustDrag, Eos, Gas, GasDisk,
    Integrator, Mass, Orbit, Planetesimals, Scene, Sizes, TimeStep, Turbulence,
};
use crate::units::System;

/// Says what is wrong with the key at a path, at its line or that of the deepest table above that the file has.
pub struct Complaints<'a> {
    entries: &'a Entries,
    door: &'a Door,
}

impl<'a> Complaints<'a> {
    pub fn new(entries: &'a Entries, door: &'a Door) -> Self {
        Self { entries, door }
    }

    fn say(&self, path: &str, sentence: &str) {
        let (place, value) = self.deepest(path);
        let shown = match value {
            Some(value) if !matches!(value, Value::Table(_)) => format!("{path} = {value}"),
            _ => path.to_owned(),
        };
        self.door.report(&place, format!("{shown}: {sentence}"));
    }

    /// The place of the deepest node on the path, and the value if the path goes all the way.
    fn deepest(&self, path: &str) -> (Place, Option<&'a Value>) {
        let mut place = Place::Line(1);
        let mut value: Option<&Value> = None;
        for (depth, step) in path.split('.').enumerate() {
            let next: Option<&Node> = match value {
                None if depth == 0 => named(self.entries, step),
                Some(Value::Table(entries)) => named(entries, step),
                Some(Value::List(items)) => step.parse().ok().and_then(|i: usize| items.get(i)),
                _ => None,
            };
            let Some(node) = next else {
                return (place, None);
            };
            place = node.place.clone();
            value = Some(&node.value);
        }
        (place, value)
    }
}

fn named<'n>(entries: &'n Entries, key: &str) -> Option<&'n Node> {
    entries
        .iter()
        .find(|(name, _)| name == key)
        .map(|(_, node)| node)
}

/// Steps that a run can do: some months of one body's.
pub const MOST_STEPS: f64 = 1e12;

/// All rules.
pub fn rules(scene: &Scene, complaints: &Complaints<'_>) {
    something_to_model(scene, complaints);
    steps(scene, complaints);
    plane::rules(scene, complaints);
    if let Some(gas) = &scene.gas {
        gas_rules(scene, gas, complaints);
    }
    if let Some(dust) = &scene.dust {
        dust_rules(scene, dust, complaints);
    }
    if let Some(bodies) = &scene.planetesimals {
        body_rules(scene, bodies, complaints);
    }
    planet_rules(scene, complaints);
    if let Some(disk) = &scene.surroundings.disk {
        surrounding_disk_rules(scene, disk, complaints);
    }
}

fn something_to_model(scene: &Scene, complaints: &Complaints<'_>) {
    let tables = ["gas", "dust", "planetesimals", "planet"];
    if tables
        .iter()
        .all(|table| named(complaints.entries, table).is_none())
        && complaints.door.is_content()
    {
        complaints.door.report(
            &Place::Line(0),
            "there is nothing to model: give [gas], [dust], [planetesimals] or [[planet]]".into(),
        );
    }
    if scene.star.is_some() && scene.domain.size().is_some() {
        let sentence = match scene.domain.hill() {
            Some(_) => {
                "has no place in a shearing box, which turns about it: its mass is in domain.rate"
            }
            None => "cannot stand in a periodic domain",
        };
        complaints.say("star", sentence);
    }
    frame::rules(scene, complaints);
    let edge = scene.gas.as_ref().and_then(|gas| gas.edge);
    if edge.is_some_and(|edge| edge.supported)
        && scene.star.is_some_and(|star| star.accretion_radius == 0.0)
    {
        complaints.say(
            "gas.edge.inner",
            "needs star.accretion_radius, at which it is",
        );
    }
    if let Some(star) = scene.star
        && let Some(disk) = scene.gas.as_ref().and_then(|gas| gas.disk)
        && star.accretion_radius > disk.inner_radius
    {
        complaints.say(
            "star.accretion_radius",
            "reaches beyond gas.disk.inner_radius: the star would swallow the inner disk at once",
        );
    }
}

fn steps(scene: &Scene, complaints: &Complaints<'_>) {
    let bodies = scene.planetesimals.as_ref();
    let given = [
        ("run.time_step", Some(scene.run.time_step)),
        ("planetesimals.time_step", bodies.map(|b| b.time_step)),
    ];
    for (path, step) in given {
        if let Some(TimeStep::Fixed(dt)) = step
            && scene.run.end_time / dt > MOST_STEPS
        {
            let sentence = format!("makes more than {MOST_STEPS:e} steps to run.end_time");
            complaints.say(path, &sentence);
        }
    }
}

fn gas_rules(scene: &Scene, gas: &Gas, complaints: &Complaints<'_>) {
    if let Some(disk) = &gas.disk {
        disk_rules(scene, disk, complaints);
    }
    for (i, entry) in gas.blocks.iter().enumerate() {
        block_rules(scene, &entry.block, &format!("gas.block.{i}"), complaints);
    }
    let total: f64 = gas
        .blocks
        .iter()
        .map(|entry| block_number(scene, &entry.block))
        .sum();
    too_many(total + gas.particles as f64, "gas.block", complaints);
    eos_rules(scene, gas, complaints);
    if let Some([alpha, beta]) = gas.viscosity.parameters()
        && alpha == 0.0
    {
        complaints.say(
            "gas.viscosity.alpha",
            if beta == 0.0 {
                "and beta are both 0; for gas without viscosity give kind = \"none\""
            } else {
                "must be above 0, since beta follows it in a fixed ratio"
            },
        );
    }
}

/// What the equation of state allows beside it.
fn eos_rules(scene: &Scene, gas: &Gas, complaints: &Complaints<'_>) {
    let hydro = crate::populate::hydro(scene, gas);
    if let Some(key) = hydro.unsuited() {
        let sentence = format!(
            "needs a gas whose pressure and energy follow from its sound speed; gas.eos.kind = \"{}\" allows \"density\", \"pressure\", \"number\" and no conduction",
            gas.eos.name()
        );
        complaints.say(&format!("gas.{key}"), &sentence);
    }
    if let Some((key, sentence)) = hydro.clashing() {
        complaints.say(&format!("gas.{key}"), sentence);
    }
    if gas.mean_molecular_weight.is_some() {
        return;
    }
    let sentence = "needs a gas with molecules; allowed in this gas.eos are laws of constant times and numbers";
    if scene.coupling.gas_dust
        && scene
            .dust
            .as_ref()
            .is_some_and(|dust| dust.drag.is_physical())
    {
        complaints.say("dust.drag.law", sentence);
    }
    if scene.coupling.gas_planetesimals
        && (scene.planetesimals.as_ref()).is_some_and(|bodies| bodies.drag == BodyDrag::Adachi)
    {
        complaints.say("planetesimals.drag.law", sentence);
    }
}

fn disk_rules(scene: &Scene, disk: &Disk, complaints: &Complaints<'_>) {
    if disk.inner_radius >= disk.outer_radius {
        complaints.say(
            "gas.disk.inner_radius",
            "must be less than gas.disk.outer_radius",
        );
    }
    if scene.domain.size().is_some() {
        complaints.say("gas.disk", "needs an open domain");
    }
    if disk.aspect_ratio > 0.5 {
        let key = match scene.gas.as_ref().map(|gas| &gas.eos) {
            Some(Eos::Ideal { .. }) => "gas.disk.aspect_ratio",
            Some(Eos::Isothermal { .. }) => "gas.eos.sound_speed",
            _ => "gas.eos.aspect_ratio",
        };
        let sentence = format!(
            "makes a disk of aspect ratio {:.3}; more than 0.5 is no disk",
            disk.aspect_ratio
        );
        complaints.say(key, &sentence);
    }
    if let (DiskAmount::Mass(mass), Some(star)) = (disk.amount, scene.star)
        && mass > star.mass
    {
        complaints.say(
            "gas.disk.mass",
            "is more than the star's: such a disk has no orbits",
        );
    }
}

/// The particles that fill a block.
pub fn block_number(scene: &Scene, block: &Block) -> f64 {
    (0..3)
        .filter(|&axis| scene.domain.axes[axis])
        .map(|axis| (block.hi[axis] - block.lo[axis]) / block.spacing)
        .product()
}

fn block_rules(scene: &Scene, block: &Block, path: &str, complaints: &Complaints<'_>) {
    let axes = |test: &dyn Fn(usize) -> bool| (0..3).filter(|&a| scene.domain.axes[a]).any(test);
    if axes(&|axis| block.lo[axis] >= block.hi[axis]) {
        complaints.say(
            &format!("{path}.hi"),
            "must be greater than lo along every axis",
        );
    } else if axes(&|axis| block.hi[axis] - block.lo[axis] < block.spacing) {
        complaints.say(
            &format!("{path}.spacing"),
            "is wider than the box from lo to hi",
        );
    }
    for (key, corner) in [("lo", block.lo), ("hi", block.hi)] {
        if frame::outside(scene, corner) {
            complaints.say(
                &format!("{path}.{key}"),
                match scene.domain.hill() {
                    Some(_) => frame::OUTSIDE,
                    None => "lies outside the periodic box, which reaches from 0 to domain.size",
                },
            );
        }
    }
}

fn too_many(number: f64, path: &str, complaints: &Complaints<'_>) {
    if number > 2f64.powi(31) {
        let sentence = format!("makes {number:.3e} particles; the most is 2147483648 a population");
        complaints.say(path, &sentence);
    }
}

fn dust_rules(scene: &Scene, dust: &Dust, complaints: &Complaints<'_>) {
    if dust.particles > 0 && dust.inner_radius >= dust.outer_radius {
        complaints.say("dust.inner_radius", "must be less than dust.outer_radius");
    }
    if let Some(disk) = &scene.surroundings.disk
        && dust.particles > 0
        && (dust.inner_radius < disk.inner_radius || dust.outer_radius > disk.outer_radius)
    {
        let sentence = format!(
            "must lie within surroundings.disk, from {} to {}",
            disk.inner_radius, disk.outer_radius
        );
        let inside = dust.inner_radius >= disk.inner_radius;
        let key = if inside { "outer" } else { "inner" };
        complaints.say(&format!("dust.{key}_radius"), &sentence);
    }
    if dust.turbulence != Turbulence::None
        && dust.drag != DustDrag::None
        && !scene.coupling.gas_dust
    {
        complaints.say(
            "dust.turbulence",
            "needs the drag of gas on dust, which coupling.drag leaves out",
        );
    }
    if let Some(Sizes::Range { min, max, .. }) = dust.sizes
        && min >= max
    {
        complaints.say("dust.size.min", "must be less than dust.size.max");
    }
    growth::rules(scene, dust, complaints);
    composition::rules(scene, dust, complaints);
    for (i, entry) in dust.blocks.iter().enumerate() {
        block_rules(scene, &entry.block, &format!("dust.block.{i}"), complaints);
    }
    let total: f64 = dust
        .blocks
        .iter()
        .map(|entry| block_number(scene, &entry.block))
        .sum();
    too_many(total + dust.particles as f64, "dust.block", complaints);
}

fn body_rules(scene: &Scene, bodies: &Planetesimals, complaints: &Complaints<'_>) {
    let path = "planetesimals";
    if bodies.number > 0 && bodies.inner_radius >= bodies.outer_radius {
        complaints.say(
            "planetesimals.inner_radius",
            "must be less than planetesimals.outer_radius",
        );
    }
    let framed = scene.domain.hill().is_some();
    if bodies.integrator == Integrator::WisdomHolman && !framed {
        if scene.star.is_none() {
            complaints.say(
                "planetesimals.integrator",
                "needs a [star], about which the orbits are",
            );
        }
        if bodies.collisions != Collisions::None {
            complaints.say(
                "planetesimals.integrator",
                "cannot follow close encounters; collisions need \"auto\", \"hybrid\", \"leapfrog\", \"hermite\" or \"gauss-radau\"",
            );
        }
    }
    if bodies.integrator == Integrator::Hybrid && !framed {
        hybrid_rules(scene, complaints);
    }
    if let Coordinates::Jacobi(_) = bodies.coordinates {
        jacobi_rules(scene, bodies, complaints);
    }
    let sizeless = bodies.number > 0 && bodies.density == 0.0;
    if sizeless && bodies.drag == BodyDrag::Adachi {
        complaints.say(
            "planetesimals.density",
            "must be greater than 0: the law \"adachi\" needs the bodies' size",
        );
    }
    if sizeless && bodies.collisions != Collisions::None {
        complaints.say(
            "planetesimals.density",
            "must be greater than 0: collisions need the bodies' size",
        );
    }
    if let Collisions::Fragment { fragment_mass, .. } = bodies.collisions
        && bodies.number > 0
        && fragment_mass > bodies.mass
    {
        complaints.say(
            "planetesimals.collisions.fragment_mass",
            "is more than the mass of a planetesimal: nothing could break",
        );
    }
    if bodies.number > 0 && scene.domain.size().is_some() && scene.domain.hill().is_none() {
        complaints.say(
            path,
            "cannot orbit in a periodic domain; give them by an initial.file",
        );
    }
}

fn surrounding_disk_rules(scene: &Scene, disk: &GasDisk, complaints: &Complaints<'_>) {
    const INNER: &str = "surroundings.disk.inner_radius";
    if disk.inner_radius >= disk.outer_radius {
        complaints.say(INNER, "must be less than surroundings.disk.outer_radius");
        return;
    }
    let law = crate::assemble::gas_disk(disk);
    for (edge, r) in [("inner", disk.inner_radius), ("outer", disk.outer_radius)] {
        let h = law.aspect_ratio(r);
        if h > 0.5 {
            let sentence = format!(
                "makes a disk of H/r = {h:.3} at its {edge} edge; more than 0.5 is no disk"
            );
            complaints.say("surroundings.disk.aspect_ratio", &sentence);
            return;
        }
        if law.rotation(r, 0.0) <= 0.0 {
            let sentence = format!("makes a pressure that leaves no orbit at its {edge} edge");
            complaints.say("surroundings.disk.surface_density_slope", &sentence);
            return;
        }
    }
    if disk.drag == BodyDrag::Adachi {
        if scene.units.system == System::Dimensionless {
            complaints.say(
                "surroundings.disk.drag",
                "needs molecules, and so physical units; in a dimensionless scene allowed are \"quadratic\" and \"constant-stopping-time\"",
            );
        }
        let sizeless = |bodies: &Planetesimals| {
            bodies.number > 0
                && (bodies.density == 0.0 || (bodies.mass == 0.0 && bodies.radius == 0.0))
        };
        if scene.planetesimals.as_ref().is_some_and(sizeless) {
            complaints.say(
                "surroundings.disk.drag",
                "needs the planetesimals' size: planetesimals.density, and radius if they have no mass",
            );
        }
    }
    let idle = disk.drag == BodyDrag::None && !disk.migration && !scene.coupling.gas_dust;
    if idle && complaints.door.is_content() {
        complaints.say(
            "surroundings.disk",
            "acts on nothing: give drag, migration = true, or [dust] with a law of drag",
        );
    }
}

/// What the hybrid map needs.
fn hybrid_rules(scene: &Scene, complaints: &Complaints<'_>) {
    let path = "planetesimals.integrator";
    if scene.star.is_none() {
        complaints.say(path, "needs a [star], about which the orbits are");
    }
    if !all_bodies_pull(scene) {
        complaints.say(
            path,
            "needs gravity among all bodies, with nothing left out by gravity.method or gravity.pulls",
        );
    }
}

/// Whether all bodies that the scene has pull each other.
pub fn all_bodies_pull(scene: &Scene) -> bool {
    let present = [Mass::Planetesimals, Mass::Planets, Mass::Star]
        .into_iter()
        .filter(|&mass| scene.has(mass));
    let mut pairs = present
        .clone()
        .flat_map(|a| present.clone().map(move |b| (a, b)));
    pairs.all(|(a, b)| (a, b) == (Mass::Star, Mass::Star) || scene.gravity.pulls.has(a, b))
}

/// What the map in Jacobi coordinates needs, since it does all forces on the bodies itself.
fn jacobi_rules(scene: &Scene, bodies: &Planetesimals, complaints: &Complaints<'_>) {
    let path = "planetesimals.coordinates";
    if bodies.integrator != Integrator::WisdomHolman {
        complaints.say(path, "belong to integrator = \"wisdom-holman\"");
    }
    if scene.gas.is_some() || scene.dust.is_some() {
        complaints.say(
            path,
            "cannot stand beside [gas] or [dust], which kick the bodies; give \"democratic-heliocentric\"",
        );
    }
    if scene.has_surroundings() {
        complaints.say(
            path,
            "cannot stand beside [surroundings] or migration_time, which kick the bodies; give \"democratic-heliocentric\"",
        );
    }
    if !all_bodies_pull(scene) {
        complaints.say(
            path,
            "needs gravity among all bodies, with nothing left out by gravity.method or gravity.pulls",
        );
    }
}

fn planet_rules(scene: &Scene, complaints: &Complaints<'_>) {
    for (i, planet) in scene.planets.iter().enumerate() {
        let path = format!("planet.{i}");
        match planet.orbit {
            Orbit::Elements {
                semi_major_axis,
                eccentricity,
                ..
            } => {
                let swallowed = scene.star.is_some_and(|star| {
                    semi_major_axis * (1.0 - eccentricity) < star.accretion_radius
                });
                if swallowed {
                    complaints.say(
                        &format!("{path}.semi_major_axis"),
                        "leads through star.accretion_radius: the planet would be swallowed",
                    );
                }
            }
            Orbit::State { position, .. } => {
                // Closer than any square of a distance says.
                if scene.star.is_some() && position.norm_squared() == 0.0 {
                    complaints.say(&format!("{path}.position"), "is that of the star");
                }
                if scene.domain.hill().is_some() && frame::outside(scene, position) {
                    complaints.say(&format!("{path}.position"), frame::OUTSIDE);
                }
            }
        }
    }
}
