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
mod tests {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

    use super::*;
    use crate::encounters::Finder;
    use crate::points::random::{self, Purpose};
    use crate::points::{Columns, Scratch};
    use rand::RngExt;

    /// Bodies of mass m and radius r at x with velocity v, ids 1, 2, ...
    fn set(parts: &[(f64, f64, [f64; 3], [f64; 3])]) -> Bodies {
        let mut bodies = Bodies::default();
        bodies.resize(parts.len());
        for (i, &(m, radius, x, v)) in parts.iter().enumerate() {
            bodies.id[i] = i as u64 + 1;
            (bodies.m[i], bodies.radius[i]) = (m, radius);
            (bodies.x[i], bodies.v[i]) = (x.into(), v.into());
        }
        bodies
    }

    fn collide(bodies: &mut Bodies, dt: f64) -> Vec<Collision> {
        let mut finder = Finder::default();
        let domain = Domain::open();
        let encounters = finder.encounters(bodies, &domain, dt).to_vec();
        let outcome = merge(bodies, &encounters, &domain, 1.0, 10.0);
        bodies.retain(&outcome.keep);
        outcome.events
    }

    fn swarm(n: u32) -> Bodies {
        let parts: Vec<_> = (1..=n)
            .map(|i| {
                let mut random = random::stream(1, Purpose::Orbits, u64::from(i), 0);
                let mut spread = || random.random::<f64>() - 0.5;
                let mut vector = || [spread(), spread(), spread()];
                let (x, v) = (vector(), vector());
                let [m, r, _] = vector();
                (1e-4 * (1.0 + m), 0.01 * (1.0 + r), x, v)
            })
            .collect();
        set(&parts)
    }

    /// Mass, momentum, moment and volume.
    fn sums(bodies: &Bodies) -> [f64; 8] {
        let mut sums = [0.0; 8];
        for i in 0..bodies.x.len() {
            let (m, x, v) = (bodies.m[i], bodies.x[i], bodies.v[i]);
            let terms = [
                m,
                m * v.x,
                m * v.y,
                m * v.z,
                m * x.x,
                m * x.y,
                m * x.z,
                bodies.radius[i].powi(3),
            ];
            sums.iter_mut()
                .zip(terms)
                .for_each(|(sum, term)| *sum += term);
        }
        sums
    }

    #[test]
    fn merging_keeps_mass_momentum_centre_and_volume() {
        let mut bodies = swarm(3000);
        let before = sums(&bodies);
        let events = collide(&mut bodies, 0.05);
        assert!(events.len() > 100 && bodies.len() + events.len() == 3000);
        assert!(
            events.iter().any(|e| e.mass_kept > 1.6e-4),
            "none merged twice"
        );
        assert!(events.is_sorted_by(|a, b| a.time <= b.time));
        for (a, b) in sums(&bodies).iter().zip(before) {
            assert!((a - b).abs() < 1e-15, "{a} {b}");
        }
    }

    #[test]
    fn the_order_in_memory_does_not_matter() {
        // Without a step all impacts are at once, and the ids alone decide.
        for dt in [0.0, 0.05] {
            let (mut one, mut other) = (swarm(3000), swarm(3000));
            one.radius.iter_mut().for_each(|r| *r *= 2.0);
            other.radius.clone_from(&one.radius);
            let order: Vec<u32> = (0..3000).map(|i| i * 1237 % 3000).collect();
            other.permute(&order, &mut Scratch::default());
            assert_eq!(collide(&mut one, dt), collide(&mut other, dt));
        }
    }

    #[test]
    fn a_parabolic_impact_has_the_escape_speed_and_its_angle() {
        // From rest at infinity: w^2 = 2 G M/d. Two equal bodies touching at 45 degrees.
        let w = 2f64.sqrt() / 0.02f64.sqrt() * 2e-3f64.sqrt();
        let part = w * 0.5f64.sqrt();
        let d = 0.02 * (1.0 - 1e-9);
        let mut bodies = set(&[
            (1e-3, 0.01, [0.0; 3], [0.0; 3]),
            (1e-3, 0.01, [d, 0.0, 0.0], [-part, part, 0.0]),
        ]);
        let event = collide(&mut bodies, 1e-9)[0];
        assert!((event.speed - 1.0).abs() < 1e-8 && (event.angle - FRAC_PI_4).abs() < 1e-8);
        assert!(event.energy_lost.abs() < 1e-12);
        // Half the mass each: reduced mass 5e-4.
        assert!((event.spin.z - 5e-4 * d * part).abs() < 1e-18);
    }

    #[test]
    fn energy_and_angular_momentum_of_an_isolated_pair_are_in_the_event() {
        let mut bodies = set(&[
            (2.0, 0.5, [0.1, 0.2, 0.3], [0.3, -0.2, 0.1]),
            (1.0, 0.4, [0.7, 0.3, 0.1], [-0.4, 0.5, 0.2]),
        ]);
        let sums = |b: &Bodies| {
            let kinetic: f64 = (0..b.len())
                .map(|i| 0.5 * b.m[i] * b.v[i].norm_squared())
                .sum();
            let spin: Vec3 = (0..b.len()).map(|i| b.x[i].cross(&b.v[i]) * b.m[i]).sum();
            (kinetic, spin)
        };
        let potential = -2.0 / (bodies.x[0] - bodies.x[1]).norm();
        let before = sums(&bodies);
        let event = collide(&mut bodies, 0.01)[0];
        let after = sums(&bodies);
        assert!((before.0 + potential - after.0 - event.energy_lost).abs() < 1e-15);
        assert!((before.1 - after.1 - event.spin).norm() < 1e-15);
        assert_eq!(
            (event.id_kept, event.mass_kept, event.mass_lost),
            (1, 2.0, 1.0)
        );
    }

