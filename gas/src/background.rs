//! A uniform pressure P_0 that forces leave out.
//!
//! Its gradient is none, yet its sum over particles that are out of order is not: P_0 sum V_i, with V_i = x_i / y_i, changes when they are
//! moved, so particles in order resist shear and disordered ones are pushed about. Forces have P - P_0 instead. Gas of free energy is
//! heated by all of P, so that its state stays right: kinetic and internal energy then lose P_0 d(sum V), which is booked and stays
//! within what the sum of volumes may vary by.
//!
//! `Least` is a part of the least P exp(-max(0, q - 1)), q = G div v H / c, G = rho c^2 / P: gas whose ln P falls by more than one while sound
//! crosses the kernel leaves voids, whose edges feel nothing of a pressure all around. It is set anew at the ends of base steps, and in
//! between where gas falls below it: particles that pull at each other do not stay in order.

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

/// The part: pressures may fall during a step.
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
    /// Sum of the particles' volumes when it was set; zero before the first time.
    pub volume: f64,
    /// What kinetic and internal energy have lost to it since it was last asked for.
    pub work: f64,
}

impl Gas {
    /// Sets the background for the forces of this tick.
    pub(crate) fn set_background(&mut self, hydro: &Hydro, clock: &Clock) {
        let wanted = hydro.background_pressure;
        if !wanted.is_some() {
            return;
        }
        let (part, most) = match wanted {
            BackgroundPressure::Fixed(pressure) => (1.0, pressure),
            BackgroundPressure::Least if hydro.domain.volume().is_infinite() => (PART, 0.0),
            BackgroundPressure::Least => (PART, self.least_pressure(hydro.support())),
        };
        let last = self.background;
        if !clock.synchronous() && most >= last.pressure {
            return;
        }
        let pressure = part * most;
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

    /// The least pressure of the active particles, less where they fly apart; zero where it is negative.
    fn least_pressure(&self, support: f64) -> f64 {
        let (derived, h) = (&self.derived, &self.particles.h);
        let expected = |&i: &u32| {
            let i = i as usize;
            let (p, cs) = (derived.p[i], derived.cs[i]);
            let crossing = support * h[i] / cs;
            let fall = derived.rho[i] * cs * cs / p * derived.div_v[i] * crossing;
            if p > 0.0 && fall > 1.0 {
                p * (1.0 - fall).exp()
            } else {
                p.max(0.0)
            }
        };
        let active = self.vicinity.active.iter().map(expected);
        active.fold(f64::INFINITY, f64::min)
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

#[cfg(test)]
mod tests {
    use nbody::points::{Domain, Vec3};

    use super::*;
    use crate::samples::{hydro, noisy};

    #[test]
    fn gas_that_falls_below_the_background_lowers_it_within_a_base_step() {
        let hydro = Hydro {
            background_pressure: BackgroundPressure::Least,
            ..hydro(Domain::periodic(Vec3::repeat(1.0)))
        };
        let mut gas = noisy(&hydro.domain, 6, 1.0);
        let mut clock = Clock::standing(0.0);
        gas.density(&hydro, &clock, Vec3::zeros())
            .expect("a density");
        // Nothing expands.
        gas.derived.div_v.fill(-1.0);
        gas.set_background(&hydro, &clock);
        let first = gas.background;
        assert!(first.pressure > 0.0 && first.volume > 0.0);
        (clock.end, clock.tick) = (1.0, 64);
        let thin = 0.5 * first.pressure;
        gas.derived.p[7] = thin;
        gas.vicinity.active = vec![6, 8];
        gas.set_background(&hydro, &clock);
        assert_eq!(gas.background, first);
        gas.vicinity.active = vec![6, 7];
        gas.set_background(&hydro, &clock);
        assert_eq!(gas.background.pressure, 0.95 * thin);
        // A void opens about one that expands faster than sound crosses its kernel.
        let fall = |gas: &Gas| {
            gas.derived.rho[7] * gas.derived.cs[7] * hydro.support() * gas.particles.h[7] / thin
        };
        gas.derived.div_v[7] = 4.0 / fall(&gas);
        gas.set_background(&hydro, &clock);
        let expected = 0.95 * thin * (-3.0f64).exp();
        assert!((gas.background.pressure / expected - 1.0).abs() < 1e-12);
    }
}
