//! A disk that pulls itself and cools in beta / Omega: fast cooling breaks it into clumps, slow cooling keeps it turbulent (Gammie 2001).
//!
//! Razor-thin, G = M = 1, Sigma ~ 1/R between 0.5 and 1.5 of 0.1 M in all, gamma = 5/3, Q = 1.3 everywhere at the start; noise of a third of the particles'
//! distance. Softening: half a particle's distance at R = 1, a sixth of c/Omega. A fragment is a place of more than 100 times the surface density that was at its
//! distance from the star, whose surroundings are bound: kinetic, internal and potential energy within 0.03 of it, about their mean motion.
//! A run ends there. Accepted: fragments at beta <= 3, none at beta = 30.
//!
//! alpha = 4 / (9 gamma (gamma - 1) beta) where cooling balances the stress's heat. Measured over the second half of a slow run by its [`stress`].
//! About the boundary disks are followed for 20 cooling times of R = 1; a number's error there is by the parts of that half.
//! Sources: Gammie (2001), ApJ 553, 174; Rice, Lodato & Armitage (2005) for gamma = 5/3 (in space).

use std::f64::consts::{PI, SQRT_2, TAU};

use coupling::System;
use gas::Particles;
use nbody::points::random::{Purpose, stream};
use nbody::points::{Columns, Fault, Vec3};
use rand::RngExt;

use self::stress::Stress;
use super::sheet::{self, Ring, Sheet};
use super::viscous::Inviscid;
use super::{Bar, Row};
use crate::trial::Trial;

mod stress;

const PARTICLES: usize = 20_000;
const GAMMA: f64 = 5.0 / 3.0;
const MASS: f64 = 0.1;
const Q: f64 = 1.3;
const INNER: f64 = 0.5;
const OUTER: f64 = 1.5;
const EDGE: f64 = 0.02;
const SOFTENING: f64 = 0.009;
/// By what the surface density has to grow.
const CONTRAST: f64 = 100.0;
/// Size of a fragment.
const SIZE: f64 = 0.03;
/// Orbits at R = 1, by beta.
const CASES: [(f64, f64); 4] = [(2.0, 6.0), (3.0, 6.0), (10.0, 8.0), (30.0, 12.0)];
/// beta about the boundary, and how many cooling times they are followed for.
const BOUNDARY: [f64; 4] = [5.0, 6.0, 7.0, 10.0];
const COOLING_TIMES: f64 = 20.0;
/// How nearly a disk is to balance its cooling by then: it is not quite steady.
const BALANCE: Bar = Bar::Reference {
    value: 1.0,
    good: 0.075,
    acceptable: 0.15,
};
/// Stops an orbit.
const STOPS: usize = 10;

/// Surface density without edges.
fn within(r: f64) -> f64 {
    MASS / (TAU * (OUTER - INNER) * r)
}

fn sigma(r: f64) -> f64 {
    let edge = |d: f64| 1.0 / (1.0 + (d / EDGE).exp());
    within(r) * edge(INNER - r) * edge(r - OUTER)
}

/// Sound speed at the start.
fn sound_speed(r: f64) -> f64 {
    Q * PI * within(r) * r.powf(1.5)
}

fn scene(beta: f64) -> String {
    let keys = format!(
        r#"
[gas]
softening = {SOFTENING}
[gas.eos]
kind = "ideal"
gamma = {GAMMA}
[gas.cooling]
kind = "beta"
beta = {beta}
[gravity]
pulls = {{ gas = ["gas"] }}
"#
    );
    sheet::scene(PARTICLES, (1.0, 0.2), &keys) + "pressure = 1.0\n"
}

/// What became of a disk.
#[derive(Clone, Debug, Default)]
struct End {
    orbits: f64,
    /// The largest surface density by that at the start, ever.
    peak: f64,
    fragment: Option<Fragment>,
    /// Over the second half.
    stress: Vec<Stress>,
}

