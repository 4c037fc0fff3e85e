//! Neighbours: the pairs of bodies that come within their cut-off during the step that begins now.
//!
//! Relative motion is a straight line bent by the star's tide: |d + w tau| < c (1 + bend) + bend |w| dt for a tau in 0..dt, c the
//! larger cut-off, bend = (Omega dt)^2 at the nearer body's distance from the star. Pairs without mass do not count. Few bodies
//! are searched by all pairs, many by a tree with boxes of positions and velocities. Pairs come sorted, the smaller place first.

use fearless_simd::{Level, dispatch};
use rayon::prelude::*;

use crate::points::sort::{Cube, Curve};
use crate::points::{Tree, Vec3};

/// Bodies a leaf of the tree.
const LEAF: usize = 8;
/// Up to so many bodies all pairs are looked at.
const FEW: usize = 1500;

/// What decides whether two bodies are neighbours; places are those of the caller.
#[derive(Clone, Copy)]
pub struct Swarm<'a> {
    pub m: &'a [f64],
    pub x: &'a [Vec3],
    pub v: &'a [Vec3],
    pub cutoff: &'a [f64],
    /// (Omega dt)^2 of each body.
    pub bend: &'a [f64],
    pub dt: f64,
}

impl Swarm<'_> {
    /// Whether bodies i and j meet.
    #[inline]
    fn meet(&self, i: usize, j: usize) -> bool {
        let reach = self.cutoff[i].max(self.cutoff[j]);
        let bend = self.bend[i].max(self.bend[j]);
        meets(
            self.x[j] - self.x[i],
            self.v[j] - self.v[i],
            [reach, bend],
            self.dt,
        ) && self.m[i] + self.m[j] > 0.0
    }
}

/// Whether a separation `d` that changes with `w` falls below `reach` within `dt`.
#[inline]
fn meets(d: Vec3, w: Vec3, [reach, bend]: [f64; 2], dt: f64) -> bool {
    let w2 = w.norm_squared();
    let nearest = if w2 > 0.0 {
        (-d.dot(&w) / w2).clamp(0.0, dt)
    } else {
        0.0
    };
    let reach = reach * (1.0 + bend) + bend * w2.sqrt() * dt;
    (d + w * nearest).norm_squared() < reach * reach
}

/// The search; keeps its tree and buffers between calls.
#[derive(Debug, Default)]
pub struct Neighbours {
    pub pairs: Vec<[u32; 2]>,
    columns: [Vec<f64>; 8],
    curve: Curve,
    tree: Tree,
    /// Along the curve.
    x: Vec<Vec3>,
    v: Vec<Vec3>,
    /// Boxes of a node's velocities, its largest cut-off and bend.
    slowest: Vec<Vec3>,
    fastest: Vec<Vec3>,
    reach: Vec<f64>,
    bend: Vec<f64>,
}

impl Neighbours {
    /// Finds the pairs of `swarm`, into `pairs`.
    pub fn find(&mut self, swarm: &Swarm<'_>) {
        assert!(swarm.dt >= 0.0, "a step forwards");
        self.pairs.clear();
        if swarm.x.len() <= FEW {
            self.all_pairs(swarm);
        } else {
            self.plant(swarm);
            self.search(swarm);
            self.pairs.par_sort_unstable();
        }
    }

    /// All pairs, sifted by a wide bound without roots first: d^2 < 2 (c^2 (1 + bend)^2 + w^2 dt^2 (1 + bend)^2).
    fn all_pairs(&mut self, swarm: &Swarm<'_>) {
        let n = swarm.x.len();
        for (k, column) in self.columns.iter_mut().enumerate() {
            column.clear();
            column.extend((0..n).map(|i| match k {
                0..3 => swarm.x[i][k],
                3..6 => swarm.v[i][k - 3] * swarm.dt,
                6 => swarm.cutoff[i],
                _ => 2.0 * (1.0 + swarm.bend[i]).powi(2),
            }));
        }
        let (columns, pairs) = (&self.columns, &mut self.pairs);
        let level = Level::new();
        dispatch!(level, simd => {
            use fearless_simd::Simd;
            simd.vectorize(
                #[inline(always)]
                || {
                    for i in 0..n {
                        if near(columns, i) > 0 {
                            let others = (i + 1..n).filter(|&j| swarm.meet(i, j));
                            pairs.extend(others.map(|j| [i as u32, j as u32]));
                        }
                    }
                },
            )
        });
    }

