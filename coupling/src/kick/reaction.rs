//! What star and planets receive of the pulls that they exert on gas and dust, and the net effect that a kick leaves over.

use nbody::points::clock::Centre;
use nbody::points::{Vec3, sum};

use crate::System;
use crate::gravity::{Heavy, Softening};
use crate::system::Stray;

/// What star and planets receive of the pulls that they exert on gas and dust.
#[derive(Clone, Copy, Debug)]
pub struct Reaction {
    /// Whether the star pulls the fluid.
    pub pulled: bool,
    /// Whether the fluid pulls star, and planets.
    pub on: [bool; 2],
    pub softening: Softening,
}

/// The weight in time of a kick, and the step that it is part of.
pub(super) struct Weight {
    pub time: f64,
    pub step: f64,
}

impl Weight {
    /// Of the kick that closes a step.
    pub(super) fn closing(system: &System, begin: u32, span: u32) -> Self {
        Self {
            time: system.closing(begin, span),
            step: f64::from(span) * system.clock.unit(),
        }
    }

    /// Of the kick that opens a step.
    pub(super) fn opening(system: &System, span: u32) -> Self {
        Self {
            time: system.opening(span),
            step: f64::from(span) * system.next.unit(),
        }
    }
}

/// The particles that react, with the weight in time of their kick now.
pub(super) struct Kicked<'a> {
    pub x: &'a [Vec3],
    pub m: &'a [f64],
    pub h: &'a [f64],
    pub gravity: &'a [Vec3],
    /// Places of those that are kicked.
    pub active: &'a [u32],
}

impl Kicked<'_> {
    /// Net impulse and torque of the pulls `pull(i)`, each with its weight in time, on those that are kicked.
    pub(super) fn stray(&self, pull: impl Fn(usize) -> (Vec3, f64) + Sync) -> Stray {
        sum::ordered(self.active.len(), Stray::default(), |range| {
            (self.active[range].iter()).fold(Stray::default(), |sum, &i| {
                let i = i as usize;
                let (pull, weight) = pull(i);
                sum + Stray::at(self.x[i], pull * (self.m[i] * weight))
            })
        })
    }
}

impl Reaction {
    /// The star, if it pulls the fluid.
    pub(super) fn centre(self, system: &System) -> Centre {
        match system.seen.star_x.first() {
            Some(&x) if self.pulled => Centre {
                x,
                gm: system.g * system.star.m[0],
            },
            _ => Centre::default(),
        }
    }

    /// What star and planets receive that balances their pulls on `kicked`, in steps of `pace(i)`.
    pub(super) fn act(
        self,
        (g, heavies, mut received): (f64, &[Heavy], Vec<Vec3>),
        centre: &Centre,
        kicked: &Kicked,
        pace: impl Fn(usize) -> Weight + Sync,
    ) -> Given {
        let active = kicked.active;
        let lacking = |i: usize, dt: f64| centre.lacking(kicked.x[i], dt);
        received.clear();
        received.extend(heavies.iter().map(|heavy| {
            if !self.on[usize::from(!heavy.star)] {
                return Vec3::zeros();
            }
            sum::ordered(active.len(), Vec3::zeros(), |range| {
                active[range].iter().fold(Vec3::zeros(), |sum, &i| {
                    let (i, Weight { time, step }) = (i as usize, pace(i as usize));
                    let mut pull = g * heavy.pull(kicked.x[i], self.softening.of(kicked.h[i])).0;
                    if heavy.star {
                        pull += lacking(i, step);
                    }
                    sum - pull * (kicked.m[i] * time)
                })
            })
        }));
        // Without gravity there is nothing to react to.
        let given = if kicked.gravity.is_empty() {
            Stray::default()
        } else {
            kicked.stray(|i| {
                let Weight { time, step } = pace(i);
                (kicked.gravity[i] + lacking(i, step), time)
            })
        };
        let stray = (heavies.iter().zip(&received))
            .fold(given, |sum, (heavy, &back)| sum + Stray::at(heavy.x, back));
        Given { received, stray }
    }
}

/// What a kick gives to star and planets, one by one, and what is left over: the net effect of the tree's field.
pub(super) struct Given {
    pub received: Vec<Vec3>,
    pub stray: Stray,
}

pub(super) fn receive(system: &mut System, heavies: Vec<Heavy>, Given { received, stray }: Given) {
    system.stray = system.stray + stray;
    for (heavy, &impulse) in heavies.iter().zip(&received) {
        let pending = if heavy.star {
            &mut system.pending_star
        } else {
            &mut system.pending_bodies
        };
        pending[heavy.place] += impulse;
    }
    (system.heavies, system.given) = (heavies, received);
    if system.bodies_active() {
        system.settle_impulses();
        system.look();
    }
}
