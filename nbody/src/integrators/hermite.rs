//! Hermite integrator with individual steps in blocks: sixth order for the pull of a centre, fourth for all others.
//!
//! With jumps D over a step h and sums S of both ends: v' = v + h S(a)/2 - h^2 D(j)/12, x' = x + h S(v)/2 - h^2 D(a)/12 for the others;
//! for the centre, whose snap s is known, 1/10 in place of 1/12 and h^3 S(s)/120 and h^3 S(j)/120 more. The ends are corrected twice,
//! which makes the step nearly symmetric in time. Step: that of the centre or of the others, whichever is shorter (see [`step`]), rounded down
//! to a power of two of the span. Each call starts afresh.
//! Source: Makino & Aarseth (1992); Nitadori & Makino (2008), eqs. 5 to 11; Kokubo, Yoshinaga & Makino (1998) for the iteration.

mod masses;
mod step;
#[cfg(test)]
mod tests;

use rayon::prelude::*;

use crate::points::Vec3;
pub use masses::Masses;
use step::{End, Rates, shorter};

/// What pulls on body `i` when all are at `x`, `v`.
pub trait Field: Sync {
    /// What all pulls at one time have in common.
    type Common: Sync;
    fn common(&self, x: &[Vec3], v: &[Vec3]) -> Self::Common;
    /// G times the mass at the origin, and the square of its softening length; no mass, no centre.
    fn centre(&self, _i: usize) -> [f64; 2] {
        [0.0; 2]
    }
    /// Acceleration and jerk by everything but the centre.
    fn pull(&self, i: usize, x: &[Vec3], v: &[Vec3], common: &Self::Common) -> [Vec3; 2];
}

/// Ticks of a span.
pub const SPAN: u64 = 1 << 44;
/// Pairs of an active and any body beyond which the work is shared among threads.
const MANY: usize = 30_000;
const CORRECTIONS: usize = 2;

/// A body at the begin of its step.
#[derive(Clone, Copy, Debug, Default)]
struct Path {
    x: Vec3,
    v: Vec3,
    end: End,
    rates: Rates,
    begin: u64,
    step: u64,
    /// The step before, in ticks; zero before the first.
    done: u64,
}

/// The state of an integration over one span; keeps its buffers between spans.
#[derive(Clone, Debug)]
pub struct Hermite {
    /// Accuracy: square of the part that a step is of the time in which the pull of the others changes.
    pub eta: f64,
    unit: f64,
    pub now: u64,
    paths: Vec<Path>,
    /// Everybody's state now: predicted, for `active` corrected.
    pub x_now: Vec<Vec3>,
    pub v_now: Vec<Vec3>,
    /// Whose step ends now.
    pub active: Vec<u32>,
    fresh: Vec<End>,
}

/// A step shorter than a span can be divided into, or none that is finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stall {
    pub place: usize,
}

impl Default for Hermite {
    fn default() -> Self {
        Self {
            eta: 0.01,
            unit: 0.0,
            now: 0,
            paths: Vec::new(),
            x_now: Vec::new(),
            v_now: Vec::new(),
            active: Vec::new(),
            fresh: Vec::new(),
        }
    }
}

impl Hermite {
    /// Moves bodies at `x`, `v` over `dt`.
    pub fn advance(
        &mut self,
        field: &impl Field,
        (x, v): (&mut [Vec3], &mut [Vec3]),
        dt: f64,
    ) -> Result<(), Stall> {
        self.begin(field, x.iter().copied().zip(v.iter().copied()), dt)?;
        while self.now < SPAN {
            self.step(field)?;
        }
        x.copy_from_slice(&self.x_now);
        v.copy_from_slice(&self.v_now);
        Ok(())
    }

    /// Takes bodies in for a span of `dt`.
    pub fn begin(
        &mut self,
        field: &impl Field,
        bodies: impl Iterator<Item = (Vec3, Vec3)>,
        dt: f64,
    ) -> Result<(), Stall> {
        self.paths.clear();
        self.paths.extend(bodies.map(|(x, v)| Path {
            x,
            v,
            ..Path::default()
        }));
        (self.unit, self.now) = (dt / SPAN as f64, 0);
        self.x_now.clear();
        self.x_now.extend(self.paths.iter().map(|path| path.x));
        self.v_now.clear();
        self.v_now.extend(self.paths.iter().map(|path| path.v));
        self.active.clear();
        self.active.extend(0..self.paths.len() as u32);
        self.pull(field);
        for (path, end) in self.paths.iter_mut().zip(&self.fresh) {
            path.end = *end;
        }
        self.set_off(field, dt)
    }

    /// Gives body i a new state now, from which it sets off afresh.
    pub fn place(&mut self, field: &impl Field, i: usize, x: Vec3, v: Vec3) -> Result<(), Stall> {
        (self.x_now[i], self.v_now[i]) = (x, v);
        let (x_now, v_now) = (&self.x_now, &self.v_now);
        let end = End::of(field, i, (x_now, v_now), &field.common(x_now, v_now));
        let [a, j] = [end.a(), end.j()];
        // What changes its state may make it quicker, never slower.
        let wanted = 0.1 * self.eta.sqrt() * a.norm() / j.norm();
        let step = self.block(i, wanted, self.paths[i].done)?;
        self.paths[i] = Path {
            x,
            v,
            end,
            rates: Rates::default(),
            begin: self.now,
            step,
            ..self.paths[i]
        };
        Ok(())
    }

