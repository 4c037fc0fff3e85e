//! The Wisdom-Holman drift on problems with known ends.

use super::*;
use crate::integrators::problems::*;
use crate::integrators::{central, kick};
use crate::kepler;
use crate::orbit::Elements;
use crate::points::Columns;

/// Kick, drift, kick with the bodies' pulls on each other taken directly.
fn steps(star: &mut Bodies, bodies: &mut Bodies, g: f64, dt: f64, n: usize) {
    for _ in 0..n {
        direct(g, &bodies.m, &bodies.x, &mut bodies.a);
        kick(&mut bodies.v, &bodies.a, 0.5 * dt);
        drift(star, bodies, g, dt).expect("orbits");
        direct(g, &bodies.m, &bodies.x, &mut bodies.a);
        kick(&mut bodies.v, &bodies.a, 0.5 * dt);
    }
}

/// Largest relative error of the energy, looked at every `every` steps.
fn outer_solar_system_error(dt: f64, n: usize, every: usize) -> f64 {
    let (mut star, mut bodies) = outer_solar_system();
    let start = energy(GAUSS, &star, &bodies);
    (0..n / every).fold(0.0, |most, _| {
        steps(&mut star, &mut bodies, GAUSS, dt, every);
        let error = (energy(GAUSS, &star, &bodies) / start - 1.0).abs();
        if error > most || error.is_nan() {
            error
        } else {
            most
        }
    })
}

#[test]
fn the_outer_solar_system_keeps_its_energy() {
    // 1e4 yr at 100 days.
    let error = outer_solar_system_error(100.0, 36_525, 7);
    assert!(error < 1.5e-6, "{error:e}");
    let error = outer_solar_system_error(0.1186 * 365.25, 36_525, 7);
    assert!(error < 3e-7, "{error:e}");
}

#[test]
fn the_error_falls_with_the_square_of_the_step() {
    let (coarse, fine) = (
        outer_solar_system_error(200.0, 1000, 1),
        outer_solar_system_error(100.0, 2000, 2),
    );
    let order = (coarse / fine).log2();
    assert!((order - 2.0).abs() < 0.1, "order {order}");
}

#[test]
fn a_massless_body_stays_on_its_exact_orbit() {
    let (mut star, mut bodies) = (sun(1.0), planet(0.0, 1.0, 0.2));
    let orbit = Elements {
        semi_major_axis: 1.0,
        eccentricity: 0.9,
        inclination: 0.3,
        node: 1.0,
        pericentre: 2.0,
        mean_anomaly: 0.5,
    };
    star.v[0] = Vec3::new(0.01, 0.02, 0.03);
    (bodies.x[0], bodies.v[0]) = orbit.state(1.0);
    bodies.v[0] += star.v[0];
    for _ in 0..1000 {
        drift(&mut star, &mut bodies, 1.0, 0.05).expect("an orbit");
    }
    let mean_anomaly = orbit.mean_anomaly + 50.0;
    let (x, v) = Elements {
        mean_anomaly,
        ..orbit
    }
    .state(1.0);
    let error = (bodies.x[0] - star.x[0] - x).norm() + (bodies.v[0] - star.v[0] - v).norm();
    assert!(error < 1e-11, "{error:e}");
}

#[test]
fn a_heavy_planet_on_a_long_ellipse_stays_bounded() {
    let (mut star, mut bodies) = (sun(1.0), planet(1e-3, 1.0, 0.2));
    let orbit = Elements {
        semi_major_axis: 1.0,
        eccentricity: 0.9,
        inclination: 0.3,
        node: 1.0,
        pericentre: 2.0,
        mean_anomaly: 3.0,
    };
    (bodies.x[0], bodies.v[0]) = orbit.state(1.001);
    let start = energy(1.0, &star, &bodies);
    // A twentieth of the pericentre passage.
    let dt = time_step(&star, &bodies, 1.0, 0.05);
    assert!((dt / (0.05 * TAU * (1e-3f64 / 1.9).sqrt()) - 1.0).abs() < 1e-2);
    let mut most = 0f64;
    for _ in 0..10_000 {
        steps(&mut star, &mut bodies, 1.0, dt, 1);
        most = most.max((energy(1.0, &star, &bodies) / start - 1.0).abs());
    }
    assert!(most < 1.5e-4, "{most:e}");
}

#[test]
fn the_map_run_backwards_returns() {
    let (mut star, mut bodies) = outer_solar_system();
    let (x, v) = (bodies.x.clone(), bodies.v.clone());
    steps(&mut star, &mut bodies, GAUSS, 100.0, 1000);
    steps(&mut star, &mut bodies, GAUSS, -100.0, 1000);
    for i in 0..x.len() {
        let error =
            (bodies.x[i] - x[i]).norm() / x[i].norm() + (bodies.v[i] - v[i]).norm() / v[i].norm();
        assert!(error < 4e-12, "{error:e}");
    }
}

