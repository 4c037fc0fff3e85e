//! Artificial viscosity: a pressure between approaching particles.
//!
//! Pi = (-alpha c mu + beta mu^2) / rho,   mu = h v_ij.r_ij / (r^2 + 0.01 h^2)   for v_ij.r_ij < 0, else 0
//!
//! with alpha, c, rho and h the means of the pair; alpha_i is the column `alpha`, and beta follows it in a fixed ratio.
//! Sources: Monaghan & Gingold (1983), Monaghan (1992); switches: Balsara (1995), and [`cullen_dehnen`].
//!
//! What counts as approach is as [`reconstruction`] says.
//!
//! Others give each particle a [`stress`] of its own: [`neumann_richtmyer`], [`tensor`] and [`planar`].

pub mod cullen_dehnen;
pub mod neumann_richtmyer;
pub mod physical;
pub mod planar;
pub mod reconstruction;
pub mod stress;
pub mod tensor;

use cullen_dehnen::{Compression, relaxed};
use nalgebra::Matrix3;
use stress::{Place, Strain};

/// How alpha of a particle follows from its state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Viscosity {
    None,
    Constant {
        alpha: f64,
        beta: f64,
    },
    /// Constant times |div v| / (|div v| + |curl v| + 1e-4 c / h).
    Balsara {
        alpha: f64,
        beta: f64,
    },
    /// Between zero and `alpha`, as [`cullen_dehnen`] says.
    CullenDehnen {
        alpha: f64,
        beta: f64,
    },
    /// A pressure where gas converges.
    NeumannRichtmyer {
        alpha: f64,
        beta: f64,
    },
    /// A stress along each axis of compression.
    Tensor {
        alpha: f64,
        beta: f64,
    },
    /// alpha between zero and `alpha` where gas is compressed along one axis, between pairs.
    PlanarSwitch {
        alpha: f64,
        beta: f64,
    },
    /// A stress along the axis of compression where there is but one; alpha between zero and `alpha`.
    Planar {
        alpha: f64,
        beta: f64,
    },
}

/// What the gas around a particle does.
#[derive(Clone, Copy, Debug)]
pub struct Flow {
    pub div_v: f64,
    pub curl_v: f64,
    pub cs: f64,
    pub h: f64,
}

impl Viscosity {
    /// alpha of a particle in `flow` that had `present`.
    pub fn alpha(
        &self,
        flow: Flow,
        present: f64,
        compression: impl FnOnce() -> Compression,
    ) -> f64 {
        match *self {
            Self::None => 0.0,
            Self::CullenDehnen { alpha, .. } => compression().alpha(present, alpha),
            Self::Constant { alpha, .. }
            | Self::NeumannRichtmyer { alpha, .. }
            | Self::Tensor { alpha, .. } => alpha,
            // The stress says.
            Self::Planar { .. } | Self::PlanarSwitch { .. } => present,
            Self::Balsara { alpha, .. } => {
                let div = flow.div_v.abs();
                alpha * div / (div + flow.curl_v + 1e-4 * flow.cs / flow.h)
            }
        }
    }

    /// Whether it looks at how the gas turns.
    pub fn switches(&self) -> bool {
        matches!(self, Self::Balsara { .. } | Self::CullenDehnen { .. })
    }

    /// Whether it follows the change of the linear-exact divergence.
    pub fn remembers(&self) -> bool {
        matches!(self, Self::CullenDehnen { .. })
    }

    /// Whether it is a stress of each particle, not a pressure of each pair.
    pub fn is_stress(&self) -> bool {
        matches!(
            self,
            Self::NeumannRichtmyer { .. } | Self::Tensor { .. } | Self::Planar { .. }
        )
    }

    /// Whether its alpha follows from the strain of the gas.
    pub fn heeds_strain(&self) -> bool {
        self.is_stress() || matches!(self, Self::PlanarSwitch { .. })
    }

    /// alpha and the stress of a particle that had `present` and whose alpha falls to `decay` of itself in the step that has passed.
    pub fn stress(&self, place: &Place, present: f64, decay: f64) -> (f64, Matrix3<f64>) {
        match *self {
            Self::NeumannRichtmyer { alpha, beta } => {
                (alpha, neumann_richtmyer::stress(place, alpha, beta))
            }
            Self::Tensor { alpha, beta } => {
                let strain = Strain::of(&place.gradient);
                (alpha, tensor::stress(place, &strain, alpha, beta))
            }
            Self::Planar { alpha, .. } | Self::PlanarSwitch { alpha, .. } => {
                let strain = Strain::of(&place.gradient);
                let local = alpha * planar::target(place, &strain);
                let alpha = relaxed(present, local, decay);
                let stress = if self.is_stress() {
                    planar::stress(place, &strain, alpha, self.ratio())
                } else {
                    Matrix3::zeros()
                };
                (alpha, stress)
            }
            _ => (present, Matrix3::zeros()),
        }
    }

    /// alpha and beta, if there is any.
    pub fn parameters(&self) -> Option<[f64; 2]> {
        match *self {
            Self::None => None,
            Self::Constant { alpha, beta }
            | Self::Balsara { alpha, beta }
            | Self::CullenDehnen { alpha, beta }
            | Self::NeumannRichtmyer { alpha, beta }
            | Self::Tensor { alpha, beta }
            | Self::PlanarSwitch { alpha, beta }
            | Self::Planar { alpha, beta } => Some([alpha, beta]),
        }
    }

    /// The part of Courant's step at which momentum does not spread further in a step than a neighbour: a viscosity alpha c h spreads it as
    /// far as sound from alpha = 4 on.
    pub fn calm(&self) -> f64 {
        let [alpha, beta] = self.parameters().unwrap_or_default();
        (4.0 / alpha).min(8.0 / beta).min(1.0)
    }

    /// beta by alpha.
    pub fn ratio(&self) -> f64 {
        let Some([alpha, beta]) = self.parameters() else {
            return 0.0;
        };
        assert!(
            alpha > 0.0 && beta >= 0.0,
            "viscosity has a positive alpha and a beta of at least zero"
        );
        beta / alpha
    }
}

#[cfg(test)]
mod tests;