    /// Removes body i; the last one takes its place, also among the active.
    pub fn remove(&mut self, i: usize) {
        let last = self.paths.len() - 1;
        self.active.retain(|&k| k as usize != i);
        let moved = self.active.iter_mut().filter(|k| **k as usize == last);
        moved.for_each(|k| *k = i as u32);
        self.x_now.swap_remove(i);
        self.v_now.swap_remove(i);
        self.paths.swap_remove(i);
    }

    /// Time since the last end of a step of i or j before now.
    pub fn since(&self, i: usize, j: usize) -> f64 {
        let [a, b] = [i, j].map(|i| match self.now - self.paths[i].begin {
            0 => self.paths[i].done,
            ticks => ticks,
        });
        a.min(b) as f64 * self.unit
    }

    /// A first step for all: part of the shortest |a|/|j| and (|a|/|a''|)^(1/2), a'' by a difference over a trial time that is short
    /// for everybody. Bodies at rest have no jerk, one amid others has no pull.
    fn set_off(&mut self, field: &impl Field, dt: f64) -> Result<(), Stall> {
        let times = self.paths.iter().map(|path| path.end);
        let times = times.map(|end| end.a().norm() / end.j().norm());
        let by_jerk = times.fold(f64::INFINITY, shorter);
        let mut trial = by_jerk.min(dt) / 64.0;
        let shortest = loop {
            (0..self.paths.len()).for_each(|i| self.predict(i, trial));
            self.pull(field);
            let ends = self.fresh.iter().zip(&self.paths);
            let times = ends.map(|(there, here)| {
                let snap = (there.j() - here.end.j()).norm() / trial;
                (here.end.a().norm() / snap).sqrt()
            });
            let shortest = times.fold(by_jerk, shorter);
            if trial <= 0.125 * shortest || trial < self.unit {
                break shortest;
            }
            trial *= 0.5;
        };
        for i in 0..self.paths.len() {
            let step = self.block(i, 0.3 * self.eta.sqrt() * shortest, SPAN)?;
            (self.paths[i].step, self.paths[i].done) = (step, step);
        }
        Ok(())
    }

    /// Everything of body i `h` after the begin of its step, without what pulls it there.
    #[inline]
    fn predict(&mut self, i: usize, h: f64) {
        let Path {
            x, v, end, rates, ..
        } = &self.paths[i];
        let (a, j) = (end.a(), end.j());
        let [snap, crackle] = [rates.snap(), rates.crackle()];
        let [half, third, fourth, fifth] = [2.0, 3.0, 4.0, 5.0].map(|n| h / n);
        self.x_now[i] = x + (v + (a + (j + (snap + crackle * fifth) * fourth) * third) * half) * h;
        self.v_now[i] = v + (a + (j + (snap + crackle * fourth) * third) * half) * h;
    }

    /// The longest power of two of ticks that is not longer than `wanted` and `longest` and ends where such steps end.
    fn block(&self, i: usize, wanted: f64, longest: u64) -> Result<u64, Stall> {
        let ticks = wanted / self.unit;
        if ticks < 1.0 || ticks.is_nan() {
            return Err(Stall { place: i });
        }
        let ticks = (ticks.min(longest as f64)) as u64;
        let mut step = 1 << ticks.ilog2();
        while !self.now.is_multiple_of(step) {
            step /= 2;
        }
        Ok(step)
    }

    /// Moves on to the next time at which a step ends.
    pub fn step(&mut self, field: &impl Field) -> Result<(), Stall> {
        let ends = self.paths.iter().map(|path| path.begin + path.step);
        self.now = ends.min().unwrap_or(SPAN);
        self.active.clear();
        for i in 0..self.paths.len() {
            let Path { begin, step, .. } = self.paths[i];
            if begin + step == self.now {
                self.active.push(i as u32);
            }
            self.predict(i, (self.now - begin) as f64 * self.unit);
        }
        for _ in 0..CORRECTIONS {
            self.pull(field);
            for (end, &i) in self.fresh.iter().zip(&self.active) {
                let i = i as usize;
                let Path { x, v, step, .. } = self.paths[i];
                let h = step as f64 * self.unit;
                (self.x_now[i], self.v_now[i]) = end.corrected(&self.paths[i].end, (x, v), h);
            }
        }
        self.pull(field);
        (0..self.active.len()).try_for_each(|k| self.close(k))
    }

    /// Ends the step of the k-th active body and chooses the next.
    fn close(&mut self, k: usize) -> Result<(), Stall> {
        let i = self.active[k] as usize;
        let last = self.paths[i];
        let end = self.fresh[k];
        let rates = end.rates(&last.end, last.step as f64 * self.unit);
        let longest = (2 * last.step).min(SPAN);
        let step = self.block(i, end.step(&rates, self.eta), longest)?;
        self.paths[i] = Path {
            x: self.x_now[i],
            v: self.v_now[i],
            end,
            rates,
            begin: self.now,
            step,
            done: last.step,
        };
        Ok(())
    }

    /// Pulls on the active bodies where everybody is now.
    fn pull(&mut self, field: &impl Field) {
        self.fresh.resize(self.active.len(), End::default());
        let (x, v) = (&self.x_now, &self.v_now);
        let common = field.common(x, v);
        let one = |(end, &i): (&mut End, &u32)| *end = End::of(field, i as usize, (x, v), &common);
        if self.active.len() * x.len() < MANY {
            self.fresh.iter_mut().zip(&self.active).for_each(one);
        } else {
            self.fresh.par_iter_mut().zip(&self.active).for_each(one);
        }
    }
}
