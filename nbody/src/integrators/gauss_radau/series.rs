//! The series of a Gauss-Radau step: accelerations as polynomials of the part s of the step done, four components abreast.
//!
//! a(s) = a0 + b0 s + ... + b6 s^7; x(s) = x + t (v + t (a0/2 + b0 s/6 + ... + b6 s^7/72)), t = s dt. The b are iterated over the seven
//! spacings of a step through Newton's form of the polynomial (its coefficients g); they start from the last step's, shifted, plus what
//! that prediction had lacked (e). Both integrators that take such steps, of the whole and of a group, use these.
//! Source: Everhart (1985); Rein & Spiegel (2015).

use super::spacings::{C, D, H, R, SHIFT};

pub const LANES: usize = 4;
/// The compiler puts these into registers.
pub type Lane = [f64; LANES];

/// The polynomials of four components.
#[derive(Clone, Copy, Debug, Default)]
pub struct Series {
    /// Acceleration at the begin of the step.
    pub a0: Lane,
    pub b: [Lane; 7],
    g: [Lane; 7],
    /// What was predicted for b, and b of the last step with its prediction.
    e: [Lane; 7],
    pub b_last: [Lane; 7],
    pub e_last: [Lane; 7],
}

/// A step is repeated if the next one is this much shorter, and never grows by more than its inverse.
pub const SAFETY: f64 = 0.25;
const MOST_ITERATIONS: usize = 12;

/// When an iteration ends, besides where its changes grow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Halt {
    /// With a change that is rounding.
    Settled,
    /// If the next change would be rounding, smaller by the same factor as this one is.
    Foreseen,
}

/// What an iteration leaves.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// max|b6|/max|a|
    pub error: f64,
    /// The last change of g over max|a|.
    pub change: f64,
}

impl Series {
    /// The last polynomial, shifted to a step `q` times as long, plus what the last prediction lacked; nothing for `q` = 0.
    #[allow(clippy::needless_range_loop)] // the sums run over triangles of two tables at once
    pub fn predict(&mut self, q: f64) {
        if q == 0.0 {
            (self.b, self.e, self.g) = Default::default();
            return;
        }
        let mut power = 1.0;
        for k in 0..7 {
            power *= q;
            for l in 0..LANES {
                let shifted: f64 = (k..7).map(|j| SHIFT[j][k] * self.b_last[j][l]).sum();
                self.e[k][l] = power * shifted;
                self.b[k][l] = self.e[k][l] + (self.b_last[k][l] - self.e_last[k][l]);
            }
        }
        for k in 0..7 {
            for l in 0..LANES {
                self.g[k][l] = (k..7).map(|j| D[j][k] * self.b[j][l]).sum();
            }
        }
    }

    /// Corrects both forms of the polynomial by the accelerations at spacing N; returns the largest changes of g.
    #[allow(clippy::needless_range_loop)] // k counts in tables and lanes at once
    #[inline(always)]
    fn correct<const N: usize>(&mut self, a: &[f64], most: &mut Lane) {
        for l in 0..LANES {
            let mut new = (a[l] - self.a0[l]) * R[N][0];
            for k in 1..N {
                new = (new - self.g[k - 1][l]) * R[N][k];
            }
            let change = new - self.g[N - 1][l];
            self.g[N - 1][l] = new;
            for k in 0..N {
                self.b[k][l] += change * C[N - 1][k];
            }
            most[l] = larger(most[l], change.abs());
        }
    }

    /// Makes this step's polynomial the last one.
    pub fn keep(&mut self) {
        (self.b_last, self.e_last) = (self.b, self.e);
    }

    /// The polynomial's part in the double integral of component l at `s`, over s t^2.
    #[inline(always)]
    pub fn bend(&self, l: usize, s: f64) -> f64 {
        polynomial(&self.b, &X_WEIGHTS, s, l)
    }

    /// The polynomial's part in the single integral of component l at `s`, over s t.
    #[inline(always)]
    pub fn gain(&self, l: usize, s: f64) -> f64 {
        polynomial(&self.b, &V_WEIGHTS, s, l)
    }
}

/// Iterates the polynomials until they stand. `pull` is told how far the step is done and writes the accelerations, one a component.
pub fn iterate(
    series: &mut [Series],
    a: &mut [f64],
    halt: Halt,
    mut pull: impl FnMut(&[Series], f64, &mut [f64]),
) -> Outcome {
    let mut last = f64::INFINITY;
    let (mut strongest, mut change) = (0.0, f64::INFINITY);
    for iteration in 0..MOST_ITERATIONS {
        for (n, &h) in H.iter().enumerate().skip(1) {
            pull(series, h, a);
            change = match n {
                1 => correct::<1>(series, a),
                2 => correct::<2>(series, a),
                3 => correct::<3>(series, a),
                4 => correct::<4>(series, a),
                5 => correct::<5>(series, a),
                6 => correct::<6>(series, a),
                _ => correct::<7>(series, a),
            };
        }
        strongest = a.iter().fold(0.0, |most, a| larger(most, a.abs()));
        change /= strongest;
        let stands = match halt {
            Halt::Settled => change < 1e-16,
            Halt::Foreseen if iteration == 0 => change < 1e-15,
            Halt::Foreseen => change * (change / last).min(1.0) < 1e-15,
        };
        // Twice the same or more: rounding is all that is left.
        if stands || iteration > 1 && change >= last || change.is_nan() {
            break;
        }
        last = change;
    }
    let b6 = series.iter().flat_map(|series| &series.b[6]);
    let b6 = b6.fold(0.0, |most, b| larger(most, b.abs()));
    let error = if strongest > 0.0 { b6 / strongest } else { b6 };
    Outcome { error, change }
}

/// Corrects all by the accelerations at spacing N; returns the largest change of g.
fn correct<const N: usize>(series: &mut [Series], a: &[f64]) -> f64 {
    let mut most = [0.0; LANES];
    for (series, a) in series.iter_mut().zip(a.chunks_exact(LANES)) {
        series.correct::<N>(a, &mut most);
    }
    most.into_iter().fold(0.0, larger)
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
pub fn larger(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

/// The step of about `wanted` that leaves no crumb before the end.
pub fn cut(wanted: f64, left: f64) -> f64 {
    if left <= wanted {
        left
    } else if left < 2.0 * wanted {
        0.5 * left
    } else {
        wanted
    }
}

/// The step that would make the error, given in units of the one allowed, one.
pub fn next_step(dt: f64, error: f64) -> f64 {
    if !error.is_finite() {
        return 0.1 * SAFETY * dt;
    }
    dt * error.powf(-1.0 / 7.0).min(1.0 / SAFETY)
}
