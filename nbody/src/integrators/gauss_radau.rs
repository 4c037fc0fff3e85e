//! Gauss-Radau integrator of order 15 with adaptive steps, for forces that depend on positions alone.
//!
//! Within a step a(s) = a0 + b0 s + ... + b6 s^7; the b are found by iteration over seven force evaluations at the spacings h,
//! x(s) = x + v s dt + (s dt)^2 (a0/2 + b0 s/6 + ... + b6 s^7/72), started from the last step's polynomial, shifted.
//! Step: dt' = dt (epsilon / (max|b6|/max|a|))^(1/7); repeated if that is below a quarter of dt. Sums are compensated, so the energy
//! error is a random walk in rounding. A force must be smooth; it may be softened.
//! Source: Everhart (1985); Rein & Spiegel (2015).

mod checkpoint;
pub(super) mod series;
mod spacings;

use thiserror::Error;

use crate::bodies::Bodies;
use crate::points::Vec3;
use series::{Halt, LANES, SAFETY, Series, cut, iterate, larger, next_step};

/// The integrator's state: what it integrates, its polynomial and its step.
#[derive(Clone, Debug)]
pub struct GaussRadau {
    /// Precision wanted of the polynomial; 1e-9 reaches rounding.
    pub epsilon: f64,
    time: f64,
    x: Vec<Vec3>,
    v: Vec<Vec3>,
    /// Rounding left over in time, x and v, one a component.
    time_lost: f64,
    x_lost: Vec<f64>,
    v_lost: Vec<f64>,
    /// Step wanted next, and the last step done (signed); zero before the first.
    wanted: f64,
    last: f64,
    /// The accelerations, of four components each.
    series: Vec<Series>,
    scratch: Scratch,
}

/// Positions and accelerations within a step; the accelerations once more, one a component.
#[derive(Clone, Debug)]
struct Scratch {
    x: Vec<Vec3>,
    a: Vec<Vec3>,
    flat: Vec<f64>,
}

/// The step that a force asks for is shorter than the time can resolve, or the force is not finite.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error("the Gauss-Radau integrator cannot go on at time {time}: it would need a step of {step}")]
pub struct Stall {
    pub time: f64,
    pub step: f64,
}

/// A polynomial is not carried over to a step longer than this many last steps.
const FARTHEST: f64 = 20.0;

impl GaussRadau {
    pub fn new(time: f64, x: &[Vec3], v: &[Vec3]) -> Self {
        assert_eq!(x.len(), v.len(), "a velocity a body");
        let components = 3 * x.len();
        let blocks = components.div_ceil(LANES);
        Self {
            epsilon: 1e-9,
            time,
            x: x.to_vec(),
            v: v.to_vec(),
            time_lost: 0.0,
            x_lost: vec![0.0; components],
            v_lost: vec![0.0; components],
            wanted: 0.0,
            last: 0.0,
            series: vec![Series::default(); blocks],
            scratch: Scratch {
                x: x.to_vec(),
                a: x.to_vec(),
                flat: vec![0.0; blocks * LANES],
            },
        }
    }

    /// Star first, then bodies.
    pub fn of(time: f64, star: &Bodies, bodies: &Bodies) -> Self {
        Self::new(
            time,
            &[&star.x[..], &bodies.x[..]].concat(),
            &[&star.v[..], &bodies.v[..]].concat(),
        )
    }

    /// Writes positions and velocities to star and bodies, as [`GaussRadau::of`] read them.
    pub fn store(&self, star: &mut Bodies, bodies: &mut Bodies) {
        let n = star.x.len();
        assert_eq!(n + bodies.x.len(), self.x.len(), "the bodies of the start");
        star.x.copy_from_slice(&self.x[..n]);
        star.v.copy_from_slice(&self.v[..n]);
        bodies.x.copy_from_slice(&self.x[n..]);
        bodies.v.copy_from_slice(&self.v[n..]);
    }

    pub fn time(&self) -> f64 {
        self.time
    }

    pub fn x(&self) -> &[Vec3] {
        &self.x
    }

    pub fn v(&self) -> &[Vec3] {
        &self.v
    }

    /// Velocities, to be kicked from outside between two calls of [`GaussRadau::advance_to`].
    pub fn v_mut(&mut self) -> &mut [Vec3] {
        &mut self.v
    }

    /// Integrates to time `end`, before or after now. `force` gets positions and adds accelerations to zeros.
    pub fn advance_to(
        &mut self,
        end: f64,
        mut force: impl FnMut(&[Vec3], &mut [Vec3]),
    ) -> Result<(), Stall> {
        while self.time != end {
            self.advance(end, &mut force)?;
        }
        Ok(())
    }

