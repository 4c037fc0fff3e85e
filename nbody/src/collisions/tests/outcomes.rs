//! Bouncing and breaking: every outcome keeps mass, momentum, centre of mass and angular momentum, and its energy is told.

use std::collections::BTreeMap;

use super::*;
use rand::Rng;

const LIMITS: Limits = Limits {
    least: 1e-4,
    most: 40,
};

/// Bodies of density 3/4 pi, three times the reference.
const FRAGMENT: Law = Law::Fragment(
    Strength {
        offset: 1.9,
        coupling: 0.36,
        density: 0.25 / std::f64::consts::PI,
    },
    LIMITS,
);

fn bounce(normal: f64, tangential: f64) -> Law {
    Law::Bounce(Restitution { normal, tangential })
}

fn vector(random: &mut impl Rng) -> Vec3 {
    Vec3::from_fn(|_, _| random.random::<f64>() - 0.5)
}

/// Two random bodies that touched within the last step, far from the origin and in motion.
fn random_pair(seed: u64) -> Bodies {
    let mut random = random::stream(seed, Purpose::Orbits, 0, 0);
    let random = &mut random;
    let m = 10f64.powf(-2.0 * random.random::<f64>());
    let masses = [m, m * 10f64.powf(-1.7 * random.random::<f64>())];
    let radii = masses.map(f64::cbrt);
    let reach = radii[0] + radii[1];
    let escape = (2.0 * (masses[0] + masses[1]) / reach).sqrt();
    let n = vector(random).normalize();
    let side = n.cross(&vector(random)).normalize();
    let sine = random.random::<f64>();
    let speed = escape * 10f64.powf(-0.05 + 1.2 * random.random::<f64>().powi(2));
    let w = (side * sine - n * (1.0 - sine * sine).sqrt()) * speed;
    let d = n * reach + w * (0.02 * random.random::<f64>() * reach / speed);
    let (x, v) = (vector(random) * 5.0, vector(random) * 5.0);
    let mut bodies = set(&[
        (masses[0], radii[0], x.into(), v.into()),
        (masses[1], radii[1], (x + d).into(), (v + w).into()),
    ]);
    for i in 0..2 {
        bodies.spin[i] = vector(random) * (0.3 * masses[i] * radii[i] * radii[i] * escape);
        bodies.softening[i] = 0.3 * random.random::<f64>() * radii[i];
    }
    bodies.composition = vec![Vec3::new(0.1, 0.6, 0.3), Vec3::new(0.5, 0.4, 0.1)];
    bodies
}

/// Mass, momentum, moment, angular momentum, volume, materials; kinetic and mutual energy.
fn all_sums(bodies: &Bodies) -> ([f64; 14], f64) {
    let mut sums = [0.0; 14];
    let mut energy = 0.0;
    for i in 0..bodies.len() {
        let (m, x, v) = (bodies.m[i], bodies.x[i], bodies.v[i]);
        let turning = x.cross(&v) * m + bodies.spin[i];
        let parts = [v * m, x * m, turning, bodies.composition[i] * m];
        sums[0] += m;
        sums[1] += bodies.radius[i].powi(3);
        let rest = parts.iter().flat_map(|v| v.iter());
        sums[2..]
            .iter_mut()
            .zip(rest)
            .for_each(|(sum, x)| *sum += x);
        energy += 0.5 * m * v.norm_squared();
        for j in 0..i {
            let soft = bodies.softening[i].powi(2) + bodies.softening[j].powi(2);
            let r2 = (x - bodies.x[j]).norm_squared() + soft;
            energy -= m * bodies.m[j] / r2.sqrt();
        }
    }
    (sums, energy)
}

#[test]
fn every_outcome_keeps_its_sums_and_tells_its_energy() {
    let mut seen = BTreeMap::new();
    let laws = [
        Law::Merge,
        FRAGMENT,
        bounce(1.0, 1.0),
        bounce(0.5, 1.0),
        bounce(0.3, 0.6),
        bounce(0.0, -1.0),
    ];
    let mut worst = [0.0f64; 2];
    for law in laws {
        for seed in 0..600 {
            let mut bodies = random_pair(seed);
            let before = all_sums(&bodies);
            let events = collide_by(&law, &field(), &mut bodies, 0.1);
            assert_eq!(events.len(), 1, "{law:?} {seed}");
            let event = events[0];
            *seen.entry(event.kind.name()).or_insert(0) += 1;
            let after = all_sums(&bodies);
            for (a, b) in after.0.iter().zip(before.0) {
                worst[0] = worst[0].max((a - b).abs());
                assert!((a - b).abs() < 2e-14, "{law:?} {seed}: {a} {b}");
            }
            let scale = before.1.abs().max(after.1.abs()).max(0.1);
            let error = (after.1 + event.energy_lost - before.1).abs() / scale;
            worst[1] = worst[1].max(error);
            assert!(error < 3.3e-14, "{law:?} {seed}: {error:e}");
            let largest = bodies.m.iter().copied().fold(0.0, f64::max);
            assert_eq!(event.mass_largest, largest);
            let stays = usize::from(bodies.id.contains(&event.id_lost));
            assert_eq!(bodies.len(), 1 + stays + event.fragments);
        }
    }
    println!("{seen:?}, worst {worst:?}");
    assert!(
        seen.len() == 8 && seen.values().all(|&n| n >= 2),
        "{seen:?}"
    );
}

