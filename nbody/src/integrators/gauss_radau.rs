//! Gauss-Radau integrator of order 15 with adaptive steps, for forces that depend on positions alone.
//!
//! Within a step a(s) = a0 + b0 s + ... + b6 s^7; the b are found by iteration over seven force evaluations at the spacings h,
//! x(s) = x + v s dt + (s dt)^2 (a0/2 + b0 s/6 + ... + b6 s^7/72), started from the last step's polynomial, shifted.
//! Step: dt' = dt (epsilon / (max|b6|/max|a|))^(1/7); repeated if that is below a quarter of dt. Sums are compensated, so the energy
//! error is a random walk in rounding. A force must be smooth; it may be softened.
//! Source: Everhart (1985); Rein & Spiegel (2015).

mod checkpoint;
pub(super) mod spacings;

use thiserror::Error;

use crate::bodies::Bodies;
use crate::points::Vec3;
use spacings::{C, D, H, R, SHIFT};

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
    /// Polynomial of the last step, and what was predicted for it, one a component.
    b_last: Vec<Seven>,
    e_last: Vec<Seven>,
    scratch: Scratch,
}

type Seven = [f64; 7];

#[derive(Clone, Debug, Default)]
struct Scratch {
    a0: Vec<Vec3>,
    b: Vec<Seven>,
    e: Vec<Seven>,
    g: Vec<Seven>,
    x: Vec<Vec3>,
    a: Vec<Vec3>,
}

/// The step that a force asks for is shorter than the time can resolve, or the force is not finite.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error("the Gauss-Radau integrator cannot go on at time {time}: it would need a step of {step}")]
pub struct Stall {
    pub time: f64,
    pub step: f64,
}

/// A step is repeated if the next one is this much shorter, and never grows by more than its inverse.
const SAFETY: f64 = 0.25;
const MOST_ITERATIONS: usize = 12;
/// A polynomial is not carried over to a step longer than this many last steps.
const FARTHEST: f64 = 20.0;

