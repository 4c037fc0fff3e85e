//! Encounters: which pairs of bodies touched within the step just done.
//!
//! Seen from body i, body j moved on the line d + w tau, -dt <= tau <= 0, with d, w the separation and relative velocity now. A pair
//! touches where |d + w tau| < R_i + R_j. The curvature of the true paths is neglected: it is that of the tide, dt^2 d G M/r^3, the
//! common one drops out. A tree of the bodies' paths finds the pairs at about N log N; without radii nothing is done. Pairs come in the order of time of touch, then ids, whatever the order of the bodies in memory.

use crate::bodies::Bodies;
use crate::points::{Domain, Vec3};
use paths::{Approach, Paths};

pub(crate) mod paths;

/// A pair of bodies that touched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encounter {
    /// Places of the two bodies; the one with the smaller id first.
    pub pair: [usize; 2],
    /// Time of the first touch counted from now, -dt..=0.
    pub time: f64,
    /// Part of that time for which the two have been held as they touched, by an integrator that resolves encounters itself.
    pub held: f64,
}

/// Time of the first touch within the step of `dt` that ends now, of spheres whose radii sum to `reach`, separated by `d` now and moving
/// apart with `w`.
pub fn touch(d: Vec3, w: Vec3, reach: f64, dt: f64) -> Option<f64> {
    let (dw, w2) = (d.dot(&w), w.norm_squared());
    let excess = d.norm_squared() - reach * reach;
    let before = excess + dt * (dt * w2 - 2.0 * dw);
    if before < 0.0 {
        return Some(-dt);
    }
    // Apart at the start of the step: the first of the two roots of w2 tau^2 + 2 dw tau + excess.
    let discriminant = dw * dw - w2 * excess;
    if w2 == 0.0 || discriminant <= 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    let time = if dw > 0.0 {
        -(dw + root) / w2
    } else {
        excess / (root - dw)
    };
    (time >= -dt && time <= 0.0).then_some(time)
}

/// Bodies whose paths in the step of `dt` that ends now are looked at.
struct Past<'a> {
    bodies: &'a Bodies,
    dt: f64,
}

impl Approach for Past<'_> {
    type Pair = Encounter;

    fn x(&self) -> &[Vec3] {
        &self.bodies.x
    }

    fn v(&self) -> &[Vec3] {
        &self.bodies.v
    }

    fn dt(&self) -> f64 {
        -self.dt
    }

    fn share(&self, i: usize) -> [f64; 2] {
        [self.bodies.radius[i], 0.0]
    }

    fn reach(&self, a: [f64; 2], b: [f64; 2], _: f64) -> f64 {
        a[0] + b[0]
    }

    fn pair(&self, i: usize, j: usize, shift: Vec3) -> Option<Encounter> {
        let Bodies { x, v, radius, .. } = self.bodies;
        let time = touch(
            x[j] + shift - x[i],
            v[j] - v[i],
            radius[i] + radius[j],
            self.dt,
        )?;
        Some(Encounter {
            pair: [i, j],
            time,
            held: 0.0,
        })
    }
}

/// Finds encounters; keeps its tree and buffers between calls.
#[derive(Clone, Debug, Default)]
pub struct Finder {
    paths: Paths,
    found: Vec<Encounter>,
}

impl Finder {
    /// The pairs of `bodies` that touched within the step of `dt` that ends now.
    pub fn encounters(&mut self, bodies: &Bodies, domain: &Domain, dt: f64) -> &[Encounter] {
        assert!(dt >= 0.0, "a step forwards");
        self.found.clear();
        if bodies.radius.iter().any(|&r| r > 0.0) {
            self.paths.plant(&bodies.x);
            let past = Past { bodies, dt };
            self.paths.search(&past, domain, &mut self.found);
            in_order(&mut self.found, &bodies.id);
        }
        &self.found
    }
}

