//! Collisions: perfect merging of bodies that touched, and accretion onto the star.
//!
//! Mass, momentum, centre of mass and volume (R^3 = R_i^3 + R_j^3) are kept; what orbit the pair had about its centre of mass becomes
//! spin and heat, and is told. Impact speed from the pair's energy: v^2 = w^2 + 2 G M (1/R - 1/d), d and w now, R = R_i + R_j.
//! Impacts are done in the order of time, then ids; when a body has merged, its later impacts are reckoned anew.
//! Whom a merged body touches only because it has grown is found at the end of the next step.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use crate::bodies::{Bodies, Kind};
use crate::encounters::{Encounter, touch};
use crate::orbit::Elements;
use crate::points::{Domain, Vec3};

/// What happened to two bodies that became one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collision {
    pub time: f64,
    pub id_kept: u64,
    pub id_lost: u64,
    /// Masses before the impact.
    pub mass_kept: f64,
    pub mass_lost: f64,
    /// Impact speed in units of the pair's escape speed; infinite for massless pairs.
    pub speed: f64,
    /// 0 head-on, pi/2 grazing.
    pub angle: f64,
    /// Kinetic and mutual potential energy of the pair about its centre of mass, which the merged body has no longer.
    pub energy_lost: f64,
    /// Angular momentum of the pair about its centre of mass, now spin.
    pub spin: Vec3,
}

/// What a round of collisions did: who stays (for `retain`), and the events in their order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    pub keep: Vec<bool>,
    pub events: Vec<Collision>,
}

/// Merges the bodies of `encounters` (of the step that ends at `now`). Bodies to be removed stay in place, marked in `keep`.
pub fn merge(
    bodies: &mut Bodies,
    encounters: &[Encounter],
    domain: &Domain,
    g: f64,
    now: f64,
) -> Outcome {
    let n = bodies.x.len();
    let mut outcome = Outcome {
        keep: vec![true; n],
        events: Vec::new(),
    };
    if encounters.is_empty() {
        return outcome;
    }
    let mut queue = Queue::new(bodies, encounters);
    while let Some(Encounter { pair, time }) = queue.next() {
        let [i, j] = pair;
        let (kept, lost) = if outranks(bodies, i, j) {
            (i, j)
        } else {
            (j, i)
        };
        let d = domain.nearest(bodies.x[lost] - bodies.x[kept]);
        let pair = Pair::of(bodies, [kept, lost], d);
        outcome.events.push(pair.collision(g, now + time));
        absorb(bodies, kept, lost, d);
        outcome.keep[lost] = false;
        queue.unite(bodies, domain, [kept, lost], time);
    }
    outcome
}

/// The impacts to come.
struct Queue {
    due: BinaryHeap<Due>,
    /// Whom each body's impacts are with, and where those are now that have merged into others.
    partners: Vec<Vec<usize>>,
    heir: Vec<usize>,
    /// How often a body has merged: an impact reckoned before that is out of date.
    mergers: Vec<u32>,
}

impl Queue {
    fn new(bodies: &Bodies, encounters: &[Encounter]) -> Self {
        let n = bodies.x.len();
        let mut queue = Self {
            due: BinaryHeap::with_capacity(encounters.len()),
            partners: vec![Vec::new(); n],
            heir: (0..n).collect(),
            mergers: vec![0; n],
        };
        for encounter in encounters {
            let [i, j] = encounter.pair;
            queue.partners[i].push(j);
            queue.partners[j].push(i);
            queue.push(bodies, *encounter);
        }
        queue
    }

    fn push(&mut self, bodies: &Bodies, encounter: Encounter) {
        let mut ids = encounter.pair.map(|i| bodies.id[i]);
        ids.sort_unstable();
        self.due.push(Due {
            encounter,
            ids,
            mergers: encounter.pair.map(|i| self.mergers[i]),
        });
    }

