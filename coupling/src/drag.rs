//! Drag: the exchange of momentum and energy between immersed particles (grains, bodies) and the gas around them.
//!
//! u_i = v_i - sum_j w_ij v_j, w from [`gas::probe`]. Over a half step s with the relative acceleration a_i of everything but drag,
//!     u(s) = u(0) e^-x + b s (1 - e^-x)/x,  x = (1 + eps_i) s / t_i,  eps_i = sum_j |w_ij| sum_k m_k |w_kj| / m_j,
//! grain i takes the impulse m_i d_i, d_i = (u(s) - u(0) - b s) / (1 + eps_i), and gas j takes -w_ij m_i d_i. All grains act at once on one
//! state of the gas. 1 + eps bounds the row sums of u' = -(1 + S) u/t (Gershgorin), so kinetic energy falls for any s / t; in uniform fields
//! the exchange is exact, of particles of several stopping times by what `kinds` adds. What the gas then did beyond -eps_i d_i is made up for
//! by a second pass (deferred correction), so that it is of second order for mixtures and any positions, too. In long steps that leaves r^2
//! of an error, r = (eps - S)/(1 + eps): hence b_i = a_i - c_i, c_i what the gas was last found to do so, as far as drag balances forces,
//! which lasts, and does not brake, which decays. Each half step then takes grains nearer to their terminal velocity a t / (1 + S), by r, and
//! stiff drag is of second order, too. Momentum and angular momentum are kept to round-off; the lost kinetic energy is heat, spread over a
//! grain's neighbours by weight.
//! Velocities are those predicted to this tick (`v_pred`): a closing half step ends now and its kick is in them, an opening one begins
//! now and its kick is not; whether kick or drag is done first does not matter. The half step's kick itself is done elsewhere.

mod block;
mod bodies;
mod booking;
mod bundles;
mod course;
mod group;
mod immersed;
mod kinds;
mod loose;
mod mixed;
mod operators;
mod prescribed;
mod relaxation;
mod response;
mod row;
mod slots;
mod touched;

use gas::Gas;
use gas::probe::Reach;
use nbody::points::{Clock, Domain, Vec3};
use rayon::prelude::*;

pub use bodies::BodyDrag;
pub use booking::{Booking, Change};
pub use dust::{Ambient, StoppingLaw};
pub use immersed::{BodiesInGas, Grains, Immersed, Star};
pub use mixed::Mixed;
pub use operators::DustDrag;
pub use prescribed::{DustInDisk, Ties};

use block::Block;
use group::RUN;
use kinds::{Family, Kinds};
use row::Row;
use touched::Touched;

/// Which half of its step a particle does at a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Half {
    /// The second half, which ends now.
    Closing,
    /// The first half, which begins now.
    Opening,
}

/// How drag acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    pub law: StoppingLaw,
    pub reach: Reach,
    /// Whether the gas feels the reaction.
    pub feedback: bool,
    /// Share of the frictional heat that the gas keeps; the rest is radiated.
    pub heat_share: f64,
    /// Whether the gas is bound to a temperature: it gives off all heat.
    pub bound: bool,
    /// Whether drag and the kick of the half step are solved together.
    pub joint: bool,
    /// Whether particles differ in their stopping times in the same gas, so that what they do to each other through it is solved, too.
    pub several: bool,
    /// Whether grains are all alike: then that is so only where bodies push the gas.
    pub alike: bool,
}

impl Settings {
    /// Drag by `law` with reaction, all heat in the gas, solved together with the kick.
    pub fn new(law: StoppingLaw, reach: Reach) -> Self {
        Self {
            law,
            reach,
            feedback: true,
            heat_share: 1.0,
            bound: false,
            joint: true,
            several: false,
            alike: false,
        }
    }
}

/// Fewest and most immersed particles a block, and how many blocks there are between.
const BLOCK: [usize; 2] = [512, 4096];
const BLOCKS: usize = 128;

