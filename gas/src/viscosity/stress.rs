//! Viscous stress of one particle: a symmetric tensor Q that its sweep of forces adds to the pressure.
//!
//! m_i dv_i/dt = -sum_j x_i x_j [ Q_i/y_i^2 G_ij + Q_j/y_j^2 G_ji' ],   G_ij = M_i grad W(r, H_i),   M_i = y_i (sum_j x_j d grad W)^-1
//! m_i du_i/dt =  sum_j x_i x_j Q_i/y_i^2 G_ij . v_ij = -(m_i / rho_i) Q_i : V_i,   V the linear-exact velocity gradient
//!
//! Since sum_j x_j d_a (M grad W)_b = y delta_ab exactly, the torque that the stress of a particle exerts over its neighbourhood is
//! eps_abc Q_bc y = 0: forces are not central, and angular momentum is conserved to round-off all the same where all pairs
//! keep the same pace. The work is heat: Q : V <= 0 for every kind here.
//! q(l) = rho (a c h |l| + b h^2 l^2) / 2 for a compression l < 0: a pair's viscosity of the same alpha and beta gives that along its axis.

use nalgebra::{Matrix3, SymmetricEigen};

/// What the stress follows from.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// V
    pub gradient: Matrix3<f64>,
    pub rho: f64,
    pub cs: f64,
    pub h: f64,
}

/// Rates of strain along their axes, in ascending order.
#[derive(Clone, Copy, Debug)]
pub struct Strain {
    pub rates: [f64; 3],
    pub axes: Matrix3<f64>,
}

impl Strain {
    /// Of a velocity gradient.
    pub fn of(gradient: &Matrix3<f64>) -> Self {
        let found = SymmetricEigen::new(0.5 * (gradient + gradient.transpose()));
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| found.eigenvalues[a].total_cmp(&found.eigenvalues[b]));
        Self {
            rates: order.map(|k| found.eigenvalues[k]),
            axes: Matrix3::from_columns(&order.map(|k| found.eigenvectors.column(k).into_owned())),
        }
    }

    /// xi: the part that the strongest compression has in all strain; 1 where one axis alone is compressed, 1/2 in shear, 1/3 where all are.
    pub fn one_sidedness(&self) -> f64 {
        let size: f64 = self.rates.iter().map(|rate| rate.abs()).sum();
        if size > 0.0 {
            (-self.rates[0]).max(0.0) / size
        } else {
            0.0
        }
    }
}

impl Place {
    /// q of a compression at `rate` < 0; none of an expansion.
    pub fn pressure(&self, rate: f64, alpha: f64, beta: f64) -> f64 {
        let speed = self.h * (-rate).max(0.0);
        0.5 * self.rho * speed * (alpha * self.cs + beta * speed)
    }

    /// q along the k-th axis of `strain` alone.
    pub fn along(&self, strain: &Strain, k: usize, alpha: f64, beta: f64) -> Matrix3<f64> {
        let axis = strain.axes.column(k);
        self.pressure(strain.rates[k], alpha, beta) * axis * axis.transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strain_is_told_apart_by_its_axes() {
        let shear = Matrix3::new(0.0, -0.5, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        let strain = Strain::of(&(1.5 * shear));
        // Kepler: -3/8, 0, 3/8 of twice the rate.
        assert!((strain.rates[0] + 0.375).abs() < 1e-15);
        assert!((strain.one_sidedness() - 0.5).abs() < 1e-15);
        let all = Strain::of(&-Matrix3::identity());
        assert!((all.one_sidedness() - 1.0 / 3.0).abs() < 1e-15);
        let axis = nalgebra::Vector3::new(1.0, 2.0, -2.0) / 3.0;
        let one = Strain::of(&(-4.0 * axis * axis.transpose()));
        assert!((one.one_sidedness() - 1.0).abs() < 1e-14);
        assert!((one.axes.column(0).dot(&axis).abs() - 1.0).abs() < 1e-14);
        assert_eq!(Strain::of(&Matrix3::identity()).one_sidedness(), 0.0);
    }

    #[test]
    fn stress_heats() {
        let gradient = Matrix3::new(-3.0, 2.0, 0.1, 0.0, 1.0, 0.7, -0.4, 0.2, -0.5);
        let place = Place {
            gradient,
            rho: 2.0,
            cs: 0.3,
            h: 0.1,
        };
        let strain = Strain::of(&gradient);
        let stress = place.along(&strain, 0, 1.0, 2.0);
        let heat = -stress.component_mul(&gradient).sum();
        let rate = strain.rates[0];
        let expected = 0.5 * 2.0 * 0.1 * -rate * (0.3 + 2.0 * 0.1 * -rate) * -rate;
        assert!((heat / expected - 1.0).abs() < 1e-13, "{heat} {expected}");
        assert_eq!(place.pressure(2.0, 1.0, 2.0), 0.0);
    }
}
