//! Bundle: the weights of up to eight neighbouring points at once, a lane each, over the gas that they share.
//!
//! The same weights as [`super::Weights`] finds where they are exact for linear fields; it leaves all other points to that.

mod tilt;
mod weigh;

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, f64x8, mask64x8};
use nbody::points::{Domain, Vec3};

use super::Reach;
use super::candidates::Candidates;
use super::near::{FIRST, Kernel, LANES, TOLERANCE};
use super::weights::MOST_ABSOLUTE;
use tilt::{Tilt, dot};

/// How far beyond its last neighbourhood a point is looked around for its new one, by the radius.
const MARGIN: f64 = 1.03;

/// Evaluations of the neighbour number for a point whose smoothing length changes as it does from tick to tick.
const TRIES: usize = 4;

/// A number for each point.
pub type Lanes = [f64; LANES];

/// The weights of points that share their gas. The columns only grow: what counts of them is said beside.
#[derive(Clone, Debug, Default)]
pub struct Bundle {
    /// smoothing length
    pub h: Lanes,
    /// density of the gas
    pub rho: Lanes,
    rows: usize,
    index: Vec<u32>,
    /// weights by their sums
    weight: Vec<Lanes>,
    /// what brings the sums to one; zero for the lanes that are not served
    norm: Lanes,
    served: u8,
    /// coordinates of the rows
    row: Vec<[f64; 3]>,
    near: usize,
    /// places among the candidates, and distances, of those that are near
    place: Vec<u32>,
    distance: Vec<Lanes>,
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
    /// Gas particle of each row of weights.
    pub fn index(&self) -> &[u32] {
        &self.index[..self.rows]
    }

    /// Appends the weights, a row a gas particle, a lane a point; zero outside a point's kernel and for points that were not served.
    pub fn append(&self, to: &mut Vec<Lanes>) {
        nbody::widest!(Level::new(), simd => self.append_lanes(simd, to));
    }

    #[inline(always)]
    fn append_lanes<S: Simd>(&self, simd: S, to: &mut Vec<Lanes>) {
        let norm = lanes(simd, &self.norm);
        to.extend(self.weight[..self.rows].iter().map(|weight| {
            let mut normed = [0.0; LANES];
            (lanes(simd, weight) * norm).store_slice(&mut normed);
            normed
        }));
    }

    /// Weights of the `points` (place, last smoothing length) from candidates that are complete within `available` of each. The lanes of those
    /// served are set in the answer; none are if together they would have more than `most` gas particles.
    pub fn fit(
        &mut self,
        candidates: &Candidates,
        domain: &Domain,
        points: &[(Vec3, f64)],
        available: f64,
        (reach, most): (&Reach, usize),
    ) -> u8 {
        nbody::widest!(Level::new(), simd => self.fit_lanes(simd, candidates, domain, points, available, (reach, most)))
    }

    #[inline(always)]
    fn fit_lanes<S: Simd>(
        &mut self,
        simd: S,
        candidates: &Candidates,
        domain: &Domain,
        points: &[(Vec3, f64)],
        available: f64,
        (reach, most): (&Reach, usize),
    ) -> u8 {
        let kernel = Kernel::new(domain);
        self.rows = 0;
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
        if !self.choose(simd, candidates, &x, available, most) {
            return 0;
        }
        let x = [lanes(simd, &x[0]), lanes(simd, &x[1]), lanes(simd, &x[2])];
        self.distances(candidates, &x);
        let start = lanes(simd, &start);
        let wanted = (available, reach.neighbours);
        let (radius, mut found) = self.radius(simd, kernel, start, wanted);
        let moments = self.weigh(simd, candidates, kernel, &x, radius);
        (radius * (1.0 / kernel.ratio)).store_slice(&mut self.h);
        let h = lanes(simd, &self.h);
        let (tilt, regular) = Tilt::of(simd, domain, h, &x, &moments);
        found &= regular;
        found &= 0xff >> (LANES - points.len());
        self.apply(simd, &tilt, moments.zeroth, found);
        self.served
    }

    /// Lists the candidates within `available` of the box around the points; false if there are more than `most`.
    #[inline(always)]
    fn choose<S: Simd>(
        &mut self,
        simd: S,
        candidates: &Candidates,
        x: &[Lanes; 3],
        available: f64,
        most: usize,
    ) -> bool {
        let columns =
            [&candidates.x, &candidates.y, &candidates.z].map(|c| c.as_chunks::<LANES>().0);
        let ends = x.map(|x| {
            let ends = (f64::INFINITY, f64::NEG_INFINITY);
            x.iter().fold(ends, |(lo, hi), &x| (lo.min(x), hi.max(x)))
        });
        grow(&mut self.place, candidates.x.len() + LANES);
        let mut near = 0;
        let [xs, ys, zs] = columns;
        for (c, ((x, y), z)) in xs.iter().zip(ys).zip(zs).enumerate() {
            let mut square = f64x8::splat(simd, 0.0);
            for (x, (lo, hi)) in [x, y, z].into_iter().zip(ends) {
                let x = lanes(simd, x);
                let gap = (x - hi).max(-x + lo).max(0.0);
                square = gap.mul_add(gap, square);
            }
            let inside = square.simd_lt(available * available).to_bitmask() as u8;
            // All lanes are written, those inside first; the next ones overwrite the rest.
            let places = &mut self.place[near..near + LANES];
            for (place, &lane) in places.iter_mut().zip(&FIRST[usize::from(inside)]) {
                *place = (c * LANES) as u32 + lane;
            }
            near += inside.count_ones() as usize;
        }
        self.near = near;
        (1..=most).contains(&near)
    }

