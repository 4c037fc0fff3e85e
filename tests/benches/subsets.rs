//! Scenes of every subset of populations with processes to choose, and a population that its own crate steps without a scene.

use std::path::Path;

use coupling::System;
use dust::motion::Parts;
use nbody::gravity::{Accuracy, Method, Settings};
use nbody::integrators::hybrid::{Hybrid, Map, cutoff::Cutoff, soft::Soft};
use nbody::points::clock::{Centre, Pacing, TICKS};
use nbody::points::{Clock, Domain};
use tridisk::populate;
use tridisk::scene::Scene;
use tridisk::trial::Trial;

/// The length of a step.
const STEP: f64 = 0.01;

/// What each population's scene says of it.
const POPULATIONS: [(&str, &str); 3] = [
    (
        "gas",
        r#"
[[gas.block]]
lo = [0.7, -0.3, -0.3]
hi = [1.3, 0.3, 0.3]
lattice = "cubic"
spacing = 0.05
density = 1e-4
pressure = 1e-7
"#,
    ),
    (
        "dust",
        r#"
[dust]
size = "1 cm"
[[dust.block]]
lo = [0.7, -0.3, -0.3]
hi = [1.3, 0.3, 0.3]
lattice = "random"
spacing = 0.05
density = 1e-6
velocity = [0.0, 0.1, 0.0]
"#,
    ),
    (
        "bodies",
        r#"
[star]
mass = "1 Msun"
[planetesimals]
number = 1728
total_mass = "10 Mearth"
inner_radius = "0.8 au"
outer_radius = "1.2 au"
eccentricity = 0.01
inclination = 0.005
density = "2 g/cm^3"
"#,
    ),
];

/// A process: what a scene sets for it, which of gas, dust and bodies it needs, and the operators that it adds where these are.
pub struct Process {
    pub name: &'static str,
    pub set: &'static [&'static str],
    needs: [bool; 3],
    pub operators: &'static [&'static str],
}

/// All processes that bring operators of their own.
pub const PROCESSES: &[Process] = &[
    Process {
        name: "drag of dust",
        set: &["coupling.drag=[\"gas-dust\"]"],
        needs: [true, true, false],
        operators: &["drag dust"],
    },
    Process {
        name: "drag of bodies",
        set: &["coupling.drag=[\"gas-planetesimals\"]"],
        needs: [true, false, true],
        operators: &["drag bodies"],
    },
    Process {
        name: "growth with drag",
        set: &[
            "coupling.drag=[\"gas-dust\"]",
            "dust.growth.alpha=1e-3",
            "dust.growth.fragmentation_speed=\"1 m/s\"",
        ],
        needs: [true, true, true],
        operators: &["growth", "drag dust"],
    },
    Process {
        name: "turbulence with drag",
        set: &["coupling.drag=[\"gas-dust\"]", "dust.turbulence.alpha=1e-3"],
        needs: [true, true, true],
        operators: &["stir dust", "drag dust"],
    },
    Process {
        name: "sublimation",
        set: &["dust.composition={ ice = 0.5, silicate = 0.5 }"],
        needs: [true, true, false],
        operators: &["sublimation"],
    },
    Process {
        name: "cooling",
        set: &["gas.cooling.kind=\"beta\"", "gas.cooling.beta=10"],
        needs: [true, false, true],
        operators: &["cooling"],
    },
    Process {
        name: "rearrangement",
        set: &["gas.rearrange.strength=1"],
        needs: [true, false, false],
        operators: &["rearrangement"],
    },
    Process {
        name: "accretion",
        set: &["star.accretion_radius=0.1"],
        needs: [false, false, true],
        operators: &["accretion"],
    },
    Process {
        name: "collisions",
        set: &["planetesimals.collisions.outcome=\"merge\""],
        needs: [false, false, true],
        operators: &["collisions"],
    },
];

impl Process {
    /// Whether the populations that it needs are there.
    pub fn suits(&self, subset: [bool; 3]) -> bool {
        (self.needs.iter().zip(subset)).all(|(&needed, present)| present || !needed)
    }
}

/// The seven subsets of gas, dust and bodies.
pub fn all() -> impl Iterator<Item = [bool; 3]> {
    (1..8u8).map(|bits| [1, 2, 4].map(|bit| bits & bit != 0))
}

/// The populations of a subset by name.
pub fn name(subset: [bool; 3]) -> String {
    let present = POPULATIONS.iter().zip(subset).filter(|(_, is)| *is);
    let names: Vec<&str> = present.map(|((name, _), _)| *name).collect();
    names.join("+")
}

/// Self-gravity, with the hybrid map of bodies where there are some; without it they pull nobody.
pub fn gravity(subset: [bool; 3], on: bool) -> Vec<&'static str> {
    let (method, integrator) = match on {
        true => (
            "gravity.method=\"tree\"",
            "planetesimals.integrator=\"hybrid\"",
        ),
        false => (
            "gravity.method=\"none\"",
            "planetesimals.integrator=\"leapfrog\"",
        ),
    };
    let bodies = subset[2].then_some(integrator);
    std::iter::once(method).chain(bodies).collect()
}

