//! Encounters: which pairs of bodies touched within the step just done.
//!
//! Seen from body i, body j moved on the line d + w tau, -dt <= tau <= 0, with d, w the separation and relative velocity now. A pair
//! touches where |d + w tau| < R_i + R_j. The curvature of the true paths is neglected: it is that of the tide, dt^2 d G M/r^3, the
//! common one drops out. A walk over the tree with boxes of positions and velocities finds the pairs at about N log N; without radii
//! nothing is done. Pairs come in the order of time of touch, then ids, whatever the order of the bodies in memory.

use std::ops::Range;

use rayon::prelude::*;

use crate::bodies::Bodies;
use crate::points::sort::{Cube, Curve};
use crate::points::{Domain, Tree, Vec3};

/// Bodies a leaf of the tree.
const LEAF: usize = 8;

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

/// Finds encounters; keeps its tree and buffers between calls.
#[derive(Clone, Debug, Default)]
pub struct Finder {
    curve: Curve,
    tree: Tree,
    /// In the order of the curve.
    x: Vec<Vec3>,
    v: Vec<Vec3>,
    radius: Vec<f64>,
    /// A node's velocities lie in this box, its radii are at most this.
    slowest: Vec<Vec3>,
    fastest: Vec<Vec3>,
    largest: Vec<f64>,
    found: Vec<Encounter>,
}

impl Finder {
    /// The pairs of `bodies` that touched within the step of `dt` that ends now.
    pub fn encounters(&mut self, bodies: &Bodies, domain: &Domain, dt: f64) -> &[Encounter] {
        assert!(dt >= 0.0, "a step forwards");
        self.found.clear();
        if bodies.radius.iter().any(|&r| r > 0.0) {
            self.plant(bodies);
            self.search(domain, dt);
            let id = |i: usize| bodies.id[i];
            for encounter in &mut self.found {
                encounter.pair.sort_by_key(|&i| id(i));
            }
            let key = |e: &Encounter| e.pair.map(id);
            self.found
                .sort_by(|a, b| a.time.total_cmp(&b.time).then_with(|| key(a).cmp(&key(b))));
        }
        &self.found
    }

    fn plant(&mut self, bodies: &Bodies) {
        self.curve.thread(&bodies.x, Cube::around(&bodies.x));
        let order = &self.curve.order;
        gather(&mut self.x, &bodies.x, order);
        gather(&mut self.v, &bodies.v, order);
        gather(&mut self.radius, &bodies.radius, order);
        self.tree.build(&self.x, &self.curve.keys, LEAF);
        let (tree, v, radius) = (&self.tree, &self.v, &self.radius);
        let nodes = tree.nodes.len();
        self.slowest.clear();
        self.slowest.resize(nodes, Vec3::repeat(f64::INFINITY));
        self.fastest.clear();
        self.fastest.resize(nodes, Vec3::repeat(f64::NEG_INFINITY));
        tree.largest(|i| radius[i], &mut self.largest);
        for i in (0..nodes).rev() {
            (self.slowest[i], self.fastest[i]) = match tree.children(i) {
                Some((a, b)) => (
                    self.slowest[a].inf(&self.slowest[b]),
                    self.fastest[a].sup(&self.fastest[b]),
                ),
                None => v[tree.nodes[i].range()]
                    .iter()
                    .fold((self.slowest[i], self.fastest[i]), |(lo, hi), v| {
                        (lo.inf(v), hi.sup(v))
                    }),
            };
        }
    }

    fn search(&mut self, domain: &Domain, dt: f64) {
        let mut found = std::mem::take(&mut self.found);
        let this = &*self;
        found.par_extend(
            this.tree
                .leaves
                .par_iter()
                .with_min_len(32)
                .flat_map_iter(|&leaf| {
                    let mut own = Vec::new();
                    let root = &this.tree.nodes[0];
                    let leaf = leaf as usize;
                    let (lo, hi) = this.swept(leaf, 0, dt);
                    domain.shifts(lo, hi, root.lo, root.hi, |shift| {
                        this.walk(leaf, shift, dt, &mut own)
                    });
                    own
                }),
        );
        self.found = found;
    }

    /// The box that `node`, moved by the step back in time relative to `leaf`, may come within reach of.
    fn swept(&self, leaf: usize, node: usize, dt: f64) -> (Vec3, Vec3) {
        // Relative velocity of the leaf's bodies as seen from the node's.
        let slowest = self.slowest[leaf] - self.fastest[node];
        let fastest = self.fastest[leaf] - self.slowest[node];
        let reach = Vec3::repeat(self.largest[leaf] + self.largest[node]);
        let zero = Vec3::zeros();
        let (box_lo, box_hi) = (self.tree.nodes[leaf].lo, self.tree.nodes[leaf].hi);
        (
            box_lo - fastest.sup(&zero) * dt - reach,
            box_hi - slowest.inf(&zero) * dt + reach,
        )
    }

    /// Pairs of the leaf's bodies with later ones, those moved by `shift`.
    fn walk(&self, leaf: usize, shift: Vec3, dt: f64, found: &mut Vec<Encounter>) {
        let nodes = &self.tree.nodes;
        let mine = nodes[leaf].range();
        let mut i = 0;
        while i < nodes.len() {
            let node = &nodes[i];
            let (lo, hi) = self.swept(leaf, i, dt);
            let past = node.end as usize <= mine.start;
            if past || apart(node.lo + shift, node.hi + shift, lo, hi) {
                i = node.skip as usize;
                continue;
            }
            if self.tree.is_leaf(i) {
                self.pairs(mine.clone(), node.range(), shift, dt, found);
            }
            i += 1;
        }
    }

    fn pairs(
        &self,
        mine: Range<usize>,
        theirs: Range<usize>,
        shift: Vec3,
        dt: f64,
        found: &mut Vec<Encounter>,
    ) {
        for i in mine {
            for j in theirs.clone().filter(|&j| j > i) {
                let reach = self.radius[i] + self.radius[j];
                let d = self.x[j] + shift - self.x[i];
                if let Some(time) = touch(d, self.v[j] - self.v[i], reach, dt) {
                    let place = |i: usize| self.curve.order[i] as usize;
                    let pair = [place(i), place(j)];
                    found.push(Encounter {
                        pair,
                        time,
                        held: 0.0,
                    });
                }
            }
        }
    }
}

fn apart(lo: Vec3, hi: Vec3, other_lo: Vec3, other_hi: Vec3) -> bool {
    (0..3).any(|axis| hi[axis] < other_lo[axis] || lo[axis] > other_hi[axis])
}

fn gather<T: Copy>(to: &mut Vec<T>, from: &[T], order: &[u32]) {
    to.clear();
    to.extend(order.iter().map(|&i| from[i as usize]));
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
    fn points_never_meet_and_plant_no_tree() {
        let mut bodies = swarm(100, 1.0);
        bodies.radius.fill(0.0);
        bodies.x.fill(Vec3::zeros());
        let mut finder = Finder::default();
        assert!(finder.encounters(&bodies, &Domain::open(), 0.1).is_empty());
        assert!(finder.tree.nodes.is_empty());
    }
}
