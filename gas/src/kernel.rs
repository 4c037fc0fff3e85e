//! Smoothing kernels W(r, H) = norm / H^d w(r / H), zero from r = H on, in two and three dimensions.
//!
//! The smoothing length h = H / support is twice the kernel's standard deviation, so that kernels of equal h resolve alike.
//! Source: Dehnen & Aly (2012), table 1.

use std::f64::consts::PI;
use std::ops::{Add, Div, Mul, Sub};

use fearless_simd::{Simd, SimdFloat};

use crate::lanes;

/// A number or lanes of numbers; `S` is [`Scalar`] or the machine's instruction set.
pub trait Number<S>:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// a times itself plus b.
    fn line(self, a: f64, b: f64) -> Self;

    /// The greater of both.
    fn at_least(self, bound: f64) -> Self;
}

/// The instruction set of single numbers.
pub struct Scalar;

impl Number<Scalar> for f64 {
    #[inline(always)]
    fn line(self, a: f64, b: f64) -> Self {
        self * a + b
    }

    #[inline(always)]
    fn at_least(self, bound: f64) -> Self {
        self.max(bound)
    }
}

impl<S: Simd, V: SimdFloat<S>> Number<S> for V
where
    V::Element: lanes::Real,
{
    #[inline(always)]
    fn line(self, a: f64, b: f64) -> Self {
        let [a, b] =
            [a, b].map(|x| V::splat(self.token(), <V::Element as lanes::Real>::from_f64(x)));
        self.mul_add(a, b)
    }

    #[inline(always)]
    fn at_least(self, bound: f64) -> Self {
        self.max(V::splat(
            self.token(),
            <V::Element as lanes::Real>::from_f64(bound),
        ))
    }
}

/// The form of a kernel; q = r / H.
pub trait Kernel: Copy + Send + Sync + 'static {
    /// Kernel support by smoothing length, H / h.
    fn support(dimensions: usize) -> f64;

    /// The factor that normalises [`Kernel::value`].
    fn norm(dimensions: usize) -> f64;

    /// w(q), not normalised.
    fn value<S, N: Number<S>>(q: N) -> N;

    /// (dw/dq) / q, not normalised; finite at q = 0.
    fn slope<S, N: Number<S>>(q: N) -> N;

    /// The part of its own W(0, H) that a particle counts too much in its density, at this neighbour number.
    fn self_excess(_neighbours: f64, _dimensions: usize) -> f64 {
        0.0
    }

    /// W(r, H).
    fn w(r: f64, reach: f64, dimensions: usize) -> f64 {
        Self::norm(dimensions) / reach.powi(dimensions as i32) * Self::value(r / reach)
    }

    /// dW/dr (r, H).
    fn dw(r: f64, reach: f64, dimensions: usize) -> f64 {
        let q = r / reach;
        Self::norm(dimensions) / reach.powi(dimensions as i32 + 1) * Self::slope(q) * q
    }
}

/// The cubic B-spline (Monaghan & Lattanzio 1985).
#[derive(Clone, Copy, Debug)]
pub struct CubicSpline;

impl Kernel for CubicSpline {
    fn support(dimensions: usize) -> f64 {
        by_dimension(dimensions, 1.778_002, 1.825_742)
    }

    fn norm(dimensions: usize) -> f64 {
        by_dimension(dimensions, 80.0 / (7.0 * PI), 16.0 / PI)
    }

    #[inline(always)]
    fn value<S, N: Number<S>>(q: N) -> N {
        let outer = q.line(-1.0, 1.0).at_least(0.0);
        let inner = q.line(-1.0, 0.5).at_least(0.0);
        outer * outer * outer - (inner * inner * inner).line(4.0, 0.0)
    }

    #[inline(always)]
    fn slope<S, N: Number<S>>(q: N) -> N {
        let outer = q.line(-1.0, 1.0).at_least(0.0);
        let inner = q.line(-1.0, 0.5).at_least(0.0);
        // Both squares cancel at the centre, where the slope is -6; kept off zero, it comes out to 1e-8 there.
        ((inner * inner).line(12.0, 0.0) - (outer * outer).line(3.0, 0.0)) / q.at_least(1e-8)
    }
}

/// The kernel C2 of Wendland (1995): does not pair.
#[derive(Clone, Copy, Debug)]
pub struct WendlandC2;

impl Kernel for WendlandC2 {
    fn support(dimensions: usize) -> f64 {
        by_dimension(dimensions, 1.897_367, 1.936_492)
    }

