//! Axisymmetric waves in a razor-thin annulus that pulls itself: one that oscillates (Q = 1.5) and some that grow (Q = 0.6, 0.5).
//!
//! omega^2 = kappa^2 - 2 pi G Sigma k f + c^2 k^2,   f = exp(-k sqrt(2) L) of the softening length L ([`sheet`](super::sheet))
//!
//! G = M = 1, annulus from 0.55 to 1.45 with soft edges, wavelength 0.15: k R = 42. c is such that the wave stands at the least omega^2 where Q is
//! what it should be, so that it does not travel; where it grows, Sigma(R) falls outwards as kappa^2 does, so that omega^2 is even about R = 1.
//! 40 neighbours: with the 20 of the plane's default, rings withstand compression 12 % too much.
//! Rings are moved by A sin(k (R - 1)) / sqrt(R), with the angular momentum that they had; A k = 1e-3. Two runs of opposite A: half their
//! difference is the wave, without what the annulus does of its own. Its part along the sine within two wavelengths about R = 1 is fitted by
//! cos(omega t) or cosh. kappa of the reference is that of the rotation at the start, 2 Omega / R d(R^2 Omega)/dR, to which the annulus's own pull adds.
//! Pressure is stiffer than c^2 k^2 by what sums over a kernel make of the wave ([`stiffness`]): where gravity and pressure nearly balance, that is
//! most of the error. The rate is judged by omega^2 of the gas, and by omega^2 of its sums.
//! Sources: Toomre (1964), ApJ 139, 1217; Binney & Tremaine (2008), section 6.2.3; corrections to tight winding are O(1 / (k R)^2).

use std::f64::consts::{PI, TAU};

use gas::WendlandC4;
use nalgebra::{Matrix4, Vector4};
use nbody::points::{Fault, Vec3};

use self::course::fit;
use self::stiffness::stiffening;
use super::sheet::{self, Ring, Sheet};
use super::{Bar, Row};
use crate::trial::Trial;

mod course;
mod stiffness;

const NEIGHBOURS: f64 = 40.0;
const WAVELENGTH: f64 = 0.15;
const AMPLITUDE: f64 = 1e-3;
/// Half a particle's distance.
const SOFTENING: f64 = 0.005;
/// Where the surface density is half of what it would be without edges, by its distance from R = 1, and how wide the edges are.
const HALF_WIDTH: f64 = 0.45;
const EDGE: f64 = 0.02;
/// Up to what distance from R = 1 omega is even.
const EVEN: f64 = 0.25;
const STOPS: usize = 24;

/// A wave to look at.
struct Case {
    q: f64,
    /// How long it is followed, in 1/Omega at R = 1.
    time: f64,
    particles: usize,
    /// Acceptable relative error of its rate.
    bar: f64,
}

const CASES: [Case; 3] = [
    Case {
        q: 1.5,
        time: 3.0,
        particles: 60_000,
        bar: 0.15,
    },
    Case {
        q: 0.6,
        time: 2.5,
        particles: 120_000,
        bar: 0.2,
    },
    Case {
        q: 0.5,
        time: 2.0,
        particles: 60_000,
        bar: 0.15,
    },
];

impl Case {
    fn k(&self) -> f64 {
        TAU / WAVELENGTH
    }

    fn reduction(&self) -> f64 {
        (-self.k() * 2f64.sqrt() * SOFTENING).exp()
    }

    /// c = kappa f / (Q k): k is that of the least omega^2.
    fn sound_speed(&self) -> f64 {
        self.reduction() / (self.q * self.k())
    }

    /// omega^2 = 1 - (f/Q)^2 at R = 1.
    fn square(&self) -> f64 {
        1.0 - (self.reduction() / self.q).powi(2)
    }

