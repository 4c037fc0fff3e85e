//! Near: the candidates around one point, and the radius that holds the wanted number of them.
//!
//! The smooth number within H is (volume of the sphere or disc of radius H) sum_j W(r_j, H); it grows with H.

use fearless_simd::{Simd, SimdBase, SimdFloat, SimdMask, f64x8};
use nbody::points::{Domain, Vec3};

use super::candidates::Candidates;

/// Radius of the Wendland C2 kernel by twice its standard deviation, that of the kernel of the weights by it, (volume of the unit sphere) times
/// W(0) H^d, and d.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kernel {
    pub ratio: f64,
    pub near: f64,
    pub central: f64,
    dimensions: i32,
}

impl Kernel {
    pub fn new(domain: &Domain) -> Self {
        if domain.dimensions() == 2 {
            Self {
                ratio: 1.897_366_596_101_027_6,
                near: 0.745_355_992_499_929_9,
                central: 7.0,
                dimensions: 2,
            }
        } else {
            Self {
                ratio: 1.936_491_673_103_708_4,
                near: 0.774_596_669_241_483_4,
                central: 14.0,
                dimensions: 3,
            }
        }
    }

    /// W(0) for radius H.
    pub fn peak(&self, radius: f64) -> f64 {
        self.central / (self.unit_volume() * radius.powi(self.dimensions))
    }

    /// [`Kernel::peak`] of eight radii.
    #[inline(always)]
    pub fn peaks<S: Simd>(&self, radius: f64x8<S>) -> f64x8<S> {
        let square = radius * radius;
        let volume = match self.dimensions {
            2 => square,
            _ => square * radius,
        };
        f64x8::splat(radius.simd, self.central / self.unit_volume()) / volume
    }

    fn unit_volume(&self) -> f64 {
        match self.dimensions {
            2 => std::f64::consts::PI,
            _ => 4.0 / 3.0 * std::f64::consts::PI,
        }
    }
}

/// Error of the neighbour number from which one last step of Newton's method suffices.
pub(super) const TOLERANCE: f64 = 1e-3;

/// W(q H) / W(0).
#[inline(always)]
pub(super) fn falloff<S: Simd>(q: f64x8<S>) -> f64x8<S> {
    let t = (-q + 1.0).max(0.0);
    let t2 = t * t;
    t2 * t2 * q.mul_add(4.0, 1.0)
}

/// The kernel of the weights, (1 - q^2)^2 by q = r / R, by q^2.
#[inline(always)]
pub(super) fn hold<S: Simd>(square: f64x8<S>) -> f64x8<S> {
    let t = (-square + 1.0).max(0.0);
    t * t
}

/// Factor of a radius by Newton's method in logarithms, from the smooth number and its derivative by ln(radius).
#[inline(always)]
pub(super) fn step(number: f64, slope: f64, wanted: f64) -> f64 {
    ((wanted / number).ln() * number / slope).exp()
}

/// Distances of candidates from a point.
#[derive(Clone, Debug, Default)]
pub(super) struct Near {
    distance: Vec<f64>,
    square: Vec<f64>,
    /// place among the candidates
    place: Vec<u32>,
    count: usize,
}

/// Numbers that are worked on at once.
pub(super) const LANES: usize = 8;

/// For each set of lanes their numbers, ascending; then zeros.
pub(super) const FIRST: [[u32; LANES]; 256] = {
    let mut table = [[0; LANES]; 256];
    let mut set = 0;
    while set < 256 {
        let (mut lane, mut place) = (0, 0);
        while lane < LANES {
            if set >> lane & 1 == 1 {
                table[set][place] = lane as u32;
                place += 1;
            }
            lane += 1;
        }
        set += 1;
    }
    table
};

/// Sum of the lanes.
#[inline(always)]
pub(super) fn sum<S: Simd>(lanes: f64x8<S>) -> f64 {
    let mut x = [0.0; LANES];
    lanes.store_slice(&mut x);
    ((x[0] + x[4]) + (x[2] + x[6])) + ((x[1] + x[5]) + (x[3] + x[7]))
}