    fn norm(dimensions: usize) -> f64 {
        by_dimension(dimensions, 7.0 / PI, 10.5 / PI)
    }

    /// Dehnen & Aly (2012), eq. 18 and table 2, in three dimensions.
    fn self_excess(neighbours: f64, dimensions: usize) -> f64 {
        by_dimension(dimensions, 0.0, 0.0294 * (0.01 * neighbours).powf(-0.977))
    }

    #[inline(always)]
    fn value<S, N: Number<S>>(q: N) -> N {
        let outer = q.line(-1.0, 1.0).at_least(0.0);
        let square = outer * outer;
        square * square * q.line(4.0, 1.0)
    }

    #[inline(always)]
    fn slope<S, N: Number<S>>(q: N) -> N {
        let outer = q.line(-1.0, 1.0).at_least(0.0);
        (outer * outer * outer).line(-20.0, 0.0)
    }
}

fn by_dimension(dimensions: usize, two: f64, three: f64) -> f64 {
    match dimensions {
        2 => two,
        3 => three,
        _ => panic!("kernels exist in two and three dimensions"),
    }
}

/// Volume of the unit sphere, area of the unit disk.
pub fn unit_sphere(dimensions: usize) -> f64 {
    by_dimension(dimensions, PI, 4.0 / 3.0 * PI)
}

/// The kernel of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KernelKind {
    CubicSpline,
    WendlandC2,
}

/// Calls a function of the kernel: in loops over pairs a branch that is always the same way, so that sweeps are compiled once for all kernels.
macro_rules! of_kernel {
    ($kind:expr, $function:ident($($argument:expr),*)) => {
        match $kind {
            KernelKind::CubicSpline => CubicSpline::$function($($argument),*),
            KernelKind::WendlandC2 => WendlandC2::$function($($argument),*),
        }
    };
}

impl KernelKind {
    /// Kernel support by smoothing length, H / h.
    pub fn support(self, dimensions: usize) -> f64 {
        of_kernel!(self, support(dimensions))
    }

    /// The factor that normalises [`KernelKind::value`].
    pub fn norm(self, dimensions: usize) -> f64 {
        of_kernel!(self, norm(dimensions))
    }

    /// As [`Kernel::self_excess`].
    pub fn self_excess(self, neighbours: f64, dimensions: usize) -> f64 {
        of_kernel!(self, self_excess(neighbours, dimensions))
    }

    /// w(q), not normalised.
    #[inline(always)]
    pub fn value<S, N: Number<S>>(self, q: N) -> N {
        of_kernel!(self, value(q))
    }

    /// (dw/dq) / q, not normalised.
    #[inline(always)]
    pub fn slope<S, N: Number<S>>(self, q: N) -> N {
        of_kernel!(self, slope(q))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Integrals of r^power W over space, by the midpoint rule in 20 000 shells (error 1e-9).
    fn moment<K: Kernel>(dimensions: usize, power: i32) -> f64 {
        let reach = 1.7;
        let shells = 20_000;
        let dr = reach / f64::from(shells);
        (0..shells)
            .map(|i| {
                let r = (f64::from(i) + 0.5) * dr;
                let shell =
                    unit_sphere(dimensions) * dimensions as f64 * r.powi(dimensions as i32 - 1);
                shell * r.powi(power) * K::w(r, reach, dimensions) * dr
            })
            .sum()
    }

    fn check<K: Kernel>() {
        for dimensions in [2, 3] {
            let mass = moment::<K>(dimensions, 0);
            assert!((mass - 1.0).abs() < 2e-9, "{dimensions}D: {mass}");
            let deviation = (moment::<K>(dimensions, 2) / dimensions as f64).sqrt();
            let support = 1.7 / (2.0 * deviation);
            assert!(
                (support / K::support(dimensions) - 1.0).abs() < 4e-7,
                "{dimensions}D: {support}"
            );
            for i in 1..100 {
                let (r, e) = (0.017 * f64::from(i), 1e-5);
                let by_difference =
                    (K::w(r + e, 1.7, dimensions) - K::w(r - e, 1.7, dimensions)) / (2.0 * e);
                assert!(
                    (K::dw(r, 1.7, dimensions) - by_difference).abs() < 2e-9,
                    "{dimensions}D at {r}"
                );
            }
            assert_eq!(K::w(1.7, 1.7, dimensions), 0.0);
            assert_eq!(K::dw(2.0, 1.7, dimensions), 0.0);
        }
    }

    #[test]
    fn kernels_hold_unit_mass_their_width_and_their_slope() {
        check::<CubicSpline>();
        check::<WendlandC2>();
    }
}
