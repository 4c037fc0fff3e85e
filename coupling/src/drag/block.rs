//! Block: a run of immersed particles with its pairs, and its own copies ("slots") of the gas that they see.
//!
//! Everything a block writes is its own: sums over gas are formed slot by slot and added up over the blocks afterwards, in a fixed order.

use gas::Gas;
use gas::probe::{Candidates, Reach, Shape, Weights, isothermal, radius};
use nalgebra::Matrix3;
use nbody::points::{Domain, Vec3};

use super::group::Group;
use super::row::Row;
use super::{Booking, Half, Immersed, Parcel, Settings, parcel};

/// Buffers of a thread while it links blocks.
#[derive(Default)]
pub struct Scratch {
    candidates: Candidates,
    /// of a member that finds too little in the group's
    own: Candidates,
    weights: Weights,
    window: Vec<u32>,
}

/// What a rigid shape adds to the weights.
#[derive(Clone, Copy, Debug)]
struct Turn {
    offset: Vec3,
    inverse_inertia: Matrix3<f64>,
    first_arm: usize,
}

#[derive(Clone, Debug, Default)]
pub struct Block {
    rows: Vec<Row>,
    /// first pair of each row, and the end
    start: Vec<u32>,
    slot: Vec<u32>,
    weight: Vec<f64>,
    turns: Vec<Turn>,
    arms: Vec<Vec3>,
    /// gas particle of each slot, ascending
    pub gas: Vec<u32>,
    /// place of each slot in the list of touched gas
    pub place: Vec<u32>,
    /// sums over the pairs of each slot
    pub partial: Vec<Parcel>,
    /// mean of the half steps of the rows
    pub half: f64,
    /// velocity and acceleration of each slot
    field: Vec<[f64; 8]>,
}

/// Three columns from `first` on.
fn vector(columns: &[f64], first: usize) -> Vec3 {
    Vec3::new(columns[first], columns[first + 1], columns[first + 2])
}

/// How far beyond its last neighbourhood a particle first looks, by the radius.
const MARGIN: f64 = 1.1;

impl Block {
    /// Finds the gas around the members.
    pub fn link<I: Immersed>(
        &mut self,
        gas: &Gas,
        immersed: &I,
        members: &[u32],
        (domain, reach): (&Domain, &Reach),
        scratch: &mut Scratch,
    ) {
        self.clear();
        let mut first = 0;
        while first < members.len() {
            let group = Group::new(immersed, &members[first..], domain);
            let available = (MARGIN * group.radius).min(radius(domain, reach.largest));
            let warm = group.radius > 0.0;
            if warm {
                scratch
                    .candidates
                    .gather(gas, domain, group.lo, group.hi, available);
            }
            let weights = &mut scratch.weights;
            for &i in &members[first..first + group.count] {
                let i = i as usize;
                let start = (immersed.position(i), immersed.smoothing(i));
                if !(warm && weights.fit(&scratch.candidates, domain, start, available, reach)) {
                    weights.find(&mut scratch.own, gas, domain, start, reach);
                }
                self.add(weights, immersed.mass(i));
            }
            first += group.count;
        }
        self.number_slots(&mut scratch.window);
        self.place.resize(self.gas.len(), 0);
        self.hear(gas, domain);
        for (row, &i) in self.rows.iter_mut().zip(members) {
            let i = i as usize;
            let u = domain.relative(immersed.position(i), immersed.velocity(i)) - row.v_gas;
            row.crossing = match row.shape {
                Shape::Empty => f64::INFINITY,
                _ => row.h / (row.c + u.norm()),
            };
        }
    }

    fn clear(&mut self) {
        self.rows.clear();
        self.start.clear();
        self.start.push(0);
        self.slot.clear();
        self.weight.clear();
        self.turns.clear();
        self.arms.clear();
    }

    /// Appends a row; its slots are gas particles until they are numbered.
    fn add(&mut self, weights: &Weights, m: f64) {
        if weights.shape == Shape::Rigid {
            self.turns.push(Turn {
                offset: weights.offset,
                inverse_inertia: weights.inverse_inertia,
                first_arm: self.arms.len(),
            });
            self.arms.extend_from_slice(&weights.arm);
        }
        self.rows.push(Row {
            h: weights.h,
            rho: weights.rho,
            shape: weights.shape,
            gain: weights.gain,
            turn: self.turns.len().saturating_sub(1) as u32,
            m,
            ..Row::default()
        });
        self.slot.extend_from_slice(&weights.index);
        self.weight.extend_from_slice(&weights.weight);
        self.start.push(self.slot.len() as u32);
    }

