//! Gauss-Radau steps of order 15 for one group: many short integrations, each started afresh and watched for touches.
//!
//! The method is that of `gauss_radau` (Everhart 1985; Rein & Spiegel 2015). Components stand in blocks of four that the compiler can
//! put into registers; sums are plain, since a group is integrated over one step of the whole only. Positions count from a point that
//! moves uniformly with the group: its separations would lose digits as differences of distances from the star. A touch within a step is found on
//! the step's own polynomial: the group is stopped there and goes on with the two bound together.

use super::group::Group;
use crate::integrators::gauss_radau::spacings::{C, D, H, R, SHIFT};
use crate::points::Vec3;

const LANES: usize = 4;
type Lane = [f64; LANES];

/// Four components: state, acceleration at the begin of the step, both forms of the polynomial.
#[derive(Clone, Copy, Debug, Default)]
struct Block {
    x: Lane,
    v: Lane,
    a0: Lane,
    b: [Lane; 7],
    g: [Lane; 7],
    /// What was predicted for b, and b of the last step with its prediction.
    e: [Lane; 7],
    b_last: [Lane; 7],
    e_last: [Lane; 7],
}

#[derive(Debug, Default)]
pub struct Radau {
    blocks: Vec<Block>,
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
const SAFETY: f64 = 0.25;
const MOST_ITERATIONS: usize = 12;
/// Below this relative change the polynomial stands.
const STANDS: f64 = 1e-15;
/// Above this relative change an iteration has not come to an end.
const ROUNDING: f64 = 1e-7;
/// The origin is moved to a pair that is closer than this part of its distance.
const FAR: f64 = 3.0;
/// Bodies are bound this little within their contact, so that it is one for everybody.
const DEPTH: f64 = 1e-9;

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
            self.predict(if last > 0.0 { h / last } else { 0.0 });
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
        self.blocks.clear();
        self.blocks.resize(blocks, Block::default());
        self.x.clear();
        self.x.resize(blocks * LANES, 0.0);
        self.a.clear();
        self.a.resize(blocks * LANES, 0.0);
        for (i, body) in group.bodies.iter().enumerate() {
            for axis in 0..3 {
                let c = 3 * i + axis;
                let block = &mut self.blocks[c / LANES];
                block.x[c % LANES] = body.x[axis] - first.x[axis];
                block.v[c % LANES] = body.v[axis] - first.v[axis];
            }
        }
    }

    /// Has positions and velocities count from a member of the closest pair where that is nearer to it than they are to the origin:
    /// else what a deep encounter needs is lost in rounding, and no step is short enough.
    fn settle(&mut self, n: usize) {
        let state = |i: usize, v: bool| {
            Vec3::from_fn(|axis, _| {
                let (block, l) = self.component(i, axis);
                if v { block.v[l] } else { block.x[l] }
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
            let block = &mut self.blocks[c / LANES];
            block.x[c % LANES] -= x[c % 3];
            block.v[c % LANES] -= v[c % 3];
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
            let (block, l) = self.component(i, axis);
            block.position(l, s, s * h)
        })
    }

    fn velocity(&self, i: usize, s: f64, h: f64) -> Vec3 {
        Vec3::from_fn(|axis, _| {
            let (block, l) = self.component(i, axis);
            block.v[l] + s * h * (block.a0[l] + s * polynomial(&block.b, &V_WEIGHTS, s, l))
        })
    }

    fn component(&self, i: usize, axis: usize) -> (&Block, usize) {
        let c = 3 * i + axis;
        (&self.blocks[c / LANES], c % LANES)
    }

    /// Accelerations at the begin of the step.
    fn begin(&mut self, group: &Group) {
        for (block, x) in self.blocks.iter().zip(self.x.chunks_exact_mut(LANES)) {
            x.copy_from_slice(&block.x);
        }
        forces(group, self.origin, &self.x, &mut self.a);
        for (block, a) in self.blocks.iter_mut().zip(self.a.chunks_exact(LANES)) {
            block.a0.copy_from_slice(a);
        }
    }

    /// The last polynomial, shifted to a step `q` times as long, plus what the last prediction lacked; nothing for `q` = 0.
    #[allow(clippy::needless_range_loop)] // the sums run over triangles of two tables at once
    fn predict(&mut self, q: f64) {
        for block in &mut self.blocks {
            if q == 0.0 {
                (block.b, block.e, block.g) = Default::default();
                continue;
            }
            let mut power = 1.0;
            for k in 0..7 {
                power *= q;
                for l in 0..LANES {
                    let shifted: f64 = (k..7).map(|j| SHIFT[j][k] * block.b_last[j][l]).sum();
                    block.e[k][l] = power * shifted;
                    block.b[k][l] = block.e[k][l] + (block.b_last[k][l] - block.e_last[k][l]);
                }
            }
            for k in 0..7 {
                for l in 0..LANES {
                    block.g[k][l] = (k..7).map(|j| D[j][k] * block.b[j][l]).sum();
                }
            }
        }
    }

    /// Iterates the polynomial of a step of `h` until it stands; returns max|b6|/max|a|.
    fn iterate(&mut self, group: &Group, h: f64) -> f64 {
        let mut last = f64::INFINITY;
        let (mut strongest, mut unsettled) = (0.0, 0.0);
        for iteration in 0..MOST_ITERATIONS {
            let mut change = 0.0;
            for (n, &s) in H.iter().enumerate().skip(1) {
                for (block, x) in self.blocks.iter().zip(self.x.chunks_exact_mut(LANES)) {
                    for (l, x) in x.iter_mut().enumerate() {
                        *x = block.position(l, s, s * h);
                    }
                }
                let origin = self.origin + self.way * (s * h);
                forces(group, origin, &self.x, &mut self.a);
                change = match n {
                    1 => self.correct::<1>(),
                    2 => self.correct::<2>(),
                    3 => self.correct::<3>(),
                    4 => self.correct::<4>(),
                    5 => self.correct::<5>(),
                    6 => self.correct::<6>(),
                    _ => self.correct::<7>(),
                };
            }
            strongest = self.a.iter().fold(0.0, |most, a| larger(most, a.abs()));
            let change = change / strongest;
            // The next change would be smaller by the same factor as this one is.
            let next = if iteration == 0 {
                change
            } else {
                change * (change / last).min(1.0)
            };
            unsettled = change;
            if next < STANDS || iteration > 1 && change >= last || change.is_nan() {
                break;
            }
            last = change;
        }
        let b6 = self.blocks.iter().flat_map(|block| &block.b[6]);
        let b6 = b6.fold(0.0, |most, b| larger(most, b.abs()));
        let error = if strongest > 0.0 { b6 / strongest } else { b6 };
        // What the iteration leaves unsettled at this level is rounding, which no shorter step would cure.
        if unsettled < ROUNDING {
            (error - 10.0 * unsettled).max(0.0)
        } else {
            error
        }
    }

    /// Corrects both forms of the polynomial by the accelerations at spacing N; returns the largest change of g.
    #[allow(clippy::needless_range_loop)] // k counts in tables and lanes at once
    fn correct<const N: usize>(&mut self) -> f64 {
        let mut most = [0.0; LANES];
        for (block, a) in self.blocks.iter_mut().zip(self.a.chunks_exact(LANES)) {
            for l in 0..LANES {
                let mut new = (a[l] - block.a0[l]) * R[N][0];
                for k in 1..N {
                    new = (new - block.g[k - 1][l]) * R[N][k];
                }
                let change = new - block.g[N - 1][l];
                block.g[N - 1][l] = new;
                for k in 0..N {
                    block.b[k][l] += change * C[N - 1][k];
                }
                most[l] = larger(most[l], change.abs());
            }
        }
        most.into_iter().fold(0.0, larger)
    }

    fn finish(&mut self, h: f64) {
        for block in &mut self.blocks {
            for l in 0..LANES {
                let v = block.v[l] + h * (block.a0[l] + polynomial(&block.b, &V_WEIGHTS, 1.0, l));
                block.x[l] = block.position(l, 1.0, h);
                block.v[l] = v;
            }
            (block.b_last, block.e_last) = (block.b, block.e);
        }
    }

    /// The first touch within the step of `h`: where, and who.
    fn touch(&self, group: &Group, h: f64) -> Option<(f64, [usize; 2])> {
        let n = group.bodies.len();
        let mut first: Option<(f64, [usize; 2])> = None;
        for i in 0..n {
            for j in 0..i {
                if !group.can_touch(i, j) {
                    continue;
                }
                let reach = group.bodies[i].radius + group.bodies[j].radius;
                if let Some(fraction) = self.approach([j, i], reach * (1.0 - DEPTH), h)
                    && first.is_none_or(|(earliest, _)| fraction < earliest)
                {
                    first = Some((fraction, [j, i]));
                }
            }
        }
        first
    }

    /// Where in the step of `h` the separation of a pair falls below `reach`.
    fn approach(&self, pair: [usize; 2], reach: f64, h: f64) -> Option<f64> {
        let d = |s: f64| self.position(pair[1], s, h) - self.position(pair[0], s, h);
        let w = |s: f64| self.velocity(pair[1], s, h) - self.velocity(pair[0], s, h);
        let ([d0, w0], [d1, w1]) = ([d(0.0), w(0.0)], [d(1.0), w(1.0)]);
        let far = |d: &Vec3| d.norm() - reach;
        let path = h * w0.norm().max(w1.norm());
        let outwards = d0.dot(&w0) >= 0.0;
        if far(&d0).min(far(&d1)) > path || outwards && far(&d1) > 0.0 {
            return None;
        }
        let mut end = 1.0;
        if far(&d1) > 0.0 {
            if d1.dot(&w1) <= 0.0 {
                return None;
            }
            end = root(|s| d(s).dot(&w(s)), [0.0, 1.0])[1];
            if far(&d(end)) > 0.0 {
                return None;
            }
        }
        if far(&d0) > 0.0 {
            return Some(root(|s| -far(&d(s)), [0.0, end])[1]);
        }
        // Within reach from the begin on, but on their way out then: do they turn back?
        (d1.dot(&w1) < 0.0).then(|| root(|s| -d(s).dot(&w(s)), [0.0, end])[1])
    }
}

