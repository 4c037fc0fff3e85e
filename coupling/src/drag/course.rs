//! Course: how drag on a grain went over a step, and what that says of the error of the step's splitting.
//!
//! Drag and kick are solved together, so that what a step errs by is its drift: all of it has the velocity of the middle of the step. Where
//! u' = -u/t' + a, t' = t_stop / (1 + eps), that is off the mean velocity by
//!
//! E = f(x) |u - a t'|,   f = (1 - e^-2x)/(2x) - e^-x,   x = h/(2t'):   x^2/6 in short steps, 1/(2x) in long ones, at most 0.117.
//!
//! Drag's impulses in the two halves of such a step differ by (1 - e^-x)^2 |u - a t'|: whatever else makes them differ (forces that change, gas that
//! moves otherwise elsewhere) is taken to make as large an error, f / (1 - e^-x)^2 of the difference. The larger of both counts. Grains that
//! follow the gas keep their steps however short their stopping time. E goes as h^2, distances err by the sum of h E: in proportion
//! to the tolerance and to time.

use nbody::points::Vec3;

use super::row::Row;

/// Below, f is its series: x^2/6 - x^3/6, better than 1e-6.
const FEW: f64 = 1e-3;

/// The part to which a step that errs too much is shortened until it does not.
const SHRINKING: f64 = 0.9;

/// f by x.
fn unevenness(x: f64) -> f64 {
    if x < FEW {
        x * x * (1.0 - x) / 6.0
    } else {
        -(-2.0 * x).exp_m1() / (2.0 * x) - (-x).exp()
    }
}

/// Drag on a grain at the end of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Course {
    /// 1/t'
    rate: f64,
    /// |u - a t'|
    astray: f64,
    /// Change of drag's acceleration of u in a unit of time.
    slope: f64,
    /// Sum of the speeds of sound and grain.
    speed: f64,
}

impl Course {
    /// Of a row whose closing half step of `half` is done, and which drag accelerated by `opening` in the opening half; none without gas.
    pub fn of(row: &Row, opening: Vec3, half: f64) -> Option<Self> {
        let speed = row.h / row.crossing;
        let load = 1.0 + row.eps;
        let rate = load / row.t_stop;
        if !(speed > 0.0 && rate > 0.0 && rate.is_finite()) {
            return None;
        }
        let u = row.u_tick + load * row.dv;
        // Before the first step nothing is known of forces.
        let (a, slope) = if half > 0.0 {
            let kick = 2.0 * (row.u_tick - row.u_middle);
            let change = row.dv / half - opening;
            (kick / half, load * change.norm() / half)
        } else {
            (Vec3::zeros(), 0.0)
        };
        Some(Self {
            rate,
            astray: (u - a / rate).norm(),
            slope,
            speed,
        })
    }

    /// Error of the mean velocity in a step of `h`, by the sum of the speeds of sound and grain.
    pub fn error(&self, h: f64) -> f64 {
        let x = 0.5 * h * self.rate;
        let (f, lost) = (unevenness(x), -(-x).exp_m1());
        let differing = 0.25 * self.slope * h * h;
        let by_impulses = if lost > 0.0 {
            differing * f / (lost * lost)
        } else {
            differing / 6.0
        };
        (f * self.astray).max(by_impulses) / self.speed
    }

