//! Stiffness: what sums of density over a kernel that follows them make of a plane wave of sound in isothermal gas of the plane.
//!
//! omega^2 = c^2 k^2 (2 W - W^2 + K W),   W(k H) = 2 pi int W(r, H) J_0(k r) r dr,   K = -dW/dlnH
//!
//! from the second order of sum m c^2 ln rho_i in a displacement A sin(k x) of particles that fill the plane evenly: 2 W - W^2 is that of one H, and
//! K W of H^2 rho kept the same: H is small where gas is dense, so that the sums see more of the wave. With k H small it is 1 + (k s)^2, s the
//! kernel's standard deviation along an axis.

use std::f64::consts::PI;

use gas::Kernel;

/// Parts of the integrals.
const PARTS: usize = 200;

/// omega^2 / (c k)^2 - 1 of a kernel of support H, by k H.
pub fn stiffening<K: Kernel>(k_reach: f64) -> f64 {
    let small = 1e-4;
    let [less, wave, more] = [1.0 - small, 1.0, 1.0 + small].map(|part| seen::<K>(k_reach * part));
    let slope = (less - more) / (2.0 * small);
    2.0 * wave - wave * wave + slope * wave - 1.0
}

/// W: the part of a wave that sums see.
fn seen<K: Kernel>(k_reach: f64) -> f64 {
    let mut sums = [0.0; 2];
    for part in 0..PARTS {
        let q = (part as f64 + 0.5) / PARTS as f64;
        let weight = q * K::value(q);
        sums[0] += weight * bessel(k_reach * q);
        sums[1] += weight;
    }
    sums[0] / sums[1]
}

/// J_0(x), the mean of cos(x sin t).
fn bessel(x: f64) -> f64 {
    let angle = |part: usize| PI * (part as f64 + 0.5) / PARTS as f64;
    let sum: f64 = (0..PARTS).map(|part| (x * angle(part).sin()).cos()).sum();
    sum / PARTS as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use gas::{WendlandC2, WendlandC4};

    fn near(a: f64, b: f64, bar: f64) {
        assert!((a / b - 1.0).abs() < bar, "{a} {b}");
    }

    /// The first zero and a value of J_0 (Abramowitz & Stegun, table 9.1).
    #[test]
    fn bessel_has_its_values() {
        assert!(bessel(2.404_825_557_7).abs() < 1e-9);
        near(bessel(1.0), 0.765_197_686_6, 1e-9);
    }

    #[test]
    fn long_waves_are_stiffer_by_the_square_of_the_kernel_s_deviation() {
        // s = h / 2 = H / (2 support) of every kernel.
        let small = 0.05;
        let expected = |support: f64| (small / (2.0 * support)).powi(2);
        near(
            stiffening::<WendlandC2>(small),
            expected(WendlandC2::support(2)),
            2e-3,
        );
        near(
            stiffening::<WendlandC4>(small),
            expected(WendlandC4::support(2)),
            2e-3,
        );
    }
}
