//! The soft part: pulls of the bodies on each other by K(r/c) times Newton's, at the positions of a kick.
//!
//! Few bodies by all pairs in f64 with K in the sum. Many by the tree: its field is Newton's, pairs near each other exact in f64, and
//! the hard part of each pair within its cut-off is taken off again. Planets are left out of the tree and pull pair by pair.

use std::borrow::Cow;

use fearless_simd::Level;

use super::changeover::soft_part;
use super::{Hybrid, typical};
use crate::bodies::{Bodies, Kind};
use crate::gravity::{Gravity, Settings, per_distance};
use crate::points::Vec3;
use crate::points::sum::CHUNK;
use rayon::prelude::*;

/// Up to so many bodies all pairs are summed.
const FEW: usize = 2500;

/// The soft field; keeps the buffers of few bodies between calls. The tree of many lives as long as a call: by far the largest thing
/// that a run of bodies has, it would stand idle beside what the rest of a step needs.
pub struct Soft {
    settings: Settings,
    g: f64,
    columns: [Vec<f64>; 6],
    sums: [Vec<f64>; 3],
}

impl Soft {
    pub fn new(settings: Settings) -> Self {
        Self {
            settings,
            g: settings.constant,
            columns: Default::default(),
            sums: Default::default(),
        }
    }

    /// Finds the soft accelerations of all bodies, into their `a`; if wanted also their whole potentials by each other, planets left out. Returns the
    /// number of interactions.
    pub fn field(
        &mut self,
        hybrid: &mut Hybrid,
        star: &Bodies,
        bodies: &mut Bodies,
        potentials: bool,
    ) -> u64 {
        hybrid.choose(star, bodies, self.g);
        if bodies.m.len() <= FEW {
            self.all_pairs(bodies);
            if potentials {
                self.all_potentials(bodies);
            }
            return (bodies.m.len() as u64).pow(2);
        }
        let interactions = self.by_tree(bodies, potentials);
        hybrid.soften(bodies, self.g);
        // What the tree's bodies do to a planet comes with what it does to them.
        for (a, &kind) in bodies.a.iter_mut().zip(&bodies.kind) {
            if kind == Kind::Planet as u32 {
                *a = Vec3::zeros();
            }
        }
        for p in 0..bodies.m.len() {
            if bodies.kind[p] == Kind::Planet as u32 {
                pull_of_planet(p, self.g, bodies);
            }
        }
        interactions
    }

    fn by_tree(&self, bodies: &mut Bodies, potentials: bool) -> u64 {
        let n = bodies.m.len();
        let planet = |i: usize| bodies.kind[i] == Kind::Planet as u32;
        let m: Cow<[f64]> = if (0..n).any(planet) {
            let small = (0..n).map(|i| if planet(i) { 0.0 } else { bodies.m[i] });
            small.collect()
        } else {
            Cow::Borrowed(&bodies.m)
        };
        let active: Vec<u32> = (0..n as u32).collect();
        let mut tree = Gravity::new(self.settings);
        tree.resolve(typical(&bodies.cutoff));
        tree.build(&bodies.x, &m, &bodies.softening);
        bodies.a.resize(n, Vec3::zeros());
        let phi = if potentials {
            &mut bodies.potential[..]
        } else {
            &mut []
        };
        let count = tree.field(&active, &mut bodies.a, phi);
        count.interactions
    }

    /// The potentials of bodies but planets by each other.
    fn all_potentials(&self, bodies: &mut Bodies) {
        let (x, m, softening, kind) = (&bodies.x, &bodies.m, &bodies.softening, &bodies.kind);
        let of = |i: usize| -> f64 {
            let others =
                (0..x.len()).filter(|&j| j != i && kind[j] != Kind::Planet as u32 && m[j] > 0.0);
            let over = |j: usize| {
                let eps2 = softening[i] * softening[i] + softening[j] * softening[j];
                m[j] * per_distance((x[j] - x[i]).norm_squared() + eps2)
            };
            -self.g * others.map(over).sum::<f64>()
        };
        let potentials = bodies.potential.par_iter_mut().enumerate();
        potentials
            .with_min_len(64)
            .for_each(|(i, phi)| *phi = of(i));
    }

