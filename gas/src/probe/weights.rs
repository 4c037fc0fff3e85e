//! Weights: how much each gas neighbour counts at a point.
//!
//! w_j = K_j V_j (A + B.r_j), r_j = x_j - x, V = m/rho, with A and B such that sum w = 1 and sum w r = 0: exact for linear fields, and an
//! impulse -w_j J against an impulse J at the point leaves momentum and angular momentum unchanged.
//! K = (1 - (r/R)^2)^2 has the standard deviation of the kernel W of the density, h/2, which makes R 1.5 h (sqrt(2) h in two dimensions): it blurs as
//! much as W does, with half the neighbours, whose outer half have together one part in a hundred of the weight.
//! Where that would need weights below -0.05 in sum (the point is at an edge of the gas): w_j = K_j V_j normalised, and the field is
//! continued from the neighbours' centre b = sum w r by their rigid rotation, f(x) = sum w f - Omega x b,
//! Omega = I^-1 sum w s x f, s = r - b, I = sum w (s^2 1 - s s); the impulse to j is -w_j (J - (I^-1 (b x J)) x s_j), the adjoint of that.
//! Where even I is singular: the normalised weights alone; then angular momentum is not kept.

use fearless_simd::{Level, Simd, SimdBase, f64x8};
use nalgebra::Matrix3;
use nbody::points::{Domain, Vec3};

use super::Reach;
use super::candidates::{Candidates, radius_by_nearest_leaf};
use super::near::{Kernel, LANES, Near, sum};
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
    near: Near,
    /// W / W(0)
    fall: Vec<f64>,
    relative: [Vec<f64>; 3],
}

/// How the neighbours of a point lie: what gradients there follow from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leverage {
    centre: Vec3,
    inverse: Matrix3<f64>,
}

/// Radius of the sphere (disc) in which a point with smoothing length `h` has its neighbours.
pub fn radius(domain: &Domain, h: f64) -> f64 {
    Kernel::new(domain).ratio * h
}

