//! The inner edge of a disk at the accretion radius: how long it lives with what holds it, on the wide disk with 20 000 particles.
//!
//! Gas within the accretion radius is accreted, so that nothing is there to hold what is next to it: the disk is eaten up from inside by a wave
//! that runs outwards at the speed of sound. Eroded: orbits at the edge until a tenth of the mass of the first ring, 10 to 15 au, is gone.

use std::f64::consts::TAU;

use coupling::System;
use nbody::points::Columns;

use super::{Bar, Row};
use crate::trial::Trial;

const SCENE: &str = include_str!("../../../tests/benches/wide-disk.toml");
const RING: [f64; 2] = [10.0, 15.0];
const ORBITS: usize = 12;
/// Stops an orbit.
const STOPS: usize = 8;
const LOSS: f64 = 0.1;

const OPTIONS: [(&str, &str); 4] = [
    ("open", ""),
    ("supported", "gas.edge={ inner = \"supported\" }"),
    (
        "a zone to 13 au",
        "gas.edge={ inner_radius = \"13 au\", time = 0.1 }",
    ),
    (
        "both",
        "gas.edge={ inner = \"supported\", inner_radius = \"13 au\", time = 0.1 }",
    ),
];

pub fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    for (name, key) in OPTIONS {
        let life = life(key);
        rows.push(Row::new(
            format!("{name}: orbits to the loss of a tenth (up to {ORBITS})"),
            life.tenth,
            match name {
                "both" => Bar::Least([10.0, 6.0]),
                _ => Bar::None,
            },
        ));
        for (orbits, loss) in life.losses {
            rows.push(Row::new(
                format!("{name}: part lost in {orbits} orbits"),
                loss,
                Bar::None,
            ));
        }
        rows.push(Row::new(
            format!("{name}: error of the angular momentum"),
            life.angular,
            Bar::Limit([1e-7, 3.6e-6]),
        ));
    }
    rows
}

/// What became of an edge.
#[derive(Default)]
struct Life {
    tenth: f64,
    losses: Vec<(usize, f64)>,
    angular: f64,
}

fn life(key: &str) -> Life {
    let mut overrides = vec!["gas.particles=20000".to_owned()];
    overrides.extend((!key.is_empty()).then(|| key.to_owned()));
    let trial = Trial::new(SCENE, &overrides, |_| {});
    let mut trial = trial.unwrap_or_else(|refusal| panic!("a built-in scene: {refusal}"));
    let orbit = TAU * RING[0].powf(1.5);
    let stops: Vec<f64> = (0..=ORBITS * STOPS)
        .map(|k| orbit * k as f64 / STOPS as f64)
        .collect();
    let mut life = Life {
        tenth: f64::NAN,
        ..Life::default()
    };
    let (mut start, mut met) = (f64::NAN, 0);
    let done = trial.run(&stops, |stop| {
        let mass = ring(stop.system);
        if met == 0 {
            start = mass;
        }
        let loss = 1.0 - mass / start;
        if life.tenth.is_nan() && loss >= LOSS {
            life.tenth = met as f64 / STOPS as f64;
        }
        if [3 * STOPS, 6 * STOPS, 12 * STOPS].contains(&met) {
            life.losses.push((met / STOPS, loss));
        }
        life.angular = stop.books.error_angular_momentum;
        met += 1;
    });
    done.unwrap_or_else(|fault| panic!("a built-in problem: {fault}"));
    if life.tenth.is_nan() {
        life.tenth = ORBITS as f64;
    }
    life
}

/// Mass of the first ring.
fn ring(system: &System) -> f64 {
    let gas = &system.gas.particles;
    let star = system.star.x[0];
    let within = |i: &usize| (RING[0]..RING[1]).contains(&(gas.x[*i] - star).xy().norm());
    (0..gas.len()).filter(within).map(|i| gas.m[i]).sum()
}
