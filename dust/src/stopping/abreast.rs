//! Abreast: eight spheres at once under laws of one kind.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x8};
use nbody::points::exponential::{ln_1p, lost};

use super::{Ambient, KWOK, Sphere, StoppingLaw, epstein_rate};

/// Spheres with their laws and the gas around them.
#[derive(Clone, Copy, Debug)]
pub struct Abreast {
    pub law: [StoppingLaw; 8],
    pub sphere: [Sphere; 8],
    pub gas: [Ambient; 8],
}

impl Abreast {
    fn is_epstein(&self) -> bool {
        self.law.iter().all(|&law| law == StoppingLaw::Epstein)
    }

    /// Epstein's rates at no speed, and the squares of the variable of Kwok's factor.
    #[inline(always)]
    fn epstein<S: Simd>(&self, simd: S, speed: f64x8<S>) -> (f64x8<S>, f64x8<S>) {
        let (mut rate, mut inverse) = ([0.0; 8], [0.0; 8]);
        for lane in 0..8 {
            let gas = &self.gas[lane];
            if gas.rho > 0.0 {
                rate[lane] = epstein_rate(&self.sphere[lane], gas);
                inverse[lane] = 1.0 / gas.c;
            }
        }
        let mach = speed * f64x8::from_slice(simd, &inverse);
        (f64x8::from_slice(simd, &rate), mach * mach * KWOK)
    }

    /// A number of each, by itself.
    #[inline(always)]
    fn each<S: Simd>(
        &self,
        simd: S,
        (speed, dt): (f64x8<S>, f64x8<S>),
        of: impl Fn(&StoppingLaw, &Sphere, &Ambient, [f64; 2]) -> f64,
    ) -> f64x8<S> {
        let (mut speeds, mut steps) = ([0.0; 8], [0.0; 8]);
        speed.store_slice(&mut speeds);
        dt.store_slice(&mut steps);
        let mut values = [0.0; 8];
        for lane in 0..8 {
            let (law, sphere, gas) = (&self.law[lane], &self.sphere[lane], &self.gas[lane]);
            values[lane] = of(law, sphere, gas, [speeds[lane], steps[lane]]);
        }
        f64x8::from_slice(simd, &values)
    }

    /// [`StoppingLaw::e_foldings`] of each.
    #[inline(always)]
    pub fn e_foldings<S: Simd>(&self, simd: S, speed: f64x8<S>, dt: f64x8<S>) -> f64x8<S> {
        if !self.is_epstein() {
            return self.each(simd, (speed, dt), |law, sphere, gas, [speed, dt]| {
                law.e_foldings(sphere, gas, speed, dt)
            });
        }
        let (rate, y2) = self.epstein(simd, speed);
        let x = dt * rate;
        let excess = y2 * 0.5 / ((y2 + 1.0).sqrt() + 1.0);
        x + ln_1p(simd, excess * lost(simd, x + x))
    }

    /// [`StoppingLaw::stopping_time`] of each.
    #[inline(always)]
    pub fn stopping_time<S: Simd>(&self, simd: S, speed: f64x8<S>) -> f64x8<S> {
        if !self.is_epstein() {
            return self.each(simd, (speed, speed), |law, sphere, gas, [speed, _]| {
                law.stopping_time(sphere, gas, speed)
            });
        }
        let (rate, y2) = self.epstein(simd, speed);
        f64x8::splat(simd, 1.0) / (rate * (y2 + 1.0).sqrt())
    }
}
