//! A layer about the midplane of a disk: places points in it with the wanted density, evenly and without a pattern.
//!
//! Bricks of equal mass, halved across their longest sides until each holds one point, which lies anywhere in it. So every region holds
//! nearly its share of points, and the noise that is left is between neighbours; there the glass cures it.

use std::f64::consts::PI;

use nbody::points::{Domain, Vec3};
use rand::{Rng, RngExt};

use super::Resolution;
use super::disk::Disk;
use super::glass::{Density, Glass};

/// Where the vertical profile ends, in scale heights.
const TOP: f64 = 5.0;
/// Sweeps that a layer is settled for.
const SWEEPS: usize = 10;
/// Layers with h above this part of their scale height are settled thicker than they are.
const RESOLVED: f64 = 0.5;
/// H/R that no layer is thickened beyond.
const THICK: f64 = 0.3;

/// A layer with the disk's surface density and `thickness` times its scale height.
#[derive(Clone, Debug)]
pub struct Layer<'a> {
    disk: &'a Disk,
    thickness: f64,
    pub mass: f64,
    /// ln R, and the mass inside by the whole.
    radii: Vec<(f64, f64)>,
}

const ROWS: usize = 8192;

impl<'a> Layer<'a> {
    /// A layer that knows its density, but cannot place points.
    pub fn bare(disk: &'a Disk, thickness: f64) -> Self {
        Self {
            disk,
            thickness,
            mass: 0.0,
            radii: Vec::new(),
        }
    }

    pub fn new(disk: &'a Disk, thickness: f64) -> Self {
        let (inner, outer) = disk.extent();
        let step = (outer / inner).ln() / ROWS as f64;
        let at = |k: usize| inner.ln() + k as f64 * step;
        let ring = |ln: f64| 2.0 * PI * (2.0 * ln).exp() * disk.sigma(ln.exp()) * step;
        let mut sum = 0.0;
        let mut radii = vec![(at(0), 0.0)];
        for k in 1..=ROWS {
            sum += 0.5 * (ring(at(k - 1)) + ring(at(k)));
            radii.push((at(k), sum));
        }
        radii.iter_mut().for_each(|row| row.1 /= sum);
        Self {
            radii,
            mass: sum,
            ..Self::bare(disk, thickness)
        }
    }

    fn aspect(&self, radius: f64) -> f64 {
        self.thickness * self.disk.aspect(radius)
    }

    /// dln(rho)/dlnR in the midplane.
    pub fn midplane_slope(&self, radius: f64) -> f64 {
        let flare = 0.5 - self.disk.exponent;
        let (_, f_slope) = column(self.aspect(radius));
        self.disk.sigma_slope(radius) - 1.0 - flare - f_slope * flare
    }

    /// The point at the quantiles of R, z at that R, and azimuth.
    pub fn place(&self, [u, w, azimuth]: [f64; 3]) -> Vec3 {
        let radius = self.radius(u);
        let z = radius * self.aspect(radius) * quantile(self.aspect(radius), w);
        let (sin, cos) = (2.0 * PI * azimuth).sin_cos();
        Vec3::new(radius * cos, radius * sin, z)
    }

    /// `n` points, one in each brick that holds 1/n of the mass.
    pub fn bricks(&self, n: usize, random: &mut impl Rng) -> Vec<Vec3> {
        let mut x = Vec::with_capacity(n);
        self.halve(n, [[0.0, 1.0]; 3], random, &mut x);
        x
    }

    /// Fills a brick of quantiles of R, z and azimuth with n points.
    fn halve(&self, n: usize, mut brick: [[f64; 2]; 3], random: &mut impl Rng, x: &mut Vec<Vec3>) {
        if n < 2 {
            let at = brick.map(|[a, b]| a + (b - a) * random.random::<f64>());
            return x.extend((n == 1).then(|| self.place(at)));
        }
        let side = self.sides(&brick);
        let longer = |a: usize, b: usize| if side[b] > side[a] { b } else { a };
        let axis = longer(longer(0, 1), 2);
        // Cuts are uneven at random, lest all bricks of a region have one shape.
        let part = (n as f64 * (0.4 + 0.2 * random.random::<f64>())).round() as usize;
        let part = part.clamp(1, n - 1);
        let [a, b] = brick[axis];
        let cut = a + (b - a) * part as f64 / n as f64;
        brick[axis] = [a, cut];
        self.halve(part, brick, random, x);
        brick[axis] = [cut, b];
        self.halve(n - part, brick, random, x);
    }

