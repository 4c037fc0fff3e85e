//! Neighbours: the pairs of bodies that come within their cut-off during the step that begins now.
//!
//! Relative motion is a straight line bent by the star's tide: |d + w tau| < c (1 + bend) + bend |w| dt for a tau in 0..dt, c the
//! larger cut-off, bend = (Omega dt)^2 at the nearer body's distance from the star. Pairs without mass do not count. Few bodies
//! are searched by all pairs, many by a tree with boxes of positions and velocities. Pairs come sorted, the smaller place first.

use fearless_simd::Level;
use rayon::prelude::*;

use crate::encounters::paths::{Approach, Paths};
use crate::points::{Domain, Vec3};

/// Up to so many bodies all pairs are looked at.
pub const FEW: usize = 1500;

/// What decides whether two bodies are neighbours; places are those of the caller. With a step, places are counted from the star.
#[derive(Clone, Copy)]
pub struct Swarm<'a> {
    pub m: &'a [f64],
    pub x: &'a [Vec3],
    pub v: &'a [Vec3],
    pub cutoff: &'a [f64],
    /// G times the star's mass.
    pub mu: f64,
    pub dt: f64,
}

impl Swarm<'_> {
    /// (Omega dt)^2 of body i; further bending than by the distance itself means nothing.
    fn bend(&self, i: usize) -> f64 {
        if self.dt == 0.0 {
            return 0.0;
        }
        let q2 = self.x[i].norm_squared();
        (self.mu * self.dt * self.dt / (q2 * q2.sqrt())).min(1.0)
    }

    /// Whether bodies i and j meet.
    #[inline]
    fn meet(&self, i: usize, j: usize) -> bool {
        let reach = self.cutoff[i].max(self.cutoff[j]);
        let bend = self.bend(i).max(self.bend(j));
        meets(
            self.x[j] - self.x[i],
            self.v[j] - self.v[i],
            [reach, bend],
            self.dt,
        ) && self.m[i] + self.m[j] > 0.0
    }
}

impl Approach for Swarm<'_> {
    type Pair = [u32; 2];

    fn x(&self) -> &[Vec3] {
        self.x
    }

    fn v(&self) -> &[Vec3] {
        self.v
    }

    fn dt(&self) -> f64 {
        self.dt
    }

    fn share(&self, i: usize) -> [f64; 2] {
        [self.cutoff[i], self.bend(i)]
    }

    fn reach(&self, a: [f64; 2], b: [f64; 2], path: f64) -> f64 {
        let bend = a[1].max(b[1]);
        a[0].max(b[0]) * (1.0 + bend) + bend * path
    }

    fn pair(&self, i: usize, j: usize, _: Vec3) -> Option<[u32; 2]> {
        self.meet(i, j).then(|| [i.min(j) as u32, i.max(j) as u32])
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

/// The search; keeps its tree from a kick to the drift after it.
#[derive(Debug, Default)]
pub struct Neighbours {
    pub pairs: Vec<[u32; 2]>,
    columns: [Vec<f64>; 8],
    paths: Paths,
    /// Bodies that the tree was planted over where they are now, or zero.
    planted: usize,
}

impl Neighbours {
    /// Finds the pairs of `swarm`, into `pairs`.
    pub fn find(&mut self, swarm: &Swarm<'_>) {
        assert!(swarm.dt >= 0.0, "a step forwards");
        self.pairs.clear();
        if swarm.x.len() <= FEW {
            self.all_pairs(swarm);
            return;
        }
        if self.planted != swarm.x.len() {
            self.paths.plant(swarm.x);
            self.planted = swarm.x.len();
        }
        self.paths.search(swarm, &Domain::open(), &mut self.pairs);
        self.pairs.par_sort_unstable();
    }

    /// To be called when bodies have moved by a step: fells the tree.
    pub fn uproot(&mut self) {
        (self.planted, self.paths) = (0, Paths::default());
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
                _ => 2.0 * (1.0 + swarm.bend(i)).powi(2),
            }));
        }
        let (columns, pairs) = (&self.columns, &mut self.pairs);
        let level = Level::new();
        crate::widest!(level, simd => {
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
            let swarm = Swarm {
                m: &m,
                x: &x,
                v: &v,
                cutoff: &cutoff,
                mu: 5.0,
                dt,
            };
            let mut expected = Vec::new();
            for i in 0..n {
                for j in i + 1..n {
                    let reach = cutoff[i].max(cutoff[j]);
                    let omega2 = |i: usize| 5.0 / x[i].norm().powi(3);
                    let bend = (omega2(i).max(omega2(j)) * dt * dt).min(1.0);
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

    #[test]
    fn two_that_the_star_draws_together_are_neighbours() {
        // Side by side on their way, they come nearer by 4.5 % of their distance, as no straight lines do.
        let x = [Vec3::x(), Vec3::new(1.0, 0.05, 0.0)];
        let v = [Vec3::y(); 2];
        let (mut there, mut w) = (x, v);
        for (x, v) in there.iter_mut().zip(&mut w) {
            crate::kepler::drift(1.0, 0.3, x, v).expect("an orbit");
        }
        let reach = 0.97 * 0.05;
        assert!((there[1] - there[0]).norm() < reach);
        let mut neighbours = Neighbours::default();
        neighbours.find(&Swarm {
            m: &[1e-6; 2],
            x: &x,
            v: &v,
            cutoff: &[reach, 0.0],
            mu: 1.0,
            dt: 0.3,
        });
        assert_eq!(neighbours.pairs, [[0, 1]]);
    }
}
