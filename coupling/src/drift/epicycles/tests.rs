//! Bodies in a shearing box against the free motion, and their books.

use std::f64::consts::TAU;

use nbody::points::{Columns, Domain, Vec3};

use super::*;
use crate::drift::DriftBodies;
use crate::ledger::Census;
use crate::{Splitting, Unmetered};

/// Omega = 1, q = 1.5, oscillations through z = 1.
const MOTION: Epicycles = Epicycles {
    step: 0.1,
    vertical: 1.0,
    middle: 1.0,
};

fn frame() -> Domain {
    Domain::shearing(Vec3::new(4.0, 6.0, 2.0), 1.0, 1.5)
}

/// Bodies of unit mass at places with velocities relative to the shear.
fn system(states: &[(Vec3, Vec3)]) -> System {
    let mut system = System::new(frame(), 1.0, 0.0);
    let bodies = &mut system.bodies;
    bodies.resize(states.len());
    bodies.m.fill(1.0);
    for (i, &(x, w)) in states.iter().enumerate() {
        let stream = frame().hill().expect("a frame").stream(x);
        (bodies.x[i], bodies.v[i]) = (x, w + Vec3::y() * stream);
    }
    system.look();
    let census = Census::scaled(&system);
    system.ledger.open(census, 0.0);
    system
}

/// Carries the system on to `end`, and shows it at the end of each base step.
fn carry(system: &mut System, end: f64, mut see: impl FnMut(&System)) {
    let mut splitting = Splitting::new(vec![Box::new(DriftBodies::new(MOTION))]);
    while system.clock.time() < end {
        let meter = &mut Unmetered;
        let done = splitting.close(system, end, 0.23, meter);
        done.expect("steps are long");
        splitting.open(system, meter).expect("no operator refuses");
        while !system.clock.synchronous() {
            splitting.cross(system, meter).expect("a drift");
            if !system.clock.synchronous() {
                splitting.close(system, end, 0.23, meter).expect("a tick");
                splitting.open(system, meter).expect("a tick");
            }
        }
        see(system);
    }
}

/// The integral of Hill's problem without the planet.
fn integral(x: Vec3, v: Vec3) -> f64 {
    let hill = *frame().hill().expect("a frame");
    let tide = hill.shear * (hill.rate * (x.x - hill.middle)).powi(2);
    let height = MOTION.vertical * (x.z - MOTION.middle);
    0.5 * v.norm_squared() - tide + 0.5 * height * height
}

#[test]
fn an_epicycle_is_closed_after_a_hundred_orbits_and_keeps_its_integral() {
    // About the middle of the box, where guiding centres rest.
    let (x, w) = (Vec3::new(2.4, 3.0, 1.3), Vec3::new(0.3, -0.2, 0.1));
    let mut one = system(&[(x, w)]);
    let (x, v) = (one.bodies.x[0], one.bodies.v[0]);
    let (start, mut strayed, mut widest) = (integral(x, v), 0.0f64, 0.0f64);
    carry(&mut one, 100.0 * TAU, |system| {
        let (x, v) = (system.bodies.x[0], system.bodies.v[0]);
        strayed = strayed.max((integral(x, v) - start).abs());
        widest = widest.max((x.x - 2.0).abs());
    });
    let open = (one.bodies.x[0] - x)
        .norm()
        .max((one.bodies.v[0] - v).norm());
    println!("open by {open:e}, integral {start} strays by {strayed:e}, widest {widest}");
    // The epicycle of radius 1/2 has been gone round.
    assert!((widest - 0.5).abs() < 1e-3, "{widest}");
    // Twice what rounding makes in 11000 steps, most of it along y, where an error of the guiding centre grows.
    assert!(open < 3.7e-11 && strayed < 1.8e-13, "{open:e}, {strayed:e}");
}

#[test]
fn bodies_cross_the_faces_with_the_velocity_of_the_shear_beyond_and_the_books_close() {
    let states = [
        (Vec3::new(3.9, 5.9, 1.3), Vec3::new(0.8, 0.1, 0.3)),
        (Vec3::new(0.1, 0.2, 0.6), Vec3::new(-0.7, 0.4, -0.5)),
        (Vec3::new(2.7, 1.0, 1.0), Vec3::new(0.0, 0.6, 0.2)),
    ];
    let mut some = system(&states);
    let start: Vec<(Vec3, Vec3)> = (some.bodies.x.iter().copied())
        .zip(some.bodies.v.iter().copied())
        .collect();
    let (mut error, mut lost, mut jumps) = (0.0f64, 0.0f64, 0);
    let mut before: Vec<f64> = states.iter().map(|state| state.0.x).collect();
    carry(&mut some, 20.0, |system| {
        let t = system.clock.time();
        let domain = frame().at(t);
        let course = MOTION.over(&domain, t);
        for (i, &(x, v)) in start.iter().enumerate() {
            let (exact, fast) = course.of(x, v);
            let (x, v) = (system.bodies.x[i], system.bodies.v[i]);
            let apart = domain.nearest(x - exact);
            let faster = domain.relative(x, v) - domain.relative(exact, fast);
            error = error.max(apart.norm()).max(faster.norm());
            assert_eq!(domain.wrap(&mut x.clone()), Vec3::zeros(), "inside");
            jumps += usize::from((x.x - before[i]).abs() > 2.0);
            before[i] = x.x;
        }
        let books = system
            .ledger
            .report(t, Census::scaled(system), 0.0, &domain);
        lost = lost.max(books.error_momentum);
    });
    println!("{jumps} jumps, error {error:e}, momentum {lost:e}");
    assert!(jumps >= 8, "{jumps}");
    // Twice what rounding makes.
    assert!(error < 1.5e-13 && lost < 1.7e-15, "{error:e}, {lost:e}");
}

#[test]
fn what_is_seen_within_a_step_is_where_a_shorter_step_ends() {
    let states = [(Vec3::new(3.98, 5.9, 1.3), Vec3::new(0.8, 0.1, 0.3))];
    let (mut whole, mut ahead) = (system(&states), Ahead::default());
    // At its tick the clock stands before the bodies are moved.
    whole.clock.end = 0.05;
    whole.clock.tick = nbody::points::clock::TICKS;
    MOTION.predict(&whole, 0.05, &mut ahead).expect("a course");
    let mut motion = MOTION;
    motion.advance(&mut whole, 0.05).expect("a course");
    assert!(whole.bodies.x[0].x < 1.0, "it has crossed");
    assert_eq!((ahead.x, ahead.v), (whole.bodies.x, whole.bodies.v));
}
