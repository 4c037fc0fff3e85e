//! Stirring as an operator: dust walks at random as turbulence of the gas around would carry it ([`dust::stirring`]).
//!
//! Each grain takes the walk of its whole step when that begins, from the gas where it then is: particles (by [`gas::probe`]) or a disk that is
//! a formula, which no walk leaves. With its place changes the velocity of the orbits around (of the shear, in a shearing box), so
//! that it keeps its own motion. Balances of settling and stirring are of first order in the step: off by St Omega dt / 4 in the scale height.
//! Numbers are keyed by seed, grain and tick. Momentum and energy come from gas that nobody follows: they are booked as given away.

use dust::{Air, Ambient, Sphere, StoppingLaw, Turbulence};
use gas::Hydro;
use gas::probe::{Candidates, Reach, Shape, Weights, isothermal};
use nbody::points::random::{Purpose, stream};
use nbody::points::{Fault, Vec3};
use rand::RngExt;
use rand_distr::StandardNormal;
use rayon::prelude::*;

use crate::System;
use crate::drag::Star;
use crate::external::GasDisk;
use crate::ledger::Totals;
use crate::operator::{Meter, Operator, Phase};

/// The gas that stirs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Medium {
    /// Particles, so many of which are asked about the gas at a point.
    Particles {
        neighbours: f64,
    },
    Disk(GasDisk),
}

/// alpha of the turbulence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Strength {
    Given(f64),
    /// That of the system's stress, and no less than `floor`.
    Measured {
        floor: f64,
    },
}

impl Medium {
    pub fn particles(hydro: &Hydro) -> Self {
        Self::Particles {
            neighbours: hydro.neighbours,
        }
    }
}

/// Where a grain walks to, and how the velocity of the orbits around changes on the way.
#[derive(Clone, Copy, Debug, Default)]
struct Walk {
    dx: Vec3,
    dv: Vec3,
}

/// Random walks of the dust.
pub struct Stir {
    strength: Strength,
    law: StoppingLaw,
    medium: Medium,
    seed: u64,
    active: Vec<u32>,
    walks: Vec<Walk>,
}

impl Stir {
    pub fn new(strength: Strength, law: StoppingLaw, medium: Medium, seed: u64) -> Self {
        Self {
            strength,
            law,
            medium,
            seed,
            active: Vec::new(),
            walks: Vec::new(),
        }
    }

    /// The walks of the active grains.
    fn plan(&mut self, system: &System) {
        let (seed, strength, law) = (self.seed, self.strength, &self.law);
        let surroundings = Surroundings::of(system, self.medium);
        // No two ticks of a run share it.
        let now = system.next.step << 30 | u64::from(system.next.tick);
        let p = &system.dust.particles;
        self.walks.resize(self.active.len(), Walk::default());
        self.walks
            .par_iter_mut()
            .zip(&self.active)
            .with_min_len(64)
            .for_each_init(Sight::default, |sight, (walk, &i)| {
                let i = i as usize;
                *walk = Walk::default();
                let Some(air) = surroundings.air(sight, i) else {
                    return;
                };
                let mut random = stream(seed, Purpose::Turbulence, p.id[i], now);
                let gauss = Vec3::from_fn(|_, _| random.sample(StandardNormal));
                let sphere = Sphere {
                    radius: p.grain_radius[i],
                    density: p.grain_density[i],
                };
                let dt = f64::from(p.span[i]) * system.next.unit();
                let turbulence = surroundings.turbulence(strength, p.x[i]);
                let dx = turbulence.walk(law, &sphere, &air, dt, gauss);
                *walk = surroundings.walk(p.x[i], system.domain.in_plane(dx));
            });
    }

    /// Moves the active grains, and books what that changes.
    fn go(&self, system: &mut System) {
        let star = system.seen.star_x.first().map(|&x| {
            let gm = system.g * system.star.m[0];
            (x, gm)
        });
        let (p, rates) = (&mut system.dust.particles, &mut system.dust.rates);
        let mut gained = Totals::default();
        for (walk, &i) in self.walks.iter().zip(&self.active) {
            let (i, Walk { dx, dv }) = (i as usize, *walk);
            let (m, x, v) = (p.m[i], p.x[i], rates.v_pred[i]);
            gained.momentum += m * dv;
            // Of the velocity that the ledger counts, which is that of the middle of the step.
            let counted = p.v[i];
            gained.angular_momentum += m * (dx.cross(&(counted + dv)) + x.cross(&dv));
            gained.kinetic += m * (dv.dot(&(v + 0.5 * dv)) + climb(star, rates.gravity[i], x, dx));
            p.x[i] += dx;
            p.v[i] += dv;
            rates.v_pred[i] += dv;
        }
        let lost = &mut system.ledger.given_away;
        lost.momentum -= gained.momentum;
        lost.angular_momentum -= gained.angular_momentum;
        lost.kinetic -= gained.kinetic;
    }
}

