//! The changeover K of a pair's force from the hard part, inside, to the soft part, outside.
//!
//! soft force = K(r/c) Newton's, hard force = (1 - K) Newton's, c the pair's cut-off: K = 0 below gamma c, 1 beyond c, between them
//! K = s^4 (35 - 84 s + 70 s^2 - 20 s^3), s = (r/c - gamma)/(1 - gamma), with three continuous derivatives. A central force has a
//! potential, so both parts, and their sum, conserve an energy.
//! Source: Duncan, Levison & Lee (1998), section 3; Oshino, Funato & Makino (2011), equation 15.

/// gamma: the inner radius in units of the cut-off.
pub const INNER: f64 = 0.1;

const WIDTH: f64 = 1.0 - INNER;

/// K at a separation of `y` cut-offs.
#[inline(always)]
pub fn soft_part(y: f64) -> f64 {
    let s = (y - INNER) * (1.0 / WIDTH);
    let s = if s > 0.0 { s } else { 0.0 };
    let s = if s < 1.0 { s } else { 1.0 };
    let s2 = s * s;
    s2 * s2 * (35.0 - 84.0 * s + s2 * (70.0 - 20.0 * s))
}

/// dK/dy at a separation of `y` cut-offs.
pub fn slope(y: f64) -> f64 {
    let s = ((y - INNER) / WIDTH).clamp(0.0, 1.0);
    let rise = s * (1.0 - s);
    140.0 * rise * rise * rise / WIDTH
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slope_is_the_derivative_and_the_ends_are_flat() {
        for k in 1..400 {
            let y = f64::from(k) * 0.003;
            let numerical = (soft_part(y + 1e-5) - soft_part(y - 1e-5)) / 2e-5;
            assert!((numerical - slope(y)).abs() < 4e-8, "{y}");
        }
        assert_eq!([0.0, 0.05, INNER].map(soft_part), [0.0; 3]);
        assert_eq!([1.0, 1.5, f64::INFINITY].map(soft_part), [1.0; 3]);
    }

    #[test]
    fn it_rises_with_the_fourth_power_and_is_the_same_backwards() {
        let at = |s: f64| soft_part(INNER + s * WIDTH);
        for k in 1..100 {
            let s = 0.01 * f64::from(k);
            assert!((at(s) + at(1.0 - s) - 1.0).abs() < 1e-14, "{s}");
        }
        // 35 s^4 (1 - 2.4 s + 2 s^2 - ...): three derivatives vanish at the end.
        for s in [1e-3, 1e-2] {
            let leading = at(s) / (35.0 * s.powi(4));
            assert!(
                (leading - (1.0 - 2.4 * s + 2.0 * s * s)).abs() < s * s * s,
                "{leading}"
            );
        }
    }
}