    /// Lengths of a brick of quantiles along R, z and azimuth.
    fn sides(&self, [u, w, azimuth]: &[[f64; 2]; 3]) -> [f64; 3] {
        let radius = self.radius(0.5 * (u[0] + u[1]));
        let aspect = self.aspect(radius);
        [
            self.radius(u[1]) - self.radius(u[0]),
            radius * aspect * (quantile(aspect, w[1]) - quantile(aspect, w[0])),
            2.0 * PI * radius * (azimuth[1] - azimuth[0]),
        ]
    }

    /// The radius inside of which the part `u` of the mass lies.
    pub fn radius(&self, u: f64) -> f64 {
        let k = self.radii.partition_point(|row| row.1 <= u).clamp(1, ROWS);
        let ((a, below), (b, above)) = (self.radii[k - 1], self.radii[k]);
        (a + (b - a) * (u - below) / (above - below)).exp()
    }

    /// Points of equal mass settled to a glass, and the radii of their kernels with 64 neighbours.
    pub fn settled(&self, x: Vec<Vec3>) -> (Vec<Vec3>, Vec<f64>) {
        let mass = self.mass / x.len() as f64;
        let sweeps = if x.len() < 64 { 0 } else { SWEEPS };
        let rows = Rows::new(self);
        let mut glass = Glass::new(x, |x| mass / self.density(x), Domain::open(), &rows);
        glass.settle(sweeps);
        glass.points()
    }

    /// `n` settled points of equal mass, however thin the layer is: they settle in one that kernels resolve, which is then pressed flat.
    pub fn pressed(&self, n: usize, random: &mut impl Rng) -> Vec<Vec3> {
        let median = self.radius(0.5);
        let full = Self {
            thickness: 1.0,
            ..self.clone()
        };
        let room = self.mass / n as f64 / full.density(Vec3::new(median, 0.0, 0.0));
        let coarse =
            Resolution::default().smoothing_length(room, 3) / self.disk.scale_height(median);
        // h/H of a layer falls as thickness^(-2/3).
        let needed = (coarse / RESOLVED)
            .powf(1.5)
            .min(THICK / self.disk.aspect(median));
        let thick = Self {
            thickness: needed.max(self.thickness),
            ..self.clone()
        };
        let (mut x, _) = thick.settled(thick.bricks(n, random));
        for x in &mut x {
            let radius = x.x.hypot(x.y);
            let (from, to) = (thick.aspect(radius), self.aspect(radius));
            x.z = to * radius * quantile(to, below(from, x.z / (from * radius)));
        }
        x
    }

    /// Density.
    pub fn density(&self, x: Vec3) -> f64 {
        let radius = x.x.hypot(x.y);
        let aspect = self.aspect(radius);
        let (f, _) = column(aspect);
        let midplane = self.disk.sigma(radius) / ((2.0 * PI).sqrt() * aspect * radius * f);
        midplane * fall(aspect, x.z / (aspect * radius)).exp()
    }

    /// Gradient of the density's logarithm.
    pub fn log_gradient(&self, x: Vec3) -> Vec3 {
        let radius = x.x.hypot(x.y);
        let rows = [self.midplane_slope(radius), self.aspect(radius).powi(-2)];
        gradient(x, radius, rows, self.disk.exponent)
    }
}

/// What a layer's gradient depends on by the radius alone, in rows of equal step in ln R.
struct Rows {
    exponent: f64,
    first: f64,
    step: f64,
    /// dln(rho)/dlnR in the midplane, and (R/H)^2.
    rows: Vec<[f64; 2]>,
}

impl Rows {
    fn new(layer: &Layer) -> Self {
        // Points may leave the disk by a kernel or so.
        let (inner, outer) = layer.disk.extent();
        let (first, last) = ((0.8 * inner).ln(), (1.25 * outer).ln());
        let step = (last - first) / ROWS as f64;
        let row = |k: usize| {
            let radius = (first + k as f64 * step).exp();
            [layer.midplane_slope(radius), layer.aspect(radius).powi(-2)]
        };
        Self {
            exponent: layer.disk.exponent,
            first,
            step,
            rows: (0..=ROWS).map(row).collect(),
        }
    }

    /// The rows about `radius`, weighted; beyond the first and the last they go on straight.
    fn at(&self, radius: f64) -> [f64; 2] {
        let place = (radius.ln() - self.first) / self.step;
        let k = (place.max(0.0) as usize).min(ROWS - 1);
        let (a, b, part) = (self.rows[k], self.rows[k + 1], place - k as f64);
        std::array::from_fn(|c| a[c] + part * (b[c] - a[c]))
    }
}

