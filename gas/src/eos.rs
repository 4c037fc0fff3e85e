//! Equations of state: P and c_s from rho and u, and where u is not free, what binds it.
//!
//! free:              u follows from work and heat; c_s^2 = dP/drho at constant entropy = P_rho + P P_u / rho^2
//! bound to place:    u = u(x); c_s^2 = dP/drho at constant u
//! bound to density:  u = u(rho); c_s^2 = dP/drho along it
//!
//! Gas that is bound gives off what work and heat have changed of its u whenever a step closes. A state that an equation does not have
//! (outside a table, beyond the tension that a liquid bears) has no P or c_s that is a number.

use std::sync::Arc;

use nbody::points::Vec3;

pub mod barotropic;
mod ideal;
mod isothermal;
pub mod stiffened;
pub mod table;
pub mod tillotson;
mod volume;

pub use barotropic::Barotropic;
pub use stiffened::Stiffened;
pub use table::Table;
pub use tillotson::Tillotson;

#[derive(Clone, Debug, PartialEq)]
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
    Barotropic(Barotropic),
    Stiffened(Stiffened),
    Tillotson(Tillotson),
    Tabulated(Arc<Table>),
}

/// What the internal energy follows from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binding {
    /// Heating and work alone.
    Free,
    Place,
    Density,
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

    /// What u follows from.
    pub fn binding(&self) -> Binding {
        match self {
            Self::Ideal { .. } | Self::Stiffened(_) | Self::Tillotson(_) | Self::Tabulated(_) => {
                Binding::Free
            }
            Self::Isothermal { .. } | Self::LocallyIsothermal { .. } => Binding::Place,
            Self::Barotropic(_) => Binding::Density,
        }
    }

    /// Whether u follows from heating and work alone.
    pub fn is_free(&self) -> bool {
        self.binding() == Binding::Free
    }

    /// Whether P/rho and u are constant multiples of c_s^2, so that the sound speed says both: conduction needs that.
    pub fn follows_sound_speed(&self) -> bool {
        !self.follows_density()
    }

    /// Whether the density has a part in c_s or u.
    pub fn follows_density(&self) -> bool {
        matches!(
            self,
            Self::Barotropic(_) | Self::Stiffened(_) | Self::Tillotson(_) | Self::Tabulated(_)
        )
    }

    /// Whether every density and every energy above zero has a pressure and a sound speed.
    pub fn is_everywhere(&self) -> bool {
        !matches!(self, Self::Stiffened(_) | Self::Tabulated(_))
    }

    /// The internal energy that place or density dictate at `x` from the star; none where u is free.
    pub fn bound_energy(&self, x: Vec3, rho: f64) -> Option<f64> {
        match *self {
            Self::Isothermal { sound_speed, gamma } => Some(isothermal::energy(gamma, sound_speed)),
            Self::LocallyIsothermal {
                sound_speed,
                radius,
                exponent,
                gamma,
            } => {
                let local = isothermal::power_law(sound_speed, radius, exponent, x);
                Some(isothermal::energy(gamma, local))
            }
            Self::Barotropic(law) => Some(law.energy(rho)),
            _ => None,
        }
    }

    /// u at which gas of density `rho` has the pressure `p`, where a formula says so.
    pub fn energy(&self, rho: f64, p: f64) -> Option<f64> {
        match self {
            Self::Ideal { gamma } => Some(p / ((gamma - 1.0) * rho)),
            Self::Stiffened(law) => Some(law.energy(rho, p)),
            _ => None,
        }
    }

    /// P(rho, u).
    #[inline]
    pub fn pressure(&self, rho: f64, u: f64) -> f64 {
        match self {
            Self::Ideal { gamma }
            | Self::Isothermal { gamma, .. }
            | Self::LocallyIsothermal { gamma, .. } => ideal::pressure(*gamma, rho, u),
            Self::Barotropic(law) => law.pressure(rho),
            Self::Stiffened(law) => law.pressure(rho, u),
            Self::Tillotson(law) => law.pressure(rho, u),
            Self::Tabulated(table) => table.pressure(rho, u),
        }
    }

    /// c_s(rho, u).
    #[inline]
    pub fn sound_speed(&self, rho: f64, u: f64) -> f64 {
        match self {
            Self::Ideal { gamma } => ideal::sound_speed(*gamma, u),
            Self::Isothermal { gamma, .. } | Self::LocallyIsothermal { gamma, .. } => {
                isothermal::sound_speed(*gamma, u)
            }
            Self::Barotropic(law) => law.sound_speed(rho),
            Self::Stiffened(law) => law.sound_speed(rho, u),
            Self::Tillotson(law) => law.sound_speed(rho, u),
            Self::Tabulated(table) => table.sound_speed(rho, u),
        }
    }

    /// P / (rho c_s^2) where it is the same for all states; else not a number.
    #[inline]
    pub fn pressure_by_square(&self) -> f64 {
        match *self {
            Self::Ideal { gamma } => 1.0 / gamma,
            Self::Isothermal { .. } | Self::LocallyIsothermal { .. } => 1.0,
            _ => f64::NAN,
        }
    }

    /// u / c_s^2 where it is the same for all states; else not a number.
    #[inline]
    pub fn energy_by_square(&self) -> f64 {
        match *self {
            Self::Ideal { gamma }
            | Self::Isothermal { gamma, .. }
            | Self::LocallyIsothermal { gamma, .. } => self.pressure_by_square() / (gamma - 1.0),
            _ => f64::NAN,
        }
    }
}

#[cfg(test)]
mod tests;
#[cfg(test)]
mod waves;
