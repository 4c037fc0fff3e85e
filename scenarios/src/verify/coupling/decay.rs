//! Planetesimals of 100 m in a disk of gas particles: their orbits shrink, and become round and flat, as in the same disk as a formula.
//!
//! What shrinks orbits is a headwind of 0.4 % of the speed, to which noise and viscosity of the particles add some of their own: the formula's gas has
//! the headwind that the bodies found among the particles, which is told beside that of the balance of pressure, (h^2/2)(p + 3/2 + q/2).
//! Both disks have H/R = 0.05 and the same surface density; bodies without weight and the drag law of Adachi et al. (1976), whose rates in the
//! formula are those of Gauss's equations. Compared are the sums over all bodies of what a, e and i changed by in a year and a half, with the standard
//! error that the scatter from body to body leaves.
//! Source: Adachi, Hayashi & Nakazawa (1976), Prog. Theor. Phys. 56, 1756.

use std::collections::HashMap;
use std::f64::consts::TAU;

use gas::probe::{Probe, Reach};
use nbody::orbit::Elements;
use nbody::points::Vec3;

use super::super::{Bar, Row};
use crate::trial::Trial;

const BODIES: &str = r#"
[run]
end_time = "10 yr"
[star]
mass = "1 Msun"
accretion_radius = "0.3 au"
[planetesimals]
number = 400
total_mass = "1e-16 Mearth"
inner_radius = "0.95 au"
outer_radius = "1.15 au"
eccentricity = 0.05
inclination = 0.02
density = "2 g/cm^3"
[planetesimals.collisions]
outcome = "none"
[gravity]
pulls = { gas = [], planetesimals = [] }
"#;

const PARTICLES: &str = r#"
[planetesimals.drag]
law = "adachi"
[gas]
[gas.disk]
surface_density = "1700 g/cm^2"
slope = -1.0
reference_radius = "1 au"
inner_radius = "0.5 au"
outer_radius = "2.1 au"
[gas.eos]
kind = "locally-isothermal"
aspect_ratio = 0.05
exponent = 0.5
reference_radius = "1 au"
[coupling]
feedback = false
"#;

const FORMULA: &str = r#"
[surroundings.disk]
drag = "adachi"
surface_density = "1700 g/cm^2"
surface_density_slope = -1.0
reference_radius = "1 au"
inner_radius = "0.4 au"
outer_radius = "2 au"
aspect_ratio = 0.05
flaring = 0.0
"#;

/// Years over which orbits are followed.
const YEARS: f64 = 1.5;

/// a, e and i of bodies by their number, at the start and at the end.
type Orbits = [HashMap<u64, [f64; 3]>; 2];

/// How often the gas is looked at.
const LOOKS: usize = 10;

/// Mean of 1 - v_phi / v_K of the gas where the bodies are; none without gas particles.
fn headwind(system: &coupling::System) -> f64 {
    let reach = Reach {
        neighbours: 58.0,
        largest: 0.2,
    };
    let (mut probe, mut sum) = (Probe::default(), 0.0);
    for (x, h) in system.bodies.x.iter().zip(&system.bodies.h) {
        let gas = probe.sample(&system.gas, &system.domain, *x, *h, &reach);
        let (from, r) = (x - system.star.x[0], x.norm());
        let along = Vec3::new(-from.y, from.x, 0.0).normalize();
        sum += 1.0 - (gas.v - system.star.v[0]).dot(&along) * r.sqrt();
    }
    sum / system.bodies.x.len() as f64
}

/// Orbits in a medium, and the mean headwind if it is of particles.
fn orbits(medium: &str, overrides: &[String]) -> (Orbits, f64) {
    let mut trial = Trial::new(&format!("{BODIES}{medium}"), overrides, |_| {})
        .unwrap_or_else(|refusal| panic!("a built-in scene: {refusal}"));
    let stops: Vec<f64> = (0..=LOOKS)
        .map(|k| TAU * YEARS * k as f64 / LOOKS as f64)
        .collect();
    let (mut found, mut wind, mut looks) = (Vec::new(), 0.0, 0);
    let done = trial.run(&stops, |stop| {
        if !stop.system.gas.is_empty() {
            wind += headwind(stop.system) / (LOOKS + 1) as f64;
        }
        looks += 1;
        if looks > 1 && looks <= LOOKS {
            return;
        }
        let (bodies, star) = (&stop.system.bodies, &stop.system.star);
        let of = |i: usize| {
            let (x, v) = (bodies.x[i] - star.x[0], bodies.v[i] - star.v[0]);
            let orbit = Elements::of(stop.system.g * star.m[0], x, v).expect("a bound body");
            [orbit.semi_major_axis, orbit.eccentricity, orbit.inclination]
        };
        found.push((0..bodies.x.len()).map(|i| (bodies.id[i], of(i))).collect());
    });
    done.unwrap_or_else(|fault| panic!("a built-in problem: {fault}"));
    (found.try_into().expect("a start and an end"), wind)
}

/// Change of each body, by the elements' mean change in the formula: mean and standard error.
fn compared(live: &Orbits, exact: &Orbits) -> [[f64; 2]; 3] {
    std::array::from_fn(|k| {
        let change = |orbits: &Orbits, id: &u64| orbits[1][id][k] - orbits[0][id][k];
        let n = exact[0].len() as f64;
        let expected = exact[0].keys().map(|id| change(exact, id)).sum::<f64>() / n;
        let ratio = |id: &u64| 1.0 + (change(live, id) - change(exact, id)) / expected;
        let mean = exact[0].keys().map(ratio).sum::<f64>() / n;
        let square = exact[0]
            .keys()
            .map(|id| (ratio(id) - mean).powi(2))
            .sum::<f64>();
        [mean, (square / (n * (n - 1.0))).sqrt()]
    })
}

pub fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    for particles in [20_000, 80_000] {
        let (live, wind) = orbits(PARTICLES, &[format!("gas.particles={particles}")]);
        let (exact, _) = orbits(FORMULA, &[format!("surroundings.disk.headwind={wind}")]);
        let of = |what: &str| format!("{particles} gas particles: {what}");
        rows.push(Row::new(
            of("headwind by v_K (of the balance 3.75e-3)"),
            wind,
            Bar::None,
        ));
        for (name, [ratio, error]) in ["a", "e", "i"].into_iter().zip(compared(&live, &exact)) {
            // The fewer show how it converges.
            let bar = match particles {
                80_000 => Bar::Reference {
                    value: 1.0,
                    good: 0.03,
                    acceptable: 0.05,
                },
                _ => Bar::None,
            };
            let what = format!("change of {name} by that in the formula's disk");
            rows.push(Row {
                uncertainty: error,
                ..Row::new(of(&what), ratio, bar)
            });
        }
    }
    rows
}