#[test]
fn pieces_are_clear_of_each_other_and_leave() {
    for seed in 0..600 {
        let mut bodies = random_pair(seed);
        let event = collide_by(&FRAGMENT, &field(), &mut bodies, 0.1)[0];
        let broken = event.fragments > 0 && event.kind != super::super::Kind::ErosiveHitAndRun;
        for i in 0..bodies.len() {
            assert!(bodies.m[i] >= LIMITS.least * (1.0 - 1e-9), "{seed}");
            for j in 0..i {
                let d = bodies.x[i] - bodies.x[j];
                let reach = bodies.radius[i] + bodies.radius[j];
                // Bodies that passed each other are where they touched, or farther.
                assert!(
                    d.norm() > reach * (1.0 - 1e-13),
                    "{seed}: {i} {j} {event:?}"
                );
            }
            if broken && i > 0 {
                let (d, w) = (bodies.x[i] - bodies.x[0], bodies.v[i] - bodies.v[0]);
                let total = event.mass_kept + event.mass_lost;
                let soft = 2.0 * bodies.softening[0].powi(2);
                let escape2 = 2.0 * total / (d.norm_squared() + soft).sqrt();
                let freely = 1.05f64.powi(2) - 1.0;
                let excess = (w.norm_squared() - escape2) / (freely * 2.0 * total / d.norm());
                assert!((excess - 1.0).abs() < 1e-9, "{seed}: {excess}");
                assert!((w.dot(&d) / (w.norm() * d.norm()) - 1.0).abs() < 1e-12);
            }
        }
    }
}

/// Two equal spheres of mass 1 and radius 1/2 at the end of a step in which they met at the origin, the second from +x with (-1, u, 0).
fn met(u: f64, since: f64) -> Bodies {
    let w = Vec3::new(-1.0, u, 0.0);
    let d = Vec3::x() + w * since;
    set(&[
        (1.0, 0.5, (d * -0.5).into(), (w * -0.5).into()),
        (1.0, 0.5, (d * 0.5).into(), (w * 0.5).into()),
    ])
}

fn free() -> Field {
    Field {
        self_gravity: false,
        ..field()
    }
}

#[test]
fn a_rebound_has_its_restitution_and_its_way_out() {
    for (e, since) in [(1.0, 0.25), (0.5, 0.25), (0.0, 0.1)] {
        let mut bodies = met(0.75, since);
        let event = collide_by(&bounce(e, 1.0), &free(), &mut bodies, 0.3)[0];
        let (d, w) = (bodies.x[1] - bodies.x[0], bodies.v[1] - bodies.v[0]);
        let after = Vec3::new(e, 0.75, 0.0);
        assert!((w - after).norm() < 1e-14, "{w}");
        assert!((d - Vec3::x() - after * since).norm() < 1e-14, "{d}");
        assert!((event.energy_lost - 0.25 * (1.0 - e * e)).abs() < 1e-15);
        assert!((event.time - 10.0 + since).abs() < 1e-14);
        // Without pull the speed is that of the run.
        assert!((event.speed - 1.25 / 2.0).abs() < 1e-14, "{}", event.speed);
        assert!((event.angle - 0.6f64.asin()).abs() < 1e-14);
        assert!(bodies.spin[0].norm() < 1e-16);
    }
}

#[test]
fn rough_spheres_turn_their_contact_points_round() {
    let mut bodies = met(0.75, 0.0);
    // Turned about z with 2 and 3: contact points move with 1 and 1.5 against each other.
    let inertia = 0.4 * 0.25;
    bodies.spin = vec![Vec3::z() * 2.0 * inertia, Vec3::z() * 3.0 * inertia];
    let slip = |bodies: &Bodies| {
        let w = bodies.v[1] - bodies.v[0];
        let turning = (bodies.spin[0] + bodies.spin[1]) * (0.5 / inertia);
        (w - turning.cross(&Vec3::x())).y
    };
    let kinetic = |bodies: &Bodies| {
        let of = |i: usize| {
            0.5 * bodies.v[i].norm_squared() + bodies.spin[i].norm_squared() / (2.0 * inertia)
        };
        of(0) + of(1)
    };
    let before = (slip(&bodies), kinetic(&bodies));
    assert!((before.0 - (0.75 - 2.5)).abs() < 1e-14);
    let mut half = bodies.clone();
    collide_by(&bounce(1.0, 0.5), &free(), &mut half, 0.1);
    assert!((slip(&half) - 0.5 * before.0).abs() < 1e-14);
    let event = collide_by(&bounce(1.0, -1.0), &free(), &mut bodies, 0.1)[0];
    assert!((slip(&bodies) + before.0).abs() < 1e-14);
    assert!((kinetic(&bodies) - before.1).abs() < 1e-14);
    // The orbits gained what the rotation lost, which the books count as heat given back.
    assert!(event.energy_lost != 0.0);
}

