//! Merging and accretion: what is kept, what is told, and in which order.

mod outcomes;

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use super::*;
use crate::encounters::Finder;
use crate::orbit::Elements;
use crate::points::Domain;
use crate::points::random::{self, Purpose};
use crate::points::{Columns, Scratch};
use rand::RngExt;

/// Bodies of mass m and radius r at x with velocity v, ids 1, 2, ...
fn set(parts: &[(f64, f64, [f64; 3], [f64; 3])]) -> Bodies {
    let mut bodies = Bodies::default();
    bodies.resize(parts.len());
    for (i, &(m, radius, x, v)) in parts.iter().enumerate() {
        bodies.id[i] = i as u64 + 1;
        (bodies.m[i], bodies.radius[i]) = (m, radius);
        (bodies.x[i], bodies.v[i]) = (x.into(), v.into());
    }
    bodies
}

fn field() -> Field {
    Field {
        domain: Domain::open(),
        g: 1.0,
        self_gravity: true,
        now: 10.0,
    }
}

/// Does what the law says to the bodies that touch in the step of `dt` that ends now.
fn collide_by(law: &Law, field: &Field, bodies: &mut Bodies, dt: f64) -> Vec<Collision> {
    let mut finder = Finder::default();
    let encounters = finder.encounters(bodies, &field.domain, dt).to_vec();
    let mut next_id = bodies.id.iter().max().map_or(0, |id| id + 1);
    let outcome = super::collide(bodies, &encounters, law, field, &mut next_id);
    bodies.retain(&outcome.keep);
    outcome.events
}

fn collide(bodies: &mut Bodies, dt: f64) -> Vec<Collision> {
    collide_by(&Law::Merge, &field(), bodies, dt)
}

fn swarm(n: u32) -> Bodies {
    let parts: Vec<_> = (1..=n)
        .map(|i| {
            let mut random = random::stream(1, Purpose::Orbits, u64::from(i), 0);
            let mut spread = || random.random::<f64>() - 0.5;
            let mut vector = || [spread(), spread(), spread()];
            let (x, v) = (vector(), vector());
            let [m, r, _] = vector();
            (1e-4 * (1.0 + m), 0.01 * (1.0 + r), x, v)
        })
        .collect();
    set(&parts)
}

/// Mass, momentum, moment and volume.
fn sums(bodies: &Bodies) -> [f64; 8] {
    let mut sums = [0.0; 8];
    for i in 0..bodies.x.len() {
        let (m, x, v) = (bodies.m[i], bodies.x[i], bodies.v[i]);
        let terms = [
            m,
            m * v.x,
            m * v.y,
            m * v.z,
            m * x.x,
            m * x.y,
            m * x.z,
            bodies.radius[i].powi(3),
        ];
        sums.iter_mut()
            .zip(terms)
            .for_each(|(sum, term)| *sum += term);
    }
    sums
}

#[test]
fn merging_keeps_mass_momentum_centre_and_volume() {
    let mut bodies = swarm(3000);
    let before = sums(&bodies);
    let events = collide(&mut bodies, 0.05);
    assert!(events.len() > 100 && bodies.len() + events.len() == 3000);
    assert!(
        events.iter().any(|e| e.mass_kept > 1.6e-4),
        "none merged twice"
    );
    assert!(events.is_sorted_by(|a, b| a.time <= b.time));
    for (a, b) in sums(&bodies).iter().zip(before) {
        assert!((a - b).abs() < 1e-15, "{a} {b}");
    }
}

#[test]
fn the_order_in_memory_does_not_matter() {
    // Without a step all impacts are at once, and the ids alone decide.
    for dt in [0.0, 0.05] {
        let (mut one, mut other) = (swarm(3000), swarm(3000));
        one.radius.iter_mut().for_each(|r| *r *= 2.0);
        other.radius.clone_from(&one.radius);
        let order: Vec<u32> = (0..3000).map(|i| i * 1237 % 3000).collect();
        other.permute(&order, &mut Scratch::default());
        assert_eq!(collide(&mut one, dt), collide(&mut other, dt));
    }
}

