//! Equations of state: P and c_s from rho, u and place; or u itself where the gas is bound to a temperature.
//!
//! ideal:               P = (gamma - 1) rho u,   c_s^2 = gamma P / rho
//! isothermal:          P = c_s^2 rho,           u = c_s^2 / (gamma - 1), reset whenever a step closes
//! locally isothermal:  as isothermal with c_s = c_0 (R / R_0)^-exponent, R the distance from the z axis through the star

use nbody::points::Vec3;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Eos {
    Ideal {
        gamma: f64,
    },
    /// `gamma` only says how much internal energy the gas counts as holding.
    Isothermal {
        sound_speed: f64,
        gamma: f64,
    },
    /// `sound_speed` at the distance `radius` from the star's axis.
    LocallyIsothermal {
        sound_speed: f64,
        radius: f64,
        exponent: f64,
        gamma: f64,
    },
}

impl Eos {
    /// Locally isothermal gas with c_s = `aspect_ratio` v_K at `radius` about a star of gravitational parameter `mu` = G M.
    pub fn of_disk(aspect_ratio: f64, mu: f64, radius: f64, exponent: f64, gamma: f64) -> Self {
        Self::LocallyIsothermal {
            sound_speed: aspect_ratio * (mu / radius).sqrt(),
            radius,
            exponent,
            gamma,
        }
    }

    /// Adiabatic index.
    pub fn gamma(&self) -> f64 {
        match *self {
            Self::Ideal { gamma }
            | Self::Isothermal { gamma, .. }
            | Self::LocallyIsothermal { gamma, .. } => gamma,
        }
    }

    /// Whether u follows from heating and work alone.
    pub fn is_free(&self) -> bool {
        matches!(self, Self::Ideal { .. })
    }

    /// The internal energy that the place dictates at `x` from the star; none where u is free.
    pub fn bound_energy(&self, x: Vec3) -> Option<f64> {
        let c = match *self {
            Self::Ideal { .. } => return None,
            Self::Isothermal { sound_speed, .. } => sound_speed,
            Self::LocallyIsothermal {
                sound_speed,
                radius,
                exponent,
                ..
            } => sound_speed * (x.xy().norm() / radius).powf(-exponent),
        };
        Some(c * c / (self.gamma() - 1.0))
    }

    /// P(rho, u).
    #[inline]
    pub fn pressure(&self, rho: f64, u: f64) -> f64 {
        (self.gamma() - 1.0) * rho * u
    }

    /// P / (rho c_s^2).
    #[inline]
    pub fn pressure_by_square(&self) -> f64 {
        match *self {
            Self::Ideal { gamma } => 1.0 / gamma,
            _ => 1.0,
        }
    }

    /// u / c_s^2.
    #[inline]
    pub fn energy_by_square(&self) -> f64 {
        self.pressure_by_square() / (self.gamma() - 1.0)
    }

    /// c_s(u): adiabatic for ideal gas, isothermal for gas bound to a temperature.
    #[inline]
    pub fn sound_speed(&self, u: f64) -> f64 {
        let gamma = self.gamma();
        match self {
            Self::Ideal { .. } => (gamma * (gamma - 1.0) * u).sqrt(),
            _ => ((gamma - 1.0) * u).sqrt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pressure_and_sound_speed_agree() {
        let ideal = Eos::Ideal { gamma: 1.4 };
        // c_s^2 = dP/drho at constant entropy, along which du = P / rho^2 drho.
        let (rho, u, e) = (0.7, 2.0, 1e-6);
        let heat = ideal.pressure(rho, u) / (rho * rho) * e;
        let slope =
            (ideal.pressure(rho + e, u + heat) - ideal.pressure(rho - e, u - heat)) / (2.0 * e);
        assert!((ideal.sound_speed(u).powi(2) - slope).abs() < 1e-9);
    }

    #[test]
    fn pressure_and_energy_follow_from_the_square_of_the_sound_speed() {
        let disk = Eos::of_disk(0.05, 4.0, 10.0, 0.25, 1.4);
        for eos in [Eos::Ideal { gamma: 1.4 }, disk] {
            let square = eos.sound_speed(0.3).powi(2);
            let p = eos.pressure(2.0, 0.3) / 2.0;
            assert!((eos.pressure_by_square() * square / p - 1.0).abs() < 1e-14);
            assert!((eos.energy_by_square() * square / 0.3 - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn disk_gas_has_the_wanted_aspect_ratio_anywhere() {
        let disk = Eos::of_disk(0.05, 4.0, 10.0, 0.25, 1.4);
        for radius in [1.0, 10.0, 100.0] {
            let u = disk
                .bound_energy(Vec3::new(0.0, radius, 3.0))
                .expect("bound");
            let kepler = (4.0f64 / radius).sqrt();
            let aspect_ratio = disk.sound_speed(u) / kepler;
            let expected = 0.05 * (radius / 10.0f64).powf(0.25);
            assert!((aspect_ratio / expected - 1.0).abs() < 1e-14);
            assert!(
                (disk.pressure(2.0, u) / (2.0 * disk.sound_speed(u).powi(2)) - 1.0).abs() < 1e-14
            );
        }
    }
}
