//! Tensor viscosity: each axis of strain that is compressed has a stress of its own along it.
//!
//! Q = sum over l_k < 0 of q(l_k) n_k n_k, as in [`stress`](super::stress)
//!
//! A shear is half compression and half expansion, and is damped. Source: Owen (2004), JCP 201, 601 (the idea; there the gradient
//! is applied pair by pair).

use nalgebra::Matrix3;

use super::stress::{Place, Strain};

/// The stress.
pub fn stress(place: &Place, strain: &Strain, alpha: f64, beta: f64) -> Matrix3<f64> {
    let along = |k: usize| place.along(strain, k, alpha, beta);
    along(0) + along(1) + along(2)
}
