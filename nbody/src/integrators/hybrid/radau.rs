//! Gauss-Radau steps of order 15 for one group: many short integrations, each started afresh and watched for touches.
//!
//! The series are those of `gauss_radau` (Everhart 1985; Rein & Spiegel 2015). Sums are plain, since a group is integrated over one step of
//! the whole only. Positions count from a point that moves uniformly with the group: its separations would lose digits as differences
//! of distances from the star. A touch within a step is found on the step's own polynomial: the group is stopped there and goes on with
//! the two bound together.

mod touch;

use super::group::Group;
use crate::integrators::gauss_radau::series::{
    Halt, LANES, Lane, SAFETY, Series, cut, iterate, next_step,
};
use crate::points::Vec3;

/// Positions and velocities of four components.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    x: Lane,
    v: Lane,
}

#[derive(Debug, Default)]
pub struct Radau {
    states: Vec<State>,
    series: Vec<Series>,
    x: Vec<f64>,
    a: Vec<f64>,
    /// Where the group's origin is at the begin of the step, and its velocity.
    origin: Vec3,
    way: Vec3,
}

/// No step short enough could be done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stall;

/// Bound of max|b6|/max|a|; the error of the step is far smaller.
const EPSILON: f64 = 1e-9;
/// Above this relative change an iteration has not come to an end.
const ROUNDING: f64 = 1e-7;
/// The origin is moved to a pair that is closer than this part of its distance.
const FAR: f64 = 3.0;

impl Radau {
    /// Moves the group over `dt`.
    pub fn advance(&mut self, group: &mut Group, dt: f64) -> Result<(), Stall> {
        let mut time = 0.0;
        while let Some(pair) = group.overlap() {
            group.bind(pair, time);
        }
        self.load(group);
        let mut wanted = group.first_step();
        let mut last = 0.0;
        while time < dt {
            let left = dt - time;
            let h = cut(wanted, left);
            if h <= 1e-14 * dt || h.is_nan() {
                return Err(Stall);
            }
            self.settle(group.bodies.len());
            self.begin(group);
            let q = if last > 0.0 { h / last } else { 0.0 };
            self.series.iter_mut().for_each(|series| series.predict(q));
            let error = self.iterate(group, h);
            let next = next_step(h, error / EPSILON);
            if next < SAFETY * h {
                wanted = next;
                continue;
            }
            if let Some((fraction, pair)) = self.touch(group, h) {
                self.store(group, fraction, h);
                time += fraction * h;
                group.bind(pair, time);
                while let Some(pair) = group.overlap() {
                    group.bind(pair, time);
                }
                self.load(group);
                (wanted, last) = (group.first_step(), 0.0);
                continue;
            }
            self.finish(h);
            self.origin += self.way * h;
            time = if h == left { dt } else { time + h };
            wanted = if h < wanted { wanted.max(next) } else { next };
            last = h;
        }
        self.store(group, 0.0, 0.0);
        Ok(())
    }

    fn load(&mut self, group: &Group) {
        let first = &group.bodies[0];
        (self.origin, self.way) = (first.x, first.v);
        let components = 3 * group.bodies.len();
        let blocks = components.div_ceil(LANES);
        self.states.clear();
        self.states.resize(blocks, State::default());
        self.series.clear();
        self.series.resize(blocks, Series::default());
        self.x.clear();
        self.x.resize(blocks * LANES, 0.0);
        self.a.clear();
        self.a.resize(blocks * LANES, 0.0);
        for (i, body) in group.bodies.iter().enumerate() {
            for axis in 0..3 {
                let c = 3 * i + axis;
                let state = &mut self.states[c / LANES];
                state.x[c % LANES] = body.x[axis] - first.x[axis];
                state.v[c % LANES] = body.v[axis] - first.v[axis];
            }
        }
    }

    /// Has positions and velocities count from a member of the closest pair where that is nearer to it than they are to the origin:
    /// else what a deep encounter needs is lost in rounding, and no step is short enough.
    fn settle(&mut self, n: usize) {
        let state = |i: usize, v: bool| {
            Vec3::from_fn(|axis, _| {
                let c = 3 * i + axis;
                let state = &self.states[c / LANES];
                if v {
                    state.v[c % LANES]
                } else {
                    state.x[c % LANES]
                }
            })
        };
        let mut closest = (f64::INFINITY, 0);
        for i in 0..n {
            let x = state(i, false);
            for j in 0..i {
                let d2 = (x - state(j, false)).norm_squared();
                if d2 < closest.0 {
                    closest = (d2, j);
                }
            }
        }
        let (d2, reference) = closest;
        let (x, v) = (state(reference, false), state(reference, true));
        if d2 == 0.0 || x.norm_squared() <= FAR * FAR * d2 {
            return;
        }
        for c in 0..3 * n {
            let state = &mut self.states[c / LANES];
            state.x[c % LANES] -= x[c % 3];
            state.v[c % LANES] -= v[c % 3];
        }
        self.origin += x;
        self.way += v;
    }

