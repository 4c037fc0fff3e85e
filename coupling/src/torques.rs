//! Torques: what each population does to each planet, by gravity and by drag.
//!
//! F = sum_j G m_p m_j r_jp / (r^2 + eps^2)^(3/2) over a population, with the softening of the run's own forces; all of it acts at the planet's place, so
//! its torque about the star is r x F and its power v . F, r and v relative to the star. "Outside": without what is within the
//! planet's Hill radius r (m_p / 3 M)^(1/3), where gas that is bound to the planet would be counted as pulling it (Crida et al. 2009, A&A 502, 679).
//! The indirect torque, by the star's own acceleration, is in none of them. Drag is the mean over the time since the last report.

use nbody::Kind;
use nbody::points::{Vec3, sum};

use crate::System;
use crate::gravity::{Heavy, Plan, heavies};

/// What a source does to a planet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torque {
    /// The planet's identity.
    pub id: u64,
    /// "gas", "dust", "planetesimals" or "planets" by their gravity, or "drag".
    pub source: &'static str,
    pub force: Vec3,
    /// The force of what is beyond the planet's Hill radius.
    pub outside: Vec3,
}

/// The forces of one population on a planet.
#[derive(Clone, Copy, Debug, Default)]
struct Pull {
    all: Vec3,
    outside: Vec3,
}

impl std::ops::Add for Pull {
    type Output = Self;

    fn add(self, o: Self) -> Self {
        Self {
            all: self.all + o.all,
            outside: self.outside + o.outside,
        }
    }
}

/// The places, masses and softening lengths of those that pull.
struct Source<'a> {
    name: &'static str,
    x: &'a [Vec3],
    m: &'a [f64],
    softening: Box<dyn Fn(usize) -> f64 + Sync + 'a>,
    /// Which of them belong to it.
    counts: Box<dyn Fn(usize) -> bool + Sync + 'a>,
}

impl Source<'_> {
    /// The force on `planet`, whose Hill radius is `hill`, for G = 1.
    fn pull(&self, planet: &Heavy, hill: f64) -> Pull {
        sum::ordered(self.x.len(), Pull::default(), |range| {
            range
                .filter(|&j| self.counts(j))
                .fold(Pull::default(), |sum, j| {
                    // What the planet does to the other, turned around.
                    let force = -self.m[j] * planet.pull(self.x[j], (self.softening)(j)).0;
                    let far = (self.x[j] - planet.x).norm_squared() > hill * hill;
                    sum + Pull {
                        all: force,
                        outside: if far { force } else { Vec3::zeros() },
                    }
                })
        })
    }

    fn counts(&self, j: usize) -> bool {
        (self.counts)(j)
    }
}

/// The populations of `system` that pull planets by `plan`.
fn sources<'a>(system: &'a System, plan: &'a Plan) -> Vec<Source<'a>> {
    const PLANETS: usize = 3;
    let (gas, dust) = (&system.gas.particles, &system.dust.particles);
    let bodies = &system.bodies;
    let x = system.seen.places(&bodies.x);
    let planet = |j: usize| bodies.kind[j] == Kind::Planet as u32;
    let all = [
        Source {
            name: "gas",
            x: &gas.x,
            m: &gas.m,
            softening: Box::new(|j| plan.gas.of(gas.h[j])),
            counts: Box::new(|_| true),
        },
        Source {
            name: "dust",
            x: &dust.x,
            m: &dust.m,
            softening: Box::new(|j| plan.dust.of(dust.h[j])),
            counts: Box::new(|_| true),
        },
        Source {
            name: "planetesimals",
            x,
            m: &bodies.m,
            softening: Box::new(|j| bodies.softening[j]),
            counts: Box::new(move |j| !planet(j)),
        },
        Source {
            name: "planets",
            x,
            m: &bodies.m,
            softening: Box::new(|j| bodies.softening[j]),
            counts: Box::new(planet),
        },
    ];
    let pulls = |k: usize, source: &Source| {
        plan.pulls[k][PLANETS] && (0..source.x.len()).any(|j| source.counts(j))
    };
    let numbered = all.into_iter().enumerate();
    numbered
        .filter(|(k, source)| pulls(*k, source))
        .map(|(_, source)| source)
        .collect()
}