impl GaussRadau {
    pub fn new(time: f64, x: &[Vec3], v: &[Vec3]) -> Self {
        assert_eq!(x.len(), v.len(), "a velocity a body");
        let components = 3 * x.len();
        let zeros = vec![[0.0; 7]; components];
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
            b_last: zeros.clone(),
            e_last: zeros,
            scratch: Scratch::sized(x.len()),
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
        self.scratch.a0.fill(Vec3::zeros());
        force(&self.x, &mut self.scratch.a0);
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

    /// A careful first step: a hundredth of the fall time over the smallest distance with the largest acceleration.
    fn first_step(&self, left: f64) -> f64 {
        let strongest = self.scratch.a0.iter().map(|a| a.norm()).fold(0.0, larger);
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

    /// The last polynomial, shifted to the step of `dt`, plus what the last prediction lacked.
    fn predict(&mut self, dt: f64) {
        let q = if self.last == 0.0 {
            0.0
        } else {
            dt / self.last
        };
        let Scratch { b, e, g, .. } = &mut self.scratch;
        let known = q > 0.0 && q <= FARTHEST;
        for i in 0..b.len() {
            (b[i], e[i]) = ([0.0; 7], [0.0; 7]);
            if known {
                let mut power = 1.0;
                for k in 0..7 {
                    power *= q;
                    e[i][k] = power * (k..7).map(|j| SHIFT[j][k] * self.b_last[i][j]).sum::<f64>();
                    b[i][k] = e[i][k] + (self.b_last[i][k] - self.e_last[i][k]);
                }
            }
            g[i] = std::array::from_fn(|k| (k..7).map(|j| D[j][k] * b[i][j]).sum());
        }
    }

    /// Iterates the polynomial of a step of `dt` until it stands; returns max|b6|/max|a|.
    fn iterate(&mut self, dt: f64, force: &mut impl FnMut(&[Vec3], &mut [Vec3])) -> f64 {
        let mut last = f64::INFINITY;
        for iteration in 0..MOST_ITERATIONS {
            let mut change = 0.0;
            for (n, h) in H.iter().enumerate().skip(1) {
                self.reach(*h, dt);
                self.scratch.a.fill(Vec3::zeros());
                force(&self.scratch.x, &mut self.scratch.a);
                change = match n {
                    1 => self.scratch.correct::<1>(),
                    2 => self.scratch.correct::<2>(),
                    3 => self.scratch.correct::<3>(),
                    4 => self.scratch.correct::<4>(),
                    5 => self.scratch.correct::<5>(),
                    6 => self.scratch.correct::<6>(),
                    _ => self.scratch.correct::<7>(),
                };
            }
            let change = change / self.scratch.strongest();
            // Twice the same or more: rounding is all that is left.
            if change < 1e-16 || iteration > 1 && change >= last {
                break;
            }
            last = change;
        }
        let strongest = self.scratch.strongest();
        let b6 = self.scratch.b.iter().map(|b| b[6].abs()).fold(0.0, larger);
        if strongest > 0.0 { b6 / strongest } else { b6 }
    }

    /// Positions at fraction `h` of the step, into the scratch.
    fn reach(&mut self, h: f64, dt: f64) {
        let s = h * dt;
        let Scratch { a0, b, x, .. } = &mut self.scratch;
        for (i, x) in x.iter_mut().enumerate() {
            for axis in 0..3 {
                let c = 3 * i + axis;
                let bend = 0.5 * a0[i][axis] + h * polynomial(&b[c], &X_WEIGHTS, h);
                x[axis] = self.x[i][axis] + (s * (self.v[i][axis] + s * bend) - self.x_lost[c]);
            }
        }
    }

    /// Takes the step.
    fn finish(&mut self, dt: f64) {
        let Scratch { a0, b, e, .. } = &self.scratch;
        for (c, b) in b.iter().enumerate() {
            let (i, axis) = (c / 3, c % 3);
            let (x, v, a0) = (&mut self.x[i][axis], &mut self.v[i][axis], a0[i][axis]);
            let (x_lost, v_lost) = (&mut self.x_lost[c], &mut self.v_lost[c]);
            // The large terms with what rounding takes from them.
            let (far, fast) = (dt * *v, dt * a0);
            let far_rest = dt.mul_add(*v, -far) - dt * *v_lost;
            let fast_rest = dt.mul_add(a0, -fast);
            let bend = dt * (dt * polynomial(b, &X_WEIGHTS, 1.0) + 0.5 * fast);
            add(x, x_lost, far_rest + bend);
            add(x, x_lost, far);
            add(v, v_lost, fast_rest + dt * polynomial(b, &V_WEIGHTS, 1.0));
            add(v, v_lost, fast);
        }
        self.b_last.copy_from_slice(b);
        self.e_last.copy_from_slice(e);
        self.last = dt;
        add(&mut self.time, &mut self.time_lost, dt);
    }
}

impl Scratch {
    fn sized(n: usize) -> Self {
        let (vectors, sevens) = (vec![Vec3::zeros(); n], vec![[0.0; 7]; 3 * n]);
        Self {
            a0: vectors.clone(),
            b: sevens.clone(),
            e: sevens.clone(),
            g: sevens,
            x: vectors.clone(),
            a: vectors,
        }
    }

    /// Corrects g and b by the accelerations at spacing N; returns the largest change of g.
    fn correct<const N: usize>(&mut self) -> f64 {
        let mut most = 0.0;
        for i in 0..self.a.len() {
            for axis in 0..3 {
                let c = 3 * i + axis;
                let (b, g) = (&mut self.b[c], &mut self.g[c]);
                let mut new = (self.a[i][axis] - self.a0[i][axis]) * R[N][0];
                for k in 1..N {
                    new = (new - g[k - 1]) * R[N][k];
                }
                let change = new - g[N - 1];
                g[N - 1] = new;
                for k in 0..N {
                    b[k] += change * C[N - 1][k];
                }
                most = larger(most, change.abs());
            }
        }
        most
    }

    /// Largest component of the accelerations at the last spacing.
    fn strongest(&self) -> f64 {
        self.a.iter().map(|a| a.amax()).fold(0.0, larger)
    }
}

/// 1/((k + 2) (k + 3)) and 1/(k + 2): b_k in the double and the single integral.
const X_WEIGHTS: Seven = [
    1.0 / 6.0,
    1.0 / 12.0,
    1.0 / 20.0,
    1.0 / 30.0,
    1.0 / 42.0,
    1.0 / 56.0,
    1.0 / 72.0,
];
const V_WEIGHTS: Seven = [
    1.0 / 2.0,
    1.0 / 3.0,
    1.0 / 4.0,
    1.0 / 5.0,
    1.0 / 6.0,
    1.0 / 7.0,
    1.0 / 8.0,
];

fn polynomial(b: &Seven, weights: &Seven, h: f64) -> f64 {
    (0..7).rev().fold(0.0, |sum, k| b[k] * weights[k] + h * sum)
}

/// The larger of two, or a NaN.
fn larger(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

/// Compensated sum (Kahan): `lost` is what the last additions put too much.
fn add(sum: &mut f64, lost: &mut f64, term: f64) {
    let term = term - *lost;
    let new = *sum + term;
    *lost = (new - *sum) - term;
    *sum = new;
}

/// The step of about `wanted` that leaves no crumb before the end.
fn cut(wanted: f64, left: f64) -> f64 {
    if left <= wanted {
        left
    } else if left < 2.0 * wanted {
        0.5 * left
    } else {
        wanted
    }
}

/// The step that would make the error, given in units of the one allowed, one.
fn next_step(dt: f64, error: f64) -> f64 {
    if error.is_nan() || error.is_infinite() {
        return 0.1 * SAFETY * dt;
    }
    dt * error.powf(-1.0 / 7.0).min(1.0 / SAFETY)
}

#[cfg(test)]
mod tests;
