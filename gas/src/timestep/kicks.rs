//! Kicks of the gas near the active particles, at the ends of steps: leaf by leaf, heat booked in the order of the leaves.

use nbody::points::sum::Parts;
use nbody::points::{Clock, Vec3, clock, clock::Centre, hill::Phase};
use rayon::prelude::*;

use super::{Heat, LEAST_PART};
use crate::field::Pulls;
use crate::leaves::FEW;
use crate::{Gas, Hydro};

/// What a kick changes of a leaf's particles.
struct Kicked<'a> {
    v: &'a mut [Vec3],
    u: &'a mut [f64],
    v_pred: &'a mut [Vec3],
    u_pred: &'a mut [f64],
    begin: &'a mut [u32],
    span: &'a mut [u32],
    end: &'a mut [u32],
    /// Empty where no field has steps of its own.
    field_begin: &'a mut [u32],
    field_span: &'a mut [u32],
}

impl Kicked<'_> {
    /// Adds the change of velocity that pairs give to particle k, wherever it is in its step, and counts what the frame made of it.
    fn push(&mut self, hydro: &Hydro, clock: &Clock, k: usize, (m, dv): (f64, Vec3)) -> Vec3 {
        let Some(hill) = hydro.domain.hill() else {
            self.v[k] += dv;
            return Vec3::zeros();
        };
        let change = hill.pushed(dv, self.phase(clock, k));
        self.v[k] += change;
        m * (change - dv)
    }

    /// How far particle k is in its step.
    fn phase(&self, clock: &Clock, k: usize) -> Phase {
        clock.phase(self.begin[k], self.span[k])
    }

    /// Adds `du` to the internal energy of particle k, of mass `m`, but leaves it positive.
    fn warm(&mut self, hydro: &Hydro, k: usize, (m, du): (f64, f64), heat: &mut Heat) {
        let u = &mut self.u[k];
        let least = hydro.least_u.max(LEAST_PART * *u);
        let wanted = *u + du;
        *u = wanted;
        if wanted < least && hydro.eos.is_free() {
            *u = least;
            heat.floored += m * (least - wanted);
            heat.floors += 1;
        }
    }

    /// The prediction of particle k starts anew from its state; gas bound to a temperature gives off what it has too much.
    fn settle(&mut self, hydro: &Hydro, k: usize, m: f64, heat: &mut Heat) {
        if hydro.eos.is_free() {
            self.u_pred[k] = self.u[k];
        } else {
            heat.radiated += m * (self.u[k] - self.u_pred[k]);
            self.u[k] = self.u_pred[k];
        }
        self.v_pred[k] = self.v[k];
    }

    /// Closes the step of the field `pull` on particle k at its end; before that, the particle is seen as if it had been kicked all the while.
    fn close_field(&mut self, clock: &Clock, k: usize, pull: Vec3) {
        let (begin, span) = (self.field_begin[k], self.field_span[k]);
        let change = clock::closing(clock.tick, begin, span) * clock.unit() * pull;
        if clock.synchronous() || begin + span == clock.tick {
            self.v[k] += change;
            self.v_pred[k] = self.v[k];
        } else {
            self.v_pred[k] = self.v[k] + change;
        }
    }
}

/// What tells a kick about a particle.
struct Impulses<'a> {
    x: &'a [Vec3],
    m: &'a [f64],
    dv: &'a [Vec3],
    du: &'a [f64],
    pulls: Pulls<'a>,
    next_field_span: &'a [u32],
    next_span: &'a [u32],
    wake: &'a [u32],
}

impl Gas {
    /// Kicks that close the steps ending now; `centre` is the star, if it pulls the gas.
    pub fn close(&mut self, hydro: &Hydro, clock: &Clock, centre: &Centre) -> Heat {
        let ending = |end: u32| clock.synchronous() || end == clock.tick;
        self.kick(true, |kicked, given, (k, i), heat| {
            let active = ending(kicked.end[k]);
            let (m, dv) = (given.m[i], given.dv[i]);
            if !active {
                heat.frame += kicked.push(hydro, clock, k, (m, dv));
            } else {
                let before = kicked.v[k];
                if let Some(hill) = hydro.domain.hill() {
                    kicked.v[k] = hill.seen(given.x[i], before, kicked.phase(clock, k));
                }
                kicked.v[k] += dv;
                let ticks = clock::closing(clock.tick, kicked.begin[k], kicked.span[k]);
                let dt = f64::from(kicked.span[k]) * clock.unit();
                let pull = given.pulls.gravity(i) + centre.lacking(given.x[i], dt);
                kicked.v[k] += ticks * clock.unit() * pull;
                if hydro.domain.hill().is_some() {
                    heat.frame += m * (kicked.v[k] - before - dv);
                }
            }
            kicked.warm(hydro, k, (given.m[i], given.du[i]), heat);
            if active {
                kicked.settle(hydro, k, given.m[i], heat);
                if let Some(&pull) = given.pulls.field.get(i) {
                    kicked.close_field(clock, k, pull);
                }
            }
        })
    }