#[test]
fn momentum_and_angular_momentum_are_kept() {
    let (mut star, mut bodies) = outer_solar_system();
    let momentum = |star: &Bodies, bodies: &Bodies| {
        let (m, _, v) = together(star, bodies);
        m.iter().zip(v).map(|(m, v)| v * *m).sum::<Vec3>()
    };
    let (p, l) = (momentum(&star, &bodies), angular_momentum(&star, &bodies));
    steps(&mut star, &mut bodies, GAUSS, 100.0, 1000);
    let size: f64 = bodies
        .m
        .iter()
        .zip(&bodies.v)
        .map(|(m, v)| m * v.norm())
        .sum();
    let linear = (momentum(&star, &bodies) - p).norm() / size;
    let angular = (angular_momentum(&star, &bodies) - l).norm() / l.norm();
    assert!(linear < 4e-14 && angular < 4e-15, "{linear:e} {angular:e}");
}

#[test]
fn prediction_is_the_drift_without_the_change() {
    let (mut star, mut bodies) = outer_solar_system();
    let mut ahead = Ahead::default();
    predict(&star, &bodies, GAUSS, 70.0, &mut ahead).expect("orbits");
    drift(&mut star, &mut bodies, GAUSS, 70.0).expect("orbits");
    assert_eq!((ahead.x, ahead.v), (bodies.x, bodies.v));
    assert_eq!((ahead.x_star, ahead.v_star), (star.x[0], star.v[0]));
}

fn belt(n: u32) -> Bodies {
    let mut bodies = Bodies::default();
    bodies.resize(n as usize);
    let f = |i: u32, k: f64| (f64::from(i) * k).fract();
    for i in 0..n {
        let orbit = Elements {
            semi_major_axis: 0.5 + f(i, 0.618_034),
            eccentricity: 0.5 * f(i, 0.414_214),
            inclination: 0.1 * f(i, 0.732_051),
            node: TAU * f(i, 0.236_068),
            pericentre: TAU * f(i, 0.645_751),
            mean_anomaly: TAU * f(i, 0.316_625),
        };
        let i = i as usize;
        (bodies.x[i], bodies.v[i]) = orbit.state(1.0);
        bodies.m[i] = 1e-8;
    }
    bodies
}

#[test]
fn the_same_bits_come_out_for_any_number_of_threads() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let (mut star, mut bodies) = (sun(1.0), belt(5000));
        pool.expect("a pool").install(|| {
            for _ in 0..3 {
                drift(&mut star, &mut bodies, 1.0, 0.1).expect("orbits");
            }
        });
        (star.x, star.v, bodies.x, bodies.v)
    };
    let one = run(1);
    assert!(one == run(2) && one == run(7));
}

#[test]
fn a_body_in_the_star_is_told_by_its_place() {
    let (mut star, mut bodies) = (sun(1.0), belt(2000));
    bodies.x[1234] = Vec3::zeros();
    bodies.x[1777] = Vec3::zeros();
    bodies.m.fill(0.0);
    let refusal = kepler::Refusal::Centre;
    let stuck = drift(&mut star, &mut bodies, 1.0, 0.1);
    assert_eq!(
        stuck,
        Err(Stuck {
            place: 1234,
            refusal
        })
    );
}

#[test]
fn many_bodies_follow_a_leapfrog_of_tiny_steps() {
    let (mut star, mut bodies) = (sun(1.0), belt(600));
    let (mut other, mut slow) = (star.clone(), bodies.clone());
    drift(&mut star, &mut bodies, 1.0, 0.05).expect("orbits");
    for _ in 0..1000 {
        let pulls = |star: &mut Bodies, bodies: &mut Bodies| {
            bodies.a.fill(Vec3::zeros());
            central::pull(1.0, star, &bodies.x, &mut bodies.a);
            star.a[0] = central::reaction(1.0, star, &bodies.m, &bodies.x);
            kick(&mut bodies.v, &bodies.a, 2.5e-5);
            kick(&mut star.v, &star.a, 2.5e-5);
        };
        pulls(&mut other, &mut slow);
        leapfrog::drift(&mut other, 5e-5);
        leapfrog::drift(&mut slow, 5e-5);
        pulls(&mut other, &mut slow);
    }
    let errors = bodies.x.iter().zip(&slow.x).map(|(a, b)| (a - b).norm());
    let most = errors.fold(0.0, f64::max);
    assert!(most < 3e-9, "{most:e}");
    assert!((star.x[0] - other.x[0]).norm() < 3e-16);
}