    /// The longest step of at most `longest` that errs by no more than `tolerance`; a grain that takes steps of at most `own` anyway allows any that are
    /// longer.
    pub fn allowed(&self, longest: f64, own: f64, tolerance: f64) -> f64 {
        let mut longest = longest;
        while longest > 0.0 && self.error(longest.min(own)) > tolerance {
            longest = longest.min(own) * SHRINKING;
        }
        longest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row at the end of a step of h under u' = -u/t + a + b s, s from the start, whose halves saw the forces of its ends, and the acceleration by drag
    /// in its opening half.
    fn stepped([t, a, b, u]: [f64; 4], h: f64) -> (Row, Vec3) {
        let half = 0.5 * h;
        let x = half / t;
        let impulse = |u: f64, a: f64| (a * t - u) * -(-x).exp_m1() - a * half;
        let opening = impulse(u, a);
        let middle = u + a * half + opening;
        let after = a + b * h;
        let closing = impulse(middle, after);
        let along = |v: f64| Vec3::new(v, 0.0, 0.0);
        let row = Row {
            h: 1.0,
            crossing: 1.0,
            t_stop: t,
            dv: along(closing),
            u_tick: along(middle + after * half),
            u_middle: along(middle + 0.5 * after * half),
            ..Row::default()
        };
        (row, along(opening / half))
    }

    fn course(law: [f64; 4], h: f64) -> Course {
        let (row, opening) = stepped(law, h);
        Course::of(&row, opening, 0.5 * h).expect("gas around")
    }

    #[test]
    fn the_error_is_what_a_drift_by_the_middle_velocity_errs_by() {
        // Relaxation to a t from the end of the step on, for stopping times from much longer to much shorter than the step.
        for t in [100.0, 3.0, 0.5, 0.1, 1e-3] {
            let h = 1.0;
            let (a, u) = (0.3, 2.0);
            let course = course([t, a, 0.0, u], h);
            let left = u - a * t;
            let now = left * (-h / t).exp();
            let middle = now * (-0.5 * h / t).exp();
            let mean = now * t / h * -(-h / t).exp_m1();
            let exact = (middle - mean).abs();
            // The impulses of the step that is over tell of an earlier and larger error.
            let own = unevenness(0.5 * h / t) * course.astray;
            assert!(
                (own - exact).abs() < 1e-6 * exact + 1e-15,
                "{t}: {own:e} of {exact:e}"
            );
            assert!(course.error(h) >= own);
        }
    }

    #[test]
    fn changing_forces_are_seen_within_a_factor_of_two_whether_stiff_or_not() {
        // A grain on u = t (a + b s) - b t^2, whose acceleration by drag changes by -b. Without the lag b t^2 drifts err by b t h/2: half of the
        // change of a t over a step.
        for t in [100.0, 1e-2, 1e-4] {
            let (h, a, b) = (0.1, 0.2, 1.0);
            let course = course([t, a, b, a * t - b * t * t], h);
            let x = 0.5 * h / t;
            let expected = match x < 1.0 {
                true => b * h * h / 24.0,
                false => 0.5 * b * h * t,
            };
            let ratio = course.error(h) / expected;
            assert!((0.5..2.1).contains(&ratio), "{t}: {ratio}");
        }
    }

    #[test]
    fn stiff_grains_that_follow_the_gas_keep_their_steps_and_loose_ones_shorten_them() {
        let follows = course([1e-9, 0.3, 0.5, 0.3e-9], 0.1);
        assert_eq!(follows.allowed(0.1, 1.0, 1e-6), 0.1);
        let loose = course([0.3, 0.0, 0.0, 1.0], 0.1);
        let (most, tolerance) = (loose.error(0.1), 1e-5);
        let step = loose.allowed(0.1, 1.0, tolerance);
        assert!(loose.error(step) <= tolerance && loose.error(step / SHRINKING) > tolerance);
        // Of second order, but for one part in twenty that the ladder of steps leaves open.
        let expected = 0.1 * (tolerance / most).sqrt();
        assert!(
            (0.88..1.02).contains(&(step / expected)),
            "{step} of {expected}"
        );
        // It steps by as little already.
        assert_eq!(loose.allowed(0.1, 0.9 * step, tolerance), 0.1);
    }

    #[test]
    fn series_and_closed_form_meet() {
        let (below, above) = (unevenness(FEW * (1.0 - 1e-9)), unevenness(FEW));
        assert!((below / above - 1.0).abs() < 1e-6);
    }
}