/// The text of a subset's scene for so many steps, without drag.
fn text(subset: [bool; 3], steps: usize) -> String {
    let present = POPULATIONS.iter().zip(subset).filter(|(_, is)| *is);
    let tables: String = present.map(|((_, table), _)| *table).collect();
    let end = steps as f64 * STEP;
    format!(
        "title = \"a subset\"\n[run]\nend_time = {end}\ntime_step = {STEP}\n[coupling]\ndrag = []\n{tables}"
    )
}

fn owned(set: &[&str]) -> Vec<String> {
    set.iter().map(|&key| key.to_owned()).collect()
}

/// The scene of a subset, with what `set` asks for.
pub fn scene(subset: [bool; 3], set: &[&str], steps: usize) -> Scene {
    let scene = Scene::parse(&text(subset, steps), "subset", Path::new("."), &owned(set));
    scene.unwrap_or_else(|problems| panic!("{} {set:?}: {problems:?}", name(subset)))
}

/// The same in place.
pub fn trial(subset: [bool; 3], set: &[&str], steps: usize) -> Trial {
    let trial = Trial::new(&text(subset, steps), &owned(set), |_| ());
    trial.unwrap_or_else(|refusal| panic!("{} {set:?}: {refusal}", name(subset)))
}

/// Takes `steps` of a scene.
pub fn run(trial: &mut Trial, steps: usize) {
    let done = trial.run(&[0.0, steps as f64 * STEP], |_| ());
    done.unwrap_or_else(|fault| panic!("{fault}"));
}

/// Takes `steps` of the only population of a scene by what its own crate offers; bodies leave the map that moved them.
pub fn alone(scene: &Scene, system: &mut System, steps: usize) -> Option<Map> {
    let end = steps as f64 * STEP;
    if let Some(gas) = &scene.gas {
        let hydro = populate::hydro(scene, gas);
        let done = gas::alone::advance(&mut system.gas, &hydro, 0.0, end, STEP);
        done.unwrap_or_else(|fault| panic!("{fault}"));
    } else if scene.dust.is_some() {
        dust_alone(&mut system.dust, end);
    } else {
        return Some(bodies_alone(scene, system, steps));
    }
    None
}

/// Dust that flies freely.
fn dust_alone(dust: &mut dust::Dust, end: f64) {
    let (domain, centre) = (Domain::open(), Centre::default());
    let parts = Parts {
        force: 0.25,
        courant: f64::INFINITY,
    };
    let mut now = Clock::standing(0.0);
    loop {
        dust.refit(&domain, &now);
        let last = now.synchronous() && now.end >= end;
        let until = if last { end + 1.0 } else { end };
        let next = match now.synchronous() {
            true => now.next_base(until, STEP),
            false => now,
        };
        let chosen = dust.steps(&Pacing::free(STEP), parts, &now, &next);
        chosen.unwrap_or_else(|fault| panic!("{fault}"));
        dust.close(&now, &centre, &domain);
        if last {
            return;
        }
        dust.open(&now, &next, &centre, &domain);
        let ends = dust.particles.end.iter().copied();
        let tick = ends.min().unwrap_or(TICKS).min(TICKS);
        dust.drift(f64::from(tick) * next.unit(), &domain);
        now = Clock { tick, ..next };
    }
}

/// Bodies by the hybrid map.
fn bodies_alone(scene: &Scene, system: &mut System, steps: usize) -> Map {
    let tridisk::scene::Opening::ForceError(error) = scene.gravity.opening else {
        panic!("a force error");
    };
    let mut map = Map {
        hybrid: Hybrid::new(Cutoff::default(), STEP, false),
        soft: Soft::new(Settings {
            accuracy: Accuracy::ForceError(error),
            method: Method::Automatic,
            constant: system.g,
        }),
        g: system.g,
        dt: STEP,
    };
    map.prepare(&system.star, &mut system.bodies);
    for _ in 0..steps {
        let moved = map.step(&mut system.star, &mut system.bodies);
        moved.unwrap_or_else(|stuck| panic!("{}", stuck.reason));
    }
    map
}

/// What a word of the command line names: `gas+dust`, `gas alone`, `gas+dust+bodies drag of dust`; whether it names anything.
pub fn named(words: &str, steps: usize) -> bool {
    let (populations, more) = words.split_once(' ').unwrap_or((words, ""));
    let Some(subset) = all().find(|&subset| name(subset) == populations) else {
        return false;
    };
    let process = PROCESSES.iter().find(|process| process.name == more);
    if process.is_none() && !["", "alone", "self-gravity"].contains(&more) {
        return false;
    }
    let bodies_only = subset == [false, false, true];
    let mut set = gravity(subset, more == "self-gravity" || bodies_only);
    set.extend(process.iter().flat_map(|process| process.set));
    let mut trial = trial(subset, &set, steps);
    if more == "alone" {
        alone(&trial.scene, &mut trial.system, steps);
    } else {
        run(&mut trial, steps);
    }
    true
}
