//! The clock: one power-of-two hierarchy of time steps for all populations.
//!
//! A base step is cut into 2^30 ticks. Every particle has a step of `span` ticks, a power of two, that began at tick `begin` and ends
//! at tick `end`; it is active when the clock stands at `end`. At the end of a base step everybody is active, the tick count starts
//! anew and the base step may change its length. A woken particle's `end` is moved forward; its `span` stays what was planned, so
//! that impulses given for the planned step can be made up when it ends (Saitoh & Makino 2009; Springel 2010).
//!
//! A pair of particles steps with the shorter of its two steps. The pair opens at the later `begin` of the two and closes when the
//! first of the two is active; at its opening it gets half its planned step as weight, at its closing the rest of the elapsed time.

use super::Vec3;
use super::hill::Phase;

/// A base step may be longer than a wanted step by this part, as far as times between reports are rounded, and still be one such step.
const ROUNDING: f64 = 1e-9;

/// Ticks a base step.
pub const TICKS: u32 = 1 << 30;

/// What limits the steps of all fluids alike: the longest step, and a part of the orbital time 1/Omega about a central mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pacing {
    /// The longest step.
    pub longest: f64,
    /// Where the central mass is.
    pub centre: Vec3,
    /// G times the central mass; zero without one.
    pub gm: f64,
    /// Part of 1/Omega that a step may last.
    pub orbit: f64,
}

impl Pacing {
    /// Steps of at most `longest`, without a central mass.
    pub fn free(longest: f64) -> Self {
        Self {
            longest,
            centre: Vec3::zeros(),
            gm: 0.0,
            orbit: f64::INFINITY,
        }
    }

    /// The pull of the central mass at `x`, which the orbital time already accounts for.
    pub fn central(&self, x: Vec3) -> Vec3 {
        let r = self.centre - x;
        if self.gm > 0.0 {
            r * (self.gm / r.norm().powi(3))
        } else {
            Vec3::zeros()
        }
    }

    /// The longest step at `x`.
    pub fn limit(&self, x: Vec3) -> f64 {
        if self.gm > 0.0 {
            self.longest
                .min(self.orbit * ((x - self.centre).norm().powi(3) / self.gm).sqrt())
        } else {
            self.longest
        }
    }
}

/// A mass about which leapfrog is to keep circular orbits as they are; none if `gm` is zero.
///
/// A kick-drift-kick step dt stays on the circle that begins with the circular velocity if the pull is 2 / (1 + sqrt(1 - s^2)) times as
/// strong, s = Omega dt: without that the orbit is one of eccentricity s^2 / 4, and gas that starts in balance is not. The orbital
/// frequency is (asin s) / s Omega then.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Centre {
    pub x: Vec3,
    /// G times the mass.
    pub gm: f64,
}

impl Centre {
    /// What the pull at `x` lacks for leapfrog steps of `dt`; steps longer than 1 / Omega are taken as that.
    #[inline]
    pub fn lacking(&self, x: Vec3, dt: f64) -> Vec3 {
        if self.gm == 0.0 {
            return Vec3::zeros();
        }
        let r = self.x - x;
        let cube = r.norm().powi(3);
        if cube > 0.0 {
            let pull = self.gm / cube;
            let root = (1.0 - (pull * dt * dt).min(1.0)).sqrt();
            r * (pull * (1.0 - root) / (1.0 + root))
        } else {
            Vec3::zeros()
        }
    }
}

/// The clock of a run, code units of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// Time at the start of the base step.
    pub start: f64,
    /// Time at the end of the base step.
    pub end: f64,
    /// Ticks since the start, 0..=TICKS.
    pub tick: u32,
    /// Base steps done since the start of the run.
    pub step: u64,
}

impl Clock {
    /// A clock that stands at `time` and at the end of a base step of no length: everybody is active.
    pub const fn standing(time: f64) -> Self {
        Self {
            start: time,
            end: time,
            tick: 0,
            step: 0,
        }
    }

    /// Length of a tick.
    pub fn unit(&self) -> f64 {
        (self.end - self.start) / f64::from(TICKS)
    }

    /// The time now.
    pub fn time(&self) -> f64 {
        if self.tick == TICKS {
            self.end
        } else {
            self.start + f64::from(self.tick) * self.unit()
        }
    }

    /// Whether everybody is active now.
    pub fn synchronous(&self) -> bool {
        self.tick == TICKS || self.end == self.start
    }

    /// The clock of the base step that follows: the time to `until` is cut into equal base steps of at most `longest`.
    pub fn next_base(&self, until: f64, longest: f64) -> Self {
        assert!(
            self.synchronous(),
            "a base step begins when everybody is active"
        );
        let left = until - self.end;
        assert!(left > 0.0 && longest > 0.0, "a base step has a length");
        // A hair of slack: dividing an interval into steps that fit it exactly must not yield one more.
        let steps = (left / longest * (1.0 - 1e-12)).ceil().max(1.0);
        let end = if steps < 1.5 {
            until
        } else {
            self.end + left / steps
        };
        Self {
            start: self.end,
            end,
            tick: 0,
            step: self.step + 1,
        }
    }