    /// Kicks that open the steps beginning now; `centre` as in [`Gas::close`].
    pub fn open(&mut self, hydro: &Hydro, clock: &Clock, next: &Clock, centre: &Centre) -> Heat {
        let ending = |end: u32| clock.synchronous() || end == clock.tick;
        let heat = self.kick(false, |kicked, given, (k, i), heat| {
            let (m, dv) = (given.m[i], given.dv[i]);
            if !ending(kicked.end[k]) {
                heat.frame += kicked.push(hydro, clock, k, (m, dv));
            } else {
                let before = kicked.v[k];
                kicked.v[k] += dv;
                let span = given.next_span[i];
                let dt = f64::from(span) * next.unit();
                let pull = given.pulls.gravity(i) + centre.lacking(given.x[i], dt);
                kicked.v[k] += clock::opening(span) * next.unit() * pull;
                if let Some(&pull) = given.pulls.field.get(i)
                    && (clock.synchronous()
                        || kicked.field_begin[k] + kicked.field_span[k] == clock.tick)
                {
                    let span = given.next_field_span[i];
                    kicked.v[k] += clock::opening(span) * next.unit() * pull;
                    (kicked.field_begin[k], kicked.field_span[k]) = (next.tick, span);
                }
                if let Some(hill) = hydro.domain.hill() {
                    kicked.v[k] = hill.opened(given.x[i], kicked.v[k], dt);
                    heat.frame += m * (kicked.v[k] - before - dv);
                }
                kicked.begin[k] = next.tick;
                kicked.span[k] = span;
                kicked.end[k] = next.tick + span;
            }
            kicked.end[k] = kicked.end[k].min(given.wake[i]);
            kicked.warm(hydro, k, (given.m[i], given.du[i]), heat);
        });
        self.bound_near(&hydro.domain, next);
        heat
    }

    /// Kicks the particles near the active ones, each by `kick(columns, impulses, (place in its leaf, place), heat)`.
    fn kick(
        &mut self,
        closing: bool,
        kick: impl Fn(&mut Kicked, &Impulses, (usize, usize), &mut Heat) + Sync,
    ) -> Heat {
        let (p, r) = (&mut self.particles, &mut self.rates);
        let given = Impulses {
            x: &p.x,
            m: &p.m,
            dv: if closing { &r.dv_close } else { &r.dv_open },
            du: if closing { &r.du_close } else { &r.du_open },
            pulls: Pulls {
                gravity: &r.gravity,
                field: &r.field,
            },
            next_field_span: &r.next_field_span,
            next_span: &r.next_span,
            wake: &self.wake,
        };
        let (v, u) = (Parts::new(&mut p.v), Parts::new(&mut p.u));
        let (v_pred, u_pred) = (Parts::new(&mut r.v_pred), Parts::new(&mut r.u_pred));
        let (begin, span, end) = (
            Parts::new(&mut p.begin),
            Parts::new(&mut p.span),
            Parts::new(&mut p.end),
        );
        let of_field = [&mut p.field_begin, &mut p.field_span].map(|column| Parts::new(column));
        let has_field = !r.field.is_empty();
        let nodes = &self.tree.nodes;
        let near = self.vicinity.near.par_iter().with_min_len(FEW);
        let of_leaf = |&leaf: &u32| {
            let own = nodes[leaf as usize].range();
            let of_own = if has_field { own.clone() } else { 0..0 };
            // SAFETY: leaves have no particles in common.
            let mut kicked = unsafe {
                Kicked {
                    v: v.part(own.clone()),
                    u: u.part(own.clone()),
                    v_pred: v_pred.part(own.clone()),
                    u_pred: u_pred.part(own.clone()),
                    begin: begin.part(own.clone()),
                    span: span.part(own.clone()),
                    end: end.part(own.clone()),
                    field_begin: of_field[0].part(of_own.clone()),
                    field_span: of_field[1].part(of_own),
                }
            };
            let mut heat = Heat::default();
            for place in own.enumerate() {
                kick(&mut kicked, &given, place, &mut heat);
            }
            heat
        };
        near.map(of_leaf).collect_into_vec(&mut self.heats);
        self.heats
            .iter()
            .fold(Heat::default(), |sum, &heat| sum.and(heat))
    }
}
