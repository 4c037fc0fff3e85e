//! Gauss-Radau spacings of order 15 and the two forms of the polynomial through them.
//!
//! a(s) = a0 + b0 s + ... + b6 s^7 = a0 + g0 s + g1 s (s - h1) + ... + g6 s (s - h1)...(s - h6), 0 <= s <= 1.
//! b_k = sum_j C[j][k] g_j, g_k = sum_j D[j][k] b_j. The h are the roots of P7(2h - 1) + P8(2h - 1), P Legendre's polynomials.
//! Source: Everhart (1985).

#[allow(clippy::excessive_precision)] // twenty digits, whatever the type
pub const H: [f64; 8] = [
    0.0,
    0.056_262_560_536_922_146_466,
    0.180_240_691_736_892_364_99,
    0.352_624_717_113_169_637_37,
    0.547_153_626_330_555_383,
    0.734_210_177_215_410_531_52,
    0.885_320_946_839_095_768_09,
    0.977_520_613_561_287_501_89,
];

/// Coefficient of s^(k+1) in s (s - h1)...(s - hj).
pub const C: [[f64; 7]; 7] = {
    let mut c = [[0.0; 7]; 7];
    c[0][0] = 1.0;
    let mut j = 1;
    while j < 7 {
        let mut k = 0;
        while k <= j {
            let raised = if k > 0 { c[j - 1][k - 1] } else { 0.0 };
            c[j][k] = raised - H[j] * c[j - 1][k];
            k += 1;
        }
        j += 1;
    }
    c
};

/// Inverse of [`C`].
pub const D: [[f64; 7]; 7] = {
    let mut d = [[0.0; 7]; 7];
    d[0][0] = 1.0;
    let mut j = 1;
    while j < 7 {
        let mut k = 0;
        while k <= j {
            let raised = if k > 0 { d[j - 1][k - 1] } else { 0.0 };
            d[j][k] = raised + H[k + 1] * d[j - 1][k];
            k += 1;
        }
        j += 1;
    }
    d
};

/// 1/(h_n - h_k) for k < n.
pub const R: [[f64; 8]; 8] = {
    let mut r = [[0.0; 8]; 8];
    let mut n = 1;
    while n < 8 {
        let mut k = 0;
        while k < n {
            r[n][k] = 1.0 / (H[n] - H[k]);
            k += 1;
        }
        n += 1;
    }
    r
};

/// Binomial coefficients (j + 1 over k + 1): the shift of the polynomial by one step.
pub const SHIFT: [[f64; 7]; 7] = {
    let mut shift = [[0.0; 7]; 7];
    let mut j = 0;
    while j < 7 {
        shift[j][0] = (j + 1) as f64;
        let mut k = 1;
        while k <= j {
            shift[j][k] = shift[j][k - 1] * (j + 1 - k) as f64 / (k + 1) as f64;
            k += 1;
        }
        j += 1;
    }
    shift
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spacings_are_the_roots_of_legendres_sum() {
        for h in H {
            let (x, mut last, mut p) = (2.0 * h - 1.0, 1.0, 2.0 * h - 1.0);
            for n in 1..8 {
                let n = f64::from(n);
                let next = ((2.0 * n + 1.0) * x * p - n * last) / (n + 1.0);
                (last, p) = (p, next);
            }
            // `last` is P7, `p` is P8; their slopes are below 36.
            assert!((last + p).abs() < 4e-15, "{h}: {:e}", last + p);
        }
    }

    #[test]
    fn the_quadrature_on_the_spacings_is_exact_to_degree_fourteen() {
        // Weights from the conditions to degree 7 by Lagrange's polynomials, expanded.
        let weight = |i: usize| {
            let mut poly = vec![1.0];
            for j in (0..8).filter(|&j| j != i) {
                let mut next = vec![0.0; poly.len() + 1];
                for (k, p) in poly.iter().enumerate() {
                    next[k + 1] += p / (H[i] - H[j]);
                    next[k] -= p * H[j] / (H[i] - H[j]);
                }
                poly = next;
            }
            let terms = poly.iter().enumerate();
            terms.map(|(k, p)| p / (k + 1) as f64).sum::<f64>()
        };
        let weights: Vec<f64> = (0..8).map(weight).collect();
        for degree in 0..15 {
            let sum: f64 = (0..8).map(|i| weights[i] * H[i].powi(degree)).sum();
            assert!(
                (sum * f64::from(degree + 1) - 1.0).abs() < 3e-13,
                "{degree}: {sum}"
            );
        }
        let beyond: f64 = (0..8).map(|i| weights[i] * H[i].powi(15)).sum();
        assert!((16.0 * beyond - 1.0).abs() > 1e-9);
    }

    #[test]
    fn both_forms_of_the_polynomial_agree() {
        for j in 0..7 {
            let product = |k: usize| (0..7).map(|i| D[j][i] * C[i][k]).sum::<f64>();
            for (k, product) in (0..7).map(product).enumerate() {
                let unit = if j == k { 1.0 } else { 0.0 };
                assert!((product - unit).abs() < 1e-15, "{j} {k} {product}");
            }
            // The product s (s - h1)...(s - hj) vanishes at its roots.
            for h in &H[..=j] {
                let value: f64 = (0..7).map(|k| C[j][k] * h.powi(k as i32 + 1)).sum();
                assert!(value.abs() < 2e-16, "{j} {h} {value}");
            }
        }
    }

    #[test]
    fn the_shift_is_the_polynomial_of_the_next_step() {
        assert_eq!(SHIFT[6], [7.0, 21.0, 35.0, 35.0, 21.0, 7.0, 1.0]);
        assert_eq!(SHIFT[1], [2.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    }
}
