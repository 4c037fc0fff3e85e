//! Sources: the particles that have mass, in the order of the curve.

use std::ops::Range;

use rayon::prelude::*;

use crate::points::Vec3;
use crate::points::sum::{CHUNK, Parts, ordered};

/// The particles that have mass, along the curve.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    pub x: Vec<f64>,
    pub y: Vec<f64>,
    pub z: Vec<f64>,
    /// square of the softening length
    pub eps2: Vec<f64>,
    /// in units of `total`
    pub m: Vec<f64>,
    /// `before[i]`: how many of the particles 0..i along the curve have mass
    pub before: Vec<u32>,
    /// total mass
    pub total: f64,
}

impl Sources {
    /// Takes the massive ones of the particles: `order[k]` has the k-th mass along the curve, `x[k]` and `eps2[k]` are in its order.
    pub fn take(&mut self, order: &[u32], m: &[f64], x: &[Vec3], eps2: &[f64]) {
        self.total = ordered(m.len(), 0.0, |range| m[range].iter().sum::<f64>());
        let inverse = 1.0 / self.total;
        let unit = if self.total > 0.0 { inverse } else { 0.0 };
        self.before.clear();
        self.before.push(0);
        let mut count = 0;
        self.before.extend(order.iter().map(|&i| {
            count += u32::from(m[i as usize] > 0.0);
            count
        }));
        let columns = [
            &mut self.x,
            &mut self.y,
            &mut self.z,
            &mut self.eps2,
            &mut self.m,
        ];
        let columns = columns.map(|column| {
            column.resize(count as usize, 0.0);
            Parts::new(column)
        });
        let before = &self.before;
        (0..order.len())
            .into_par_iter()
            .with_min_len(CHUNK)
            .for_each(|k| {
                let j = before[k] as usize;
                if before[k + 1] as usize > j {
                    let row = [x[k].x, x[k].y, x[k].z, eps2[k], m[order[k] as usize] * unit];
                    for (column, value) in columns.iter().zip(row) {
                        // SAFETY: each source has one place along the curve.
                        unsafe { column.part(j..j + 1)[0] = value };
                    }
                }
            });
    }

    /// The sources among the particles of `range` along the curve.
    pub fn of(&self, range: Range<usize>) -> Range<usize> {
        self.before[range.start] as usize..self.before[range.end] as usize
    }

    pub fn position(&self, j: usize) -> Vec3 {
        Vec3::new(self.x[j], self.y[j], self.z[j])
    }

    pub fn count(&self) -> usize {
        self.m.len()
    }
}
