//! Touches within a step: where the separation of a pair on the step's own polynomials first falls below the sum of their radii.

use super::Radau;
use crate::integrators::hybrid::group::Group;
use crate::points::Vec3;

/// Bodies are bound this little within their contact, so that it is one for everybody.
const DEPTH: f64 = 1e-9;

impl Radau {
    /// The first touch within the step of `h`: where, and who.
    pub(super) fn touch(&self, group: &Group, h: f64) -> Option<(f64, [usize; 2])> {
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
