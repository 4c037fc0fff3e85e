//! Bundle: the weights of up to eight neighbouring points at once, a lane each, over the gas that they share.
//!
//! The same weights as [`super::Weights`] finds where they are exact for linear fields; it leaves all other points to that.

mod around;
mod tilt;
mod weigh;

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, f64x8, mask64x8};
use nbody::points::{Domain, Vec3};

use super::Reach;
use super::candidates::Candidates;
use super::near::{Kernel, LANES};
use super::weights::MOST_ABSOLUTE;
use around::Around;
use tilt::Tilt;
use weigh::weigh;

/// How far beyond its last neighbourhood a point is looked around for its new one, by the radius.
const MARGIN: f64 = 1.03;

/// A number for each point.
pub type Lanes = [f64; LANES];

/// Gas particles with their weights, a lane a point: zero outside of a point's kernel. The columns only grow; the first `count` rows count.
#[derive(Clone, Debug, Default)]
pub struct Rows {
    index: Vec<u32>,
    weight: Vec<Lanes>,
    count: usize,
}

impl Rows {
    pub fn len(&self) -> usize {
        self.count
    }

    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    pub fn clear(&mut self) {
        self.count = 0;
    }

    pub fn index(&self) -> &[u32] {
        &self.index[..self.count]
    }

    pub fn index_mut(&mut self) -> &mut [u32] {
        &mut self.index[..self.count]
    }

    pub fn weight(&self) -> &[Lanes] {
        &self.weight[..self.count]
    }

    /// Appends `n` rows, and returns them.
    fn append(&mut self, n: usize) -> (&mut [u32], &mut [Lanes]) {
        let first = self.count;
        self.count += n;
        grow(&mut self.index, self.count);
        grow(&mut self.weight, self.count);
        let range = first..self.count;
        (&mut self.index[range.clone()], &mut self.weight[range])
    }
}

/// The points that share their gas.
#[derive(Clone, Debug, Default)]
pub struct Bundle {
    /// smoothing length
    pub h: Lanes,
    /// density of the gas
    pub rho: Lanes,
    /// What the weights are to be multiplied by for their sum to be one; zero for the points that are not served.
    pub norm: Lanes,
    /// sum of |w|
    pub absolute: Lanes,
    around: Around,
    /// places among the candidates of what is listed
    near: Vec<u32>,
}

/// Makes a column at least as long as `n`.
fn grow<T: Copy + Default>(column: &mut Vec<T>, n: usize) {
    if column.len() < n {
        column.resize(n, T::default());
    }
}

#[inline(always)]
fn lanes<S: Simd>(simd: S, values: &Lanes) -> f64x8<S> {
    f64x8::from_slice(simd, values)
}

impl Bundle {
    /// Takes candidates over, which are complete within `reach` of a box, for points in it.
    pub fn enter(&mut self, candidates: &Candidates, reach: f64) {
        nbody::widest!(Level::new(), _simd => self.around.enter(candidates, reach));
    }

    /// Appends the weights of the `points` (place, last smoothing length) to `rows`, from candidates that were entered and are complete within
    /// `available` of each. The points that are served are set in the answer; none are if together they would have more than `most` gas particles.
    pub fn fit(
        &mut self,
        candidates: &Candidates,
        domain: &Domain,
        (points, available): (&[(Vec3, f64)], f64),
        (reach, most): (&Reach, usize),
        rows: &mut Rows,
    ) -> u8 {
        nbody::widest!(Level::new(), simd => self.fit_lanes(simd, candidates, domain, (points, available), (reach, most), rows))
    }

    #[inline(always)]
    fn fit_lanes<S: Simd>(
        &mut self,
        simd: S,
        candidates: &Candidates,
        domain: &Domain,
        (points, available): (&[(Vec3, f64)], f64),
        (reach, most): (&Reach, usize),
        rows: &mut Rows,
    ) -> u8 {
        let kernel = Kernel::new(domain);
        let (mut x, mut start) = ([[0.0; LANES]; 3], [0.0; LANES]);
        for lane in 0..LANES {
            // Lanes to spare repeat the last point.
            let (place, h) = points[lane.min(points.len() - 1)];
            let place = domain.in_plane(place - candidates.centre);
            (0..3).for_each(|axis| x[axis][lane] = place[axis]);
            start[lane] = kernel.ratio * h;
        }
        let largest = start.iter().fold(0.0, |most: f64, &r| most.max(r));
        let available = available.min(MARGIN * largest);
        let near = self.around.choose(simd, &x, available);
        if !(1..=most).contains(&near) {
            return 0;
        }
        let x = [lanes(simd, &x[0]), lanes(simd, &x[1]), lanes(simd, &x[2])];
        let wanted = (lanes(simd, &start), available, reach.neighbours);
        let gas = (candidates, kernel);
        let (radius, mut found) = self.around.radius(simd, gas, &x, wanted);
        let (mass, count) = self.around.mass(simd, gas, radius, &mut self.near);
        (radius * (1.0 / kernel.ratio)).store_slice(&mut self.h);
        (mass * kernel.peaks(radius)).store_slice(&mut self.rho);
        let near = &self.near[..count];
        let (index, weights) = rows.append(count);
        let x = [lanes(simd, &x[0]), lanes(simd, &x[1]), lanes(simd, &x[2])];
        for (index, &k) in index.iter_mut().zip(near) {
            *index = candidates.index(k as usize);
        }
        let moments = weigh(simd, candidates, (kernel, radius), &x, (near, weights));
        let (tilt, regular) = Tilt::of(simd, domain, lanes(simd, &self.h), &x, &moments);
        found &= regular;
        found &= 0xff >> (LANES - points.len());
        let tilted = (near, weights);
        let (sums, served) = apply(simd, candidates, &tilt, (moments.zeroth, found), tilted);
        sums[0].store_slice(&mut self.norm);
        sums[1].store_slice(&mut self.absolute);
        if served == 0 {
            rows.count -= count;
        }
        served
    }
}

/// Tilts the weights of the lanes `found`; what brings their sums to one, and the sums of |w|; and those whose weights are not too negative.
#[inline(always)]
fn apply<S: Simd>(
    simd: S,
    candidates: &Candidates,
    tilt: &Tilt<S>,
    (zeroth, found): (f64x8<S>, u8),
    (near, weights): (&[u32], &mut [Lanes]),
) -> ([f64x8<S>; 2], u8) {
    let none = f64x8::splat(simd, 0.0);
    let mask = |set: u8| mask64x8::from_bitmask(simd, u64::from(set));
    // The others may have no numbers at all.
    let found_lanes = mask(found);
    let level = found_lanes.select(tilt.level, none);
    let [sx, sy, sz] = tilt.slope.map(|s| found_lanes.select(s, none));
    let (mut total, mut absolute) = (none, none);
    for (weight, &k) in weights.iter_mut().zip(near) {
        let [x, y, z] = candidates.place(k as usize);
        let factor = sx.mul_add(f64x8::splat(simd, x), level);
        let factor = sy.mul_add(f64x8::splat(simd, y), factor);
        let factor = sz.mul_add(f64x8::splat(simd, z), factor);
        let w = lanes(simd, weight) * factor;
        w.store_slice(weight);
        total += w;
        absolute += w.abs();
    }
    let served = found & absolute.simd_lt(zeroth * MOST_ABSOLUTE).to_bitmask() as u8;
    let norm = mask(served).select(f64x8::splat(simd, 1.0) / total, none);
    ([norm, absolute * norm], served)
}
