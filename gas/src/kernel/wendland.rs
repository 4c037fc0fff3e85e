//! Kernels of Wendland (1995), C2, C4 and C6: of positive Fourier transform, so that particles do not pair at any number of neighbours.
//!
//! C2: w(q) = (1 - q)^4 (1 + 4 q),   C4: (1 - q)^6 (1 + 6 q + 35/3 q^2),   C6: (1 - q)^8 (1 + 8 q + 25 q^2 + 32 q^3)
//!
//! In three dimensions a particle counts itself too much; the excess is a fit to glasses.
//! Source: Dehnen & Aly (2012), table 1; eq. 18 and table 2 for the excess.

use std::f64::consts::PI;

use super::{Kernel, Number, by_dimension};

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

    fn self_excess(neighbours: f64, dimensions: usize) -> f64 {
        excess([0.0294, 0.977], neighbours, dimensions)
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

/// The fit of the excess: its value at 100 neighbours, and the power with which it falls.
fn excess([at_hundred, power]: [f64; 2], neighbours: f64, dimensions: usize) -> f64 {
    by_dimension(
        dimensions,
        0.0,
        at_hundred * (0.01 * neighbours).powf(-power),
    )
}

/// The kernel C4.
#[derive(Clone, Copy, Debug)]
pub struct WendlandC4;

impl Kernel for WendlandC4 {
    fn support(dimensions: usize) -> f64 {
        by_dimension(dimensions, 2.171_241, 2.207_940)
    }

    fn norm(dimensions: usize) -> f64 {
        by_dimension(dimensions, 9.0 / PI, 495.0 / (32.0 * PI))
    }

    fn self_excess(neighbours: f64, dimensions: usize) -> f64 {
        excess([0.013_42, 1.579], neighbours, dimensions)
    }

    #[inline(always)]
    fn value<S, N: Number<S>>(q: N) -> N {
        let outer = q.line(-1.0, 1.0).at_least(0.0);
        let square = outer * outer;
        square * square * square * (q * q.line(35.0 / 3.0, 6.0)).line(1.0, 1.0)
    }

    #[inline(always)]
    fn slope<S, N: Number<S>>(q: N) -> N {
        let outer = q.line(-1.0, 1.0).at_least(0.0);
        let square = outer * outer;
        (square * square * outer * q.line(5.0, 1.0)).line(-56.0 / 3.0, 0.0)
    }
}

/// The kernel C6.
#[derive(Clone, Copy, Debug)]
pub struct WendlandC6;

impl Kernel for WendlandC6 {
    fn support(dimensions: usize) -> f64 {
        by_dimension(dimensions, 2.415_230, 2.449_490)
    }

    fn norm(dimensions: usize) -> f64 {
        by_dimension(dimensions, 78.0 / (7.0 * PI), 1365.0 / (64.0 * PI))
    }

    fn self_excess(neighbours: f64, dimensions: usize) -> f64 {
        excess([0.0116, 2.236], neighbours, dimensions)
    }

    #[inline(always)]
    fn value<S, N: Number<S>>(q: N) -> N {
        let outer = q.line(-1.0, 1.0).at_least(0.0);
        let square = outer * outer;
        let fourth = square * square;
        let rest = (q * (q * q.line(32.0, 25.0)).line(1.0, 8.0)).line(1.0, 1.0);
        fourth * fourth * rest
    }

    #[inline(always)]
    fn slope<S, N: Number<S>>(q: N) -> N {
        let outer = q.line(-1.0, 1.0).at_least(0.0);
        let square = outer * outer;
        let seventh = square * square * square * outer;
        (seventh * (q * q.line(16.0, 7.0)).line(1.0, 1.0)).line(-22.0, 0.0)
    }
}
