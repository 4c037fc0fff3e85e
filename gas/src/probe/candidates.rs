//! Candidates: the gas near a small box, copied into short columns relative to the box.

use fearless_simd::{Level, Simd, SimdBase, SimdFloat, SimdMask, f64x8};
use nbody::points::{Domain, Vec3};

use super::near::{FIRST, LANES};
use crate::Gas;

/// A coordinate further than anything, whose square is finite.
const FAR: f64 = 1e150;

/// Gas particles that may be neighbours of points in a box. The columns only grow; the first `count` numbers count.
#[derive(Clone, Debug, Default)]
pub struct Candidates {
    /// Origin of the coordinates.
    pub(super) centre: Vec3,
    count: usize,
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
    /// mass and volume
    mass: Vec<[f64; 2]>,
    index: Vec<u32>,
}

/// One of them.
pub(super) struct Candidate {
    pub x: f64,
    pub y: f64,
    pub z: f64,
    pub m: f64,
    pub volume: f64,
    pub index: u32,
}

impl Candidates {
    pub fn len(&self) -> usize {
        self.count
    }

    /// The coordinates, filled up to whole lanes.
    pub(super) fn columns(&self) -> [&[f64]; 3] {
        let filled = self.count.next_multiple_of(LANES);
        [&self.x[..filled], &self.y[..filled], &self.z[..filled]]
    }

    /// The candidate at place k.
    #[inline(always)]
    pub(super) fn at(&self, k: usize) -> Candidate {
        let mass = self.mass[k];
        Candidate {
            x: self.x[k],
            y: self.y[k],
            z: self.z[k],
            m: mass[0],
            volume: mass[1],
            index: self.index[k],
        }
    }

    /// Gas particle of the candidate at place k.
    #[inline(always)]
    pub(super) fn index(&self, k: usize) -> u32 {
        self.index[k]
    }

    /// Mass of the candidate at place k.
    #[inline(always)]
    pub(super) fn mass(&self, k: usize) -> f64 {
        self.mass[k][0]
    }

    /// Coordinates of the candidate at place k.
    #[inline(always)]
    pub(super) fn place(&self, k: usize) -> [f64; 3] {
        [self.x[k], self.y[k], self.z[k]]
    }

    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Collects all gas within `reach` of the box [lo, hi], images included.
    pub fn gather(&mut self, gas: &Gas, domain: &Domain, lo: Vec3, hi: Vec3, reach: f64) {
        self.centre = 0.5 * (lo + hi);
        let half = 0.5 * (hi - lo);
        let counts = |axis: usize| f64::from(u8::from(domain.axes[axis]));
        let axes = Vec3::new(counts(0), counts(1), counts(2));
        let (mut lo, mut hi) = (lo, hi);
        for axis in (0..3).filter(|&axis| !domain.axes[axis]) {
            // Distances along a missing axis do not count.
            (lo[axis], hi[axis]) = (f64::NEG_INFINITY, f64::INFINITY);
        }
        let mut n = 0;
        gas.tree.near(domain, (lo, hi), reach, &[], |range, shift| {
            let most = n + range.len();
            self.grow(most);
            let (px, py) = (&mut self.x[n..most], &mut self.y[n..most]);
            let (pz, index) = (&mut self.z[n..most], &mut self.index[n..most]);
            let offset = shift - self.centre;
            for (k, x) in gas.particles.x[range.clone()].iter().enumerate() {
                let x = (x + offset).component_mul(&axes);
                (px[k], py[k], pz[k]) = (x.x, x.y, x.z);
                index[k] = (range.start + k) as u32;
            }
            n = most;
        });
        self.fill(n);
        nbody::widest!(Level::new(), simd => n = self.keep(simd, half, reach));
        self.fill(n);
        self.mass.clear();
        self.mass.extend(self.index[..n].iter().map(|&j| {
            let m = gas.particles.m[j as usize];
            [m, m / gas.derived.rho[j as usize]]
        }));
    }

    /// Removes what is not within `reach` of the box of the half lengths `half`; returns how many stay.
    #[inline(always)]
    fn keep<S: Simd>(&mut self, simd: S, half: Vec3, reach: f64) -> usize {
        let mut n = 0;
        for first in (0..self.count).step_by(LANES) {
            let range = first..first + LANES;
            let x = f64x8::from_slice(simd, &self.x[range.clone()]);
            let y = f64x8::from_slice(simd, &self.y[range.clone()]);
            let z = f64x8::from_slice(simd, &self.z[range.clone()]);
            let gx = (x.abs() - half.x).max(0.0);
            let gy = (y.abs() - half.y).max(0.0);
            let gz = (z.abs() - half.z).max(0.0);
            let far = gx.mul_add(gx, gy.mul_add(gy, gz * gz));
            let near = far.simd_lt(reach * reach);
            let set = near.to_bitmask() as u8;
            // All lanes are written, those that stay first; the next ones overwrite the rest.
            let to = n..n + LANES;
            simd.compress_f64x8(x, near)
                .store_slice(&mut self.x[to.clone()]);
            simd.compress_f64x8(y, near)
                .store_slice(&mut self.y[to.clone()]);
            simd.compress_f64x8(z, near)
                .store_slice(&mut self.z[to.clone()]);
            let mut index = [0; LANES];
            index.copy_from_slice(&self.index[range]);
            for (to, &lane) in self.index[to].iter_mut().zip(&FIRST[usize::from(set)]) {
                *to = index[lane as usize % LANES];
            }
            n += set.count_ones() as usize;
        }
        n
    }

    /// Leaves `n` candidates; the columns of coordinates are filled up to whole lanes.
    fn fill(&mut self, n: usize) {
        self.grow(n);
        self.count = n;
        let end = n.next_multiple_of(LANES);
        for column in [&mut self.x, &mut self.y, &mut self.z] {
            column[n..end].fill(FAR);
        }
    }

    /// Makes room for `n` candidates and whole lanes.
    fn grow(&mut self, n: usize) {
        let room = n.next_multiple_of(LANES);
        if self.index.len() < room {
            for column in [&mut self.x, &mut self.y, &mut self.z] {
                column.resize(room, 0.0);
            }
            self.index.resize(room, 0);
        }
    }
}

/// Radius of the sphere (disc) that would hold `neighbours` particles if all gas were as dense as the leaf nearest to `x`.
pub(super) fn radius_by_nearest_leaf(gas: &Gas, domain: &Domain, x: Vec3, neighbours: f64) -> f64 {
    let tree = &gas.tree;
    let distance = |node: usize| {
        let n = &tree.nodes[node];
        domain
            .in_plane((n.lo - x).sup(&(x - n.hi)).sup(&Vec3::zeros()))
            .norm_squared()
    };
    let dimensions = domain.dimensions() as f64;
    let mut node = 0;
    let mut radius = 0.0;
    loop {
        let n = &tree.nodes[node];
        let size = n.hi - n.lo;
        let volume: f64 = (0..3)
            .filter(|&axis| domain.axes[axis])
            .map(|axis| size[axis])
            .product();
        let own = (0.25 * neighbours * volume / n.count() as f64).powf(1.0 / dimensions);
        if own > 0.0 {
            radius = own;
        }
        match tree.children(node) {
            Some((left, right)) if distance(left) <= distance(right) => node = left,
            Some((_, right)) => node = right,
            None => return radius + distance(node).sqrt(),
        }
    }
}
