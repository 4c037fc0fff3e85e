//! Hermite integrator of fourth order with individual steps in blocks.
//!
//! Predict x, v by acceleration and jerk; correct v' = v + h (a + a')/2 + h^2 (j - j')/12, x' = x + h (v + v')/2 + h^2 (a - a')/12, three
//! times, which makes the step nearly symmetric in time. Step: h = sqrt(eta (|a||a''| + |j|^2)/(|j||a'''| + |a''|^2)), rounded down to a
//! power of two of the span. Each call starts afresh. Energy error of a circular orbit a revolution: about eta^(5/2).
//! Source: Makino & Aarseth (1992); Aarseth (1985) for the step; Kokubo, Yoshinaga & Makino (1998) for the iteration.

#[cfg(test)]
mod tests;

use rayon::prelude::*;

use crate::bodies::Bodies;
use crate::points::Vec3;

/// What pulls: acceleration and jerk of body `i` when all are at `x`, `v`.
pub trait Field: Sync {
    fn pull(&self, i: usize, x: &[Vec3], v: &[Vec3]) -> [Vec3; 2];
}

/// Ticks of a span.
pub const SPAN: u64 = 1 << 44;
/// Pairs of an active and any body beyond which the work is shared among threads.
const MANY: usize = 30_000;
const CORRECTIONS: usize = 3;