    /// The longest step of at most `dt`, but for rounding, that may begin now, in ticks; none if it is shorter than a tick.
    ///
    /// It is a power of two and divides the tick that it begins at.
    pub fn span(&self, dt: f64) -> Option<u32> {
        let ticks = dt * (1.0 + ROUNDING) / self.unit();
        if ticks.is_nan() || ticks < 1.0 {
            return None;
        }
        let longest = if ticks >= f64::from(TICKS) {
            TICKS
        } else {
            1 << (ticks as u32).ilog2()
        };
        let aligned = if self.tick == 0 {
            TICKS
        } else {
            1 << self.tick.trailing_zeros()
        };
        Some(longest.min(aligned))
    }

    /// How far a step of `span` ticks is that began at tick `begin`.
    pub fn phase(&self, begin: u32, span: u32) -> Phase {
        let unit = self.unit();
        Phase {
            step: f64::from(span) * unit,
            elapsed: f64::from(self.tick - begin) * unit,
        }
    }

    /// The end of a step that is cut to at most `span` ticks by waking: the next tick after now that a step of `span` may end at.
    pub fn waking(&self, span: u32) -> u32 {
        (self.tick / span + 1) * span
    }
}

/// Weight in ticks with which the force of a pair, taken now, closes the pair's step.
///
/// `begin` is the later of both particles' `begin`, `span` the shorter of both planned spans.
pub fn closing(tick: u32, begin: u32, span: u32) -> f64 {
    f64::from(tick - begin) - 0.5 * f64::from(span)
}

/// Weight in ticks with which the force of a pair, taken now, opens the pair's step; `span` as for [`closing`].
pub fn opening(span: u32) -> f64 {
    0.5 * f64::from(span)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base_steps_end_exactly_on_the_wanted_time() {
        let mut clock = Clock::standing(0.0);
        let mut steps = 0;
        while clock.end < 0.7 {
            clock = clock.next_base(0.7, 0.1);
            clock.tick = TICKS;
            steps += 1;
        }
        assert_eq!(clock.time(), 0.7);
        assert_eq!(steps, 7);
    }

    #[test]
    fn spans_are_aligned_powers_of_two_no_longer_than_wanted() {
        let mut clock = Clock::standing(0.0).next_base(1.0, 1.0);
        assert_eq!(clock.span(2.0), Some(TICKS));
        assert_eq!(clock.span(0.3), Some(TICKS / 4));
        clock.tick = 3 * (TICKS / 8);
        assert_eq!(clock.span(2.0), Some(TICKS / 8));
        assert_eq!(clock.span(1e-12), None);
        assert_eq!(clock.span(f64::NAN), None);
    }

    #[test]
    fn a_base_step_of_the_wanted_length_is_one_step_however_it_is_rounded() {
        let mut clock = Clock::standing(0.0);
        for k in 1..=100 {
            clock = clock.next_base(f64::from(k) * 0.1, 0.1);
            assert_eq!(clock.span(0.1), Some(TICKS), "{k}");
            clock.tick = TICKS;
        }
    }

    #[test]
    fn the_weights_of_a_pair_add_up_to_the_elapsed_time() {
        assert_eq!(opening(64) + closing(64, 0, 64), 64.0);
        // Woken at a quarter of its step.
        assert_eq!(opening(64) + closing(16, 0, 64), 16.0);
    }

    /// Largest change of the distance of a leapfrog orbit of 1000 steps that begins at the circular velocity.
    fn excursion(centre: &Centre, dt: f64) -> f64 {
        let (mut x, mut v) = (Vec3::x(), Vec3::y());
        let mut most: f64 = 0.0;
        for _ in 0..1000 {
            for half in 0..2 {
                v += 0.5 * dt * (-x / x.norm().powi(3) + centre.lacking(x, dt));
                x += if half == 0 { dt * v } else { Vec3::zeros() };
            }
            most = most.max((x.norm() - 1.0).abs()).max((v.norm() - 1.0).abs());
        }
        most
    }

    #[test]
    fn leapfrog_keeps_circular_orbits() {
        let (none, one) = (
            Centre::default(),
            Centre {
                gm: 1.0,
                ..Centre::default()
            },
        );
        for dt in [1e-3, 0.1, 0.9] {
            assert!(
                excursion(&one, dt) < 1e-12,
                "{dt}: {:e}",
                excursion(&one, dt)
            );
        }
        // Twice the eccentricity dt^2 / 4.
        let without = excursion(&none, 0.1);
        assert!((without / 0.005 - 1.0).abs() < 0.1, "{without:e}");
    }

    #[test]
    fn a_woken_step_ends_on_its_own_grid() {
        let mut clock = Clock::standing(0.0).next_base(1.0, 1.0);
        clock.tick = 37;
        assert_eq!(clock.waking(8), 40);
        clock.tick = 40;
        assert_eq!(clock.waking(8), 48);
    }
}
