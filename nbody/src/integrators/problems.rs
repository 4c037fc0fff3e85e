//! Star and bodies of the tests of the integrators.

use crate::bodies::{Bodies, Kind};
use crate::points::{Columns, Vec3};

pub fn set(kind: Kind, m: &[f64], x: &[[f64; 3]], v: &[[f64; 3]]) -> Bodies {
    let mut bodies = Bodies::default();
    bodies.resize(m.len());
    for i in 0..m.len() {
        bodies.id[i] = i as u64 + 1;
        bodies.m[i] = m[i];
        bodies.x[i] = Vec3::from(x[i]);
        bodies.v[i] = Vec3::from(v[i]);
        bodies.kind[i] = kind as u32;
    }
    bodies
}

/// A star at rest at the origin.
pub fn sun(m: f64) -> Bodies {
    set(Kind::Star, &[m], &[[0.0; 3]], &[[0.0; 3]])
}

/// A planet of mass `m` at distance `r` with a little more than the circular speed for G M = 1.
pub fn planet(m: f64, r: f64, inclined: f64) -> Bodies {
    let speed = 1.1 * (1.0 / r).sqrt();
    set(
        Kind::Planet,
        &[m],
        &[[r, 0.0, 0.0]],
        &[[0.0, speed, inclined * speed]],
    )
}

/// G in au, days, solar masses.
pub const GAUSS: f64 = 0.000_295_912_208_286;

/// Sun (with the inner planets) and Jupiter to Neptune in au and days (Hairer, Lubich & Wanner 2006, I.2.3).
pub fn outer_solar_system() -> (Bodies, Bodies) {
    let planets = set(
        Kind::Planet,
        &[
            0.000954786104043,
            0.000285583733151,
            4.37273164546e-05,
            5.17759138449e-05,
        ],
        &[
            [-3.5023653, -3.8169847, -1.5507963],
            [9.0755314, -3.0458353, -1.6483708],
            [8.310142, -16.2901086, -7.2521278],
            [11.4707666, -25.7294829, -10.8169456],
        ],
        &[
            [0.00565429, -0.0041249, -0.00190589],
            [0.00168318, 0.00483525, 0.00192462],
            [0.00354178, 0.00137102, 0.00055029],
            [0.0028893, 0.00114527, 0.00039677],
        ],
    );
    (sun(1.00000597682), planets)
}

/// Accelerations of point masses by each other, without softening.
pub fn direct(g: f64, m: &[f64], x: &[Vec3], a: &mut [Vec3]) {
    a.fill(Vec3::zeros());
    for i in 0..m.len() {
        for j in i + 1..m.len() {
            let d = x[j] - x[i];
            let r2 = d.norm_squared();
            let f = d * (g / (r2 * r2.sqrt()));
            a[i] += f * m[j];
            a[j] -= f * m[i];
        }
    }
}

/// Masses, positions and velocities of the star (first) and the bodies.
pub fn together(star: &Bodies, bodies: &Bodies) -> (Vec<f64>, Vec<Vec3>, Vec<Vec3>) {
    (
        [&star.m[..], &bodies.m[..]].concat(),
        [&star.x[..], &bodies.x[..]].concat(),
        [&star.v[..], &bodies.v[..]].concat(),
    )
}

pub fn energy_of(g: f64, m: &[f64], x: &[Vec3], v: &[Vec3]) -> f64 {
    (0..m.len())
        .map(|i| {
            let potential: f64 = (0..i).map(|j| -g * m[j] / (x[i] - x[j]).norm()).sum();
            m[i] * (0.5 * v[i].norm_squared() + potential)
        })
        .sum()
}

pub fn energy(g: f64, star: &Bodies, bodies: &Bodies) -> f64 {
    let (m, x, v) = together(star, bodies);
    energy_of(g, &m, &x, &v)
}

pub fn angular_momentum(star: &Bodies, bodies: &Bodies) -> Vec3 {
    let (m, x, v) = together(star, bodies);
    (0..m.len()).map(|i| x[i].cross(&v[i]) * m[i]).sum()
}
