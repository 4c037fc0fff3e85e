//! Around: the gas around the points of a bundle, the radii that hold the wanted number of it, and its density.
//!
//! What is near is found in single precision, with a margin; all sums are in double precision.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x16, f64x8, u32x16};

use super::tilt::dot;
use super::{Lanes, grow, lanes};
use crate::probe::candidates::Candidates;
use crate::probe::near::{Kernel, falloff};

/// Lanes in single precision.
const WIDE: usize = 16;

/// Evaluations of the neighbour number for a point whose smoothing length changes as it does from tick to tick.
const TRIES: usize = 4;

/// Error of the neighbour number from which one last step of Halley's method suffices: it leaves the cube of that.
const TOLERANCE: f64 = 1e-2;

/// A coordinate further than anything, whose square is finite.
const FAR: f32 = 1e15;

/// What rounding in single precision may take from the square of a length, at most.
const SLACK: f64 = 1e-5;

#[derive(Clone, Debug, Default)]
pub(super) struct Around {
    inverse_unit: f64,
    /// coordinates of all candidates, by their reach
    all: [Vec<f32>; 3],
    /// places among the candidates of those that are near, and their distances
    place: Vec<u32>,
    distance: Vec<Lanes>,
    count: usize,
}

impl Around {
    /// Takes the candidates over, which are complete within `reach` of a box.
    pub fn enter(&mut self, candidates: &Candidates, reach: f64) {
        self.inverse_unit = 1.0 / reach;
        let n = candidates.len();
        for (narrow, wide) in self.all.iter_mut().zip(candidates.columns()) {
            narrow.clear();
            narrow.extend(wide[..n].iter().map(|x| (x * self.inverse_unit) as f32));
            narrow.resize(n.next_multiple_of(WIDE), FAR);
        }
    }

    /// Lists the candidates within `available` of the box around the points `x`; returns how many there are.
    #[inline(always)]
    pub fn choose<S: Simd>(&mut self, simd: S, x: &[Lanes; 3], available: f64) -> usize {
        let ends = x.map(|x| {
            let ends = (f64::INFINITY, f64::NEG_INFINITY);
            let (lo, hi) = (x.iter()).fold(ends, |(lo, hi), &x| (lo.min(x), hi.max(x)));
            [lo, hi].map(|x| f32x16::splat(simd, (x * self.inverse_unit) as f32))
        });
        let most = available * self.inverse_unit;
        let most = f32x16::splat(simd, (most * most * (1.0 + SLACK)) as f32);
        let [x, y, z] = [0, 1, 2].map(|axis| self.all[axis].as_chunks::<WIDE>().0);
        grow(&mut self.place, (x.len() + 1) * WIDE);
        let mut place = u32x16::from_fn(simd, |k| k as u32);
        let mut near = 0;
        for ((x, y), z) in x.iter().zip(y).zip(z) {
            let mut square = f32x16::splat(simd, 0.0);
            for (x, [lo, hi]) in [x, y, z].into_iter().zip(ends) {
                let x = f32x16::from_slice(simd, x);
                let gap = (x - hi).max(lo - x).max(0.0);
                square = gap.mul_add(gap, square);
            }
            let inside = square.simd_lt(most);
            // All lanes are written, those inside first; the next ones overwrite the rest.
            simd.compress_u32x16(place, inside)
                .store_slice(&mut self.place[near..near + WIDE]);
            place += WIDE as u32;
            near += inside.to_bitmask().count_ones() as usize;
        }
        self.count = near;
        near
    }