/// What is within a fragment.
#[derive(Clone, Copy, Debug)]
struct Fragment {
    particles: usize,
    /// By the disk's.
    mass: f64,
    /// Kinetic and internal energy by the size of the potential one.
    heat: f64,
}

pub fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    for (beta, orbits) in CASES {
        let end = run(beta, orbits).unwrap_or_else(|fault| panic!("a built-in problem: {fault}"));
        let fast = beta <= 3.0;
        let mut row = |what: &str, measured: f64, bar: Bar| {
            rows.push(Row::new(format!("beta = {beta}: {what}"), measured, bar));
        };
        row(
            "largest surface density by that at the start",
            end.peak,
            match beta {
                _ if fast => Bar::Least([CONTRAST, 0.3 * CONTRAST]),
                // Between the accepted bounds either may happen.
                10.0 => Bar::None,
                _ => Bar::Limit([0.05 * CONTRAST, 0.3 * CONTRAST]),
            },
        );
        row("orbits", end.orbits, Bar::None);
        if let Some(fragment) = end.fragment {
            row("particles within", fragment.particles as f64, Bar::None);
            row("their mass by the disk's", fragment.mass, Bar::None);
        }
        if fast || end.fragment.is_some() {
            // Not a number, and so failed, without a fragment.
            let heat = end.fragment.map_or(f64::NAN, |fragment| fragment.heat);
            row(
                "kinetic and internal energy by the potential one's size",
                heat,
                Bar::Limit([0.9, 1.0]),
            );
        } else {
            rows.extend(turbulence(beta, &end, Bar::None));
        }
    }
    rows
}

/// Disks about the boundary, for as many cooling times as it takes to be sure.
pub fn boundary() -> Vec<Row> {
    let mut rows = Vec::new();
    for beta in BOUNDARY {
        let end = run(beta, COOLING_TIMES * beta / TAU)
            .unwrap_or_else(|fault| panic!("a built-in problem: {fault}"));
        let mut row = |what: &str, measured: f64| {
            rows.push(Row::new(
                format!("beta = {beta}: {what}"),
                measured,
                Bar::None,
            ));
        };
        row("cooling times", end.orbits * TAU / beta);
        row("largest surface density by that at the start", end.peak);
        match end.fragment {
            Some(fragment) => row("bound mass by the disk's", fragment.mass),
            None => rows.extend(turbulence(beta, &end, BALANCE)),
        }
    }
    rows
}

/// alpha of a disk that does not break, beside what balances its cooling.
fn turbulence(beta: f64, end: &End, balance: Bar) -> Vec<Row> {
    let expected = 4.0 / (9.0 * GAMMA * (GAMMA - 1.0) * beta);
    let row = |what: &str, bar: Bar, of: &dyn Fn(&Stress) -> f64| {
        let (mean, uncertainty) = stress::mean(&end.stress, of);
        Row {
            uncertainty,
            ..Row::new(format!("beta = {beta}: {what}"), mean, bar)
        }
    };
    let resolved = |stress: &Stress| stress.velocities + stress.gravity;
    let by_it = |alpha: f64| alpha / expected;
    let mut rows = vec![
        row("alpha of the velocities", Bar::None, &|s| s.velocities),
        row("alpha of gravity", Bar::None, &|s| s.gravity),
        row("alpha of artificial viscosity", Bar::None, &|s| s.viscosity),
        row("alpha of pressure", Bar::None, &|s| s.pressure),
        row(
            "velocities and gravity, by what balances the cooling",
            Bar::None,
            &|s| by_it(resolved(s)),
        ),
        row("all, by what balances the cooling", balance, &|s| {
            by_it(resolved(s) + s.viscosity + s.pressure)
        }),
        row("Q", Bar::None, &|s| s.q),
    ];
    let what = format!("beta = {beta}: alpha that balances the cooling");
    rows.push(Row::new(what, expected, Bar::None));
    rows
}

