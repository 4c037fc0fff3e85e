//! Response: what the kinds at a gas particle do to each other through it, at eight gas particles at once.
//!
//! At a gas particle kind k has the load S_k = sum |w| m / m_j, the mean slip u_k, the mean kick f_k relative to the gas and the mean number of e-foldings
//! x_k. With exp(y) - 1 = y phi(y), phi(y) = sum_p r_p / (y - z_p) for y < 0, the change of such gas over the half step is the sum over p of r_p G_p,
//!     G_p = -sum_k c_k S_k (u_k + f_k / z_p) / (1 + sum_k c_k S_k),   c_k = x_k / (x_k + z_p),
//! which solves a resolvent of the mixture in closed form, and a grain of kind k follows it by c_k G_p. From both is taken what they would be were
//! all like k. Loads are sums of |w|, so that no denominator vanishes.
//! The poles: Caratheodory-Fejer approximation of exp on the negative axis of type (14, 14), error 6e-14 (Trefethen, Weideman & Schmelzer 2006, BIT 46, 653).

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x8};
use nalgebra::Complex;

use super::relaxation::Vectors;

/// Gas particles that are answered at once.
pub const ABREAST: usize = 8;

/// [`super::kinds::Sums`] of a kind, by the mass of the gas, at eight gas particles: a column a number.
pub type Columns = [[f64; ABREAST]; 8];

/// Poles in the upper half plane, and twice their residues of phi.
const POLES: [[Complex<f64>; 2]; 7] = [
    [
        Complex::new(5.62317153474907, 1.1940664287035054),
        Complex::new(-16.86906600019298, -32.74970824777925),
    ],
    [
        Complex::new(5.089374564868055, 3.5888160956106345),
        Complex::new(20.766649169514505, 3.2934111397898334),
    ],
    [
        Complex::new(3.993400429645279, 6.004818060147936),
        Complex::new(-4.950213208530579, 4.534654507645974),
    ],
    [
        Complex::new(2.269816525848304, 8.461717806887696),
        Complex::new(-0.006966293637173381, -1.1380997388450373),
    ],
    [
        Complex::new(-0.20872377765454347, 10.991232026342253),
        Complex::new(0.06227298587028484, 0.06730172560041692),
    ],
    [
        Complex::new(-3.7032391601860652, 13.656333463723643),
        Complex::new(-0.0026936592713571092, -0.0006518716509266902),
    ],
    [
        Complex::new(-8.897735413193399, 16.63093520843589),
        Complex::new(1.700624732022173e-05, -4.954336853423439e-07),
    ],
];

/// Eight complex numbers.
#[derive(Clone, Copy)]
struct Complexes<S: Simd> {
    re: f64x8<S>,
    im: f64x8<S>,
}

impl<S: Simd> Complexes<S> {
    #[inline(always)]
    fn times(self, other: Self) -> Self {
        Self {
            re: self.re * other.re - self.im * other.im,
            im: self.re.mul_add(other.im, self.im * other.re),
        }
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Self {
            re: self.re + other.re,
            im: self.im + other.im,
        }
    }

    #[inline(always)]
    fn scaled(self, by: f64x8<S>) -> Self {
        Self {
            re: self.re * by,
            im: self.im * by,
        }
    }

    #[inline(always)]
    fn inverse(self) -> Self {
        let square = self.re.mul_add(self.re, self.im * self.im);
        Self {
            re: self.re / square,
            im: -(self.im / square),
        }
    }
}

/// A kind at eight gas particles: load, mean slip, mean kick, mean number of e-foldings; zeros where it is not.
struct Kind<S: Simd> {
    load: f64x8<S>,
    u: Vectors<S>,
    f: Vectors<S>,
    x: f64x8<S>,
}

/// From sums to means where there is a load, to zeros elsewhere.
#[inline(always)]
fn average<S: Simd>(simd: S, sums: &mut Columns) {
    let load = f64x8::from_slice(simd, &sums[3]);
    let none = f64x8::splat(simd, 0.0);
    // What has hardly a load at all has no inverse.
    let there = load.simd_gt(f64::MIN_POSITIVE);
    let inverse = there.select(f64x8::splat(simd, 1.0) / load, none);
    for column in [0, 1, 2, 4, 5, 6, 7] {
        (f64x8::from_slice(simd, &sums[column]) * inverse).store_slice(&mut sums[column]);
    }
}

impl<S: Simd> Kind<S> {
    #[inline(always)]
    fn of(simd: S, means: &Columns) -> Self {
        let column = |k: usize| f64x8::from_slice(simd, &means[k]);
        Self {
            load: column(3),
            u: [column(0), column(1), column(2)],
            f: [column(4), column(5), column(6)],
            x: column(7),
        }
    }

