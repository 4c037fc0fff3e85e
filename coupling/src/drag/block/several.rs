//! Several kinds: the passes of a block in which grains that differ learn of each other.

use super::{Block, SCRATCH, Scratch, empty, vector};
use crate::drag::Half;
use crate::drag::kinds::{ByKind, Family, Kinds, LARGEST, Sums};
use crate::drag::row::Row;

/// The largest load with which the response is taken whole. Of scattered grains kinds see different means of the gas around, and gas that is light
/// by them throws these differences back: from a load of 16 on they grow.
const MODERATE: f64 = 4.0;

/// E-foldings of a row in a half step, were the gas at rest.
fn folds(row: &Row, step: f64) -> f64 {
    (step / row.t_stop).min(LARGEST)
}

/// Momentum that a grain and a body give to the gas around in a half step, by that of this gas at the same speed, from which on they make a kind:
/// what is lost is second order of that. Bodies' kinds cost the grains beside them several times what one kind of grains costs.
const LEAST: [f64; 2] = [1e-8, 1e-5];

/// What a row is, where particles from `bodies` on are bodies.
fn family(row: &Row, bodies: u32) -> Family {
    match row.i < bodies {
        true => Family::Grains,
        false => Family::Bodies,
    }
}

/// The kind of a row with `x` e-foldings.
fn kind(row: &Row, bodies: u32, x: f64) -> Kinds {
    Kinds::of(family(row, bodies), x)
}

impl Block {
    /// Finds the kinds of the rows, in so many dimensions.
    pub fn find_kinds(&mut self, steps: &[f64], dimensions: i32) {
        let mut kinds = Kinds::default();
        for row in &self.rows {
            let x = folds(row, steps[row.place as usize]);
            let least = LEAST[family(row, self.bodies) as usize];
            if row.m * x.min(1.0) > least * row.rho * row.h.powi(dimensions) {
                kinds = kinds.with(kind(row, self.bodies, x));
            }
        }
        self.kinds = kinds;
    }

    /// Spreads over the slots, by kind, what rows have at the start of their half step.
    pub fn spread_kinds(&mut self, kinds: Kinds, (steps, half): (&[f64], Half)) {
        let bodies = self.bodies;
        self.by_kind.clear(self.gas.len(), kinds.count());
        let of = |row: usize| {
            let row = &self.rows[row];
            let x = folds(row, steps[row.place as usize]);
            let (start, kick) = row.start(half);
            let (u, f) = (row.m * start, row.m * (kick - row.expected));
            let load = row.m * row.gain;
            let sums: Sums = [u.x, u.y, u.z, load, f.x, f.y, f.z, load * x];
            let number = kinds.number(kind(row, bodies, x));
            number.map_or((0, Sums::default()), |number| (number, sums))
        };
        self.bundles.spread_kinds(of, &mut self.by_kind);
        self.loose.spread_kinds(of, &mut self.by_kind);
    }

    /// Lets the rows respond to what others do differently; `responses` are those of the touched gas. What they are to give in the other half of a step
    /// follows as far as the response lasts.
    pub fn respond(&mut self, kinds: Kinds, (steps, half): (&[f64], Half), responses: &ByKind) {
        let bodies = self.bodies;
        SCRATCH.with_borrow_mut(|Scratch { seen, .. }| {
            empty(seen, self.rows.len(), [0.0; 8]);
            let own = |row: &Row| {
                let x = folds(row, steps[row.place as usize]);
                kinds.number(kind(row, bodies, x))
            };
            let of = |row: usize| own(&self.rows[row]).unwrap_or(0);
            let field = (self.place.as_slice(), responses);
            self.bundles.seen_kinds(of, field, seen);
            self.loose.seen_kinds(of, field, seen);
            for (row, seen) in self.rows.iter().zip(&mut *seen) {
                if own(row).is_none() {
                    *seen = [0.0; 8];
                }
            }
            for ((row, seen), coming) in self.rows.iter_mut().zip(&*seen).zip(&mut self.coming) {
                let part = (MODERATE / row.eps).min(1.0);
                let more = part * vector(seen, 0);
                row.dv += more;
                // The gas does this beyond -eps dv.
                let beyond = part * vector(seen, 4) + row.eps * more;
                row.expected += beyond;
                if half == Half::Opening {
                    let (start, kick) = row.start(half);
                    let slip = start + 1.5 * kick + (1.0 + row.eps) * row.dv - beyond;
                    let impulse = -row.m * row.kept(steps[row.place as usize]) * more;
                    let given = [impulse.x, impulse.y, impulse.z, impulse.dot(&slip)];
                    coming
                        .iter_mut()
                        .zip(given)
                        .for_each(|(sum, given)| *sum += given);
                }
            }
        });
    }
}