#[test]
fn a_parabolic_impact_has_the_escape_speed_and_its_angle() {
    // From rest at infinity: w^2 = 2 G M/d. Two equal bodies touching at 45 degrees.
    let w = 2f64.sqrt() / 0.02f64.sqrt() * 2e-3f64.sqrt();
    let part = w * 0.5f64.sqrt();
    let d = 0.02 * (1.0 - 1e-9);
    let mut bodies = set(&[
        (1e-3, 0.01, [0.0; 3], [0.0; 3]),
        (1e-3, 0.01, [d, 0.0, 0.0], [-part, part, 0.0]),
    ]);
    let event = collide(&mut bodies, 1e-9)[0];
    assert!((event.speed - 1.0).abs() < 1e-8 && (event.angle - FRAC_PI_4).abs() < 1e-8);
    assert!(event.energy_lost.abs() < 1e-12);
    // Half the mass each: reduced mass 5e-4.
    assert!((bodies.spin[0].z - 5e-4 * d * part).abs() < 1e-18);
}

#[test]
fn energy_and_angular_momentum_of_an_isolated_pair_are_in_the_event() {
    let mut bodies = set(&[
        (2.0, 0.5, [0.1, 0.2, 0.3], [0.3, -0.2, 0.1]),
        (1.0, 0.4, [0.7, 0.3, 0.1], [-0.4, 0.5, 0.2]),
    ]);
    let sums = |b: &Bodies| {
        let kinetic: f64 = (0..b.len())
            .map(|i| 0.5 * b.m[i] * b.v[i].norm_squared())
            .sum();
        let spin: Vec3 = (0..b.len()).map(|i| b.x[i].cross(&b.v[i]) * b.m[i]).sum();
        (kinetic, spin)
    };
    let potential = -2.0 / (bodies.x[0] - bodies.x[1]).norm();
    let before = sums(&bodies);
    let event = collide(&mut bodies, 0.01)[0];
    let after = sums(&bodies);
    assert!((before.0 + potential - after.0 - event.energy_lost).abs() < 1e-15);
    assert!((before.1 - after.1 - bodies.spin[0]).norm() < 1e-15);
    assert_eq!(
        (event.id_kept, event.mass_kept, event.mass_lost),
        (1, 2.0, 1.0)
    );
}

#[test]
fn a_bullet_through_three_bodies_merges_with_each_in_its_turn() {
    // It passed the three between x = 0 and 2 in the last step; each merging slows it down.
    let still = |x: f64| (1e-9, 1e-3, [x, 0.0, 0.0], [0.0; 3]);
    let bullet = (1.0, 0.1, [4.0, 0.0, 0.0], [5.0, 0.0, 0.0]);
    let mut bodies = set(&[still(2.0), still(0.0), still(1.0), bullet]);
    let events = collide(&mut bodies, 1.0);
    let lost: Vec<u64> = events.iter().map(|e| e.id_lost).collect();
    assert_eq!(lost, [2, 3, 1]);
    for (event, x) in events.iter().zip([0.0, 1.0, 2.0]) {
        // From x = 4 back to the sum of radii before the target.
        assert!(
            (event.time - (10.0 - (4.101 - x) / 5.0)).abs() < 3e-8,
            "{event:?}"
        );
        assert!(event.angle < 1e-9);
    }
}

#[test]
fn an_impact_is_dropped_if_the_first_one_stops_the_body() {
    // Two equal bodies meet head-on at x = -0.5 and stop; the third lies farther along the path of the first.
    let mut bodies = set(&[
        (1.0, 0.1, [2.0, 0.0, 0.0], [4.0, 0.0, 0.0]),
        (1.0, 0.1, [-3.0, 0.0, 0.0], [-4.0, 0.0, 0.0]),
        (1.0, 0.1, [1.5, 0.0, 0.0], [0.0; 3]),
    ]);
    let events = collide(&mut bodies, 1.0);
    assert_eq!((events.len(), bodies.len()), (1, 2));
    assert!((bodies.x[0].x + 0.5).abs() < 1e-15 && bodies.v[0].norm() < 1e-15);
}

