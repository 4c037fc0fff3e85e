//! The kernels: pull of a block of point masses, or of [`quadrupole`]s, on a few targets; wide over the sources.
//!
//! Points: a = sum m d / q^3,  phi = -sum m / q,  q^2 = d^2 + eps_i^2 + eps_j^2,  d from target to source.
//! Powers of q are those of an estimate y, times a series in e = 1 - q^2 y^2. Partial sums of a block are made in the element type, sums
//! over blocks in f64. Lengths are in units of the target group's size, so that no power of q leaves the range of f32.
//! Two targets abreast leave room for all that is in use among 32 registers: with four, half the operands come from memory.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask};

use super::lanes::{Lanes, Real};

pub mod quadrupole;
#[cfg(test)]
mod rates;
#[cfg(test)]
mod tests;

/// Targets that one pass over a block serves.
pub const ABREAST: usize = 2;
/// Points in a block: what fits the first cache.
pub const POINTS: usize = 1024;
/// Columns are padded to a multiple of this many entries.
const PADDING: usize = 16;
/// Where padding lies: the square is within f32, and beyond all that is summed in f64.
const FAR: f64 = 1e15;

/// Columns of reals of one length; entries from `len` up to the next multiple of the lanes are harmless padding.
#[derive(Clone, Debug)]
pub struct Block<E, const COLUMNS: usize> {
    pub columns: [Vec<E>; COLUMNS],
    pub len: usize,
}

/// x, y, z, eps^2, m.
pub type Points<E> = Block<E, 5>;
/// x, y, z, eps^2.
pub type Targets<E> = Block<E, 4>;

impl<E: Real, const COLUMNS: usize> Block<E, COLUMNS> {
    pub fn with_capacity(capacity: usize) -> Self {
        let column = || vec![E::from_f64(0.0); capacity.next_multiple_of(PADDING)];
        Self {
            columns: std::array::from_fn(|_| column()),
            len: 0,
        }
    }

    /// Fills up to the next multiple of the lanes with massless entries far away from everything, where no pair is resolved.
    #[inline(always)]
    pub fn pad(&mut self) {
        for i in self.len..self.len.next_multiple_of(PADDING) {
            for (c, column) in self.columns.iter_mut().enumerate() {
                column[i] = E::from_f64(if c == 0 { FAR } else { 0.0 });
            }
        }
    }
}

/// Pull on one target, in units of the group.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pull {
    pub a: [f64; 3],
    pub phi: f64,
}

/// Targets abreast, each coordinate in all lanes.
struct Abreast<V> {
    x: [V; ABREAST],
    y: [V; ABREAST],
    z: [V; ABREAST],
    e: [V; ABREAST],
}

#[inline(always)]
fn abreast<S: Simd, E: Real>(simd: S, targets: &Targets<E>, first: usize) -> Abreast<E::Native<S>> {
    let zero = same::<S, E>(simd, 0.0);
    let mut t = Abreast {
        x: [zero; ABREAST],
        y: [zero; ABREAST],
        z: [zero; ABREAST],
        e: [zero; ABREAST],
    };
    let [x, y, z, e] = &targets.columns;
    for k in 0..ABREAST {
        t.x[k] = E::Native::<S>::splat(simd, x[first + k]);
        t.y[k] = E::Native::<S>::splat(simd, y[first + k]);
        t.z[k] = E::Native::<S>::splat(simd, z[first + k]);
        t.e[k] = E::Native::<S>::splat(simd, e[first + k]);
    }
    t
}

#[inline(always)]
fn same<S: Simd, E: Real>(simd: S, value: f64) -> E::Native<S> {
    E::Native::<S>::splat(simd, E::from_f64(value))
}

#[inline(always)]
fn load<S: Simd, E: Real, const C: usize>(
    simd: S,
    block: &Block<E, C>,
    column: usize,
    i: usize,
) -> E::Native<S> {
    E::Native::<S>::from_slice(simd, &block.columns[column][i..i + E::Native::<S>::LEN])
}

/// Separation and softened square of the distance from target `k` to `sources`: x, y, z, eps^2.
#[inline(always)]
fn separation<S: Simd, V: SimdFloat<S>>(
    t: &Abreast<V>,
    k: usize,
    [x, y, z, e]: [V; 4],
) -> ([V; 3], V) {
    let (dx, dy, dz) = (x - t.x[k], y - t.y[k], z - t.z[k]);
    let e = e + t.e[k];
    (
        [dx, dy, dz],
        dz.mul_add(dz, dy.mul_add(dy, dx.mul_add(dx, e))),
    )
}

