//! A gas disk about a star, vertically hydrostatic, its rotation balancing gravity and pressure.
//!
//! Sigma = Sigma0 (R/R0)^slope / [(1 + (R_in/R)^(1/d_in)) (1 + (R/R_out)^(1/d_out))],  d = taper H / (2 R) at the edge
//! rho = Sigma / (sqrt(2 pi) H f) exp[(G M / c^2) (1/r - 1/R)],  c = c0 (R/R0)^-exponent,  H = c / Omega_K,  f(H/R) = 1 + O(H^2/R^2)
//! v_phi^2 = R dPhi/dR + (R/rho) dP/dR = v_K^2 [1 - 2 exponent (1 - R/r)] + c^2 dln(P_mid)/dlnR
//!
//! At an edge's radius Sigma is half of the power law; the mass is that of sharp edges but for O(d^2). The specific angular momentum grows
//! outwards for tapers above about one (at the edge dln l^2/dlnR = 1 - 1/taper^2). Nothing lies beyond 5 H.

use gas::Particles;
use nbody::points::Vec3;
use nbody::points::random::{Purpose, stream};

use super::Resolution;
use super::layer::Layer;

/// Particles that fill one kernel.
const FEWEST: usize = 64;

/// Largest outer by inner radius.
const WIDEST: f64 = 1e6;

/// Parameters of a gas disk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk {
    pub particles: usize,
    /// Sigma0: surface density at `reference_radius` but for the tapers.
    pub surface_density: f64,
    /// Exponent of the surface density, e.g. -1.
    pub slope: f64,
    pub reference_radius: f64,
    pub inner_radius: f64,
    pub outer_radius: f64,
    /// Width of the edges in their scale heights.
    pub taper: f64,
    /// H/R at `reference_radius`.
    pub aspect_ratio: f64,
    /// Sound speed falls as R^-exponent.
    pub exponent: f64,
    pub star_mass: f64,
    pub g: f64,
}

/// How far the tapers' tails reach, in e-foldings.
const TAIL: f64 = 9.0;

impl Disk {
    /// Isothermal sound speed at the cylindrical radius `radius`.
    pub fn sound_speed(&self, radius: f64) -> f64 {
        let kepler = (self.g * self.star_mass / self.reference_radius).sqrt();
        self.aspect_ratio * kepler * (radius / self.reference_radius).powf(-self.exponent)
    }

    /// H/R.
    pub fn aspect(&self, radius: f64) -> f64 {
        self.aspect_ratio * (radius / self.reference_radius).powf(0.5 - self.exponent)
    }

    /// H = c / Omega_K.
    pub fn scale_height(&self, radius: f64) -> f64 {
        self.aspect(radius) * radius
    }

    /// Both edges: radius and width in ln R of the logistic taper, signed so that the disk lies where ln(R/edge)/width > 0.
    fn edges(&self) -> [(f64, f64); 2] {
        let width = |radius| 0.5 * self.taper * self.aspect(radius);
        [
            (self.inner_radius, width(self.inner_radius)),
            (self.outer_radius, -width(self.outer_radius)),
        ]
    }

    /// Surface density.
    pub fn sigma(&self, radius: f64) -> f64 {
        self.edges().iter().fold(
            self.surface_density * (radius / self.reference_radius).powf(self.slope),
            |sigma, (edge, width)| sigma / (1.0 + (edge / radius).powf(1.0 / width)),
        )
    }

    /// dln(Sigma)/dlnR.
    pub(super) fn sigma_slope(&self, radius: f64) -> f64 {
        self.edges()
            .iter()
            .fold(self.slope, |slope, (edge, width)| {
                slope + 1.0 / (width * (1.0 + (radius / edge).powf(1.0 / width)))
            })
    }

    /// The radii between which there is gas.
    pub fn extent(&self) -> (f64, f64) {
        let [(inner, a), (outer, b)] = self.edges();
        (inner * (-TAIL * a).exp(), outer * (-TAIL * b).exp())
    }

    /// Mass of the whole disk.
    pub fn mass(&self) -> f64 {
        Layer::new(self, 1.0).mass
    }

    /// Density.
    pub fn density(&self, x: Vec3) -> f64 {
        Layer::bare(self, 1.0).density(x)
    }

