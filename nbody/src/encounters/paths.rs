//! Paths: the straight lines that bodies go in a step, and which two of them may come within reach of each other.
//!
//! Seen from body i, body j is at d + w tau, tau between 0 and dt. A tree over the positions holds for each node boxes of its bodies'
//! velocities, in f32 rounded outwards, and the largest of what each brings to a pair's reach. Two nodes walk down together and part
//! where the box of their relative paths stays beyond the reach; what is left is looked at pair by pair.

use std::ops::Range;

use rayon::prelude::*;

use crate::points::sort::{Cube, Curve};
use crate::points::{Domain, Tree, Vec3};

/// Bodies a leaf of the tree.
const LEAF: usize = 16;
/// Pairs of nodes into which the search is parted for the threads.
const TASKS: usize = 1024;

/// What it means for two bodies to come near each other.
pub trait Approach: Sync {
    /// What is to be known of two that do.
    type Pair: Send;

    fn x(&self) -> &[Vec3];
    fn v(&self) -> &[Vec3];
    /// The step from now on; negative for the step that ends now.
    fn dt(&self) -> f64;
    /// What body `i` brings to a pair's reach.
    fn share(&self, i: usize) -> [f64; 2];
    /// The reach of two with the shares `a` and `b` whose relative path is at most `path` long: rises with each of them.
    fn reach(&self, a: [f64; 2], b: [f64; 2], path: f64) -> f64;
    /// The pair of bodies `i` and `j`, that one moved by `shift`, if they come near each other.
    fn pair(&self, i: usize, j: usize, shift: Vec3) -> Option<Self::Pair>;
}

/// Velocities of a node's bodies lie in a box, their shares of reach are at most `share`.
#[derive(Clone, Copy, Debug)]
struct Span {
    slowest: [f32; 3],
    fastest: [f32; 3],
    share: [f32; 2],
}

const EMPTY: Span = Span {
    slowest: [f32::INFINITY; 3],
    fastest: [f32::NEG_INFINITY; 3],
    share: [f32::NEG_INFINITY; 2],
};

impl Span {
    fn of(v: Vec3, share: [f64; 2]) -> Self {
        Self {
            slowest: std::array::from_fn(|k| (v[k] as f32).next_down()),
            fastest: std::array::from_fn(|k| (v[k] as f32).next_up()),
            share: share.map(|part| (part as f32).next_up()),
        }
    }

    fn with(self, o: Self) -> Self {
        Self {
            slowest: std::array::from_fn(|k| self.slowest[k].min(o.slowest[k])),
            fastest: std::array::from_fn(|k| self.fastest[k].max(o.fastest[k])),
            share: std::array::from_fn(|k| self.share[k].max(o.share[k])),
        }
    }
}

/// The tree over the paths; keeps it and its buffers between calls.
#[derive(Clone, Debug, Default)]
pub struct Paths {
    tree: Tree,
    /// Which body each point along the curve is; empty if the bodies stand along it themselves.
    order: Vec<u32>,
    /// Positions along the curve if bodies stand otherwise.
    x: Vec<Vec3>,
    spans: Vec<Span>,
}

/// Two nodes to be looked at, the bodies of the second moved by a shift.
type Two = (u32, u32, Vec3);

impl Paths {
    /// Plants the tree over bodies at `x`.
    pub fn plant(&mut self, x: &[Vec3]) {
        let mut curve = Curve::default();
        curve.thread(x, Cube::around(x));
        let along = curve.order.iter().zip(0..).all(|(&i, k)| i == k);
        if along {
            (self.order, self.x) = (Vec::new(), Vec::new());
            self.tree.build(x, &curve.keys, LEAF);
        } else {
            self.order = curve.order;
            gather(&mut self.x, x, &self.order);
            self.tree.build(&self.x, &curve.keys, LEAF);
        }
    }

    /// Adds all pairs that come near each other to `found`, in an order of no meaning. The bodies are those of the tree, moved a little.
    pub fn search<A: Approach>(&mut self, approach: &A, domain: &Domain, found: &mut Vec<A::Pair>) {
        self.fit(approach);
        let Some(root) = self.tree.nodes.first() else {
            return;
        };
        let (path, reach) = self.longest(approach, 0, 0);
        let (lo, hi, margin) = (root.lo, root.hi, Vec3::repeat(path + reach));
        let mut tasks: Vec<Two> = Vec::new();
        domain.shifts(lo - margin, hi + margin, lo, hi, |shift| {
            tasks.push((0, 0, shift))
        });
        let this = &*self;
        this.share_out(approach, &mut tasks);
        found.par_extend(tasks.into_par_iter().flat_map_iter(|two| {
            let mut own = Vec::new();
            this.walk(approach, two, &mut own);
            own
        }));
    }

    /// Parts `tasks` until there are enough of them.
    fn share_out<A: Approach>(&self, approach: &A, tasks: &mut Vec<Two>) {
        let mut parts = Vec::new();
        let mut more = true;
        while more && tasks.len() < TASKS {
            more = false;
            for &two in &*tasks {
                if self.apart(approach, two) {
                    continue;
                }
                if self.part(two, &mut parts) {
                    more = true;
                } else {
                    parts.push(two);
                }
            }
            std::mem::swap(tasks, &mut parts);
            parts.clear();
        }
    }