    #[inline(always)]
    fn distances<S: Simd>(&mut self, candidates: &Candidates, x: &[f64x8<S>; 3]) {
        grow(&mut self.distance, self.near);
        for (distance, &k) in self.distance.iter_mut().zip(&self.place[..self.near]) {
            let [px, py, pz] = candidates.place(k as usize);
            let r = [x[0] - px, x[1] - py, x[2] - pz];
            dot(&r, &r).sqrt().store_slice(distance);
        }
    }

    /// Brings each radius to where it holds the `wanted` smooth number, by Newton's method; the lanes in which that was done within `available`.
    #[inline(always)]
    fn radius<S: Simd>(
        &self,
        simd: S,
        kernel: Kernel,
        mut radius: f64x8<S>,
        (available, wanted): (f64, f64),
    ) -> (f64x8<S>, u8) {
        let mut open = radius.simd_gt(0.0);
        for _ in 0..TRIES {
            let inverse = f64x8::splat(simd, 1.0) / radius;
            let none = f64x8::splat(simd, 0.0);
            let (mut value, mut slope) = (none, none);
            for distance in &self.distance[..self.near] {
                let q = lanes(simd, distance) * inverse;
                let t = (-q + 1.0).max(0.0);
                let t3 = t * t * t;
                value = (t3 * t).mul_add(q.mul_add(4.0, 1.0), value);
                slope = (q * q).mul_add(t3, slope);
            }
            let number = value * (kernel.central / wanted);
            let steepness = slope * (20.0 * kernel.central / wanted);
            radius = open.select(radius * step(simd, number, steepness), radius);
            open &= (number - 1.0).abs().simd_ge(TOLERANCE);
            if open.to_bitmask() == 0 {
                break;
            }
        }
        let inside = radius.simd_gt(0.0) & radius.simd_le(available);
        let found = inside.to_bitmask() & !open.to_bitmask();
        let radius = inside.select(radius, f64x8::splat(simd, available));
        (radius, found as u8)
    }

    /// Tilts the weights of the lanes `found`, and keeps those whose weights are not too negative.
    #[inline(always)]
    fn apply<S: Simd>(&mut self, simd: S, tilt: &Tilt<S>, zeroth: f64x8<S>, found: u8) {
        let none = f64x8::splat(simd, 0.0);
        let mask = |set: u8| mask64x8::from_bitmask(simd, u64::from(set));
        // The others may have no numbers at all.
        let found_lanes = mask(found);
        let level = found_lanes.select(tilt.level, none);
        let [sx, sy, sz] = tilt.slope.map(|s| found_lanes.select(s, none));
        let (mut total, mut absolute) = (none, none);
        for (weight, row) in self.weight[..self.rows].iter_mut().zip(&self.row) {
            let factor = sx.mul_add(f64x8::splat(simd, row[0]), level);
            let factor = sy.mul_add(f64x8::splat(simd, row[1]), factor);
            let factor = sz.mul_add(f64x8::splat(simd, row[2]), factor);
            let w = lanes(simd, weight) * factor;
            w.store_slice(weight);
            total += w;
            absolute += w.abs();
        }
        self.served = found & absolute.simd_lt(zeroth * MOST_ABSOLUTE).to_bitmask() as u8;
        let norm = f64x8::splat(simd, 1.0) / total;
        mask(self.served)
            .select(norm, none)
            .store_slice(&mut self.norm);
    }
}

/// Factor of a radius by Newton's method in logarithms, from the smooth number by the wanted one and its derivative by ln(radius); exact to
/// rounding for the last step, and rough far from it.
#[inline(always)]
fn step<S: Simd>(simd: S, number: f64x8<S>, slope: f64x8<S>) -> f64x8<S> {
    // -ln(number) = 2 artanh(z), and exp by its (2, 2) approximant.
    let one = f64x8::splat(simd, 1.0);
    let z = (one - number) / (one + number);
    let z2 = z * z;
    let log = z * 2.0 * z2.mul_add(z2.mul_add(0.2, 1.0 / 3.0), 1.0);
    let x = (log * number / slope).max(-1.0).min(1.0);
    let even = x.mul_add(x, 12.0);
    (even + x * 6.0) / (even - x * 6.0)
}
