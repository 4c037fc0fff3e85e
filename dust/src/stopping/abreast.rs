//! Abreast: eight spheres at once.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x8};
use nbody::points::exponential::{ln_1p, lost};

use super::{Ambient, KWOK, Sphere, StoppingLaw, epstein_rate};

/// Spheres with their laws and the gas around them.
#[derive(Clone, Copy, Debug)]
pub struct Abreast {
    law: [StoppingLaw; 8],
    sphere: [Sphere; 8],
    gas: [Ambient; 8],
    /// of Epstein's law, if all have that: the rates at no speed, and the inverse sound speeds
    epstein: Option<[[f64; 8]; 2]>,
}

impl Abreast {
    pub fn new(law: [StoppingLaw; 8], sphere: [Sphere; 8], gas: [Ambient; 8]) -> Self {
        let alike = law.iter().all(|law| matches!(law, StoppingLaw::Epstein));
        let mut columns = [[0.0; 8]; 2];
        if alike {
            let [rates, inverses] = &mut columns;
            let each = sphere.iter().zip(&gas).zip(rates.iter_mut().zip(inverses));
            for ((sphere, gas), (rate, inverse)) in each.filter(|((_, gas), _)| gas.rho > 0.0) {
                (*rate, *inverse) = (epstein_rate(sphere, gas), 1.0 / gas.c);
            }
        }
        Self {
            law,
            sphere,
            gas,
            epstein: alike.then_some(columns),
        }
    }

    /// Whether the stopping times are the same at all speeds.
    pub fn is_linear(&self) -> bool {
        self.law.iter().all(StoppingLaw::is_linear)
    }

    /// Epstein's rates at no speed, and the squares of the variable of Kwok's factor.
    #[inline(always)]
    fn kwok<S: Simd>(
        simd: S,
        [rate, inverse]: &[[f64; 8]; 2],
        speed: f64x8<S>,
    ) -> (f64x8<S>, f64x8<S>) {
        let mach = speed * f64x8::from_slice(simd, inverse);
        (f64x8::from_slice(simd, rate), mach * mach * KWOK)
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
        let Some(epstein) = &self.epstein else {
            return self.each(simd, (speed, dt), |law, sphere, gas, [speed, dt]| {
                law.e_foldings(sphere, gas, speed, dt)
            });
        };
        let (rate, y2) = Self::kwok(simd, epstein, speed);
        let x = dt * rate;
        let excess = y2 * 0.5 / ((y2 + 1.0).sqrt() + 1.0);
        x + ln_1p(simd, excess * lost(simd, x + x))
    }

    /// [`StoppingLaw::stopping_time`] of each.
    #[inline(always)]
    pub fn stopping_time<S: Simd>(&self, simd: S, speed: f64x8<S>) -> f64x8<S> {
        let Some(epstein) = &self.epstein else {
            return self.each(simd, (speed, speed), |law, sphere, gas, [speed, _]| {
                law.stopping_time(sphere, gas, speed)
            });
        };
        let (rate, y2) = Self::kwok(simd, epstein, speed);
        f64x8::splat(simd, 1.0) / (rate * (y2 + 1.0).sqrt())
    }
}