    /// Numbers the gas particles of all pairs in ascending order.
    fn number_slots(&mut self, window: &mut Vec<u32>) {
        self.gas.clear();
        if self.slot.is_empty() {
            return;
        }
        let ends = (u32::MAX, 0);
        let (first, last) = self
            .slot
            .iter()
            .fold(ends, |(lo, hi), &j| (lo.min(j), hi.max(j)));
        window.clear();
        window.resize((last - first + 1) as usize, 0);
        for &j in &self.slot {
            window[(j - first) as usize] = 1;
        }
        for (j, number) in (first..).zip(window.iter_mut()) {
            if *number == 1 {
                *number = self.gas.len() as u32;
                self.gas.push(j);
            }
        }
        for slot in &mut self.slot {
            *slot = window[(*slot - first) as usize];
        }
    }

    /// Mean velocity and isothermal sound speed around each row; the velocity relative to a shear.
    fn hear(&mut self, gas: &Gas, domain: &Domain) {
        let state = |&j: &u32| {
            let j = j as usize;
            let v = domain.relative(gas.particles.x[j], gas.rates.v_pred[j]);
            parcel(v, isothermal(gas, j))
        };
        self.partial.clear();
        self.partial.extend(self.gas.iter().map(state));
        for k in 0..self.rows.len() {
            let (mut sum, mut norm) = ([0.0; 4], 0.0);
            for (slot, w) in self.pairs(k) {
                let (state, w) = (&self.partial[slot], w.abs());
                (0..4).for_each(|n| sum[n] += w * state[n]);
                norm += w;
            }
            let row = &mut self.rows[k];
            // Without neighbours everything is zero, and the time to cross infinite.
            let norm = if norm > 0.0 { norm } else { 1.0 };
            (row.v_gas, row.c) = (vector(&sum, 0) / norm, (sum[3] / norm).sqrt());
        }
    }

    fn pairs(&self, row: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.start[row] as usize..self.start[row + 1] as usize;
        let weights = &self.weight[range.clone()];
        let slots = self.slot[range].iter().map(|&slot| slot as usize);
        slots.zip(weights.iter().copied())
    }

    /// Fields of the slots, at a row: vectors in the first three of each four columns.
    fn seen<const N: usize>(&self, row: usize, field: &[[f64; N]]) -> [f64; N] {
        let mut sum = [0.0; N];
        for (slot, w) in self.pairs(row) {
            let value = &field[slot];
            (0..N).for_each(|k| sum[k] += w * value[k]);
        }
        if self.rows[row].shape == Shape::Rigid {
            for first in (0..N).step_by(4) {
                let turned = self.turned(row, |slot| vector(&field[slot], first));
                (0..3).for_each(|k| sum[first + k] -= turned[k]);
            }
        }
        sum
    }

    /// Omega x b of a rigid shape.
    fn turned(&self, row: usize, field: impl Fn(usize) -> Vec3) -> Vec3 {
        let turn = &self.turns[self.rows[row].turn as usize];
        let spin: Vec3 = self
            .pairs(row)
            .zip(&self.arms[turn.first_arm..])
            .map(|((slot, w), arm)| w * arm.cross(&field(slot)))
            .sum();
        (turn.inverse_inertia * spin).cross(&turn.offset)
    }

    pub fn keep_smoothing<I: Immersed>(&self, immersed: &mut I, members: &[u32]) {
        for (row, &i) in self.rows.iter().zip(members) {
            immersed.keep_smoothing(i as usize, row.h, row.crossing);
        }
    }

    /// Spreads |w| m over the slots.
    pub fn spread_load(&mut self) {
        self.partial.clear();
        self.partial.resize(self.gas.len(), [0.0; 4]);
        for (k, row) in self.rows.iter().enumerate() {
            let range = self.start[k] as usize..self.start[k + 1] as usize;
            let load = row.m * row.gain;
            for (&slot, w) in self.slot[range.clone()].iter().zip(&self.weight[range]) {
                self.partial[slot as usize][0] += load * w.abs();
            }
        }
    }

    /// eps of each row, from the loads of the gas.
    pub fn gather_load(&mut self, touched: &super::Touched) {
        for (part, &place) in self.partial.iter_mut().zip(&self.place) {
            *part = touched.sums[place as usize];
        }
        for k in 0..self.rows.len() {
            let load = self
                .pairs(k)
                .map(|(slot, w)| w.abs() * self.partial[slot][0])
                .sum::<f64>();
            self.rows[k].eps = self.rows[k].gain * load;
        }
    }