    /// Surface density without edges.
    fn within(&self, r: f64) -> f64 {
        let wave = (self.sound_speed() * self.k()).powi(2);
        // Where much of kappa^2 is left, no surface density could make up for how it falls.
        let kappa2 = match self.square() > 0.0 {
            true => 1.0,
            false => r.clamp(1.0 - EVEN, 1.0 + EVEN).powi(-3),
        };
        (kappa2 + wave - self.square()) / (TAU * self.k() * self.reduction())
    }

    fn sigma(&self, r: f64) -> f64 {
        self.within(r) / (1.0 + (((r - 1.0).abs() - HALF_WIDTH) / EDGE).exp())
    }

    /// What sums over particles of mass `m` add to omega^2 at R = 1: H is that of the wanted neighbours.
    fn stiffer(&self, m: f64) -> f64 {
        let reach = (NEIGHBOURS * m / (PI * self.within(1.0))).sqrt();
        (self.sound_speed() * self.k()).powi(2) * stiffening::<WendlandC4>(self.k() * reach)
    }

    /// What the wave is like at `r`.
    fn shape(&self, r: f64) -> f64 {
        (self.k() * (r - 1.0)).sin() / r.sqrt()
    }

    fn scene(&self) -> String {
        let keys = format!(
            r#"
[gas]
softening = {SOFTENING}
[gas.eos]
kind = "isothermal"
sound_speed = {}
[gas.hydro]
kernel = "wendland-c4"
neighbours = {NEIGHBOURS}
[gas.viscosity]
kind = "none"
[gravity]
pulls = {{ gas = ["gas"] }}
"#,
            self.sound_speed()
        );
        sheet::scene(self.particles, (1.0, 0.1), &keys)
    }
}

pub fn rows() -> Vec<Row> {
    let rows = CASES.iter().flat_map(|case| {
        let found = Wave::of(case).unwrap_or_else(|fault| panic!("a built-in problem: {fault}"));
        let (word, sign) = match found.expected > 0.0 {
            true => ("frequency of oscillation", 1.0),
            false => ("rate of growth", -1.0),
        };
        let rate = |square: f64| (sign * square).sqrt();
        let judged = |of: &str, square: f64| {
            Row::new(
                format!("Q = {}: {word}, Omega{of}", case.q),
                rate(found.square),
                Bar::Reference {
                    value: rate(square),
                    good: 0.03,
                    acceptable: case.bar,
                },
            )
        };
        [
            judged("", found.expected),
            judged(", by that of the sums", found.expected + found.stiffer),
            Row::new(
                format!(
                    "Q = {}: omega^2 with half the gravity, for comparison",
                    case.q
                ),
                found.halved,
                Bar::None,
            ),
            Row::new(
                format!("Q = {}: what the fit leaves, of the wave", case.q),
                found.rest,
                Bar::Limit([0.03, 0.1]),
            ),
        ]
    });
    rows.collect()
}

/// What became of a wave.
#[derive(Clone, Copy, Debug)]
struct Wave {
    /// omega^2 as measured, as it should be, and as it would be with half the gravity.
    square: f64,
    expected: f64,
    halved: f64,
    /// What the sums add to it.
    stiffer: f64,
    /// Root mean square of what the fit leaves, by that of the wave.
    rest: f64,
}

impl Wave {
    fn of(case: &Case) -> Result<Self, Fault> {
        let sigma = |r: f64| case.sigma(r);
        let sheet = Sheet {
            sigma: &sigma,
            inner: 1.0 - HALF_WIDTH - 5.0 * EDGE,
            outer: 1.0 + HALF_WIDTH + 5.0 * EDGE,
            particles: case.particles,
            softening: SOFTENING,
        };
        let rings = sheet.rings();
        let momenta = momenta(case, &rings);
        let mut signs = [1.0, -1.0].map(|sign| amplitudes(case, &sheet, (&rings, &momenta), sign));
        let [one, other] = [0, 1].map(|k| std::mem::replace(&mut signs[k], Ok(Vec::new())));
        let (one, other) = (one?, other?);
        let wave: Vec<[f64; 2]> = (one.iter().zip(&other))
            .map(|(a, b)| [a[0], (a[1] - b[1]) / (one[0][1] - other[0][1])])
            .collect();
        let (square, rest) = fit(&wave);
        let gravity = TAU * case.within(1.0) * case.k() * case.reduction();
        let expected = case.square() + own_kappa2(&rings, &momenta);
        Ok(Self {
            square,
            expected,
            halved: expected + 0.5 * gravity,
            stiffer: case.stiffer(sheet.mass()),
            rest,
        })
    }
}

