//! Links: which gas is around each grain and which grains are around each gas particle.

use gas::probe::{Candidates, Reach, Shape, Weights};
use rayon::prelude::*;

use crate::System;

/// Grains that a thread looks at in one go.
const RUN: usize = 512;

/// Pairs of grains and gas, in the order of the grains, and by gas particle.
#[derive(Default)]
pub struct Links {
    /// first pair of each grain, and the end
    start: Vec<u32>,
    /// place in `rooms` of the gas of each pair
    room: Vec<u32>,
    /// w of each pair
    pub weight: Vec<f64>,
    /// part of the swarm that each pair has: the positive of w
    pub share: Vec<f64>,
    /// gas particles that have pairs
    pub rooms: Vec<u32>,
    /// first guest of each room, and the end
    first: Vec<u32>,
    /// grain and pair of each guest, room by room in the order of the grains
    guest: Vec<[u32; 2]>,
}

/// The pairs of a run of grains.
#[derive(Default)]
struct Part {
    ends: Vec<usize>,
    gas: Vec<u32>,
    weight: Vec<f64>,
}

impl Links {
    /// Finds the gas around all grains.
    pub fn find(&mut self, system: &System, neighbours: f64) {
        let largest = system.gas.particles.h.iter().copied().fold(0.0, f64::max);
        let reach = Reach {
            neighbours,
            largest,
        };
        let n = system.dust.len();
        let parts: Vec<Part> = (0..n.div_ceil(RUN))
            .into_par_iter()
            .map_init(
                || (Candidates::default(), Weights::default()),
                |(candidates, weights), run| {
                    let mut part = Part::default();
                    for i in run * RUN..n.min((run + 1) * RUN) {
                        part.look(system, i, &reach, (candidates, weights));
                    }
                    part
                },
            )
            .collect();
        self.list(&parts);
        self.turn(system.gas.len());
    }

    /// Puts the parts one after the other; rooms are gas particles until they are turned.
    fn list(&mut self, parts: &[Part]) {
        self.start.clear();
        self.room.clear();
        self.weight.clear();
        self.start.push(0);
        for part in parts {
            let before = self.room.len();
            self.start
                .extend(part.ends.iter().map(|end| (before + end) as u32));
            self.room.extend_from_slice(&part.gas);
            self.weight.extend_from_slice(&part.weight);
        }
        self.share.clear();
        for ends in self.start.windows(2) {
            let own = &self.weight[ends[0] as usize..ends[1] as usize];
            let sum: f64 = own.iter().map(|w| w.max(0.0)).sum();
            self.share.extend(own.iter().map(|w| w.max(0.0) / sum));
        }
    }

    /// Lists the guests of each of the `gas` particles that has any.
    fn turn(&mut self, gas: usize) {
        let mut count = vec![0; gas];
        self.room.iter().for_each(|&j| count[j as usize] += 1);
        self.rooms.clear();
        self.first.clear();
        let mut total = 0;
        for (j, count) in count
            .iter_mut()
            .enumerate()
            .filter(|(_, count)| **count > 0)
        {
            self.first.push(total);
            total += std::mem::replace(count, self.rooms.len() as u32);
            self.rooms.push(j as u32);
        }
        self.first.push(total);
        let mut next = self.first.clone();
        self.guest.resize(total as usize, [0; 2]);
        for i in 0..self.start.len() - 1 {
            for pair in self.start[i]..self.start[i + 1] {
                let room = &mut self.room[pair as usize];
                *room = count[*room as usize];
                let next = &mut next[*room as usize];
                self.guest[*next as usize] = [i as u32, pair];
                *next += 1;
            }
        }
    }

    /// Grain and pair of each guest of a room.
    pub fn guests(&self, room: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let range = self.first[room] as usize..self.first[room + 1] as usize;
        let guests = self.guest[range].iter();
        guests.map(|&[grain, pair]| (grain as usize, pair as usize))
    }

    /// Pair and room of the gas around a grain.
    pub fn hosts(&self, grain: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let range = self.start[grain] as usize..self.start[grain + 1] as usize;
        range.map(|pair| (pair, self.room[pair] as usize))
    }
}

impl Part {
    /// Lists the gas around grain `i`; none of one at an edge.
    fn look(
        &mut self,
        system: &System,
        i: usize,
        reach: &Reach,
        (candidates, weights): (&mut Candidates, &mut Weights),
    ) {
        let p = &system.dust.particles;
        weights.find(
            candidates,
            &system.gas,
            &system.domain,
            (p.x[i], p.h[i]),
            reach,
        );
        if weights.shape == Shape::Linear {
            self.gas.extend_from_slice(&weights.index);
            self.weight.extend_from_slice(&weights.weight);
        }
        self.ends.push(self.gas.len());
    }
}