/// The first four columns of a block at `i`.
#[inline(always)]
fn places<S: Simd, E: Real, const C: usize>(
    simd: S,
    block: &Block<E, C>,
    i: usize,
) -> [E::Native<S>; 4] {
    let (x, y) = (load(simd, block, 0, i), load(simd, block, 1, i));
    let (z, e) = (load(simd, block, 2, i), load(simd, block, 3, i));
    [x, y, z, e]
}

/// Adds the pull of `block` to `pulls`. With `NEAR`, pairs with q^2 <= `closest` are left out and counted in `hits`.
#[inline(always)]
pub fn pull_of_points<S: Simd, E: Real, R: Lanes<S, E>, const POTENTIAL: bool, const NEAR: bool>(
    simd: S,
    targets: &Targets<E>,
    block: &Points<E>,
    closest: E,
    pulls: &mut [Pull],
    hits: &mut [u32],
) {
    let (zero, one) = (same::<S, E>(simd, 0.0), same::<S, E>(simd, 1.0));
    let closest = E::Native::<S>::splat(simd, closest);
    for first in (0..targets.len).step_by(ABREAST) {
        let t = abreast(simd, targets, first);
        let mut a = [[zero; 3]; ABREAST];
        let mut phi = [zero; ABREAST];
        let mut near = [zero; ABREAST];
        for i in (0..block.len).step_by(E::Native::<S>::LEN) {
            let places = places(simd, block, i);
            let m = load(simd, block, 4, i);
            for k in 0..ABREAST {
                let (d, q) = separation(&t, k, places);
                let y = R::inverse_root(simd, q);
                let y2 = y * y;
                let my = m * y;
                let mut w = my * y2;
                let mut p = my;
                if R::TERMS > 0 {
                    // The rest e of the estimate: q^(-3/2) = y^3 (1 + 3/2 e + 15/8 e^2 + ...), and so on.
                    let e = (-q).mul_add(y2, one);
                    w *= series::<S, E, R>(simd, e, [1.0, 1.5, 1.875, 2.1875]);
                    if POTENTIAL {
                        p *= series::<S, E, R>(simd, e, [1.0, 0.5, 0.375, 0.3125]);
                    }
                }
                if NEAR {
                    let far = q.simd_gt(closest);
                    w = far.select(w, zero);
                    p = far.select(p, zero);
                    near[k] += far.select(zero, one);
                }
                for axis in 0..3 {
                    a[k][axis] = d[axis].mul_add(w, a[k][axis]);
                }
                if POTENTIAL {
                    phi[k] += p;
                }
            }
        }
        let served = ABREAST.min(targets.len - first);
        add::<S, E, R, POTENTIAL>(&mut pulls[first..first + served], &a, &phi);
        if NEAR {
            for k in 0..served {
                hits[first + k] = R::sum(near[k]) as u32;
            }
        }
    }
}

/// The first terms of a series in `e`, as many as an estimate wants.
#[inline(always)]
fn series<S: Simd, E: Real, R: Lanes<S, E>>(
    simd: S,
    e: E::Native<S>,
    coefficients: [f64; 4],
) -> E::Native<S> {
    let mut sum = same::<S, E>(simd, coefficients[R::TERMS]);
    for k in (0..R::TERMS).rev() {
        sum = sum.mul_add(e, same::<S, E>(simd, coefficients[k]));
    }
    sum
}

/// Adds the sums of a block over its lanes to `pulls`.
#[inline(always)]
fn add<S: Simd, E: Real, R: Lanes<S, E>, const POTENTIAL: bool>(
    pulls: &mut [Pull],
    a: &[[E::Native<S>; 3]; ABREAST],
    phi: &[E::Native<S>; ABREAST],
) {
    for (k, pull) in pulls.iter_mut().enumerate() {
        for (sum, part) in pull.a.iter_mut().zip(a[k]) {
            *sum += R::sum(part);
        }
        if POTENTIAL {
            pull.phi -= R::sum(phi[k]);
        }
    }
}

/// Calls `visit` with every source of `block` that [`pull_of_points`] left out for target `target`.
#[inline(always)]
pub fn each_near<S: Simd, E: Real>(
    simd: S,
    targets: &Targets<E>,
    target: usize,
    block: &Points<E>,
    closest: E,
    mut visit: impl FnMut(usize),
) {
    let first = target - target % ABREAST;
    let t = abreast(simd, targets, first);
    let closest = E::Native::<S>::splat(simd, closest);
    for i in (0..block.len).step_by(E::Native::<S>::LEN) {
        let (_, q) = separation(&t, target - first, places(simd, block, i));
        let mut bits = (!q.simd_gt(closest)).to_bitmask();
        while bits != 0 {
            visit(i + bits.trailing_zeros() as usize);
            bits &= bits - 1;
        }
    }
}