#[test]
fn an_elastic_rebound_keeps_the_energy_of_the_pull_too() {
    for seed in 0..300 {
        let mut bodies = random_pair(seed);
        let scale = bodies.m[1] * (bodies.v[1] - bodies.v[0]).norm_squared();
        let event = collide_by(&bounce(1.0, 1.0), &field(), &mut bodies, 0.1)[0];
        let error = (event.energy_lost / scale).abs();
        assert!(error < 1e-14, "{seed}: {error:e}");
    }
}

#[test]
fn bodies_that_lie_on_each_other_do_not_sink_in() {
    // They fall on each other at rest, with half the speed left after each bounce, by kicks and drifts.
    let mut bodies = set(&[
        (1.0, 0.5, [-0.6, 0.0, 0.0], [0.0; 3]),
        (1.0, 0.5, [0.6, 0.0, 0.0], [0.0; 3]),
    ]);
    let dt = 0.01;
    let (mut deepest, mut bounces) = (f64::INFINITY, 0);
    for _ in 0..2000 {
        let d = bodies.x[1] - bodies.x[0];
        let pull = d / d.norm().powi(3);
        bodies.v[0] += pull * dt;
        bodies.v[1] -= pull * dt;
        for i in 0..2 {
            let v = bodies.v[i];
            bodies.x[i] += v * dt;
        }
        bounces += collide_by(&bounce(0.5, 1.0), &field(), &mut bodies, dt).len();
        deepest = deepest.min((bodies.x[1] - bodies.x[0]).norm());
    }
    assert!(deepest > 1.0 - 1e-13, "{deepest}");
    assert!(bounces > 100 && bodies.len() == 2);
    assert!((bodies.x[1] - bodies.x[0]).norm() < 1.0 + 1e-3);
}

#[test]
fn the_order_in_memory_does_not_matter_to_any_outcome() {
    for law in [FRAGMENT, bounce(0.7, 0.5)] {
        let prepared = || {
            let mut bodies = swarm(3000);
            bodies.radius.iter_mut().for_each(|r| *r *= 2.0);
            bodies.v.iter_mut().for_each(|v| *v *= 3.0);
            // Rather light for their size, so that impacts are violent.
            bodies.m.iter_mut().for_each(|m| *m *= 10.0);
            bodies
        };
        let (mut one, mut other) = (prepared(), prepared());
        let order: Vec<u32> = (0..3000).map(|i| i * 1237 % 3000).collect();
        other.permute(&order, &mut Scratch::default());
        let events = collide_by(&law, &field(), &mut one, 0.05);
        assert!(events.len() > 100);
        assert_eq!(events, collide_by(&law, &field(), &mut other, 0.05));
        let by_id = |bodies: &Bodies| {
            let mut rows: Vec<_> = (0..bodies.len())
                .map(|i| (bodies.id[i], bodies.m[i], bodies.x[i].x, bodies.spin[i].z))
                .collect();
            rows.sort_by_key(|row| row.0);
            assert!(rows.windows(2).all(|pair| pair[0].0 < pair[1].0));
            rows
        };
        assert_eq!(by_id(&one), by_id(&other));
    }
}

#[test]
fn a_row_of_balls_hands_the_push_on() {
    // The first strikes two at rest that lie a gap apart; the last flies off with all of the speed.
    let ball = |x: f64, v: f64| (1.0, 0.5, [x, 0.0, 0.0], [v, 0.0, 0.0]);
    let mut bodies = set(&[ball(2.0, 4.0), ball(0.0, 0.0), ball(1.5, 0.0)]);
    let events = collide_by(&bounce(1.0, 1.0), &free(), &mut bodies, 1.0);
    assert_eq!(events.len(), 2);
    // From -2 it touches the second when at -1, the second the third after another half.
    let times = events.iter().map(|event| event.time - 9.0);
    for (time, wanted) in times.zip([0.25, 0.375]) {
        assert!((time - wanted).abs() < 1e-14, "{time}");
    }
    for (i, (x, v)) in [(-1.0, 0.0), (0.5, 0.0), (1.5 + 2.5, 4.0)]
        .into_iter()
        .enumerate()
    {
        assert!((bodies.x[i].x - x).abs() < 1e-14, "{i}: {}", bodies.x[i]);
        assert!((bodies.v[i].x - v).abs() < 1e-14, "{i}: {}", bodies.v[i]);
    }
}

