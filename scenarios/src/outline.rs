//! The outline of a scene: what it models and what not, how large it is, its first steps, and what a run of it is likely to cost.
//!
//! The start is really made and the scene advanced for a moment, from which its cost follows.

use gas::Reconstruction;
use gas::rearrangement::Order;
use std::fmt::Write;

use coupling::System;
use nbody::points::{Columns, Dimension};

use crate::cost;
use crate::read::gas::{FORMULATIONS, name_of, viscosity_name};
use crate::run::RunError;
use crate::scene::{
    BodyDrag, Collisions, Cooling, CoolingTime, Eos, Gradient, GrainMotion, Growth, Physical,
    Scene, Turbulence,
};

/// Wall-clock time for which a scene is advanced to see what it costs, s.
const MOMENT: f64 = 0.5;

/// What `check` says of a scene.
pub fn outline(scene: &Scene) -> Result<String, RunError> {
    let sampled = cost::sample(scene, MOMENT)?;
    let system = &sampled.system;
    let mut text = format!("{}\n\nmodelled:\n{}", scene.title, populations(system));
    let mut line =
        |words: String| writeln!(text, "{words}").expect("writing to a string does not fail");
    line(format!(
        "  operators of a step: {}",
        sampled.operators.join(", ")
    ));
    let said = method(scene).into_iter().chain(sampled.remarks.clone());
    said.chain(growth(scene))
        .chain(composition(scene))
        .chain(surroundings(scene, system))
        .for_each(|words| line(format!("  {words}")));
    line(format!(
        "not modelled: {}",
        absent(scene, system).join(", ")
    ));
    line(format!(
        "memory: {:.1} MB of particles",
        bytes(system) as f64 / 1e6
    ));
    if let Some([shortest, longest]) = sampled.first {
        let unit = scene.units.symbol(Dimension::TIME);
        line(format!(
            "first steps: {shortest:.3e} to {longest:.3e} {unit}"
        ));
        let cost = &sampled.cost;
        let particles = system.gas.len() + system.dust.len() + system.bodies.len();
        let updates: f64 = cost.updates().iter().sum();
        line(format!(
            "cost: about {:.0} steps a particle, {} on this machine now",
            updates / particles as f64,
            duration(cost.wall_s())
        ));
    }
    Ok(text)
}

fn populations(system: &System) -> String {
    let mut text = String::new();
    let planets = system
        .bodies
        .kind
        .iter()
        .filter(|&&kind| kind == nbody::Kind::Planet as u32)
        .count();
    let counts = [
        ("star", system.star.len()),
        ("planets", planets),
        ("planetesimals", system.bodies.len() - planets),
        ("gas particles", system.gas.len()),
        ("dust superparticles", system.dust.len()),
    ];
    for (name, count) in counts.into_iter().filter(|(_, count)| *count > 0) {
        writeln!(text, "  {count} {name}").expect("writing to a string does not fail");
    }
    text
}

/// How the gas is solved.
fn method(scene: &Scene) -> Option<String> {
    let gas = scene.gas.as_ref()?;
    let formulation = name_of(&FORMULATIONS, gas.hydro.formulation);
    let viscosity = match gas.viscosity.parameters() {
        None => "no viscosity".to_owned(),
        Some([alpha, _]) => format!(
            "viscosity {} with alpha up to {alpha}{}",
            viscosity_name(&gas.viscosity),
            match gas.reconstruction {
                Reconstruction::None => "",
                Reconstruction::Linear => " of what linear flow leaves",
            }
        ),
    };
    let gradient = match gas.hydro.gradient {
        Gradient::Standard => "",
        Gradient::Matrix => ", linear-exact gradients",
    };
    let physical = match gas.physical {
        Physical::None => String::new(),
        Physical::Constant { nu } => format!(", kinematic viscosity {nu}"),
        Physical::ShakuraSunyaev { alpha, .. } => format!(", Shakura-Sunyaev alpha = {alpha}"),
    };
    let conduction = if gas.conduction > 0.0 {
        format!(", conduction alpha = {}", gas.conduction)
    } else {
        String::new()
    };
    let rearranged = match gas.rearrange {
        None => String::new(),
        Some(Order::Repulsion { strength }) => {
            format!(", rearranged at {strength} times the shear")
        }
        Some(Order::Continuity(_)) => ", placed by the continuity equation".to_owned(),
    };
    let eos = match &gas.eos {
        Eos::Ideal { gamma } => format!("ideal, gamma = {gamma}"),
        Eos::Barotropic(law) => format!("barotropic, gamma = {} when dense", law.gamma),
        Eos::Stiffened(law) => format!("stiffened, gamma = {}", law.gamma),
        Eos::Tillotson { material } => format!("Tillotson's {material}"),
        Eos::Tabulated { file, .. } => format!("tabulated in {}", file.display()),
        other => other.name().replace('-', " "),
    };
    let cooling = match &gas.cooling {
        Cooling::None => String::new(),
        Cooling::Beta { beta, floor } => {
            let floor = if floor.is_some() { ", to a floor" } else { "" };
            format!(", cooling in {beta} / Omega{floor}")
        }
        Cooling::Relaxation { time, .. } => match time {
            CoolingTime::Orbital(beta) => format!(", relaxing in {beta} / Omega"),
            CoolingTime::Time(time) => format!(", relaxing in {time} units of time"),
        },
    };
    let edge = match gas.edge {
        Some(edge) => {
            let rotation = match scene.gravity.fluids_pull_gas() || gas.disk.is_none() {
                true => " but for the rotation",
                false => "",
            };
            let damped = match (edge.inner, edge.outer) {
                (None, None) => String::new(),
                _ => format!(", edges damped in {} / Omega{rotation}", edge.time),
            };
            let held = match edge.supported {
                true => ", held at the accretion radius",
                false => "",
            };
            damped + held
        }
        None => String::new(),
    };
    Some(format!(
        "gas: {eos}; SPH that sums {formulation}, {} neighbours{gradient}, {viscosity}{physical}{conduction}{rearranged}{cooling}{edge}",
        gas.hydro.neighbours
    ))
}

