//! Star and planets: what each does to others pair by pair, and what those give back.

use nbody::Kind;
use nbody::points::{Vec3, sum};
use rayon::prelude::*;

use super::{Mutual, PLANETESIMALS, PLANETS, Plan, STAR};
use crate::System;

/// A massive body that pulls pair by pair.
#[derive(Clone, Copy, Debug)]
pub struct Heavy {
    pub x: Vec3,
    pub m: f64,
    pub softening: f64,
    /// Its place among the bodies, or among the stars.
    pub place: usize,
    pub star: bool,
}

/// The stars and planets of the system that pull, where they are seen now; to be given back to [`System::heavies`] for its memory.
pub fn heavies(system: &mut System) -> Vec<Heavy> {
    let mut all = std::mem::take(&mut system.heavies);
    all.clear();
    let own = system.seen.places(&system.bodies.x);
    for (bodies, x, star) in [
        (&system.star, &system.seen.star_x[..], true),
        (&system.bodies, own, false),
    ] {
        let pulls =
            |&i: &usize| star || (bodies.kind[i] == Kind::Planet as u32 && bodies.m[i] > 0.0);
        all.extend((0..bodies.x.len()).filter(pulls).map(|i| Heavy {
            x: x[i],
            m: bodies.m[i],
            softening: bodies.softening[i],
            place: i,
            star,
        }));
    }
    all
}

impl Heavy {
    /// Its place in [`super::Pulls`].
    pub(super) fn rank(&self) -> usize {
        if self.star { STAR } else { PLANETS }
    }

    /// Acceleration of a point at `x` with softening length `softening`, and the potential there, for G = 1.
    pub fn pull(&self, x: Vec3, softening: f64) -> (Vec3, f64) {
        let dx = self.x - x;
        let own = if self.star { 0.0 } else { softening };
        let r2 = dx.norm_squared() + self.softening * self.softening + own * own;
        if r2 > 0.0 {
            let inverse = 1.0 / r2.sqrt();
            (
                dx * (self.m * inverse * inverse * inverse),
                -self.m * inverse,
            )
        } else {
            (Vec3::zeros(), 0.0)
        }
    }
}

impl Plan {
    /// The pulls of star and planets on active gas and dust.
    pub(super) fn pull_fluids(&self, system: &mut System, heavies: &[Heavy]) {
        let (tick, synchronous, g) = (system.clock.tick, system.clock.synchronous(), system.g);
        let felt = |target: usize| (heavies.iter()).filter(move |h| self.pulls[h.rank()][target]);
        let softening = self.gas;
        if felt(0).next().is_some() {
            system.gas.pull(|gravity, gas, i| {
                let soft = softening.of(gas.h[i]);
                felt(0).fold(gravity, |sum, heavy| sum + g * heavy.pull(gas.x[i], soft).0)
            });
        }
        if felt(1).next().is_none() {
            return;
        }
        let dust = &mut system.dust;
        let (particles, gravity) = (&dust.particles, &mut dust.rates.gravity);
        gravity
            .par_iter_mut()
            .enumerate()
            .with_min_len(sum::CHUNK)
            .for_each(|(i, gravity)| {
                if synchronous || particles.end[i] == tick {
                    let soft = self.dust.of(particles.h[i]);
                    for heavy in felt(1) {
                        *gravity += g * heavy.pull(particles.x[i], soft).0;
                    }
                }
            });
    }

    /// The pulls among star, planets and planetesimals that the kick has.
    pub(super) fn pull_bodies(&self, system: &mut System, heavies: &[Heavy]) {
        let (g, pulls) = (system.g, &self.pulls);
        let bodies = &mut system.bodies;
        let x = system.seen.places(&bodies.x);
        let (kind, softening) = (&bodies.kind, &bodies.softening);
        let rank = |i: usize| {
            if kind[i] == Kind::Planet as u32 {
                PLANETS
            } else {
                PLANETESIMALS
            }
        };
        for heavy in heavies {
            if !(if heavy.star {
                self.star_in_kick
            } else {
                !matches!(self.mutual, Mutual::Drift)
            }) {
                continue;
            }
            bodies
                .a
                .par_iter_mut()
                .enumerate()
                .with_min_len(sum::CHUNK)
                .for_each(|(i, a)| {
                    if pulls[heavy.rank()][rank(i)] && (heavy.star || i != heavy.place) {
                        *a += g * heavy.pull(x[i], softening[i]).0;
                    }
                });
            // What the pulled ones give back; planets among themselves have it from the loop above.
            let back = sum::ordered(x.len(), Vec3::zeros(), |range| {
                range
                    .filter(|&i| {
                        pulls[rank(i)][heavy.rank()] && (heavy.star || rank(i) == PLANETESIMALS)
                    })
                    .fold(Vec3::zeros(), |sum, i| {
                        sum - bodies.m[i] * heavy.pull(x[i], softening[i]).0
                    })
            });
            if heavy.m > 0.0 {
                let own = if heavy.star {
                    &mut system.star.a
                } else {
                    &mut bodies.a
                };
                own[heavy.place] += g * back / heavy.m;
            }
        }
    }
}
