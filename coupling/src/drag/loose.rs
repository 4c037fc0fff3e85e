//! Loose rows: immersed particles whose weights stand by themselves, because they are at an edge of the gas or share it with too few others.

use fearless_simd::{Level, Simd, SimdBase, SimdFloat, f64x4, f64x8};
use gas::probe::{Shape, Weights};
use nalgebra::Matrix3;
use nbody::points::Vec3;

use super::kinds::{ByKind, Sums};
use super::{ABSOLUTE, Both, Parcel};

/// What a rigid shape adds to the weights.
#[derive(Clone, Copy, Debug)]
struct Turn {
    offset: Vec3,
    inverse_inertia: Matrix3<f64>,
    /// from its first pair's on
    first_arm: usize,
}

/// A row and the end of its pairs.
#[derive(Clone, Copy, Debug)]
struct Own {
    row: usize,
    start: usize,
    end: usize,
    /// Place of its rigid shape, if it has one.
    turn: Option<u32>,
}

#[derive(Clone, Debug, Default)]
pub struct Loose {
    own: Vec<Own>,
    slot: Vec<u32>,
    weight: Vec<f64>,
    turns: Vec<Turn>,
    arms: Vec<Vec3>,
}

/// Three columns from `first` on.
fn vector(columns: &[f64], first: usize) -> Vec3 {
    Vec3::new(columns[first], columns[first + 1], columns[first + 2])
}

impl Loose {
    pub fn clear(&mut self) {
        self.own.clear();
        self.slot.clear();
        self.weight.clear();
        self.turns.clear();
        self.arms.clear();
    }

    /// Shows the slots of all pairs; they are gas particles until they are numbered.
    pub fn name(&mut self, slot: impl FnMut(&mut u32)) {
        self.slot.iter_mut().for_each(slot);
    }

    /// Appends a row.
    pub fn add(&mut self, weights: &Weights, row: usize) {
        let start = self.slot.len();
        self.slot.extend_from_slice(&weights.index);
        self.weight.extend_from_slice(&weights.weight);
        let rigid = weights.shape == Shape::Rigid;
        self.own.push(Own {
            row,
            start,
            end: self.slot.len(),
            turn: rigid.then_some(self.turns.len() as u32),
        });
        if rigid {
            self.turns.push(Turn {
                offset: weights.offset,
                inverse_inertia: weights.inverse_inertia,
                first_arm: self.arms.len(),
            });
            self.arms.extend_from_slice(&weights.arm);
        }
    }

