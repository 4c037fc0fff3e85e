//! Exponential: 1 - e^-x and ln(1 + x) of eight numbers at once, to a few units of the last place for any x from 0 to infinity.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x8, i64x8};

/// ln 2 as a number of few bits and the rest.
const LN_2: [f64; 2] = [0.693_147_180_369_123_8, 1.908_214_929_270_587_7e-10];

/// To this a number is added to have it as an integer in the lowest bits.
const INTEGER: f64 = 6_755_399_441_055_744.0;

/// 1/2!, 1/3!, ..., enough for half of ln 2.
const FACTORIALS: [f64; 13] = {
    let mut series = [0.5; 13];
    let mut n = 1;
    while n < series.len() {
        series[n] = series[n - 1] / (n + 2) as f64;
        n += 1;
    }
    series
};

/// 1 - e^-x.
#[inline(always)]
pub fn lost<S: Simd>(simd: S, x: f64x8<S>) -> f64x8<S> {
    // Beyond, nothing is left in 53 bits; and the powers of two below are normal numbers.
    let x = -x.min(700.0);
    let shifted = x * std::f64::consts::LOG2_E + INTEGER;
    let k = shifted - INTEGER;
    let r = k.mul_add(-LN_2[1], k.mul_add(-LN_2[0], x));
    let tail = series(simd, r, &FACTORIALS);
    let change = (r * r).mul_add(tail, r);
    let bits = (shifted.bitcast::<i64x8<S>>() + 1023) << 52;
    let power = bits.bitcast::<f64x8<S>>();
    -power.mul_add(change, power - 1.0)
}

/// A polynomial by its coefficients from the lowest on.
#[inline(always)]
pub fn series<S: Simd>(simd: S, x: f64x8<S>, coefficients: &[f64]) -> f64x8<S> {
    // Even and odd powers by themselves: two sums that do not wait for each other.
    let none = f64x8::splat(simd, 0.0);
    let (mut even, mut odd) = (none, none);
    let square = x * x;
    for pair in coefficients.chunks(2).rev() {
        even = square.mul_add(even, f64x8::splat(simd, pair[0]));
        odd = match pair {
            &[_, c] => square.mul_add(odd, f64x8::splat(simd, c)),
            _ => none,
        };
    }
    x.mul_add(odd, even)
}

/// 1/3, 1/5, ..., enough for arguments below 1/5.
const ODD: [f64; 11] = {
    let mut series = [0.0; 11];
    let mut n = 0;
    while n < series.len() {
        series[n] = 1.0 / (2 * n + 3) as f64;
        n += 1;
    }
    series
};

/// ln(1 + x).
#[inline(always)]
pub fn ln_1p<S: Simd>(simd: S, x: f64x8<S>) -> f64x8<S> {
    if x.simd_lt(0.5).to_bitmask() == 0xff {
        // 2 artanh s.
        let s = x / (x + 2.0);
        let s2 = s * s;
        return (s * 2.0) * (s2 * series(simd, s2, &ODD) + 1.0);
    }
    let mut values = [0.0; 8];
    x.store_slice(&mut values);
    for value in &mut values {
        *value = value.ln_1p();
    }
    f64x8::from_slice(simd, &values)
}

#[cfg(test)]
mod tests {
    use fearless_simd::Level;

    use super::*;

    /// 1 - e^-x and ln(1 + x).
    fn both(x: f64) -> [f64; 2] {
        let mut values = [[0.0; 8]; 2];
        crate::widest!(Level::new(), simd => {
            let x = f64x8::splat(simd, x);
            lost(simd, x).store_slice(&mut values[0]);
            ln_1p(simd, x).store_slice(&mut values[1]);
        });
        values.map(|value| value[7])
    }

    #[test]
    fn they_agree_with_the_functions_of_one_number() {
        for n in -600..60 {
            let x = 10f64.powf(0.05 * f64::from(n));
            let [lost, log] = both(x);
            assert!(
                (lost / -(-x).exp_m1() - 1.0).abs() < 1e-15,
                "{x:e}: {lost:e}"
            );
            assert!((log / x.ln_1p() - 1.0).abs() < 1e-15, "{x:e}: {log:e}");
        }
        assert_eq!(both(0.0), [0.0, 0.0]);
        assert_eq!(both(f64::INFINITY), [1.0, f64::INFINITY]);
    }
}
