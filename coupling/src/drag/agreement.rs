//! Agreement: the changes of all grains at once, when each answers to what the others do to their common gas.
//!
//! A row's change d is right for the gas that it sees if d_i = alone_i + share_i (g_i + eps_i d_i), g = -S d what the gas around it gains; after one
//! correction that holds up to second order in s/t. For the rest, c_i d_i + (S d)_i = alone_i / share_i with c_i = 1/share_i - eps_i >= 1 is solved by
//! conjugate gradients: S is symmetric in the product sum m d d', and with share as preconditioner the rounds needed grow as sqrt(1 + eps) at most
//! (Saad 2003, Iterative Methods for Sparse Linear Systems, algorithm 9.1). Loosely coupled or uniform grains need none.

use gas::Gas;
use nbody::points::Vec3;
use rayon::prelude::*;

use super::block::{Block, vector};
use super::touched::Touched;

/// Most rounds of an exchange.
const MOST: usize = 200;

/// Sums over rows: of m r^2/share, m r^2 and m d^2, r what is lacking of agreement.
type Lack = [f64; 3];

/// Brings the rows of all blocks to agreement within `tolerance` of their changes, root mean square; `touched` holds what the gas gains of the changes
/// so far, and in the end.
pub fn settle(blocks: &mut [Block], touched: &mut Touched, gas: &Gas, tolerance: f64) {
    let mut lack = over(blocks, |block| block.lack(touched));
    let enough = tolerance * tolerance * lack[2];
    if lack[1] <= enough {
        return;
    }
    let mut beta = 0.0;
    for _ in 0..MOST {
        blocks.par_iter_mut().for_each(|block| block.search(beta));
        touched.sum(blocks, gas);
        let [curvature, ..] = over(blocks, |block| block.curvature(touched));
        let alpha = lack[0] / curvature;
        let left = over(blocks, |block| block.advance(alpha));
        beta = left[0] / lack[0];
        lack = left;
        if lack[1] <= enough {
            break;
        }
    }
    blocks.par_iter_mut().for_each(Block::spread_impulse);
    touched.sum(blocks, gas);
}

/// A sum over blocks, each of which may change.
fn over(blocks: &mut [Block], of: impl Fn(&mut Block) -> Lack + Sync) -> Lack {
    blocks
        .par_iter_mut()
        .for_each(|block| block.lack = of(block));
    let add = |sum: Lack, block: &Block| std::array::from_fn(|k| sum[k] + block.lack[k]);
    blocks.iter().fold([0.0; 3], add)
}

impl Block {
    /// What each row's change lacks of agreement.
    fn lack(&mut self, touched: &Touched) -> Lack {
        self.hear_of(touched);
        let mut sum = [0.0; 3];
        for k in 0..self.rows.len() {
            let gained = vector(&self.seen(k, &self.partial), 0);
            let row = &mut self.rows[k];
            row.lack = row.alone + row.share * (gained + row.eps * row.dv) - row.dv;
            if row.share > 0.0 {
                let square = row.m * row.lack.norm_squared();
                sum[0] += square / row.share;
                sum[1] += square;
            }
            sum[2] += row.m * row.dv.norm_squared();
        }
        sum
    }

    /// Turns the direction of search towards what is lacking, and spreads it.
    fn search(&mut self, beta: f64) {
        for row in &mut self.rows {
            // Without drag there is nothing to agree on.
            row.search = match row.share > 0.0 {
                true => row.lack + beta * row.search,
                false => Vec3::zeros(),
            };
        }
        self.spread(|row| (-row.m * row.search, 0.0));
    }

    /// The product of search, matrix and search.
    fn curvature(&mut self, touched: &Touched) -> Lack {
        self.hear_of(touched);
        let mut sum = 0.0;
        for k in 0..self.rows.len() {
            let gained = vector(&self.seen(k, &self.partial), 0);
            let row = &mut self.rows[k];
            row.image = row.search - row.share * (gained + row.eps * row.search);
            if row.share > 0.0 {
                sum += row.m * row.search.dot(&row.image) / row.share;
            }
        }
        [sum, 0.0, 0.0]
    }

    /// Goes along the search.
    fn advance(&mut self, alpha: f64) -> Lack {
        let mut sum = [0.0; 3];
        for row in self.rows.iter_mut().filter(|row| row.share > 0.0) {
            row.dv += alpha * row.search;
            row.lack -= alpha * row.image;
            let square = row.m * row.lack.norm_squared();
            sum[0] += square / row.share;
            sum[1] += square;
        }
        sum
    }
}