    /// Velocity of gas in balance at `x`; the outward acceleration `extra` along R adds to gravity and pressure.
    ///
    /// Not a number where no rotation can balance them.
    pub fn rotation(&self, x: Vec3, extra: f64) -> Vec3 {
        let radius = x.x.hypot(x.y);
        let kepler2 = self.g * self.star_mass / radius;
        let height = 1.0 - radius / x.norm();
        let midplane = Layer::bare(self, 1.0).midplane_slope(radius) - 2.0 * self.exponent;
        let speed2 = kepler2 * (1.0 - 2.0 * self.exponent * height)
            + self.sound_speed(radius).powi(2) * midplane
            - radius * extra;
        speed2.sqrt() / radius * Vec3::new(-x.y, x.x, 0.0)
    }

    /// Smallest dln(l^2)/dlnR in the midplane, l the specific angular momentum: positive where the disk is Rayleigh stable.
    pub fn rayleigh(&self) -> f64 {
        let (inner, outer) = self.extent();
        let l2 =
            |radius: f64| (radius * self.rotation(Vec3::new(radius, 0.0, 0.0), 0.0).norm()).powi(2);
        let n = 2000;
        let step = (outer / inner).ln() / f64::from(n);
        let slope = |k: i32| {
            let radius = inner * (f64::from(k) * step).exp();
            let d = 1e-4;
            (l2(radius * f64::exp(d)) / l2(radius * f64::exp(-d))).ln() / (2.0 * d)
        };
        // `f64::min` would lose a NaN.
        let least = |a: f64, b: f64| if a <= b || a.is_nan() { a } else { b };
        (0..=n).map(slope).fold(f64::INFINITY, least)
    }

    /// The disk as equal-mass particles, settled, in balanced rotation about a star at rest in the origin, which is their centre of mass.
    ///
    /// Smoothing lengths are for `resolution`; internal energies are left to the equation of state.
    pub fn gas(&self, resolution: Resolution, seed: u64, first_id: u64) -> Particles {
        self.check();
        let layer = Layer::new(self, 1.0);
        let mass = layer.mass / self.particles as f64;
        let x = layer.bricks(
            self.particles,
            &mut stream(seed, Purpose::GasPositions, 0, 0),
        );
        let (mut x, support) = layer.settled(x);
        let centre = x.iter().sum::<Vec3>() / x.len().max(1) as f64;
        x.iter_mut().for_each(|x| *x -= centre);
        let mut v: Vec<Vec3> = x.iter().map(|&x| self.rotation(x, 0.0)).collect();
        let drift = v.iter().sum::<Vec3>() / v.len().max(1) as f64;
        v.iter_mut().for_each(|v| *v -= drift);
        // A settled kernel holds 64 neighbours; others hold theirs in proportion to the volume.
        let scale = (resolution.neighbours / 64.0).cbrt() / resolution.support;
        let h = support.iter().map(|s| s * scale).collect();
        let mut particles = super::gas(x, h, mass, first_id);
        particles.v = v;
        particles
    }

    /// Velocities of gas and of grains of stopping time `t_stop` that drift through each other at `x`, dust by gas density being
    /// `dust_to_gas` there (Nakagawa, Sekiya & Hayashi 1986; without settling).
    pub fn drift(&self, x: Vec3, t_stop: f64, dust_to_gas: f64) -> (Vec3, Vec3) {
        let radius = x.x.hypot(x.y);
        let out = Vec3::new(x.x, x.y, 0.0) / radius;
        let along = Vec3::new(-out.y, out.x, 0.0);
        let kepler = (self.g * self.star_mass / x.norm().powi(3)).sqrt() * radius;
        let stokes = t_stop * kepler / radius;
        // How much slower than grains alone the gas alone is.
        let lag = kepler - self.rotation(x, 0.0).dot(&along);
        let load = 1.0 + dust_to_gas;
        let scale = lag / (stokes * stokes + load * load);
        let gas = (kepler - scale * (load + stokes * stokes)) * along
            + 2.0 * dust_to_gas * stokes * scale * out;
        let dust = (kepler - scale * load) * along - 2.0 * stokes * scale * out;
        (gas, dust)
    }

