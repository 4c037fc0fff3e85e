//! Weigh: the density around the points of a bundle, and their weights before the tilt, with the sums that it follows from.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x8};

use super::tilt::Moments;
use super::{Bundle, grow, lanes};
use crate::probe::candidates::Candidates;
use crate::probe::near::{Kernel, LANES, falloff, hold};

impl Bundle {
    /// Sums the density, and lists the gas that is inside of any point's kernel, with K V as weights.
    #[inline(always)]
    pub(super) fn weigh<S: Simd>(
        &mut self,
        simd: S,
        candidates: &Candidates,
        kernel: Kernel,
        x: &[f64x8<S>; 3],
        radius: f64x8<S>,
    ) -> Moments<S> {
        grow(&mut self.index, self.near);
        grow(&mut self.weight, self.near);
        grow(&mut self.row, self.near);
        let none = f64x8::splat(simd, 0.0);
        let inverse = f64x8::splat(simd, 1.0) / radius;
        let (mut n, mut mass) = (0, none);
        for (distance, k) in self.distance[..self.near].iter().zip(0..) {
            let place = self.place[k];
            let q = lanes(simd, distance) * inverse;
            mass = falloff(q).mul_add(candidates.mass(place as usize), mass);
            let s = q * (1.0 / kernel.near);
            // Written always, kept when inside: no branch to mispredict.
            let s2 = s * s;
            hold(s2).store_slice(&mut self.weight[n]);
            self.place[n] = place;
            n += usize::from(s2.simd_lt(1.0).to_bitmask() != 0);
        }
        self.rows = n;
        let (mut rho, mut r) = ([0.0; LANES], [0.0; LANES]);
        mass.store_slice(&mut rho);
        radius.store_slice(&mut r);
        for (rho, r) in rho.iter_mut().zip(r) {
            *rho *= kernel.peak(r);
        }
        self.rho = rho;
        self.moments(simd, candidates, x)
    }

    /// Multiplies the kernels of the rows by the volumes, and sums them.
    #[inline(always)]
    fn moments<S: Simd>(
        &mut self,
        simd: S,
        candidates: &Candidates,
        x: &[f64x8<S>; 3],
    ) -> Moments<S> {
        let none = f64x8::splat(simd, 0.0);
        let mut sums = Moments {
            zeroth: none,
            first: [none; 3],
            second: [none; 6],
        };
        let rows = self.weight.iter_mut().zip(&mut self.index);
        let rows = rows.zip(&mut self.row).zip(&self.place[..self.rows]);
        for (((weight, index), row), &k) in rows {
            let near = candidates.at(k as usize);
            let w = lanes(simd, weight) * near.volume;
            let r = [-x[0] + near.x, -x[1] + near.y, -x[2] + near.z];
            let wr = [w * r[0], w * r[1], w * r[2]];
            sums.zeroth += w;
            for axis in 0..3 {
                sums.first[axis] += wr[axis];
                sums.second[axis] = wr[axis].mul_add(r[axis], sums.second[axis]);
            }
            for (pair, (a, b)) in [(0, 1), (0, 2), (1, 2)].into_iter().enumerate() {
                sums.second[3 + pair] = wr[a].mul_add(r[b], sums.second[3 + pair]);
            }
            w.store_slice(weight);
            (*index, *row) = (near.index, [near.x, near.y, near.z]);
        }
        sums
    }
}