/// Puts encounters into the order of their times, then ids; each pair by its ids.
pub(crate) fn in_order(encounters: &mut [Encounter], id: &[u64]) {
    for encounter in &mut *encounters {
        encounter.pair.sort_by_key(|&i| id[i]);
    }
    let key = |e: &Encounter| e.pair.map(|i| id[i]);
    encounters.sort_by(|a, b| a.time.total_cmp(&b.time).then_with(|| key(a).cmp(&key(b))));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::Columns;
    use crate::points::random::{self, Purpose};
    use rand::RngExt;

    fn swarm(n: usize, speed: f64) -> Bodies {
        let mut bodies = Bodies::default();
        bodies.resize(n);
        for i in 0..n {
            bodies.id[i] = (i * 37 % n) as u64;
            let mut random = random::stream(1, Purpose::Orbits, i as u64, 0);
            let mut vector = || Vec3::from_fn(|_, _| random.random::<f64>());
            bodies.x[i] = vector();
            bodies.v[i] = (vector() - Vec3::repeat(0.5)) * speed;
            bodies.radius[i] = 0.005 * vector().x;
        }
        bodies
    }

    fn all_pairs(bodies: &Bodies, domain: &Domain, dt: f64) -> Vec<[usize; 2]> {
        let mut pairs = Vec::new();
        for i in 0..bodies.len() {
            for j in i + 1..bodies.len() {
                let d = domain.nearest(bodies.x[j] - bodies.x[i]);
                let reach = bodies.radius[i] + bodies.radius[j];
                if touch(d, bodies.v[j] - bodies.v[i], reach, dt).is_some() {
                    pairs.push(if bodies.id[i] < bodies.id[j] {
                        [i, j]
                    } else {
                        [j, i]
                    });
                }
            }
        }
        pairs.sort_unstable();
        pairs
    }

    #[test]
    fn the_tree_finds_the_pairs_that_all_pairs_finds() {
        for domain in [Domain::open(), Domain::periodic(Vec3::repeat(1.0))] {
            for (speed, dt) in [(0.0, 0.0), (1.0, 0.0), (1.0, 0.01), (3.0, 0.05)] {
                let mut bodies = swarm(2000, speed);
                bodies.radius[17] = 0.1;
                let found = Finder::default().encounters(&bodies, &domain, dt).to_vec();
                assert!(found.is_sorted_by(|a, b| a.time <= b.time));
                let mut pairs: Vec<_> = found.iter().map(|e| e.pair).collect();
                pairs.sort_unstable();
                assert!(pairs.len() > 5);
                assert_eq!(pairs, all_pairs(&bodies, &domain, dt));
            }
        }
    }

    #[test]
    fn the_touch_is_the_first_time_at_that_distance() {
        let f = |i: u32, k: f64| (f64::from(i) * k).fract() - 0.5;
        let mut touched = 0;
        for i in 1..2000 {
            let d = Vec3::new(f(i, 0.618_034), f(i, 0.414_214), f(i, 0.732_051));
            let w = Vec3::new(f(i, 0.236_068), f(i, 0.645_751), f(i, 0.316_625)) * 2.0;
            let gap = |time: f64| (d + w * time).norm() - 0.3;
            let sampled = (0..=1000)
                .map(|k| -1.0 + f64::from(k) * 1e-3)
                .find(|&t| gap(t) < 0.0);
            match touch(d, w, 0.3, 1.0) {
                Some(time) => {
                    touched += 1;
                    assert!(time == -1.0 && gap(time) < 0.0 || gap(time).abs() < 1e-14);
                    assert!(sampled.is_none_or(|s| s >= time && s - time <= 1e-3 + 1e-12));
                }
                None => assert_eq!(sampled, None),
            }
        }
        assert!(touched > 300);
    }

    #[test]
    fn a_fast_body_does_not_tunnel() {
        let mut bodies = swarm(2, 0.0);
        bodies.radius = vec![1e-6, 1e-6];
        bodies.x = vec![Vec3::zeros(), Vec3::x()];
        bodies.v = vec![Vec3::zeros(), Vec3::x() * 10.0];
        let mut finder = Finder::default();
        let found = finder.encounters(&bodies, &Domain::open(), 0.2);
        assert_eq!(found.len(), 1);
        assert!((found[0].time + 0.1).abs() < 1e-6);
        assert!(finder.encounters(&bodies, &Domain::open(), 0.09).is_empty());
    }

    #[test]
    fn points_never_meet() {
        let mut bodies = swarm(100, 1.0);
        bodies.radius.fill(0.0);
        bodies.x.fill(Vec3::zeros());
        let mut finder = Finder::default();
        assert!(finder.encounters(&bodies, &Domain::open(), 0.1).is_empty());
    }
}
