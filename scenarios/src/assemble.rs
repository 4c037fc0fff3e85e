//! Assembly: from a resolved scene to a system of populations and the list of operators that advances it.
//!
//! Ids are consecutive over all populations: the star has 0, then come planets, planetesimals, gas and dust.

mod choice;
mod doors;

use coupling::accretion::{Accretion, Collisions};
use coupling::cooling::CoolGas;
use coupling::drag::{BodyDrag, DustDrag, DustInDisk, Ties};
use coupling::drift::{
    Blocks, DriftBodies, DriftDust, DriftGas, Encounters, Epicycles, JacobiMap, Kepler, Radau,
    Straight,
};
use coupling::external::{
    Central, DiskDrag, External, GasDisk, Local, Migration, Oblateness, Relativity, Rotation,
    TypeOne,
};
use coupling::gravity::{Gravity, Meetings, Mutual, Plan, Softening};
use coupling::growth::GrowDust;
use coupling::kick::{Density, KickBodies, KickDust, KickGas, Reaction, Steps};
use coupling::rearrange::RearrangeGas;
use coupling::stirring::{Medium, Stir, Strength};
use coupling::stress::MeasureStress;
use coupling::sublimation::Sublimate;
use coupling::{Operator, Splitting, System};
use dust::motion::Parts;
use nbody::gravity as solver;
use nbody::integrators::hybrid::{Hybrid, cutoff::Cutoff};
use nbody::integrators::wisdom_holman::jacobi::Scheme;
use nbody::points::Columns;

use crate::memory;
use crate::populate;
use crate::run::REPORTS;
use crate::scene::{self, Coordinates, Integrator, Mass, Scene, TimeStep, Turbulence};
pub use choice::chosen;
use choice::integrator;
use doors::{countable, separate};

/// A system and its operators.
pub struct Assembly {
    pub system: System,
    pub splitting: Splitting,
    /// Sentences for the log: choices that were made for the user.
    pub remarks: Vec<String>,
}

/// Places all particles and bodies of a scene at its start.
pub fn start(scene: &Scene) -> Result<System, populate::Refusal> {
    memory::fits(scene)?;
    let mut system = System::new(scene.domain, scene.gravity.constant, 0.0);
    populate::fill(scene, &mut system)?;
    if [
        system.star.len(),
        system.bodies.len(),
        system.gas.len(),
        system.dust.len(),
    ] == [0; 4]
    {
        let sentence =
            "there is nothing to model: the scene's tables and its file have no particles";
        return Err(populate::Refusal(sentence.to_owned()));
    }
    system.number_on();
    system.look();
    Ok(system)
}

/// Chooses the operators for a system that is in place; refuses one whose steps are too many to be done.
pub fn assembly(scene: &Scene, mut system: System) -> Result<Assembly, populate::Refusal> {
    let mut remarks = Vec::new();
    let integrator = integrator(scene, &mut system, &mut remarks);
    system.star_in_kick = integrator == Integrator::Leapfrog;
    if system.clock.step == 0 {
        Accretion::default().begin(&mut system);
        separate(&system)?;
        system.bodies_step = bodies_step(scene, &system, integrator);
        system.longest = match scene.run.time_step {
            TimeStep::Fixed(dt) => dt,
            TimeStep::Auto if system.gas.is_empty() && system.dust.is_empty() => {
                stride(scene, integrator, system.bodies_step) * system.bodies_step
            }
            TimeStep::Auto => typical_step(scene, &system),
        };
        countable(scene, &system)?;
    }
    let fixed = match scene.run.time_step {
        TimeStep::Fixed(dt) => dt,
        TimeStep::Auto => f64::INFINITY,
    };
    let splitting = Splitting::new(operators(scene, &system, integrator, fixed));
    Ok(Assembly {
        system,
        splitting,
        remarks,
    })
}

/// The Jacobi map that the scene names.
fn jacobi(scene: &Scene, integrator: Integrator) -> Option<Scheme> {
    match scene.planetesimals.as_ref()?.coordinates {
        Coordinates::Jacobi(scheme) if integrator == Integrator::WisdomHolman => Some(scheme),
        _ => None,
    }
}

/// The bodies' steps in a base step: one, or where nobody looks at the bodies between reports as many as lie between two.
fn stride(scene: &Scene, integrator: Integrator, step: f64) -> f64 {
    let looked_at = scene.star.is_some_and(|star| star.accretion_radius > 0.0);
    if looked_at || jacobi(scene, integrator).is_none() {
        return 1.0;
    }
    (scene.run.end_time / (REPORTS * step))
        .ceil()
        .clamp(1.0, MOST_STEPS)
}

