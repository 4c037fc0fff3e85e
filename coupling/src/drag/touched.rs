//! Touched gas: the gas particles that have pairs, and the sums over the blocks that they are in.

use fearless_simd::Level;
use gas::Gas;
use gas::lean::Coming;
use nbody::points::{Clock, Domain};
use rayon::prelude::*;

use super::block::Block;
use super::kinds::{ByKind, Sums, numbers};
use super::response::{ABREAST, Columns, respond};
use super::{Booking, Both, Half, Parcel, Settings, Vec3};

const NOWHERE: u32 = u32::MAX;

/// How many of those that are present, a bit each, come before a kind.
fn below(kind: usize, present: u64) -> usize {
    (present & ((1 << kind) - 1)).count_ones() as usize
}

#[derive(Clone, Debug, Default)]
pub struct Touched {
    /// (block, slot in the block), by gas particle, then by block
    entries: Vec<(u32, u32)>,
    /// gas particle, in the order in which the blocks name them
    gas: Vec<u32>,
    /// first entry of each gas particle, and the end
    start: Vec<u32>,
    /// place of each gas particle in the list; nowhere between calls
    known: Vec<u32>,
    next: Vec<u32>,
    /// Sums over the pairs by the mass of the gas particle: of |w| m,
    pub loads: Vec<[f64; 1]>,
    /// of impulses and heat,
    pub sums: Vec<Parcel>,
    /// of these in the pass before,
    before: Vec<Parcel>,
    /// and of these with those of the other half of the step.
    both: Vec<Both>,
    /// What each kind of grains has at each gas particle, and then how both respond.
    pub responses: ByKind,
}

impl Touched {
    /// Lists the gas of all blocks and tells the blocks where each of their slots is in the list.
    pub fn list(&mut self, blocks: &mut [Block], gas: &Gas) {
        self.gas.clear();
        self.next.clear();
        self.known.resize(gas.len(), NOWHERE);
        for block in &mut *blocks {
            for (&j, place) in block.gas.iter().zip(&mut block.place) {
                let known = &mut self.known[j as usize];
                if *known == NOWHERE {
                    *known = self.gas.len() as u32;
                    self.gas.push(j);
                    self.next.push(0);
                }
                *place = *known;
                self.next[*place as usize] += 1;
            }
        }
        self.start.clear();
        let mut total = 0;
        for (&j, next) in self.gas.iter().zip(&mut self.next) {
            self.known[j as usize] = NOWHERE;
            self.start.push(total);
            (*next, total) = (total, total + *next);
        }
        self.start.push(total);
        self.entries.resize(total as usize, (0, 0));
        for (b, block) in blocks.iter().enumerate() {
            for (slot, &place) in block.place.iter().enumerate() {
                let next = &mut self.next[place as usize];
                self.entries[*next as usize] = (b as u32, slot as u32);
                *next += 1;
            }
        }
    }

    /// Adds up the loads that the blocks have spread.
    pub fn sum_loads(&mut self, blocks: &[Block], gas: &Gas) {
        let mut sums = std::mem::take(&mut self.loads);
        self.sum(&mut sums, gas, |block, slot| [blocks[block].loads[slot]]);
        self.loads = sums;
    }

    /// Adds up the impulses and heat that the blocks have spread.
    pub fn sum_impulses(&mut self, blocks: &[Block], gas: &Gas) {
        let mut sums = std::mem::take(&mut self.sums);
        self.sum(&mut sums, gas, |block, slot| blocks[block].partial[slot]);
        self.sums = sums;
    }

    /// Adds them up anew, and keeps those that there were.
    pub fn sum_again(&mut self, blocks: &[Block], gas: &Gas) {
        std::mem::swap(&mut self.sums, &mut self.before);
        self.sum_impulses(blocks, gas);
    }

    /// Adds up those of both halves of a step.
    pub fn sum_both(&mut self, blocks: &[Block], gas: &Gas) {
        let mut sums = std::mem::take(&mut self.both);
        self.sum(&mut sums, gas, |block, slot| blocks[block].both[slot]);
        self.sums.clear();
        let now = sums.iter().map(|&[x, y, z, e, ..]| [x, y, z, e]);
        self.sums.extend(now);
        self.both = sums;
    }

    /// Adds up what each of `kinds` kinds has at the gas, and lets them respond.
    pub fn respond(&mut self, blocks: &[Block], gas: &Gas, kinds: usize) {
        let mut responses = std::mem::take(&mut self.responses);
        responses.clear(self.gas.len(), kinds);
        let runs = responses.runs(ABREAST);
        runs.zip(self.gas.par_chunks(ABREAST).enumerate())
            .with_min_len(32)
            .for_each_init(
                || (Vec::new(), Vec::new()),
                |(sums, columns), (own, (run, gas_of_run))| {
                    let first = run * ABREAST;
                    let present = (self.parts(blocks, first, gas_of_run.len()))
                        .fold(0, |all, (parts, slot)| all | parts.present(slot));
                    // All lanes have a place for what is at any.
                    columns.clear();
                    columns.resize(present.count_ones() as usize, Columns::default());
                    for (lane, &j) in gas_of_run.iter().enumerate() {
                        sums.clear();
                        sums.resize(columns.len(), Sums::default());
                        for (parts, slot) in self.parts(blocks, first + lane, 1) {
                            for (kind, part) in parts.there(slot) {
                                let sums = &mut sums[below(kind, present)];
                                (0..8).for_each(|k| sums[k] += part[k]);
                            }
                        }
                        let inverse = 1.0 / gas.particles.m[j as usize];
                        for (columns, sums) in columns.iter_mut().zip(&*sums) {
                            (0..8).for_each(|k| columns[k][lane] = inverse * sums[k]);
                        }
                    }
                    nbody::widest!(Level::new(), simd => respond(simd, columns));
                    for (lane, own) in own.chunks_mut(kinds).enumerate() {
                        for (kind, columns) in numbers(present).zip(&*columns) {
                            own[kind] = columns.map(|column| column[lane]);
                        }
                    }
                },
            );
        self.responses = responses;
    }