    fn next(&mut self) -> Option<Encounter> {
        loop {
            let Due {
                encounter, mergers, ..
            } = self.due.pop()?;
            let valid = encounter.pair.map(|i| self.heir[i]) == encounter.pair
                && encounter.pair.map(|i| self.mergers[i]) == mergers;
            if valid {
                return Some(encounter);
            }
        }
    }

    /// The lost body's partners become the kept one's; their impacts are reckoned anew from `time`, when the two merged.
    fn unite(&mut self, bodies: &Bodies, domain: &Domain, [kept, lost]: [usize; 2], time: f64) {
        self.heir[lost] = kept;
        self.mergers[kept] += 1;
        let mut partners = std::mem::take(&mut self.partners[lost]);
        partners.append(&mut self.partners[kept]);
        for partner in &mut partners {
            *partner = self.survivor(*partner);
        }
        partners.sort_unstable();
        partners.dedup();
        partners.retain(|&partner| partner != kept);
        for &partner in &partners {
            let d = domain.nearest(bodies.x[partner] - bodies.x[kept]);
            let w = bodies.v[partner] - bodies.v[kept];
            let reach = bodies.radius[kept] + bodies.radius[partner];
            if let Some(time) = touch(d, w, reach, -time) {
                let pair = [kept, partner];
                self.push(bodies, Encounter { pair, time });
            }
        }
        self.partners[kept] = partners;
    }

    fn survivor(&self, mut i: usize) -> usize {
        while self.heir[i] != i {
            i = self.heir[i];
        }
        i
    }
}

/// Accretes onto the star the bodies that are within its radius, or passed their pericentre there within the step of `dt` that ends now.
///
/// The star keeps its radius. Without a star, or with a star without radius, nothing happens.
pub fn accrete(star: &mut Bodies, bodies: &Bodies, g: f64, now: f64, dt: f64) -> Outcome {
    let mut outcome = Outcome {
        keep: vec![true; bodies.x.len()],
        events: Vec::new(),
    };
    let Some(&radius) = star.radius.first().filter(|&&r| r > 0.0) else {
        return outcome;
    };
    let mut fallen: Vec<(f64, u64, usize)> = (0..bodies.x.len())
        .filter_map(|i| {
            let (d, w) = (bodies.x[i] - star.x[0], bodies.v[i] - star.v[0]);
            let mu = g * (star.m[0] + bodies.m[i]);
            Some((plunge(mu, d, w, radius, dt)?, bodies.id[i], i))
        })
        .collect();
    fallen.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    for (time, _, i) in fallen {
        let pair = Pair {
            id: [star.id[0], bodies.id[i]],
            m: [star.m[0], bodies.m[i]],
            d: bodies.x[i] - star.x[0],
            w: bodies.v[i] - star.v[0],
            reach: radius,
        };
        outcome.events.push(pair.collision(g, now + time));
        let share = pair.share();
        star.x[0] += pair.d * share;
        star.v[0] += pair.w * share;
        star.m[0] += pair.m[1];
        outcome.keep[i] = false;
    }
    outcome
}

/// When, counted from now, a body entered the star: now if it is inside, at its pericentre if that lay inside and within the step.
fn plunge(mu: f64, d: Vec3, w: Vec3, radius: f64, dt: f64) -> Option<f64> {
    let r = d.norm();
    if r < radius {
        return Some(0.0);
    }
    let outwards = d.dot(&w);
    // Outside the star it went no faster than this since then.
    let fastest = (w.norm_squared() + 2.0 * mu / radius).sqrt();
    if outwards <= 0.0 || r - radius > dt * fastest {
        return None;
    }
    let ago = match Elements::of(mu, d, w) {
        Some(orbit) if orbit.pericentre_distance() < radius => {
            orbit.mean_anomaly / orbit.mean_motion(mu)
        }
        Some(_) => return None,
        None => r * r / outwards,
    };
    (ago <= dt).then_some(-ago)
}

