//! Weights: how much each gas neighbour counts at a point.
//!
//! w_j = W_j V_j (A + B.r_j), r_j = x_j - x, V = m/rho, with A and B such that sum w = 1 and sum w r = 0: exact for linear fields, and an
//! impulse -w_j J against an impulse J at the point leaves momentum and angular momentum unchanged.
//! Where that would need weights below -0.05 in sum (the point is at an edge of the gas): w_j = W_j V_j normalised, and the field is
//! continued from the neighbours' centre b = sum w r by their rigid rotation, f(x) = sum w f - Omega x b,
//! Omega = I^-1 sum w s x f, s = r - b, I = sum w (s^2 1 - s s); the impulse to j is -w_j (J - (I^-1 (b x J)) x s_j), the adjoint of that.
//! Where even I is singular: the normalised weights alone; then angular momentum is not kept.

use nalgebra::Matrix3;
use nbody::points::{Domain, Vec3};

use super::Reach;
use super::candidates::{Candidates, radius_by_nearest_leaf};
use crate::Gas;

/// How the weights of a point came about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shape {
    /// No gas within reach.
    #[default]
    Empty,
    /// Exact for linear fields.
    Linear,
    /// Exact for rigid rotation.
    Rigid,
    /// Exact for uniform fields.
    Plain,
}

/// The weights of one point. Columns run over its neighbours.
#[derive(Clone, Debug, Default)]
pub struct Weights {
    pub shape: Shape,
    /// smoothing length
    pub h: f64,
    /// density of the gas
    pub rho: f64,
    /// gas particle; one that is near with several images is listed several times
    pub index: Vec<u32>,
    pub weight: Vec<f64>,
    /// s_j of a rigid shape; empty otherwise
    pub arm: Vec<Vec3>,
    /// b of a rigid shape
    pub offset: Vec3,
    /// I^-1 of a rigid shape
    pub inverse_inertia: Matrix3<f64>,
    /// bound on |impulse to j| / (w_j |J|)
    pub gain: f64,
    distance: Vec<f64>,
    place: Vec<u32>,
    relative: [Vec<f64>; 3],
}

/// Radius of the Wendland C2 kernel by twice its standard deviation, (volume of the unit sphere) times W(0) H^d, and d.
#[derive(Clone, Copy)]
struct Kernel {
    ratio: f64,
    central: f64,
    dimensions: i32,
}

impl Kernel {
    fn new(domain: &Domain) -> Self {
        if domain.dimensions() == 2 {
            Self {
                ratio: 1.897_366_596_101_027_6,
                central: 7.0,
                dimensions: 2,
            }
        } else {
            Self {
                ratio: 1.936_491_673_103_708_4,
                central: 14.0,
                dimensions: 3,
            }
        }
    }

    /// W(0) for radius H.
    fn peak(&self, radius: f64) -> f64 {
        let unit_volume = if self.dimensions == 2 {
            std::f64::consts::PI
        } else {
            4.0 / 3.0 * std::f64::consts::PI
        };
        self.central / (unit_volume * radius.powi(self.dimensions))
    }
}

/// Radius of the sphere (disc) in which a point with smoothing length `h` has its neighbours.
pub fn radius(domain: &Domain, h: f64) -> f64 {
    Kernel::new(domain).ratio * h
}

/// Error of the neighbour number from which one last step of Newton's method suffices.
const TOLERANCE: f64 = 1e-3;

/// Sum of |w| up to which weights exact for linear fields are taken.
const MOST_ABSOLUTE: f64 = 1.1;

/// Largest gain of a rigid shape.
const MOST_GAIN: f64 = 20.0;

impl Weights {
    /// Weights of the point `x`, starting from the smoothing length `guess` (zero if unknown); gathers its own candidates.
    pub fn find(
        &mut self,
        candidates: &mut Candidates,
        gas: &Gas,
        domain: &Domain,
        (x, guess): (Vec3, f64),
        reach: &Reach,
    ) {
        if gas.is_empty() {
            self.clear(reach.largest);
            return;
        }
        let ratio = Kernel::new(domain).ratio;
        let start = if guess > 0.0 {
            ratio * guess
        } else {
            radius_by_nearest_leaf(gas, domain, x, reach.neighbours)
        };
        let mut available = 1.3 * start;
        loop {
            available = available.min(ratio * reach.largest);
            candidates.gather(gas, domain, x, x, available);
            if self.fit(candidates, domain, (x, start / ratio), available, reach) {
                return;
            }
            // An unset guess of zero must grow too.
            available = (1.6 * available).max(1e-6 * ratio * reach.largest);
        }
    }

