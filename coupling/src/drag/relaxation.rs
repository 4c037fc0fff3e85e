//! Relaxation: u' = -x u + a over a unit of time, for any x from 0 to infinity.
//!
//! u(1) = u(0) e^-x + a (1 - e^-x)/x; the change beyond that by a alone is -lost(x) u(0) - lag(x) a.

use nbody::points::Vec3;

/// 1 - e^-x.
pub fn lost(x: f64) -> f64 {
    -(-x).exp_m1()
}

/// 1 - (1 - e^-x)/x.
pub fn lag(x: f64) -> f64 {
    if x > 0.5 {
        return 1.0 - lost(x) / x;
    }
    // x/2! - x^2/3! + ..., to x^13 for 16 digits at 0.5.
    let mut term = 0.5 * x;
    let mut sum = term;
    for n in 3..15 {
        term *= -x / f64::from(n);
        sum += term;
    }
    sum
}

/// Change of u by the relaxation alone.
pub fn change(x: f64, u: Vec3, a: Vec3) -> Vec3 {
    -lost(x) * u - lag(x) * a
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