impl Density for Rows {
    fn log_gradient(&self, x: Vec3) -> [Vec3; 2] {
        let radius = x.x.hypot(x.y);
        let rows = self.at(radius);
        let upwards = rows[1] / (radius * radius);
        [
            gradient(x, radius, rows, self.exponent),
            Vec3::new(0.0, 0.0, upwards),
        ]
    }
}

/// The gradient of ln(rho) at `x` from its slope in the midplane and (R/H)^2 at that radius, with c ~ R^-exponent.
fn gradient(x: Vec3, radius: f64, [midplane, inverse2]: [f64; 2], exponent: f64) -> Vec3 {
    let r = x.norm();
    let ratio = radius / r;
    // By R: of the midplane, and of (GM/c^2)(1/r - 1/R).
    let outwards = midplane + inverse2 * (2.0 * exponent * (ratio - 1.0) - ratio.powi(3) + 1.0);
    let upwards = -inverse2 * ratio * x.z / (r * r);
    Vec3::new(x.x, x.y, 0.0) * (outwards / (radius * radius)) + Vec3::new(0.0, 0.0, upwards)
}

/// ln(rho/rho_mid) at z = s H for H/R = `aspect`: -s^2/2 for a thin disk.
fn fall(aspect: f64, s: f64) -> f64 {
    let root = (1.0 + (aspect * s).powi(2)).sqrt();
    // (1/root - 1) / aspect^2 without cancellation.
    -s * s / (root * (1.0 + root))
}

/// The column's integral of exp(fall) over ds by sqrt(2 pi), and its dln/dln(aspect).
fn column(aspect: f64) -> (f64, f64) {
    let n = 12;
    let step = TOP / f64::from(n);
    let (mut sum, mut change) = (0.5, 0.0);
    for k in 1..=n {
        let s = f64::from(k) * step;
        let root = (1.0 + (aspect * s).powi(2)).sqrt();
        let (e, end) = (fall(aspect, s), if k == n { 0.5 } else { 1.0 });
        sum += end * e.exp();
        change += end * e.exp() * (-2.0 * e - s * s / root.powi(3));
    }
    (sum * step * (2.0 / PI).sqrt(), change / sum)
}

/// Cells of a column's upper half, for sums of `fall`.
const CELLS: usize = 200;

/// s = z/H below which the part `w` of a column lies.
fn quantile(aspect: f64, w: f64) -> f64 {
    let step = TOP / CELLS as f64;
    let (f, _) = column(aspect);
    let wanted = (2.0 * w - 1.0).abs() * f * (PI / 2.0).sqrt() / step;
    let (mut sum, mut last) = (0.0, 1.0);
    for k in 1..=CELLS {
        let next = fall(aspect, k as f64 * step).exp();
        let cell = 0.5 * (last + next);
        if sum + cell >= wanted || k == CELLS {
            let s = step * ((k - 1) as f64 + ((wanted - sum) / cell).min(1.0));
            return s.copysign(w - 0.5);
        }
        sum += cell;
        last = next;
    }
    unreachable!("the last cell ends the search")
}