    /// One step towards `end`.
    fn advance(
        &mut self,
        end: f64,
        force: &mut impl FnMut(&[Vec3], &mut [Vec3]),
    ) -> Result<(), Stall> {
        self.begin(force);
        let left = (end - self.time) + self.time_lost;
        if self.wanted == 0.0 {
            self.wanted = self.first_step(left.abs());
        }
        loop {
            let dt = left.signum() * cut(self.wanted, left.abs());
            let stall = Stall {
                time: self.time,
                step: dt,
            };
            if !(self.wanted.is_finite() && dt.abs() > 1e-16 * left.abs()) {
                return Err(stall);
            }
            self.predict(dt);
            let error = self.iterate(dt, force);
            let next = next_step(dt.abs(), error / self.epsilon);
            if next < SAFETY * dt.abs() {
                self.wanted = next;
                continue;
            }
            // A step cut to land on the end says nothing against the longer one.
            let cut_short = dt.abs() < self.wanted;
            self.wanted = if cut_short {
                self.wanted.max(next)
            } else {
                next
            };
            self.finish(dt);
            if dt == left {
                (self.time, self.time_lost) = (end, 0.0);
            }
            return Ok(());
        }
    }

    /// Accelerations at the begin of the step.
    fn begin(&mut self, force: &mut impl FnMut(&[Vec3], &mut [Vec3])) {
        let Scratch { a, flat, .. } = &mut self.scratch;
        a.fill(Vec3::zeros());
        force(&self.x, a);
        flatten(a, flat);
        for (series, a) in self.series.iter_mut().zip(flat.chunks_exact(LANES)) {
            series.a0.copy_from_slice(a);
        }
    }

    /// A careful first step: a hundredth of the fall time over the smallest distance with the largest acceleration.
    fn first_step(&self, left: f64) -> f64 {
        let strongest = self.scratch.a.iter().map(|a| a.norm()).fold(0.0, larger);
        let mut nearest = f64::INFINITY;
        for (i, x) in self.x.iter().enumerate() {
            let others = self.x[..i].iter().map(|y| (x - y).norm());
            nearest = others.filter(|&d| d > 0.0).fold(nearest, f64::min);
        }
        if nearest.is_infinite() {
            nearest = self.x.iter().map(|x| x.norm()).fold(0.0, larger);
        }
        let fall = 0.01 * (nearest / strongest).sqrt();
        if fall > 0.0 && fall < left {
            fall
        } else {
            left
        }
    }

    /// The polynomials of a step of `dt` from those of the last.
    fn predict(&mut self, dt: f64) {
        let q = if self.last == 0.0 {
            0.0
        } else {
            dt / self.last
        };
        let known = q > 0.0 && q <= FARTHEST;
        let q = if known { q } else { 0.0 };
        self.series.iter_mut().for_each(|series| series.predict(q));
    }

    /// Iterates the polynomials of a step of `dt` until they stand; returns max|b6|/max|a|.
    fn iterate(&mut self, dt: f64, force: &mut impl FnMut(&[Vec3], &mut [Vec3])) -> f64 {
        let Self {
            x: begin,
            v,
            x_lost,
            series,
            scratch: Scratch { x, a, flat },
            ..
        } = self;
        let pull = |series: &[Series], h: f64, flat: &mut [f64]| {
            let t = h * dt;
            for (i, x) in x.iter_mut().enumerate() {
                for axis in 0..3 {
                    let c = 3 * i + axis;
                    let (series, l) = (&series[c / LANES], c % LANES);
                    let bend = 0.5 * series.a0[l] + h * series.bend(l, h);
                    x[axis] = begin[i][axis] + (t * (v[i][axis] + t * bend) - x_lost[c]);
                }
            }
            a.fill(Vec3::zeros());
            force(x, a);
            flatten(a, flat);
        };
        iterate(series, flat, Halt::Settled, pull).error
    }

    /// Takes the step.
    fn finish(&mut self, dt: f64) {
        for c in 0..self.x_lost.len() {
            let (i, axis, l) = (c / 3, c % 3, c % LANES);
            let series = &self.series[c / LANES];
            let (x, v, a0) = (&mut self.x[i][axis], &mut self.v[i][axis], series.a0[l]);
            let (x_lost, v_lost) = (&mut self.x_lost[c], &mut self.v_lost[c]);
            // The large terms with what rounding takes from them.
            let (far, fast) = (dt * *v, dt * a0);
            let far_rest = dt.mul_add(*v, -far) - dt * *v_lost;
            let fast_rest = dt.mul_add(a0, -fast);
            let bend = dt * (dt * series.bend(l, 1.0) + 0.5 * fast);
            add(x, x_lost, far_rest + bend);
            add(x, x_lost, far);
            add(v, v_lost, fast_rest + dt * series.gain(l, 1.0));
            add(v, v_lost, fast);
        }
        self.series.iter_mut().for_each(Series::keep);
        self.last = dt;
        add(&mut self.time, &mut self.time_lost, dt);
    }
}

/// One a component; what is beyond the bodies is left.
fn flatten(of: &[Vec3], flat: &mut [f64]) {
    for (flat, of) in flat.chunks_exact_mut(3).zip(of) {
        flat.copy_from_slice(of.as_slice());
    }
}

/// Compensated sum (Kahan): `lost` is what the last additions put too much.
fn add(sum: &mut f64, lost: &mut f64, term: f64) {
    let term = term - *lost;
    let new = *sum + term;
    *lost = (new - *sum) - term;
    *sum = new;
}

#[cfg(test)]
mod tests;
