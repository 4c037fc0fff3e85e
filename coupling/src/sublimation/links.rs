//! Links: which gas is around each grain and which grains are around each gas particle.

use gas::probe::{Candidates, Reach, Shape, Weights};
use nalgebra::Matrix3;
use nbody::points::Vec3;
use rayon::prelude::*;

use crate::System;

/// Grains that a thread looks at in one go.
const RUN: usize = 512;

/// The rigid rotation that a grain at an edge of the gas sees.
#[derive(Clone, Copy, Debug)]
struct Turn {
    offset: Vec3,
    inverse_inertia: Matrix3<f64>,
    /// place of its first pair's arm
    arms: usize,
}

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
    /// place of each grain's turn; nowhere for those inside the gas
    turn: Vec<u32>,
    turns: Vec<Turn>,
    arms: Vec<Vec3>,
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
    turn: Vec<u32>,
    turns: Vec<Turn>,
    arms: Vec<Vec3>,
}

const NOWHERE: u32 = u32::MAX;

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
        self.invite(system.gas.len());
    }

    /// Puts the parts one after the other; rooms are gas particles until they invite.
    fn list(&mut self, parts: &[Part]) {
        self.start.clear();
        self.room.clear();
        self.weight.clear();
        self.turn.clear();
        self.turns.clear();
        self.arms.clear();
        self.start.push(0);
        for part in parts {
            let before = self.room.len();
            self.start
                .extend(part.ends.iter().map(|end| (before + end) as u32));
            self.room.extend_from_slice(&part.gas);
            self.weight.extend_from_slice(&part.weight);
            let (turns, arms) = (self.turns.len() as u32, self.arms.len());
            let later = |&turn: &u32| if turn == NOWHERE { turn } else { turns + turn };
            self.turn.extend(part.turn.iter().map(later));
            self.turns.extend(part.turns.iter().map(|turn| Turn {
                arms: arms + turn.arms,
                ..*turn
            }));
            self.arms.extend_from_slice(&part.arms);
        }
        self.share.clear();
        for ends in self.start.windows(2) {
            let own = &self.weight[ends[0] as usize..ends[1] as usize];
            let sum: f64 = own.iter().map(|w| w.max(0.0)).sum();
            self.share.extend(own.iter().map(|w| w.max(0.0) / sum));
        }
    }

    /// Lists the guests of each of the `gas` particles that has any.
    fn invite(&mut self, gas: usize) {
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

    /// A field of the gas at a grain; `of` gives it by room.
    pub fn seen(&self, grain: usize, of: impl Fn(usize) -> Vec3) -> Vec3 {
        let pairs = || {
            self.hosts(grain)
                .map(|(pair, room)| (pair, self.weight[pair] * of(room)))
        };
        let plain: Vec3 = pairs().map(|(_, field)| field).sum();
        let Some(turn) = self.turn_of(grain) else {
            return plain;
        };
        let spin: Vec3 = pairs()
            .map(|(pair, field)| self.arm(turn, grain, pair).cross(&field))
            .sum();
        plain - (turn.inverse_inertia * spin).cross(&turn.offset)
    }

    /// The rotation that an impulse at a grain gives to the gas around.
    pub fn spin(&self, grain: usize, impulse: Vec3) -> Vec3 {
        let turn = self.turn_of(grain);
        turn.map_or_else(Vec3::zeros, |turn| {
            turn.inverse_inertia * turn.offset.cross(&impulse)
        })
    }

    /// What of it a pair gets, by its weight.
    pub fn turned(&self, spin: Vec3, grain: usize, pair: usize) -> Vec3 {
        let turn = self.turn_of(grain);
        turn.map_or_else(Vec3::zeros, |turn| spin.cross(&self.arm(turn, grain, pair)))
    }

    fn turn_of(&self, grain: usize) -> Option<&Turn> {
        self.turns.get(self.turn[grain] as usize)
    }

    fn arm(&self, turn: &Turn, grain: usize, pair: usize) -> Vec3 {
        self.arms[turn.arms + pair - self.start[grain] as usize]
    }

    /// Pair and room of the gas around a grain.
    pub fn hosts(&self, grain: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let range = self.start[grain] as usize..self.start[grain + 1] as usize;
        range.map(|pair| (pair, self.room[pair] as usize))
    }
}

impl Part {
    /// Lists the gas around grain `i`; none of one that could not keep angular momentum.
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
        let rigid = weights.shape == Shape::Rigid;
        if rigid || weights.shape == Shape::Linear {
            self.gas.extend_from_slice(&weights.index);
            self.weight.extend_from_slice(&weights.weight);
        }
        self.turn.push(if rigid {
            self.turns.len() as u32
        } else {
            NOWHERE
        });
        if rigid {
            self.turns.push(Turn {
                offset: weights.offset,
                inverse_inertia: weights.inverse_inertia,
                arms: self.arms.len(),
            });
            self.arms.extend_from_slice(&weights.arm);
        }
        self.ends.push(self.gas.len());
    }
}
