//! The motion of superparticles: kicks by gravity at both ends of a step, straight drifts between.
//!
//! Step: dt = min( C sqrt(h / |g - g_star|), C_c h / (c + |u|), D / Omega ), with h and c the smoothing length and sound speed of the gas around,
//! u the velocity relative to it (absent without gas), and Omega the orbital frequency about the star: the gas's own criteria, so that
//! grains and gas make the same errors of integration and drift apart by drag alone. The stopping time has no part in it.

use nbody::points::clock::{Centre, Pacing};
use nbody::points::{Clock, Domain, Fault, Population, Vec3, clock};
use rayon::prelude::*;

use crate::Dust;

/// What part of a grain's times in the gas around a step may last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parts {
    /// Of the time in which gravity, but for the star's, moves it by a smoothing length.
    pub force: f64,
    /// Of the time in which sound and its own motion cross a smoothing length.
    pub courant: f64,
}

impl Dust {
    /// Chooses the steps that begin now.
    pub fn steps(
        &mut self,
        pacing: &Pacing,
        parts: Parts,
        now: &Clock,
        next: &Clock,
    ) -> Result<(), Fault> {
        let particles = &self.particles;
        let (gravity, crossing) = (&self.rates.gravity, &self.derived.crossing);
        let refused = self
            .rates
            .next_span
            .par_iter_mut()
            .enumerate()
            .with_min_len(nbody::points::sum::CHUNK)
            .filter_map(|(i, next_span)| {
                if !(now.synchronous() || particles.end[i] == now.tick) {
                    return None;
                }
                let (x, h) = (particles.x[i], particles.h[i]);
                let pull = (gravity[i] - pacing.central(x)).norm();
                let near = if h > 0.0 {
                    let pulled = parts.force * (h / pull).sqrt();
                    // Without drag nobody looks for the gas around.
                    match crossing[i] {
                        0.0 => pulled,
                        crossed => pulled.min(parts.courant * crossed),
                    }
                } else {
                    f64::INFINITY
                };
                let dt = near.min(pacing.limit(x));
                match next.span(dt) {
                    Some(span) => {
                        *next_span = span;
                        None
                    }
                    None => Some((i, dt)),
                }
            })
            .min_by_key(|&(i, _)| i);
        match refused {
            None => Ok(()),
            Some((i, step)) => Err(Fault::StepTooSmall {
                population: Population::Dust,
                id: self.particles.id[i],
                step,
                shortest: next.unit(),
                time: now.time(),
            }),
        }
    }

    /// The kick that closes the steps that end now; `centre` is the star, if it pulls the dust. Returns the momentum that the frame of a
    /// shearing box gave, and what pulls in it.
    pub fn close(&mut self, now: &Clock, centre: &Centre, domain: &Domain) -> Vec3 {
        let (p, mut gained) = (&mut self.particles, Vec3::zeros());
        for i in 0..p.x.len() {
            if now.synchronous() || p.end[i] == now.tick {
                let dt = f64::from(p.span[i]) * now.unit();
                let pull = self.rates.gravity[i] + centre.lacking(p.x[i], dt);
                let before = p.v[i];
                if let Some(hill) = domain.hill() {
                    p.v[i] = hill.seen(p.x[i], before, now.phase(p.begin[i], p.span[i]));
                }
                p.v[i] += pull * (clock::closing(now.tick, p.begin[i], p.span[i]) * now.unit());
                self.rates.v_pred[i] = p.v[i];
                if domain.hill().is_some() {
                    gained += p.m[i] * (p.v[i] - before);
                }
            }
        }
        gained
    }

