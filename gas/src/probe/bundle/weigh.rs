//! Weigh: the weights of the points of a bundle before the tilt, with the sums that it follows from.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x8};

use super::Lanes;
use super::tilt::{Moments, dot};
use crate::probe::candidates::Candidates;
use crate::probe::near::{Kernel, hold};

/// Sets the weights of the candidates at the places `near` to K V, and sums them.
#[inline(always)]
pub fn weigh<S: Simd>(
    simd: S,
    candidates: &Candidates,
    (kernel, radius): (Kernel, f64x8<S>),
    x: &[f64x8<S>; 3],
    (near, weights): (&[u32], &mut [Lanes]),
) -> Moments<S> {
    let none = f64x8::splat(simd, 0.0);
    let mut sums = Moments {
        zeroth: none,
        first: [none; 3],
        second: [none; 6],
    };
    let edge = radius * kernel.near;
    let inverse = f64x8::splat(simd, 1.0) / (edge * edge);
    for (weight, &k) in weights.iter_mut().zip(near) {
        let near = candidates.at(k as usize);
        let r = [-x[0] + near.x, -x[1] + near.y, -x[2] + near.z];
        let w = hold(dot(&r, &r) * inverse) * near.volume;
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
    }
    sums
}
