//! The hybrid map on encounters with known ends.

use std::f64::consts::TAU;

use super::*;
use crate::bodies::Kind;
use crate::gravity::{Accuracy, Method, Settings};
use crate::integrators::gauss_radau::GaussRadau;
use crate::integrators::problems::*;
use crate::points::Columns;

fn map(dt: f64, touching: bool) -> Map {
    Map {
        hybrid: Hybrid::new(Cutoff::default(), dt, touching),
        soft: soft::Soft::new(Settings {
            accuracy: Accuracy::ForceError(1e-3),
            method: Method::Tree,
            constant: 1.0,
        }),
        g: 1.0,
        dt,
    }
}

/// Two bodies of masses `m` on neighbouring circles, the inner one about to overtake the outer one.
fn overtaking(m: [f64; 2]) -> (Bodies, Bodies) {
    let (outer, lead) = (1.02f64, 0.1f64);
    let speed = (1.0 / outer).sqrt();
    let bodies = set(
        Kind::Planetesimal,
        &m,
        &[
            [1.0, 0.0, 0.0],
            [outer * lead.cos(), outer * lead.sin(), 1e-3],
        ],
        &[
            [0.0, 1.0, 0.0],
            [-speed * lead.sin(), speed * lead.cos(), 0.0],
        ],
    );
    (sun(1.0), bodies)
}

fn forward(star: &mut Bodies, bodies: &mut Bodies, dt: f64, steps: usize) -> f64 {
    let mut map = map(dt, false);
    let start = energy(1.0, star, bodies);
    map.prepare(star, bodies);
    let mut most = 0.0;
    for _ in 0..steps {
        map.step(star, bodies).expect("a way");
        let error = (energy(1.0, star, bodies) / start - 1.0).abs();
        most = if error > most || error.is_nan() {
            error
        } else {
            most
        };
    }
    most
}

/// Distance of the two bodies from where Gauss-Radau for the whole takes them.
fn miss(m: [f64; 2], dt: f64) -> f64 {
    let (mut star, mut bodies) = overtaking(m);
    let mut radau = GaussRadau::of(0.0, &star, &bodies);
    let steps = (12.0 / dt).round() as usize;
    forward(&mut star, &mut bodies, dt, steps);
    let (masses, ..) = together(&star, &bodies);
    let end = dt * steps as f64;
    radau
        .advance_to(end, |x, a| direct(1.0, &masses, x, a))
        .expect("a way");
    let misses = bodies.x.iter().zip(&radau.x()[1..]);
    misses.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

#[test]
fn an_encounter_leaves_the_bodies_where_gauss_radau_does() {
    // They pass each other at 1/40 of their Hill radius.
    let misses = [0.03, 0.015, 0.0075].map(|dt| miss([1e-6, 2e-6], dt));
    for pair in misses.windows(2) {
        assert!(
            ((pair[0] / pair[1]).log2() - 2.05).abs() < 0.1,
            "{misses:?}"
        );
    }
    assert!(misses[2] < 1e-7, "{misses:?}");
}

#[test]
fn a_body_without_mass_passes_a_planet_as_gauss_radau_takes_it() {
    for light in [0.0, 1e-17] {
        let misses = [0.03, 0.015, 0.0075].map(|dt| miss([light, 1e-5], dt));

        for pair in misses.windows(2) {
            assert!(((pair[0] / pair[1]).log2() - 2.0).abs() < 0.1, "{misses:?}");
        }
        assert!(misses[2] < 1.4e-6, "{misses:?}");
    }
}

#[test]
fn the_energy_error_falls_with_the_square_of_the_step() {
    let error = |dt: f64| {
        let (mut star, mut bodies) = overtaking([1e-5, 2e-5]);
        forward(&mut star, &mut bodies, dt, (12.0 / dt) as usize)
    };
    let (coarse, fine) = (error(0.04), error(0.02));
    let order = (coarse / fine).log2();
    assert!((order - 2.0).abs() < 0.1 && fine < 4e-8, "{order} {fine:e}");
}

/// A dense ring in which many meet.
fn ring(n: u32, mass: f64, radius: f64) -> (Bodies, Bodies) {
    let f = |i: u32, k: f64| (f64::from(i) * k).fract();
    let mut bodies = Bodies::default();
    bodies.resize(n as usize);
    for i in 0..n {
        let place = i as usize;
        let (r, angle) = (1.0 + 0.1 * f(i, 0.618_034), TAU * f(i, 0.414_214));
        let speed = (1.0 / r).sqrt() * (1.0 + 0.01 * (f(i, 0.732_051) - 0.5));
        bodies.id[place] = u64::from(n - i);
        bodies.m[place] = mass;
        bodies.radius[place] = radius;
        bodies.x[place] = Vec3::new(r * angle.cos(), r * angle.sin(), 0.005 * f(i, 0.236_068));
        bodies.v[place] = Vec3::new(-angle.sin(), angle.cos(), 0.0) * speed;
    }
    (sun(1.0), bodies)
}

#[test]
fn the_same_bits_come_out_for_any_number_of_threads() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(|| {
            let (mut star, mut bodies) = ring(4000, 1e-8, 2e-5);
            let mut map = map(0.02, true);
            map.prepare(&star, &mut bodies);
            let mut touches = Vec::new();
            for _ in 0..4 {
                map.step(&mut star, &mut bodies).expect("a way");
                touches.extend(map.hybrid.touches.iter().copied());
            }
            assert!(map.hybrid.clustered().0 > 200);
            (bodies.x, bodies.v, star.x, touches)
        })
    };
    let one = run(1);
    for threads in [2, 7] {
        assert_eq!(run(threads), one);
    }
}