/// The part of a column below s = z/H, the inverse of `quantile`.
fn below(aspect: f64, s: f64) -> f64 {
    let step = TOP / CELLS as f64;
    let (f, _) = column(aspect);
    let place = (s.abs() / step).min(CELLS as f64);
    let value = |k: usize| fall(aspect, k as f64 * step).exp();
    let whole = (place as usize).min(CELLS - 1);
    let cell = |k: usize| 0.5 * (value(k) + value(k + 1));
    let sum = (0..whole).map(cell).sum::<f64>() + (place - whole as f64) * cell(whole);
    let half = sum * step / (f * (PI / 2.0).sqrt());
    (0.5 * (1.0 + half.copysign(s))).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use nbody::points::random::{Purpose, stream};

    use super::super::disk::tests::flat;
    use super::*;

    /// Points, and the part of them where `which` holds.
    fn part(x: &[Vec3], which: impl Fn(&Vec3) -> bool) -> f64 {
        x.iter().filter(|x| which(x)).count() as f64 / x.len() as f64
    }

    #[test]
    fn quantiles_and_parts_of_a_column_are_inverse() {
        for aspect in [0.01, 0.1, 0.3] {
            for w in [0.001, 0.2, 0.5, 0.77, 0.9999] {
                assert!((below(aspect, quantile(aspect, w)) - w).abs() < 1e-9, "{w}");
            }
        }
        // A thin column is Gaussian: one part in 6.3 is above one scale height.
        // Cells are cut straight: step^2/12 of the slope.
        assert!((below(1e-4, 1.0) - 0.841_344_7).abs() < 2e-5);
    }

    #[test]
    fn bricks_hold_their_share() {
        let disk = flat();
        let layer = Layer::new(&disk, 1.0);
        let n = 20_000;
        let x = layer.bricks(n, &mut stream(1, Purpose::GasPositions, 0, 0));
        assert_eq!(x.len(), n);
        // Bricks that a cut crosses add the noise of a uniform number each: all columns, five bricks high, at the midplane.
        let crossed = n as f64 / 5.0;
        let bar = 4.0 * (crossed / 12.0).sqrt() / n as f64;
        let radius = layer.radius(0.37);
        assert!((part(&x, |x| x.xy().norm() < radius) - 0.37).abs() < bar);
        assert!((part(&x, |x| x.z < 0.0) - 0.5).abs() < bar);
        assert!((part(&x, |x| x.x < x.y) - 0.5).abs() < bar);
        let high = |x: &Vec3| x.z > disk.scale_height(x.xy().norm());
        assert!((part(&x, high) - 0.158_7).abs() < bar);
    }

    #[test]
    fn rows_have_the_gradient_of_their_layer() {
        let disk = flat();
        let layer = Layer::new(&disk, 0.7);
        let rows = Rows::new(&layer);
        let (inner, outer) = disk.extent();
        for k in 0..=400 {
            let radius = 0.85 * inner * (1.4 * outer / inner).powf(f64::from(k) / 400.0);
            let height = 0.7 * disk.scale_height(radius);
            let x = Vec3::new(0.6 * radius, 0.8 * radius, 1.3 * height);
            let [force, slope] = rows.log_gradient(x);
            let error = (force - layer.log_gradient(x)).norm() * height;
            assert!(error < 2e-5, "{error} at {radius}");
            // Of a thin layer the fall is Gaussian.
            assert!((slope.z * height * height - 1.0).abs() < 1e-6 && slope.xy().norm() == 0.0);
        }
    }

    /// How a glass feels the wanted gradient: pressure against gravity along z by least squares, and the rms residual force by 1/H.
    fn balance(glass: &mut Glass<Rows>, layer: &Layer) -> (f64, f64) {
        let (mut along, mut weight, mut square, mut n) = (0.0, 0.0, 0.0, 0.0);
        for (x, force) in glass.forces() {
            let height = layer.disk.scale_height(x.xy().norm());
            if (1.2..1.7).contains(&x.xy().norm()) && x.z.abs() < 2.0 * height {
                let gravity = layer.log_gradient(x).z;
                along += (gravity - force.z) * gravity;
                weight += gravity * gravity;
                square += (force.norm() * height).powi(2);
                n += 1.0;
            }
        }
        (along / weight, f64::sqrt(square / n))
    }

    #[test]
    fn the_pressure_of_a_settled_layer_carries_it() {
        let disk = Disk {
            outer_radius: 1.9,
            ..flat()
        };
        let layer = Layer::new(&disk, 1.0);
        let n = 20_000;
        let mass = layer.mass / f64::from(n);
        let x = layer.bricks(n as usize, &mut stream(1, Purpose::GasPositions, 0, 0));
        let rows = Rows::new(&layer);
        let mut glass = Glass::new(x, |x| mass / layer.density(x), Domain::open(), &rows);
        glass.settle(SWEEPS);
        // Noise alone lets the pressure of the unsettled start be twelve per cent too high, and the residual larger than one.
        let (pressure, residual) = balance(&mut glass, &layer);
        assert!((pressure - 1.0).abs() < 0.0013, "{pressure}");
        assert!(residual < 0.05, "{residual}");
    }

    #[test]
    fn points_of_a_layer_thinner_than_a_kernel_come_to_rest() {
        let disk = flat();
        let layer = Layer::new(&disk, 0.1);
        let random = &mut stream(1, Purpose::GasPositions, 0, 0);
        let rows = Rows::new(&layer);
        let x = layer.bricks(2000, random);
        let mass = layer.mass / 2000.0;
        let mut glass = Glass::new(x, |x| mass / layer.density(x), Domain::open(), &rows);
        glass.settle(SWEEPS);
        // Kernels feel no pressure from within the layer: what is left of its thickness is what ten sweeps leave, unless points swing.
        let (x, _) = glass.points();
        let height = |x: &Vec3| 0.1 * disk.scale_height(x.xy().norm());
        let square: f64 = x.iter().map(|x| (x.z / height(x)).powi(2)).sum();
        let rms = (square / 2000.0).sqrt();
        assert!(rms < 0.016, "{rms}");
    }
}