    /// Finds the distances from the points `x`, and brings each radius, from `radius` on, to where it holds the `wanted` smooth number, by Halley's
    /// method; also the lanes in which that was done within `available`.
    #[inline(always)]
    pub fn radius<S: Simd>(
        &mut self,
        simd: S,
        (candidates, kernel): (&Candidates, Kernel),
        x: &[f64x8<S>; 3],
        (mut radius, available, wanted): (f64x8<S>, f64, f64),
    ) -> (f64x8<S>, u8) {
        grow(&mut self.distance, self.count);
        let distances = &mut self.distance[..self.count];
        let one = f64x8::splat(simd, 1.0);
        let mut sums = Sums::new(simd);
        let inverse = one / radius;
        for (distance, &k) in distances.iter_mut().zip(&self.place) {
            let [px, py, pz] = candidates.place(k as usize);
            let r = [x[0] - px, x[1] - py, x[2] - pz];
            let d = dot(&r, &r).sqrt();
            d.store_slice(distance);
            sums.add(d * inverse);
        }
        let mut open = radius.simd_gt(0.0);
        for _ in 1..TRIES {
            let (number, step) = sums.step(kernel.central / wanted);
            radius = open.select(radius * step, radius);
            open &= (number - 1.0).abs().simd_ge(TOLERANCE);
            if open.to_bitmask() == 0 {
                break;
            }
            sums = Sums::new(simd);
            let inverse = one / radius;
            for distance in distances.iter() {
                sums.add(lanes(simd, distance) * inverse);
            }
        }
        let inside = radius.simd_gt(0.0) & radius.simd_le(available);
        let found = inside.to_bitmask() & !open.to_bitmask();
        let radius = inside.select(radius, f64x8::splat(simd, available));
        (radius, found as u8)
    }

    /// Mass within the radii by the kernel; lists the places of what is inside of the kernel of the weights for any point, and returns how many
    /// these are.
    #[inline(always)]
    pub fn mass<S: Simd>(
        &self,
        simd: S,
        (candidates, kernel): (&Candidates, Kernel),
        radius: f64x8<S>,
        listed: &mut Vec<u32>,
    ) -> (f64x8<S>, usize) {
        grow(listed, self.count);
        let inverse = f64x8::splat(simd, 1.0) / radius;
        let (mut n, mut mass) = (0, f64x8::splat(simd, 0.0));
        for (distance, &place) in self.distance[..self.count].iter().zip(&self.place) {
            let q = lanes(simd, distance) * inverse;
            mass = falloff(q).mul_add(candidates.mass(place as usize), mass);
            // Written always, kept when inside: no branch to mispredict.
            listed[n] = place;
            n += usize::from(q.simd_lt(kernel.near).to_bitmask() != 0);
        }
        (mass, n)
    }
}

/// Sums over the gas by q = r / H: with t = 1 - q, of t^4 (1 + 4 q), q^2 t^3 and q^3 t^2.
struct Sums<S: Simd> {
    simd: S,
    value: f64x8<S>,
    slope: f64x8<S>,
    bend: f64x8<S>,
}

impl<S: Simd> Sums<S> {
    #[inline(always)]
    fn new(simd: S) -> Self {
        let none = f64x8::splat(simd, 0.0);
        Self {
            simd,
            value: none,
            slope: none,
            bend: none,
        }
    }

    #[inline(always)]
    fn add(&mut self, q: f64x8<S>) {
        let t = (-q + 1.0).max(0.0);
        let (t2, qt) = (t * t, q * t);
        self.value = (t2 * t2).mul_add(q.mul_add(4.0, 1.0), self.value);
        let square = qt * qt;
        self.slope = square.mul_add(t, self.slope);
        self.bend = square.mul_add(q, self.bend);
    }

    /// The smooth number by the wanted one, and the factor of the radius by Halley's method in logarithms; exact to rounding for the last step, and
    /// rough far from it. `scale` is what the value is to be multiplied by.
    #[inline(always)]
    fn step(&self, scale: f64) -> (f64x8<S>, f64x8<S>) {
        let one = f64x8::splat(self.simd, 1.0);
        let number = self.value * scale;
        // n' and n'' by ln(radius), by n.
        let each = one / self.value;
        let slope = self.slope * each * 20.0;
        let bend = self.bend * each * 60.0 - slope * 2.0 - slope * slope;
        // ln(number) = -2 artanh(z), and exp by its (2, 2) approximant.
        let z = (one - number) / (one + number);
        let z2 = z * z;
        let log = z * 2.0 * z2.mul_add(z2.mul_add(0.2, 1.0 / 3.0), 1.0);
        let newton = log / slope;
        let curved = (newton * bend / slope).max(-0.5).min(0.5) * 0.5 + 1.0;
        let x = (newton / curved).max(-1.0).min(1.0);
        let even = x.mul_add(x, 12.0);
        (number, (even + x * 6.0) / (even - x * 6.0))
    }
}
