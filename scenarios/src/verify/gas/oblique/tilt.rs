//! Square lattices turned in the plane by angles of rational slope, so that they fill periodic boxes.
//!
//! Sides d (run, rise) / s and d (-rise, run) / s with s^2 = rise^2 + run^2: the lattice comes again after s d along x and along y, and a square of that
//! side, a tile, holds s^2 particles.

use nbody::points::Vec3;

/// An angle whose tangent is rise / run, without common factors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tilt {
    pub rise: u32,
    pub run: u32,
}

impl Tilt {
    pub fn degrees(&self) -> f64 {
        f64::from(self.rise).atan2(f64::from(self.run)).to_degrees()
    }

    /// Particles of a tile.
    fn particles(&self) -> u32 {
        self.rise * self.rise + self.run * self.run
    }

    /// Side of a tile by the distance of particles.
    pub fn side(&self) -> f64 {
        f64::from(self.particles()).sqrt()
    }

    /// The places of `tiles` (along x, along y) of the side `side` from x = `from` on.
    pub fn places(&self, from: f64, side: f64, tiles: [u32; 2]) -> Vec<Vec3> {
        let tile = self.tile();
        let mut places = Vec::new();
        for i in 0..tiles[0] {
            for j in 0..tiles[1] {
                let corner = Vec3::new(from + side * f64::from(i), side * f64::from(j), 0.0);
                places.extend(tile.iter().map(|place| corner + side * place));
            }
        }
        places
    }

    /// The places within a tile of side one.
    fn tile(&self) -> Vec<Vec3> {
        let (size, rise, run) = (
            i64::from(self.particles()),
            i64::from(self.rise),
            i64::from(self.run),
        );
        let mut places = Vec::new();
        for i in 0..=rise + run {
            for j in -(rise + run)..=rise + run {
                let [x, y] = [i * run - j * rise, i * rise + j * run];
                if (0..size).contains(&x) && (0..size).contains(&y) {
                    let place = |k: i64| (k as f64 + 0.5) / size as f64;
                    places.push(Vec3::new(place(x), place(y), 0.0));
                }
            }
        }
        places
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turned_lattices_are_periodic_of_the_right_density_and_slope() {
        for (rise, run) in [(0, 1), (1, 3), (1, 2), (3, 4), (1, 1)] {
            let tilt = Tilt { rise, run };
            let (side, tiles) = (0.7, [4, 3]);
            let places = tilt.places(0.1, side, tiles);
            assert_eq!(places.len() as u32, 12 * tilt.particles());
            let size = [4.0 * side, 3.0 * side];
            let d = side / tilt.side();
            // The nearest of each particle, across the edges too, are four at the distance d, at the angle and right angles to it.
            for (i, a) in places.iter().enumerate() {
                let mut near = 0;
                for (_, b) in places.iter().enumerate().filter(|&(j, _)| j != i) {
                    let mut apart = b - a;
                    for axis in 0..2 {
                        apart[axis] -= size[axis] * (apart[axis] / size[axis]).round();
                    }
                    assert!(apart.norm() > 0.999 * d, "{tilt:?}: {}", apart.norm() / d);
                    if apart.norm() < 1.001 * d {
                        let angle = apart.y.atan2(apart.x).to_degrees() - tilt.degrees();
                        assert!((angle / 90.0 - (angle / 90.0).round()).abs() < 1e-9);
                        near += 1;
                    }
                }
                assert_eq!(near, 4);
            }
            let inside =
                |x: &Vec3| (0.1..0.1 + size[0]).contains(&x.x) && (0.0..size[1]).contains(&x.y);
            assert!(places.iter().all(inside));
        }
    }
}
