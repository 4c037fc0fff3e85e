//! Long orbits: the energy of the outer Solar System by the Jacobi map and by Gauss-Radau, and a needle of e = 0.999999.
//!
//! The energy error of an integrator that rounds without a bias is a random walk: <(E(t + tau) - E(t))^2> ~ tau^(2 p) with p = 1/2; a
//! drift has p = 1. The exponent is fitted to lags of 1/512 to 1/4 of the span, over all intervals of all systems.
//! At the pericentre of the needle a rounding of the force by u = 1.1e-16 weighs 2 u/(1 - e) = 2e-10 in the energy: what a method that
//! sums forces there cannot avoid. Source: Brouwer (1937) for the walk; Rein & Spiegel (2015).

use std::f64::consts::TAU;

use cpu_time::ThreadTime;
use nbody::integrators::gauss_radau::GaussRadau;
use nbody::integrators::wisdom_holman::jacobi::{Corrector, Jacobi, Kernel, Scheme};
use nbody::kepler;
use nbody::points::{Columns, Vec3};
use nbody::{Bodies, Kind};
use rayon::prelude::*;

use super::{Bar, Row};

/// au, days, solar masses.
pub const G: f64 = 0.000_295_912_208_286;
pub const YEAR: f64 = 365.25;
/// Days; the orbit of Jupiter has a hundred steps.
const STEP: f64 = 0.1186 * YEAR;
const JUPITER: f64 = 11.86 * YEAR;

/// Masses, positions and velocities of Hairer, Lubich & Wanner (2006), I.2.3.
#[rustfmt::skip]
const SYSTEM: [(f64, [f64; 3], [f64; 3]); 5] = [
    (1.00000597682, [0.0; 3], [0.0; 3]),
    (0.000954786104043, [-3.5023653, -3.8169847, -1.5507963], [0.00565429, -0.0041249, -0.00190589]),
    (0.000285583733151, [9.0755314, -3.0458353, -1.6483708], [0.00168318, 0.00483525, 0.00192462]),
    (4.37273164546e-05, [8.310142, -16.2901086, -7.2521278], [0.00354178, 0.00137102, 0.00055029]),
    (5.17759138449e-05, [11.4707666, -25.7294829, -10.8169456], [0.0028893, 0.00114527, 0.00039677]),
];

/// Sun and giants seen from their centre of mass, Jupiter's place stretched by `shift`.
pub fn outer_solar_system(shift: f64) -> (Bodies, Bodies) {
    let place = |i: usize| Vec3::from(SYSTEM[i].1) * if i == 1 { 1.0 + shift } else { 1.0 };
    let total: f64 = SYSTEM.iter().map(|body| body.0).sum();
    let x = (0..5).map(|i| place(i) * SYSTEM[i].0).sum::<Vec3>() / total;
    let v = SYSTEM.iter().map(|b| Vec3::from(b.2) * b.0).sum::<Vec3>() / total;
    let set = |places: std::ops::Range<usize>, kind: Kind| {
        let mut set = Bodies::default();
        set.resize(places.len());
        for (k, i) in places.enumerate() {
            (set.id[k], set.kind[k], set.m[k]) = (i as u64, kind as u32, SYSTEM[i].0);
            (set.x[k], set.v[k]) = (place(i) - x, Vec3::from(SYSTEM[i].2) - v);
        }
        set
    };
    (set(0..1, Kind::Star), set(1..5, Kind::Planet))
}

fn energy(m: &[f64], x: &[Vec3], v: &[Vec3]) -> f64 {
    let of = |i: usize| {
        let potential: f64 = (0..i).map(|j| -G * m[j] / (x[i] - x[j]).norm()).sum();
        m[i] * (0.5 * v[i].norm_squared() + potential)
    };
    (0..m.len()).map(of).sum()
}

fn energy_of(star: &Bodies, planets: &Bodies) -> f64 {
    let m = [&star.m[..], &planets.m[..]].concat();
    let x = [&star.x[..], &planets.x[..]].concat();
    energy(&m, &x, &[&star.v[..], &planets.v[..]].concat())
}

fn pulls(m: &[f64], x: &[Vec3], a: &mut [Vec3]) {
    for i in 0..m.len() {
        for j in i + 1..m.len() {
            let d = x[j] - x[i];
            let r2 = d.norm_squared();
            let pull = d * (G / (r2 * r2.sqrt()));
            a[i] += pull * m[j];
            a[j] -= pull * m[i];
        }
    }
}

pub fn rows() -> Vec<Row> {
    let mut rows = jacobi();
    rows.extend(needle());
    rows
}

fn row(what: &str, measured: f64, uncertainty: f64, bar: Bar) -> Row {
    Row {
        what: what.to_string(),
        measured,
        uncertainty,
        bar,
    }
}