#[test]
fn planets_keep_their_identity_then_the_heavier_then_the_older() {
    let near = [0.01, 0.0, 0.0];
    let survivor = |a: (f64, crate::Kind), b: (f64, crate::Kind)| {
        let mut bodies = set(&[(a.0, 0.1, [0.0; 3], [0.0; 3]), (b.0, 0.1, near, [0.0; 3])]);
        bodies.kind = vec![a.1 as u32, b.1 as u32];
        collide(&mut bodies, 0.1)[0].id_kept
    };
    let (planet, small) = (crate::Kind::Planet, crate::Kind::Planetesimal);
    assert_eq!(survivor((5.0, small), (1.0, planet)), 2);
    assert_eq!(survivor((1.0, small), (2.0, small)), 2);
    assert_eq!(survivor((1.0, small), (1.0, small)), 1);
    assert_eq!(survivor((0.0, small), (0.0, small)), 1);
}

#[test]
fn a_pair_across_a_periodic_face_merges_there() {
    let domain = Domain::periodic(Vec3::repeat(1.0));
    let mut bodies = set(&[
        (1.0, 0.1, [0.95, 0.5, 0.5], [0.0; 3]),
        (3.0, 0.1, [0.05, 0.5, 0.5], [0.0; 3]),
    ]);
    let field = Field { domain, ..field() };
    collide_by(&Law::Merge, &field, &mut bodies, 0.1);
    assert_eq!(bodies.id, [2]);
    assert!((bodies.x[0].x - 0.025).abs() < 1e-15);
}

#[test]
fn the_star_takes_what_is_inside_and_what_passed_through() {
    let mut star = set(&[(1.0, 0.05, [0.0; 3], [0.0; 3])]);
    star.id[0] = 100;
    star.spin[0] = Vec3::z();
    let orbit = |e: f64, mean_anomaly: f64| Elements {
        semi_major_axis: 1.0,
        eccentricity: e,
        inclination: 0.2,
        node: 0.3,
        pericentre: 0.4,
        mean_anomaly,
    };
    // Pericentres at 0.04 (inside) and 0.06; 0.1 and 0.3 after the pericentre, and 0.1 before it.
    let orbits = [
        orbit(0.96, 0.1),
        orbit(0.96, 0.3),
        orbit(0.96, -0.1),
        orbit(0.94, 0.1),
    ];
    let mut bodies = set(&[(1e-6, 0.0, [0.0; 3], [0.0; 3]); 5]);
    for (i, orbit) in orbits.iter().enumerate() {
        (bodies.x[i], bodies.v[i]) = orbit.state(1.0 + 1e-6);
    }
    bodies.x[4] = Vec3::new(0.03, 0.0, 0.0);
    let momentum: Vec3 = bodies.v[0] * 1e-6 + bodies.v[4] * 1e-6;
    let outcome = accrete(&mut star, &bodies, 1.0, 7.0, 0.2);
    assert_eq!(outcome.keep, [false, true, true, true, false]);
    assert_eq!(
        outcome.events.iter().map(|e| e.id_lost).collect::<Vec<_>>(),
        [1, 5]
    );
    assert!((outcome.events[0].time - 6.9).abs() < 1e-6);
    assert!((star.m[0] - 1.000002).abs() < 1e-15 && star.radius[0] == 0.05);
    assert!((star.v[0] * star.m[0] - momentum).norm() < 1e-18);
    let orbits = (0..5).filter(|&i| !outcome.keep[i]);
    let momenta = orbits.fold(Vec3::z(), |sum, i| {
        sum + bodies.x[i].cross(&bodies.v[i]) * 1e-6
    });
    let left = star.x[0].cross(&star.v[0]) * star.m[0] + star.spin[0];
    assert!((left - momenta).norm() < 1e-15);
    // At the star's surface on an orbit of a = 1: v^2 = 2 (1/0.05 - 1/2); the pericentre is close below.
    let event = outcome.events[0];
    assert!((event.speed - (1.0f64 - 0.025).sqrt()).abs() < 1e-5 && event.angle < FRAC_PI_2);
    star.radius[0] = 0.0;
    assert!(accrete(&mut star, &bodies, 1.0, 7.0, 0.2).events.is_empty());
}