    /// Weights of the point `x`, from candidates that are complete within `available` of it. False if that is too short a way to find the
    /// wanted number of neighbours.
    pub fn fit(
        &mut self,
        candidates: &Candidates,
        domain: &Domain,
        (x, guess): (Vec3, f64),
        available: f64,
        reach: &Reach,
    ) -> bool {
        let kernel = Kernel::new(domain);
        let x = domain.in_plane(x - candidates.centre);
        self.choose(candidates, x, available);
        let longest = kernel.ratio * reach.largest;
        let radius = match self.radius(kernel, guess * kernel.ratio, available, reach) {
            Some(radius) => radius,
            None if available >= longest => longest,
            None => return false,
        };
        self.clear(radius / kernel.ratio);
        self.weigh(candidates, kernel, x, radius);
        if !self.index.is_empty() {
            self.correct(domain);
        }
        true
    }

    fn clear(&mut self, h: f64) {
        self.h = h;
        (self.shape, self.rho, self.gain) = (Shape::Empty, 0.0, 1.0);
        self.index.clear();
        self.weight.clear();
        self.arm.clear();
        self.relative.iter_mut().for_each(Vec::clear);
    }

    /// The candidates within `available` of `x`, and their distances.
    fn choose(&mut self, candidates: &Candidates, x: Vec3, available: f64) {
        let n = candidates.len();
        self.distance.resize(n, 0.0);
        self.place.resize(n, 0);
        let columns = candidates.x.iter().zip(&candidates.y).zip(&candidates.z);
        for (d, ((px, py), pz)) in self.distance.iter_mut().zip(columns) {
            let (dx, dy, dz) = (px - x.x, py - x.y, pz - x.z);
            *d = dx * dx + dy * dy + dz * dz;
        }
        let mut near = 0;
        for k in 0..n {
            let d = self.distance[k];
            // Written always, kept when near: no branch to mispredict.
            self.distance[near] = d;
            self.place[near] = k as u32;
            near += usize::from(d < available * available);
        }
        self.distance.truncate(near);
        self.place.truncate(near);
        self.distance.iter_mut().for_each(|d| *d = d.sqrt());
    }

    /// Smooth neighbour number within `radius`, and its derivative by ln(radius).
    fn number(&self, kernel: Kernel, radius: f64) -> (f64, f64) {
        let inverse = 1.0 / radius;
        let mut sums = [[0.0; 4]; 2];
        let term = |d: f64| {
            let q = d * inverse;
            let t = (1.0 - q).max(0.0);
            let t3 = t * t * t;
            (t3 * t * (1.0 + 4.0 * q), q * q * t3)
        };
        let four = self.distance.chunks_exact(4);
        let rest = four.remainder();
        for part in four {
            for lane in 0..4 {
                let (value, slope) = term(part[lane]);
                sums[0][lane] += value;
                sums[1][lane] += slope;
            }
        }
        for &d in rest {
            let (value, slope) = term(d);
            sums[0][0] += value;
            sums[1][0] += slope;
        }
        let [value, slope] = sums.map(|s| (s[0] + s[1]) + (s[2] + s[3]));
        (kernel.central * value, 20.0 * kernel.central * slope)
    }