/// Courant's part for grains in gas by that for gas.
const DUST_STEP: f64 = 2.0;

/// Steps of bodies after which the program looks for signals and checkpoints.
const MOST_STEPS: f64 = 65536.0;

/// The step that the middle one of all fluid particles wants by its orbit about the star, or with the frame: longer base steps would only let the order of
/// particles in memory grow stale.
fn typical_step(scene: &Scene, system: &System) -> f64 {
    if let Some(hill) = scene.domain.hill() {
        return scene.accuracy.orbit_step / hill.rate;
    }
    let (Some(&centre), Some(&mass)) = (system.star.x.first(), system.star.m.first()) else {
        return f64::INFINITY;
    };
    let mut radii: Vec<f64> = system
        .gas
        .particles
        .x
        .iter()
        .chain(&system.dust.particles.x)
        .map(|x| (x - centre).norm())
        .collect();
    if radii.is_empty() || mass == 0.0 {
        return f64::INFINITY;
    }
    let middle = radii.len() / 2;
    let (_, radius, _) = radii.select_nth_unstable_by(middle, f64::total_cmp);
    scene.accuracy.orbit_step * (radius.powi(3) / (system.g * mass)).sqrt()
}

/// The step of star and bodies: a part of 1/Omega at the closest pericentre, or what the scene says.
fn bodies_step(scene: &Scene, system: &System, integrator: Integrator) -> f64 {
    if let Some(TimeStep::Fixed(dt)) = scene.planetesimals.as_ref().map(|p| p.time_step) {
        return dt;
    }
    if let TimeStep::Fixed(dt) = scene.run.time_step {
        return dt;
    }
    if let Some(hill) = scene.domain.hill() {
        return match scene.coupling.gas_planetesimals {
            true => scene.accuracy.orbit_step / hill.rate,
            false => f64::INFINITY,
        };
    }
    let touching = scene
        .planetesimals
        .as_ref()
        .is_some_and(|p| p.collisions != scene::Collisions::None);
    let whole = matches!(integrator, Integrator::GaussRadau | Integrator::Hermite);
    let free =
        (whole || lonely(scene, system, integrator)) && !touching && !scene.has_surroundings();
    if free || system.bodies.is_empty() || system.star.is_empty() {
        return f64::INFINITY;
    }
    let (star_x, star_v) = (system.star.x[0], system.star.v[0]);
    let bodies = &system.bodies;
    let shortest = (0..bodies.len())
        .map(|i| {
            let mu = system.g * (system.star.m[0] + bodies.m[i]);
            let (x, v) = (bodies.x[i] - star_x, bodies.v[i] - star_v);
            let h2 = x.cross(&v).norm_squared();
            let e = (v.cross(&x.cross(&v)) / mu - x / x.norm()).norm();
            // Nobody comes closer to the star than it accretes.
            let pericentre = (h2 / mu / (1.0 + e)).max(system.star.radius[0]);
            (pericentre.powi(3) / mu).sqrt()
        })
        .fold(f64::INFINITY, f64::min);
    scene.accuracy.orbit_step * shortest
}

/// Whether each body has the star alone to move it, and the integrator follows such an orbit exactly by steps of any length.
fn lonely(scene: &Scene, system: &System, integrator: Integrator) -> bool {
    let looked_at = scene.star.is_some_and(|star| star.accretion_radius > 0.0);
    let pulled = !system.gas.is_empty() || !system.dust.is_empty();
    let massless = system.bodies.m.iter().all(|&m| m == 0.0);
    let exact = matches!(integrator, Integrator::WisdomHolman | Integrator::Hybrid);
    exact && massless && !pulled && !looked_at
}

fn softening(of: scene::Softening) -> Softening {
    match of {
        scene::Softening::SmoothingLength => Softening::Adaptive(1.0),
        scene::Softening::Fixed(length) => Softening::Length(length),
    }
}