    fn plant(&mut self, swarm: &Swarm<'_>) {
        self.curve.thread(swarm.x, Cube::around(swarm.x));
        let order = &self.curve.order;
        gather(&mut self.x, swarm.x, order);
        gather(&mut self.v, swarm.v, order);
        self.tree.build(&self.x, &self.curve.keys, LEAF);
        let tree = &self.tree;
        tree.largest(|k| swarm.cutoff[order[k] as usize], &mut self.reach);
        tree.largest(|k| swarm.bend[order[k] as usize], &mut self.bend);
        let (v, nodes) = (&self.v, tree.nodes.len());
        self.slowest.clear();
        self.slowest.resize(nodes, Vec3::repeat(f64::INFINITY));
        self.fastest.clear();
        self.fastest.resize(nodes, Vec3::repeat(f64::NEG_INFINITY));
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

    fn search(&mut self, swarm: &Swarm<'_>) {
        let mut pairs = std::mem::take(&mut self.pairs);
        let this = &*self;
        let leaves = this.tree.leaves.par_iter().with_min_len(64);
        pairs.par_extend(leaves.flat_map_iter(|&leaf| {
            let mut own = Vec::new();
            this.walk(leaf as usize, swarm, &mut own);
            own
        }));
        self.pairs = pairs;
    }

    /// Pairs of the leaf's bodies with each other and with those further along the curve.
    fn walk(&self, leaf: usize, swarm: &Swarm<'_>, pairs: &mut Vec<[u32; 2]>) {
        let nodes = &self.tree.nodes;
        let mine = nodes[leaf].range();
        let mut i = 0;
        while i < nodes.len() {
            let node = &nodes[i];
            if node.end as usize <= mine.start || self.apart(leaf, i, swarm.dt) {
                i = node.skip as usize;
                continue;
            }
            if self.tree.is_leaf(i) {
                let place = |k: usize| self.curve.order[k] as usize;
                for a in mine.clone() {
                    let others = node.range().filter(|&b| b > a);
                    let met = others.filter(|&b| swarm.meet(place(a), place(b)));
                    pairs.extend(met.map(|b| {
                        let mut pair = [place(a) as u32, place(b) as u32];
                        pair.sort_unstable();
                        pair
                    }));
                }
            }
            i += 1;
        }
    }

    /// Whether no body of the leaf can meet one of the node.
    #[inline]
    fn apart(&self, leaf: usize, node: usize, dt: f64) -> bool {
        let (a, b) = (&self.tree.nodes[leaf], &self.tree.nodes[node]);
        // Relative velocities of the node's bodies as seen from the leaf's.
        let slowest = self.slowest[node] - self.fastest[leaf];
        let fastest = self.fastest[node] - self.slowest[leaf];
        let bend = self.bend[leaf].max(self.bend[node]);
        let path = slowest.abs().sup(&fastest.abs()).norm() * dt;
        let reach = self.reach[leaf].max(self.reach[node]) * (1.0 + bend) + bend * path;
        (0..3).any(|axis| {
            let (back, forth) = (slowest[axis].min(0.0) * dt, fastest[axis].max(0.0) * dt);
            b.lo[axis] + back - a.hi[axis] > reach || a.lo[axis] - (b.hi[axis] + forth) > reach
        })
    }
}

/// How many bodies after the i-th may be its neighbours.
#[inline(always)]
fn near([x, y, z, vx, vy, vz, c, wide]: &[Vec<f64>; 8], i: usize) -> u64 {
    let from = i + 1;
    let n = x.len();
    let (xs, ys, zs) = (&x[from..n], &y[from..n], &z[from..n]);
    let (us, vs, ws) = (&vx[from..n], &vy[from..n], &vz[from..n]);
    let (cs, wides) = (&c[from..n], &wide[from..n]);
    let mut count = 0;
    for j in 0..xs.len() {
        let (dx, dy, dz) = (xs[j] - x[i], ys[j] - y[i], zs[j] - z[i]);
        let (du, dv, dw) = (us[j] - vx[i], vs[j] - vy[i], ws[j] - vz[i]);
        let reach = if cs[j] > c[i] { cs[j] } else { c[i] };
        let wide = if wides[j] > wide[i] {
            wides[j]
        } else {
            wide[i]
        };
        let d2 = dx * dx + dy * dy + dz * dz;
        let w2 = du * du + dv * dv + dw * dw;
        count += u64::from(d2 < wide * (reach * reach + w2));
    }
    count
}

fn gather<T: Copy>(to: &mut Vec<T>, from: &[T], order: &[u32]) {
    to.clear();
    to.extend(order.iter().map(|&i| from[i as usize]));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::random::{self, Purpose};
    use rand::RngExt;

    #[test]
    fn tree_and_sieve_find_the_pairs_that_all_pairs_finds() {
        for (n, dt) in [(1200, 0.0), (1200, 0.05), (2500, 0.0), (2500, 0.03)] {
            let mut random = random::stream(3, Purpose::Orbits, n as u64, 0);
            let mut vector = || Vec3::from_fn(|_, _| random.random::<f64>());
            let x: Vec<Vec3> = (0..n).map(|_| vector()).collect();
            let v: Vec<Vec3> = (0..n).map(|_| vector() - Vec3::repeat(0.5)).collect();
            let mut cutoff: Vec<f64> = (0..n).map(|_| 0.08 * vector().x).collect();
            cutoff[n / 2] = 0.2;
            let m: Vec<f64> = (0..n).map(|i| f64::from(i % 3 != 0)).collect();
            let bend: Vec<f64> = (0..n).map(|_| 0.1 * vector().x).collect();
            let swarm = Swarm {
                m: &m,
                x: &x,
                v: &v,
                cutoff: &cutoff,
                bend: &bend,
                dt,
            };
            let mut expected = Vec::new();
            for i in 0..n {
                for j in i + 1..n {
                    let reach = cutoff[i].max(cutoff[j]);
                    let bend = bend[i].max(bend[j]);
                    if meets(x[j] - x[i], v[j] - v[i], [reach, bend], dt) && m[i] + m[j] > 0.0 {
                        expected.push([i as u32, j as u32]);
                    }
                }
            }
            let mut neighbours = Neighbours::default();
            neighbours.find(&swarm);
            assert!(expected.len() > 50);
            assert_eq!(neighbours.pairs, expected);
        }
    }
}
