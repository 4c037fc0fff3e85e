//! The kernels: pull of a block of point masses, or of quadrupoles, on a few targets; wide over the sources.
//!
//! Points:      a = sum m d / q^3,  phi = -sum m / q,  q^2 = d^2 + eps_i^2 + eps_j^2,  d from target to source.
//! Quadrupoles: a = sum d/q^3 (m + 15/2 u.S.u - 3/2 tr S) - 3 S.u / q^2,  with u = d/q and S = (sum m x x)/q^2,
//! the gradient of phi = -sum m/q + (3 u.S.u - tr S) / (2 q); second moments keep their trace, which softening makes felt.
//! Partial sums of a block are made in the element type, sums over blocks in f64.
//! Lengths are in units of the target group's size, so that no power of q leaves the range of f32.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask};

use super::lanes::{Lanes, Real};

/// Targets that one pass over a block serves.
pub const ABREAST: usize = 4;
/// Sources in a block of points, and of quadrupoles: what fits the first cache.
pub const POINTS: usize = 1024;
pub const QUADRUPOLES: usize = 512;
/// Columns are padded to a multiple of this many entries.
const PADDING: usize = 16;

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

    /// Fills up to the next multiple of the lanes with massless, softened entries at the centre.
    #[inline(always)]
    pub fn pad(&mut self) {
        for i in self.len..self.len.next_multiple_of(PADDING) {
            for (c, column) in self.columns.iter_mut().enumerate() {
                column[i] = E::from_f64(if c == 3 { 1.0 } else { 0.0 });
            }
        }
    }
}

/// Quadrupoles that lie together, column after column: x, y, z, eps^2, m, 3 S (xx, yy, zz, xy, xz, yz), 3/2 tr S.
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

#[inline(always)]
fn take<S: Simd, E: Real>(simd: S, column: &[E; BATCH], i: usize) -> E::Native<S> {
    E::Native::<S>::from_slice(simd, &column[i..i + E::Native::<S>::LEN])
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
    let (slope, offset) = (same::<S, E>(simd, -1.5), same::<S, E>(simd, 2.5));
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
                // m q^(-3/2) from the estimate y: y^3 (5 - 3 q y^2) / 2 is right to second order.
                let y = R::inverse_root(simd, q);
                let y2 = y * y;
                let my = m * y;
                let t = q * y2;
                let mut w = my * y2 * t.mul_add(slope, offset);
                let mut p = zero;
                if POTENTIAL {
                    p = my * t.mul_add(same::<S, E>(simd, -0.5), offset - one);
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

/// Adds the pull of a block of quadrupoles to `pulls`.
#[inline(always)]
pub fn pull_of_quadrupoles<S: Simd, E: Real, R: Lanes<S, E>, const POTENTIAL: bool>(
    simd: S,
    targets: &Targets<E>,
    block: &Quadrupoles<E>,
    pulls: &mut [Pull],
) {
    let zero = same::<S, E>(simd, 0.0);
    let (half, three_halves, five_halves) = (
        same::<S, E>(simd, 0.5),
        same::<S, E>(simd, 1.5),
        same::<S, E>(simd, 2.5),
    );
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
                for k in 0..ABREAST {
                    let (d, q) = separation(&t, k, places);
                    let y = R::inverse_root(simd, q);
                    let y = y * (q * y * y).mul_add(-half, three_halves);
                    let y2 = y * y;
                    let [ux, uy, uz] = [d[0] * y, d[1] * y, d[2] * y];
                    let gx = xx.mul_add(ux, xy.mul_add(uy, xz * uz));
                    let gy = xy.mul_add(ux, yy.mul_add(uy, yz * uz));
                    let gz = xz.mul_add(ux, yz.mul_add(uy, zz * uz));
                    let ug = ux.mul_add(gx, uy.mul_add(gy, uz * gz));
                    let c = y2 * y2.mul_add(five_halves.mul_add(ug, -trace), m);
                    let y4 = -(y2 * y2);
                    a[k][0] = ux.mul_add(c, gx.mul_add(y4, a[k][0]));
                    a[k][1] = uy.mul_add(c, gy.mul_add(y4, a[k][1]));
                    a[k][2] = uz.mul_add(c, gz.mul_add(y4, a[k][2]));
                    if POTENTIAL {
                        let second = half.mul_add(ug, trace * same::<S, E>(simd, -1.0 / 3.0));
                        phi[k] = y.mul_add(y2.mul_add(second, m), phi[k]);
                    }
                }
            }
        }
        let served = ABREAST.min(targets.len - first);
        add::<S, E, R, POTENTIAL>(&mut pulls[first..first + served], &a, &phi);
    }
}

