//! One step of one body: what pulls at its ends, the corrected end, the derivatives there, the length of the next step.
//!
//! Aarseth's time T = sqrt((|a||s| + |j|^2)/(|j||c| + |s|^2)), s and c the second and third derivatives of a, of the centre's and of the
//! others' pull apart: h = min(sqrt(eta_c) T_c, sqrt(eta) T_o (|a|/|a_o|)^(1/4)). The weight gives others their share of the whole error,
//! which goes with h^4. With eta_c = 0.6 eta^(2/3) an orbit's energy errs by 1e-6, 5e-8, 8e-11 for eta = 4e-2, 1e-2, 6e-4 at e = 0.1, within the
//! fourth order's by factors of 300 to 100 at 0.6 to 0.3 of its cost (`examples/blocks.rs`).
//! Source: Aarseth (1985); Nitadori & Makino (2008), eqs. 8 to 11.

use super::Field;
use crate::points::{Vec3, length};

/// eta_c of eta^(2/3).
const CENTRE: f64 = 0.6;
/// Most of T_o that a step takes however small the share of the others: nobody comes near unseen.
const FARTHEST: f64 = 0.3;
/// Share of the whole that others are not seen below: the derivatives of what fades away at a cut-off are rounding.
const NOTHING: f64 = 1e-13;

/// Pulls at an end of a step.
#[derive(Clone, Copy, Debug, Default)]
pub struct End {
    /// Acceleration, jerk and snap by the centre.
    centre: [Vec3; 3],
    /// Acceleration and jerk by all others.
    others: [Vec3; 2],
}

/// Second and third derivatives of the accelerations.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rates {
    centre: [Vec3; 2],
    others: [Vec3; 2],
}

impl Rates {
    pub fn snap(&self) -> Vec3 {
        self.centre[0] + self.others[0]
    }

    pub fn crackle(&self) -> Vec3 {
        self.centre[1] + self.others[1]
    }
}

impl End {
    /// Pulls on body `i`.
    #[inline]
    pub fn of<F: Field>(
        field: &F,
        i: usize,
        (x, v): (&[Vec3], &[Vec3]),
        common: &F::Common,
    ) -> Self {
        let others = field.pull(i, x, v, common);
        Self {
            centre: centre(field.centre(i), x[i], v[i], others[0]),
            others,
        }
    }

    pub fn a(&self) -> Vec3 {
        self.centre[0] + self.others[0]
    }

    pub fn j(&self) -> Vec3 {
        self.centre[1] + self.others[1]
    }

    /// Place and velocity at this end of a step of `h` that began with `begin` at `x`, `v`.
    #[inline]
    pub fn corrected(&self, begin: &Self, (x, v): (Vec3, Vec3), h: f64) -> (Vec3, Vec3) {
        let ([a0, j0, s0], [a1, j1, s1]) = (begin.centre, self.centre);
        let ([b0, k0], [b1, k1]) = (begin.others, self.others);
        let (tenth, twelfth) = (h * h / 10.0, h * h / 12.0);
        let cube = h * h * h / 120.0;
        let end = v
            + (begin.a() + self.a()) * (0.5 * h)
            + (j0 - j1) * tenth
            + (k0 - k1) * twelfth
            + (s0 + s1) * cube;
        let place =
            x + (v + end) * (0.5 * h) + (a0 - a1) * tenth + (b0 - b1) * twelfth + (j0 + j1) * cube;
        (place, end)
    }

    /// Derivatives at this end of the polynomials through both ends.
    pub fn rates(&self, begin: &Self, h: f64) -> Rates {
        let ([a0, j0, s0], [a1, j1, s1]) = (begin.centre, self.centre);
        let ([b0, k0], [b1, k1]) = (begin.others, self.others);
        let (square, cube) = (1.0 / (h * h), 1.0 / (h * h * h));
        let crackle = ((b0 - b1) * 12.0 + (k0 + k1) * (6.0 * h)) * cube;
        let snap = ((b1 - b0) * 6.0 - (k0 * 4.0 + k1 * 2.0) * h) * square + crackle * h;
        let c1 = ((a1 - a0) * 60.0 - (j0 * 24.0 + j1 * 36.0) * h + (s1 * 9.0 - s0 * 3.0) * (h * h))
            * cube;
        Rates {
            centre: [s1, c1],
            others: [snap, crackle],
        }
    }

    /// The longest step from this end, where the derivatives are `rates`.
    pub fn step(&self, rates: &Rates, eta: f64) -> f64 {
        let [a, j, _] = self.centre;
        let by_centre = time([a, j, rates.centre[0], rates.centre[1]]);
        let of_centre = (CENTRE * eta.cbrt() * eta.cbrt()).sqrt() * by_centre;
        let [b, k] = self.others;
        if b.norm() <= NOTHING * self.a().norm() {
            return of_centre;
        }
        let by_others = time([b, k, rates.others[0], rates.others[1]]);
        let weight = (self.a().norm() / b.norm()).sqrt().sqrt();
        let of_others = (eta.sqrt() * weight).min(FARTHEST.max(eta.sqrt())) * by_others;
        // A step that is no number is to be found out.
        if of_centre < of_others {
            of_centre
        } else {
            of_others
        }
    }
}

/// Aarseth's time; infinite for what does not change.
fn time(derivatives: [Vec3; 4]) -> f64 {
    // The squares of the higher ones leave the range of numbers first.
    let [a, j, s, c] = derivatives.map(length);
    let slow = j * c + s * s;
    if slow == 0.0 {
        f64::INFINITY
    } else {
        ((a * s + j * j) / slow).sqrt()
    }
}

/// The shorter of two times, without those that are zero or no number.
pub fn shorter(shortest: f64, time: f64) -> f64 {
    if time > 0.0 {
        shortest.min(time)
    } else {
        shortest
    }
}

/// Acceleration, jerk and snap by a centre on a body that is pulled by `others` too.
#[inline]
fn centre([mu, eps2]: [f64; 2], x: Vec3, v: Vec3, others: Vec3) -> [Vec3; 3] {
    let q2 = x.norm_squared() + eps2;
    if mu == 0.0 || q2 == 0.0 {
        return [Vec3::zeros(); 3];
    }
    let inverse = 1.0 / q2;
    let cube = -mu * inverse * inverse.sqrt();
    let alpha = x.dot(&v) * inverse;
    let a = x * cube;
    let j = v * cube - a * (3.0 * alpha);
    let whole = a + others;
    let beta = (v.norm_squared() + x.dot(&whole)) * inverse + alpha * alpha;
    [a, j, whole * cube - j * (6.0 * alpha) - a * (3.0 * beta)]
}
