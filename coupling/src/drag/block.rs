//! Block: a run of immersed particles with its weights, and its own copies ("slots") of the gas that they see.
//!
//! Everything a block writes is its own: sums over gas are formed slot by slot and added up over the blocks afterwards, in a fixed order.

mod passes;
mod several;

use std::cell::RefCell;

use dust::Sphere;
use gas::Gas;
use gas::probe::{Bundle, Candidates, Reach, Shape, Weights, isothermal, radius};
use nbody::points::{Domain, Vec3};

use super::bundles::Bundles;
use super::group::{Cell, Member, RUN, cut};
use super::kinds::{ByKind, Kinds};
use super::loose::Loose;
use super::row::{Outcome, Row, Wind};
use super::slots::Slots;
use super::{ABSOLUTE, Booking, Both, Immersed, Parcel};

/// Buffers of a thread while it works on a block.
#[derive(Default)]
struct Scratch {
    /// columns of a field of the slots, and at each row
    field: Vec<[f64; 8]>,
    sums: Vec<Parcel>,
    seen: Vec<[f64; 8]>,
    /// what rows are to give in the other half of their step, of no block
    coming: Vec<Parcel>,
    /// what the members do, by place
    motion: Vec<Motion>,
    /// masses and velocities of the members by place
    mass: Vec<f64>,
    velocity: Vec<Vec3>,
    /// what the exchange did to the members, by place
    outcome: Vec<Outcome>,
    /// Where members are relative to.
    origin: Vec3,
    members: Vec<Member>,
    /// by place: smoothing lengths of the members, and where that image of each is that is nearest to the origin
    lengths: Vec<f64>,
    images: Vec<Vec3>,
    cells: Vec<Cell>,
    candidates: Candidates,
    /// of a member that finds too little in the cell's
    own: Candidates,
    bundle: Bundle,
    weights: Weights,
    slots: Slots,
}

/// What a member is, and what it does: velocity relative to a shear or not, and acceleration.
#[derive(Clone, Copy)]
struct Motion {
    sphere: Sphere,
    v: Vec3,
    a: Option<Vec3>,
    /// what it expects of the gas
    excess: Vec3,
}

thread_local! {
    static SCRATCH: RefCell<Scratch> = RefCell::default();
}

#[derive(Clone, Debug, Default)]
pub struct Block {
    rows: Vec<Row>,
    /// Rows of particles from this on are bodies.
    bodies: u32,
    bundles: Bundles,
    loose: Loose,
    /// gas particle of each slot
    pub gas: Vec<u32>,
    /// place of each slot in the list of touched gas
    pub place: Vec<u32>,
    /// Sums over the pairs of each slot: of |w| m, of impulses and heat, and of these with those of the other half of the step.
    pub loads: Vec<f64>,
    pub partial: Vec<Parcel>,
    pub both: Vec<Both>,
    /// mean of the half steps of the rows
    pub half: f64,
    /// largest load of a row
    pub heaviest: f64,
    /// What rows are to give in the other half of their step; a buffer of the thread's, until it is spread.
    coming: Vec<Parcel>,
    /// Where grains differ: the kinds there are, and what each has at each slot.
    pub kinds: Kinds,
    pub by_kind: ByKind,
    /// by place: smoothing length of the gas around and the time to cross it; what the exchange did; and what the members ask for
    around: Vec<[f64; 2]>,
    outcome: Vec<Outcome>,
    wind: Vec<Wind>,
    /// what the exchange moved
    pub booking: Booking,
}

/// Three columns from `first` on.
fn vector(columns: &[f64], first: usize) -> Vec3 {
    Vec3::new(columns[first], columns[first + 1], columns[first + 2])
}

/// How far beyond its last neighbourhood a particle first looks, by its radius.
const MARGIN: f64 = 1.1;

/// Members without a smoothing length begin with that of another within so many of it.
const NEAR: f64 = 0.5;

/// Fewest members that are bundled.
const FEWEST: usize = 4;

impl Block {
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// Finds the gas around the members.
    pub fn link<I: Immersed>(
        &mut self,
        gas: &Gas,
        immersed: &I,
        members: &[u32],
        (domain, reach): (&Domain, &Reach),
    ) {
        self.bodies = immersed.bodies();
        SCRATCH.with_borrow_mut(|scratch| {
            self.list(gas, immersed, members, (domain, reach), scratch);
            for c in 0..scratch.cells.len() {
                self.link_cell(gas, scratch.cells[c], (domain, reach), scratch);
            }
            let slots = &mut scratch.slots;
            slots.clear(gas.len());
            self.bundles.name(|j| slots.mark(j));
            self.loose.name(|j| slots.mark(j));
            slots.number(&mut self.gas);
            self.bundles.name(|j| *j = slots.of(*j));
            self.loose.name(|j| *j = slots.of(*j));
            self.place.resize(self.gas.len(), 0);
            self.hear(gas, domain, scratch);
        });
    }