    #[test]
    fn a_bullet_through_three_bodies_merges_with_each_in_its_turn() {
        // It passed the three between x = 0 and 2 in the last step; each merging slows it down.
        let still = |x: f64| (1e-9, 1e-3, [x, 0.0, 0.0], [0.0; 3]);
        let bullet = (1.0, 0.1, [4.0, 0.0, 0.0], [5.0, 0.0, 0.0]);
        let mut bodies = set(&[still(2.0), still(0.0), still(1.0), bullet]);
        let events = collide(&mut bodies, 1.0);
        let lost: Vec<u64> = events.iter().map(|e| e.id_lost).collect();
        assert_eq!(lost, [2, 3, 1]);
        for (event, x) in events.iter().zip([0.0, 1.0, 2.0]) {
            // From x = 4 back to the sum of radii before the target.
            assert!(
                (event.time - (10.0 - (4.101 - x) / 5.0)).abs() < 3e-8,
                "{event:?}"
            );
            assert!(event.angle < 1e-9);
        }
    }

    #[test]
    fn an_impact_is_dropped_if_the_first_one_stops_the_body() {
        // Two equal bodies meet head-on at x = -0.5 and stop; the third lies farther along the path of the first.
        let mut bodies = set(&[
            (1.0, 0.1, [2.0, 0.0, 0.0], [4.0, 0.0, 0.0]),
            (1.0, 0.1, [-3.0, 0.0, 0.0], [-4.0, 0.0, 0.0]),
            (1.0, 0.1, [1.5, 0.0, 0.0], [0.0; 3]),
        ]);
        let events = collide(&mut bodies, 1.0);
        assert_eq!((events.len(), bodies.len()), (1, 2));
        assert!((bodies.x[0].x + 0.5).abs() < 1e-15 && bodies.v[0].norm() < 1e-15);
    }

    #[test]
    fn planets_keep_their_identity_then_the_heavier_then_the_older() {
        let near = [0.01, 0.0, 0.0];
        let survivor = |a: (f64, Kind), b: (f64, Kind)| {
            let mut bodies = set(&[(a.0, 0.1, [0.0; 3], [0.0; 3]), (b.0, 0.1, near, [0.0; 3])]);
            bodies.kind = vec![a.1 as u32, b.1 as u32];
            collide(&mut bodies, 0.1)[0].id_kept
        };
        let (planet, small) = (Kind::Planet, Kind::Planetesimal);
        assert_eq!(survivor((5.0, small), (1.0, planet)), 2);
        assert_eq!(survivor((1.0, small), (2.0, small)), 2);
        assert_eq!(survivor((1.0, small), (1.0, small)), 1);
        assert_eq!(survivor((0.0, small), (0.0, small)), 1);
    }

    #[test]
    fn a_pair_across_a_periodic_face_merges_there() {
        let domain = Domain::periodic(Vec3::repeat(1.0));
        let mut bodies = set(&[
            (1.0, 0.1, [0.95, 0.5, 0.5], [0.0; 3]),
            (3.0, 0.1, [0.05, 0.5, 0.5], [0.0; 3]),
        ]);
        let encounters = Finder::default().encounters(&bodies, &domain, 0.1).to_vec();
        let outcome = merge(&mut bodies, &encounters, &domain, 1.0, 0.0);
        assert_eq!(outcome.keep, [false, true]);
        assert!((bodies.x[1].x - 0.025).abs() < 1e-15);
    }

    #[test]
    fn the_star_takes_what_is_inside_and_what_passed_through() {
        let mut star = set(&[(1.0, 0.05, [0.0; 3], [0.0; 3])]);
        star.id[0] = 100;
        let orbit = |e: f64, mean_anomaly: f64| Elements {
            semi_major_axis: 1.0,
            eccentricity: e,
            inclination: 0.2,
            node: 0.3,
            pericentre: 0.4,
            mean_anomaly,
        };
        // Pericentres at 0.04 (inside) and 0.06; 0.1 and 0.3 after the pericentre, and 0.1 before it.
        let orbits = [
            orbit(0.96, 0.1),
            orbit(0.96, 0.3),
            orbit(0.96, -0.1),
            orbit(0.94, 0.1),
        ];
        let mut bodies = set(&[(1e-6, 0.0, [0.0; 3], [0.0; 3]); 5]);
        for (i, orbit) in orbits.iter().enumerate() {
            (bodies.x[i], bodies.v[i]) = orbit.state(1.0 + 1e-6);
        }
        bodies.x[4] = Vec3::new(0.03, 0.0, 0.0);
        let momentum: Vec3 = bodies.v[0] * 1e-6 + bodies.v[4] * 1e-6;
        let outcome = accrete(&mut star, &bodies, 1.0, 7.0, 0.2);
        assert_eq!(outcome.keep, [false, true, true, true, false]);
        assert_eq!(
            outcome.events.iter().map(|e| e.id_lost).collect::<Vec<_>>(),
            [1, 5]
        );
        assert!((outcome.events[0].time - 6.9).abs() < 1e-6);
        assert!((star.m[0] - 1.000002).abs() < 1e-15 && star.radius[0] == 0.05);
        assert!((star.v[0] * star.m[0] - momentum).norm() < 1e-18);
        // At the star's surface on an orbit of a = 1: v^2 = 2 (1/0.05 - 1/2); the pericentre is close below.
        let event = outcome.events[0];
        assert!((event.speed - (1.0f64 - 0.025).sqrt()).abs() < 1e-5 && event.angle < FRAC_PI_2);
        star.radius[0] = 0.0;
        assert!(accrete(&mut star, &bodies, 1.0, 7.0, 0.2).events.is_empty());
    }
}
