//! Laws of collisions in a cell: kernels with an exact solution, whose grains always stick, and the physical one.

use std::f64::consts::PI;

use nbody::points::Vec3;
use rand::{Rng, RngExt};

use super::cell::{Law, Swarms};
use super::{Physics, Place};

use crate::Dust;
use crate::outcome::{Outcome, Product};
use crate::porosity::Aggregate;
use crate::relative_speed::{Conditions, Grain};
use crate::stopping::{Ambient, Sphere};

/// A kernel that is a rate times a function of both masses.
pub struct Power<F> {
    pub rate: f64,
    pub law: F,
}

impl<F: Fn(f64, f64) -> f64> Law for Power<F> {
    const TOGETHER: f64 = 0.05;

    fn describe(&self, _: &mut Swarms, _: usize) {}

    #[inline(always)]
    fn bound(&self, swarms: &Swarms, i: usize, j: usize) -> f64 {
        self.rate * (self.law)(swarms.m[i], swarms.m[j])
    }

    fn leverage(&self) -> f64 {
        1.0
    }

    fn collision(
        &self,
        swarms: &Swarms,
        (i, j): (usize, usize),
        many: f64,
        _: &mut impl Rng,
    ) -> Option<(Aggregate, Outcome)> {
        let (one, two) = (swarms.grain(i), swarms.grain(j));
        let grain = Aggregate {
            m: one.m + many * two.m,
            volume: one.volume + many * two.volume,
        };
        Some((grain, Outcome::Sticking))
    }
}

/// The physical kernel in the gas of a cell.
pub struct Formula<'a> {
    physics: &'a Physics,
    gas: Ambient,
    height: f64,
    conditions: Conditions,
    /// Mean velocity relative to the gas.
    mean: Vec3,
}

impl<'a> Formula<'a> {
    /// In the mean gas of the cell; none where there is no gas.
    pub fn new(
        physics: &'a Physics,
        swarms: &mut Swarms,
        dust: &Dust,
        place: &impl Fn(usize) -> Place,
    ) -> Option<Self> {
        let derived = &dust.derived;
        let (mut gas, mut height, mut mean, mut seen) = (
            Ambient {
                rho: 0.0,
                c: 0.0,
                omega: 0.0,
            },
            0.0,
            Vec3::zeros(),
            0.0,
        );
        for k in 0..swarms.n {
            let i = swarms.places[k];
            let here = place(i);
            // Where no gas is seen its velocity means nothing.
            let inside = derived.rho_gas[i] > 0.0;
            let slip = if inside {
                derived.slip[i]
            } else {
                Vec3::zeros()
            };
            swarms.slip[k] = slip;
            if inside {
                gas.rho += derived.rho_gas[i];
                gas.c += derived.c_gas[i];
                seen += 1.0;
            }
            gas.omega += here.omega;
            height += here.height;
            mean += slip;
        }
        if seen == 0.0 {
            return None;
        }
        let n = swarms.n as f64;
        (gas.rho, gas.c, gas.omega) = (gas.rho / seen, gas.c / seen, gas.omega / n);
        let mean = physics.sources.drift(0.0, mean / n, gas.omega, height / n);
        let formula = Self {
            physics,
            gas,
            height: height / n,
            conditions: physics.sources.conditions(&gas),
            mean,
        };
        formula.settle(swarms);
        Some(formula)
    }

    /// Lets gas and gravity compress the aggregates.
    fn settle(&self, swarms: &mut Swarms) {
        let Some(monomers) = &self.physics.porosity else {
            return;
        };
        for i in 0..swarms.n {
            self.describe(swarms, i);
            let grain = swarms.grain(i);
            let stirred = self.conditions.stirred(swarms.stokes[i]);
            let speed = (swarms.u[i].norm_squared() + stirred).sqrt();
            let volume = monomers.settled(&grain, speed, swarms.t_stop[i]);
            if volume < grain.volume {
                let grain = Aggregate { volume, ..grain };
                swarms.put(i, grain);
                swarms.radius[i] = grain.radius();
                swarms.changed = true;
            }
        }
    }