    fn all_pairs(&mut self, bodies: &mut Bodies) {
        let n = bodies.m.len();
        for (k, column) in self.columns.iter_mut().enumerate() {
            column.clear();
            column.extend((0..n).map(|i| match k {
                0..3 => bodies.x[i][k],
                3 => bodies.m[i] * self.g,
                4 => 1.0 / bodies.cutoff[i].max(f64::MIN_POSITIVE),
                _ => bodies.softening[i] * bodies.softening[i],
            }));
        }
        for sum in &mut self.sums {
            sum.clear();
            sum.resize(n, 0.0);
        }
        let (columns, sums) = (&self.columns, &mut self.sums);
        let softened = columns[5].iter().any(|&eps2| eps2 != 0.0);
        let level = Level::new();
        crate::widest!(level, simd => {
            use fearless_simd::Simd;
            simd.vectorize(
                #[inline(always)]
                || if softened {
                    (0..n).for_each(|j| add_pull::<true>(columns, j, sums));
                } else {
                    (0..n).for_each(|j| add_pull::<false>(columns, j, sums));
                },
            )
        });
        for (i, a) in bodies.a.iter_mut().enumerate() {
            *a = Vec3::from_fn(|axis, _| self.sums[axis][i]);
        }
    }
}

/// Adds the soft pull of body j on everybody; without softening one root serves both separation and force.
#[inline(always)]
fn add_pull<const SOFTENED: bool>(
    [x, y, z, gm, c, eps2]: &[Vec<f64>; 6],
    j: usize,
    sums: &mut [Vec<f64>; 3],
) {
    let n = x.len();
    let (x, y, z) = (&x[..n], &y[..n], &z[..n]);
    let (c, eps2) = (&c[..n], &eps2[..n]);
    let [sx, sy, sz] = sums;
    let (sx, sy, sz) = (&mut sx[..n], &mut sy[..n], &mut sz[..n]);
    let (xj, yj, zj, gm, cj, ej) = (x[j], y[j], z[j], gm[j], c[j], eps2[j]);
    for i in 0..n {
        let (dx, dy, dz) = (xj - x[i], yj - y[i], zj - z[i]);
        let r2 = dx * dx + dy * dy + dz * dz;
        // The larger cut-off is the smaller inverse.
        let per_cutoff = if c[i] < cj { c[i] } else { cj };
        // K is zero at the body itself: a floor keeps the quotient finite.
        let floored = r2 + 1e-200;
        let r = floored.sqrt();
        let k = soft_part(r * per_cutoff);
        let cube = if SOFTENED {
            let q2 = floored + (eps2[i] + ej);
            q2 * q2.sqrt()
        } else {
            floored * r
        };
        let pull = gm * k / cube;
        sx[i] += pull * dx;
        sy[i] += pull * dy;
        sz[i] += pull * dz;
    }
}

/// Adds the soft pull of planet `p` on everybody and theirs on it; other planets' pulls on it come with them.
fn pull_of_planet(p: usize, g: f64, bodies: &mut Bodies) {
    let (x, softening, m) = (&bodies.x, &bodies.softening, &bodies.m);
    let cutoffs = &bodies.cutoff;
    let pull = |i: usize| {
        let d = x[p] - x[i];
        let eps2 = softening[i] * softening[i] + softening[p] * softening[p];
        d * soft_pull(g, d.norm_squared(), eps2, cutoffs[i].max(cutoffs[p]))
    };
    let all = bodies.a.par_iter_mut().enumerate().with_min_len(CHUNK);
    all.filter(|&(i, _)| i != p)
        .for_each(|(i, a)| *a += pull(i) * m[p]);
    let small = |&i: &usize| bodies.kind[i] != Kind::Planet as u32;
    let back = crate::points::sum::ordered(m.len(), Vec3::zeros(), |range| {
        range
            .filter(small)
            .fold(Vec3::zeros(), |sum, i| sum - pull(i) * m[i])
    });
    bodies.a[p] += back;
}

/// The soft pull over separation and mass.
pub fn soft_pull(g: f64, r2: f64, eps2: f64, cutoff: f64) -> f64 {
    let q2 = r2 + eps2;
    if r2 == 0.0 || q2 == 0.0 {
        return 0.0;
    }
    let k = if r2 < cutoff * cutoff {
        soft_part((r2 / (cutoff * cutoff)).sqrt())
    } else {
        1.0
    };
    g * k / (q2 * q2.sqrt())
}