    /// Which body the k-th along the curve is.
    fn place(&self, k: usize) -> usize {
        self.order.get(k).map_or(k, |&i| i as usize)
    }

    /// Fits the tree to where the bodies are and how they move.
    fn fit<A: Approach>(&mut self, approach: &A) {
        let (x, v) = (approach.x(), approach.v());
        if self.order.is_empty() {
            self.tree.refit(x);
        } else {
            gather(&mut self.x, x, &self.order);
            self.tree.refit(&self.x);
        }
        let mut spans = std::mem::take(&mut self.spans);
        spans.clear();
        spans.resize(self.tree.nodes.len(), EMPTY);
        let all = spans.par_iter_mut().zip(&self.tree.nodes).enumerate();
        all.with_min_len(1024).for_each(|(k, (span, node))| {
            if node.skip as usize == k + 1 {
                let bodies = node.range().map(|k| self.place(k));
                *span = bodies.fold(EMPTY, |span, i| {
                    span.with(Span::of(v[i], approach.share(i)))
                });
            }
        });
        for i in (0..spans.len()).rev() {
            if let Some((left, right)) = self.tree.children(i) {
                spans[i] = spans[left].with(spans[right]);
            }
        }
        self.spans = spans;
    }

    /// The longest relative path of bodies of two nodes, and the reach that belongs to it.
    fn longest<A: Approach>(&self, approach: &A, a: usize, b: usize) -> (f64, f64) {
        let (a, b) = (&self.spans[a], &self.spans[b]);
        let speed = Vec3::from_fn(|k, _| {
            let rise = f64::from(b.fastest[k]) - f64::from(a.slowest[k]);
            let fall = f64::from(a.fastest[k]) - f64::from(b.slowest[k]);
            rise.max(fall)
        });
        let path = speed.norm() * approach.dt().abs();
        let reach = approach.reach(a.share.map(f64::from), b.share.map(f64::from), path);
        (path, reach)
    }

    /// Whether no two bodies of the nodes come near each other.
    fn apart<A: Approach>(&self, approach: &A, (a, b, shift): Two) -> bool {
        let (a, b) = (a as usize, b as usize);
        let (_, reach) = self.longest(approach, a, b);
        let dt = approach.dt();
        let (mine, theirs) = (&self.tree.nodes[a], &self.tree.nodes[b]);
        (0..3).any(|k| {
            let slowest = f64::from(self.spans[b].slowest[k]) - f64::from(self.spans[a].fastest[k]);
            let fastest = f64::from(self.spans[b].fastest[k]) - f64::from(self.spans[a].slowest[k]);
            let (one, other) = (slowest * dt, fastest * dt);
            let (back, forth) = (one.min(other).min(0.0), one.max(other).max(0.0));
            theirs.lo[k] + shift[k] + back - mine.hi[k] > reach
                || mine.lo[k] - (theirs.hi[k] + shift[k] + forth) > reach
        })
    }

    /// Lists the pairs of nodes that a pair of nodes consists of; answers whether it can be parted.
    fn part(&self, (a, b, shift): Two, parts: &mut Vec<Two>) -> bool {
        let nodes = &self.tree.nodes;
        let halves = |i: u32| {
            let children = self.tree.children(i as usize);
            children.map(|(left, right)| [left as u32, right as u32])
        };
        let second = nodes[b as usize].count() >= nodes[a as usize].count();
        if a == b {
            let Some([left, right]) = halves(a) else {
                return false;
            };
            parts.extend([
                (left, left, shift),
                (left, right, shift),
                (right, right, shift),
            ]);
            true
        } else if let Some(halves) = halves(b).filter(|_| second || halves(a).is_none()) {
            parts.extend(halves.map(|b| (a, b, shift)));
            true
        } else if let Some(halves) = halves(a) {
            parts.extend(halves.map(|a| (a, b, shift)));
            true
        } else {
            false
        }
    }

    fn walk<A: Approach>(&self, approach: &A, two: Two, found: &mut Vec<A::Pair>) {
        let mut open = vec![two];
        while let Some(two) = open.pop() {
            if !self.apart(approach, two) && !self.part(two, &mut open) {
                self.meet(approach, two, found);
            }
        }
    }

    /// The pairs of two leaves; of one leaf with itself each pair once.
    fn meet<A: Approach>(&self, approach: &A, (a, b, shift): Two, found: &mut Vec<A::Pair>) {
        let (mine, theirs): (Range<usize>, Range<usize>) = (
            self.tree.nodes[a as usize].range(),
            self.tree.nodes[b as usize].range(),
        );
        let (path, reach) = self.longest(approach, a as usize, b as usize);
        let far = (path + reach) * (1.0 + 1e-12);
        let x = approach.x();
        for k in mine {
            let i = self.place(k);
            let from = x[i] - shift;
            for l in theirs.start.max(k + 1)..theirs.end {
                let j = self.place(l);
                if (x[j] - from).norm_squared() <= far * far {
                    found.extend(approach.pair(i, j, shift));
                }
            }
        }
    }
}

fn gather<T: Copy>(to: &mut Vec<T>, from: &[T], order: &[u32]) {
    to.clear();
    to.extend(order.iter().map(|&i| from[i as usize]));
}
