//! B-splines (Schoenberg 1946; Monaghan & Lattanzio 1985): the third, M4, and the fifth, M6.
//!
//! M4: w(q) = (1 - q)^3 - 4 (1/2 - q)^3,   M6: w(q) = (1 - q)^5 - 6 (2/3 - q)^5 + 15 (1/3 - q)^5,   each bracket counted where positive
//!
//! Particles pair under them where there are too many neighbours (M4: from about 60, M6: from about 200 in three dimensions).
//! Source: Dehnen & Aly (2012), table 1.

use std::f64::consts::PI;

use super::{Kernel, Number, by_dimension};

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

/// The quintic B-spline.
#[derive(Clone, Copy, Debug)]
pub struct QuinticSpline;

/// (end - q) where positive, and its fourth power.
#[inline(always)]
fn fourth<S, N: Number<S>>(q: N, end: f64) -> [N; 2] {
    let rest = q.line(-1.0, end).at_least(0.0);
    let square = rest * rest;
    [rest, square * square]
}

impl Kernel for QuinticSpline {
    fn support(dimensions: usize) -> f64 {
        by_dimension(dimensions, 2.158_130, 2.195_775)
    }

    fn norm(dimensions: usize) -> f64 {
        by_dimension(dimensions, 15_309.0 / (478.0 * PI), 2_187.0 / (40.0 * PI))
    }

    #[inline(always)]
    fn value<S, N: Number<S>>(q: N) -> N {
        let [a, a4] = fourth(q, 1.0);
        let [b, b4] = fourth(q, 2.0 / 3.0);
        let [c, c4] = fourth(q, 1.0 / 3.0);
        a4 * a - (b4 * b).line(6.0, 0.0) + (c4 * c).line(15.0, 0.0)
    }

    #[inline(always)]
    fn slope<S, N: Number<S>>(q: N) -> N {
        // Written out: a closure would be compiled without the lanes' instructions.
        let ([_, a], [_, b], [_, c]) = (fourth(q, 1.0), fourth(q, 2.0 / 3.0), fourth(q, 1.0 / 3.0));
        // As in the cubic spline: the terms cancel at the centre.
        (b.line(30.0, 0.0) - a.line(5.0, 0.0) - c.line(75.0, 0.0)) / q.at_least(1e-8)
    }
}
