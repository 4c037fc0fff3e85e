//! Secular frequencies of the outer Solar System: how fast the apsides (g5 to g8) and the nodes (s6 to s8) of its modes turn.
//!
//! Lines of e exp(i varpi) and sin(i/2) exp(i Omega) over 5 Myr, in the invariable plane, where the node of the fifth mode does not
//! exist. A line is where the transform with Hann's window 1 - cos(2 pi t/T) is largest; its error is about 1e-3 of 1/T.
//! Reference: 20 Myr of the same initial data by an independent Wisdom-Holman map; within 0.4 % of Nobili, Milani & Carpino (1989).
//! Source: Murray & Dermott (1999), chapter 7; Laskar (1990) for the search of lines.

use std::f64::consts::{PI, TAU};

use nalgebra::{Complex, Rotation3};
use nbody::Bodies;
use nbody::integrators::wisdom_holman::jacobi::{Jacobi, Scheme};
use nbody::orbit::Elements;
use nbody::points::Vec3;

use super::orbits::{G, YEAR, outer_solar_system};
use super::{Bar, Row};

/// Years.
const SPAN: f64 = 5e6;
const INTERVAL: f64 = 500.0;
/// Days.
const STEP: f64 = 100.0;
/// Arcseconds a year.
const FASTEST: f64 = 60.0;
const GRID: f64 = 0.05;

/// Whether the frequency belongs to the mode of a planet's apsis or of its node, and which planet shows it.
const WANTED: [(&str, f64); 7] = [
    ("g5", 4.2422),
    ("g6", 28.278),
    ("g7", 3.0915),
    ("g8", 0.6735),
    ("s6", -26.328),
    ("s7", -2.9943),
    ("s8", -0.6919),
];

pub fn rows() -> Vec<Row> {
    let found = frequencies();
    let row = |(&(name, value), found): (&(&str, f64), f64)| Row {
        what: format!("{name} in arcseconds a year"),
        measured: found,
        uncertainty: 0.0,
        bar: Bar::Reference {
            value,
            good: 0.005,
            acceptable: 0.03,
        },
    };
    WANTED.iter().zip(found).map(row).collect()
}

type Series = Vec<Complex<f64>>;

/// g5, g6, g7, g8, s6, s7, s8 in arcseconds a year.
fn frequencies() -> [f64; 7] {
    let Some([apsides, nodes]) = series() else {
        return [f64::NAN; 7];
    };
    let first = |series: &Series| line(series).0;
    let (g5, g6, g8) = (first(&apsides[0]), first(&apsides[1]), first(&apsides[3]));
    // In the orbit of Uranus the fifth mode is as strong as its own.
    let (one, rest) = line(&apsides[2]);
    let other = first(&rest);
    let g7 = if (one - g5).abs() < (other - g5).abs() {
        other
    } else {
        one
    };
    let [s6, s7, s8] = [1, 2, 3].map(|k| first(&nodes[k]));
    [g5, g6, g7, g8, s6, s7, s8]
}

/// e exp(i varpi) and sin(i/2) exp(i Omega) of each planet; none if a planet is lost.
fn series() -> Option<[[Series; 4]; 2]> {
    let (mut star, mut planets) = outer_solar_system(0.0);
    let plane = invariable_plane(&star, &planets);
    let mut map = Jacobi::of(Scheme::default(), G, &star, &planets);
    let steps = (INTERVAL * YEAR / STEP).round() as u64;
    let looks = (SPAN / INTERVAL) as usize;
    let [mut apsides, mut nodes]: [[Series; 4]; 2] = Default::default();
    for _ in 0..looks {
        for (i, (apsis, node)) in apsides.iter_mut().zip(&mut nodes).enumerate() {
            let x = plane * (planets.x[i] - star.x[0]);
            let v = plane * (planets.v[i] - star.v[0]);
            let orbit = Elements::of(G * (star.m[0] + planets.m[i]), x, v)?;
            let pericentre = orbit.node + orbit.pericentre;
            apsis.push(Complex::from_polar(orbit.eccentricity, pericentre));
            let tilt = (0.5 * orbit.inclination).sin();
            node.push(Complex::from_polar(tilt, orbit.node));
        }
        map.advance(STEP, steps).ok()?;
        map.store(&mut star, &mut planets).ok()?;
    }
    Some([apsides, nodes])
}

/// Turns the angular momentum of all onto the z axis.
fn invariable_plane(star: &Bodies, planets: &Bodies) -> Rotation3<f64> {
    let of = |set: &Bodies| -> Vec3 {
        (0..set.m.len())
            .map(|i| set.x[i].cross(&set.v[i]) * set.m[i])
            .sum()
    };
    let momentum = of(star) + of(planets);
    Rotation3::rotation_between(&momentum, &Vec3::z()).unwrap_or_else(Rotation3::identity)
}

/// The frequency of the strongest line, and the series without it.
fn line(series: &Series) -> (f64, Series) {
    let amplitude = |frequency: f64| transform(series, frequency).norm();
    let half = (FASTEST / GRID) as i32;
    let strongest = (-half..=half)
        .map(|k| f64::from(k) * GRID)
        .map(|f| (f, amplitude(f)))
        .fold(
            (f64::NAN, 0.0),
            |most, one| {
                if one.1 > most.1 { one } else { most }
            },
        );
    let (mut lo, mut hi) = (strongest.0 - GRID, strongest.0 + GRID);
    for _ in 0..40 {
        let (a, b) = (lo + (hi - lo) / 3.0, hi - (hi - lo) / 3.0);
        if amplitude(a) < amplitude(b) {
            lo = a;
        } else {
            hi = b;
        }
    }
    let frequency = 0.5 * (lo + hi);
    let strength = transform(series, frequency);
    let samples = series.iter().enumerate();
    let rest =
        samples.map(|(k, z)| z - strength * Complex::from_polar(1.0, turn(frequency) * k as f64));
    (frequency, rest.collect())
}

/// Radians between two samples.
fn turn(frequency: f64) -> f64 {
    frequency * INTERVAL * TAU / 1_296_000.0
}

/// Amplitude at a frequency by Hann's window.
fn transform(series: &Series, frequency: f64) -> Complex<f64> {
    let n = series.len() as f64;
    let back = Complex::from_polar(1.0, -turn(frequency));
    let onwards = Complex::from_polar(1.0, TAU / n);
    let mut wave = Complex::new(1.0, 0.0);
    let mut window = Complex::from_polar(1.0, PI / n);
    let mut sum = Complex::new(0.0, 0.0);
    for z in series {
        sum += z * wave * (1.0 - window.re);
        wave *= back;
        window *= onwards;
    }
    sum / n
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_lines_are_told_apart() {
        let sample = |k: u32| {
            let at = |f: f64, phase: f64| Complex::from_polar(1.0, turn(f) * f64::from(k) + phase);
            at(4.2422, 1.0) * 0.037 + at(3.0915, 2.0) * 0.029 + at(-26.3, 0.5) * 1e-3
        };
        let series: Series = (0..10_000).map(sample).collect();
        let (first, rest) = line(&series);
        let (second, _) = line(&rest);
        // A step of the search is 0.05; the window's side lobes of the other line move a peak by 1e-4.
        let errors = [first - 4.2422, second - 3.0915].map(f64::abs);
        assert!(errors[0] < 4e-4 && errors[1] < 4e-4, "{errors:?}");
    }
}
