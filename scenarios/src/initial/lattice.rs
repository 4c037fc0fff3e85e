//! Lattices that fill a box with whole cells, and random points in it; in the axes of the domain, in two or three dimensions.
//!
//! Cell edges are the box's by round(box / cell): a periodic box is tiled exactly. Along a missing axis points lie at the box's lower corner.

use nbody::points::random::{Purpose, stream};
use nbody::points::{Domain, Vec3};
use rand::RngExt;

use super::glass::{Glass, Uniform};

/// Sweeps that a glass is settled for.
const SWEEPS: usize = 25;

/// The box [lo, hi) and its axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    pub lo: Vec3,
    pub hi: Vec3,
    pub axes: [bool; 3],
}

/// How points fill a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrangement {
    /// One point in the middle of each cell.
    Cubic,
    /// Two points a cell, a quarter of it from its lower and its upper corner.
    BodyCentred,
}

impl Block {
    /// A three-dimensional block.
    pub const fn new(lo: Vec3, hi: Vec3) -> Self {
        Self {
            lo,
            hi,
            axes: [true; 3],
        }
    }

    fn dimensions(&self) -> usize {
        self.axes.iter().filter(|&&axis| axis).count()
    }

    /// Volume, or area in two dimensions.
    pub fn volume(&self) -> f64 {
        self.sides().filter(|side| *side > 0.0).product()
    }

    fn sides(&self) -> impl Iterator<Item = f64> {
        (0..3).map(|axis| {
            if self.axes[axis] {
                self.hi[axis] - self.lo[axis]
            } else {
                0.0
            }
        })
    }

    fn check(&self) {
        let sound = |axis: usize| !self.axes[axis] || self.lo[axis] < self.hi[axis];
        assert!(
            (0..3).all(sound),
            "a block's upper corner is above its lower one"
        );
    }

    /// Points of a lattice whose cells have edges as near to `cell` as fit the block.
    pub fn lattice(&self, arrangement: Arrangement, cell: f64) -> Vec<Vec3> {
        self.check();
        assert!(cell > 0.0, "a cell has a size");
        let mut count = [1usize; 3];
        let mut edge = Vec3::zeros();
        for (axis, side) in self
            .sides()
            .enumerate()
            .filter(|&(axis, _)| self.axes[axis])
        {
            count[axis] = (side / cell).round().max(1.0) as usize;
            edge[axis] = side / count[axis] as f64;
        }
        let places: &[f64] = match arrangement {
            Arrangement::Cubic => &[0.5],
            Arrangement::BodyCentred => &[0.25, 0.75],
        };
        let mut x = Vec::with_capacity(places.len() * count.iter().product::<usize>());
        for k in 0..count[2] {
            for j in 0..count[1] {
                for i in 0..count[0] {
                    let corner = Vec3::new(i as f64, j as f64, k as f64);
                    let point =
                        |place: &f64| self.lo + (corner.add_scalar(*place)).component_mul(&edge);
                    x.extend(places.iter().map(point));
                }
            }
        }
        x
    }

    /// A glass that continues periodically: as many points as a cubic lattice, from random places in its cells settled to equal density.
    pub fn glass(&self, cell: f64, seed: u64, purpose: Purpose) -> Vec<Vec3> {
        let mut x = self.lattice(Arrangement::Cubic, cell);
        let edge = (self.volume() / x.len() as f64).powf(1.0 / self.dimensions() as f64);
        let size = self.hi - self.lo;
        let domain = Domain::periodic(size).with_axes(self.axes);
        let mut random = stream(seed, purpose, 0, 0);
        for x in &mut x {
            let jitter = edge * Vec3::from_fn(|_, _| random.random::<f64>() - 0.5);
            *x += domain.in_plane(jitter) - self.lo;
            domain.wrap(x);
        }
        let volume = self.volume() / x.len() as f64;
        let mut glass = Glass::new(x, |_| volume, domain, &Uniform);
        glass.settle(SWEEPS);
        glass.points().0.iter().map(|x| x + self.lo).collect()
    }

