//! The viscosity of von Neumann, Richtmyer and Landshoff: a pressure where gas converges, with div v exact for linear flows.
//!
//! Q = q(div v) 1 for div v < 0, as in [`stress`](super::stress)
//!
//! A shear has no divergence, and none of it. Sources: von Neumann & Richtmyer (1950), Landshoff (1955); with a high-order
//! div v in SPH: Hosono, Saitoh & Makino (2016), ApJS 224, 32.

use nalgebra::Matrix3;

use super::stress::Place;

/// The stress.
pub fn stress(place: &Place, alpha: f64, beta: f64) -> Matrix3<f64> {
    Matrix3::identity() * place.pressure(place.gradient.trace(), alpha, beta)
}
