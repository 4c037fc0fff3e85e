//! Problems of the gas in single and in double precision side by side.
//!
//! Errors are those of the run in double precision; the difference is what the run in single precision makes of the same quantity, and should
//! be ten times smaller than the error at least. Where particles keep their order it is taken particle by particle, else between means.

pub mod evrard;
mod gresho;
pub mod sod;

pub use gresho::rows as gresho;
pub use sod::rows as sod;

use coupling::System;
use coupling::ledger::Report;
use gas::Particles;

use super::{Bar, Row};
use crate::trial::Trial;

/// The part of an error that precision may make.
const PART: [f64; 2] = [0.03, 0.1];

/// What a run came to: its gas in the order of identities, and its books.
struct End {
    gas: Vec<State>,
    books: Report,
}

/// A gas particle at the end of a run.
#[derive(Clone, Copy)]
struct State {
    id: u64,
    x: nbody::points::Vec3,
    v: nbody::points::Vec3,
    m: f64,
    rho: f64,
}

impl End {
    fn of(system: &System, books: &Report) -> Self {
        let (p, rho) = (&system.gas.particles, &system.gas.derived.rho);
        let state = |i: usize| State {
            id: p.id[i],
            x: p.x[i],
            v: p.v[i],
            m: p.m[i],
            rho: rho[i],
        };
        let mut gas: Vec<State> = (0..p.m.len()).map(state).collect();
        gas.sort_unstable_by_key(|particle| particle.id);
        Self { gas, books: *books }
    }
}

/// The ends of a scene in double and in single precision; `scene` has no table `gas.hydro` of its own.
fn both(scene: &str, end: f64, prepare: impl Fn(&mut Particles)) -> [End; 2] {
    ["double", "single"].map(|precision| {
        let text = format!("{scene}\n[gas.hydro]\nprecision = \"{precision}\"\n");
        solo(&text, end, &prepare).0
    })
}

/// The end of a scene, and the CPU time of an update in seconds.
fn solo(scene: &str, end: f64, prepare: impl FnOnce(&mut Particles)) -> (End, f64) {
    let mut trial = Trial::new(scene, &[], prepare)
        .unwrap_or_else(|refusal| panic!("a built-in scene: {refusal}"));
    let mut last = None;
    let done = trial.run(&[0.0, end], |stop| {
        last = Some(End::of(stop.system, stop.books));
    });
    done.unwrap_or_else(|fault| panic!("a built-in problem: {fault}"));
    let cost = trial.cpu_s() / trial.updates() as f64;
    (last.expect("a run has an end"), cost)
}

/// The rows of one quantity: its error in double precision, and how much of that the precision makes.
fn pair(what: &str, bar: Bar, error: f64, difference: f64) -> [Row; 2] {
    let row = |what: String, measured, bar| Row {
        what,
        measured,
        uncertainty: 0.0,
        bar,
    };
    [
        row(what.to_owned(), error, bar),
        row(
            format!("{what}: difference in single precision, of the error"),
            difference / error,
            Bar::Limit(PART),
        ),
    ]
}
