//! Kicks: the changes of velocity by gravity, pressure and viscosity, at both ends of a particle's step.
//!
//! Gas is kicked pair by pair by the impulses of its force sweep, and by gravity; dust and bodies by gravity. What star and planets
//! give to gas and dust they receive in turn at once, if they are active, or at their next tick.

use nbody::points::clock::Pacing;
use nbody::points::{Clock, Fault};

use crate::System;

mod bodies;
mod dust;
mod gas;
mod reaction;

pub use bodies::KickBodies;
pub use dust::KickDust;
pub use gas::{Density, KickGas};
pub use reaction::Reaction;

/// How long steps of gas and dust may be, whatever the particle's own criteria say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steps {
    pub longest: f64,
    /// Part of 1/Omega about the star, or of the frame.
    pub orbit: f64,
}

impl Steps {
    fn of(self, system: &System) -> Pacing {
        match system.seen.star_x.first() {
            Some(&centre) => Pacing {
                longest: self.longest,
                centre,
                gm: system.g * system.star.m[0],
                orbit: self.orbit,
            },
            None => {
                let rate = system.domain.hill().map_or(0.0, |hill| hill.rate);
                Pacing::free(self.longest.min(self.orbit / rate))
            }
        }
    }
}

/// The span in ticks of a bodies' step of at most `step`.
pub(crate) fn span(next: &Clock, step: f64) -> Result<u32, Fault> {
    next.span(step).ok_or(Fault::StepTooSmall {
        population: nbody::points::Population::Planetesimals,
        id: 0,
        step,
        shortest: next.unit(),
        time: next.time(),
    })
}

#[cfg(test)]
mod tests {
    use nbody::points::clock::TICKS;

    use super::*;

    /// Bodies' steps in a hundred base steps that end at multiples of `step`.
    fn spans(step: f64) -> Vec<u32> {
        let mut clock = Clock::standing(0.0);
        (1..=100)
            .map(|k| {
                clock = clock.next_base(f64::from(k) * step, step);
                let one = span(&clock, step).expect("a step of many ticks");
                clock.tick = TICKS;
                one
            })
            .collect()
    }

    #[test]
    fn a_base_step_of_the_bodies_length_is_one_step_of_theirs_however_it_is_rounded() {
        let step = 0.01 * std::f64::consts::TAU;
        assert_eq!(spans(step), [TICKS; 100]);
        assert_eq!(
            span(&Clock::standing(0.0).next_base(1.0, 1.0), 0.4).expect("a step"),
            TICKS / 4
        );
    }
}
