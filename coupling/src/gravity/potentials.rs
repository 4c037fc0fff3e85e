//! Potentials of all masses, for reports: what the tree does not know is added pair by pair, and the potential energy is summed.

use std::borrow::Cow;

use nbody::Kind;
use nbody::gravity::per_distance;
use nbody::points::{Vec3, sum};
use rayon::prelude::*;

use super::{Heavy, Plan, Softening};
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
    /// Places of planets: they have their own sum.
    planets: Vec<usize>,
}

impl Members<'_> {
    /// Adds the potentials of `heavies`; returns the potential energy: half of what stood there before, all of what is added.
    fn add(&mut self, heavies: &[Heavy], g: f64) -> f64 {
        let Self {
            x,
            m,
            softening,
            potential,
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
                let others = heavies
                    .iter()
                    .filter(|heavy| heavy.star || !planet || heavy.place != i);
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
    let fluid = |x, m, h, softening, potential| Members {
        x,
        m,
        softening: soft(softening, h),
        potential,
        planets: Vec::new(),
    };
    let (p, d) = (&gas.particles, &dust.particles);
    let mut energy = fluid(&p.x, &p.m, &p.h, plan.gas, &mut gas.rates.potential).add(heavies, g);
    energy += fluid(&d.x, &d.m, &d.h, plan.dust, &mut dust.rates.potential).add(heavies, g);
    let planets = (0..bodies.x.len())
        .filter(|&i| bodies.kind[i] == Kind::Planet as u32)
        .collect();
    let softening = Cow::Borrowed(&bodies.softening[..]);
    energy += Members {
        x: system.seen.places(&bodies.x),
        m: &bodies.m,
        softening,
        potential: &mut bodies.potential,
        planets,
    }
    .add(heavies, g);
    for (k, heavy) in heavies.iter().enumerate() {
        for other in &heavies[..k] {
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
