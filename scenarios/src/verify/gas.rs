//! Problems of the gas: a battery for any scheme, and some of them in single and in double precision side by side.
//!
//! Of the latter: errors are those of the run in double precision; the difference is what the run in single precision makes of the same quantity, and should
//! be ten times smaller than the error at least. Where particles keep their order it is taken particle by particle, else between means.

pub mod blob;
pub mod evrard;
pub mod gresho;
pub mod liquid;
pub mod noh;
pub mod noise;
pub mod oblique;
pub mod passing_rows;
mod picture;
pub mod riemann;
pub mod scheme;
pub mod sedov;
pub mod sharp_layer;
pub mod shear_layer;
pub mod sod;
pub mod square;
pub mod tube;
pub mod wave;
pub mod yee;

use coupling::System;
use coupling::ledger::Report;
use gas::Particles;
use nbody::points::Vec3;

use self::scheme::Scheme;
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
    x: Vec3,
    v: Vec3,
    /// By pressure and viscosity.
    a: Vec3,
    m: f64,
    u: f64,
    h: f64,
    rho: f64,
    p: f64,
}

/// A quantity of a particle.
type Quantity = fn(&State) -> f64;

impl State {
    /// m / rho
    fn volume(&self) -> f64 {
        self.m / self.rho
    }
}

impl End {
    fn of(system: &System, books: &Report) -> Self {
        let (p, derived) = (&system.gas.particles, &system.gas.derived);
        let state = |i: usize| State {
            id: p.id[i],
            x: p.x[i],
            v: p.v[i],
            a: system.gas.rates.hydro[i],
            m: p.m[i],
            u: p.u[i],
            h: p.h[i],
            rho: derived.rho[i],
            p: derived.p[i],
        };
        let mut gas: Vec<State> = (0..p.m.len()).map(state).collect();
        gas.sort_unstable_by_key(|particle| particle.id);
        Self { gas, books: *books }
    }

    /// The mean of `value` over the particles that have one, weighted by volume.
    fn mean(&self, value: impl Fn(&State) -> Option<f64>) -> f64 {
        let (mut sum, mut volume) = (0.0, 0.0);
        for particle in &self.gas {
            if let Some(value) = value(particle) {
                sum += particle.volume() * value;
                volume += particle.volume();
            }
        }
        sum / volume
    }

    /// Means of `value` over particles in `bins` bins of `place` from zero to one; not-a-number where there are none.
    fn binned(
        &self,
        bins: usize,
        place: impl Fn(&State) -> f64,
        value: impl Fn(&State) -> f64,
    ) -> Vec<f64> {
        let mut sums = vec![[0.0; 2]; bins];
        for particle in &self.gas {
            let bin = (place(particle) * bins as f64).floor();
            if bin >= 0.0 && bin < bins as f64 {
                sums[bin as usize][0] += value(particle);
                sums[bin as usize][1] += 1.0;
            }
        }
        sums.iter().map(|[sum, number]| sum / number).collect()
    }

    fn energy_error(&self) -> Row {
        Row::new(
            "error of the energy",
            self.books.error_energy.abs(),
            Bar::None,
        )
    }
}

/// The middle of the values.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// The power of the resolution with which errors fall: the slope of a straight line through their logarithms.
fn order(resolutions: &[f64], errors: &[f64]) -> f64 {
    let [x, y] = [resolutions, errors]
        .map(|values| -> Vec<f64> { values.iter().map(|value| value.ln()).collect() });
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let (x0, y0) = (mean(&x), mean(&y));
    let products = x.iter().zip(&y).map(|(x, y)| (x - x0) * (y - y0));
    -products.sum::<f64>() / x.iter().map(|x| (x - x0).powi(2)).sum::<f64>()
}

/// The place below which a part of the mass lies that has this density over the unit interval, and the whole mass.
pub fn stretched(density: impl Fn(f64) -> f64) -> (impl Fn(f64) -> f64, f64) {
    const PARTS: usize = 20_000;
    let width = 1.0 / PARTS as f64;
    let mut below = vec![0.0];
    for k in 0..PARTS {
        let slice = density((k as f64 + 0.5) * width) * width;
        below.push(below[k] + slice);
    }
    let mass = below[PARTS];
    let place = move |part: f64| {
        let k = below.partition_point(|b| *b <= part * mass).clamp(1, PARTS);
        let inside = (part * mass - below[k - 1]) / (below[k] - below[k - 1]);
        (k as f64 - 1.0 + inside) * width
    };
    (place, mass)
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
    [
        Row::new(what, error, bar),
        Row::new(
            format!("{what}: difference in single precision, of the error"),
            difference / error,
            Bar::Limit(PART),
        ),
    ]
}

#[cfg(test)]
mod tests;
