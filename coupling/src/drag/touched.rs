//! Touched gas: the gas particles that have pairs, and the sums over the blocks that they are in.

use gas::Gas;
use rayon::prelude::*;

use super::block::Block;
use super::{Booking, Parcel, Vec3};

#[derive(Clone, Debug, Default)]
pub struct Touched {
    /// (gas particle, block, slot in the block), ascending
    entries: Vec<(u32, u32, u32)>,
    /// gas particle
    gas: Vec<u32>,
    /// first entry of each gas particle, and the end
    start: Vec<u32>,
    /// sum over the pairs by the mass of the gas particle
    pub sums: Vec<Parcel>,
}

impl Touched {
    /// Lists the gas of all blocks and tells the blocks where each of their slots is in the list.
    pub fn list(&mut self, blocks: &mut [Block]) {
        self.entries.clear();
        for (b, block) in blocks.iter().enumerate() {
            let slots = block.gas.iter().enumerate();
            self.entries
                .extend(slots.map(|(slot, &j)| (j, b as u32, slot as u32)));
        }
        self.entries.par_sort_unstable();
        self.gas.clear();
        self.start.clear();
        for (e, &(j, block, slot)) in self.entries.iter().enumerate() {
            if self.gas.last() != Some(&j) {
                self.gas.push(j);
                self.start.push(e as u32);
            }
            blocks[block as usize].place[slot as usize] = (self.gas.len() - 1) as u32;
        }
        self.start.push(self.entries.len() as u32);
        self.sums.clear();
        self.sums.resize(self.gas.len(), [0.0; 4]);
    }

    /// Adds up what the blocks have spread.
    pub fn sum(&mut self, blocks: &[Block], gas: &Gas) {
        let (entries, start, places) = (&self.entries, &self.start, &self.gas);
        self.sums
            .par_iter_mut()
            .enumerate()
            .with_min_len(1024)
            .for_each(|(t, sum)| {
                let mut total = [0.0; 4];
                for &(_, block, slot) in &entries[start[t] as usize..start[t + 1] as usize] {
                    let part = &blocks[block as usize].partial[slot as usize];
                    (0..4).for_each(|k| total[k] += part[k]);
                }
                let inverse = 1.0 / gas.particles.m[places[t] as usize];
                *sum = total.map(|x| x * inverse);
            });
    }

    /// Gives the gas its change of velocity and its heat.
    pub fn push(&self, gas: &mut Gas, heat_share: f64, booking: &mut Booking) {
        let (particles, rates) = (&mut gas.particles, &mut gas.rates);
        for (&j, &[x, y, z, heat]) in self.gas.iter().zip(&self.sums) {
            let (j, dv) = (j as usize, Vec3::new(x, y, z));
            let m = particles.m[j];
            // The grains booked their heat as if the gas kept its velocity.
            let heat = heat - 0.5 * dv.norm_squared();
            booking.gas.add((particles.x[j], rates.v_pred[j]), m, dv);
            booking.heat += m * heat_share * heat;
            booking.radiated += m * (1.0 - heat_share) * heat;
            particles.v[j] += dv;
            rates.v_pred[j] += dv;
            particles.u[j] += heat_share * heat;
            rates.u_pred[j] += heat_share * heat;
        }
    }
}