/// The operators that the scene requires, in the order of the first half of a step; no fluid's step is longer than `longest`.
fn operators(
    scene: &Scene,
    system: &System,
    integrator: Integrator,
    longest: f64,
) -> Vec<Box<dyn Operator>> {
    let step = system.bodies_step;
    let (gas, dust) = (!system.gas.is_empty(), !system.dust.is_empty());
    let bodies = !system.bodies.is_empty() || !system.star.is_empty();
    let hydro = scene.gas.as_ref().map(|g| populate::hydro(scene, g));
    let mut list: Vec<Box<dyn Operator>> = Vec::new();
    let grown = scene.dust.as_ref().filter(|_| dust);
    if let Some(kernel) = grown.and_then(|d| populate::growth::kernel(scene, d)) {
        // The outermost: closes after and opens before all others.
        list.push(Box::new(GrowDust::new(kernel, scene.run.seed)));
    }
    let phases = hydro.as_ref().filter(|_| gas && dust);
    if let Some(phases) = phases.and_then(|hydro| populate::sublimation::phases(scene, hydro)) {
        list.push(Box::new(Sublimate::new(phases)));
    }
    if let Some(hydro) = hydro.clone().filter(|_| gas) {
        if let Some(order) = scene.gas.as_ref().and_then(|gas| gas.rearrange) {
            // Moves before densities are found, and settles after all else is closed.
            list.push(Box::new(RearrangeGas::new(hydro.clone(), order)));
        }
        let neighbours = hydro.neighbours;
        list.push(Box::new(Density { hydro }));
        if dust && scene.has_measured_alpha() {
            // Closes after all that changes velocities.
            list.push(Box::new(MeasureStress { neighbours }));
        }
        // Closes after all that heats the gas.
        let cooling = scene.gas.as_ref().and_then(populate::cooling);
        if let Some(cooling) = cooling {
            list.push(Box::new(CoolGas { cooling }));
        }
        let edges = scene.gas.as_ref().and_then(|g| populate::edges(scene, g));
        if let Some(edges) = edges {
            list.push(Box::new(edges));
        }
    }
    let plan = plan(scene, integrator, step);
    let mut drift = DriftGas {
        always: false,
        observers: [false; 3],
    };
    list.extend(local_forces(scene));
    let framed = scene.domain.hill().is_some();
    if plan.tree.is_some() || bodies && !framed {
        let gravity = Gravity::new(plan.clone());
        drift.observers = gravity.observers();
        list.push(Box::new(gravity));
    }
    let dragged = (scene.planetesimals.as_ref())
        .filter(|_| gas && scene.coupling.gas_planetesimals)
        .map(|p| populate::body_law(scene, p));
    // One exchange for all that gas drags: each feels what others do to the gas.
    let together = scene.coupling.mixtures && dust && scene.coupling.gas_dust;
    if let (true, true, Some(d), Some(hydro)) =
        (gas, dust && scene.coupling.gas_dust, &scene.dust, &hydro)
    {
        drift.always = true;
        let mut drag = DustDrag::new(
            populate::dust_law(scene, d),
            hydro,
            scene.coupling.feedback,
            scene.coupling.heat_share,
        );
        drag.mixtures = scene.coupling.mixtures;
        drag.bodies = dragged.filter(|_| together);
        drag.tolerance = scene.coupling.tolerance;
        list.push(Box::new(drag));
    }
    list.extend(dust_in_disk(scene).filter(|_| dust));
    if let (Some(law), Some(hydro)) = (dragged.filter(|_| !together), &hydro) {
        drift.always = true;
        list.push(Box::new(BodyDrag::new(
            law,
            hydro,
            scene.coupling.feedback,
            scene.coupling.heat_share,
        )));
    }
    let kicked = gas || dust || scene.has_surroundings();
    if !system.bodies.is_empty() {
        list.extend(surroundings(scene));
    }
    let jacobi = jacobi(scene, integrator);
    let whole = matches!(integrator, Integrator::GaussRadau | Integrator::Hermite);
    if bodies && !framed && jacobi.is_none() && (!whole || kicked) {
        list.push(Box::new(KickBodies {
            step,
            mutual: mutual(scene),
        }));
    }
    let reaction = |fluid: Mass, softening: Softening| Reaction {
        pulled: scene.gravity.pulls.has(Mass::Star, fluid),
        on: [
            scene.gravity.pulls.has(fluid, Mass::Star),
            scene.gravity.pulls.has(fluid, Mass::Planets),
        ],
        softening,
    };
    let pacing = Steps {
        longest,
        orbit: scene.accuracy.orbit_step,
    };
    if dust {
        let parts = Parts {
            force: scene.accuracy.acceleration_step,
            courant: hydro
                .as_ref()
                .map_or(f64::INFINITY, |hydro| DUST_STEP * hydro.courant),
        };
        let reaction = reaction(Mass::Dust, plan.dust);
        let mut kick = KickDust::new(pacing, parts, reaction);
        kick.pulled = plan.tree.is_some() || bodies || framed;
        list.push(Box::new(kick));
        list.extend(stirring(scene, hydro.as_ref().filter(|_| gas)));
    }
    if let Some(hydro) = hydro.filter(|_| gas) {
        list.push(Box::new(KickGas {
            hydro,
            reaction: reaction(Mass::Gas, plan.gas),
            pacing,
        }));
        let rim = scene.gas.as_ref().and_then(|g| populate::rim(scene, g));
        if let Some(rim) = rim {
            list.push(Box::new(rim));
        }
        list.push(Box::new(drift));
    }
    if dust {
        list.push(Box::new(DriftDust));
    }
    if bodies {
        list.push(match (integrator, jacobi, &plan.mutual) {
            (_, Some(scheme), _) => Box::new(DriftBodies::new(JacobiMap { scheme, step })),
            (_, _, Mutual::Changeover(meetings)) => {
                Box::new(DriftBodies::new(Encounters(meetings.clone())))
            }
            (Integrator::Epicycles, ..) => Box::new(DriftBodies::new(epicycles(scene, step))),
            (Integrator::Leapfrog, ..) => Box::new(DriftBodies::new(Straight)),
            (Integrator::Hermite, ..) => Box::new(DriftBodies::new(Blocks::new(kicked, step))),
            (Integrator::GaussRadau, ..) => Box::new(DriftBodies::new(Radau { kicked, step })),
            _ => Box::new(DriftBodies::new(Kepler)),
        });
    }
    if scene.star.is_some_and(|star| star.accretion_radius > 0.0) && bodies {
        list.push(Box::new(Accretion::default()));
    }
    let law = scene.planetesimals.as_ref().and_then(populate::collisions);
    if let Some(law) = law.filter(|_| system.bodies.len() > 1) {
        let found = integrator == Integrator::Hybrid;
        list.push(Box::new(Collisions::new(law, self_gravity(scene), found)));
    }
    list
}