impl Near {
    /// Keeps the candidates within `available` of `x`, and their distances, filled up to whole lanes with distances beyond.
    #[inline(always)]
    pub fn choose<S: Simd>(&mut self, simd: S, candidates: &Candidates, x: Vec3, available: f64) {
        let room = candidates.len().next_multiple_of(LANES) + LANES;
        if self.place.len() < room {
            self.place.resize(room, 0);
            self.square.resize(room, 0.0);
        }
        let most = available * available;
        let columns = candidates.columns().map(|c| c.as_chunks::<LANES>().0);
        let square = self.square.as_chunks_mut::<LANES>().0;
        let mut near = 0;
        for (c, square) in square.iter_mut().enumerate().take(columns[0].len()) {
            let dx = f64x8::from_slice(simd, &columns[0][c]) - x.x;
            let dy = f64x8::from_slice(simd, &columns[1][c]) - x.y;
            let dz = f64x8::from_slice(simd, &columns[2][c]) - x.z;
            let d = dx * dx + dy * dy + dz * dz;
            d.store_slice(square);
            let inside = d.simd_lt(most).to_bitmask() as u8;
            // All lanes are written, those inside first; the next ones overwrite the rest.
            let places = &mut self.place[near..near + LANES];
            for (place, &lane) in places.iter_mut().zip(&FIRST[usize::from(inside)]) {
                *place = (c * LANES) as u32 + lane;
            }
            near += inside.count_ones() as usize;
        }
        let (square, distance) = (&self.square, &mut self.distance);
        distance.clear();
        distance.extend(self.place[..near].iter().map(|&k| square[k as usize]));
        distance.resize(near.next_multiple_of(LANES), 4.0 * most);
        distance.iter_mut().for_each(|d| *d = d.sqrt());
        self.count = near;
    }

    /// Distances in a radius, and places, of those kept.
    pub fn kept(&self, inverse_radius: f64) -> impl Iterator<Item = (f64, u32)> + '_ {
        let pairs = self.distance.iter().zip(&self.place);
        pairs
            .map(move |(&d, &k)| (d * inverse_radius, k))
            .take(self.count)
    }

    /// W / W(0) of those kept, and the kernel of the weights, filled up to whole lanes with zeros.
    #[inline(always)]
    pub fn falloffs<S: Simd>(
        &self,
        simd: S,
        kernel: Kernel,
        inverse_radius: f64,
        [fall, held]: [&mut [f64]; 2],
    ) {
        let fall = fall.as_chunks_mut::<LANES>().0;
        let held = held.as_chunks_mut::<LANES>().0;
        let lanes = self.distance.as_chunks::<LANES>().0;
        for (lanes, (fall, held)) in lanes.iter().zip(fall.iter_mut().zip(held)) {
            let q = f64x8::from_slice(simd, lanes) * inverse_radius;
            falloff(q).store_slice(fall);
            let s = q * (1.0 / kernel.near);
            hold(s * s).store_slice(held);
        }
    }

    pub fn len(&self) -> usize {
        self.count
    }

    /// Smooth neighbour number within `radius`, and its derivative by ln(radius).
    #[inline(always)]
    fn number<S: Simd>(&self, simd: S, kernel: Kernel, radius: f64) -> (f64, f64) {
        let mut value = f64x8::splat(simd, 0.0);
        let mut slope = value;
        let one = f64x8::splat(simd, 1.0);
        for lanes in self.distance.as_chunks::<LANES>().0 {
            let q = f64x8::from_slice(simd, lanes) * (1.0 / radius);
            let t = (one - q).max(0.0);
            let t3 = t * t * t;
            value += t3 * t * (one + q * 4.0);
            slope += q * q * t3;
        }
        (
            kernel.central * sum(value),
            20.0 * kernel.central * sum(slope),
        )
    }

    /// The radius with the wanted smooth neighbour number: Newton's method in logarithms, inside a shrinking bracket.
    #[inline(always)]
    pub fn radius<S: Simd>(
        &self,
        simd: S,
        kernel: Kernel,
        (guess, available): (f64, f64),
        wanted: f64,
    ) -> Option<f64> {
        let (mut low, mut high) = (0.0, available);
        let mut bounded = false;
        let mut radius = if guess > 0.0 && guess < available {
            guess
        } else {
            available
        };
        for _ in 0..100 {
            let (number, slope) = self.number(simd, kernel, radius);
            let newton = radius * step(number, slope, wanted);
            if (number / wanted - 1.0).abs() < TOLERANCE {
                return Some(newton.min(available));
            }
            if number < wanted {
                if radius >= available {
                    return None;
                }
                low = radius;
            } else {
                high = radius;
                bounded = true;
            }
            radius = if newton > low && newton < high {
                newton
            } else if bounded {
                0.5 * (low + high)
            } else {
                available
            };
        }
        Some(radius)
    }
}