#[test]
fn a_step_begun_with_fresh_buffers_gives_the_same_bits() {
    let (mut star, mut bodies) = ring(3000, 1e-9, 2e-5);
    let mut whole = map(0.02, true);
    whole.prepare(&star, &mut bodies);
    whole.step(&mut star, &mut bodies).expect("a way");
    let (mut other_star, mut other) = (star.clone(), bodies.clone());
    whole.step(&mut star, &mut bodies).expect("a way");
    map(0.02, true)
        .step(&mut other_star, &mut other)
        .expect("a way");
    assert_eq!((bodies.x, bodies.v), (other.x, other.v));
}

#[test]
fn two_that_fall_on_each_other_stop_at_their_touch_with_their_energy() {
    let m = [3e-6, 1e-6];
    let (mut star, mut bodies) = (
        sun(1.0),
        set(
            Kind::Planetesimal,
            &m,
            &[[1.0, 0.0, 0.0], [1.001, 0.0, 0.0]],
            &[[0.0, 1.0, 0.0], [-0.02, 1.0, 0.0]],
        ),
    );
    bodies.radius = vec![2e-4, 1e-4];
    let start = energy(1.0, &star, &bodies);
    let mut map = map(0.05, true);
    map.prepare(&star, &mut bodies);
    map.step(&mut star, &mut bodies).expect("a way");
    let touches = map.hybrid.touches.clone();
    assert_eq!(touches.len(), 1);
    assert_eq!(touches[0].pair, [0, 1]);
    assert!(touches[0].time > -0.05 && touches[0].time < -0.01);
    let d = (bodies.x[1] - bodies.x[0]).norm();
    assert!((d / 3e-4 - 1.0).abs() < 1e-8, "{d:e}");
    // In falling from 1e-3 to 3e-4 they gained more than a hundred times this.
    let error = (energy(1.0, &star, &bodies) - start).abs() / (0.5 * 0.75e-6 * 4e-4);
    assert!(error < 2.7e-6, "{error:e}");
}

#[test]
fn bodies_at_the_same_place_go_as_one() {
    let (mut star, mut bodies) = overtaking([1e-6, 1e-6]);
    (bodies.x[1], bodies.v[1]) = (bodies.x[0], bodies.v[0]);
    forward(&mut star, &mut bodies, 0.05, 20);
    let (mut other, mut one) = overtaking([2e-6, 0.0]);
    one.x[1] = -one.x[1];
    one.v[1] = -one.v[1];
    forward(&mut other, &mut one, 0.05, 20);
    assert_eq!(bodies.x[0], bodies.x[1]);
    let apart = (bodies.x[0] - one.x[0]).norm();
    assert!(apart < 4e-16, "{apart:e}");
}