/// The pulls of all populations on all planets of `system`, where they are now.
pub(crate) fn pulls(system: &mut System, plan: &Plan) -> Vec<Torque> {
    let heavies = heavies(system);
    let planets = heavies.iter().filter(|heavy| !heavy.star);
    let sources = sources(system, plan);
    let star = heavies.iter().find(|heavy| heavy.star);
    let several = planets.clone().count() > 1;
    let mut found = Vec::new();
    for planet in planets {
        let hill = star.map_or(0.0, |star| {
            (planet.x - star.x).norm() * (planet.m / (3.0 * star.m)).cbrt()
        });
        for source in &sources {
            if source.name == "planets" && !several {
                continue;
            }
            let pull = source.pull(planet, hill);
            found.push(Torque {
                id: system.bodies.id[planet.place],
                source: source.name,
                force: system.g * pull.all,
                outside: system.g * pull.outside,
            });
        }
    }
    drop(sources);
    system.heavies = heavies;
    found
}

/// What drag has given to planets since the last report.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Braked {
    /// When the last report was.
    pub since: f64,
    /// Impulses, by the planets' identities.
    pub impulses: Vec<(u64, Vec3)>,
}

impl Braked {
    /// Adds an impulse on the planet `id`.
    pub(crate) fn add(&mut self, id: u64, impulse: Vec3) {
        match self.impulses.iter_mut().find(|(known, _)| *known == id) {
            Some((_, sum)) => *sum += impulse,
            None => self.impulses.push((id, impulse)),
        }
    }

    /// The mean forces until `time`, from which on it counts anew. None of those that no time has passed for.
    pub fn settle(&mut self, time: f64) -> Vec<Torque> {
        let span = time - self.since;
        self.since = time;
        let impulses = self.impulses.drain(..);
        impulses
            .filter(|_| span > 0.0)
            .map(|(id, impulse)| Torque {
                id,
                source: "drag",
                force: impulse / span,
                outside: impulse / span,
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use nbody::points::{Columns, Domain};

    use super::*;
    use crate::gravity::{ALL_PULL, Mutual, Softening};

    #[test]
    fn gas_ahead_pulls_ahead_and_what_is_within_the_hill_radius_is_told_apart() {
        let mut system = System::new(Domain::open(), 2.0, 0.0);
        for (bodies, x, m, kind) in [
            (&mut system.star, Vec3::zeros(), 1.0, Kind::Star),
            (&mut system.bodies, Vec3::x(), 3e-3, Kind::Planet),
        ] {
            bodies.resize(1);
            (bodies.x[0], bodies.m[0], bodies.kind[0]) = (x, m, kind as u32);
        }
        system.bodies.id[0] = 7;
        let gas = &mut system.gas.particles;
        gas.resize(2);
        // The Hill radius is a tenth: one is within, one beyond.
        (gas.x[0], gas.m[0]) = (Vec3::new(1.0, 0.05, 0.0), 1e-6);
        (gas.x[1], gas.m[1]) = (Vec3::new(1.0, 0.2, 0.0), 4e-6);
        gas.h.fill(0.1);
        system.look();
        let plan = Plan {
            tree: None,
            pulls: ALL_PULL,
            gas: Softening::Adaptive(0.5),
            dust: Softening::Length(0.0),
            star_in_kick: false,
            mutual: Mutual::Kick,
            held_back: false,
            field_steps: false,
        };
        let found = pulls(&mut system, &plan);
        assert_eq!(found.len(), 1);
        let soft = |d: f64| d / (d * d + 0.05f64.powi(2)).powf(1.5);
        let (near, far) = (6e-9 * soft(0.05), 24e-9 * soft(0.2));
        let Torque {
            id,
            source,
            force,
            outside,
        } = found[0];
        assert_eq!((id, source), (7, "gas"));
        assert!((force.y / (near + far) - 1.0).abs() < 1e-12, "{force}");
        assert!((outside.y / far - 1.0).abs() < 1e-12, "{outside}");
        assert!(force.xz().norm() < 1e-25);
    }

    #[test]
    fn the_mean_force_of_drag_is_its_impulse_by_the_time_since_the_last_report() {
        let mut braked = Braked::default();
        braked.add(3, Vec3::x());
        braked.add(3, Vec3::y());
        let [first] = braked.settle(4.0)[..] else {
            panic!("one planet");
        };
        assert_eq!((first.id, first.force), (3, Vec3::new(0.25, 0.25, 0.0)));
        assert!(braked.settle(5.0).is_empty());
    }
}
