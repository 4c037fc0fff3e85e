//! Stress: the Reynolds stress of the resolved gas in rings about the star, as the alpha of its turbulence.
//!
//! alpha = <rho v_R' v_phi'> / <P>
//!
//! v' is the velocity beyond the circular one, sqrt(G M / R), and beyond a line in ln R through the ring's particles. Of the two factors one is a particle's
//! own and the other that of its neighbours without it, weighted as by [`gas::probe`], in turn: so the noise that particles have each
//! for itself, which is no flow that is resolved, does not count. The ring means are sums over particles by
//! their mass, of v_R' v_phi' and of the square of the isothermal sound speed; the stress is taken up by n/(n - 2), since the lines take two freedoms of n. Both
//! are averaged over time, exponentially over the ring's orbital time, at the ends of every fourth base step. Rings are equally wide in ln R, from the innermost
//! to the outermost gas of the start; between their middles alpha is linear in ln R. A negative stress carries angular momentum inwards and is no
//! diffusion: alpha is never below a floor, which is also that of rings without gas. Viscosity has no part in it.
//! Source of the definition: Balbus & Papaloizou (1999, ApJ 521, 650).

use gas::probe::{Candidates, Reach, Weights, isothermal};
use nalgebra::{Matrix2, Vector2};
use nbody::points::{Fault, Vec3};
use rayon::prelude::*;

use crate::System;
use crate::operator::{Meter, Operator, Phase};

/// Widths of rings in ln R.
const WIDTH: f64 = 0.1;

/// The most rings.
const MOST: f64 = 256.0;

/// Base steps from one measurement to the next.
const EVERY: u64 = 4;

/// The fewest particles whose mean flow is told from their turbulence.
const FEWEST: f64 = 16.0;

/// The part of the weights at its own place from which on a particle is alone.
const ALONE: f64 = 0.9;

/// The averages of a ring.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ring {
    /// Of stress and pressure by density, squares of velocities in code units; each weighted by the time since the start.
    pub stress: f64,
    pub pressure: f64,
}

/// The rings about a star; none before they are first measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stress {
    /// ln R of the innermost edge, and the width of each ring.
    pub inner: f64,
    pub width: f64,
    /// When the gas was measured last.
    pub time: f64,
    pub rings: Vec<Ring>,
}

impl Ring {
    /// alpha as it is measured; zero without gas.
    pub fn alpha(&self) -> f64 {
        if self.pressure > 0.0 {
            self.stress / self.pressure
        } else {
            0.0
        }
    }
}

/// Velocities beyond the circular one: outwards and around, a particle's own and its neighbours'.
#[derive(Clone, Copy, Debug)]
struct Flow {
    radial: [f64; 2],
    around: [f64; 2],
}

/// Sums over the particles of a ring by mass: of (1, s) times (1, s), times the velocities outwards, and around; of v_R v_phi; of c^2; and their number.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    number: f64,
    weight: Matrix2<f64>,
    radial: [Vector2<f64>; 2],
    around: [Vector2<f64>; 2],
    both: f64,
    square: f64,
}

impl Sums {
    fn add(&mut self, m: f64, s: f64, flow: &Flow, square: f64) {
        let line = m * Vector2::new(1.0, s);
        self.number += 1.0;
        self.weight += m * Matrix2::new(1.0, s, s, s * s);
        for k in 0..2 {
            self.radial[k] += flow.radial[k] * line;
            self.around[k] += flow.around[k] * line;
            self.both += 0.5 * m * flow.radial[k] * flow.around[1 - k];
        }
        self.square += m * square;
    }

    /// Means of stress and pressure by density; none of too few.
    fn means(&self) -> Option<Ring> {
        let inverse = self
            .weight
            .try_inverse()
            .filter(|_| self.number >= FEWEST)?;
        let mass = self.weight[(0, 0)];
        let mean = |k: usize| self.radial[k].dot(&(inverse * self.around[1 - k]));
        let left = self.both - 0.5 * (mean(0) + mean(1));
        Some(Ring {
            stress: left / mass * self.number / (self.number - 2.0),
            pressure: self.square / mass,
        })
    }
}

impl Stress {
    /// ln R of the middle of ring k.
    pub fn middle(&self, k: usize) -> f64 {
        self.inner + (k as f64 + 0.5) * self.width
    }

    /// alpha at a distance R from the star's axis, no less than `floor`, and its slope dalpha/dR.
    pub fn alpha(&self, radius: f64, floor: f64) -> (f64, f64) {
        let Some(last) = self.rings.len().checked_sub(1) else {
            return (floor, 0.0);
        };
        let of = |k: usize| self.rings[k].alpha().max(floor);
        let place = (radius.ln() - self.middle(0)) / self.width;
        if !(place >= 0.0 && place < last as f64) {
            let outside = place >= last as f64;
            return (of(if outside { last } else { 0 }), 0.0);
        }
        let (k, part) = (place as usize, place.fract());
        let rise = of(k + 1) - of(k);
        (of(k) + part * rise, rise / (self.width * radius))
    }

