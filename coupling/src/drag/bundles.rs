//! Bundles: the weights of immersed particles that share their gas, eight at once, and sums over them.

use fearless_simd::{Level, Select, Simd, SimdBase, SimdFloat, SimdMask, f64x4, f64x8, mask64x8};
use gas::probe::{Bundle, Candidates, Lanes, Reach, Rows};
use nbody::points::{Domain, Vec3};

use super::group::RUN;
use super::kinds::{ByKind, Sums};
use super::{ABSOLUTE, Both, Parcel};

/// Rows from `row` on, those in the lanes `served` alone, with the weights `start..end` by their sums.
#[derive(Clone, Copy, Debug)]
struct Lot {
    row: usize,
    served: u8,
    norm: Lanes,
    start: usize,
    end: usize,
}

#[derive(Clone, Debug, Default)]
pub struct Bundles {
    lots: Vec<Lot>,
    /// slots and weights
    rows: Rows,
}

/// The most gas particles that the rows of a lot may share: beyond, most weights would be zeros.
const WIDEST: usize = 320;

/// The columns that are spread by |w|, a bit each; nothing in them is negative.
const UNSIGNED: u64 = 0b1000_1000;

impl Lot {
    fn lanes(&self) -> impl Iterator<Item = usize> {
        let served = self.served;
        (0..RUN).filter(move |lane| served >> lane & 1 == 1)
    }
}

impl Bundles {
    pub fn clear(&mut self) {
        self.lots.clear();
        self.rows.clear();
    }

    /// Shows the slots of all weights; they are gas particles until they are numbered.
    pub fn name(&mut self, slot: impl FnMut(&mut u32)) {
        self.rows.index_mut().iter_mut().for_each(slot);
    }

    /// Finds weights for the `points` of the rows from `row` on; those that got some are set in the answer.
    pub fn fit(
        &mut self,
        bundle: &mut Bundle,
        candidates: &Candidates,
        (domain, reach): (&Domain, &Reach),
        points: (&[(Vec3, f64)], f64),
        row: usize,
    ) -> u8 {
        let start = self.rows.len();
        let served = bundle.fit(candidates, domain, points, (reach, WIDEST), &mut self.rows);
        if served != 0 {
            self.lots.push(Lot {
                row,
                served,
                norm: bundle.norm,
                start,
                end: self.rows.len(),
            });
        }
        served
    }

    /// The weights of a lot, and their slots.
    fn weights(&self, lot: &Lot) -> impl Iterator<Item = (&Lanes, &u32)> {
        let range = lot.start..lot.end;
        let slots = &self.rows.index()[range.clone()];
        self.rows.weight()[range].iter().zip(slots)
    }

