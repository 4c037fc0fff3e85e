//! Relaxation: u' = -x u + a over a unit of time, for any x from 0 to infinity; eight at once.
//!
//! u(1) = u(0) e^-x + a (1 - e^-x)/x; the change beyond that by a alone is -lost(x) u(0) - lag(x) a.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x8};
use nbody::points::exponential::{lost, series};

/// Eight vectors.
pub type Vectors<S> = [f64x8<S>; 3];

/// 1 - e^-x and 1 - (1 - e^-x)/x.
#[derive(Clone, Copy)]
pub struct Relaxation<S: Simd> {
    pub lost: f64x8<S>,
    pub lag: f64x8<S>,
}

/// x/2! - x^2/3! + ..., to x^13 for 16 digits at 0.5.
const SERIES: [f64; 13] = {
    let mut series = [0.5; 13];
    let mut n = 1;
    while n < series.len() {
        series[n] = -series[n - 1] / (n + 2) as f64;
        n += 1;
    }
    series
};

impl<S: Simd> Relaxation<S> {
    #[inline(always)]
    pub fn of(simd: S, x: f64x8<S>) -> Self {
        let lost = lost(simd, x);
        let few = x.min(0.5);
        let closed = -(lost / x) + 1.0;
        let lag = x
            .simd_gt(0.5)
            .select(closed, few * series(simd, few, &SERIES));
        Self { lost, lag }
    }

    /// Change of u by the relaxation alone.
    #[inline(always)]
    pub fn change(&self, u: &Vectors<S>, a: &Vectors<S>) -> Vectors<S> {
        [
            -(self.lost * u[0]) - self.lag * a[0],
            -(self.lost * u[1]) - self.lag * a[1],
            -(self.lost * u[2]) - self.lag * a[2],
        ]
    }
}

#[cfg(test)]
mod tests {
    use fearless_simd::Level;

    use super::*;

    fn at(x: f64) -> (f64, f64) {
        let mut values = [[0.0; 8]; 2];
        nbody::widest!(Level::new(), simd => {
            let both = Relaxation::of(simd, f64x8::splat(simd, x));
            both.lag.store_slice(&mut values[0]);
            both.lost.store_slice(&mut values[1]);
        });
        (values[0][0], values[1][0])
    }

    #[test]
    fn series_and_closed_form_meet() {
        for x in [0.45f64, 0.5, 0.500001, 0.6, 2.0] {
            let closed = 1.0 + (-x).exp_m1() / x;
            let error = (at(x).0 / closed - 1.0).abs();
            // The closed form loses three bits here.
            assert!(error < 2e-15, "{x}: {error:e}");
        }
    }

    #[test]
    fn limits_are_right_to_the_last_digit() {
        assert_eq!(at(0.0), (0.0, 0.0));
        let (lag, lost) = at(1e-12);
        assert!((lag / 0.5e-12 - 1.0).abs() < 1e-11);
        assert!((lost / 1e-12 - 1.0).abs() < 1e-11);
        assert_eq!(at(f64::INFINITY), (1.0, 1.0));
    }
}