#[test]
fn hard_and_soft_force_of_a_pair_are_newtons_together() {
    let (g, eps2) = (2.0, 1e-4);
    let mut group = group::Group::default();
    group.begin(1.0, g);
    for cutoff in [0.3, 0.4] {
        group.add(Member {
            m: 1.0,
            eps2: 0.5 * eps2,
            cutoff,
            ..Member::default()
        });
    }
    for k in 1..60 {
        let r2 = (0.01 * f64::from(k)).powi(2);
        let both = group.pull(0, 1, r2) + soft::soft_pull(g, r2, eps2, 0.4);
        let newton = g / (r2 + eps2).powf(1.5);
        assert!((both / newton - 1.0).abs() < 1e-14, "{r2}");
    }
}

/// Root mean square error, in units of the root mean square, of the soft field of `n` bodies with a planet and softening.
fn field_error(n: u32) -> f64 {
    let (star, mut bodies) = ring(n, 1e-8, 2e-5);
    (bodies.kind[7], bodies.m[7]) = (Kind::Planet as u32, 1e-5);
    // Every 50th with a wide cut-off, so that many are within.
    (0..n as usize).step_by(50).for_each(|i| bodies.m[i] = 1e-6);
    for i in 0..n as usize / 2 {
        bodies.softening[i] = 1e-4;
    }
    let mut map = map(0.02, true);
    map.soft = soft::Soft::new(Settings {
        accuracy: Accuracy::ForceError(1e-4),
        method: Method::Tree,
        constant: 1.0,
    });
    map.prepare(&star, &mut bodies);
    let (mut error, mut all) = (0.0, 0.0);
    for i in 0..n as usize {
        let mut sum = Vec3::zeros();
        for j in 0..n as usize {
            let d = bodies.x[j] - bodies.x[i];
            let eps2 = bodies.softening[i].powi(2) + bodies.softening[j].powi(2);
            let cutoff = bodies.cutoff[i].max(bodies.cutoff[j]);
            sum += d * (soft::soft_pull(1.0, d.norm_squared(), eps2, cutoff) * bodies.m[j]);
        }
        error += (bodies.a[i] - sum).norm_squared();
        all += sum.norm_squared();
    }
    (error / all).sqrt()
}

#[test]
fn the_soft_field_is_the_sum_of_soft_pulls() {
    let (few, many) = (field_error(500), field_error(3000));
    assert!(few < 5e-15 && many < 2e-5, "{few:e} {many:e}");
}

/// Largest relative error of the potentials by each other of `n` bodies and an idle planet, and what a planet's mass would make of it.
fn potential_error(n: u32) -> f64 {
    let (star, mut bodies) = ring(n, 1e-8, 2e-5);
    (bodies.kind[7], bodies.m[7]) = (Kind::Planet as u32, 1e-5);
    bodies.softening[11] = 0.1;
    let mut map = map(0.02, true);
    map.soft.field(&mut map.hybrid, &star, &mut bodies, true);
    let errors = (0..n as usize).map(|i| {
        let others = (0..n as usize).filter(|&j| j != i && j != 7);
        let pull = |j: usize| {
            let eps2 = bodies.softening[i].powi(2) + bodies.softening[j].powi(2);
            bodies.m[j] / ((bodies.x[j] - bodies.x[i]).norm_squared() + eps2).sqrt()
        };
        let phi = -others.map(pull).sum::<f64>();
        (bodies.potential[i] / phi - 1.0).abs()
    });
    errors.fold(0.0, |most, error| {
        if error > most || error.is_nan() {
            error
        } else {
            most
        }
    })
}

#[test]
fn the_soft_field_tells_the_whole_potentials() {
    let (few, many) = (potential_error(300), potential_error(3000));
    assert!(few < 1e-15 && many < 2e-3, "{few:e} {many:e}");
}