/// The state of an integration over one span; keeps its buffers between spans.
#[derive(Clone, Debug)]
pub struct Hermite {
    /// Accuracy: part of the time in which the acceleration changes.
    pub eta: f64,
    unit: f64,
    pub now: u64,
    x: Vec<Vec3>,
    v: Vec<Vec3>,
    pulls: Vec<[Vec3; 2]>,
    begin: Vec<u64>,
    step: Vec<u64>,
    /// The step before, in ticks; zero before the first.
    done: Vec<u64>,
    /// Everybody's state now: predicted, for `active` corrected.
    pub x_now: Vec<Vec3>,
    pub v_now: Vec<Vec3>,
    /// Whose step ends now.
    pub active: Vec<u32>,
    fresh: Vec<[Vec3; 2]>,
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
            x: Vec::new(),
            v: Vec::new(),
            pulls: Vec::new(),
            begin: Vec::new(),
            step: Vec::new(),
            done: Vec::new(),
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
        self.x.clear();
        self.v.clear();
        for (x, v) in bodies {
            self.x.push(x);
            self.v.push(v);
        }
        let n = self.x.len();
        (self.unit, self.now) = (dt / SPAN as f64, 0);
        self.x_now.clone_from(&self.x);
        self.v_now.clone_from(&self.v);
        self.active.clear();
        self.active.extend(0..n as u32);
        self.pull(field);
        self.pulls.clone_from(&self.fresh);
        self.begin.clear();
        self.begin.resize(n, 0);
        self.step.clear();
        self.step.resize(n, 0);
        self.done.clear();
        self.done.resize(n, 0);
        self.set_off(field, dt)
    }

    /// Gives body i a new state now, from which it sets off afresh.
    pub fn place(&mut self, field: &impl Field, i: usize, x: Vec3, v: Vec3) -> Result<(), Stall> {
        (self.x[i], self.v[i]) = (x, v);
        (self.x_now[i], self.v_now[i]) = (x, v);
        self.pulls[i] = field.pull(i, &self.x_now, &self.v_now);
        let [a, j] = self.pulls[i];
        // What changes its state may make it quicker, never slower.
        let wanted = 0.1 * self.eta.sqrt() * a.norm() / j.norm();
        self.begin[i] = self.now;
        self.step[i] = self.block(i, wanted, self.done[i])?;
        Ok(())
    }

    /// Removes body i; the last one takes its place, also among the active.
    pub fn remove(&mut self, i: usize) {
        let last = self.x.len() - 1;
        self.active.retain(|&k| k as usize != i);
        let moved = self.active.iter_mut().filter(|k| **k as usize == last);
        moved.for_each(|k| *k = i as u32);
        for column in [&mut self.x, &mut self.v, &mut self.x_now, &mut self.v_now] {
            column.swap_remove(i);
        }
        self.pulls.swap_remove(i);
        self.begin.swap_remove(i);
        self.step.swap_remove(i);
        self.done.swap_remove(i);
    }

    /// Time since the last end of a step of i or j before now.
    pub fn since(&self, i: usize, j: usize) -> f64 {
        let [a, b] = [i, j].map(|i| match self.now - self.begin[i] {
            0 => self.done[i],
            ticks => ticks,
        });
        a.min(b) as f64 * self.unit
    }

    /// A first step for all: part of the shortest |a|/|j| and (|a|/|a''|)^(1/2), a'' by a difference over a trial time that is short
    /// for everybody. Bodies at rest have no jerk, one amid others has no pull.
    fn set_off(&mut self, field: &impl Field, dt: f64) -> Result<(), Stall> {
        let least = |shortest: f64, time: f64| {
            if time > 0.0 {
                shortest.min(time)
            } else {
                shortest
            }
        };
        let times = self.pulls.iter().map(|[a, j]| a.norm() / j.norm());
        let by_jerk = times.fold(f64::INFINITY, least);
        let mut trial = by_jerk.min(dt) / 64.0;
        let shortest = loop {
            (0..self.x.len()).for_each(|i| self.predict(i, trial));
            self.pull(field);
            let pulls = self.fresh.iter().zip(&self.pulls);
            let times = pulls.map(|(there, here)| {
                let snap = (there[1] - here[1]).norm() / trial;
                (here[0].norm() / snap).sqrt()
            });
            let shortest = times.fold(by_jerk, least);
            if trial <= 0.125 * shortest || trial < self.unit {
                break shortest;
            }
            trial *= 0.5;
        };
        for i in 0..self.x.len() {
            self.step[i] = self.block(i, 0.3 * self.eta.sqrt() * shortest, SPAN)?;
            self.done[i] = self.step[i];
        }
        Ok(())
    }

    /// Everything of body i `h` after the begin of its step, without what pulls it there.
    #[inline]
    fn predict(&mut self, i: usize, h: f64) {
        let [a, j] = self.pulls[i];
        let third = h / 3.0;
        self.x_now[i] = self.x[i] + (self.v[i] + (a + j * third) * (0.5 * h)) * h;
        self.v_now[i] = self.v[i] + (a + j * (0.5 * h)) * h;
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
        let ends = self.begin.iter().zip(&self.step).map(|(b, s)| b + s);
        self.now = ends.min().unwrap_or(SPAN);
        self.active.clear();
        for i in 0..self.x.len() {
            if self.begin[i] + self.step[i] == self.now {
                self.active.push(i as u32);
            }
            self.predict(i, (self.now - self.begin[i]) as f64 * self.unit);
        }
        for _ in 0..CORRECTIONS {
            self.pull(field);
            for (k, &i) in self.active.iter().enumerate() {
                let i = i as usize;
                let h = self.step[i] as f64 * self.unit;
                let ([a, j], [a1, j1]) = (self.pulls[i], self.fresh[k]);
                let twelfth = h * h / 12.0;
                self.v_now[i] = self.v[i] + (a + a1) * (0.5 * h) + (j - j1) * twelfth;
                self.x_now[i] =
                    self.x[i] + (self.v[i] + self.v_now[i]) * (0.5 * h) + (a - a1) * twelfth;
            }
        }
        self.pull(field);
        (0..self.active.len()).try_for_each(|k| self.close(k))
    }

    /// Ends the step of the k-th active body and chooses the next.
    fn close(&mut self, k: usize) -> Result<(), Stall> {
        let i = self.active[k] as usize;
        let h = self.step[i] as f64 * self.unit;
        let ([a, j], [a1, j1]) = (self.pulls[i], self.fresh[k]);
        let snap = ((a1 - a) * 6.0 - (j * 4.0 + j1 * 2.0) * h) / (h * h);
        let crackle = ((a - a1) * 12.0 + (j + j1) * (6.0 * h)) / (h * h * h);
        let snap = (snap + crackle * h).norm();
        let (a, j) = (a1.norm(), j1.norm());
        let slow = j * crackle.norm() + snap * snap;
        let wanted = if slow == 0.0 {
            f64::INFINITY
        } else {
            (self.eta * (a * snap + j * j) / slow).sqrt()
        };
        let longest = (2 * self.step[i]).min(SPAN);
        (self.x[i], self.v[i], self.pulls[i]) = (self.x_now[i], self.v_now[i], self.fresh[k]);
        (self.begin[i], self.done[i]) = (self.now, self.step[i]);
        self.step[i] = self.block(i, wanted, longest)?;
        Ok(())
    }

    /// Pulls on the active bodies where everybody is now.
    fn pull(&mut self, field: &impl Field) {
        self.fresh.resize(self.active.len(), [Vec3::zeros(); 2]);
        let (x, v) = (&self.x_now, &self.v_now);
        let one = |(pull, &i): (&mut [Vec3; 2], &u32)| *pull = field.pull(i as usize, x, v);
        if self.active.len() * x.len() < MANY {
            self.fresh.iter_mut().zip(&self.active).for_each(one);
        } else {
            self.fresh.par_iter_mut().zip(&self.active).for_each(one);
        }
    }
}