/// Mean and its standard error.
fn mean(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

/// Largest energy error in 1e5 yr, its drift in 1e6 yr, and the speed, of the corrected map with the lazy kernel.
fn jacobi() -> Vec<Row> {
    const SYSTEMS: u32 = 4;
    const LOOKS: usize = 2000;
    // Errors of these looks are averaged at the begin and at the end: what swings with the orbits goes out.
    const AVERAGED: usize = LOOKS / 20;
    let scheme = Scheme {
        kernel: Kernel::Lazy,
        corrector: Corrector::Seventeenth,
    };
    let steps = (1e6 * YEAR / STEP) as u64 / LOOKS as u64;
    let one = |system: u32| -> Option<(f64, f64, f64)> {
        let (mut star, mut planets) = outer_solar_system(1e-6 * f64::from(system));
        let start = energy_of(&star, &planets);
        let mut map = Jacobi::of(scheme, G, &star, &planets);
        let (mut errors, mut seconds) = (Vec::with_capacity(LOOKS), 0.0);
        for _ in 0..LOOKS {
            let clock = ThreadTime::now();
            map.advance(STEP, steps).ok()?;
            seconds += clock.elapsed().as_secs_f64();
            map.store(&mut star, &mut planets).ok()?;
            errors.push(energy_of(&star, &planets) / start - 1.0);
        }
        let early = errors[..LOOKS / 10].iter();
        let most = early.fold(
            0.0,
            |most: f64, e| if e.abs() > most { e.abs() } else { most },
        );
        let average = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
        let drift = average(&errors[LOOKS - AVERAGED..]) - average(&errors[..AVERAGED]);
        Some((most, drift, steps as f64 * LOOKS as f64 / seconds))
    };
    let runs: Vec<_> = (0..SYSTEMS)
        .map(|k| one(k).unwrap_or((f64::NAN, f64::NAN, f64::NAN)))
        .collect();
    let (drift, uncertainty) = mean(&runs.iter().map(|run| run.1).collect::<Vec<_>>());
    let speed = runs.iter().map(|run| run.2).fold(0.0, f64::max);
    let name = "Jacobi map, corrector 17, lazy kernel, steps of 0.1186 yr";
    vec![
        row(
            &format!("{name}: largest energy error in 1e5 yr"),
            runs[0].0,
            0.0,
            Bar::Limit([3e-13, 6e-13]),
        ),
        row(
            &format!("{name}: energy drift in 1e6 yr, mean of {SYSTEMS}"),
            drift,
            uncertainty,
            Bar::Limit([2e-14, 1e-13]),
        ),
        row(&format!("{name}: steps a second"), speed, 0.0, Bar::None),
    ]
}

/// Exponent and size of the energy error of Gauss-Radau over 1e6 orbits of Jupiter, with Saturn.
pub fn walk() -> Vec<Row> {
    const SYSTEMS: u32 = 2;
    const LOOKS: usize = 2048;
    let orbits = 1e6;
    let one = |system: u32| -> Vec<f64> {
        let (star, planets) = outer_solar_system(1e-6 * f64::from(system));
        let m = [star.m[0], planets.m[0], planets.m[1]];
        let x = [star.x[0], planets.x[0], planets.x[1]];
        let v = [star.v[0], planets.v[0], planets.v[1]];
        let start = energy(&m, &x, &v);
        let mut radau = GaussRadau::new(0.0, &x, &v);
        let look = |k: usize| {
            let end = orbits * JUPITER * k as f64 / LOOKS as f64;
            let done = radau.advance_to(end, |x, a| pulls(&m, x, a));
            let error = energy(&m, radau.x(), radau.v()) / start - 1.0;
            done.map_or(f64::NAN, |()| error)
        };
        (0..=LOOKS).map(look).collect()
    };
    let runs: Vec<Vec<f64>> = (0..SYSTEMS).into_par_iter().map(one).collect();
    let (exponent, uncertainty) = exponent(&runs, 4, LOOKS / 4);
    let squares: Vec<f64> = runs.iter().map(|run| run[LOOKS].powi(2)).collect();
    let (drift, drift_error) = mean(&runs.iter().map(|run| run[LOOKS]).collect::<Vec<_>>());
    let name = format!("Gauss-Radau, 1e6 orbits of Jupiter beside Saturn, {SYSTEMS} systems");
    vec![
        row(
            &format!("{name}: growth exponent of the energy error"),
            exponent,
            uncertainty,
            Bar::Reference {
                value: 0.5,
                good: 0.2,
                acceptable: 0.4,
            },
        ),
        row(
            &format!("{name}: root mean square energy error"),
            mean(&squares).0.sqrt(),
            0.0,
            Bar::None,
        ),
        row(
            &format!("{name}: mean energy error"),
            drift,
            drift_error,
            Bar::None,
        ),
    ]
}

/// Slope of log rms of the differences over log lag, lags doubling from `first` to `last`, and its standard error for a random walk.
fn exponent(runs: &[Vec<f64>], first: usize, last: usize) -> (f64, f64) {
    let lags =
        std::iter::successors(Some(first), |lag| Some(2 * lag)).take_while(|&lag| lag <= last);
    let (mut w, mut wx, mut wy, mut wxx, mut wxy) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for lag in lags {
        let (mut square, mut n) = (0.0, 0.0);
        for run in runs {
            for k in (lag..run.len()).step_by(lag) {
                square += (run[k] - run[k - lag]).powi(2);
                n += 1.0;
            }
        }
        // The logarithm of the root of a mean of n squares is uncertain by 1/sqrt(2 n).
        let (x, y, weight) = ((lag as f64).ln(), 0.5 * (square / n).ln(), 2.0 * n);
        (w, wx, wy) = (w + weight, wx + weight * x, wy + weight * y);
        (wxx, wxy) = (wxx + weight * x * x, wxy + weight * x * y);
    }
    let spread = w * wxx - wx * wx;
    ((w * wxy - wx * wy) / spread, (w / spread).sqrt())
}

/// Error of the energy (or of the semi-major axis) of e = 0.999999 after 1000 pericentres by the Kepler drift and by Gauss-Radau.
fn needle() -> Vec<Row> {
    const SYSTEMS: u32 = 4;
    const ORBITS: u32 = 1000;
    let e: f64 = 0.999_999;
    let axis = |x: Vec3, v: Vec3| 1.0 / (2.0 / x.norm() - v.norm_squared());
    let start = |system: u32| {
        let (sin, cos) = (0.7 * f64::from(system)).sin_cos();
        let slow = ((1.0 - e) / (1.0 + e)).sqrt();
        (
            Vec3::new(cos, sin, 0.0) * (1.0 + e),
            Vec3::new(-sin, cos, 0.0) * slow,
        )
    };
    let by_kepler = |system: u32| {
        let (x0, v0) = start(system);
        let (mut x, mut v) = (x0, v0);
        // A third of a period and a little: no stop is at a pericentre, where a rounding of the place is 1e-10 of the distance.
        let done = (0..3 * ORBITS).try_for_each(|_| kepler::drift(1.0, 0.36 * TAU, &mut x, &mut v));
        done.map_or(f64::NAN, |()| axis(x, v) / axis(x0, v0) - 1.0)
    };
    let by_radau = |system: u32| {
        let (x0, v0) = start(system);
        let mut radau = GaussRadau::new(0.0, &[x0], &[v0]);
        let pull = |x: &[Vec3], a: &mut [Vec3]| a[0] -= x[0] / x[0].norm().powi(3);
        // Each to the apocentre.
        let done = (1..=ORBITS).try_for_each(|k| radau.advance_to(TAU * f64::from(k), pull));
        done.map_or(f64::NAN, |()| {
            axis(radau.x()[0], radau.v()[0]) / axis(x0, v0) - 1.0
        })
    };
    let rms =
        |errors: Vec<f64>| (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
    let kepler = rms((0..SYSTEMS).into_par_iter().map(by_kepler).collect());
    let radau = rms((0..SYSTEMS).into_par_iter().map(by_radau).collect());
    let name = format!("e = 0.999999, {ORBITS} pericentres, rms error of a over {SYSTEMS} orbits");
    vec![
        row(
            &format!("{name}: Kepler drift"),
            kepler,
            0.0,
            Bar::Limit([1e-12, 1e-10]),
        ),
        row(
            &format!("{name}: Gauss-Radau"),
            radau,
            0.0,
            Bar::Limit([1e-10, 2.5e-9]),
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_walk_has_the_exponent_one_half_and_a_drift_one() {
        let step = |k: u32, seed: f64| {
            (f64::from(k) * 0.618_034 + seed)
                .fract()
                .mul_add(1e4, 0.0)
                .sin()
        };
        let walk = |run: u32| -> Vec<f64> {
            let steps = 0..2048u32;
            let sums = steps.scan(0.0, |sum, k| {
                *sum += step(k.wrapping_mul(k) + 7919 * run, 0.1 * f64::from(run)).signum();
                Some(*sum)
            });
            sums.collect()
        };
        let (found, error) = exponent(&[walk(1), walk(2), walk(3), walk(4)], 4, 512);
        assert!((found - 0.5).abs() < 4.0 * error, "{found} +- {error}");
        let drift: Vec<f64> = (0..2048).map(f64::from).collect();
        assert!((exponent(&[drift], 4, 512).0 - 1.0).abs() < 1e-9);
    }
}
