//! A plan: what a run takes before it is run, and what it can be trusted with.
//!
//! The scene is really started and advanced for a moment, and a snapshot of it written. One that is too large for that is thinned out first. Memory is what was measured of whole programs by that of the
//! particles' columns.

mod expected;
mod files;
mod resolution;
mod scaled;
pub mod seed;

use std::fmt::Write;
use std::path::Path;

use coupling::System;
use nbody::points::{Columns, Dimension};

use crate::cost::{self, Cost, Sampled};
use crate::document;
use crate::outline;
use crate::run::RunError;
use crate::scene::Scene;
use crate::thin::thinned;
use files::snapshots;
use scaled::scaled;

/// Particles up to which a scene is started as it is.
const MOST: f64 = 200_000.0;
/// The part of a thinned sample that another one has, to see how the cost grows with the number.
const FEWER: f64 = 0.25;
/// What a program takes by itself, bytes.
const PROGRAM: f64 = 24e6;
/// Bytes that gas, dust and bodies hold with their trees and workspaces, by those of their columns.
const HELD: [f64; 3] = [2.1, 2.0, 1.85];
/// Bytes a gas particle that the tree pulls, and a superparticle with its gas neighbours, hold besides.
const PULLED: f64 = 700.0;
const DRAGGED: f64 = 1750.0;

/// What a run takes.
pub struct Plan {
    pub cost: Cost,
    /// Bytes.
    pub memory: f64,
    pub disk: f64,
    /// The part of the particles that the sample had.
    pub part: f64,
    /// As of `--set`: what made the sample of it.
    pub thin: Vec<String>,
    pub sampled: Sampled,
}

impl Plan {
    /// Of the scene in a file, sampled for some seconds.
    pub fn of(path: &Path, set: &[String], seconds: f64) -> Result<(Scene, Self), RunError> {
        let load = |set: &[String]| {
            Scene::load(path, set).map_err(|refusal| RunError::Refused(refusal.to_string()))
        };
        let scene = load(set)?;
        let all = generated(&scene);
        let (mut part, mut thin, mut small) = (1.0, Vec::new(), scene.clone());
        if all > MOST {
            part = MOST / all;
            let entries = std::fs::read_to_string(path).ok();
            let entries = entries.and_then(|text| document::parse(&text).ok());
            thin = thinned(&scene, &entries.unwrap_or_default(), part);
            small = load(&[set, &thin].concat())?;
            part = generated(&small) / all;
        }
        let sampled = cost::sample(&small, seconds)?;
        let mut cost = sampled.cost;
        if part < 1.0 {
            let fewer = thinned(&small, &Default::default(), FEWER);
            let fewer = load(&[set, &thin, &fewer].concat())?;
            let rate = cost::sample(&fewer, seconds)?.cost.rate;
            let numbers = [&fewer, &small, &scene].map(generated);
            cost = scaled(cost, &scene, numbers, rate);
        }
        let system = &sampled.system;
        cost.files_s = snapshots(&scene) * files::seconds(&small, system) / part;
        let held = sets(system).map(|sets| sets.iter().map(|set| set.bytes()).sum::<usize>());
        let memory = PROGRAM + working(&scene, system, held) / part;
        let state = held.iter().sum::<usize>() as f64 / part;
        let each = files::snapshot_bytes(&scene, system) / part;
        let disk = files::disk(&scene, each, state, &system.ledger);
        let plan = Self {
            cost,
            memory,
            disk,
            part,
            thin,
            sampled,
        };
        Ok((scene, plan))
    }
}

/// Particles that generators make.
fn generated(scene: &Scene) -> f64 {
    let gas = scene.gas.as_ref().map_or(0, |gas| gas.particles);
    let dust = scene.dust.as_ref().map_or(0, |dust| dust.particles);
    let bodies = scene.planetesimals.map_or(0, |p| p.number);
    (gas + dust + bodies) as f64
}

/// Bytes that particles with columns of `held` bytes take at work.
fn working(scene: &Scene, system: &System, held: [usize; 3]) -> f64 {
    let columns: f64 = held
        .iter()
        .zip(HELD)
        .map(|(held, by)| *held as f64 * by)
        .sum();
    let pulled = match scene.gravity.fluids_pull_gas() {
        true => PULLED * system.gas.len() as f64,
        false => 0.0,
    };
    let dragged = match scene.coupling.gas_dust {
        true => DRAGGED * system.dust.len() as f64,
        false => 0.0,
    };
    columns + pulled + dragged
}

/// Columns of gas, of dust, and of bodies.
fn sets(system: &System) -> [Vec<&dyn Columns>; 3] {
    let (gas, dust) = (&system.gas, &system.dust);
    [
        vec![&gas.particles, &gas.derived, &gas.rates],
        vec![&dust.particles, &dust.derived, &dust.rates],
        vec![&system.bodies, &system.star],
    ]
}

