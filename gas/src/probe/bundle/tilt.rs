//! Tilt: what makes the weights of a bundle exact for linear fields.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x8};
use nbody::points::Domain;

/// Sums over the rows: w, w r and w r r (xx, yy, zz, xy, xz, yz).
pub struct Moments<S: Simd> {
    pub zeroth: f64x8<S>,
    pub first: [f64x8<S>; 3],
    pub second: [f64x8<S>; 6],
}

/// Weights are multiplied by level + slope.x.
pub struct Tilt<S: Simd> {
    pub level: f64x8<S>,
    pub slope: [f64x8<S>; 3],
}

#[inline(always)]
pub fn dot<S: Simd>(a: &[f64x8<S>; 3], b: &[f64x8<S>; 3]) -> f64x8<S> {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

impl<S: Simd> Tilt<S> {
    /// About the origin of the candidates, for points at `x` with smoothing lengths `h`; and where it is well posed.
    #[inline(always)]
    pub fn of(
        simd: S,
        domain: &Domain,
        h: f64x8<S>,
        x: &[f64x8<S>; 3],
        moments: &Moments<S>,
    ) -> (Self, u8) {
        let square = h * h;
        let norm = f64x8::splat(simd, 1.0) / moments.zeroth;
        let [a, b, c] = moments.first;
        let (a, b, c) = (a * norm, b * norm, c * norm);
        let [xx, yy, zz, xy, xz, yz] = moments.second;
        let (xx, yy, zz) = (xx * norm - a * a, yy * norm - b * b, zz * norm - c * c);
        let (xy, xz, yz) = (xy * norm - a * b, xz * norm - a * c, yz * norm - b * c);
        let [ox, oy, oz] = domain.axes;
        let xx = if ox { xx } else { square };
        let yy = if oy { yy } else { square };
        let zz = if oz { zz } else { square };
        // L D L^T of the spread.
        let (ly, lz) = (xy / xx, xz / xx);
        let second = yy - ly * xy;
        let rest = yz - ly * xz;
        let lyz = rest / second;
        let third = zz - lz * xz - lyz * rest;
        let fy = b - ly * a;
        let fz = c - lz * a - lyz * fy;
        let sz = -fz / third;
        let sy = -fy / second - lyz * sz;
        let sx = -a / xx - ly * sy - lz * sz;
        let slope = [sx, sy, sz];
        let level = -dot(&slope, &[a, b, c]) + 1.0;
        let regular = (xx * second * third).simd_gt(square * square * square * 1e-4)
            & xx.simd_gt(0.0)
            & second.simd_gt(0.0);
        let level = level - dot(&slope, x);
        (Self { level, slope }, regular.to_bitmask() as u8)
    }
}
