//! Smoothing kernels W(r, H) = norm / H^d w(r / H), zero from r = H on, in two and three dimensions.
//!
//! The smoothing length h = H / support is twice the kernel's standard deviation, so that kernels of equal h resolve alike.
//! Source: Dehnen & Aly (2012), table 1.

use std::f64::consts::PI;
use std::ops::{Add, Div, Mul, Sub};

use fearless_simd::{Simd, SimdFloat};

use crate::lanes;

mod splines;
mod wendland;

pub use splines::{CubicSpline, QuinticSpline};
pub use wendland::{WendlandC2, WendlandC4, WendlandC6};

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
    QuinticSpline,
    WendlandC2,
    WendlandC4,
    WendlandC6,
}

/// Calls a function of the kernel: in loops over pairs a branch that is always the same way, so that sweeps are compiled once for all kernels.
macro_rules! of_kernel {
    ($kind:expr, $function:ident($($argument:expr),*)) => {
        match $kind {
            KernelKind::CubicSpline => CubicSpline::$function($($argument),*),
            KernelKind::QuinticSpline => QuinticSpline::$function($($argument),*),
            KernelKind::WendlandC2 => WendlandC2::$function($($argument),*),
            KernelKind::WendlandC4 => WendlandC4::$function($($argument),*),
            KernelKind::WendlandC6 => WendlandC6::$function($($argument),*),
        }
    };
}

impl KernelKind {
    /// All kernels.
    pub const ALL: [Self; 5] = [
        Self::CubicSpline,
        Self::QuinticSpline,
        Self::WendlandC2,
        Self::WendlandC4,
        Self::WendlandC6,
    ];

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
mod tests;
