//! Individual time steps: what they save in a gas disk whose orbital times span a factor of 1000, at equal error.
//!
//! The same disk is run over one base step with individual steps, with one step for all as short as the shortest of those, and with
//! individual steps a quarter as long, from which errors are counted. Where the disk is chaotic, near its inner edge, steps of 0.3 differ
//! from those of a quarter nearly as much as whole ones do; that difference is told too.

use std::collections::HashMap;

use coupling::System;
use nbody::points::{Columns, Vec3};

use super::{Bar, Row};
use crate::trial::Trial;

const PARTICLES: usize = 20_000;
/// Part of the scene that the error is compared in.
const RINGS: usize = 12;
const INNER: f64 = 0.1;
const OUTER: f64 = 10.0;
const ASPECT: f64 = 0.05;

const SCENE: &str = include_str!("../../../tests/benches/inner-outer-disk.toml");

/// A run that has ended.
struct Run {
    system: System,
    cpu_s: f64,
    /// Particles that were active, added up over all ticks, and ticks.
    updates: u64,
    ticks: u64,
}

/// Runs the disk with `overrides` to its end.
fn run(overrides: &[String]) -> Result<Run, String> {
    let mut all = vec![
        format!("gas.particles={PARTICLES}"),
        "run.end_time=\"0.13 yr\"".to_owned(),
    ];
    all.extend_from_slice(overrides);
    let mut trial = Trial::new(SCENE, &all, |_| {})?;
    let stops = [0.0, trial.scene.run.end_time];
    trial
        .run(&stops, |_| {})
        .map_err(|fault| fault.to_string())?;
    let density = trial.watch.laps[coupling::Phase::Density as usize];
    Ok(Run {
        cpu_s: trial.cpu_s(),
        updates: density.targets,
        ticks: density.calls,
        system: trial.system,
    })
}

/// Mass inside of each ring's outer edge, and mass and momenta (radial, along the orbit) of each ring.
struct Profile {
    inside: [f64; RINGS],
    mass: [f64; RINGS],
    number: [usize; RINGS],
    radial: [f64; RINGS],
    orbital: [f64; RINGS],
}

fn radius(ring: f64) -> f64 {
    INNER * (OUTER / INNER).powf(ring / RINGS as f64)
}

fn profile(system: &System) -> Profile {
    let mut profile = Profile {
        inside: [0.0; RINGS],
        mass: [0.0; RINGS],
        number: [0; RINGS],
        radial: [0.0; RINGS],
        orbital: [0.0; RINGS],
    };
    let gas = &system.gas.particles;
    for i in 0..gas.len() {
        let (x, v) = (gas.x[i] - system.star.x[0], gas.v[i] - system.star.v[0]);
        let r = x.xy().norm();
        let out = Vec3::new(x.x, x.y, 0.0) / r;
        for ring in 0..RINGS {
            if r < radius(ring as f64 + 1.0) {
                profile.inside[ring] += gas.m[i];
                if r >= radius(ring as f64) {
                    profile.number[ring] += 1;
                    profile.mass[ring] += gas.m[i];
                    profile.radial[ring] += gas.m[i] * v.dot(&out);
                    profile.orbital[ring] += gas.m[i] * Vec3::z().cross(&out).dot(&v);
                }
            }
        }
    }
    profile
}

/// Rms differences over the rings: of masses, and of mean velocities.
fn difference(a: &System, b: &System) -> [f64; 2] {
    let (a, b) = (profile(a), profile(b));
    let (mut sum, mut rings) = ([0.0; 2], 0.0);
    for k in (0..RINGS).filter(|&k| b.number[k] >= 50) {
        let sound = ASPECT / radius(k as f64 + 0.5).sqrt();
        let velocity = |of: fn(&Profile) -> &[f64; RINGS]| {
            (of(&a)[k] / a.mass[k] - of(&b)[k] / b.mass[k]) / sound
        };
        let mass = (a.inside[k] - b.inside[k]) / b.mass[k];
        sum[0] += mass * mass;
        sum[1] += velocity(|p| &p.radial).powi(2) + velocity(|p| &p.orbital).powi(2);
        rings += 1.0;
    }
    sum.map(|sum| (sum / rings).sqrt())
}