impl Block {
    /// Component l at fraction `s` of the step, `t` after its begin.
    #[inline(always)]
    fn position(&self, l: usize, s: f64, t: f64) -> f64 {
        let bend = 0.5 * self.a0[l] + s * polynomial(&self.b, &X_WEIGHTS, s, l);
        self.x[l] + t * (self.v[l] + t * bend)
    }
}

/// The bracket, halved to rounding, at whose begin `f` is negative and at whose end it is not.
fn root(f: impl Fn(f64) -> f64, [mut lo, mut hi]: [f64; 2]) -> [f64; 2] {
    for _ in 0..60 {
        let middle = 0.5 * (lo + hi);
        if f(middle) < 0.0 {
            lo = middle;
        } else {
            hi = middle;
        }
    }
    [lo, hi]
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

/// 1/((k + 2) (k + 3)) and 1/(k + 2): b_k in the double and the single integral.
const X_WEIGHTS: [f64; 7] = weights(true);
const V_WEIGHTS: [f64; 7] = weights(false);

const fn weights(double: bool) -> [f64; 7] {
    let mut weights = [0.0; 7];
    let mut k = 0;
    while k < 7 {
        let n = (k + 2) as f64;
        weights[k] = if double {
            1.0 / (n * (n + 1.0))
        } else {
            1.0 / n
        };
        k += 1;
    }
    weights
}

#[inline(always)]
fn polynomial(b: &[Lane; 7], weights: &[f64; 7], s: f64, l: usize) -> f64 {
    let mut sum = 0.0;
    for k in (0..7).rev() {
        sum = b[k][l] * weights[k] + s * sum;
    }
    sum
}

/// The larger of two, or a NaN.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
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
fn next_step(h: f64, error: f64) -> f64 {
    if !error.is_finite() {
        return 0.1 * SAFETY * h;
    }
    h * error.powf(-1.0 / 7.0).min(1.0 / SAFETY)
}
