//! Streaming instability: growth of the linear modes linA and linB (Youdin & Johansen 2007, ApJ 662, 613, table 1) of gas and dust that drift through each
//! other, in an axisymmetric shearing box (the x-z plane, three components of velocity) with feedback.
//!
//! Background: Nakagawa, Sekiya & Hayashi (1986); the mode ~ Re[A f exp(lambda t + i k x)], one oblique wave in a box of a wavelength a side, k = K Omega / eta v_K;
//! f and lambda are those of the linearised equations of compressible isothermal gas and pressureless dust, c = 20 eta v_K. Displaced by
//! xi = i k delta / k^2 from square lattices. Forces leave out the pressure of the gas at rest: sums of it make a lattice of particles elastic,
//! with shear waves that are faster (0.08 c with 20 neighbours) than anything in the mode; a wide kernel does the rest. Measured: slope and phase of ln (2/N sum_j exp(-i k x_j)) of the dust, least squares.

use std::f64::consts::TAU;

use dust::Dust;
use nalgebra::Complex;
use nbody::points::Vec3;

use super::{Bar, Row};
use crate::trial::Trial;

const SCENE: &str = r#"
[run]
end_time = 1000.0
[units]
system = "dimensionless"
[domain]
kind = "shearing-box"
dimensions = 2
plane = "xz"
rate = 1.0
headwind = 0.05
[gas.eos]
kind = "isothermal"
sound_speed = 1.0
[gas.hydro]
kernel = "wendland-c6"
neighbours = 60
background_pressure = 1.0
[gas.viscosity]
kind = "none"
[dust.drag]
law = "constant-stokes-number"
"#;

/// eta v_K by the sound speed; Omega = 1.
const HEADWIND: f64 = 0.05;

/// A linear mode.
struct Mode {
    name: &'static str,
    stokes: f64,
    dust_to_gas: f64,
    /// K, in x and in z alike.
    wave_number: f64,
    /// lambda
    rate: [f64; 2],
    /// Amplitudes relative to that of the dust's density: of the gas's density, of the velocities of gas and dust in eta v_K.
    gas_density: [f64; 2],
    gas: [[f64; 2]; 3],
    dust: [[f64; 2]; 3],
    /// Amplitude at the start.
    amplitude: f64,
    /// Times between which growth is fitted.
    fitted: [f64; 2],
}

const LIN_A: Mode = Mode {
    name: "linA",
    stokes: 0.1,
    dust_to_gas: 3.0,
    wave_number: 30.0,
    rate: [0.419_009_132_314, -0.348_018_152_222],
    gas_density: [2.239_097_302e-5, 2.120_321_162e-5],
    gas: [
        [-0.169_136_372_117, 0.036_160_636_552_7],
        [0.133_671_033_926, 0.059_167_289_580_9],
        [0.169_135_496_585, -0.036_160_872_472_4],
    ],
    dust: [
        [-0.139_859_422_797, 0.037_299_966_815_8],
        [0.130_563_467_089, 0.064_055_235_862_5],
        [0.163_952_220_251, -0.023_332_995_738_7],
    ],
    amplitude: 1e-3,
    fitted: [1.0, 5.0],
};

const LIN_B: Mode = Mode {
    name: "linB",
    stokes: 0.1,
    dust_to_gas: 0.2,
    wave_number: 6.0,
    rate: [0.015_486_226_176_5, 0.499_878_751_493],
    gas_density: [-6.744_547_157e-6, -6.912_495_249_1e-5],
    gas: [
        [-0.017_409_022_501_9, -0.277_034_621_901],
        [0.276_798_723_365, -0.018_748_493_570_4],
        [0.017_409_948_881_8, 0.277_042_270_404],
    ],
    dust: [
        [0.046_294_618_455_9, -0.274_305_200_861],
        [0.273_930_739_566, 0.003_937_583_204_27],
        [0.008_323_290_778_09, 0.276_886_238_557],
    ],
    amplitude: 1e-3,
    fitted: [2.0, 40.0],
};

impl Mode {
    /// Length of the box: a wavelength.
    fn side(&self) -> f64 {
        TAU * HEADWIND / self.wave_number
    }

    fn wave_vector(&self) -> Vec3 {
        let k = TAU / self.side();
        Vec3::new(k, 0.0, k)
    }

    /// A exp(i k x) at the start.
    fn wave(&self, x: Vec3) -> Complex<f64> {
        Complex::from_polar(self.amplitude, self.wave_vector().dot(&x))
    }

    /// Velocities of gas and dust in balance, in eta v_K, relative to the shear.
    fn drift(&self) -> [Vec3; 2] {
        let (st, eps) = (self.stokes, self.dust_to_gas);
        let whole = (1.0 + eps).powi(2) + st * st;
        let along = |part: f64| -(1.0 + part * st * st / whole) / (1.0 + eps);
        [
            Vec3::new(2.0 * eps * st / whole, along(eps), 0.0),
            Vec3::new(-2.0 * st / whole, along(-1.0), 0.0),
        ]
    }