    /// Hands the group its state at `fraction` of the step of `h`.
    fn store(&self, group: &mut Group, fraction: f64, h: f64) {
        for (i, body) in group.bodies.iter_mut().enumerate() {
            let here = self.origin + self.way * (fraction * h);
            body.x = here + self.position(i, fraction, h);
            body.v = self.way + self.velocity(i, fraction, h);
        }
    }

    fn position(&self, i: usize, s: f64, h: f64) -> Vec3 {
        Vec3::from_fn(|axis, _| {
            let (block, l) = ((3 * i + axis) / LANES, (3 * i + axis) % LANES);
            self.states[block].position(&self.series[block], l, s, s * h)
        })
    }

    fn velocity(&self, i: usize, s: f64, h: f64) -> Vec3 {
        Vec3::from_fn(|axis, _| {
            let (block, l) = ((3 * i + axis) / LANES, (3 * i + axis) % LANES);
            let series = &self.series[block];
            self.states[block].v[l] + s * h * (series.a0[l] + s * series.gain(l, s))
        })
    }

    /// Accelerations at the begin of the step.
    fn begin(&mut self, group: &Group) {
        for (state, x) in self.states.iter().zip(self.x.chunks_exact_mut(LANES)) {
            x.copy_from_slice(&state.x);
        }
        forces(group, self.origin, &self.x, &mut self.a);
        for (series, a) in self.series.iter_mut().zip(self.a.chunks_exact(LANES)) {
            series.a0.copy_from_slice(a);
        }
    }

    /// Iterates the polynomials of a step of `h` until they stand; returns max|b6|/max|a|.
    fn iterate(&mut self, group: &Group, h: f64) -> f64 {
        let Self {
            states,
            series,
            x,
            a,
            origin,
            way,
        } = self;
        let pull = |series: &[Series], s: f64, a: &mut [f64]| {
            let blocks = states.iter().zip(series);
            for ((state, series), x) in blocks.zip(x.chunks_exact_mut(LANES)) {
                for (l, x) in x.iter_mut().enumerate() {
                    *x = state.position(series, l, s, s * h);
                }
            }
            forces(group, *origin + *way * (s * h), x, a);
        };
        let outcome = iterate(series, a, Halt::Foreseen, pull);
        // What the iteration leaves unsettled at this level is rounding, which no shorter step would cure.
        if outcome.change < ROUNDING {
            (outcome.error - 10.0 * outcome.change).max(0.0)
        } else {
            outcome.error
        }
    }

    fn finish(&mut self, h: f64) {
        for (state, series) in self.states.iter_mut().zip(&mut self.series) {
            for l in 0..LANES {
                let v = state.v[l] + h * (series.a0[l] + series.gain(l, 1.0));
                state.x[l] = state.position(series, l, 1.0, h);
                state.v[l] = v;
            }
            series.keep();
        }
    }
}

impl State {
    /// Component l at fraction `s` of the step, `t` after its begin.
    #[inline(always)]
    fn position(&self, series: &Series, l: usize, s: f64, t: f64) -> f64 {
        let bend = 0.5 * series.a0[l] + s * series.bend(l, s);
        self.x[l] + t * (self.v[l] + t * bend)
    }
}

/// Accelerations of the group's bodies at `x` from the origin, component by component.
fn forces(group: &Group, origin: Vec3, x: &[f64], a: &mut [f64]) {
    let at = |i: usize| [x[3 * i], x[3 * i + 1], x[3 * i + 2]];
    for i in 0..group.bodies.len() {
        let here = at(i);
        let q = origin + Vec3::from(here);
        let q2 = q.norm_squared();
        let star = -group.mu / (q2 * q2.sqrt());
        for axis in 0..3 {
            a[3 * i + axis] = star * q[axis];
        }
        for j in 0..i {
            let there = at(j);
            let d = [there[0] - here[0], there[1] - here[1], there[2] - here[2]];
            let pull = group.pull(i, j, d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
            if pull > 0.0 {
                let (on_i, on_j) = (pull * group.bodies[j].m, pull * group.bodies[i].m);
                for axis in 0..3 {
                    a[3 * i + axis] += on_i * d[axis];
                    a[3 * j + axis] -= on_j * d[axis];
                }
            }
        }
    }
}
