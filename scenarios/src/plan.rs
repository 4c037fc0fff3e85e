//! A plan: what a run takes before it is run, and what it can be trusted with.
//!
//! The scene is really started and advanced for a moment. One that is too large for that is thinned out first; its cost then follows from
//! N and from steps ~ N^(-1/d) where the Courant condition sets them. Memory is what was measured of whole programs by that of the
//! particles' columns.

mod expected;
mod resolution;
pub mod seed;

use std::fmt::Write;
use std::path::Path;

use coupling::System;
use nbody::points::{ColumnRef, Columns, Dimension, Keep};

use crate::cost::{self, Cost, Sampled};
use crate::document;
use crate::outline;
use crate::run::{REPORTS, RunError};
use crate::scene::{Scene, Snapshots};
use crate::thin::thinned;

/// Particles up to which a scene is started as it is.
const MOST: f64 = 200_000.0;
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
        let (cost, system) = (scaled(sampled.cost, &scene, part), &sampled.system);
        let held = sets(system).map(|sets| sets.iter().map(|set| set.bytes()).sum::<usize>());
        let memory = PROGRAM + working(&scene, system, held) / part;
        let state = held.iter().sum::<usize>() as f64 / part;
        let disk = disk(
            &scene,
            snapshot_bytes(&scene, system) / part,
            state,
            sampled.operators.len(),
        );
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

/// The cost of a scene of which a part of the particles was sampled.
fn scaled(cost: Cost, scene: &Scene, part: f64) -> Cost {
    if part >= 1.0 {
        return cost;
    }
    // A tree's depth grows with the logarithm of the number; steps of gas shrink with the spacing.
    let number = generated(scene);
    let depth = number.ln() / (number * part).ln();
    let steps = match scene.gas {
        Some(_) => part.powf(-1.0 / scene.domain.dimensions() as f64),
        None => 1.0,
    };
    Cost {
        rate: cost.rate / part * depth * steps,
        start_s: cost.start_s / part,
        report_s: cost.report_s / part,
        updates: cost.updates.map(|updates| updates / part * steps),
        ticks: cost.ticks * steps,
        ..cost
    }
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

/// Bytes of a snapshot.
fn snapshot_bytes(scene: &Scene, system: &System) -> f64 {
    let shown = |set: &&dyn Columns| -> usize {
        let list = set.list();
        let columns = list
            .iter()
            .filter(|(label, _)| matches!(label.keep, Keep::Snapshot));
        columns.map(|(_, column)| bytes(column)).sum()
    };
    let columns: usize = sets(system).iter().flatten().map(shown).sum();
    // Beside the columns: temperatures, numbers of a swarm, densities; accelerations and potentials if wanted.
    let number = system.gas.len() + system.dust.len() + system.bodies.len();
    let more = if scene.run.write_accelerations { 64 } else { 8 };
    (columns + number * more) as f64
}

fn bytes(column: &ColumnRef) -> usize {
    match column {
        ColumnRef::Real(v) => size_of_val(*v),
        ColumnRef::Vector(v) => size_of_val(*v),
        ColumnRef::Integer(v) => size_of_val(*v),
        ColumnRef::Short(v) => size_of_val(*v),
    }
}

/// Snapshots that the run writes.
fn snapshots(scene: &Scene) -> f64 {
    match &scene.run.snapshots {
        Snapshots::None => 0.0,
        Snapshots::Every(interval) => (scene.run.end_time / interval - 1e-9).ceil() + 1.0,
        Snapshots::At(times) => {
            let inside = |t: &&f64| **t > 0.0 && **t < scene.run.end_time;
            times.iter().filter(inside).count() as f64 + 2.0
        }
    }
}

/// Bytes that a run writes: snapshots of `each`, a checkpoint of `state`, and the layout and tables around them; a line of a table for the sums, and
/// about one and a half for each operator.
fn disk(scene: &Scene, each: f64, state: f64, operators: usize) -> f64 {
    const LAYOUT: f64 = 3.2e4;
    const LINE: f64 = 200.0;
    let report = (2.0 + 1.5 * operators as f64) * LINE;
    snapshots(scene) * (each + LAYOUT) + state + 2.0 * LAYOUT + REPORTS * report
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