/// Immersed particles a block where `n` are active: nothing else fixes the blocks, so that results do not depend on threads.
fn length(n: usize) -> usize {
    let own = (n / BLOCKS).next_multiple_of(RUN);
    own.clamp(BLOCK[0], BLOCK[1])
}

/// The pairs of the active particles at a tick, and the buffers of the exchange.
#[derive(Clone, Debug)]
pub struct Exchange {
    pub settings: Settings,
    active: Vec<u32>,
    blocks: Vec<Block>,
    used: usize,
    /// members a block
    length: usize,
    touched: Touched,
    /// Whether the sums over the touched gas are the loads of the prepared particles.
    fresh: bool,
    /// The domain as it was prepared for.
    domain: Domain,
}

impl Exchange {
    pub fn new(settings: Settings) -> Self {
        assert!(
            settings.reach.largest.is_finite() && settings.reach.largest > 0.0,
            "drag looks for gas within a finite reach"
        );
        Self {
            settings,
            active: Vec::new(),
            blocks: Vec::new(),
            used: 0,
            length: BLOCK[0],
            touched: Touched::default(),
            fresh: false,
            domain: Domain::open(),
        }
    }

    /// Finds the gas around the `active` particles, once a tick; positions and density of the gas are those of now.
    ///
    /// Fast if neighbours in the list are neighbours in space.
    pub fn prepare<I: Immersed>(
        &mut self,
        gas: &Gas,
        immersed: &mut I,
        active: &[u32],
        domain: &Domain,
    ) {
        self.domain = *domain;
        self.active.clear();
        self.active.extend_from_slice(active);
        self.length = length(active.len());
        self.used = active.len().div_ceil(self.length);
        if self.blocks.len() < self.used {
            self.blocks.resize_with(self.used, Block::default);
        }
        let (settings, seen) = (&self.settings, &*immersed);
        self.blocks[..self.used]
            .par_iter_mut()
            .zip(active.par_chunks(self.length))
            .for_each(|(block, members)| {
                block.link(gas, seen, members, (domain, &settings.reach));
                if settings.feedback {
                    block.spread_load();
                }
            });
        for (block, members) in self.blocks[..self.used]
            .iter()
            .zip(active.chunks(self.length))
        {
            block.keep_smoothing(immersed, members);
        }
        if settings.feedback {
            let blocks = &mut self.blocks[..self.used];
            self.touched.list(blocks, gas);
            self.touched.sum_loads(blocks, gas);
            self.fresh = true;
        }
    }

    /// The rows of the prepared particles, as the last exchange left them.
    fn rows(&self) -> impl Iterator<Item = &Row> {
        self.blocks[..self.used].iter().flat_map(Block::rows)
    }

    /// Learns the masses anew, if they have changed since the exchange was prepared.
    pub fn reweigh<I: Immersed>(&mut self, gas: &Gas, immersed: &I) {
        let blocks = &mut self.blocks[..self.used];
        let feedback = self.settings.feedback;
        blocks.par_iter_mut().for_each(|block| {
            block.weigh(immersed);
            if feedback {
                block.spread_load();
            }
        });
        if feedback {
            self.touched.sum_loads(blocks, gas);
            self.fresh = true;
        }
    }

    /// [`Exchange::exchange`], after new masses are learned if there are any.
    fn act<I: Immersed>(
        &mut self,
        gas: &mut Gas,
        immersed: &mut I,
        steps: &[f64],
        when: (Half, &Clock),
        reweighed: bool,
    ) -> Booking {
        if reweighed {
            self.reweigh(gas, immersed);
        }
        self.exchange(gas, immersed, steps, when)
    }

    /// The largest load of the last exchange.
    fn heaviest(&self) -> f64 {
        let blocks = self.blocks[..self.used].iter();
        blocks.fold(0.0, |most, block| most.max(block.heaviest))
    }