    /// The first M columns of a field of the slots, at each row; the fourth of each four by |w|.
    pub fn seen<const M: usize, const N: usize>(&self, field: &[[f64; N]], seen: &mut [[f64; 8]]) {
        nbody::widest!(Level::new(), simd => self.gather::<_, M, N>(simd, field, seen, #[inline(always)] |k, w| if k % 4 == ABSOLUTE { w.abs() } else { w }));
    }

    #[inline(always)]
    fn gather<S: Simd, const M: usize, const N: usize>(
        &self,
        simd: S,
        field: &[[f64; N]],
        seen: &mut [[f64; 8]],
        of: impl Fn(usize, f64x8<S>) -> f64x8<S>,
    ) {
        for lot in &self.lots {
            let mut sums = [f64x8::splat(simd, 0.0); M];
            for (weight, &slot) in self.weights(lot) {
                let w = f64x8::from_slice(simd, weight);
                let value = &field[slot as usize];
                for (k, (sum, &value)) in sums.iter_mut().zip(value).enumerate() {
                    *sum = of(k, w).mul_add(f64x8::splat(simd, value), *sum);
                }
            }
            let mut columns = [[0.0; RUN]; M];
            let norm = f64x8::from_slice(simd, &lot.norm);
            for (column, sum) in columns.iter_mut().zip(sums) {
                (sum * norm).store_slice(column);
            }
            for lane in lot.lanes() {
                let seen = &mut seen[lot.row + lane];
                (0..M).for_each(|k| seen[k] = columns[k][lane]);
            }
        }
    }

    /// Adds w times what each row gives to the slots.
    pub fn spread(&self, of: impl Fn(usize) -> Parcel, partial: &mut [Parcel]) {
        nbody::widest!(Level::new(), simd => self.spread_lanes::<_, f64x4<_>, 4>(simd, &of, partial));
    }

    /// The same for what each row gives now and in the other half of its step.
    pub fn spread_both(&self, of: impl Fn(usize) -> Both, partial: &mut [Both]) {
        nbody::widest!(Level::new(), simd => self.spread_lanes::<_, f64x8<_>, 8>(simd, &of, partial));
    }

    #[inline(always)]
    fn spread_lanes<S: Simd, V: SimdFloat<S, Element = f64>, const N: usize>(
        &self,
        simd: S,
        of: &impl Fn(usize) -> [f64; N],
        partial: &mut [[f64; N]],
    ) {
        for lot in &self.lots {
            let mut given = [V::splat(simd, 0.0); RUN];
            for lane in lot.lanes() {
                given[lane] = V::from_slice(simd, &of(lot.row + lane)) * lot.norm[lane];
            }
            for (weight, &slot) in self.weights(lot) {
                let part = &mut partial[slot as usize];
                let mut sum = V::from_slice(simd, part);
                for (&w, given) in weight.iter().zip(given) {
                    sum = V::splat(simd, w).mul_add(given, sum);
                }
                sum.store_slice(part);
            }
        }
    }

    /// Adds w times what each row gives, |w| times the last of each four columns, to those of its kind at the slots.
    pub fn spread_kinds(&self, of: impl Fn(usize) -> (usize, Sums), sums: &mut ByKind) {
        nbody::widest!(Level::new(), simd => self.spread_kinds_lanes(simd, &of, sums));
    }

    #[inline(always)]
    fn spread_kinds_lanes<S: Simd>(
        &self,
        simd: S,
        of: &impl Fn(usize) -> (usize, Sums),
        sums: &mut ByKind,
    ) {
        let unsigned = mask64x8::from_bitmask(simd, UNSIGNED);
        for lot in &self.lots {
            let mut given = [(0, f64x8::splat(simd, 0.0)); RUN];
            // What has no kind gives nothing to the first.
            let mut added = 1;
            for lane in lot.lanes() {
                let (kind, own) = of(lot.row + lane);
                added |= 1 << kind;
                given[lane] = (kind, f64x8::from_slice(simd, &own) * lot.norm[lane]);
            }
            for (weight, &slot) in self.weights(lot) {
                let sums = sums.with(slot as usize, added);
                for (&w, &(kind, given)) in weight.iter().zip(&given) {
                    let part = given * w;
                    let part = unsigned.select(part.abs(), part);
                    let sums = &mut sums[kind];
                    (f64x8::from_slice(simd, sums) + part).store_slice(sums);
                }
            }
        }
    }

    /// The columns of each row's kind, at it; the field is by place, that of each slot.
    pub fn seen_kinds(
        &self,
        of: impl Fn(usize) -> usize,
        field: (&[u32], &ByKind),
        seen: &mut [Sums],
    ) {
        nbody::widest!(Level::new(), simd => self.gather_kinds(simd, &of, field, seen));
    }

    #[inline(always)]
    fn gather_kinds<S: Simd>(
        &self,
        simd: S,
        of: &impl Fn(usize) -> usize,
        (place, field): (&[u32], &ByKind),
        seen: &mut [Sums],
    ) {
        for lot in &self.lots {
            let mut sums = [(0, f64x8::splat(simd, 0.0)); RUN];
            for lane in lot.lanes() {
                sums[lane].0 = of(lot.row + lane);
            }
            for (weight, &slot) in self.weights(lot) {
                let field = field.at(place[slot as usize] as usize);
                for (&w, (kind, sum)) in weight.iter().zip(&mut sums) {
                    let w = f64x8::splat(simd, w);
                    *sum = w.mul_add(f64x8::from_slice(simd, &field[*kind]), *sum);
                }
            }
            for lane in lot.lanes() {
                (sums[lane].1 * lot.norm[lane]).store_slice(&mut seen[lot.row + lane]);
            }
        }
    }

    /// Adds |w| times what each row weighs to the slots.
    pub fn load(&self, of: impl Fn(usize) -> f64, loads: &mut [f64]) {
        nbody::widest!(Level::new(), simd => self.load_lanes(simd, &of, loads));
    }

    #[inline(always)]
    fn load_lanes<S: Simd>(&self, simd: S, of: &impl Fn(usize) -> f64, loads: &mut [f64]) {
        for lot in &self.lots {
            let mut weighs = [0.0; RUN];
            lot.lanes()
                .for_each(|lane| weighs[lane] = of(lot.row + lane) * lot.norm[lane]);
            let weighs = f64x8::from_slice(simd, &weighs);
            for (weight, &slot) in self.weights(lot) {
                let weight = f64x8::from_slice(simd, weight).abs();
                loads[slot as usize] += (weight * weighs).reduce_sum();
            }
        }
    }
}