    /// Brings the members into order; those without a smoothing length get one.
    fn list<I: Immersed>(
        &mut self,
        gas: &Gas,
        immersed: &I,
        members: &[u32],
        (domain, reach): (&Domain, &Reach),
        scratch: &mut Scratch,
    ) {
        self.bundles.clear();
        self.loose.clear();
        scratch.members.clear();
        scratch.lengths.clear();
        scratch.images.clear();
        scratch.mass.clear();
        scratch.velocity.clear();
        let first = members.first().map(|&i| immersed.position(i as usize));
        scratch.origin = first.unwrap_or_default();
        // The last that was looked for, and its smoothing length.
        let mut found: Option<(Vec3, f64)> = None;
        for (&i, place) in members.iter().zip(0..) {
            let (x, mut h) = (
                immersed.position(i as usize),
                immersed.smoothing(i as usize),
            );
            if h <= 0.0 {
                let near = found.filter(|&(y, h)| domain.nearest(x - y).norm() <= NEAR * h);
                let weights = &mut scratch.weights;
                (_, h) = *found.insert(near.unwrap_or_else(|| {
                    weights.find(&mut scratch.own, gas, domain, (x, h), reach);
                    (x, weights.h)
                }));
            }
            let from = x - scratch.origin;
            let nearest = domain.nearest(from);
            let relative: [f64; 3] = nearest.into();
            let x32 = relative.map(|x| x as f32);
            scratch.members.push(Member { x: x32, place });
            scratch.lengths.push(h);
            scratch.images.push(x + (nearest - from));
            scratch.mass.push(immersed.mass(i as usize));
            scratch.velocity.push(immersed.velocity(i as usize));
        }
        scratch.cells.clear();
        let (h, cells) = (&scratch.lengths, &mut scratch.cells);
        cut(&mut scratch.members, (h, domain), cells);
        self.rows.clear();
        self.rows.extend(scratch.members.iter().map(|member| {
            let i = members[member.place as usize];
            Row {
                place: member.place,
                i,
                m: scratch.mass[member.place as usize],
                x: immersed.position(i as usize),
                h: scratch.lengths[member.place as usize],
                ..Row::default()
            }
        }));
    }

    fn link_cell(
        &mut self,
        gas: &Gas,
        cell: Cell,
        (domain, reach): (&Domain, &Reach),
        scratch: &mut Scratch,
    ) {
        let available = radius(domain, (MARGIN * cell.h).min(reach.largest));
        let Scratch {
            candidates,
            bundle,
            weights,
            own,
            images,
            ..
        } = scratch;
        let (lo, hi) = (cell.lo + scratch.origin, cell.hi + scratch.origin);
        candidates.gather(gas, domain, lo, hi, available);
        if cell.end - cell.first >= FEWEST {
            bundle.enter(candidates, available);
        }
        for first in (cell.first..cell.end).step_by(RUN) {
            let count = RUN.min(cell.end - first);
            let mut points = [(Vec3::zeros(), 0.0); RUN];
            for (point, row) in points.iter_mut().zip(&self.rows[first..first + count]) {
                *point = (images[row.place as usize], row.h);
            }
            let points = &points[..count];
            let served = if count >= FEWEST {
                let bundles = &mut self.bundles;
                let points = (points, available);
                bundles.fit(bundle, candidates, (domain, reach), points, first)
            } else {
                0
            };
            for (lane, &point) in points.iter().enumerate() {
                let row = &mut self.rows[first + lane];
                if served >> lane & 1 == 1 {
                    (row.h, row.rho) = (bundle.h[lane], bundle.rho[lane]);
                    (row.shape, row.gain) = (Shape::Linear, 1.0);
                    row.absolute = bundle.absolute[lane];
                    continue;
                }
                if !weights.fit(candidates, domain, point, available, reach) {
                    weights.find(own, gas, domain, point, reach);
                }
                (row.h, row.rho) = (weights.h, weights.rho);
                (row.shape, row.gain) = (weights.shape, weights.gain);
                row.absolute = weights.weight.iter().map(|w| w.abs()).sum();
                self.loose.add(weights, first + lane);
            }
        }
    }

    /// Sound speed around each row, and the time to cross its smoothing length, by the velocity relative to a shear.
    fn hear(
        &mut self,
        gas: &Gas,
        domain: &Domain,
        Scratch {
            sums,
            seen,
            velocity,
            ..
        }: &mut Scratch,
    ) {
        sums.clear();
        sums.extend(self.gas.iter().map(|&j| {
            let j = j as usize;
            let v = domain.relative(gas.particles.x[j], gas.rates.v_pred[j]);
            [v.x, v.y, v.z, isothermal(gas, j)]
        }));
        empty(seen, self.rows.len(), [0.0; 8]);
        self.bundles.seen::<4, 4>(sums, seen);
        self.loose.seen(sums, seen);
        self.around.resize(self.rows.len(), [0.0; 2]);
        for (row, seen) in self.rows.iter_mut().zip(&*seen) {
            let v = domain.relative(row.x, velocity[row.place as usize]);
            row.hear(v - vector(seen, 0), seen[ABSOLUTE]);
            self.around[row.place as usize] = [row.h, row.crossing];
        }
    }

    pub fn keep_smoothing<I: Immersed>(&self, immersed: &mut I, members: &[u32]) {
        for (&i, &[h, crossing]) in members.iter().zip(&self.around) {
            immersed.keep_smoothing(i as usize, h, crossing);
        }
    }

    /// Asks the members for their masses.
    pub fn weigh<I: Immersed>(&mut self, immersed: &I) {
        for row in &mut self.rows {
            row.m = immersed.mass(row.i as usize);
        }
    }

    /// Spreads |w| m over the slots.
    pub fn spread_load(&mut self) {
        empty(&mut self.loads, self.gas.len(), 0.0);
        let of = |row: usize| self.rows[row].m * self.rows[row].gain;
        self.bundles.load(of, &mut self.loads);
        self.loose.load(of, &mut self.loads);
    }
}

/// Makes a column `n` times the same.
fn empty<T: Copy>(column: &mut Vec<T>, n: usize, value: T) {
    column.clear();
    column.resize(n, value);
}

#[cfg(test)]
mod tests;
