//! Potentials of all masses, for reports: what the tree does not know is added pair by pair, and the potential energy is summed.

use std::borrow::Cow;

use nbody::Kind;
use nbody::gravity::per_distance;
use nbody::points::{Vec3, sum};
use rayon::prelude::*;

use super::{DUST, GAS, Heavy, PLANETESIMALS, PLANETS, Plan, Softening};
use crate::System;

/// The planetesimals' potentials by each other, for integrators that do their forces themselves.
pub fn add_mutual_potentials(system: &mut System) {
    let (bodies, g) = (&mut system.bodies, system.g);
    let x = system.seen.places(&bodies.x);
    let small = |i: usize| bodies.kind[i] != Kind::Planet as u32;
    let softening = &bodies.softening;
    // Only masses pull: without this, test particles would cost the square of their number.
    let sources: Vec<usize> = (0..x.len())
        .filter(|&j| small(j) && bodies.m[j] > 0.0)
        .collect();
    let phi = |i: usize| -> f64 {
        let others = sources.iter().filter(|&&j| j != i);
        others
            .map(|&j| {
                let q2 = (x[j] - x[i]).norm_squared() + softening[i].powi(2) + softening[j].powi(2);
                -bodies.m[j] * per_distance(q2)
            })
            .sum()
    };
    let added: Vec<f64> = (0..x.len())
        .into_par_iter()
        .map(|i| if small(i) { g * phi(i) } else { 0.0 })
        .collect();
    for (potential, more) in bodies.potential.iter_mut().zip(added) {
        *potential += more;
    }
}

/// A population as the sum of potentials sees it.
struct Members<'a> {
    x: &'a [Vec3],
    m: &'a [f64],
    softening: Cow<'a, [f64]>,
    potential: &'a mut [f64],
    /// What they are in the table of pulls, unless they are planets.
    rank: usize,
    /// Places of planets: they have their own sum.
    planets: Vec<usize>,
}

impl Plan {
    /// Whether either of two pulls the other: what pulls nobody and is pulled by nobody has no potential energy.
    fn counts(&self, a: usize, b: usize) -> bool {
        self.pulls[a][b] || self.pulls[b][a]
    }
}

impl Members<'_> {
    /// Adds the potentials of `heavies`; returns the potential energy: half of what stood there before, all of what is added.
    fn add(&mut self, plan: &Plan, heavies: &[Heavy], g: f64) -> f64 {
        let Self {
            x,
            m,
            softening,
            potential,
            rank,
            planets,
        } = self;
        let halves = sum::ordered(x.len(), 0.0, |range| {
            range.fold(0.0, |sum, i| sum + m[i] * potential[i])
        });
        let added: Vec<f64> = (0..x.len())
            .into_par_iter()
            .with_min_len(sum::CHUNK)
            .map(|i| {
                let planet = planets.contains(&i);
                let rank = if planet { PLANETS } else { *rank };
                let others = heavies
                    .iter()
                    .filter(|heavy| heavy.star || !planet || heavy.place != i)
                    .filter(|heavy| plan.counts(heavy.rank(), rank));
                others
                    .map(|heavy| g * heavy.pull(x[i], softening[i]).1)
                    .sum()
            })
            .collect();
        let whole = sum::ordered(x.len(), 0.0, |range| {
            range.fold(0.0, |sum, i| sum + m[i] * added[i])
        });
        let double: f64 = planets.iter().map(|&i| m[i] * added[i]).sum();
        for (phi, more) in potential.iter_mut().zip(added) {
            *phi += more;
        }
        0.5 * halves + whole - double
    }
}

/// Adds the potentials of star and planets to those of the tree, and sums the potential energy.
pub fn add_potentials(system: &mut System, plan: &Plan, heavies: &[Heavy]) {
    let g = system.g;
    let (gas, dust, bodies) = (&mut system.gas, &mut system.dust, &mut system.bodies);
    let soft =
        |softening: Softening, h: &[f64]| h.iter().map(|&h| softening.of(h)).collect::<Cow<_>>();
    let fluid = |rank, (x, m), softening, potential| Members {
        x,
        m,
        softening,
        potential,
        rank,
        planets: Vec::new(),
    };
    let (p, d) = (&gas.particles, &dust.particles);
    let (soft_gas, soft_dust) = (soft(plan.gas, &p.h), soft(plan.dust, &d.h));
    let (phi_gas, phi_dust) = (&mut gas.rates.potential, &mut dust.rates.potential);
    let mut energy = fluid(GAS, (&p.x, &p.m), soft_gas, phi_gas).add(plan, heavies, g);
    energy += fluid(DUST, (&d.x, &d.m), soft_dust, phi_dust).add(plan, heavies, g);
    let planets = (0..bodies.x.len())
        .filter(|&i| bodies.kind[i] == Kind::Planet as u32)
        .collect();
    let softening = Cow::Borrowed(&bodies.softening[..]);
    energy += Members {
        x: system.seen.places(&bodies.x),
        m: &bodies.m,
        softening,
        potential: &mut bodies.potential,
        rank: PLANETESIMALS,
        planets,
    }
    .add(plan, heavies, g);
    for (k, heavy) in heavies.iter().enumerate() {
        let others = heavies[..k].iter();
        for other in others.filter(|other| plan.counts(heavy.rank(), other.rank())) {
            let softening = if heavy.star || other.star {
                0.0
            } else {
                other.softening
            };
            energy += g * other.m * heavy.pull(other.x, softening).1;
        }
    }
    system.potential = energy;
}
