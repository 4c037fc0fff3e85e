//! Quadrupoles: a = d/q^3 (m + (15/2 d.S.d/q^2 - 3/2 tr S)/q^2) - 3 S.d / q^5, with S = sum m x x,
//! the gradient of phi = -m/q + (3 d.S.d/q^2 - tr S)/(2 q^3); second moments keep their trace, which softening makes felt.

use fearless_simd::{Simd, SimdBase, SimdFloat};

use super::super::lanes::{Lanes, Real};
use super::{ABREAST, PADDING, Pull, Targets, abreast, add, same, separation, series};

/// Quadrupoles in a block: what fits the first cache.
pub const QUADRUPOLES: usize = 256;
/// Quadrupoles that lie together, column after column: x, y, z, eps^2, m, -3 S (xx, yy, zz, xy, xz, yz), -3/2 tr S.
pub type Batch<E> = [[E; BATCH]; 12];
/// Quadrupoles in a batch; a multiple of all lanes.
pub const BATCH: usize = PADDING;

/// Batches of quadrupoles; what pads the last one is massless and softened.
#[derive(Clone, Debug, Default)]
pub struct Quadrupoles<E> {
    pub batches: Vec<Batch<E>>,
}

impl<E: Real> Quadrupoles<E> {
    /// A batch of nothing.
    pub fn empty_batch() -> Batch<E> {
        std::array::from_fn(|c| [E::from_f64(if c == 3 { 1.0 } else { 0.0 }); BATCH])
    }
}

#[inline(always)]
fn take<S: Simd, E: Real>(simd: S, column: &[E; BATCH], i: usize) -> E::Native<S> {
    E::Native::<S>::from_slice(simd, &column[i..i + E::Native::<S>::LEN])
}

/// q^(-1/2), q^(-1) and q^(-3/2) from an estimate `y` of the first; in f64 1/q to 2e-12, the others to rounding.
#[inline(always)]
fn powers<S: Simd, E: Real, R: Lanes<S, E>>(
    simd: S,
    q: E::Native<S>,
    y: E::Native<S>,
) -> [E::Native<S>; 3] {
    let y2 = y * y;
    let y3 = y * y2;
    if R::TERMS == 0 {
        return [y, y2, y3];
    }
    let e = (-q).mul_add(y2, same::<S, E>(simd, 1.0));
    let cube = series::<S, E, R>(simd, e, [1.0, 1.5, 1.875, 2.1875]);
    let root = series::<S, E, R>(simd, e, [1.0, 0.5, 0.375, 0.3125]);
    let part = if R::TERMS > 1 { e.mul_add(e, e) } else { e };
    [y * root, y2.mul_add(part, y2), y3 * cube]
}

/// Adds the pull of a block of quadrupoles to `pulls`.
#[inline(always)]
pub fn pull_of_quadrupoles<S: Simd, E: Real, R: Lanes<S, E>, const POTENTIAL: bool>(
    simd: S,
    targets: &Targets<E>,
    block: &Quadrupoles<E>,
    pulls: &mut [Pull],
) {
    let zero = same::<S, E>(simd, 0.0);
    let (half, third) = (same::<S, E>(simd, -0.5), same::<S, E>(simd, 1.0 / 3.0));
    let five_halves = same::<S, E>(simd, -2.5);
    for first in (0..targets.len).step_by(ABREAST) {
        let t = abreast(simd, targets, first);
        let mut a = [[zero; 3]; ABREAST];
        let mut phi = [zero; ABREAST];
        for batch in &block.batches {
            for i in (0..BATCH).step_by(E::Native::<S>::LEN) {
                let column = |c: usize| take::<S, E>(simd, &batch[c], i);
                let places = [column(0), column(1), column(2), column(3)];
                let (m, trace) = (column(4), column(11));
                let (xx, yy, zz) = (column(5), column(6), column(7));
                let (xy, xz, yz) = (column(8), column(9), column(10));
                // Stage by stage for all abreast: the chains of one target alone are longer than the processor looks ahead.
                for k in 0..ABREAST {
                    let (d, q) = separation(&t, k, places);
                    // The products with S do not wait for the root.
                    let gx = xx.mul_add(d[0], xy.mul_add(d[1], xz * d[2]));
                    let gy = xy.mul_add(d[0], yy.mul_add(d[1], yz * d[2]));
                    let gz = xz.mul_add(d[0], yz.mul_add(d[1], zz * d[2]));
                    let dg = d[0].mul_add(gx, d[1].mul_add(gy, d[2] * gz));
                    let [y, y2, y3] = powers::<S, E, R>(simd, q, R::inverse_root(simd, q));
                    let s = dg * y2;
                    let c = y3 * y2.mul_add(s.mul_add(five_halves, trace), m);
                    let y5 = y3 * y2;
                    a[k][0] = d[0].mul_add(c, gx.mul_add(y5, a[k][0]));
                    a[k][1] = d[1].mul_add(c, gy.mul_add(y5, a[k][1]));
                    a[k][2] = d[2].mul_add(c, gz.mul_add(y5, a[k][2]));
                    if POTENTIAL {
                        let second = s.mul_add(half, trace * third);
                        phi[k] = y.mul_add(y2.mul_add(second, m), phi[k]);
                    }
                }
            }
        }
        let served = ABREAST.min(targets.len - first);
        add::<S, E, R, POTENTIAL>(&mut pulls[first..first + served], &a, &phi);
    }
}