    /// Why no such disk can be made of particles, if none can.
    pub fn flaw(&self) -> Option<String> {
        let positive = |x: f64| x > 0.0 && x.is_finite();
        let all = [
            self.inner_radius,
            self.outer_radius,
            self.reference_radius,
            self.aspect_ratio,
            self.taper,
            self.star_mass,
            self.g,
        ];
        if self.particles < FEWEST {
            return Some(format!(
                "{} particles are too few for a disk, of which one kernel holds {FEWEST}",
                self.particles
            ));
        }
        let sound = all.into_iter().all(positive) && self.inner_radius < self.outer_radius;
        if !sound || self.outer_radius / self.inner_radius > WIDEST {
            return Some(format!(
                "a disk from {:e} to {:e} is wider than the factor {WIDEST:e} that its layers follow",
                self.inner_radius, self.outer_radius
            ));
        }
        let layer = Layer::new(self, 1.0);
        let inside = [
            layer.mass,
            layer.radius(0.0),
            layer.radius(1.0),
            self.surface_density,
        ];
        let slim = [self.inner_radius, self.outer_radius].map(|r| self.aspect(r));
        if !inside.into_iter().chain(slim).all(positive) {
            let sentence = "its slope, exponent, taper and reference radius make a mass or a height that is no number";
            return Some(sentence.to_owned());
        }
        for part in [0.0, 0.5, 1.0] {
            let radius = layer.radius(part);
            if !self
                .rotation(Vec3::new(radius, 0.0, 0.0), 0.0)
                .y
                .is_finite()
            {
                return Some(format!("its pressure leaves no rotation at {radius:e}"));
            }
        }
        None
    }

    fn check(&self) {
        let flaw = self.flaw();
        assert!(flaw.is_none(), "a disk can be made: {flaw:?}");
    }
}

#[cfg(test)]
pub(super) mod tests {
    use std::f64::consts::PI;
    use std::sync::OnceLock;

    use nbody::points::Columns;

    use super::*;

    pub fn flat() -> Disk {
        Disk {
            particles: 0,
            surface_density: 1e-4,
            slope: -1.0,
            reference_radius: 1.0,
            inner_radius: 1.0,
            outer_radius: 4.0,
            taper: 2.0,
            aspect_ratio: 0.05,
            exponent: 0.25,
            star_mass: 1.0,
            g: 1.0,
        }
    }

    fn thick() -> Disk {
        Disk {
            aspect_ratio: 0.15,
            exponent: 0.4,
            slope: -0.5,
            star_mass: 2.0,
            g: 3.0,
            ..flat()
        }
    }

    fn places() -> impl Iterator<Item = Vec3> {
        let radii = [0.9, 1.0, 1.3, 2.5, 4.0, 4.4];
        radii.into_iter().flat_map(|radius| {
            [-0.2, 0.0, 0.07, 0.3].map(|z| Vec3::new(0.6 * radius, 0.8 * radius, z * radius))
        })
    }

    /// Derivative of `f` along `axis` at `x`, of fourth order.
    fn slope(f: impl Fn(Vec3) -> f64, x: Vec3, axis: Vec3) -> f64 {
        let d = 1e-3;
        let central = |d: f64| (f(x + d * axis) - f(x - d * axis)) / (2.0 * d);
        (4.0 * central(0.5 * d) - central(d)) / 3.0
    }

    fn pressure(disk: &Disk, x: Vec3) -> f64 {
        disk.sound_speed(x.xy().norm()).powi(2) * disk.density(x)
    }

    #[test]
    fn rotation_pressure_and_gravity_balance_everywhere() {
        for disk in [flat(), thick()] {
            for x in places() {
                let radius = x.xy().norm();
                let out = Vec3::new(x.x, x.y, 0.0) / radius;
                let push = |axis| -slope(|x| pressure(&disk, x), x, axis) / disk.density(x);
                let gravity = -disk.g * disk.star_mass * x / x.norm().powi(3);
                let extra = 0.01 * disk.g;
                let v = disk.rotation(x, extra);
                let scale = gravity.norm();
                let outwards = gravity.dot(&out) + push(out) + extra + v.norm_squared() / radius;
                assert!((outwards / scale).abs() < 1e-6, "{outwards} at {x}");
                assert!(
                    ((gravity.z + push(Vec3::z())) / scale).abs() < 1e-6,
                    "at {x}"
                );
                assert!(v.dot(&out).abs() < 1e-15 * v.norm() && v.z == 0.0);
                assert!(x.x * v.y - x.y * v.x > 0.0);
            }
        }
    }