    /// Displaces points of relative density `delta` and gives them their velocities.
    fn imprint(
        &self,
        (x, v): (&mut [Vec3], &mut [Vec3]),
        [re, im]: [f64; 2],
        velocity: [[f64; 2]; 3],
        drift: Vec3,
    ) {
        let (k, middle) = (self.wave_vector(), 0.5 * self.side());
        for (x, v) in x.iter_mut().zip(v) {
            let wave = self.wave(*x);
            let density = Complex::new(re, im) * wave;
            let along = (Complex::<f64>::i() * density).re / k.norm_squared();
            *x += along * k;
            let part = |[re, im]: [f64; 2]| (Complex::new(re, im) * wave).re;
            let perturbed = Vec3::new(part(velocity[0]), part(velocity[1]), part(velocity[2]));
            *v = HEADWIND * (drift + perturbed) - Vec3::y() * (1.5 * (x.x - middle));
        }
    }

    /// Gas and dust of `n` particles a side in place.
    fn trial(&self, n: usize) -> Trial {
        let side = self.side();
        let spacing = side / n as f64;
        let block = |density: f64, more: &str| {
            format!(
                "[{{lo=[0.0,0.0,0.0],hi=[{side:e},1.0,{side:e}],spacing={spacing:e},density={density}{more}}}]"
            )
        };
        let overrides = [
            format!("domain.size=[{side:e},1.0,{side:e}]"),
            format!("gas.block={}", block(1.0, "")),
            format!("dust.block={}", block(self.dust_to_gas, "")),
            format!("dust.drag.stokes_number={}", self.stokes),
        ];
        let [gas, dust] = self.drift();
        let mut trial = Trial::new(SCENE, &overrides, |p| {
            self.imprint((&mut p.x, &mut p.v), self.gas_density, self.gas, gas);
        })
        .unwrap_or_else(|refusal| panic!("a built-in scene: {refusal}"));
        let mut p = std::mem::take(&mut trial.system.dust.particles);
        self.imprint((&mut p.x, &mut p.v), [1.0, 0.0], self.dust, dust);
        trial.system.dust = Dust::new(p);
        trial
    }

    /// Amplitude of the wave in the density of points.
    fn amplitude(&self, x: &[Vec3]) -> Complex<f64> {
        let k = self.wave_vector();
        let sum: Complex<f64> = (x.iter())
            .map(|x| Complex::from_polar(1.0, -k.dot(x)))
            .sum();
        2.0 * sum / x.len() as f64
    }

    /// lambda, as `n` particles a side have it.
    fn measured(&self, n: usize) -> [f64; 2] {
        let [begin, end] = self.fitted;
        let stops: Vec<f64> = std::iter::once(0.0)
            .chain((0..=SAMPLES).map(|k| begin + (end - begin) * k as f64 / SAMPLES as f64))
            .collect();
        let (mut t, mut wave) = (Vec::new(), Vec::new());
        let done = self.trial(n).run(&stops, |stop| {
            if stop.books.time > 0.0 {
                t.push(stop.books.time);
                wave.push(self.amplitude(&stop.system.dust.particles.x));
            }
        });
        done.unwrap_or_else(|fault| panic!("a built-in problem: {fault}"));
        let size: Vec<f64> = wave.iter().map(|w| w.norm().ln()).collect();
        // The phase turns by less than half a turn from sample to sample.
        let turns = wave.windows(2).map(|pair| (pair[1] / pair[0]).arg());
        let phase: Vec<f64> = std::iter::once(0.0)
            .chain(turns)
            .scan(0.0, |sum, turn| {
                *sum += turn;
                Some(*sum)
            })
            .collect();
        [slope(&t, &size), slope(&t, &phase)]
    }
}

/// Samples that a growth is fitted to.
const SAMPLES: usize = 32;

/// Slope of the straight line closest to y(x).
fn slope(x: &[f64], y: &[f64]) -> f64 {
    let n = x.len() as f64;
    let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let (up, down) = x.iter().zip(y).fold((0.0, 0.0), |(up, down), (x, y)| {
        (up + (x - mx) * (y - my), down + (x - mx).powi(2))
    });
    up / down
}

fn rows(mode: &Mode, sides: &[usize], [good, acceptable]: [f64; 2]) -> Vec<Row> {
    let last = sides.len() - 1;
    let mut rows = Vec::new();
    for (k, &n) in sides.iter().enumerate() {
        let [growth, turn] = mode.measured(n);
        let bar = |value: f64| match k == last {
            true => Bar::Reference {
                value,
                good,
                acceptable,
            },
            false => Bar::None,
        };
        let name = mode.name;
        rows.push(Row::new(
            format!("{name}, growth by Omega, {n} a wavelength"),
            growth,
            bar(mode.rate[0]),
        ));
        rows.push(Row::new(
            format!("{name}, frequency by Omega, {n} a wavelength"),
            turn,
            bar(mode.rate[1]),
        ));
    }
    rows
}

pub fn lin_a() -> Vec<Row> {
    rows(&LIN_A, &[16, 24, 32], [0.05, 0.25])
}

pub fn lin_b() -> Vec<Row> {
    rows(&LIN_B, &[16, 24], [0.1, 0.25])
}
