//! A tube in the plane, periodic of length 2, whose halves are filled by lattices of one tilt.

use gas::Particles;
use nbody::points::{Columns, Vec3};

use super::super::riemann::State;
use super::super::sod::TUBE;
use super::tilt::Tilt;

/// By what particles are farther apart on the right.
const COARSER: u32 = 3;
/// Distances of the right that the tube is wide at least: more than both sides of the widest kernel.
const ACROSS: f64 = 10.0;

/// A tube with its lattices in place.
pub struct Tube {
    pub tilt: Tilt,
    /// Side of a tile of the left, and their numbers along and across the half.
    pub side: f64,
    pub tiles: [u32; 2],
}

impl Tube {
    pub fn new(tilt: Tilt, cells: f64) -> Self {
        let coarser = f64::from(COARSER);
        // Whole tiles of the right.
        let along = COARSER * (cells / (coarser * tilt.side())).round() as u32;
        let across = COARSER * (ACROSS / tilt.side()).ceil() as u32;
        Self {
            tilt,
            side: 1.0 / f64::from(along),
            tiles: [along, across],
        }
    }

    /// Distance of particles ahead of the shock.
    pub fn distance(&self) -> f64 {
        self.side * f64::from(COARSER) / self.tilt.side()
    }

    /// Its block only says how gas is bound; [`Tube::lay_out`] replaces it.
    pub fn scene(&self) -> String {
        let width = self.side * f64::from(self.tiles[1]);
        format!(
            "[run]\nend_time = 0.2\n[units]\nsystem = \"dimensionless\"\n[domain]\nkind = \"periodic\"\nsize = [2, {width}, {width}]\n\
             dimensions = 2\n[[gas.block]]\nlo = [0, 0, 0]\nhi = [2, {width}, 0]\nspacing = 0.02\ndensity = 1\npressure = 1\n\
             [gas.eos]\ngamma = {}\n",
            TUBE.gamma
        )
    }

    pub fn lay_out(&self, gas: &mut Particles) {
        let coarse = self.tiles.map(|tiles| tiles / COARSER);
        let halves = [
            (0.0, self.side, self.tiles, TUBE.left.state),
            (
                1.0,
                self.side * f64::from(COARSER),
                coarse,
                TUBE.right.state,
            ),
        ];
        let filled = halves.map(|(from, side, tiles, state)| {
            let places = self.tilt.places(from, side, tiles);
            (places, (side / self.tilt.side()).powi(2), state)
        });
        gas.resize(filled.iter().map(|(places, ..)| places.len()).sum());
        let mut i = 0;
        for (places, volume, State { rho, p, .. }) in filled {
            for x in places {
                gas.id[i] = i as u64;
                gas.x[i] = x;
                gas.v[i] = Vec3::zeros();
                gas.m[i] = rho * volume;
                gas.u[i] = p / ((TUBE.gamma - 1.0) * rho);
                gas.h[i] = 0.0;
                i += 1;
            }
        }
    }
}
