//! Cell: the swarms of one cell in columns, the bounds on the rates at which they meet, and their collisions one after the other.

use fearless_simd::Level;
use nbody::points::Vec3;
use rand::{Rng, RngExt};

use super::{CELL, Tally};
use crate::Dust;
use crate::outcome::Outcome;
use crate::porosity::Aggregate;

/// A column of a cell; what lies behind the last member has no mass.
pub type Column = [f64; CELL];

/// Collisions of a cell in a call beyond which none is drawn: minutes of computing.
pub const MOST: f64 = 1e9;

/// A grain after the step; stopping time and Stokes number where they are known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct After {
    pub radius: f64,
    pub density: f64,
    pub stopping: Option<[f64; 2]>,
}

/// What grains of a cell do when they meet.
pub trait Law {
    /// The most of others that an event takes together, by the part of the grain's mass that they may have.
    const TOGETHER: f64;

    /// Brings what follows from the grain of a member up to date.
    fn describe(&self, swarms: &mut Swarms, i: usize);

    /// A bound on K.
    fn bound(&self, swarms: &Swarms, i: usize, j: usize) -> f64;

    /// How much heavier than j the mass is that an event with one of j moves.
    fn leverage(&self) -> f64;

    /// What becomes of the grain of i that meets `many` of j; none if the draw from the bound is refused.
    fn collision(
        &self,
        swarms: &Swarms,
        pair: (usize, usize),
        many: f64,
        random: &mut impl Rng,
    ) -> Option<(Aggregate, Outcome)>;
}

/// Lanes of a sum.
const LANES: usize = 8;

/// Sum of a column, lane by lane and then of the lanes: an order that wide registers keep.
#[inline(always)]
fn total(column: &Column) -> f64 {
    let mut lanes = [0.0; LANES];
    for part in column.chunks_exact(LANES) {
        for (lane, x) in lanes.iter_mut().zip(part) {
            *lane += x;
        }
    }
    lanes.iter().sum()
}

/// The swarms of a cell.
#[derive(Clone, Debug)]
pub struct Swarms {
    pub n: usize,
    ids: [u64; CELL],
    pub places: [usize; CELL],
    /// mass of the swarm
    pub mass: Column,
    /// mass, volume and radius of a grain
    pub m: Column,
    pub volume: Column,
    pub radius: Column,
    /// how many grains there are of the swarm in a unit of volume
    pub number: Column,
    pub t_stop: Column,
    pub stokes: Column,
    pub u: [Vec3; CELL],
    /// velocity relative to the gas as resolved
    pub slip: [Vec3; CELL],
    pub slow: Column,
    pub stirred: Column,
    /// inverse volume, by the part of the members that others are
    dilution: f64,
    /// density of the swarm
    spread: Column,
    /// bounds on the rates of i with j, and their sums over j
    rates: Vec<Column>,
    sums: Column,
    pub changed: bool,
}

impl Default for Swarms {
    fn default() -> Self {
        let none = [0.0; CELL];
        Self {
            n: 0,
            ids: [0; CELL],
            places: [0; CELL],
            mass: none,
            m: [1.0; CELL],
            volume: [1.0; CELL],
            radius: none,
            number: none,
            t_stop: none,
            stokes: none,
            u: [Vec3::zeros(); CELL],
            slip: [Vec3::zeros(); CELL],
            slow: none,
            stirred: none,
            dilution: 0.0,
            spread: none,
            rates: vec![none; CELL],
            sums: none,
            changed: false,
        }
    }
}

impl Swarms {
    /// Takes up the members of a cell.
    pub fn gather(
        &mut self,
        dust: &Dust,
        places: impl ExactSizeIterator<Item = usize>,
        volume: f64,
    ) {
        self.n = places.len();
        self.changed = false;
        let n = self.n as f64;
        self.dilution = match self.n > 1 && volume > 0.0 {
            true => n / ((n - 1.0) * volume),
            false => 0.0,
        };
        let p = &dust.particles;
        for (k, i) in places.enumerate() {
            (self.places[k], self.ids[k], self.mass[k]) = (i, p.id[i], p.m[i]);
            self.spread[k] = p.m[i] * self.dilution;
            self.put(k, Aggregate::new(p.grain_radius[i], p.grain_density[i]));
            self.radius[k] = p.grain_radius[i];
        }
        self.spread[self.n..].fill(0.0);
        self.sums[self.n..].fill(0.0);
        self.number[self.n..].fill(0.0);
    }

    /// The identity that the cell's random numbers go by.
    pub fn id(&self) -> u64 {
        self.ids[..self.n].iter().copied().min().unwrap_or(0)
    }