    /// Of each of the blocks that gas particles `first..first + count` are in, what its kinds have and where that is.
    fn parts<'a>(
        &self,
        blocks: &'a [Block],
        first: usize,
        count: usize,
    ) -> impl Iterator<Item = (&'a ByKind, usize)> {
        let entries = self.start[first] as usize..self.start[first + count] as usize;
        let entries = self.entries[entries].iter();
        entries.map(|&(block, slot)| (&blocks[block as usize].by_kind, slot as usize))
    }

    /// Adds up a number of columns of all slots of a gas particle, by its mass.
    fn sum<const N: usize>(
        &self,
        sums: &mut Vec<[f64; N]>,
        gas: &Gas,
        of: impl Fn(usize, usize) -> [f64; N] + Sync,
    ) {
        sums.resize(self.gas.len(), [0.0; N]);
        let (entries, start, places) = (&self.entries, &self.start, &self.gas);
        sums.par_iter_mut()
            .enumerate()
            .with_min_len(1024)
            .for_each(|(t, sum)| {
                let mut total = [0.0; N];
                for &(block, slot) in &entries[start[t] as usize..start[t + 1] as usize] {
                    let part = of(block as usize, slot as usize);
                    (0..N).for_each(|k| total[k] += part[k]);
                }
                let inverse = 1.0 / gas.particles.m[places[t] as usize];
                *sum = total.map(|x| x * inverse);
            });
    }

    /// Lets the gas know what it is to receive at the ends of steps that begin at `time`.
    pub fn expect(&self, gas: &mut Gas, blocks: &[Block], heat_share: f64, time: f64) {
        gas.expect_drag();
        for (t, (&j, &[.., x, y, z, heat])) in self.gas.iter().zip(&self.both).enumerate() {
            let entries = &self.entries[self.start[t] as usize..self.start[t + 1] as usize];
            let halves = entries
                .iter()
                .map(|&(block, _)| blocks[block as usize].half);
            let dv = Vec3::new(x, y, z);
            gas.expect_impulse(
                j as usize,
                time,
                Coming {
                    dv,
                    du: heat_share * (heat - 0.5 * dv.norm_squared()),
                    half: halves.sum::<f64>() / entries.len() as f64,
                },
            );
        }
    }

    /// Gives the gas its change of velocity and its heat.
    pub fn push(
        &self,
        gas: &mut Gas,
        &Settings {
            heat_share, bound, ..
        }: &Settings,
        (domain, half, clock): (&Domain, Half, &Clock),
        booking: &mut Booking,
    ) {
        let sums = self.sums.iter().zip(&self.before);
        for (&j, (&[x, y, z, heat], &[x0, y0, z0, _])) in self.gas.iter().zip(sums) {
            let (j, dv) = (j as usize, Vec3::new(x, y, z));
            let foreseen = match half {
                Half::Closing => gas.has_come(j, clock.time()),
                Half::Opening => Vec3::zeros(),
            };
            let (particles, rates) = (&mut gas.particles, &mut gas.rates);
            let m = particles.m[j];
            // The grains booked their heat as if the gas changed as in the pass before.
            let heat = heat - 0.5 * dv.dot(&(dv - Vec3::new(x0, y0, z0)));
            booking.gas.add((particles.x[j], rates.v_pred[j]), m, dv);
            let kept = if bound { 0.0 } else { heat_share };
            booking.heat += m * kept * heat;
            booking.radiated += m * (1.0 - kept) * heat;
            let change = match domain.hill() {
                // Between its ticks gas keeps the mean velocity of its step.
                Some(hill) if !(clock.synchronous() || particles.end[j] == clock.tick) => {
                    hill.pushed(dv, clock.phase(particles.begin[j], particles.span[j]))
                }
                _ => dv,
            };
            booking.frame += m * (change - dv);
            particles.v[j] += change;
            rates.v_pred[j] += dv;
            let mut warmed = kept * heat;
            if half == Half::Closing && (clock.synchronous() || particles.end[j] == clock.tick) {
                // Pressure has worked on the velocity that was foreseen between its half steps.
                let work = (dv - foreseen).dot(&(rates.dv_close[j] + rates.dv_open[j]));
                warmed -= work;
            }
            if bound {
                booking.work += m * warmed;
            } else {
                particles.u[j] += warmed;
                rates.u_pred[j] += warmed;
            }
        }
    }
}