/// Sum of |w| up to which weights exact for linear fields are taken.
pub(super) const MOST_ABSOLUTE: f64 = 1.1;

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
        start: (Vec3, f64),
        available: f64,
        reach: &Reach,
    ) -> bool {
        nbody::widest!(Level::new(), simd => self.fit_lanes(simd, candidates, (domain, reach), start, available))
    }

    #[inline(always)]
    fn fit_lanes<S: Simd>(
        &mut self,
        simd: S,
        candidates: &Candidates,
        (domain, reach): (&Domain, &Reach),
        (x, guess): (Vec3, f64),
        available: f64,
    ) -> bool {
        let kernel = Kernel::new(domain);
        let x = domain.in_plane(x - candidates.centre);
        self.near.choose(simd, candidates, x, available);
        let longest = kernel.ratio * reach.largest;
        let start = (guess * kernel.ratio, available);
        let radius = match self.near.radius(simd, kernel, start, reach.neighbours) {
            Some(radius) => radius,
            None if available >= longest => longest,
            None => return false,
        };
        self.clear(radius / kernel.ratio);
        let count = self.weigh(simd, candidates, kernel, x, radius);
        if count > 0 {
            self.correct(simd, domain);
        } else {
            // What is near the edge of the larger kernel alone is no gas.
            self.rho = 0.0;
        }
        let count = if self.shape == Shape::Empty { 0 } else { count };
        self.index.truncate(count);
        self.weight.truncate(count);
        if self.shape == Shape::Rigid {
            self.arm.truncate(count);
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

    /// Lists the neighbours with K V as weight, and sums the density within `radius`. The columns are filled up to whole lanes with zeros;
    /// returns how many are neighbours.
    #[inline(always)]
    fn weigh<S: Simd>(
        &mut self,
        simd: S,
        candidates: &Candidates,
        kernel: Kernel,
        x: Vec3,
        radius: f64,
    ) -> usize {
        let most = self.near.len() + LANES;
        self.index.resize(most, 0);
        self.weight.resize(most, 0.0);
        self.fall.resize(most, 0.0);
        self.relative.iter_mut().for_each(|r| r.resize(most, 0.0));
        let [rx, ry, rz] = &mut self.relative;
        let (rx, ry, rz) = (&mut rx[..most], &mut ry[..most], &mut rz[..most]);
        let (weight, index) = (&mut self.weight[..most], &mut self.index[..most]);
        let inverse = 1.0 / radius;
        let fall = &mut self.fall[..most];
        self.near.falloffs(simd, kernel, inverse, [fall, weight]);
        let (mut n, mut mass) = (0, 0.0);
        for (i, (q, k)) in self.near.kept(inverse).enumerate() {
            let w = weight[i];
            let near = candidates.at(k as usize);
            mass += near.m * fall[i];
            // Written always, kept when inside: no branch to mispredict.
            weight[n] = w * near.volume;
            index[n] = near.index;
            rx[n] = near.x - x.x;
            ry[n] = near.y - x.y;
            rz[n] = near.z - x.z;
            n += usize::from(q < kernel.near);
        }
        let filled = n.next_multiple_of(LANES);
        for column in [&mut *weight, rx, ry, rz] {
            column[n..filled].fill(0.0);
        }
        self.weight.truncate(filled);
        self.relative.iter_mut().for_each(|r| r.truncate(filled));
        self.rho = mass * kernel.peak(radius);
        n
    }

    /// Makes the weights exact for linear fields, or the best that can be had.
    #[inline(always)]
    fn correct<S: Simd>(&mut self, simd: S, domain: &Domain) {
        let (zeroth, first, second) = self.moments(simd);
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
            if self.absolute(simd, level, slope) < MOST_ABSOLUTE * zeroth {
                self.tilt(simd, level, slope);
                self.shape = Shape::Linear;
                return;
            }
        }
        self.tilt(simd, 1.0, Vec3::zeros());
        self.turn(centre, spread);
    }

    /// Sum of w, w r and w r r.
    #[inline(always)]
    fn moments<S: Simd>(&self, simd: S) -> (f64, Vec3, Matrix3<f64>) {
        let none = f64x8::splat(simd, 0.0);
        let [mut m, mut mx, mut my, mut mz] = [none; 4];
        let [mut xx, mut xy, mut xz, mut yy, mut yz, mut zz] = [none; 6];
        for c in 0..self.weight.len() / LANES {
            let (w, [x, y, z]) = self.lanes(simd, c);
            let (wx, wy, wz) = (w * x, w * y, w * z);
            (m, mx, my, mz) = (m + w, mx + wx, my + wy, mz + wz);
            (xx, xy, xz) = (xx + wx * x, xy + wx * y, xz + wx * z);
            (yy, yz, zz) = (yy + wy * y, yz + wy * z, zz + wz * z);
        }
        let (xy, xz, yz) = (sum(xy), sum(xz), sum(yz));
        (
            sum(m),
            Vec3::new(sum(mx), sum(my), sum(mz)),
            Matrix3::new(sum(xx), xy, xz, xy, sum(yy), yz, xz, yz, sum(zz)),
        )
    }

    /// Weights and relative positions, the c-th lanes of them.
    #[inline(always)]
    fn lanes<S: Simd>(&self, simd: S, c: usize) -> (f64x8<S>, [f64x8<S>; 3]) {
        let range = c * LANES..(c + 1) * LANES;
        let [rx, ry, rz] = &self.relative;
        let w = f64x8::from_slice(simd, &self.weight[range.clone()]);
        let x = f64x8::from_slice(simd, &rx[range.clone()]);
        let y = f64x8::from_slice(simd, &ry[range.clone()]);
        let z = f64x8::from_slice(simd, &rz[range]);
        (w, [x, y, z])
    }

    /// Sum of |w (level + slope.r)|.
    #[inline(always)]
    fn absolute<S: Simd>(&self, simd: S, level: f64, slope: Vec3) -> f64 {
        let mut total = f64x8::splat(simd, 0.0);
        for c in 0..self.weight.len() / LANES {
            let (w, [x, y, z]) = self.lanes(simd, c);
            total += w * (x * slope.x + y * slope.y + z * slope.z + level).abs();
        }
        sum(total)
    }

    /// Multiplies the weights by level + slope.r, and brings their sum to one.
    #[inline(always)]
    fn tilt<S: Simd>(&mut self, simd: S, level: f64, slope: Vec3) {
        let mut total = f64x8::splat(simd, 0.0);
        for c in 0..self.weight.len() / LANES {
            let (w, [x, y, z]) = self.lanes(simd, c);
            let w = w * (x * slope.x + y * slope.y + z * slope.z + level);
            w.store_slice(&mut self.weight[c * LANES..(c + 1) * LANES]);
            total += w;
        }
        let norm = 1.0 / sum(total);
        for w in &mut self.weight {
            *w *= norm;
        }
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

    /// A scalar field of the gas, at the point.
    pub fn scalar(&self, field: impl Fn(usize) -> f64) -> f64 {
        let pairs = self.index.iter().zip(&self.weight);
        pairs.map(|(&j, &w)| w * field(j as usize)).sum()
    }

    /// What gradients follow from: the inverse of sum |w| (r - b)(r - b), b = sum |w| r / sum |w|, zero along the
    /// axes that the domain leaves out. None where the neighbours lie in a plane, or on a line of one.
    pub fn leverage(&self, domain: &Domain) -> Option<Leverage> {
        let places = || self.index.iter().enumerate().map(|(k, _)| self.place(k));
        let pairs = || self.weight.iter().map(|w| w.abs()).zip(places());
        let (mass, first) = pairs().fold((0.0, Vec3::zeros()), |(mass, first), (w, r)| {
            (mass + w, first + w * r)
        });
        let centre = first / mass;
        let mut spread = pairs().fold(Matrix3::zeros(), |sum, (w, r)| {
            let arm = domain.in_plane(r - centre);
            sum + w * arm * arm.transpose()
        });
        for axis in (0..3).filter(|&axis| !domain.axes[axis]) {
            spread[(axis, axis)] = mass * self.h * self.h;
        }
        let enough = spread.determinant() > 1e-6 * (mass * self.h * self.h).powi(3);
        let inverse = spread.try_inverse().filter(|_| enough)?;
        Some(Leverage { centre, inverse })
    }

    /// Gradient of a scalar field of the gas at the point, by least squares: exact for linear fields.
    pub fn gradient(
        &self,
        domain: &Domain,
        leverage: &Leverage,
        field: impl Fn(usize) -> f64,
    ) -> Vec3 {
        let moment = (0..self.index.len()).fold(Vec3::zeros(), |sum, k| {
            let arm = domain.in_plane(self.place(k) - leverage.centre);
            sum + self.weight[k].abs() * field(self.index[k] as usize) * arm
        });
        leverage.inverse * moment
    }

    /// Where neighbour k is, from the point.
    fn place(&self, k: usize) -> Vec3 {
        let [x, y, z] = &self.relative;
        Vec3::new(x[k], y[k], z[k])
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
