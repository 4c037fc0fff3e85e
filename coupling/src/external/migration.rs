//! Prescribed migration of planets: da/dt = a/tau, outward for tau > 0, at constant eccentricity and inclination.
//!
//! dv/dt = v/(2 tau) about the star, solved exactly: E' = v^2/tau averages to -E/tau, and 1 - e^2 ~ E L^2 keeps its value over an orbit.
//! Source: Malhotra (1993, Nature 365, 819); Papaloizou & Larwood (2000, MNRAS 315, 823), eq. 23.

use super::{Change, Law, Target};

/// Planets that migrate.
#[derive(Clone, Debug, PartialEq)]
pub struct Migration {
    /// Identity and 1/tau, by ascending identity.
    rates: Vec<(u64, f64)>,
}

impl Migration {
    /// Planets and the times in which their semi-major axes grow by e.
    pub fn new(times: impl IntoIterator<Item = (u64, f64)>) -> Self {
        let mut rates: Vec<(u64, f64)> = times.into_iter().map(|(id, t)| (id, 1.0 / t)).collect();
        rates.sort_by_key(|&(id, _)| id);
        Self { rates }
    }
}

impl Law for Migration {
    const NAME: &'static str = "prescribed migration";

    fn change(&self, target: &Target, span: f64) -> Change {
        let found = self.rates.binary_search_by_key(&target.id, |&(id, _)| id);
        found.map_or_else(
            |_| Change::default(),
            |place| Change {
                dv: target.v * (0.5 * self.rates[place].1 * span).exp_m1(),
                heat: 0.0,
            },
        )
    }
}