/// Weight of a ring: a bell of a wavelength on either side.
fn window(r: f64) -> f64 {
    let part = (r - 1.0) / WAVELENGTH;
    if part.abs() < 1.0 {
        (0.5 * PI * part).cos().powi(2)
    } else {
        0.0
    }
}

/// Angular momenta by mass of rings in balance.
fn momenta(case: &Case, rings: &[Ring]) -> Vec<f64> {
    let c2 = case.sound_speed().powi(2);
    let slope = |r: f64| (case.sigma(r + 1e-6) / case.sigma(r - 1e-6)).ln() / 2e-6;
    (rings.iter())
        .map(|ring| ring.momentum(-c2 * slope(ring.radius)))
        .collect()
}

/// What the annulus's own pull and pressure add to kappa^2 = R^-3 dl^2/dR: the mean over the window, of a cubic through the l^2 of its rings.
fn own_kappa2(rings: &[Ring], momenta: &[f64]) -> f64 {
    let (mut matrix, mut right) = (Matrix4::zeros(), Vector4::zeros());
    for (ring, l) in rings.iter().zip(momenta) {
        let (d, w) = (ring.radius - 1.0, window(ring.radius));
        let powers = Vector4::new(1.0, d, d * d, d * d * d);
        matrix += w * powers * powers.transpose();
        right += w * (l * l - ring.radius) * powers;
    }
    let cubic = matrix.try_inverse().expect("rings in the window") * right;
    let mut sums = [0.0; 2];
    for ring in rings {
        let (d, w) = (ring.radius - 1.0, window(ring.radius));
        let slope = cubic[1] + d * (2.0 * cubic[2] + 3.0 * d * cubic[3]);
        sums[0] += w * slope / ring.radius.powi(3);
        sums[1] += w;
    }
    sums[0] / sums[1]
}

/// Times, and the part of the rings' displacement along the wave's shape, of a wave that begins with the amplitude times `sign`.
fn amplitudes(
    case: &Case,
    sheet: &Sheet,
    (rings, momenta): (&[Ring], &[f64]),
    sign: f64,
) -> Result<Vec<[f64; 2]>, Fault> {
    let size = sign * AMPLITUDE / case.k();
    let trial = Trial::new(&case.scene(), &[], |gas| {
        sheet.lay_out(gas, rings, (momenta, |r| size * case.shape(r)));
    });
    let mut trial = trial.unwrap_or_else(|refusal| panic!("a built-in scene: {refusal}"));
    let mut radii = vec![0.0; case.particles];
    for ring in rings {
        radii[ring.first..ring.first + ring.particles].fill(ring.radius);
    }
    let stops: Vec<f64> = (0..=STOPS)
        .map(|k| case.time * k as f64 / STOPS as f64)
        .collect();
    let mut found = Vec::new();
    trial.run(&stops, |stop| {
        let gas = &stop.system.gas.particles;
        let (mut along, mut norm) = (0.0, 0.0);
        for (x, &id) in gas.x.iter().zip(&gas.id) {
            let x: &Vec3 = x;
            let r = radii[id as usize];
            let shape = case.shape(r);
            along += window(r) * shape * (x.norm() - r);
            norm += window(r) * shape * shape;
        }
        found.push([stop.system.clock.time(), along / norm]);
    })?;
    Ok(found)
}