/// The drag on dust of gas that is a formula.
fn dust_in_disk(scene: &Scene) -> Option<Box<dyn Operator>> {
    let (dust, disk) = (scene.dust.as_ref()?, scene.surroundings.disk.as_ref()?);
    if !scene.coupling.gas_dust {
        return None;
    }
    let pulls = &scene.gravity.pulls;
    let movers = [Mass::Planets, Mass::Planetesimals];
    let ties = Ties {
        star_pulls: pulls.has(Mass::Star, Mass::Dust),
        star_moves: movers.iter().any(|&mass| pulls.has(mass, Mass::Star)),
    };
    let law = populate::dust_law(scene, dust);
    Some(Box::new(DustInDisk::new(gas_disk(disk), law, ties)))
}

/// What stirs the dust, with `hydro` in gas of particles.
fn stirring(scene: &Scene, hydro: Option<&gas::Hydro>) -> Option<Box<dyn Operator>> {
    let dust = scene.dust.as_ref()?;
    let strength = match dust.turbulence {
        Turbulence::None => return None,
        Turbulence::Given(alpha) => Strength::Given(alpha),
        Turbulence::Measured { floor } => Strength::Measured { floor },
    };
    let medium = match &scene.surroundings.disk {
        Some(disk) => Medium::Disk(gas_disk(disk)),
        None => Medium::particles(hydro?),
    };
    let law = populate::dust_law(scene, dust);
    Some(Box::new(Stir::new(strength, law, medium, scene.run.seed)))
}

/// What a shearing box takes over from its disk, on gas and dust.
fn local_forces(scene: &Scene) -> Option<Box<dyn Operator>> {
    let (hill, local) = (scene.domain.hill()?, scene.local);
    if local == scene::Local::default() {
        return None;
    }
    let [vertical, middle] = oscillation(scene);
    Some(Box::new(Local {
        push: 2.0 * hill.rate * local.headwind,
        square_frequency: vertical * vertical,
        middle,
    }))
}

/// How bodies move in a shearing box.
fn epicycles(scene: &Scene, step: f64) -> Epicycles {
    let [vertical, middle] = oscillation(scene);
    Epicycles {
        step,
        vertical,
        middle,
    }
}

/// Frequency of the oscillation in the vertical gravity of a shearing box, zero without that, and the height that it is about.
pub fn oscillation(scene: &Scene) -> [f64; 2] {
    let hill = scene.domain.hill().filter(|_| scene.local.vertical_gravity);
    let middle = scene.domain.size().map_or(0.0, |size| 0.5 * size.z);
    [hill.map_or(0.0, |hill| hill.rate), middle]
}

