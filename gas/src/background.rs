//! A uniform pressure P_0 that forces leave out.
//!
//! Its gradient is none, yet its sum over particles that are out of order is not: P_0 sum V_i, with V_i = x_i / y_i, changes when they are
//! moved, so particles in order resist shear and disordered ones are pushed about. Forces have P - P_0 instead. Gas of free energy is
//! heated by all of P, so that its state stays right: kinetic and internal energy then lose P_0 d(sum V), which is booked and stays
//! within what the sum of volumes may vary by.
//!
//! `Least` follows the least pressure there is, and is set anew at the ends of base steps.

use nbody::points::{Clock, sum};

use crate::{Gas, Hydro};

/// The pressure that forces leave out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BackgroundPressure {
    /// This one, code units of pressure (in the plane, of energy an area).
    Fixed(f64),
    /// A part of the least pressure of the gas; nothing where a side is open, since a vacuum is around.
    Least,
}

/// The part: pressures may fall during a base step.
const PART: f64 = 0.95;

impl BackgroundPressure {
    pub const NONE: Self = Self::Fixed(0.0);

    pub fn is_some(self) -> bool {
        self != Self::NONE
    }
}

/// The background of the present base step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Background {
    /// Code units.
    pub pressure: f64,
    /// Sum of the particles' volumes at the begin of the base step; zero before the first.
    pub volume: f64,
    /// What kinetic and internal energy have lost to it since it was last asked for.
    pub work: f64,
}

impl Gas {
    /// Sets the background where a base step ends.
    pub(crate) fn set_background(&mut self, hydro: &Hydro, clock: &Clock) {
        if !hydro.background_pressure.is_some() || !clock.synchronous() {
            return;
        }
        let (p, last) = (&self.derived.p, self.background);
        let pressure = match hydro.background_pressure {
            BackgroundPressure::Fixed(pressure) => pressure,
            BackgroundPressure::Least if hydro.domain.volume().is_infinite() => 0.0,
            BackgroundPressure::Least => {
                PART * p.iter().copied().fold(f64::INFINITY, f64::min).max(0.0)
            }
        };
        let volume = if hydro.eos.is_free() {
            self.volume(hydro)
        } else {
            0.0
        };
        if last.volume > 0.0 {
            self.background.work += 0.5 * (last.pressure + pressure) * (volume - last.volume);
        }
        self.background.pressure = pressure;
        self.background.volume = volume;
    }

    /// What kinetic and internal energy have lost to the background since the last call.
    pub fn take_background_work(&mut self) -> f64 {
        std::mem::take(&mut self.background.work)
    }

    /// Sum of x / y.
    fn volume(&self, hydro: &Hydro) -> f64 {
        let (m, rho, ratio) = (&self.particles.m, &self.derived.rho, &self.derived.p_ratio);
        let (p, content) = (&self.derived.p, &self.derived.content);
        let weighs = hydro.formulation == crate::Formulation::Pressure;
        sum::ordered(m.len(), 0.0, |range| {
            range.fold(0.0, |sum, i| {
                if let Some(content) = content.get(i) {
                    return sum + m[i] * content / (p[i] + hydro.eos.offset());
                }
                let share = if weighs {
                    ratio[i].powf(-hydro.exponent)
                } else {
                    1.0
                };
                sum + m[i] / rho[i] * share
            })
        })
    }
}
