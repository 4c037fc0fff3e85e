//! Coagulation: growth of grains by collisions, by the Monte Carlo method of representative particles.
//!
//! The grain that superparticle i stands for meets those of swarm j of its cell at the rate n_j K_ij, n_j = M_j / (m_j V) whatever the masses M of
//! the swarms (Zsom & Dullemond 2008, A&A 489, 931; unequal ones: Beutel & Dullemond 2023, A&A 670, A134), K = pi (s_1 + s_2)^2 v. Each swarm keeps
//! its mass: a change of grain i changes their number. In a cell of n the others stand for all: n_j counts n/(n - 1) times, the own swarm not.
//! Waiting times are exponential, one collision after the other: no time step. They come from bounds on the rates; a collision
//! is then refused with the chance that makes the rate right. Grains lighter than a part (`together`) of m_i are met many at once, as
//! many times more rarely. The gas is that of the cell's mean and stays as it is for the time asked.
//! A swarm keeps its velocity, whatever its grains do: so momentum and energy of the dust stay as they are. A grain cannot outweigh its swarm:
//! what would make it so does not happen, and is counted.

mod cell;
mod cells;
mod law;

use std::ops::Add;

use nbody::points::random::{Purpose, stream};
use nbody::points::sum::{self, Parts};

pub use cell::MOST;
pub use cells::{CELL, Cell, Cells};

use crate::outcome::{Outcome, Rules};
use crate::porosity::Monomers;
use crate::relative_speed::Sources;
use crate::{Dust, StoppingLaw};
use cell::{After, Swarms};
use law::{Formula, Power};

/// How often grains meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kernel {
    /// K is this.
    Constant(f64),
    /// K is this times m_1 + m_2.
    Sum(f64),
    /// K is this times m_1 m_2.
    Product(f64),
    /// Cross section times relative speed, with all that collisions do.
    Physical(Physics),
}

/// What collisions of real grains follow from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Physics {
    pub sources: Sources,
    pub rules: Rules,
    /// None: volumes add up.
    pub porosity: Option<Monomers>,
    pub law: StoppingLaw,
    /// Whether impact speeds are spread as Maxwell's, with the relative speed as root mean square; else they are that.
    pub spread: bool,
}

/// What a superparticle's place says: orbital frequency, and height above the plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Place {
    pub omega: f64,
    pub height: f64,
}

/// What has happened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Collisions by outcome, in the order of [`Outcome::ALL`].
    pub collisions: [u64; 5],
    /// Collisions drawn from the bounds, refused ones with them.
    pub drawn: u64,
    /// Collisions that did not happen since the grain would have outweighed its swarm.
    pub whole: u64,
    /// Superparticles in cells without a volume, where nothing meets.
    pub flat: u64,
    /// Cells that were left with more collisions to come than can be drawn.
    pub crowded: u64,
}

impl Tally {
    pub fn total(&self) -> u64 {
        self.collisions.iter().sum()
    }

    fn count(&mut self, outcome: Outcome) {
        self.collisions[outcome as usize] += 1;
    }
}

impl Add for Tally {
    type Output = Self;

    fn add(self, o: Self) -> Self {
        Self {
            collisions: std::array::from_fn(|k| self.collisions[k] + o.collisions[k]),
            drawn: self.drawn + o.drawn,
            whole: self.whole + o.whole,
            flat: self.flat + o.flat,
            crowded: self.crowded + o.crowded,
        }
    }
}

/// Cells a task.
const TASK: usize = 64;

/// Coagulation of a set of superparticles.
#[derive(Clone, Debug)]
pub struct Coagulation {
    pub kernel: Kernel,
    pub seed: u64,
    pub cells: Cells,
    /// Grains after the step, in the order of the cells' members; and which cells have any that changed.
    after: Vec<After>,
    changed: Vec<bool>,
}

impl Coagulation {
    pub fn new(kernel: Kernel, seed: u64) -> Self {
        Self {
            kernel,
            seed,
            cells: Cells::default(),
            after: Vec::new(),
            changed: Vec::new(),
        }
    }

    /// Lets the grains of each cell collide for `dt`; `step` is a number that no other call of the run has.
    pub fn advance(
        &mut self,
        dust: &mut Dust,
        place: &(impl Fn(usize) -> Place + Sync),
        dt: f64,
        step: u64,
    ) -> Tally {
        assert_eq!(
            self.cells.len(),
            dust.len(),
            "cells of the superparticles that there are"
        );
        self.after.resize(self.cells.len(), After::default());
        self.changed.resize(self.cells.cells.len(), false);
        let (after, changed) = (Parts::new(&mut self.after), Parts::new(&mut self.changed));
        let (cells, seed, seen) = (&self.cells, self.seed, &*dust);
        let kernel = &self.kernel;
        let tally = sum::ordered_by(TASK, cells.cells.len(), Tally::default(), |range| {
            let mut swarms = Box::<Swarms>::default();
            range.fold(Tally::default(), |sum, c| {
                let cell = &cells.cells[c];
                let members = cell.first as usize..cell.end as usize;
                swarms.gather(seen, cells.places(cell), cell.volume);
                let mut random = stream(seed, Purpose::Growth, swarms.id(), step);
                let tally = match *kernel {
                    Kernel::Constant(rate) => swarms.advance(
                        &Power {
                            rate,
                            law: |_, _| 1.0,
                        },
                        dt,
                        &mut random,
                    ),
                    Kernel::Sum(rate) => swarms.advance(
                        &Power {
                            rate,
                            law: |a, b| a + b,
                        },
                        dt,
                        &mut random,
                    ),
                    Kernel::Product(rate) => swarms.advance(
                        &Power {
                            rate,
                            law: |a, b| a * b,
                        },
                        dt,
                        &mut random,
                    ),
                    Kernel::Physical(ref physics) => {
                        let formula = Formula::new(physics, &mut swarms, seen, place);
                        formula.map_or_else(Tally::default, |formula| {
                            swarms.advance(&formula, dt, &mut random)
                        })
                    }
                };
                // SAFETY: cells have members of their own, and each is visited once.
                let (after, changed) = unsafe { (after.part(members), changed.part(c..c + 1)) };
                changed[0] = swarms.changed;
                if swarms.changed {
                    swarms.write(after);
                }
                sum + tally
            })
        });
        self.scatter(dust);
        tally
    }

    /// Gives the superparticles their new grains.
    fn scatter(&self, dust: &mut Dust) {
        let (particles, derived) = (&mut dust.particles, &mut dust.derived);
        let cells = self.cells.cells.iter().zip(&self.changed);
        for (cell, _) in cells.filter(|(_, changed)| **changed) {
            let after = &self.after[cell.first as usize..cell.end as usize];
            for (i, after) in self.cells.places(cell).zip(after) {
                particles.grain_radius[i] = after.radius;
                particles.grain_density[i] = after.density;
                if let Some([t_stop, stokes]) = after.stopping {
                    (derived.t_stop[i], derived.stokes[i]) = (t_stop, stokes);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