#[test]
fn three_bodies_that_touch_in_one_step_keep_their_sums() {
    for law in [Law::Merge, FRAGMENT, bounce(0.5, 0.5)] {
        let mut more = 0;
        for seed in 0..100 {
            let mut bodies = random_pair(seed);
            bodies.resize(3);
            let v = bodies.v[0];
            // It is caught between the two.
            let way = bodies.v[1] - v;
            (bodies.id[2], bodies.m[2], bodies.radius[2]) = (3, 0.1, 0.1f64.cbrt());
            bodies.x[2] = (bodies.x[0] + bodies.x[1]) * 0.5;
            bodies.v[2] = v + way * 0.5;
            bodies.composition[2] = Vec3::y();
            let before = all_sums(&bodies);
            let events = collide_by(&law, &field(), &mut bodies, 0.1);
            more += usize::from(events.len() >= 2);
            for (a, b) in all_sums(&bodies).0.iter().zip(before.0) {
                assert!((a - b).abs() < 2e-14, "{law:?} {seed}: {a} {b}");
            }
        }
        assert!(more > 25, "{law:?}: {more}");
    }
}

#[test]
fn degenerate_pairs_have_a_finite_outcome() {
    let cases = [
        // One place, at rest and in motion; without mass; points; a ratio of 1e12.
        [(1.0, 0.5, 0.0, 0.0), (1.0, 0.5, 0.0, 0.0)],
        [(1.0, 0.5, 0.0, 0.0), (0.5, 0.5, 0.0, -9.0)],
        [(0.0, 0.5, 0.0, 0.0), (0.0, 0.5, 0.9, -1.0)],
        [(1.0, 0.5, 0.0, 0.0), (0.0, 0.5, 0.9, -1.0)],
        [(1.0, 0.5, 0.0, 0.0), (0.1, 0.0, 0.4, -9.0)],
        [(1.0, 1.0, 0.0, 0.0), (1e-12, 1e-4, 1.0, -20.0)],
    ];
    for law in [Law::Merge, FRAGMENT, bounce(0.5, 0.5), bounce(0.0, 0.0)] {
        for case in cases {
            let part =
                |(m, r, x, v): (f64, f64, f64, f64)| (m, r, [x, 0.0, 0.0], [v, 0.01 * v, 0.0]);
            let mut bodies = set(&case.map(part));
            bodies.composition = vec![Vec3::x(), Vec3::y()];
            let before = all_sums(&bodies).0;
            let events = collide_by(&law, &field(), &mut bodies, 1e-3);
            assert_eq!(events.len(), 1, "{law:?} {case:?}");
            let event = events[0];
            assert!(
                event.energy_lost.is_finite() && event.angle.is_finite(),
                "{event:?}"
            );
            assert_eq!(bodies.non_finite(), None, "{law:?} {case:?}");
            for (k, (a, b)) in all_sums(&bodies).0.iter().zip(before).enumerate() {
                // Massless bodies have volume, and take none along where they are lost.
                assert!((a - b).abs() < 1e-14, "{law:?} {case:?} {k}: {a} {b}");
            }
            if bodies.len() == 2 {
                let (d, w) = (bodies.x[1] - bodies.x[0], bodies.v[1] - bodies.v[0]);
                assert!(d.norm() >= bodies.radius[0] + bodies.radius[1] - 1e-12);
                assert!(d.dot(&w) >= -1e-9, "{law:?} {case:?} {w}");
            }
        }
    }
}

#[test]
fn new_bodies_have_new_ids_and_the_mixture_of_what_broke() {
    let mut violent = None;
    for seed in 0..600 {
        let mut bodies = random_pair(seed);
        let event = collide_by(&FRAGMENT, &field(), &mut bodies, 0.1)[0];
        let ids: Vec<u64> = bodies.id.iter().copied().filter(|&id| id > 2).collect();
        let wanted: Vec<u64> = (3..3 + event.fragments as u64).collect();
        assert_eq!(ids, wanted);
        if event.kind == super::super::Kind::ErosiveHitAndRun {
            // The lighter one broke; the heavier is as it was.
            assert!(
                bodies.composition[2..]
                    .iter()
                    .all(|c| *c == bodies.composition[1])
            );
            assert_eq!(bodies.composition[0], Vec3::new(0.1, 0.6, 0.3));
            violent = Some(seed);
        }
    }
    assert!(violent.is_some());
}
