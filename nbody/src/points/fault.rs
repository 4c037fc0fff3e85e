//! A fault: the typed reason why a step cannot be done, naming population, particle, quantity and time.

use std::fmt;

use thiserror::Error;

/// The kinds of particles that live in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Population {
    Gas,
    Dust,
    Planetesimals,
    Star,
}

impl fmt::Display for Population {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Population::Gas => "gas",
            Population::Dust => "dust",
            Population::Planetesimals => "planetesimals",
            Population::Star => "star",
        })
    }
}

/// Why a step cannot be done. Times are in code units.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum Fault {
    #[error("{population} particle {id}: {quantity} is not a finite number at time {}", shown(*time))]
    NonFinite {
        population: Population,
        id: u64,
        quantity: &'static str,
        time: f64,
    },
    #[error(
        "{population} particle {id}: no smoothing length gives the wanted neighbour number at time {} (last try {smoothing_length:e})",
        shown(*time)
    )]
    DensityNotConverged {
        population: Population,
        id: u64,
        smoothing_length: f64,
        time: f64,
    },
    #[error(
        "{population} particle {id}: needs a time step of {step:e} at time {}, shorter than the shortest, {shortest:e}",
        shown(*time)
    )]
    StepTooSmall {
        population: Population,
        id: u64,
        step: f64,
        shortest: f64,
        time: f64,
    },
    #[error(
        "{population} particle {id}: the equation of state has no pressure or sound speed at density {} and internal energy {}, at time {}",
        shown(*density),
        shown(*energy),
        shown(*time)
    )]
    NoState {
        population: Population,
        id: u64,
        density: f64,
        energy: f64,
        time: f64,
    },
    #[error("{population} body {id} cannot be moved at time {}: {reason}", shown(*time))]
    Stuck {
        population: Population,
        id: u64,
        reason: String,
        time: f64,
    },
    #[error("{quantity} is not conserved: relative error {error:e} exceeds {bar:e} at time {}", shown(*time))]
    NotConserved {
        quantity: &'static str,
        error: f64,
        bar: f64,
        time: f64,
    },
}

/// A number in few digits, whatever its size.
fn shown(x: f64) -> String {
    match x.abs() {
        0.0 | 1e-4..1e9 => x.to_string(),
        _ => format!("{x:e}"),
    }
}