    fn pairs(&self, own: &Own) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = own.start..own.end;
        let slots = self.slot[range.clone()].iter().map(|&slot| slot as usize);
        slots.zip(self.weight[range].iter().copied())
    }

    /// The columns of a field of the slots, at each row: vectors in the first three of each four columns; the fourth by |w|.
    pub fn seen<const N: usize>(&self, field: &[[f64; N]], seen: &mut [[f64; 8]]) {
        nbody::widest!(Level::new(), simd => self.gather(simd, field, seen, #[inline(always)] |w: f64| {
            let mut first = [w; 4];
            first[ABSOLUTE] = w.abs();
            [first; 2]
        }));
        for own in self.own.iter().filter(|own| own.turn.is_some()) {
            for first in (0..N).step_by(4) {
                let turned = self.turned(own, |slot| vector(&field[slot], first));
                (0..3).for_each(|k| seen[own.row][first + k] -= turned[k]);
            }
        }
    }

    #[inline(always)]
    fn gather<S: Simd, const N: usize>(
        &self,
        simd: S,
        field: &[[f64; N]],
        seen: &mut [[f64; 8]],
        of: impl Fn(f64) -> [[f64; 4]; 2],
    ) {
        for own in &self.own {
            // Four sums, so that one addition does not wait for the other.
            let mut sums = [[f64x4::splat(simd, 0.0); 4]; 2];
            let range = own.start..own.end;
            let slots = self.slot[range.clone()].chunks(4);
            for (slots, weights) in slots.zip(self.weight[range].chunks(4)) {
                for (k, (&slot, &w)) in slots.iter().zip(weights).enumerate() {
                    let values = field[slot as usize].chunks(4);
                    for ((sums, w), value) in sums.iter_mut().zip(&of(w)).zip(values) {
                        let w = f64x4::from_slice(simd, w);
                        sums[k] = w.mul_add(f64x4::from_slice(simd, value), sums[k]);
                    }
                }
            }
            for (sums, seen) in sums.iter().zip(seen[own.row].chunks_mut(4)).take(N / 4) {
                ((sums[0] + sums[1]) + (sums[2] + sums[3])).store_slice(seen);
            }
        }
    }

    /// Omega x b of a rigid shape.
    fn turned(&self, own: &Own, field: impl Fn(usize) -> Vec3) -> Vec3 {
        let Some(turn) = own.turn.map(|turn| &self.turns[turn as usize]) else {
            return Vec3::zeros();
        };
        let spin: Vec3 = self
            .pairs(own)
            .zip(&self.arms[turn.first_arm..])
            .map(|((slot, w), arm)| w * arm.cross(&field(slot)))
            .sum();
        (turn.inverse_inertia * spin).cross(&turn.offset)
    }

    /// Adds w times what each row gives to the slots; the first three columns are an impulse.
    pub fn spread(&self, of: impl Fn(usize) -> Parcel, partial: &mut [Parcel]) {
        nbody::widest!(Level::new(), simd => self.spread_lanes::<_, f64x4<_>, 4>(simd, &of, partial));
        self.spread_turns(of, partial);
    }

    /// The same for what each row gives now and in the other half of its step.
    pub fn spread_both(&self, of: impl Fn(usize) -> Both, partial: &mut [Both]) {
        nbody::widest!(Level::new(), simd => self.spread_lanes::<_, f64x8<_>, 8>(simd, &of, partial));
        self.spread_turns(of, partial);
    }

    #[inline(always)]
    fn spread_lanes<S: Simd, V: SimdFloat<S, Element = f64>, const N: usize>(
        &self,
        simd: S,
        of: &impl Fn(usize) -> [f64; N],
        partial: &mut [[f64; N]],
    ) {
        for own in &self.own {
            let given = V::from_slice(simd, &of(own.row));
            for (slot, w) in self.pairs(own) {
                let part = &mut partial[slot];
                let sum = V::from_slice(simd, part);
                V::splat(simd, w).mul_add(given, sum).store_slice(part);
            }
        }
    }

    /// The parts of rigid shapes' reactions that keep the angular momentum.
    fn spread_turns<const N: usize>(
        &self,
        of: impl Fn(usize) -> [f64; N],
        partial: &mut [[f64; N]],
    ) {
        for own in &self.own {
            let Some(turn) = own.turn.map(|turn| &self.turns[turn as usize]) else {
                continue;
            };
            let given = of(own.row);
            for first in (0..N).step_by(4) {
                let spin = turn.inverse_inertia * turn.offset.cross(&vector(&given, first));
                for ((slot, w), arm) in self.pairs(own).zip(&self.arms[turn.first_arm..]) {
                    let impulse = -w * spin.cross(arm);
                    let part = &mut partial[slot];
                    (0..3).for_each(|k| part[first + k] += impulse[k]);
                }
            }
        }
    }

    /// Adds w times what each row gives, |w| times the last of each four columns, to those of its kind at the slots. Rigid shapes
    /// act as if they did not turn.
    pub fn spread_kinds(&self, of: impl Fn(usize) -> (usize, Sums), sums: &mut ByKind) {
        for own in &self.own {
            let (kind, given) = of(own.row);
            for (slot, w) in self.pairs(own) {
                let sums = sums.with(slot, 1 << kind)[kind].iter_mut().zip(given);
                for (k, (sum, given)) in sums.enumerate() {
                    *sum += if k % 4 == ABSOLUTE { w.abs() } else { w } * given;
                }
            }
        }
    }

    /// The columns of each row's kind, at it; the field is by place, that of each slot.
    pub fn seen_kinds(
        &self,
        of: impl Fn(usize) -> usize,
        (place, field): (&[u32], &ByKind),
        seen: &mut [Sums],
    ) {
        for own in &self.own {
            let kind = of(own.row);
            for (slot, w) in self.pairs(own) {
                let seen = seen[own.row].iter_mut();
                seen.zip(field.at(place[slot] as usize)[kind])
                    .for_each(|(sum, value)| *sum += w * value);
            }
        }
    }

    /// Adds |w| times what each row weighs to the slots.
    pub fn load(&self, of: impl Fn(usize) -> f64, loads: &mut [f64]) {
        for own in &self.own {
            let load = of(own.row);
            for (slot, w) in self.pairs(own) {
                loads[slot] += load * w.abs();
            }
        }
    }
}
