//! Relaxation: u' = -x u + a over a unit of time, for any x from 0 to infinity.
//!
//! u(1) = u(0) e^-x + a (1 - e^-x)/x; the change beyond that by a alone is -lost(x) u(0) - lag(x) a.

use nbody::points::Vec3;

/// 1 - e^-x.
pub fn lost(x: f64) -> f64 {
    -(-x).exp_m1()
}

/// 1/2!, 1/3!, ...
const SERIES: [f64; 13] = {
    let mut series = [0.5; 13];
    let mut n = 1;
    while n < 13 {
        series[n] = series[n - 1] / (n + 2) as f64;
        n += 1;
    }
    series
};

/// 1 - (1 - e^-x)/x.
pub fn lag(x: f64) -> f64 {
    if x > 0.5 {
        return 1.0 - lost(x) / x;
    }
    // x/2! - x^2/3! + ..., to x^13 for 16 digits at 0.5.
    x * SERIES.iter().rev().fold(0.0, |sum, c| c - x * sum)
}

/// Both at once.
#[derive(Clone, Copy, Debug)]
pub struct Relaxation {
    pub lost: f64,
    pub lag: f64,
}

impl Relaxation {
    pub fn of(x: f64) -> Self {
        if x > 0.5 {
            let lost = lost(x);
            let lag = 1.0 - lost / x;
            Self { lost, lag }
        } else {
            let lag = lag(x);
            let lost = x * (1.0 - lag);
            Self { lost, lag }
        }
    }

    /// Change of u by the relaxation alone.
    pub fn change(&self, u: Vec3, a: Vec3) -> Vec3 {
        -self.lost * u - self.lag * a
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_and_closed_form_meet() {
        for x in [0.45f64, 0.5, 0.500001, 0.6, 2.0] {
            let closed = 1.0 - lost(x) / x;
            let error = (lag(x) / closed - 1.0).abs();
            // The closed form loses three bits here.
            assert!(error < 2e-15, "{x}: {error:e}");
        }
    }

    #[test]
    fn limits_are_right_to_the_last_digit() {
        assert_eq!(lag(0.0), 0.0);
        assert_eq!(lost(0.0), 0.0);
        assert!((lag(1e-12) / 0.5e-12 - 1.0).abs() < 1e-11);
        assert!((lost(1e-12) / 1e-12 - 1.0).abs() < 1e-11);
        assert_eq!((lag(f64::INFINITY), lost(f64::INFINITY)), (1.0, 1.0));
    }
}