    fn seen(&self, swarms: &Swarms, i: usize) -> Grain {
        Grain {
            m: swarms.m[i],
            stokes: swarms.stokes[i],
            u: swarms.u[i],
        }
    }

    /// Volume of grain 1 with `many` of grain 2 stuck to it.
    fn merged(&self, one: &Aggregate, two: &Aggregate, many: f64, speed: f64) -> f64 {
        match &self.physics.porosity {
            None => one.volume + many * two.volume,
            Some(monomers) if many == 1.0 => monomers.merged(one, two, speed),
            Some(monomers) => monomers.coated(one, two, many, speed),
        }
    }
}

impl Law for Formula<'_> {
    const TOGETHER: f64 = 0.05;

    fn describe(&self, swarms: &mut Swarms, i: usize) {
        let sphere = Sphere {
            radius: swarms.radius[i],
            density: swarms.m[i] / swarms.volume[i],
        };
        let t_stop = (self.physics.law).stopping_time(&sphere, &self.gas, swarms.slip[i].norm());
        let stokes = if self.gas.omega > 0.0 {
            t_stop * self.gas.omega
        } else {
            0.0
        };
        (swarms.t_stop[i], swarms.stokes[i]) = (t_stop, stokes);
        let sources = &self.physics.sources;
        swarms.u[i] = sources.drift(stokes, swarms.slip[i], self.gas.omega, self.height);
        [swarms.slow[i], swarms.stirred[i]] =
            self.conditions.bounds(&self.seen(swarms, i), self.mean);
    }

    #[inline(always)]
    fn bound(&self, swarms: &Swarms, i: usize, j: usize) -> f64 {
        let reach = swarms.radius[i] + swarms.radius[j];
        let speed = swarms.slow[i] + swarms.slow[j] + swarms.stirred[i].max(swarms.stirred[j]);
        PI * reach * reach * speed
    }

    fn leverage(&self) -> f64 {
        self.physics.rules.erosion.amount.max(1.0)
    }

    fn collision(
        &self,
        swarms: &Swarms,
        (i, j): (usize, usize),
        many: f64,
        random: &mut impl Rng,
    ) -> Option<(Aggregate, Outcome)> {
        let typical = self
            .conditions
            .speed(&self.seen(swarms, i), &self.seen(swarms, j));
        let bound = swarms.slow[i] + swarms.slow[j] + swarms.stirred[i].max(swarms.stirred[j]);
        if random.random::<f64>() * bound >= typical {
            return None;
        }
        let speed = match self.physics.spread {
            // Those that meet are spread as v^3 exp(-3/2 v^2/typical^2).
            true => {
                let chance = (1.0 - random.random::<f64>()) * (1.0 - random.random::<f64>());
                typical * (-2.0 / 3.0 * chance.ln()).sqrt()
            }
            false => typical,
        };
        let rules = &self.physics.rules;
        let (one, two) = (swarms.grain(i), swarms.grain(j));
        let m = [one.m, two.m];
        let outcome = rules.outcome(m, speed, random.random());
        let chances = [random.random(), random.random()];
        let grain = match rules.product(outcome, m, many, chances) {
            Product::Merged(many) => Aggregate {
                m: one.m + many * two.m,
                volume: self.merged(&one, &two, many, speed),
            },
            Product::Unchanged => one,
            Product::Fragment(m) => Aggregate {
                m,
                volume: m * (one.volume + two.volume) / (one.m + two.m),
            },
            Product::Remnant(m) => Aggregate {
                m,
                volume: m * one.volume / one.m,
            },
            Product::Coated(extra) => Aggregate {
                m: two.m + extra,
                volume: two.volume + extra * one.volume / one.m,
            },
        };
        Some((grain, outcome))
    }
}