/// Whether grains can break.
fn breaks(growth: &Growth) -> bool {
    matches!(growth, Growth::Physical(growth) if growth.fragmentation_speed.is_finite())
}

/// How grains grow.
fn growth(scene: &Scene) -> Option<String> {
    let growth = match scene.dust.as_ref()?.growth? {
        Growth::Exact { kernel, rate } => {
            let kernel = format!("{kernel:?}").to_lowercase();
            return Some(format!("growth of grains: {kernel} kernel of rate {rate}"));
        }
        Growth::Physical(growth) => growth,
    };
    let mut sources = Vec::new();
    if growth.brownian {
        sources.push("Brownian motion".to_owned());
    }
    if growth.alpha > 0.0 {
        sources.push(format!("turbulence of alpha = {}", growth.alpha));
    }
    match growth.motion {
        GrainMotion::None => {}
        GrainMotion::Resolved => sources.push("the motion of the superparticles".to_owned()),
        GrainMotion::Steady { headwind } => {
            sources.push(format!("steady drift in a head wind of {headwind}"));
        }
    }
    let shape = match growth.rolling_energy {
        Some(_) => "porous",
        None => "compact",
    };
    let threshold = |does: &str, speed: f64| match speed.is_finite() {
        true => format!(", {does} above {speed:.4e}"),
        false => String::new(),
    };
    Some(format!(
        "growth of {shape} grains by {}{}{}",
        sources.join(", "),
        threshold("bouncing", growth.bouncing_speed),
        threshold("breaking", growth.fragmentation_speed)
    ))
}

/// What grains are made of.
fn composition(scene: &Scene) -> Option<String> {
    let composition = scene.dust.as_ref()?.composition?;
    let [ice, silicate, iron] = composition.fractions;
    let ice_does = match composition.sublimation {
        true => "sublimates into the gas and recondenses; silicate and iron do not",
        false => "stays",
    };
    Some(format!(
        "grains of ice {ice}, silicate {silicate} and iron {iron} by mass; the ice {ice_does}"
    ))
}

/// What acts by a formula, and on whom.
fn surroundings(scene: &Scene, system: &System) -> Vec<String> {
    let mut said = Vec::new();
    if let Some(hill) = scene.domain.hill() {
        said.push(format!(
            "a shearing box: Coriolis force and tide at Omega = {}, q = {}",
            hill.rate, hill.shear
        ));
        if scene.local.vertical_gravity {
            said.push("  vertical gravity of the star".to_owned());
        }
        if scene.local.headwind != 0.0 {
            let push = 2.0 * hill.rate * scene.local.headwind;
            said.push(format!("  the disk's pressure gradient, {push} on the gas"));
        }
    }
    let given = &scene.surroundings;
    if given.speed_of_light.is_some() {
        said.push("relativity: the star's pericentre advance of first order, on bodies".to_owned());
    }
    if let Some(oblateness) = &given.oblateness {
        said.push(format!(
            "oblateness of the star: J2 = {}, on bodies",
            oblateness.j2
        ));
    }
    let bodies = &system.bodies;
    let planet = |i: usize| bodies.kind[i] == nbody::Kind::Planet as u32;
    let count = |test: &dyn Fn(usize) -> bool| (0..bodies.len()).filter(|&i| test(i)).count();
    let moved = scene.planets.iter().filter(|p| p.migration_time.is_some());
    let moved = moved.count();
    if moved > 0 {
        said.push(format!("prescribed migration of {moved} planets"));
    }
    if let Some(disk) = &given.disk {
        said.push("a gas disk as a formula, without gravity of its own".to_owned());
        if disk.drag != BodyDrag::None {
            let sized = |i: usize| bodies.radius[i] > 0.0 && bodies.mean_density(i) > 0.0;
            let felt = |i: usize| {
                (!planet(i) || bodies.m[i] == 0.0) && (disk.drag != BodyDrag::Adachi || sized(i))
            };
            let number = count(&felt);
            said.push(format!(
                "  its drag on {number} planetesimals and test particles"
            ));
        }
        if scene.coupling.gas_dust {
            let number = system.dust.len();
            said.push(format!(
                "  its drag on {number} dust superparticles, without reaction"
            ));
        }
        if disk.migration {
            let number = count(&|i| bodies.m[i] > 0.0);
            said.push(format!("  its type-I torques on {number} bodies with mass"));
        }
    }
    said.extend(stirring(scene));
    let massless = count(&|i| bodies.m[i] == 0.0);
    if massless > 0 && scene.domain.hill().is_none() {
        said.push(format!(
            "{massless} of the bodies are test particles: they feel gravity and do not pull"
        ));
    }
    said
}

