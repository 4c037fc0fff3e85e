//! Steps of the field apart from those of the forces (FAST): what they save, and what they cost in accuracy, against the length of steps.
//!
//! Evrard's collapse to t = 0.8, and a disk of a tenth of its star's mass through a quarter of an orbit of its middle. Errors: of the energy,
//! and the rms distance of particles from where they are with all steps a quarter as long, by their smoothing length there.

use std::collections::HashMap;

use coupling::{Phase, System};
use gas::Particles;

use super::gas::evrard;
use super::{Bar, Row};
use crate::trial::Trial;

const DISK: &str = r#"
title = "A disk that pulls itself"
[run]
end_time = 35.0
[star]
mass = 1.0
accretion_radius = 5.0
[gas]
particles = 20000
[gas.disk]
mass = 0.1
slope = -1.0
inner_radius = 10.0
outer_radius = 40.0
[gas.eos]
kind = "locally-isothermal"
aspect_ratio = 0.1
reference_radius = 10.0
exponent = 0.25
[gas.viscosity]
kind = "cullen-dehnen"
"#;

/// A scene, the end of its run and what is done to its gas before the start.
struct Case {
    name: &'static str,
    text: String,
    end: f64,
    prepare: fn(&mut Particles),
    /// Whether its energy is conserved: not where the gas is bound to a temperature.
    closed: bool,
}

/// What a run came to.
struct Outcome {
    energy: f64,
    cpu_s: f64,
    /// Fields and forces that were found, in the number of particles.
    fields: f64,
    forces: f64,
    system: System,
}

fn run(case: &Case, part: f64, separate: bool) -> Result<Outcome, String> {
    let overrides = [
        format!("gravity.separate_steps={separate}"),
        format!("accuracy.acceleration_step={}", 0.25 * part),
        format!("accuracy.orbit_step={}", 0.1 * part),
        format!("gas.hydro.courant={}", 0.25 * part),
    ];
    let mut trial = Trial::new(&case.text, &overrides, case.prepare)?;
    let mut energy = 0.0;
    let done = trial.run(&[0.0, case.end], |stop| energy = stop.books.error_energy);
    done.map_err(|fault| fault.to_string())?;
    let n = trial.system.gas.len() as f64;
    let targets = |phase: Phase| trial.watch.laps[phase as usize].targets as f64 / n;
    Ok(Outcome {
        energy: energy.abs(),
        cpu_s: trial.cpu_s(),
        fields: targets(Phase::Gravity),
        forces: targets(Phase::Density),
        system: trial.system,
    })
}

/// Rms distance of the particles that both have, by their smoothing lengths.
fn distance(a: &System, b: &System) -> f64 {
    let (p, q) = (&a.gas.particles, &b.gas.particles);
    let known: HashMap<u64, usize> = q.id.iter().copied().zip(0..).collect();
    let pairs = (0..p.m.len()).filter_map(|i| Some((i, *known.get(&p.id[i])?)));
    let (sum, n) = pairs.fold((0.0, 0.0), |(sum, n), (i, k)| {
        (sum + ((p.x[i] - q.x[k]).norm() / q.h[k]).powi(2), n + 1.0)
    });
    f64::sqrt(sum / n)
}

/// What is compared, or the refusal of what should have run.
pub fn rows() -> Vec<Row> {
    let cases = [
        Case {
            name: "collapse",
            text: evrard::scene(30),
            end: 0.8,
            prepare: evrard::sphere,
            closed: true,
        },
        Case {
            name: "disk",
            text: DISK.to_owned(),
            end: 35.0,
            prepare: |_| (),
            closed: false,
        },
    ];
    let rows = cases.iter().map(measured).collect::<Result<Vec<_>, _>>();
    rows.map_or_else(
        |refusal| {
            vec![Row {
                what: refusal,
                measured: f64::NAN,
                uncertainty: 0.0,
                bar: Bar::Limit([0.0, 0.0]),
            }]
        },
        |rows| rows.concat(),
    )
}

fn measured(case: &Case) -> Result<Vec<Row>, String> {
    let finest = run(case, 0.25, false)?;
    let mut rows = Vec::new();
    for part in [2.0, 1.0, 0.5] {
        let [together, separate] = [run(case, part, false)?, run(case, part, true)?];
        let mut told = |what: &str, values: [f64; 2], bar: Bar| {
            for (kind, value, bar) in [
                ("together", values[0], Bar::None),
                ("apart", values[1], bar),
            ] {
                rows.push(Row {
                    what: format!("{}, steps of {part}, {kind}: {what}", case.name),
                    measured: value,
                    uncertainty: 0.0,
                    bar,
                });
            }
        };
        let both = |of: fn(&Outcome) -> f64| [of(&together), of(&separate)];
        told("fields a particle", both(|o| o.fields), Bar::None);
        told("forces a particle", both(|o| o.forces), Bar::None);
        told("CPU time, s", both(|o| o.cpu_s), Bar::None);
        if case.closed {
            let bar = if part == 1.0 {
                Bar::Limit([1e-3, 3e-3])
            } else {
                Bar::None
            };
            told("error of the energy", both(|o| o.energy), bar);
        }
        let far = [&together, &separate].map(|o| distance(&o.system, &finest.system));
        told("rms distance, by h", far, Bar::None);
        if part == 1.0 {
            let more = [1.0, far[1] / far[0]];
            told(
                "rms distance by that of steps together",
                more,
                Bar::Limit([1.1, 1.5]),
            );
        }
    }
    Ok(rows)
}