    /// The radius with the wanted smooth neighbour number: Newton's method in logarithms, inside a shrinking bracket.
    fn radius(&self, kernel: Kernel, guess: f64, available: f64, reach: &Reach) -> Option<f64> {
        let wanted = reach.neighbours;
        let (mut low, mut high) = (0.0, available);
        let mut bounded = false;
        let mut radius = if guess > 0.0 && guess < available {
            guess
        } else {
            available
        };
        for _ in 0..100 {
            let (number, slope) = self.number(kernel, radius);
            let newton = radius * ((wanted / number).ln() * number / slope).exp();
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

    /// Lists the neighbours within `radius` with W V / W(0) as weight, and sums the density.
    fn weigh(&mut self, candidates: &Candidates, kernel: Kernel, x: Vec3, radius: f64) {
        let inverse = 1.0 / radius;
        let [rx, ry, rz] = &mut self.relative;
        let mut mass = 0.0;
        for (&d, &k) in self.distance.iter().zip(&self.place) {
            let q = d * inverse;
            if q < 1.0 {
                let k = k as usize;
                let t2 = (1.0 - q) * (1.0 - q);
                let w = t2 * t2 * (1.0 + 4.0 * q);
                mass += candidates.m[k] * w;
                self.weight.push(w * candidates.volume[k]);
                self.index.push(candidates.index[k]);
                rx.push(candidates.x[k] - x.x);
                ry.push(candidates.y[k] - x.y);
                rz.push(candidates.z[k] - x.z);
            }
        }
        self.rho = mass * kernel.peak(radius);
    }

    /// Makes the weights exact for linear fields, or the best that can be had.
    fn correct(&mut self, domain: &Domain) {
        let (zeroth, first, second) = self.moments();
        if zeroth <= 0.0 {
            // All neighbours are at the very edge of the kernel, where it underflows.
            self.clear(self.h);
            return;
        }
        let centre = first / zeroth;
        let spread = second / zeroth - centre * centre.transpose();
        let mut full = spread;
        for axis in (0..3).filter(|&axis| !domain.axes[axis]) {
            full[(axis, axis)] = self.h * self.h;
        }
        // Inside the gas the determinant is h^6/64 (h^6/16 in two dimensions); at the edge of a plane or line of gas it vanishes.
        if full.determinant() > 1e-4 * self.h.powi(6)
            && let Some(root) = full.cholesky()
        {
            let slope = root.solve(&-centre);
            let level = 1.0 - slope.dot(&centre);
            if self.absolute(level, slope) < MOST_ABSOLUTE * zeroth {
                self.tilt(level, slope);
                self.shape = Shape::Linear;
                return;
            }
        }
        self.tilt(1.0, Vec3::zeros());
        self.turn(centre, spread);
    }

    /// Sum of w, w r and w r r.
    fn moments(&self) -> (f64, Vec3, Matrix3<f64>) {
        let [rx, ry, rz] = &self.relative;
        let mut sums = [[0.0; 2]; 10];
        for (k, w) in self.weight.iter().enumerate() {
            let (x, y, z) = (rx[k], ry[k], rz[k]);
            let (wx, wy, wz) = (w * x, w * y, w * z);
            let terms = [
                *w,
                wx,
                wy,
                wz,
                wx * x,
                wx * y,
                wx * z,
                wy * y,
                wy * z,
                wz * z,
            ];
            for (sum, term) in sums.iter_mut().zip(terms) {
                sum[k & 1] += term;
            }
        }
        let [w, x, y, z, xx, xy, xz, yy, yz, zz] = sums.map(|s| s[0] + s[1]);
        (
            w,
            Vec3::new(x, y, z),
            Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
        )
    }

    /// Sum of |w (level + slope.r)|.
    fn absolute(&self, level: f64, slope: Vec3) -> f64 {
        let [rx, ry, rz] = &self.relative;
        let mut sums = [0.0; 4];
        for (k, w) in self.weight.iter().enumerate() {
            let factor = level + slope.x * rx[k] + slope.y * ry[k] + slope.z * rz[k];
            sums[k & 3] += w * factor.abs();
        }
        sums.iter().sum()
    }

    /// Multiplies the weights by level + slope.r, and brings their sum to one.
    fn tilt(&mut self, level: f64, slope: Vec3) {
        let [rx, ry, rz] = &self.relative;
        let columns = rx.iter().zip(ry).zip(rz);
        for (w, ((x, y), z)) in self.weight.iter_mut().zip(columns) {
            *w *= level + slope.x * x + slope.y * y + slope.z * z;
        }
        let mut sums = [0.0; 4];
        for (k, w) in self.weight.iter().enumerate() {
            sums[k & 3] += w;
        }
        let norm = 1.0 / sums.iter().sum::<f64>();
        self.weight.iter_mut().for_each(|w| *w *= norm);
    }

    /// Rigid rotation about the neighbours' `centre`; `spread` is the covariance of their places.
    fn turn(&mut self, centre: Vec3, spread: Matrix3<f64>) {
        self.shape = Shape::Plain;
        if spread.trace().is_nan() || spread.trace() < 1e-8 * self.h * self.h {
            return;
        }
        let inertia = Matrix3::from_diagonal_element(spread.trace()) - spread;
        if inertia.determinant() < 1e-6 * spread.trace().powi(3) {
            return;
        }
        let Some(inverse) = inertia.try_inverse() else {
            return;
        };
        let [rx, ry, rz] = &self.relative;
        self.arm
            .extend((0..rx.len()).map(|k| Vec3::new(rx[k], ry[k], rz[k]) - centre));
        let longest = self.arm.iter().fold(0.0, |m: f64, s| m.max(s.norm()));
        let gain = 1.0 + centre.norm() * inverse.norm() * longest;
        if gain < MOST_GAIN {
            self.shape = Shape::Rigid;
            (self.offset, self.inverse_inertia, self.gain) = (centre, inverse, gain);
        } else {
            self.arm.clear();
        }
    }

    /// A vector field of the gas, at the point.
    pub fn vector(&self, field: impl Fn(usize) -> Vec3) -> Vec3 {
        let pairs = self.index.iter().zip(&self.weight);
        let plain = pairs.map(|(&j, &w)| w * field(j as usize)).sum::<Vec3>();
        if self.shape != Shape::Rigid {
            return plain;
        }
        let spin: Vec3 = (0..self.arm.len())
            .map(|k| self.weight[k] * self.arm[k].cross(&field(self.index[k] as usize)))
            .sum();
        plain - (self.inverse_inertia * spin).cross(&self.offset)
    }

    /// A positive scalar field of the gas, at the point; positive even where weights are not.
    pub fn positive(&self, field: impl Fn(usize) -> f64) -> f64 {
        let pairs = self.index.iter().zip(&self.weight);
        let (sum, norm) = pairs.fold((0.0, 0.0), |(sum, norm), (&j, &w)| {
            (sum + w.abs() * field(j as usize), norm + w.abs())
        });
        if norm > 0.0 { sum / norm } else { 0.0 }
    }
}