/// A pair of bodies, the kept one first.
struct Pair {
    id: [u64; 2],
    m: [f64; 2],
    /// Separation and relative velocity of the lost one from the kept one.
    d: Vec3,
    w: Vec3,
    reach: f64,
}

impl Pair {
    fn of(bodies: &Bodies, [kept, lost]: [usize; 2], d: Vec3) -> Self {
        Self {
            id: [bodies.id[kept], bodies.id[lost]],
            m: [bodies.m[kept], bodies.m[lost]],
            d,
            w: bodies.v[lost] - bodies.v[kept],
            reach: bodies.radius[kept] + bodies.radius[lost],
        }
    }

    /// The lost body's part of the mass.
    fn share(&self) -> f64 {
        let total = self.m[0] + self.m[1];
        if total > 0.0 { self.m[1] / total } else { 0.0 }
    }

    fn collision(&self, g: f64, time: f64) -> Collision {
        let (total, reach) = (self.m[0] + self.m[1], self.reach);
        let reduced = self.m[0] * self.share();
        let distance = if self.d.norm() > 0.0 {
            self.d.norm()
        } else {
            reach
        };
        let w2 = self.w.norm_squared();
        let speed = (w2 + 2.0 * g * total * (1.0 / reach - 1.0 / distance))
            .max(0.0)
            .sqrt();
        let escape = (2.0 * g * total / reach).sqrt();
        let momentum = self.d.cross(&self.w);
        let sine = (momentum.norm() / (reach * speed)).min(1.0);
        Collision {
            time,
            id_kept: self.id[0],
            id_lost: self.id[1],
            mass_kept: self.m[0],
            mass_lost: self.m[1],
            speed: if escape > 0.0 {
                speed / escape
            } else {
                f64::INFINITY
            },
            angle: if speed > 0.0 { sine.asin() } else { 0.0 },
            energy_lost: reduced * 0.5 * w2 - g * self.m[0] * self.m[1] / distance,
            spin: momentum * reduced,
        }
    }
}

/// Gives the kept body the lost one's mass, momentum, moment and volume. The lost one is `d` away.
fn absorb(bodies: &mut Bodies, kept: usize, lost: usize, d: Vec3) {
    let total = bodies.m[kept] + bodies.m[lost];
    let share = if total > 0.0 {
        bodies.m[lost] / total
    } else {
        0.0
    };
    let (w, a) = (
        bodies.v[lost] - bodies.v[kept],
        bodies.a[lost] - bodies.a[kept],
    );
    bodies.x[kept] += d * share;
    bodies.v[kept] += w * share;
    bodies.a[kept] += a * share;
    bodies.m[kept] = total;
    let volume = bodies.radius[kept].powi(3) + bodies.radius[lost].powi(3);
    bodies.radius[kept] = volume.cbrt();
    bodies.softening[kept] = bodies.softening[kept].max(bodies.softening[lost]);
}

/// Whether body i keeps its identity before j: planets before planetesimals, then the heavier, then the smaller id.
fn outranks(bodies: &Bodies, i: usize, j: usize) -> bool {
    let planet = |i: usize| bodies.kind[i] == Kind::Planet as u32;
    let order = planet(i)
        .cmp(&planet(j))
        .then(bodies.m[i].total_cmp(&bodies.m[j]))
        .then(bodies.id[j].cmp(&bodies.id[i]));
    order == Ordering::Greater
}

/// An impact in the queue; the greatest is the first to happen.
struct Due {
    encounter: Encounter,
    ids: [u64; 2],
    /// How often either body had merged when the impact was reckoned.
    mergers: [u32; 2],
}

impl Ord for Due {
    fn cmp(&self, other: &Self) -> Ordering {
        let (a, b) = (self.encounter.time, other.encounter.time);
        b.total_cmp(&a).then_with(|| other.ids.cmp(&self.ids))
    }
}

impl PartialOrd for Due {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Due {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Due {}

#[cfg(test)]
mod tests;
