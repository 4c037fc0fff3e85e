//! Gradients of the kernel: as they are, or corrected so that the gradient of a linear field is exact.
//!
//! G_ij = M_i grad W(r_ij, H_i),   M_i = y_i (sum_j x_j d (grad W)^T)^-1, d = r_i - r_j: then sum_j (x_j / y_i) (a_i - a_j) G_ij = -grad a for any linear a
//!
//! Guard: where the neighbours hardly span a volume, which shows by entries of M beyond any of a half space, M = 1. Forces take
//! P_i M_i and P_j M_j, so that momentum and energy are exact; so is angular momentum, see [`stress`](crate::viscosity::stress).
//! Without grad-h terms: the correction holds the sums to what the gradient of a constant and of a linear field must be.
//! Sources: Randles & Libersky (1996); Bonet & Lok (1999); in this conservative form: García-Senz, Cabezón & Escartín (2012).

use nalgebra::Matrix3;

/// How gradients of pressure are taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Gradient {
    #[default]
    Standard,
    Matrix,
}

/// Frobenius norm beyond which a correction is none: a particle at the edge of a half space has about 4.
const MOST: f64 = 8.0;

/// M from `inverse`, the inverse of sum_j x_j w' / q d d^T, by `scale` = -y H^(d+2) / norm.
pub(crate) fn correction(inverse: &Matrix3<f64>, scale: f64) -> Matrix3<f64> {
    let corrected = inverse * scale;
    if corrected.norm() < MOST {
        corrected
    } else {
        Matrix3::identity()
    }
}