/// Star (first) and bodies as point masses, softened by their own lengths: a = G m d/(d^2 + eps_i^2 + eps_j^2)^(3/2).
#[derive(Clone, Debug, Default)]
pub struct Masses {
    pub g: f64,
    m: Vec<f64>,
    eps2: Vec<f64>,
    x: Vec<Vec3>,
    v: Vec<Vec3>,
}

impl Field for Masses {
    fn pull(&self, i: usize, x: &[Vec3], v: &[Vec3]) -> [Vec3; 2] {
        let mut sum = [Vec3::zeros(); 2];
        for j in (0..x.len()).filter(|&j| j != i) {
            let (d, w) = (x[j] - x[i], v[j] - v[i]);
            let q2 = d.norm_squared() + (self.eps2[i] + self.eps2[j]);
            if q2 != 0.0 {
                let inverse = 1.0 / q2;
                let pull = self.g * self.m[j] * inverse * inverse.sqrt();
                sum[0] += d * pull;
                sum[1] += (w - d * (3.0 * inverse * d.dot(&w))) * pull;
            }
        }
        sum
    }
}

impl Masses {
    /// Moves star and bodies on each other by `dt`. The place of a stall counts the star as the first.
    pub fn drift(
        &mut self,
        hermite: &mut Hermite,
        star: &mut Bodies,
        bodies: &mut Bodies,
        dt: f64,
    ) -> Result<(), Stall> {
        self.m.clear();
        self.m.extend(star.m.iter().chain(&bodies.m));
        self.eps2.clear();
        let softening = star.softening.iter().chain(&bodies.softening);
        self.eps2.extend(softening.map(|eps| eps * eps));
        let (mut x, mut v) = (std::mem::take(&mut self.x), std::mem::take(&mut self.v));
        x.clear();
        x.extend(star.x.iter().chain(&bodies.x));
        v.clear();
        v.extend(star.v.iter().chain(&bodies.v));
        let done = hermite.advance(self, (&mut x, &mut v), dt);
        let stars = star.x.len();
        star.x.copy_from_slice(&x[..stars]);
        star.v.copy_from_slice(&v[..stars]);
        bodies.x.copy_from_slice(&x[stars..]);
        bodies.v.copy_from_slice(&v[stars..]);
        (self.x, self.v) = (x, v);
        done
    }
}
