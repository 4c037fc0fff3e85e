//! Sums of a particle's forces and heats: as rates, and weighted by the parts of the pairs' steps that they close and open.
//!
//! Forces are summed in double precision, so that the impulses of a pair cancel. Where all particles keep the same pace, the weights
//! are the same for all pairs, and one sum serves for all three.

use fearless_simd::{Simd, SimdBase, SimdFloat};

use super::Pace;
use super::pair::Member;
use crate::lanes::{Lanes, Machine, Real, same};

/// What a particle gets, times its mass: as a rate, closing and opening; in units of the sweep and ticks.
pub struct Total {
    pub force: [[f64; 3]; 3],
    pub heat: [f64; 3],
    /// The shortest next step of those that it meets, in ticks; infinite if it meets nobody.
    pub near: f64,
}

/// Sums over pairs.
pub trait Sums<S: Simd, E: Real> {
    /// Adds the force of some pairs on `own`, and the heat that stays with it.
    fn add(
        &mut self,
        simd: S,
        own: &Member<S, E>,
        other: &Member<S, E>,
        force: [Lanes<S, E>; 3],
        heat: Lanes<S, E>,
    );
}

/// Sums where all keep the same pace.
pub struct Even<S: Simd, E: Real> {
    force: [S::f64s; 3],
    heat: Lanes<S, E>,
}

impl<S: Simd, E: Real> Even<S, E> {
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        Self {
            force: [same::<S, f64>(simd, 0.0); 3],
            heat: same::<S, E>(simd, 0.0),
        }
    }

    /// The sums over `count` neighbours at this pace.
    #[inline(always)]
    pub fn total<R: Machine<S, E>>(&self, pace: Pace, count: usize) -> Total {
        let [x, y, z] = self.force;
        let [x, y, z] = [R::double_total(x), R::double_total(y), R::double_total(z)];
        let heat = R::total(self.heat);
        let [close, open] = pace.weights();
        Total {
            force: [
                [x, y, z],
                [close * x, close * y, close * z],
                [open * x, open * y, open * z],
            ],
            heat: [heat, close * heat, open * heat],
            near: if count > 0 {
                f64::from(pace.next_span)
            } else {
                f64::INFINITY
            },
        }
    }
}

impl<S: Simd, E: Real> Sums<S, E> for Even<S, E> {
    #[inline(always)]
    fn add(
        &mut self,
        _simd: S,
        _own: &Member<S, E>,
        _other: &Member<S, E>,
        [x, y, z]: [Lanes<S, E>; 3],
        heat: Lanes<S, E>,
    ) {
        E::accumulate(&mut self.force[0], x);
        E::accumulate(&mut self.force[1], y);
        E::accumulate(&mut self.force[2], z);
        self.heat += heat;
    }
}

/// Sums where steps differ.
pub struct Mixed<S: Simd, E: Real> {
    force: [[S::f64s; 3]; 3],
    heat: [Lanes<S, E>; 3],
    near: Lanes<S, E>,
}

impl<S: Simd, E: Real> Mixed<S, E> {
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        Self {
            force: [[same::<S, f64>(simd, 0.0); 3]; 3],
            heat: [same::<S, E>(simd, 0.0); 3],
            near: same::<S, E>(simd, f64::INFINITY),
        }
    }

    /// The sums over all neighbours.
    #[inline(always)]
    pub fn total<R: Machine<S, E>>(&self) -> Total {
        let mut force = [[0.0; 3]; 3];
        for (force, sums) in force.iter_mut().zip(&self.force) {
            for (force, &sum) in force.iter_mut().zip(sums) {
                *force = R::double_total(sum);
            }
        }
        let [rate, close, open] = self.heat;
        let [rate, close, open, _] = R::totals([rate, close, open, open]);
        let mut near = f64::INFINITY;
        for x in self.near.as_slice() {
            near = near.min(x.to_f64());
        }
        Total {
            force,
            heat: [rate, close, open],
            near,
        }
    }
}

impl<S: Simd, E: Real> Sums<S, E> for Mixed<S, E> {
    #[inline(always)]
    fn add(
        &mut self,
        simd: S,
        own: &Member<S, E>,
        other: &Member<S, E>,
        force: [Lanes<S, E>; 3],
        heat: Lanes<S, E>,
    ) {
        let half = same::<S, E>(simd, 0.5);
        // The later begin of a pair is the lesser age.
        let closing = own.age.min(other.age) - own.span.min(other.span) * half;
        let opening = own.next_span.min(other.next_span) * half;
        let [rate, close, open] = &mut self.force;
        for (a, &force) in force.iter().enumerate() {
            E::accumulate(&mut rate[a], force);
            E::accumulate(&mut close[a], closing * force);
            E::accumulate(&mut open[a], opening * force);
        }
        self.heat[0] += heat;
        self.heat[1] = closing.mul_add(heat, self.heat[1]);
        self.heat[2] = opening.mul_add(heat, self.heat[2]);
        self.near = self.near.min(other.next_span);
    }
}