    /// The kick that opens the steps that begin now; `centre` as in [`Dust::close`].
    pub fn open(&mut self, now: &Clock, next: &Clock, centre: &Centre, domain: &Domain) -> Vec3 {
        let (p, mut gained) = (&mut self.particles, Vec3::zeros());
        for i in 0..p.x.len() {
            if now.synchronous() || p.end[i] == now.tick {
                let span = self.rates.next_span[i];
                let dt = f64::from(span) * next.unit();
                let pull = self.rates.gravity[i] + centre.lacking(p.x[i], dt);
                let before = p.v[i];
                p.v[i] += pull * (clock::opening(span) * next.unit());
                if let Some(hill) = domain.hill() {
                    p.v[i] = hill.opened(p.x[i], p.v[i], dt);
                    gained += p.m[i] * (p.v[i] - before);
                }
                (p.begin[i], p.span[i], p.end[i]) = (next.tick, span, next.tick + span);
            }
        }
        gained
    }

    /// Moves everybody over `dt`; out of a shearing box until [`Dust::refit`] brings them back.
    pub fn drift(&mut self, dt: f64, domain: &Domain) {
        let frame = domain.hill().map(|hill| (hill, hill.turn(dt)));
        let v = &self.particles.v;
        let gravity = &self.rates.gravity;
        self.particles
            .x
            .par_iter_mut()
            .zip(&mut self.rates.v_pred)
            .enumerate()
            .with_min_len(nbody::points::sum::CHUNK)
            .for_each(|(i, (x, v_pred))| {
                let relative = domain.relative(*x, *v_pred);
                *x += domain.in_plane(v[i]) * dt;
                if let Some((hill, turn)) = frame {
                    *v_pred = turn.of(relative) + Vec3::y() * hill.stream(*x);
                } else {
                    domain.wrap(x);
                }
                *v_pred += gravity[i] * dt;
            });
    }
}

#[cfg(test)]
mod tests {
    use nbody::points::Columns;

    use super::*;
    use crate::Superparticles;

    /// A grain from `x` with the velocity `v` across, after a period about a unit mass, by steps of at most `orbit` / Omega; calls `see` at each.
    fn grain((x, v): (f64, f64), orbit: f64, mut see: impl FnMut(Vec3)) -> Vec3 {
        let mut p = Superparticles::default();
        p.resize(1);
        p.x[0] = Vec3::new(x, 0.0, 0.0);
        p.v[0] = Vec3::new(0.0, v, 0.0);
        let mut dust = Dust::new(p);
        let pacing = Pacing {
            longest: f64::INFINITY,
            centre: Vec3::zeros(),
            gm: 1.0,
            orbit,
        };
        let centre = Centre {
            gm: 1.0,
            ..Centre::default()
        };
        let mut now = Clock::standing(0.0);
        let period = std::f64::consts::TAU;
        loop {
            let x = dust.particles.x[0];
            dust.rates.gravity[0] = -x / x.norm().powi(3);
            see(x);
            if now.synchronous() && now.end >= period {
                dust.close(&now, &centre, &Domain::open());
                return x;
            }
            let next = if now.synchronous() {
                now.next_base(period, orbit)
            } else {
                now
            };
            let parts = Parts {
                force: 0.25,
                courant: 0.25,
            };
            dust.steps(&pacing, parts, &now, &next).expect("a step");
            dust.close(&now, &centre, &Domain::open());
            dust.open(&now, &next, &centre, &Domain::open());
            now = next;
            let tick = dust.particles.end[0];
            dust.drift(f64::from(tick - now.tick) * now.unit(), &Domain::open());
            now.tick = tick;
        }
    }

    #[test]
    fn an_orbit_converges_with_the_square_of_the_step() {
        let start = (0.7, (1.3f64 / 0.7).sqrt());
        let error = |orbit: f64| (grain(start, orbit, |_| ()) - Vec3::new(0.7, 0.0, 0.0)).norm();
        let (coarse, fine) = (error(0.02), error(0.01));
        let order = (coarse / fine).log2();
        assert!(
            (order - 2.0).abs() < 0.2,
            "order {order} from errors {coarse} and {fine}"
        );
    }

    #[test]
    fn a_circular_orbit_stays_one_at_any_step() {
        for orbit in [0.01, 0.3] {
            let mut most: f64 = 0.0;
            grain((1.0, 1.0), orbit, |x| {
                most = most.max((x.norm() - 1.0).abs());
            });
            assert!(most < 1e-13, "{most:e}");
        }
    }
}