    /// Drag over the half steps `steps` of the active particles, as they were given to [`Exchange::prepare`], at the tick of `clock`.
    pub fn exchange<I: Immersed>(
        &mut self,
        gas: &mut Gas,
        immersed: &mut I,
        steps: &[f64],
        (half, clock): (Half, &Clock),
    ) -> Booking {
        assert_eq!(
            steps.len(),
            self.active.len(),
            "a half step for each prepared particle"
        );
        let blocks = &mut self.blocks[..self.used];
        let (settings, domain) = (&self.settings, &self.domain);
        let (seen, see) = (&*immersed, &*gas);
        let fresh = std::mem::take(&mut self.fresh);
        let loads = fresh.then_some(self.touched.loads.as_slice());
        let (active, length) = (&self.active, self.length);
        blocks
            .par_iter_mut()
            .zip(active.par_chunks(length).zip(steps.par_chunks(length)))
            .for_each(|(block, (members, steps))| {
                let seen = (seen, members);
                block.relax(see, seen, loads, (steps, half), (settings, domain));
                if settings.feedback && !settings.several {
                    block.spread(half);
                }
                if !settings.feedback {
                    block.settle(seen, (settings, domain));
                }
            });
        if settings.feedback {
            if settings.several {
                let steps = (steps, length, half);
                let gas = (see, domain.dimensions() as i32);
                consider_kinds(blocks, &mut self.touched, gas, (steps, settings.alike));
                blocks.par_iter_mut().for_each(|block| block.spread(half));
            }
            match half {
                Half::Closing => self.touched.sum_impulses(blocks, see),
                Half::Opening => self.touched.sum_both(blocks, see),
            }
            let sums = &self.touched.sums;
            blocks
                .par_iter_mut()
                .zip(active.par_chunks(length))
                .for_each(|(block, members)| {
                    block.refine(sums);
                    block.settle((seen, members), (settings, domain));
                });
            self.touched.sum_again(blocks, see);
        }
        let mut booking = Booking::default();
        for (block, members) in blocks.iter().zip(active.chunks(length)) {
            booking += block.booking;
            block.push(immersed, members);
        }
        if settings.feedback {
            let when = (domain, half, clock);
            self.touched.push(gas, settings, when, &mut booking);
            if half == Half::Opening {
                let time = clock.time();
                (self.touched).expect(gas, blocks, settings.heat_share, time);
            }
        }
        booking
    }
}

/// Lets the rows of all blocks respond to what particles of other stopping times do, `length` half steps a block.
fn consider_kinds(
    blocks: &mut [Block],
    touched: &mut Touched,
    (gas, dimensions): (&Gas, i32),
    ((steps, length, half), alike): ((&[f64], usize, Half), bool),
) {
    let own = |blocks: &mut [Block], pass: &(dyn Fn(&mut Block, &[f64]) + Sync)| {
        let both = blocks.par_iter_mut().zip(steps.par_chunks(length));
        both.for_each(|(block, steps)| pass(block, steps));
    };
    own(blocks, &|block, steps| block.find_kinds(steps, dimensions));
    let kinds = (blocks.iter()).fold(Kinds::default(), |all, block| all.with(block.kinds));
    if kinds.count() < 2 || alike && !kinds.has(Family::Bodies) {
        return;
    }
    own(blocks, &|block, steps| {
        block.spread_kinds(kinds, (steps, half))
    });
    touched.respond(blocks, gas, kinds.count());
    let responses = &touched.responses;
    own(blocks, &|block, steps| {
        block.respond(kinds, (steps, half), responses)
    });
}

/// A sum over the pairs of one gas particle: momentum, energy.
type Parcel = [f64; 4];

/// That of one half of a step and that of the other.
type Both = [f64; 8];

/// The column of a field that is seen by |w|.
const ABSOLUTE: usize = 3;

#[cfg(test)]
mod tests;