    /// How it follows the gas, c_k, at a pole.
    #[inline(always)]
    fn follows(&self, z: Complex<f64>) -> Complexes<S> {
        let re = self.x + z.re;
        let each = self.x / (re * re + z.im * z.im);
        Complexes {
            re: re * each,
            im: each * -z.im,
        }
    }

    /// u_k + f_k / z along an axis.
    #[inline(always)]
    fn pull(&self, inverse: Complex<f64>, axis: usize) -> Complexes<S> {
        Complexes {
            re: self.f[axis] * inverse.re + self.u[axis],
            im: self.f[axis] * inverse.im,
        }
    }
}

/// From the sums of each kind at eight gas particles to what a grain of each does beyond its own relaxation, and what the gas does beyond what such a
/// grain takes it to do: the first and the second three columns.
#[inline(always)]
pub fn respond<S: Simd>(simd: S, kinds: &mut [Columns]) {
    let none = f64x8::splat(simd, 0.0);
    let zero = Complexes { re: none, im: none };
    let one = Complexes {
        re: none + 1.0,
        im: none,
    };
    let load = (kinds.iter()).fold(none, |sum, kind| sum + f64x8::from_slice(simd, &kind[3]));
    kinds.iter_mut().for_each(|sums| average(simd, sums));
    let mut gas = [[zero; 3]; POLES.len()];
    for (gas, [z, _]) in gas.iter_mut().zip(POLES) {
        let (inverse, mut resistance) = (z.inv(), one);
        for sums in &*kinds {
            let kind = Kind::of(simd, sums);
            let c = kind.follows(z).scaled(kind.load);
            for (axis, sum) in gas.iter_mut().enumerate() {
                *sum = sum.plus(c.times(kind.pull(inverse, axis)));
            }
            resistance = resistance.plus(c);
        }
        let each = resistance.inverse().scaled(none - 1.0);
        *gas = gas.map(|sum| sum.times(each));
    }
    for sums in kinds {
        let kind = Kind::of(simd, sums);
        let mut answer = [none; 6];
        for ([z, residue], gas) in POLES.iter().zip(&gas) {
            let (inverse, c) = (z.inv(), kind.follows(*z));
            let whole = c.scaled(load);
            let alike = whole.times(whole.plus(one).inverse());
            let residue = Complexes {
                re: none + residue.re,
                im: none + residue.im,
            };
            for (axis, gas) in gas.iter().enumerate() {
                let beyond = gas.plus(alike.times(kind.pull(inverse, axis)));
                let beyond = beyond.times(residue);
                answer[axis] += c.times(beyond).re;
                answer[3 + axis] += beyond.re;
            }
        }
        let there = kind.load.simd_gt(0.0);
        for (&answer, column) in answer.iter().zip([0, 1, 2, 4, 5, 6]) {
            there.select(answer, none).store_slice(&mut sums[column]);
        }
        (sums[3], sums[7]) = ([0.0; ABREAST], [0.0; ABREAST]);
    }
}

#[cfg(test)]
mod tests {
    use fearless_simd::Level;

    use super::*;

    #[test]
    fn answers_are_finite_at_any_load_and_zero_where_a_kind_is_not() {
        let loads = [0.0, 1e-310, 1e-290, 1e-12, 1.0, 1e6, 1e12, 1e30];
        for folds in [0.0, 1e-30, 1.0, 1e30] {
            // A kind with these loads beside one that is everywhere.
            let kind = |loads: [f64; ABREAST], u: f64, x: f64| -> Columns {
                [u, -u, 0.0, 1.0, u, 0.0, u, x].map(|mean| loads.map(|load| mean * load))
            };
            let mut kinds = [kind(loads, 3.0, folds), kind([0.5; ABREAST], -1.0, 2.0)];
            nbody::widest!(Level::new(), simd => respond(simd, &mut kinds));
            assert!(
                kinds
                    .as_flattened()
                    .as_flattened()
                    .iter()
                    .all(|x| x.is_finite())
            );
            assert!(kinds[0].iter().all(|column| column[0] == 0.0));
        }
    }

    #[test]
    fn the_poles_make_an_exponential() {
        for x in [1e-12f64, 1e-6, 1e-3, 0.1, 1.0, 3.0, 10.0, 30.0, 1e3, 1e9] {
            let phi: f64 = (POLES.iter())
                .map(|[z, residue]| (residue / (Complex::from(-x) - z)).re)
                .sum();
            let error = phi * x + (-x).exp_m1();
            assert!(error.abs() < 2e-13_f64.min(5e-12 * x), "{x}: {error:e}");
        }
    }
}