/// The plan of a scene's file in words.
pub fn of_scene(path: &Path, set: &[String], seconds: f64) -> Result<String, RunError> {
    let (scene, plan) = Plan::of(path, set, seconds)?;
    let (cost, system) = (&plan.cost, &plan.sampled.system);
    let mut text = format!("{}\n", scene.title);
    let mut line = |words: String| {
        writeln!(text, "{words}").expect("writing to a string does not fail");
    };
    if plan.part < 1.0 {
        line(format!(
            "estimated from {:.2} % of the particles ({})",
            100.0 * plan.part,
            plan.thin.join(", ")
        ));
    }
    steps(cost, &scene, system, plan.part)
        .into_iter()
        .for_each(&mut line);
    line(format!(
        "cost: {} of CPU time, {} on {} threads of this machine now",
        outline::duration(cost.cpu_s()),
        outline::duration(cost.wall_s()),
        rayon::current_num_threads()
    ));
    line(format!("memory: {:.0} MB", plan.memory / 1e6));
    line(format!(
        "disk: {:.1} MB, {} snapshots and a checkpoint",
        plan.disk / 1e6,
        snapshots(&scene)
    ));
    line("resolution:".to_owned());
    let resolution = resolution::sentences(&scene, system);
    resolution
        .iter()
        .for_each(|words| line(format!("  {words}")));
    line("expected error:".to_owned());
    let errors = expected::sentences(&scene, system);
    errors.iter().for_each(|words| line(format!("  {words}")));
    line(format!(
        "not modelled: {}",
        outline::absent(&scene, system).join(", ")
    ));
    Ok(text)
}

/// The same for programs, as JSON.
pub fn numbers(path: &Path, set: &[String], seconds: f64) -> Result<String, RunError> {
    let (scene, plan) = Plan::of(path, set, seconds)?;
    let cost = &plan.cost;
    let [gas, dust, bodies] = cost.updates();
    let all = serde_json::json!({
        "steps": cost.steps,
        "base_step": cost.base_step(),
        "ticks": cost.ticks,
        "updates": {"gas": gas, "dust": dust, "bodies": bodies},
        "cpu_s": cost.cpu_s(),
        "start_cpu_s": cost.start_s,
        "report_cpu_s": cost.report_s,
        "files_cpu_s": cost.files_s,
        "wall_s": cost.wall_s(),
        "threads": rayon::current_num_threads(),
        "memory_bytes": plan.memory,
        "disk_bytes": plan.disk,
        "snapshots": snapshots(&scene),
        "sampled_part": plan.part,
    });
    Ok(format!("{all:#}\n"))
}

/// How many steps of what length, and updates by population.
pub fn steps(cost: &Cost, scene: &Scene, system: &System, part: f64) -> Vec<String> {
    let unit = scene.units.symbol(Dimension::TIME);
    let mut said = vec![format!(
        "steps: {} of at most {:.3e} {unit}, {:.0} ticks each",
        cost.steps,
        cost.base_step(),
        cost.ticks
    )];
    let numbers = [system.gas.len(), system.dust.len(), system.bodies.len()];
    let named = ["gas", "dust", "bodies"]
        .into_iter()
        .zip(numbers)
        .zip(cost.updates());
    let counts = named
        .filter(|((_, number), _)| *number > 0)
        .map(|((name, number), updates)| {
            let all = number as f64 / part;
            format!(
                "{name} {:.0} a particle, {updates:.2e} in all",
                updates / all
            )
        });
    let counts: Vec<String> = counts.collect();
    if !counts.is_empty() {
        said.push(format!("updates: {}", counts.join("; ")));
    }
    said
}

/// The plan of a number of particles over some years.
pub fn of_number(plan: &seed::Particles) -> Result<String, RunError> {
    let speed = updates_per_second()?;
    let threads = rayon::current_num_threads() as f64;
    let years = plan.number * plan.steps() / speed / threads / (365.25 * 86_400.0);
    let lines = [
        format!(
            "particles: {:.3e}, {:.3e} au apart, sound speed {} km/s = {:.4} au/yr",
            plan.number,
            plan.spacing,
            plan.sound_speed,
            plan.speed()
        ),
        format!(
            "sound crosses a spacing in {:.4e} yr = {:.4} days",
            plan.crossing(),
            plan.crossing() * 365.25
        ),
        format!(
            "step: {:.4e} yr = {:.4} days",
            plan.step(),
            plan.step() * 365.25
        ),
        format!("steps: {:.4e} in {:e} yr", plan.steps(), plan.years),
        format!(
            "operations: {:.4e} at {:e} an update",
            plan.total(),
            plan.operations
        ),
        format!(
            "time: {:.4e} yr at 1 Tflops, {:.4} h at 1 Pflops",
            plan.duration(1e12),
            plan.duration(1e15) * 8766.0
        ),
        format!(
            "on this machine now: {years:.3e} yr at {speed:.2e} updates a second on each of {threads} threads, without gravity and drag"
        ),
        format!("memory: {:.3e} bytes of gas", 400.0 * plan.number),
        format!(
            "at the same cost: {:.3e} particles for a tenth of the time, {:.3e} for a hundredth (T N^(4/3) is constant)",
            seed::affordable(plan.number, 1.0, 0.1),
            seed::affordable(plan.number, 1.0, 0.01)
        ),
        format!(
            "with a tenth of the particles: {:.1} runs, Re and the rotations that a disk lasts by {:.3} (N^(1/3))",
            seed::models(0.1),
            seed::reynolds(0.1)
        ),
    ];
    Ok(lines.join("\n") + "\n")
}

/// A box of gas, by which updates are timed.
const BOX: &str = r#"
[run]
end_time = 100.0
[units]
system = "dimensionless"
[domain]
kind = "periodic"
size = [1.0, 1.0, 1.0]
[[gas.block]]
lo = [0.0, 0.0, 0.0]
hi = [1.0, 1.0, 1.0]
spacing = 0.04
density = 1.0
pressure = 1.0
"#;

/// Updates of gas particles a CPU second.
fn updates_per_second() -> Result<f64, RunError> {
    let scene = Scene::parse(BOX, "box", Path::new("."), &[]);
    let scene = scene.map_err(|problems| RunError::Failed(format!("{problems:?}")))?;
    let cost = cost::sample(&scene, 1.0)?.cost;
    Ok(cost.updates[0] / cost.rate)
}