/// Rms differences of particles that both have: of positions, relative to the thickness of the disk, over all; of velocities, relative to
/// the sound speed, in the ring where they are largest.
fn scatter(a: &System, b: &System) -> [f64; 2] {
    let known: HashMap<u64, usize> = (b.gas.particles.id.iter().copied().zip(0..)).collect();
    let (mut place, mut count) = (0.0, 0.0);
    let mut rings = [[0.0; 2]; RINGS];
    for i in 0..a.gas.len() {
        let Some(&k) = known.get(&a.gas.particles.id[i]) else {
            continue;
        };
        let (p, q) = (&a.gas.particles, &b.gas.particles);
        let r = (q.x[k] - b.star.x[0]).xy().norm();
        place += ((p.x[i] - q.x[k]).norm() / (ASPECT * r)).powi(2);
        count += 1.0;
        let ring = (r / INNER).ln() / (OUTER / INNER).ln() * RINGS as f64;
        if ring >= 0.0 && ring < RINGS as f64 {
            let ring = &mut rings[ring as usize];
            ring[0] += (p.v[i] - q.v[k]).norm_squared() * r / (ASPECT * ASPECT);
            ring[1] += 1.0;
        }
    }
    let ring = |[sum, n]: [f64; 2]| if n >= 50.0 { (sum / n).sqrt() } else { 0.0 };
    let most = rings.into_iter().map(ring).fold(0.0, f64::max);
    [(place / count).sqrt(), most]
}

/// What is compared, or the refusal of what should have run.
pub fn rows() -> Vec<Row> {
    measured().unwrap_or_else(|refusal| {
        vec![Row {
            what: refusal,
            measured: f64::NAN,
            uncertainty: 0.0,
            bar: Bar::Limit([0.0, 0.0]),
        }]
    })
}

/// Individual steps by this part of those that the settings ask for by themselves.
fn refined(part: f64) -> Result<Run, String> {
    run(&[
        format!("accuracy.orbit_step={}", 0.1 * part),
        format!("accuracy.acceleration_step={}", 0.25 * part),
        format!("gas.hydro.courant={}", 0.25 * part),
    ])
}

fn measured() -> Result<Vec<Row>, String> {
    let individual = run(&[])?;
    let step = individual.system.clock.end / individual.ticks as f64;
    let global = run(&[format!("run.time_step={step}")])?;
    let (fine, finer) = (refined(0.3)?, refined(0.25)?);
    let errors = |run: &Run| {
        let ([masses, velocities], [places, speeds]) = (
            difference(&run.system, &finer.system),
            scatter(&run.system, &finer.system),
        );
        [places, speeds, masses, velocities]
    };
    let (own, common, floor) = (errors(&individual), errors(&global), errors(&fine));
    let row = |what: String, measured: f64, bar: Bar| Row {
        what,
        measured,
        uncertainty: 0.0,
        bar,
    };
    let told = |what: &str, measured: f64| row(what.to_owned(), measured, Bar::None);
    let saved = global.updates as f64 / individual.updates as f64;
    let mut rows = vec![
        told(
            "updates with one step for all, by those of individual steps",
            saved,
        ),
        told("CPU time, one step for all (s)", global.cpu_s),
        told("CPU time, individual steps (s)", individual.cpu_s),
        row(
            "CPU time of individual steps by that of one step".to_owned(),
            individual.cpu_s / global.cpu_s,
            Bar::Limit([0.0625, 0.125]),
        ),
    ];
    let names = [
        "positions of particles, by H",
        "velocities of particles in the worst ring, by c",
        "masses of rings",
        "mean velocities of rings, by c",
    ];
    for (k, what) in names.into_iter().enumerate() {
        // Particles part by disorder soon, rings do not: these are judged.
        let bar = if k < 2 {
            Bar::None
        } else {
            Bar::Limit([1.1, 1.5])
        };
        rows.push(told(
            &format!("error of {what}: one step for all"),
            common[k],
        ));
        rows.push(told(&format!("error of {what}: individual steps"), own[k]));
        rows.push(told(
            &format!("error of {what}: nearly the reference"),
            floor[k],
        ));
        rows.push(row(
            format!("error of {what}: individual by one step"),
            own[k] / common[k],
            bar,
        ));
    }
    Ok(rows)
}