    /// The cell with which a lattice of this block has about `n` points; exactly n where n suits the block.
    pub fn cell(&self, arrangement: Arrangement, n: usize) -> f64 {
        let cell_points = match arrangement {
            Arrangement::Cubic => 1.0,
            Arrangement::BodyCentred => 2.0,
        };
        (self.volume() * cell_points / n as f64).powf(1.0 / self.dimensions() as f64)
    }

    /// `n` points anywhere, each from the stream of its own id; ids begin with `first_id`.
    pub fn random(&self, n: usize, seed: u64, purpose: Purpose, first_id: u64) -> Vec<Vec3> {
        self.check();
        let point = |id: u64| {
            let mut random = stream(seed, purpose, id, 0);
            let mut x = self.lo;
            for axis in (0..3).filter(|&axis| self.axes[axis]) {
                let u: f64 = random.random();
                let inside = self.lo[axis] + u * (self.hi[axis] - self.lo[axis]);
                // Rounding may land on the upper face, which is not in the box.
                x[axis] = inside.min(self.hi[axis].next_down());
            }
            x
        };
        (first_id..).take(n).map(point).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLAT: [bool; 3] = [true, false, true];

    /// Smallest distance between any two points, with the block's periods.
    fn closest(block: &Block, x: &[Vec3]) -> f64 {
        let size = block.hi - block.lo;
        let mut least = f64::INFINITY;
        for (i, a) in x.iter().enumerate() {
            for b in &x[..i] {
                let mut d = a - b;
                for axis in (0..3).filter(|&axis| block.axes[axis]) {
                    d[axis] -= size[axis] * (d[axis] / size[axis]).round();
                }
                least = least.min(d.norm());
            }
        }
        least
    }

    #[test]
    fn lattices_tile_a_periodic_box() {
        let block = Block::new(Vec3::new(-1.0, 0.0, 2.0), Vec3::new(1.0, 1.0, 3.0));
        let cubic = block.lattice(Arrangement::Cubic, 0.21);
        assert_eq!(cubic.len(), 10 * 5 * 5);
        assert!((closest(&block, &cubic) - 0.2).abs() < 1e-12);
        let centred = block.lattice(Arrangement::BodyCentred, 0.2);
        assert_eq!(centred.len(), 2 * 250);
        assert!((closest(&block, &centred) - 0.1 * 3f64.sqrt()).abs() < 1e-12);
        assert!((centred[1] - block.lo - Vec3::repeat(0.15)).norm() < 1e-12);
    }

    #[test]
    fn a_missing_axis_has_one_layer() {
        let block = Block {
            axes: FLAT,
            ..Block::new(Vec3::new(0.0, 0.5, 0.0), Vec3::new(1.0, 0.5, 2.0))
        };
        assert_eq!(block.volume(), 2.0);
        let cell = block.cell(Arrangement::BodyCentred, 1600);
        let x = block.lattice(Arrangement::BodyCentred, cell);
        assert_eq!(x.len(), 1600);
        assert!(x.iter().all(|x| x.y == 0.5));
        assert!((closest(&block, &x) - cell * 0.5f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn random_points_stay_inside_and_are_uniform() {
        let block = Block {
            axes: FLAT,
            ..Block::new(Vec3::new(1.0, 0.0, -2.0), Vec3::new(3.0, 1.0, 2.0))
        };
        let n = 20_000;
        let x = block.random(n, 5, Purpose::GasPositions, 7);
        let inside = |x: &Vec3| x.x >= 1.0 && x.x < 3.0 && x.y == 0.0 && x.z >= -2.0 && x.z < 2.0;
        assert!(x.iter().all(inside));
        assert_eq!(x[1..], block.random(n - 1, 5, Purpose::GasPositions, 8));
        let mean = x.iter().sum::<Vec3>() / n as f64;
        // Four standard errors of the mean, and of the mean square 4/12 L^2 (1 - ...) of a uniform number.
        let error = |side: f64| 4.0 * side / (12.0 * n as f64).sqrt();
        assert!((mean.x - 2.0).abs() < error(2.0) && mean.z.abs() < error(4.0));
        let spread = x.iter().map(|x| x.z * x.z).sum::<f64>() / n as f64;
        assert!((spread / (16.0 / 12.0) - 1.0).abs() < 4.0 * (0.8 / n as f64).sqrt());
    }
}