#[cfg(test)]
mod rates;
#[cfg(test)]
mod tests {
    use super::super::lanes::Job;
    use super::*;
    use fearless_simd::Level;

    /// One source of each kind at the same place, pulling on one target.
    struct Once<'a, E> {
        targets: &'a Targets<E>,
        points: &'a Points<E>,
        quadrupoles: &'a Quadrupoles<E>,
        pulls: &'a mut [Pull],
    }

    impl<E: Real> Job<E> for Once<'_, E> {
        #[inline(always)]
        fn run<S: Simd, R: Lanes<S, E>>(self, simd: S) {
            let (one, two) = self.pulls.split_at_mut(1);
            let none = E::from_f64(0.0);
            pull_of_points::<S, E, R, true, false>(
                simd,
                self.targets,
                self.points,
                none,
                one,
                &mut [0],
            );
            pull_of_quadrupoles::<S, E, R, true>(simd, self.targets, self.quadrupoles, two);
        }
    }

    fn block<E: Real, const C: usize>(rows: &[[f64; C]]) -> Block<E, C> {
        let mut block = Block::with_capacity(rows.len());
        block.len = rows.len();
        for (i, row) in rows.iter().enumerate() {
            for (column, &value) in block.columns.iter_mut().zip(row) {
                column[i] = E::from_f64(value);
            }
        }
        block.pad();
        block
    }

    /// A batch of one quadrupole.
    fn batch<E: Real>(row: [f64; 12]) -> Batch<E> {
        let mut batch = Quadrupoles::empty_batch();
        for (column, value) in batch.iter_mut().zip(row) {
            column[0] = E::from_f64(value);
        }
        batch
    }

    /// Relative error of the quadrupole of a few points at `distance`, in force and potential.
    fn truncation<E: Real>(level: Level, distance: f64) -> (f64, f64) {
        let points = [
            [0.5, 0.1, -0.3, 0.04, 0.2],
            [-0.4, 0.3, 0.2, 0.04, 0.3],
            [0.04, -0.22, 0.0, 0.04, 0.5],
        ];
        let mut s = [0.0; 6];
        for [x, y, z, _, m] in points {
            for (s, p) in s.iter_mut().zip([x * x, y * y, z * z, x * y, x * z, y * z]) {
                *s += 3.0 * m * p;
            }
        }
        let trace = 0.5 * (s[0] + s[1] + s[2]);
        let row = [
            0.0, 0.0, 0.0, 0.04, 1.0, s[0], s[1], s[2], s[3], s[4], s[5], trace,
        ];
        let centre: [f64; 3] =
            std::array::from_fn(|axis| points.iter().map(|p| p[4] * p[axis]).sum());
        assert!(
            centre.iter().all(|c| c.abs() < 1e-12),
            "the points balance: {centre:?}"
        );
        let mut pulls = [Pull::default(); 2];
        E::run(
            level,
            Once {
                targets: &block(&[[0.48 * distance, -0.6 * distance, 0.64 * distance, 0.01]]),
                points: &block(&points),
                quadrupoles: &Quadrupoles {
                    batches: vec![batch(row)],
                },
                pulls: &mut pulls,
            },
        );
        let [exact, far] = pulls;
        let square = |a: [f64; 3]| a.iter().map(|a| a * a).sum::<f64>();
        let error = square(std::array::from_fn(|i| far.a[i] - exact.a[i]));
        (
            (error / square(exact.a)).sqrt(),
            ((far.phi - exact.phi) / exact.phi).abs(),
        )
    }

    #[test]
    fn quadrupoles_leave_a_third_order_error() {
        for level in [Level::new(), Level::baseline()] {
            let (near, far) = (
                truncation::<f64>(level, 8.0),
                truncation::<f64>(level, 16.0),
            );
            assert!(
                (near.0 / far.0).log2() > 2.9 && near.0 < 2e-3,
                "{near:?} {far:?}"
            );
            assert!(
                (near.1 / far.1).log2() > 2.9 && near.1 < 1e-3,
                "{near:?} {far:?}"
            );
            let single = truncation::<f32>(level, 8.0);
            assert!((single.0 - near.0).abs() < 1e-6 && (single.1 - near.1).abs() < 1e-6);
        }
    }
}