/// Bodies with their ids, by id.
fn by_id(bodies: &Bodies, column: &[Vec3]) -> Vec<Vec3> {
    let mut all: Vec<(u64, Vec3)> = bodies
        .id
        .iter()
        .copied()
        .zip(column.iter().copied())
        .collect();
    all.sort_by_key(|&(id, _)| id);
    all.into_iter().map(|(_, value)| value).collect()
}

#[test]
fn many_bodies_go_the_same_ways_in_the_order_of_the_curve() {
    let (mut star, mut bodies) = ring(4000, 1e-8, 2e-5);
    let (mut other_star, mut other) = (star.clone(), bodies.clone());
    let (mut map, mut arranged) = (map(0.02, true), map(0.02, true));
    map.prepare(&star, &mut bodies);
    let order = arranged.hybrid.arrange(&mut other);
    assert!(
        order
            .iter()
            .zip(&other.id)
            .all(|(&i, &id)| bodies.id[i as usize] == id)
    );
    assert_ne!(other.id, bodies.id);
    arranged.prepare(&other_star, &mut other);
    for _ in 0..3 {
        map.step(&mut star, &mut bodies).expect("a way");
        arranged.step(&mut other_star, &mut other).expect("a way");
        arranged.hybrid.arrange(&mut other);
        assert_eq!(map.hybrid.clustered(), arranged.hybrid.clustered());
        assert_eq!(map.hybrid.touches.len(), arranged.hybrid.touches.len());
    }
    let apart = by_id(&bodies, &bodies.x)
        .into_iter()
        .zip(by_id(&other, &other.x));
    let apart = apart.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    // Sums over all come out otherwise rounded.
    assert!(apart < 1e-13, "{apart:e}");
}

#[test]
fn what_softening_takes_off_is_the_hard_part() {
    let (star, mut bodies) = ring(3000, 1e-6, 2e-5);
    bodies.m.iter_mut().step_by(3).for_each(|m| *m = 3e-6);
    let mut hybrid = map(0.02, true).hybrid;
    hybrid.choose(&star, &mut bodies, 1.0);
    let mut pulls = vec![Vec3::zeros(); bodies.len()];
    hybrid.add_hard(&bodies, 1.0, &mut pulls);
    hybrid.soften_all(&mut bodies, 1.0);
    assert!(pulls.iter().filter(|pull| pull.norm() > 0.0).count() > 100);
    assert!(pulls.iter().zip(&bodies.a).all(|(pull, a)| *pull == -a));
    let force = |(pull, m): (&Vec3, &f64)| pull * *m;
    let whole: Vec3 = pulls.iter().zip(&bodies.m).map(force).sum();
    let size: f64 = pulls
        .iter()
        .zip(&bodies.m)
        .map(|pair| force(pair).norm())
        .sum();
    assert!(whole.norm() < 1e-14 * size, "{whole:?} {size:e}");
}

/// Two points that fall past each other, with a third not far, keep their energy and go on.
#[test]
fn a_deep_encounter_of_points_is_no_obstacle() {
    let miss = 1e-4;
    let bodies = set(
        Kind::Planetesimal,
        &[1e-9, 1e-9, 1e-9],
        &[[1.0, -3e-3, 0.0], [1.0, 0.0, 0.0], [1.0, 1e-4, 0.0]],
        &[
            [0.0, 1.0, 0.0],
            [miss, 1.0 + 1e-3, 0.0],
            [0.0, 1.0 - 1e-3, 0.0],
        ],
    );
    let (mut star, mut bodies) = (sun(1.0), bodies);
    let mut map = map(0.06, false);
    map.prepare(&star, &mut bodies);
    let before = energy(1.0, &star, &bodies);
    for _ in 0..30 {
        map.step(&mut star, &mut bodies).expect("a way");
    }
    let error = (energy(1.0, &star, &bodies) / before - 1.0).abs();
    println!("miss {miss:e}: energy {error:e}");
    // A hundredth of a pair's own energy, which is 1e-6 of the whole.
    assert!(error < 1e-8, "miss {miss:e}: {error:e}");
}