    #[test]
    fn the_density_has_the_wanted_gradient_and_column() {
        for disk in [flat(), thick()] {
            let layer = Layer::bare(&disk, 0.7);
            for x in places() {
                let gradient = layer.log_gradient(x);
                for axis in [Vec3::x(), Vec3::y(), Vec3::z()] {
                    let exact = slope(|x| layer.density(x).ln(), x, axis);
                    let h = 0.7 * disk.scale_height(x.xy().norm());
                    assert!((gradient.dot(&axis) - exact).abs() * h < 1e-6, "at {x}");
                }
            }
            for radius in [1.0, 2.0, 4.0] {
                let height = 0.7 * disk.scale_height(radius);
                let n = 2000;
                let z = |k: i32| height * 5.0 * (f64::from(k) + 0.5) / f64::from(n);
                let half: f64 = (0..n)
                    .map(|k| layer.density(Vec3::new(radius, 0.0, z(k))))
                    .sum();
                let sigma = 2.0 * half * height * 5.0 / f64::from(n);
                assert!((sigma / disk.sigma(radius) - 1.0).abs() < 1e-5, "{sigma}");
            }
        }
    }

    #[test]
    fn tapers_keep_the_disk_rayleigh_stable_and_its_mass() {
        for disk in [flat(), thick()] {
            // 1 - 1/taper^2 = 0.75 but for the power laws and the change of c across the edge.
            assert!((disk.rayleigh() - 0.75).abs() < 0.1, "{}", disk.rayleigh());
            assert!(Disk { taper: 0.7, ..disk }.rayleigh() < 0.0);
            let power = disk.slope + 2.0;
            let sharp = 2.0
                * PI
                * disk.surface_density
                * (disk.outer_radius.powf(power) - disk.inner_radius.powf(power))
                / power;
            // The edges' second moments add about (pi d)^2/6 power^2 of their own share.
            let [(_, a), (_, b)] = disk.edges();
            let bar = (3.2 * a.abs().max(b.abs()) * power).powi(2) / 3.0;
            assert!(
                (disk.mass() / sharp - 1.0).abs() < bar,
                "{}",
                disk.mass() / sharp - 1.0
            );
        }
    }

    #[test]
    fn drift_is_that_of_nakagawa_sekiya_and_hayashi() {
        let disk = flat();
        let x = Vec3::new(0.0, 2.0, 0.0);
        let omega = (1.0f64 / 8.0).sqrt();
        let (kepler, gas_alone) = (omega * 2.0, disk.rotation(x, 0.0).norm());
        let (t_stop, load) = (0.3 / omega, 0.2);
        let (gas, dust) = disk.drift(x, t_stop, load);
        // Residuals of the equations of motion of both in the frame that rotates with the Kepler speed, linear in the small velocities.
        let local = |v: Vec3| (v.y, -v.x - kepler);
        let ((gr, gp), (dr, dp)) = (local(gas), local(dust));
        let push = 2.0 * omega * (kepler - gas_alone);
        let residuals = [
            2.0 * omega * gp - load * (gr - dr) / t_stop + push,
            -0.5 * omega * gr - load * (gp - dp) / t_stop,
            2.0 * omega * dp - (dr - gr) / t_stop,
            -0.5 * omega * dr - (dp - gp) / t_stop,
        ];
        for r in residuals {
            assert!((r / push).abs() < 1e-12, "{residuals:?}");
        }
        let (_, tied) = disk.drift(x, 0.0, 0.0);
        assert!((tied - disk.rotation(x, 0.0)).norm() < 1e-14);
    }

