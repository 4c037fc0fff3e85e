//! Physical viscosity: the stress of Navier and Stokes, without bulk viscosity.
//!
//! Q = -2 rho nu (S - tr S / d),   S the rate of strain, linear-exact;   heat 2 nu S' : S' a mass
//! nu constant, or nu = alpha c_s^2 / Omega (Shakura & Sunyaev 1973) with Omega of circular orbits at the distance from the star's axis
//!
//! Two first derivatives: noise from particle to particle is left to the artificial viscosity. Steps keep dt <= C h^2 / nu.
//! Source: Landau & Lifshitz, Fluid Mechanics, section 15; in SPH: Flebbe et al. (1994).

use nalgebra::Matrix3;
use nbody::points::Vec3;

use super::stress::Place;

/// How viscous gas is by nature.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Physical {
    #[default]
    None,
    /// Kinematic viscosity.
    Constant { nu: f64 },
    /// About a star of gravitational parameter `mu`.
    ShakuraSunyaev { alpha: f64, mu: f64 },
}

impl Physical {
    /// nu of gas of sound speed `cs` at `x` from the star.
    pub fn nu(&self, cs: f64, x: Vec3) -> f64 {
        match *self {
            Self::None => 0.0,
            Self::Constant { nu } => nu,
            Self::ShakuraSunyaev { alpha, mu } => {
                alpha * cs * cs * (x.xy().norm().powi(3) / mu).sqrt()
            }
        }
    }
}

/// The stress of viscosity `nu` along the `axes` of the domain.
pub fn stress(place: &Place, nu: f64, axes: [bool; 3]) -> Matrix3<f64> {
    let gradient = &place.gradient;
    let mut strain = 0.5 * (gradient + gradient.transpose());
    let present = axes.iter().filter(|&&axis| axis).count() as f64;
    let mean = strain.trace() / present;
    for a in (0..3).filter(|&a| axes[a]) {
        strain[(a, a)] -= mean;
    }
    -2.0 * place.rho * nu * strain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stress_of_a_shear_is_off_the_diagonal_and_heats() {
        let mut gradient = Matrix3::zeros();
        gradient[(1, 0)] = -1.5;
        let place = Place {
            gradient,
            rho: 2.0,
            cs: 1.0,
            h: 1.0,
        };
        let stress = stress(&place, 0.1, [true, true, false]);
        assert!((stress[(0, 1)] - 0.3).abs() < 1e-15 && stress.trace().abs() < 1e-15);
        // nu (dv/dx)^2 rho.
        let heat = -stress.component_mul(&gradient).sum();
        assert!((heat - 2.0 * 0.1 * 2.25).abs() < 1e-14);
        let disk = Physical::ShakuraSunyaev {
            alpha: 0.01,
            mu: 4.0,
        };
        let nu = disk.nu(0.1, Vec3::new(0.0, 4.0, 1.0));
        assert!((nu - 0.01 * 0.01 * 4.0).abs() < 1e-17);
    }
}