/// What stirs the dust.
fn stirring(scene: &Scene) -> Option<String> {
    let alpha = match scene.dust.as_ref()?.turbulence {
        Turbulence::None => return None,
        Turbulence::Given(alpha) => format!("alpha = {alpha}"),
        Turbulence::Measured { floor } => {
            format!("the gas's own alpha, measured in rings (at least {floor})")
        }
    };
    Some(format!(
        "stirring of dust by turbulence of {alpha}, D = alpha c^2/Omega / (1 + St^2)"
    ))
}

/// What a reader could expect and the scene leaves out.
pub fn absent(scene: &Scene, system: &System) -> Vec<&'static str> {
    let gas = !system.gas.is_empty();
    let breaking = scene
        .planetesimals
        .as_ref()
        .is_some_and(|p| matches!(p.collisions, Collisions::Fragment { .. }));
    let fluids = gas || !system.dust.is_empty();
    let growing = scene.dust.as_ref().and_then(|dust| dust.growth);
    let given = &scene.surroundings;
    let disk = given.disk;
    let lacks = [
        (
            system.star.is_empty() && scene.domain.hill().is_none(),
            "a star",
        ),
        (
            scene.domain.hill().is_some() && !scene.local.vertical_gravity,
            "vertical gravity",
        ),
        (!gas, "gas"),
        (system.dust.is_empty(), "dust"),
        (system.bodies.is_empty(), "planetesimals and planets"),
        (
            scene.gravity.method == crate::scene::GravityMethod::None,
            "gravity of gas, dust and planetesimals",
        ),
        (
            gas && !system.dust.is_empty() && !scene.coupling.gas_dust,
            "drag between gas and dust",
        ),
        (
            gas && !system.bodies.is_empty() && !scene.coupling.gas_planetesimals,
            "drag between gas and bodies",
        ),
        (
            gas && !scene.coupling.feedback,
            "the gas's reaction to drag",
        ),
        (
            gas && !scene.coupling.mixtures,
            "what grains of several stopping times, and bodies, do to each other through the gas within a step",
        ),
        (
            gas && scene
                .gas
                .as_ref()
                .is_some_and(|gas| gas.cooling == Cooling::None),
            "cooling",
        ),
        (gas, "magnetic fields, radiation"),
        (
            !system.dust.is_empty() && growing.is_none(),
            "growth and fragmentation of grains",
        ),
        (
            scene
                .dust
                .as_ref()
                .is_some_and(|dust| dust.turbulence == Turbulence::None),
            "turbulent stirring of dust",
        ),
        (
            (scene.dust.as_ref()).is_some_and(|dust| dust.composition.is_none()),
            "sublimation of grains",
        ),
        (
            !system.dust.is_empty() && growing.is_some_and(|g| !breaks(&g)),
            "fragmentation of grains",
        ),
        (
            !system.bodies.is_empty() && !breaking,
            "fragmentation of bodies",
        ),
        (
            disk.is_some_and(|disk| disk.drag == BodyDrag::None),
            "drag of the gas disk on planetesimals",
        ),
        (
            disk.is_some_and(|disk| !disk.migration),
            "torques of the gas disk on planets",
        ),
        (
            disk.is_some() && !system.dust.is_empty() && !scene.coupling.gas_dust,
            "drag of the gas disk on dust",
        ),
        (
            fluids && (given.speed_of_light.is_some() || given.oblateness.is_some()),
            "relativity and oblateness in the motion of gas and dust",
        ),
    ];
    lacks
        .into_iter()
        .filter_map(|(lacks, what)| lacks.then_some(what))
        .collect()
}

fn bytes(system: &System) -> usize {
    let gas = &system.gas;
    let dust = &system.dust;
    let sets: [&dyn Columns; 8] = [
        &gas.particles,
        &gas.derived,
        &gas.rates,
        &dust.particles,
        &dust.derived,
        &dust.rates,
        &system.bodies,
        &system.star,
    ];
    sets.iter().map(|set| set.bytes()).sum()
}

/// A time for people.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 100.0 => format!("{s:.1} s"),
        s if s < 6000.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}