    pub fn grain(&self, i: usize) -> Aggregate {
        Aggregate {
            m: self.m[i],
            volume: self.volume[i],
        }
    }

    /// Gives member `i` another grain.
    pub fn put(&mut self, i: usize, grain: Aggregate) {
        (self.m[i], self.volume[i]) = (grain.m, grain.volume);
        self.number[i] = self.spread[i] / grain.m;
    }

    pub fn write(&self, after: &mut [After]) {
        for (k, after) in after.iter_mut().enumerate() {
            let stopping = (self.stokes[k] >= 0.0 && self.t_stop[k] > 0.0)
                .then_some([self.t_stop[k], self.stokes[k]]);
            *after = After {
                radius: self.radius[k],
                density: self.grain(k).density(),
                stopping,
            };
        }
    }

    /// Collisions for `dt`.
    pub fn advance<L: Law>(&mut self, law: &L, dt: f64, random: &mut impl Rng) -> Tally {
        let mut tally = Tally::default();
        if self.dilution == 0.0 {
            // Alone, or flat.
            tally.flat = if self.n > 1 { self.n as u64 } else { 0 };
            return tally;
        }
        for i in 0..self.n {
            law.describe(self, i);
        }
        let level = Level::new();
        nbody::widest!(level, _simd => self.meet_all(law));
        let mut now = 0.0;
        loop {
            let total = total(&self.sums);
            if total * (dt - now) > MOST {
                tally.crowded = 1;
                return tally;
            }
            now -= (1.0 - random.random::<f64>()).ln() / total;
            // Not a number where nothing ever meets.
            if now.is_nan() || now >= dt {
                return tally;
            }
            tally.drawn += 1;
            let pair = self.pair(total * random.random::<f64>());
            let many = self.many(law, pair);
            let Some((grain, outcome)) = law.collision(self, pair, many, random) else {
                continue;
            };
            let i = pair.0;
            if grain.m > self.mass[i] {
                tally.whole += 1;
                continue;
            }
            tally.count(outcome);
            if outcome != Outcome::Bouncing {
                self.changed = true;
                self.put(i, grain);
                self.radius[i] = grain.radius();
                law.describe(self, i);
                nbody::widest!(level, _simd => self.met_again(law, i));
            }
        }
    }

    /// How many of j an event of i takes together.
    fn many<L: Law>(&self, law: &L, (i, j): (usize, usize)) -> f64 {
        (L::TOGETHER * self.m[i] / (law.leverage() * self.m[j])).max(1.0)
    }

    /// Bound on the rate at which i has an event with j.
    #[inline(always)]
    fn rate<L: Law>(&self, law: &L, i: usize, j: usize, least: f64) -> f64 {
        // n_j by how many are taken together.
        self.number[j].min(least * self.spread[j]) * law.bound(self, i, j)
    }

    /// The bounds of i with all others.
    #[inline(always)]
    fn meet<L: Law>(&mut self, law: &L, i: usize) {
        let least = law.leverage() / (L::TOGETHER * self.m[i]);
        let mut row = [0.0; CELL];
        for (j, rate) in row.iter_mut().enumerate() {
            *rate = self.rate(law, i, j, least);
        }
        row[i] = 0.0;
        self.sums[i] = total(&row);
        self.rates[i] = row;
    }

    #[inline(always)]
    fn meet_all<L: Law>(&mut self, law: &L) {
        for i in 0..self.n {
            self.meet(law, i);
        }
    }

    /// The bounds after the grain of i has changed.
    #[inline(always)]
    fn met_again<L: Law>(&mut self, law: &L, i: usize) {
        self.meet(law, i);
        for k in (0..self.n).filter(|&k| k != i) {
            let least = law.leverage() / (L::TOGETHER * self.m[k]);
            self.rates[k][i] = self.rate(law, k, i, least);
            // Summed anew: differences of large rates would leave their round-off.
            self.sums[k] = total(&self.rates[k]);
        }
    }

    /// The pair that a number between zero and the sum of all rates means.
    fn pair(&self, mut level: f64) -> (usize, usize) {
        let mut found = (0, 0);
        for i in (0..self.n).filter(|&i| self.sums[i] > 0.0) {
            if level < self.sums[i] {
                found = (i, 0);
                break;
            }
            level -= self.sums[i];
            // Round-off may lead beyond the last.
            found = (i, 0);
        }
        let row = &self.rates[found.0];
        for j in (0..self.n).filter(|&j| row[j] > 0.0) {
            found.1 = j;
            if level < row[j] {
                break;
            }
            level -= row[j];
        }
        found
    }
}
