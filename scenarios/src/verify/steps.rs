//! Individual time steps: what they save in a gas disk whose orbital times span a factor of 1000, at equal error.
//!
//! The same disk is run over one base step with individual steps, with half of these, with one step for all as short as the shortest of the first, and
//! with individual steps a quarter as long, from which errors are counted. Where the disk is chaotic, near its inner edge, steps of 0.3 differ
//! from those of a quarter nearly as much as whole ones do; that difference is told too. So one realisation says little: errors are the
//! roots of mean squares over disks of several seeds, and the standard error of their ratio is that of leaving out each in turn.

use std::collections::HashMap;

use coupling::System;
use nbody::points::{Columns, Vec3};

use super::{Bar, Row};
use crate::trial::Trial;

const PARTICLES: usize = 20_000;
const SEEDS: u64 = 6;
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

/// Runs the disk of a seed with `overrides` to its end.
fn run(seed: u64, overrides: &[String]) -> Result<Run, String> {
    let mut all = vec![
        format!("gas.particles={PARTICLES}"),
        format!("run.seed={seed}"),
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
fn refined(seed: u64, part: f64) -> Result<Run, String> {
    let overrides = [
        format!("accuracy.orbit_step={}", 0.1 * part),
        format!("accuracy.acceleration_step={}", 0.25 * part),
        format!("gas.hydro.courant={}", 0.25 * part),
    ];
    run(seed, &overrides)
}

/// What errors are counted of, and whether they are judged: particles part by disorder soon, rings do not.
const ERRORS: [(&str, bool); 4] = [
    ("positions of particles, by H", false),
    ("velocities of particles in the worst ring, by c", false),
    ("masses of rings", true),
    ("mean velocities of rings, by c", true),
];

/// The squares of [`ERRORS`].
type Squares = [f64; ERRORS.len()];

fn squares(run: &Run, reference: &Run) -> Squares {
    let [masses, velocities] = difference(&run.system, &reference.system);
    let [places, speeds] = scatter(&run.system, &reference.system);
    [places, speeds, masses, velocities].map(|error| error * error)
}

/// The runs of a disk: of individual steps as the settings ask for and of half of those, of one step for all, and of steps near the reference's.
const RUNS: [&str; 4] = [
    "individual steps",
    "half of individual steps",
    "one step for all",
    "nearly the reference",
];
const COMMON: usize = 2;

/// What the disk of one seed gives, by run.
struct Sample {
    squares: [Squares; RUNS.len()],
    updates: [f64; RUNS.len()],
    cpu_s: [f64; RUNS.len()],
}

fn sample(seed: u64) -> Result<Sample, String> {
    let individual = run(seed, &[])?;
    let step = individual.system.clock.end / individual.ticks as f64;
    let global = run(seed, &[format!("run.time_step={step}")])?;
    let runs = [individual, refined(seed, 0.5)?, global, refined(seed, 0.3)?];
    let finer = refined(seed, 0.25)?;
    Ok(Sample {
        squares: runs.each_ref().map(|run| squares(run, &finer)),
        updates: runs.each_ref().map(|run| run.updates as f64),
        cpu_s: runs.each_ref().map(|run| run.cpu_s),
    })
}

/// Sum over the samples.
fn sum(samples: &[Sample], part: impl Fn(&Sample) -> f64) -> f64 {
    samples.iter().map(part).sum()
}

/// The ratio of two sums over the samples, or its root, as `form` says; and its standard error by leaving out one sample in turn.
fn ratio(
    samples: &[Sample],
    [above, below]: [&dyn Fn(&Sample) -> f64; 2],
    form: fn(f64) -> f64,
) -> (f64, f64) {
    let n = samples.len() as f64;
    let (over, under) = (sum(samples, above), sum(samples, below));
    let whole = form(over / under);
    let without = |one: &Sample| form((over - above(one)) / (under - below(one)));
    let mean = sum(samples, without) / n;
    let square = sum(samples, |one| (without(one) - mean).powi(2));
    (whole, (square * (n - 1.0) / n).sqrt())
}

fn measured() -> Result<Vec<Row>, String> {
    let samples: Vec<Sample> = (1..=SEEDS).map(sample).collect::<Result<_, _>>()?;
    let row = |what: String, (measured, uncertainty): (f64, f64), bar: Bar| Row {
        what,
        measured,
        uncertainty,
        bar,
    };
    let mut rows = Vec::new();
    for (k, name) in RUNS.into_iter().enumerate() {
        let cost = ratio(&samples, [&|s| s.cpu_s[k], &|_| 1.0], |x| x);
        rows.push(row(format!("CPU time (s): {name}"), cost, Bar::None));
    }
    for (k, (what, _)) in ERRORS.into_iter().enumerate() {
        for (kind, name) in RUNS.into_iter().enumerate() {
            let rms = ratio(&samples, [&|s| s.squares[kind][k], &|_| 1.0], f64::sqrt);
            rows.push(row(format!("error of {what}: {name}"), rms, Bar::None));
        }
    }
    // Errors of half of the steps are those of one step for all: there the cost is judged.
    for (kind, at_equal_error) in [(0, false), (1, true)] {
        let name = RUNS[kind];
        let bar = |bar: [f64; 2], judged: bool| {
            if judged && at_equal_error {
                Bar::Limit(bar)
            } else {
                Bar::None
            }
        };
        let saved = ratio(
            &samples,
            [&|s| s.updates[COMMON], &|s| s.updates[kind]],
            |x| x,
        );
        let cost = ratio(&samples, [&|s| s.cpu_s[kind], &|s| s.cpu_s[COMMON]], |x| x);
        rows.push(row(
            format!("updates with one step for all, by those of {name}"),
            saved,
            Bar::None,
        ));
        rows.push(row(
            format!("CPU time of {name} by that of one step for all"),
            cost,
            bar([0.0625, 0.125], true),
        ));
        for (k, (what, judged)) in ERRORS.into_iter().enumerate() {
            let quotient = ratio(
                &samples,
                [&|s| s.squares[kind][k], &|s| s.squares[COMMON][k]],
                f64::sqrt,
            );
            rows.push(row(
                format!("error of {what}: {name} by one step for all"),
                quotient,
                bar([1.1, 1.5], judged),
            ));
        }
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ratio_of_means_has_the_standard_error_of_its_parts() {
        let sample = |square: f64| Sample {
            squares: [[square; 4], [2.0; 4], [1.0; 4], [1.0; 4]],
            updates: [1.0; 4],
            cpu_s: [1.0; 4],
        };
        let samples = [1.0, 4.0, 2.0, 5.0].map(sample);
        let parts: [&dyn Fn(&Sample) -> f64; 2] = [&|s| s.squares[0][0], &|s| s.squares[1][0]];
        let (mean, error) = ratio(&samples, parts, |x| x);
        // Mean 3 by 2; of a mean, leaving one out gives the standard error: sqrt(10 / 3 / 4) by 2.
        assert!((mean - 1.5).abs() < 1e-14);
        assert!((error - 0.5 * (10.0f64 / 12.0).sqrt()).abs() < 1e-14);
        let (root, error_of_root) = ratio(&samples, parts, f64::sqrt);
        assert!((root - 1.5f64.sqrt()).abs() < 1e-14);
        // To first order the error of a root is that of its square by twice the root; with four samples to a few per cent.
        assert!((error_of_root * 2.0 * root / error - 1.0).abs() < 0.05);
    }
}
