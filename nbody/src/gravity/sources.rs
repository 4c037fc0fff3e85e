//! Sources: the particles that have mass, in the order of the curve; and beside them those that have none.
//!
//! What is alike for all is kept once: the order of sources where every particle is one, the softening where all lengths are equal.

use std::ops::Range;

use rayon::prelude::*;

use super::direct::{NO_SOURCE, Target};
use crate::points::Vec3;
use crate::points::sum::{CHUNK, Parts, ordered};

/// The particles that have mass, along the curve.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    pub x: Vec<f64>,
    pub y: Vec<f64>,
    pub z: Vec<f64>,
    /// in units of `total`
    pub m: Vec<f64>,
    /// total mass
    pub total: f64,
    /// squares of the softening lengths; empty if all particles have `common`
    own_eps2: Vec<f64>,
    common_eps2: f64,
    /// `before[i]`: how many of the particles 0..i along the curve have mass; empty if all have
    before: Vec<u32>,
    /// positions and squares of the softening lengths of the particles without mass
    idle: Vec<(Vec3, f64)>,
}

impl Sources {
    /// Takes all particles along the curve: the k-th is number `order[k]` of the columns.
    pub fn take(&mut self, order: &[u32], x: &[Vec3], m: &[f64], softening: &[f64]) {
        self.total = ordered(m.len(), 0.0, |range| m[range].iter().sum::<f64>());
        let unit = if self.total > 0.0 {
            1.0 / self.total
        } else {
            0.0
        };
        let count = self.number(order, m);
        let first = softening.first().copied().unwrap_or(0.0);
        self.common_eps2 = first.powi(2);
        let alike = softening.iter().all(|&length| length == first);
        self.own_eps2.resize(if alike { 0 } else { count }, 0.0);
        self.idle.resize(order.len() - count, (Vec3::zeros(), 0.0));
        let [xs, ys, zs, ms] = [&mut self.x, &mut self.y, &mut self.z, &mut self.m].map(|column| {
            column.resize(count, 0.0);
            Parts::new(column)
        });
        let (eps2s, idle) = (Parts::new(&mut self.own_eps2), Parts::new(&mut self.idle));
        let before = |k: usize| self.before.get(k).map_or(k, |&j| j as usize);
        let along = order.par_iter().enumerate().with_min_len(CHUNK);
        along.for_each(|(k, &i)| {
            let (i, j) = (i as usize, before(k));
            let eps2 = softening[i].powi(2);
            if before(k + 1) == j {
                let own = k - j..k - j + 1;
                // SAFETY: each particle without mass has one place along the curve.
                unsafe { idle.part(own)[0] = (x[i], eps2) };
                return;
            }
            for (column, value) in
                [&xs, &ys, &zs, &ms]
                    .into_iter()
                    .zip([x[i].x, x[i].y, x[i].z, m[i] * unit])
            {
                // SAFETY: each source has one place along the curve.
                unsafe { column.part(j..j + 1)[0] = value };
            }
            if !alike {
                // SAFETY: as above.
                unsafe { eps2s.part(j..j + 1)[0] = eps2 };
            }
        });
    }

    /// Counts the particles with mass along the curve; returns how many there are.
    fn number(&mut self, order: &[u32], m: &[f64]) -> usize {
        self.before.clear();
        if m.iter().all(|&m| m > 0.0) {
            return order.len();
        }
        let mut count = 0;
        self.before.push(0);
        self.before.extend(order.iter().map(|&i| {
            count += u32::from(m[i as usize] > 0.0);
            count
        }));
        count as usize
    }

    /// How many of the particles 0..i along the curve have mass.
    fn before(&self, i: usize) -> usize {
        self.before.get(i).map_or(i, |&j| j as usize)
    }

    /// The sources among the particles of `range` along the curve.
    pub fn of(&self, range: Range<usize>) -> Range<usize> {
        self.before(range.start)..self.before(range.end)
    }

    /// The i-th particle along the curve, with mass or without.
    pub fn target(&self, i: usize) -> Target {
        let j = self.before(i);
        if self.before(i + 1) > j {
            Target {
                x: self.position(j),
                eps2: self.eps2(j),
                source: j as u32,
            }
        } else {
            let (x, eps2) = self.idle[i - j];
            Target {
                x,
                eps2,
                source: NO_SOURCE,
            }
        }
    }

    /// The box around the particles of `range` along the curve.
    pub fn bounds(&self, range: Range<usize>) -> (Vec3, Vec3) {
        let own = self.of(range.clone());
        let idle = range.start - own.start..range.end - own.end;
        let empty = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
        let with = |(lo, hi): (Vec3, Vec3), x: Vec3| (lo.inf(&x), hi.sup(&x));
        let (xs, ys, zs) = (&self.x[own.clone()], &self.y[own.clone()], &self.z[own]);
        let rows = xs.iter().zip(ys).zip(zs);
        let of_sources = rows.fold(empty, |both, ((&x, &y), &z)| with(both, Vec3::new(x, y, z)));
        let rest = self.idle[idle].iter();
        rest.fold(of_sources, |both, &(x, _)| with(both, x))
    }

    pub fn position(&self, j: usize) -> Vec3 {
        Vec3::new(self.x[j], self.y[j], self.z[j])
    }

    /// Square of the softening length of source `j`.
    pub fn eps2(&self, j: usize) -> f64 {
        self.own_eps2.get(j).copied().unwrap_or(self.common_eps2)
    }

    /// Squares of the softening lengths of the sources in `range`, unless all particles have the one of [`Sources::eps2`].
    pub fn own_eps2(&self, range: Range<usize>) -> Option<&[f64]> {
        self.own_eps2.get(range)
    }

    pub fn count(&self) -> usize {
        self.m.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn targets_and_boxes_are_those_of_the_columns() {
        let n = 60;
        let f = |i: usize, k: f64| (i as f64 * k).fract();
        let x: Vec<Vec3> = (0..n)
            .map(|i| Vec3::new(f(i, 0.618_034), f(i, 0.414_214), f(i, 0.732_051)))
            .collect();
        let order: Vec<u32> = (0..n as u32).map(|k| k * 7 % n as u32).collect();
        for (every, softer) in [(1, 0.0), (1, 0.1), (3, 0.0), (3, 0.1)] {
            let m: Vec<f64> = (0..n).map(|i| f64::from(i % every == 0)).collect();
            let softening: Vec<f64> = (0..n).map(|i| 0.2 + softer * f(i, 0.3)).collect();
            let mut sources = Sources::default();
            sources.take(&order, &x, &m, &softening);
            for (k, &i) in order.iter().enumerate() {
                let (i, target) = (i as usize, sources.target(k));
                assert_eq!((target.x, target.eps2), (x[i], softening[i].powi(2)));
                assert_eq!(target.source != NO_SOURCE, m[i] > 0.0);
            }
            for first in 0..n - 5 {
                let own = order[first..first + 5].iter().map(|&i| x[i as usize]);
                let (lo, hi) = sources.bounds(first..first + 5);
                assert_eq!(lo, own.clone().reduce(|a, b| a.inf(&b)).expect("five"));
                assert_eq!(hi, own.reduce(|a, b| a.sup(&b)).expect("five"));
            }
        }
    }
}