    /// Lays the rings over the gas.
    fn lay(&mut self, radii: impl Iterator<Item = f64>) {
        let (least, most) = radii
            .filter(|r| *r > 0.0)
            .fold((f64::INFINITY, 0.0f64), |(a, b), r| (a.min(r), b.max(r)));
        let range = (most / least).ln();
        if range > 0.0 && range.is_finite() {
            let number = (range / WIDTH).ceil().min(MOST);
            self.inner = least.ln();
            self.width = range / number;
            self.rings = vec![Ring::default(); number as usize];
        }
    }

    /// Takes in the gas of a system that is closed, seen by so many `neighbours`; `dt` after the last time.
    fn measure(&mut self, system: &System, neighbours: f64, dt: f64) {
        let Some(sight) = Sight::of(system) else {
            return;
        };
        let gas = &system.gas.particles;
        if self.rings.is_empty() {
            self.lay((0..gas.x.len()).map(|i| sight.radius(i)));
        }
        let flows = sight.flows(neighbours);
        let mut sums = vec![Sums::default(); self.rings.len()];
        for (i, flow) in flows.iter().enumerate() {
            let place = (sight.radius(i).ln() - self.inner) / self.width;
            // The outermost edge belongs to the last ring.
            let k = if place == sums.len() as f64 {
                place - 1.0
            } else {
                place
            };
            if k >= 0.0
                && let Some(sum) = sums.get_mut(k as usize)
            {
                let s = place - k.floor() - 0.5;
                sum.add(gas.m[i], s, flow, isothermal(&system.gas, i));
            }
        }
        for (k, sum) in sums.iter().enumerate() {
            let period = std::f64::consts::TAU * ((3.0 * self.middle(k)).exp() / sight.gm).sqrt();
            let part = -(-dt / period).exp_m1();
            self.rings[k] = sum.means().map_or_else(Ring::default, |now| {
                let ring = self.rings[k];
                Ring {
                    stress: ring.stress + part * (now.stress - ring.stress),
                    pressure: ring.pressure + part * (now.pressure - ring.pressure),
                }
            });
        }
    }
}

/// The gas as it is seen from the star.
struct Sight<'a> {
    system: &'a System,
    x: Vec3,
    v: Vec3,
    gm: f64,
}

impl<'a> Sight<'a> {
    /// None without a star.
    fn of(system: &'a System) -> Option<Self> {
        let star = &system.star;
        let gm = system.g * star.m.first()?;
        (gm > 0.0).then(|| Self {
            system,
            x: star.x[0],
            v: star.v[0],
            gm,
        })
    }

    fn radius(&self, i: usize) -> f64 {
        let x = self.system.gas.particles.x[i] - self.x;
        x.x.hypot(x.y)
    }

    /// The directions outwards and around from the star's axis at x, and the distance from it.
    fn frame(&self, x: Vec3) -> (Vec3, Vec3, f64) {
        let r = x - self.x;
        let radius = r.x.hypot(r.y);
        let out = Vec3::new(r.x, r.y, 0.0) / radius;
        (out, Vec3::new(-out.y, out.x, 0.0), radius)
    }

    /// Velocity of particle i beyond the circular one.
    fn beyond(&self, i: usize) -> Vec3 {
        let gas = &self.system.gas.particles;
        let (_, around, radius) = self.frame(gas.x[i]);
        gas.v[i] - self.v - (self.gm / radius).sqrt() * around
    }

    /// The flow at each particle, by so many neighbours.
    fn flows(&self, neighbours: f64) -> Vec<Flow> {
        let (gas, domain) = (&self.system.gas, &self.system.domain);
        let p = &gas.particles;
        let reach = Reach {
            neighbours,
            largest: p.h.iter().copied().fold(0.0, f64::max),
        };
        let beyond: Vec<Vec3> = (0..p.x.len()).map(|i| self.beyond(i)).collect();
        let sight = <(Candidates, Weights)>::default;
        (0..p.x.len())
            .into_par_iter()
            .with_min_len(64)
            .map_init(sight, |(candidates, weights), i| {
                weights.find(candidates, gas, domain, (p.x[i], p.h[i]), &reach);
                let part = weights.positive(|j| f64::from(u8::from(j == i)));
                let (out, around, _) = self.frame(p.x[i]);
                // One without neighbours is no flow.
                let others = |direction: Vec3| match part < ALONE {
                    true => {
                        let other = |j: usize| match j == i {
                            true => 0.0,
                            false => beyond[j].dot(&direction),
                        };
                        weights.positive(other) / (1.0 - part)
                    }
                    false => 0.0,
                };
                Flow {
                    radial: [beyond[i].dot(&out), others(out)],
                    around: [beyond[i].dot(&around), others(around)],
                }
            })
            .collect()
    }
}

/// Measures the stress of the gas.
pub struct MeasureStress {
    /// Of a point in the gas.
    pub neighbours: f64,
}

impl Operator for MeasureStress {
    fn name(&self) -> &'static str {
        "measure stress"
    }

    fn counted(&self, _: &System) -> bool {
        false
    }

    fn close(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        if system.clock.synchronous() && system.clock.step.is_multiple_of(EVERY) {
            meter.enter(Phase::Dust);
            let mut stress = std::mem::take(&mut system.stress);
            let now = system.clock.time();
            let dt = now - std::mem::replace(&mut stress.time, now);
            stress.measure(system, self.neighbours, dt);
            system.stress = stress;
        }
        Ok(false)
    }
}

#[cfg(test)]
mod tests;