/// What acts on bodies by a formula.
fn surroundings(scene: &Scene) -> Vec<Box<dyn Operator>> {
    let mut list: Vec<Box<dyn Operator>> = Vec::new();
    if let Some(speed_of_light) = scene.surroundings.speed_of_light {
        list.push(Box::new(Central::new(Relativity { speed_of_light })));
    }
    if let Some(scene::Oblateness {
        j2,
        equatorial_radius,
        pole,
    }) = scene.surroundings.oblateness
    {
        list.push(Box::new(Central::new(Oblateness {
            j2,
            equatorial_radius,
            pole,
        })));
    }
    // Planets are the first bodies, with ids from 1 on.
    let times = (1..).zip(&scene.planets);
    let mut times = times
        .filter_map(|(id, planet)| Some((id, planet.migration_time?)))
        .peekable();
    if times.peek().is_some() {
        list.push(Box::new(External::new(Migration::new(times))));
    }
    if let Some(given) = &scene.surroundings.disk {
        let disk = gas_disk(given);
        if given.migration {
            list.push(Box::new(External::new(TypeOne { disk })));
        }
        if given.drag != scene::BodyDrag::None {
            let law = populate::disk_law(scene, given);
            list.push(Box::new(External::new(DiskDrag { disk, law })));
        }
    }
    list
}

/// The analytic disk of a scene.
pub fn gas_disk(disk: &scene::GasDisk) -> GasDisk {
    GasDisk {
        surface_density: disk.surface_density,
        slope: disk.slope,
        reference_radius: disk.reference_radius,
        aspect_ratio: disk.aspect_ratio,
        flaring: disk.flaring,
        inner_radius: disk.inner_radius,
        outer_radius: disk.outer_radius,
        rotation: disk.headwind.map_or(Rotation::Pressure, Rotation::Headwind),
    }
}

/// Whether gas, dust, planetesimals and planets pull each other both ways or not at all, each with all of the forces in kicks.
fn mutual(scene: &Scene) -> bool {
    let pulls = &scene.gravity.pulls.0;
    let fluids = [
        Mass::Gas,
        Mass::Dust,
        Mass::Planetesimals,
        Mass::Planets,
        Mass::Star,
    ]
    .map(|m| m as usize);
    fluids
        .iter()
        .all(|&a| fluids.iter().all(|&b| pulls[a][b] == pulls[b][a]))
}

/// Whether planetesimals pull each other.
fn self_gravity(scene: &Scene) -> bool {
    let pulls = &scene.gravity.pulls;
    scene.gravity.method != scene::GravityMethod::None
        && pulls.has(Mass::Planetesimals, Mass::Planetesimals)
}

/// How far the hybrid map's cut-offs reach.
fn cutoff(scene: &Scene) -> Cutoff {
    let default = Cutoff::default();
    let given = scene.planetesimals.as_ref();
    Cutoff {
        hill: given.map_or(default.hill, |p| p.cutoff),
        ..default
    }
}

/// The hybrid map of a scene for steps of `step`.
fn hybrid(scene: &Scene, step: f64) -> Hybrid {
    let given = scene.planetesimals.as_ref();
    let touching = given.is_some_and(|p| p.collisions != scene::Collisions::None);
    Hybrid::new(cutoff(scene), step, touching)
}

/// Who pulls whom, how softly and how exactly; `step` is that of the bodies.
fn plan(scene: &Scene, integrator: Integrator, step: f64) -> Plan {
    let accuracy = match scene.gravity.opening {
        scene::Opening::ForceError(error) => solver::Accuracy::ForceError(error),
        scene::Opening::Angle(angle) => solver::Accuracy::OpeningAngle(angle),
    };
    let method = match scene.gravity.method {
        scene::GravityMethod::Direct => Some(solver::Method::Direct),
        scene::GravityMethod::Tree => Some(solver::Method::Automatic),
        scene::GravityMethod::None => None,
    };
    let length = |softening: Option<scene::Softening>| {
        softening.map_or(Softening::Length(0.0), self::softening)
    };
    let mutual = match integrator {
        Integrator::GaussRadau | Integrator::Hermite => Mutual::Drift,
        Integrator::Hybrid => Mutual::Changeover(Meetings::new(hybrid(scene, step))),
        _ if jacobi(scene, integrator).is_some() => Mutual::Drift,
        _ => Mutual::Kick,
    };
    Plan {
        tree: method.map(|method| solver::Settings {
            accuracy,
            method,
            constant: scene.gravity.constant,
        }),
        pulls: scene.gravity.pulls.0,
        gas: length(scene.gas.as_ref().map(|g| g.softening)),
        dust: length(scene.dust.as_ref().map(|d| d.softening)),
        star_in_kick: integrator == Integrator::Leapfrog,
        mutual,
        held_back: scene.run.write_accelerations,
        field_steps: scene.gravity.separate_steps,
    }
}