    /// Each row's change of velocity, as if all gas around it changed by -eps times that.
    pub fn relax<I: Immersed>(
        &mut self,
        gas: &Gas,
        immersed: &I,
        (members, steps): (&[u32], &[f64]),
        half: Half,
        (settings, domain): (&Settings, &Domain),
    ) {
        // Relative to a shear, since neighbours may be images.
        let relative = |x: Vec3, v: Vec3| domain.relative(x, v);
        let turning = |w: Vec3| {
            domain
                .hill()
                .map_or_else(Vec3::zeros, |hill| hill.turning(w))
        };
        self.half = steps.iter().sum::<f64>() / steps.len() as f64;
        self.field.clear();
        self.field.extend(self.gas.iter().map(|&j| {
            let j = j as usize;
            let v = relative(gas.particles.x[j], gas.rates.v_pred[j]);
            let a = if settings.joint {
                gas.acceleration(j) + turning(v)
            } else {
                Vec3::zeros()
            };
            [v.x, v.y, v.z, 0.0, a.x, a.y, a.z, 0.0]
        }));
        for (k, (&i, &step)) in members.iter().zip(steps).enumerate() {
            let i = i as usize;
            let seen = self.seen(k, &self.field);
            let v_gas = vector(&seen, 0);
            let x = immersed.position(i);
            let v = relative(x, immersed.velocity(i));
            let a = match immersed.acceleration(i) {
                Some(a) if settings.joint => a + turning(v) - vector(&seen, 4),
                _ => Vec3::zeros(),
            };
            let row = &mut self.rows[k];
            (row.v_gas, row.x) = (v_gas, x);
            row.u_tick = v - v_gas;
            row.relax(&settings.law, immersed, i, (step, half), a);
        }
    }

    /// Spreads the reaction to each row's change, and its heat, over the slots.
    pub fn spread_impulse(&mut self) {
        self.spread(|row| (-row.m * row.dv, row.heat()));
    }

    /// Spreads the reaction to what each row expects of the other half of its step.
    pub fn spread_coming(&mut self) {
        self.spread(|row| (-row.m * row.coming, row.coming_heat));
    }

    /// Spreads an impulse and a heat of each row over the slots.
    fn spread(&mut self, of: impl Fn(&Row) -> (Vec3, f64)) {
        self.partial.clear();
        self.partial.resize(self.gas.len(), [0.0; 4]);
        for k in 0..self.rows.len() {
            let row = self.rows[k];
            let range = self.start[k] as usize..self.start[k + 1] as usize;
            let (reaction, heat) = of(&row);
            let [x, y, z, q] = parcel(reaction, heat);
            for (&slot, w) in self.slot[range.clone()].iter().zip(&self.weight[range]) {
                let part = &mut self.partial[slot as usize];
                part[0] += w * x;
                part[1] += w * y;
                part[2] += w * z;
                part[3] += w * q;
            }
            if row.shape == Shape::Rigid {
                self.spread_turn(k, reaction);
            }
        }
    }

    /// The part of a rigid shape's reaction that keeps the angular momentum.
    fn spread_turn(&mut self, k: usize, reaction: Vec3) {
        let turn = &self.turns[self.rows[k].turn as usize];
        let spin = turn.inverse_inertia * turn.offset.cross(&reaction);
        let range = self.start[k] as usize..self.start[k + 1] as usize;
        for (pair, arm) in range.zip(&self.arms[turn.first_arm..]) {
            let impulse = -self.weight[pair] * spin.cross(arm);
            let part = &mut self.partial[self.slot[pair] as usize];
            part[0] += impulse.x;
            part[1] += impulse.y;
            part[2] += impulse.z;
        }
    }

    /// Makes up for what the gas did beyond -eps dv.
    pub fn refine(&mut self, touched: &super::Touched) {
        for (part, &place) in self.partial.iter_mut().zip(&self.place) {
            *part = touched.sums[place as usize];
        }
        for k in 0..self.rows.len() {
            let gained = vector(&self.seen(k, &self.partial), 0);
            let row = &mut self.rows[k];
            row.dv += row.share * (gained + row.eps * row.dv);
        }
    }

    /// Gives the members their change of velocity.
    pub fn push<I: Immersed>(&self, immersed: &mut I, members: &[u32], booking: &mut Booking) {
        for (row, &i) in self.rows.iter().zip(members) {
            row.push(immersed, i as usize, booking);
            booking.rigid += usize::from(row.shape == Shape::Rigid);
            booking.plain += usize::from(row.shape == Shape::Plain);
            booking.without_gas += usize::from(row.shape == Shape::Empty);
        }
    }

    /// Books what a gas that feels no reaction would have got.
    pub fn give_away(&self, booking: &mut Booking) {
        self.rows.iter().for_each(|row| row.give_away(booking));
    }

    pub fn loads(&self) -> impl Iterator<Item = f64> {
        self.rows.iter().map(|row| 1.0 + row.eps)
    }
}