/// By how much the potential differs between `x` and `x + dx`: that of the star exactly, the rest of `gravity` as if it were uniform.
fn climb(star: Option<(Vec3, f64)>, gravity: Vec3, x: Vec3, dx: Vec3) -> f64 {
    let Some((centre, gm)) = star else {
        return -gravity.dot(&dx);
    };
    let r = x - centre;
    let (near, far) = (r.norm(), (r + dx).norm());
    let own = -gm / (near * near * near) * r;
    gm * (1.0 / near - 1.0 / far) - (gravity - own).dot(&dx)
}

/// Buffers of a thread while it looks at gas.
#[derive(Default)]
struct Sight {
    candidates: Candidates,
    weights: Weights,
}

/// All that a walk depends on but the grain.
struct Surroundings<'a> {
    system: &'a System,
    medium: Medium,
    star: Star,
    reach: Reach,
}

impl<'a> Surroundings<'a> {
    fn of(system: &'a System, medium: Medium) -> Self {
        let neighbours = match medium {
            Medium::Particles { neighbours } => neighbours,
            Medium::Disk(_) => 0.0,
        };
        let largest = system.gas.particles.h.iter().copied().fold(0.0, f64::max);
        Self {
            system,
            medium,
            star: Star::of(system),
            reach: Reach {
                neighbours,
                largest,
            },
        }
    }

    /// The gas around grain `i`; none where there is none.
    fn air(&self, sight: &mut Sight, i: usize) -> Option<Air> {
        match self.medium {
            Medium::Particles { .. } => self.among_particles(sight, i),
            Medium::Disk(disk) => {
                let x = self.system.dust.particles.x[i] - self.star.x;
                disk.air(x, self.star.gm)
            }
        }
    }

    fn among_particles(&self, sight: &mut Sight, i: usize) -> Option<Air> {
        let (gas, domain) = (&self.system.gas, &self.system.domain);
        let p = &self.system.dust.particles;
        let (x, weights) = (p.x[i], &mut sight.weights);
        weights.find(&mut sight.candidates, gas, domain, (x, p.h[i]), &self.reach);
        if weights.shape == Shape::Empty {
            return None;
        }
        let leverage = weights.leverage(domain)?;
        let slope = |field: &dyn Fn(usize) -> f64| weights.gradient(domain, &leverage, field);
        let r = x - self.star.x;
        Some(Air {
            ambient: Ambient {
                rho: weights.rho,
                c: weights.positive(|j| isothermal(gas, j)).sqrt(),
                omega: self.star.omega(x),
            },
            log_rho: slope(&|j| gas.derived.rho[j].ln()),
            log_c: 0.5 * slope(&|j| isothermal(gas, j).ln()),
            log_omega: match self.star.gm > 0.0 {
                true => -1.5 / r.norm_squared() * r,
                false => Vec3::zeros(),
            },
        })
    }

    /// The turbulence of `strength` at `x`.
    fn turbulence(&self, strength: Strength, x: Vec3) -> Turbulence {
        match strength {
            Strength::Given(alpha) => Turbulence::uniform(alpha),
            Strength::Measured { floor } => {
                let r = x - self.star.x;
                let radius = r.x.hypot(r.y);
                let (alpha, slope) = self.system.stress.alpha(radius, floor);
                Turbulence {
                    alpha,
                    slope: slope / radius * Vec3::new(r.x, r.y, 0.0),
                }
            }
        }
    }

    /// The walk from `x` by `dx`; none if it would leave a disk that has an edge.
    fn walk(&self, x: Vec3, dx: Vec3) -> Walk {
        if let Medium::Disk(disk) = self.medium
            && disk.at(x + dx - self.star.x, self.star.gm).is_none()
        {
            return Walk::default();
        }
        Walk {
            dx,
            dv: self.orbiting(x + dx) - self.orbiting(x),
        }
    }

    /// Velocity of circular orbits, but for that of the star; of the shear in a shearing box.
    fn orbiting(&self, x: Vec3) -> Vec3 {
        if let Some(hill) = self.system.domain.hill() {
            return hill.stream(x) * Vec3::y();
        }
        let r = x - self.star.x;
        let radius = r.x.hypot(r.y);
        if self.star.gm == 0.0 || radius == 0.0 {
            return Vec3::zeros();
        }
        (self.star.gm / radius).sqrt() / radius * Vec3::new(-r.y, r.x, 0.0)
    }
}

impl Operator for Stir {
    fn name(&self) -> &'static str {
        "stir dust"
    }

    fn prepare(&mut self, system: &mut System, _: &mut dyn Meter) -> Result<(), Fault> {
        system.list_active_dust(&mut self.active);
        Ok(())
    }

    fn open(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Dust);
        self.plan(system);
        self.go(system);
        Ok(true)
    }
}

#[cfg(test)]
mod tests;
