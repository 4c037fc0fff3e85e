//! The queue of impacts to come within a step, in the order of time, then ids.
//!
//! When a body has had an impact, its later ones are reckoned anew from its new straight path. Only those are looked at whom
//! one of the two met on its first path: whom else a body meets because it was deflected, or has grown, is found in the next step.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use crate::bodies::Bodies;
use crate::encounters::{Encounter, touch};
use crate::points::Domain;

/// Impacts of one body in a step; more wait for the next, so that bodies at rest against each other do not stop the run.
const MOST: u32 = 64;

pub struct Queue {
    due: BinaryHeap<Due>,
    /// Whom each body's impacts are with, and where those are now that have merged into others.
    partners: Vec<Vec<usize>>,
    heir: Vec<usize>,
    /// How many impacts a body has had: one reckoned before the last of them is out of date.
    impacts: Vec<u32>,
}

impl Queue {
    pub fn new(bodies: &Bodies, encounters: &[Encounter]) -> Self {
        let n = bodies.x.len();
        let mut queue = Self {
            due: BinaryHeap::with_capacity(encounters.len()),
            partners: vec![Vec::new(); n],
            heir: (0..n).collect(),
            impacts: vec![0; n],
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
            impacts: encounter.pair.map(|i| self.impacts[i]),
        });
    }

    /// The next impact that still takes place.
    pub fn next(&mut self) -> Option<Encounter> {
        loop {
            let Due {
                encounter, impacts, ..
            } = self.due.pop()?;
            let now = encounter.pair.map(|i| self.impacts[i]);
            let alive = encounter.pair.map(|i| self.heir[i]) == encounter.pair;
            if alive && now == impacts && now.iter().all(|&n| n < MOST) {
                return Some(encounter);
            }
        }
    }

    /// After one of two bodies has taken in the other, or what is left of it, at `time`.
    pub fn unite(&mut self, bodies: &Bodies, domain: &Domain, [kept, lost]: [usize; 2], time: f64) {
        self.heir[lost] = kept;
        self.impacts[kept] += 1;
        let mut partners = std::mem::take(&mut self.partners[lost]);
        self.partners[kept].append(&mut partners);
        self.reckon(bodies, domain, kept, kept, time);
    }

    /// After two bodies have parted at `time`; the one may go where the other was to.
    pub fn part(&mut self, bodies: &Bodies, domain: &Domain, [one, other]: [usize; 2], time: f64) {
        self.impacts[one] += 1;
        self.impacts[other] += 1;
        let mut partners = self.partners[one].clone();
        partners.extend(&self.partners[other]);
        self.partners[one].clone_from(&partners);
        self.partners[other] = partners;
        self.reckon(bodies, domain, one, other, time);
        self.reckon(bodies, domain, other, one, time);
    }

    /// The impacts of `body` from `time` on with all of its partners but `left`.
    fn reckon(&mut self, bodies: &Bodies, domain: &Domain, body: usize, left: usize, time: f64) {
        let mut partners = std::mem::take(&mut self.partners[body]);
        for partner in &mut partners {
            *partner = self.survivor(*partner);
        }
        partners.sort_unstable();
        partners.dedup();
        partners.retain(|&partner| partner != body);
        for &partner in partners.iter().filter(|&&partner| partner != left) {
            let d = domain.nearest(bodies.x[partner] - bodies.x[body]);
            let w = bodies.v[partner] - bodies.v[body];
            let reach = bodies.radius[body] + bodies.radius[partner];
            if let Some(time) = touch(d, w, reach, -time) {
                let pair = [body, partner];
                self.push(
                    bodies,
                    Encounter {
                        pair,
                        time,
                        held: 0.0,
                    },
                );
            }
        }
        self.partners[body] = partners;
    }

    fn survivor(&self, mut i: usize) -> usize {
        while self.heir[i] != i {
            i = self.heir[i];
        }
        i
    }
}

/// An impact in the queue; the greatest is the first to happen.
struct Due {
    encounter: Encounter,
    ids: [u64; 2],
    /// How many impacts either body had had when this one was reckoned.
    impacts: [u32; 2],
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