fn run(beta: f64, orbits: f64) -> Result<End, Fault> {
    let sheet = Sheet {
        sigma: &sigma,
        inner: INNER - 5.0 * EDGE,
        outer: OUTER + 5.0 * EDGE,
        particles: PARTICLES,
        softening: SOFTENING,
    };
    let rings = sheet.rings();
    let trial = Trial::new(&scene(beta), &[], |gas| lay_out(gas, &sheet, &rings));
    let mut trial = trial.unwrap_or_else(|refusal| panic!("a built-in scene: {refusal}"));
    let number = (orbits * STOPS as f64) as usize;
    let stops: Vec<f64> = (0..=number)
        .map(|k| TAU * k as f64 / STOPS as f64)
        .collect();
    let inviscid = Inviscid::of(&trial);
    let mut end = End::default();
    trial.run_while(&stops, |stop| {
        end.orbits = stop.system.clock.time() / TAU;
        let (place, contrast) = densest(stop.system);
        end.peak = end.peak.max(contrast);
        if contrast > CONTRAST {
            end.fragment = Some(fragment(stop.system, place));
            return end.fragment.is_some_and(|fragment| fragment.heat >= 1.0);
        }
        if 2.0 * end.orbits >= orbits {
            end.stress.push(Stress::of(stop.system, &inviscid));
        }
        true
    })?;
    Ok(end)
}

/// Lays the disk out in balance, with noise.
fn lay_out(gas: &mut Particles, sheet: &Sheet, rings: &[Ring]) {
    let pressure = |r: f64| sigma(r) * sound_speed(r).powi(2) / GAMMA;
    let momenta: Vec<f64> = (rings.iter())
        .map(|ring| {
            let r = ring.radius;
            let slope = (pressure(r + 1e-6) - pressure(r - 1e-6)) / 2e-6;
            ring.momentum(-slope / sigma(r))
        })
        .collect();
    sheet.lay_out(gas, rings, (&momenta, |_| 0.0));
    for i in 0..gas.len() {
        let r = gas.x[i].norm();
        let spacing = (gas.m[i] / within(r)).sqrt();
        let mut random = stream(1, Purpose::GasPositions, gas.id[i], 0);
        let mut noise = || 2.0 * random.random::<f64>() - 1.0;
        gas.x[i] += spacing / 3.0 * Vec3::new(noise(), noise(), 0.0);
        gas.u[i] = sound_speed(r).powi(2) / (GAMMA * (GAMMA - 1.0));
    }
}

/// The particle of the largest surface density by that at the start, and that ratio; not a number if one is none.
fn densest(system: &System) -> (usize, f64) {
    let (gas, star) = (&system.gas, system.star.x[0]);
    let contrast = |i: usize| gas.derived.rho[i] / within((gas.particles.x[i] - star).norm());
    let all = (0..gas.len()).map(|i| (i, contrast(i)));
    all.fold(
        (0, 0.0),
        |a, b| if a.1 >= b.1 || a.1.is_nan() { a } else { b },
    )
}

/// What is about particle `place`.
fn fragment(system: &System, place: usize) -> Fragment {
    let p = &system.gas.particles;
    let near: Vec<usize> = (0..p.len())
        .filter(|&i| (p.x[i] - p.x[place]).norm() < SIZE)
        .collect();
    let mass: f64 = near.iter().map(|&i| p.m[i]).sum();
    let drift = near.iter().map(|&i| p.m[i] * p.v[i]).sum::<Vec3>() / mass;
    let mut motion = 0.0;
    let mut potential = 0.0;
    for (k, &i) in near.iter().enumerate() {
        motion += p.m[i] * (0.5 * (p.v[i] - drift).norm_squared() + p.u[i]);
        for &j in &near[..k] {
            let d = (p.x[i] - p.x[j]).norm().hypot(SQRT_2 * SOFTENING);
            potential += p.m[i] * p.m[j] / d;
        }
    }
    Fragment {
        particles: near.len(),
        mass: mass / MASS,
        heat: motion / potential,
    }
}