    /// Radius of the kernel with 64 neighbours about `x`, and the density there, by definition.
    fn kernel(x: Vec3, gas: &Particles) -> (f64, f64) {
        let mut near: Vec<f64> = gas.x.iter().map(|y| (y - x).norm()).collect();
        near.select_nth_unstable_by(400, f64::total_cmp);
        let density = |support: f64| -> f64 {
            let one = |q: f64| (1.0 - q).max(0.0).powi(4) * (1.0 + 4.0 * q);
            let sum: f64 = near[..400].iter().map(|r| one(r / support)).sum();
            sum * 10.5 / PI / support.powi(3)
        };
        let (mut lo, mut hi) = (0.0, near[400]);
        for _ in 0..50 {
            let middle = 0.5 * (lo + hi);
            let count = 4.0 / 3.0 * PI * middle.powi(3) * density(middle);
            if count < 64.0 {
                lo = middle;
            } else {
                hi = middle;
            }
        }
        (lo, density(lo) * gas.m[0])
    }

    fn rms(values: impl Iterator<Item = f64>) -> f64 {
        let values: Vec<f64> = values.collect();
        (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt()
    }

    fn narrow() -> (Disk, &'static Particles) {
        static GAS: OnceLock<Particles> = OnceLock::new();
        let disk = Disk {
            particles: 20_000,
            outer_radius: 1.8,
            ..flat()
        };
        let gas = GAS.get_or_init(|| disk.gas(Resolution::default(), 1, 10));
        (disk, gas)
    }

    #[test]
    fn settled_gas_has_the_mass_and_the_thickness_of_its_disk() {
        let (disk, gas) = narrow();
        let n = disk.particles as f64;
        assert_eq!((gas.id[0], gas.id[19_999]), (10, 20_009));
        assert!((gas.m.iter().sum::<f64>() / disk.mass() - 1.0).abs() < 1e-12);
        assert!((gas.x.iter().sum::<Vec3>() / n).norm() < 1e-14);
        assert!((gas.v.iter().sum::<Vec3>() / n).norm() < 1e-14);
        // Kernels smooth the edges: their rings hold 1.4 % less; others are right to 0.5 %.
        for (a, b, bar) in [
            (1.0, 1.2, 0.025),
            (1.2, 1.4, 0.01),
            (1.4, 1.6, 0.01),
            (1.6, 1.8, 0.02),
        ] {
            let inside = |x: &&Vec3| (a..b).contains(&x.xy().norm());
            let ring: Vec<Vec3> = gas.x.iter().filter(inside).copied().collect();
            let step = (b - a) / 200.0;
            let radius = |k: i32| a + (f64::from(k) + 0.5) * step;
            let mass = |k: i32| 2.0 * PI * radius(k) * disk.sigma(radius(k)) * step;
            let ratio = ring.len() as f64 * gas.m[0] / (0..200).map(mass).sum::<f64>();
            assert!((ratio - 1.0).abs() < bar, "{ratio} from {a} to {b}");
            let height = rms(ring.iter().map(|x| x.z / disk.scale_height(x.xy().norm())));
            assert!((height - 1.0).abs() < 0.01, "{height} from {a} to {b}");
        }
    }

    #[test]
    fn few_particles_and_thick_disks_stay_finite() {
        for particles in [64, 300] {
            for disk in [flat(), thick()] {
                let disk = Disk { particles, ..disk };
                let gas = disk.gas(Resolution::default(), 1, 0);
                assert!(gas.len() == particles && gas.non_finite().is_none());
            }
        }
    }

    #[test]
    fn settled_gas_is_quiet() {
        let (disk, gas) = narrow();
        let height = |x: Vec3| x.z.abs() / disk.scale_height(x.xy().norm());
        let middle =
            |&i: &usize| (1.2..1.6).contains(&gas.x[i].xy().norm()) && height(gas.x[i]) < 0.3;
        let sample: Vec<usize> = (0..gas.x.len()).step_by(7).filter(middle).collect();
        let mut ratios = Vec::new();
        for &i in &sample {
            let (support, density) = kernel(gas.x[i], gas);
            let h = support / Resolution::default().support;
            assert!((gas.h[i] / h - 1.0).abs() < 1e-3, "{} {h}", gas.h[i]);
            ratios.push(density / disk.density(gas.x[i]));
        }
        let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
        let noise = rms(ratios.iter().map(|r| r / mean - 1.0));
        // At h = 0.7 H the kernel sees the mean over a good part of the layer: eight per cent below the density in its middle.
        assert!((mean - 0.92).abs() < 0.015, "{mean}");
        assert!(noise < 0.015, "{noise}");
    }
}
