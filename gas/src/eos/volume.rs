//! Volumes by pressure: what a particle of any equation of state brings into a sum of pressures.
//!
//! q = P + Pi,   rho(q, u): P(rho, u) + Pi = q,   x_i = m_i q_i / rho(q_i, u_i),   q_i = sum_j x_j W(r_ij, H_i)
//!
//! The last two are solved together by repetition, each time by the part 2 / (1 + G) of the way where G = q / (rho c_s^2), about d ln rho / d ln q, is
//! above one: all of the way would leave the part (1 - G) of an error. Pi is nothing for gas, as published; a liquid or solid in tension would bring a
//! negative x, so it has
//!
//! stiffened:  Pi = gamma p_0:  x = (gamma - 1) m u, nothing to repeat, and no tension that it bears has q below zero
//! Tillotson:  Pi = A:  G is about one near rest; the deepest tension of cold matter is A^2 / 4B
//!
//! The root rho is sought by secants near the density of the sum; where P does not rise with it or there is none, that density is taken.
//! Source: Hosono, Saitoh & Makino (2013), PASJ 65, 108, section 2; Pi, the part of the way and the search are ours.

use super::Eos;

/// Steps of a search, its relative error, and how far from where it began the root may be.
const TRIES: usize = 40;
const ERROR: f64 = 1e-13;
const FAR: f64 = 16.0;

impl Eos {
    /// Pi: what sums of pressures have beside the pressure.
    #[inline]
    pub fn offset(&self) -> f64 {
        match self {
            Self::Stiffened(law) => law.gamma * law.pressure,
            Self::Tillotson(law) => law.bulk,
            _ => 0.0,
        }
    }

    /// The part of the way to go in a repetition, for matter of these states.
    pub fn pace(&self, q: f64, rho: f64, u: f64) -> f64 {
        let stiffness = q / (rho * self.sound_speed(rho, u).powi(2));
        // Also where it is not a number.
        2.0 / (1.0 + stiffness.max(1.0))
    }

    /// The density at which P + Pi = `q`, near `rho`.
    pub fn density(&self, q: f64, u: f64, rho: f64) -> f64 {
        if let Self::Stiffened(law) = self {
            return q / ((law.gamma - 1.0) * u);
        }
        let excess = |rho: f64| self.pressure(rho, u) + self.offset() - q;
        let (low, high) = (rho / FAR, rho * FAR);
        let (mut last, mut off) = (rho, excess(rho));
        let mut slope = self.sound_speed(rho, u).powi(2);
        for _ in 0..TRIES {
            let next = (last - off / slope).clamp(0.5 * last, 2.0 * last);
            if !(low..=high).contains(&next) {
                break;
            }
            let found = excess(next);
            if (next - last).abs() <= ERROR * next || found == 0.0 {
                return next;
            }
            slope = (found - off) / (next - last);
            if slope.is_nan() || slope <= 0.0 {
                break;
            }
            (last, off) = (next, found);
        }
        rho
    }
}

#[cfg(test)]
mod tests;
