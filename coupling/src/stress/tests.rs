//! Gas of a known stress has that alpha; laminar gas has none, reversed gas the floor; the walk's slope is that of alpha.

use std::f64::consts::TAU;

use gas::{Gas, Particles};
use nbody::points::random::{Purpose, stream};
use nbody::points::{Columns, Domain};
use rand::RngExt;
use rand_distr::StandardNormal;

use super::*;

/// Square of the sound speed, and the rms of each turbulent velocity by the sound speed.
const SQUARE: f64 = 2.5e-3;
const MACH: f64 = 0.2;

/// Neighbours of a point, and a radius that holds them.
const NEIGHBOURS: f64 = 40.0;
const WIDE: f64 = 0.1;

/// Waves around the disk.
const WAVES: f64 = 4.0;

/// Velocities outwards and around, by their rms.
#[derive(Clone, Copy)]
enum Turbulence {
    /// Waves, of which a part goes around as it goes outwards.
    Waves(f64),
    /// Each particle's own, of which a part goes around as it goes outwards.
    Noise(f64),
}

impl Turbulence {
    fn of(self, id: u64, phi: f64) -> (f64, f64) {
        let (a, b, shared) = match self {
            Self::Waves(shared) => {
                let (sin, cos) = (WAVES * phi).sin_cos();
                (sin * 2f64.sqrt(), cos * 2f64.sqrt(), shared)
            }
            Self::Noise(shared) => {
                let mut random = stream(3, Purpose::Turbulence, id, 0);
                (
                    random.sample(StandardNormal),
                    random.sample(StandardNormal),
                    shared,
                )
            }
        };
        (a, shared * a + (1.0 - shared * shared).sqrt() * b)
    }
}

/// Gas from 0.7 to 1.5 about a star that is elsewhere and moves: circular velocities beside pressure, an inflow, and turbulence of `mach`.
fn disk(n: usize, turbulence: Turbulence, mach: f64) -> System {
    let mut system = System::new(Domain::open(), 1.0, 0.0);
    let (place, speed) = (Vec3::new(3.0, -2.0, 1.0), Vec3::new(0.3, 0.1, -0.2));
    system.star.resize(1);
    (system.star.m[0], system.star.x[0], system.star.v[0]) = (2.0, place, speed);
    let mut p = Particles::default();
    p.resize(n);
    for i in 0..n {
        let mut random = stream(3, Purpose::DustPositions, i as u64, 0);
        let [u, turn, z]: [f64; 3] = std::array::from_fn(|_| random.random());
        let (r, phi) = (0.7 + 0.8 * u, TAU * turn);
        let out = Vec3::new(phi.cos(), phi.sin(), 0.0);
        let along = Vec3::new(-phi.sin(), phi.cos(), 0.0);
        let (radial, round) = turbulence.of(i as u64, phi);
        let each = mach * SQUARE.sqrt();
        let flow = (2.0 / r).sqrt() * (1.0 - 2.0 * SQUARE * r) + each * round;
        (p.id[i], p.m[i], p.h[i]) = (i as u64, 1e-6, WIDE);
        p.x[i] = place + r * out + Vec3::new(0.0, 0.0, 0.1 * z);
        p.v[i] = speed + (each * radial - 0.02 / r) * out + flow * along;
    }
    system.gas = Gas::new(p);
    system.gas.derived.rho.fill(2.0);
    system.gas.derived.p.fill(2.0 * SQUARE);
    system
}

fn measured(system: &System, times: usize) -> Stress {
    let mut stress = Stress::default();
    (0..times).for_each(|_| stress.measure(system, NEIGHBOURS, 0.5));
    stress
}

#[test]
fn gas_of_a_known_stress_has_its_alpha() {
    let (n, shared) = (40_000, 0.5);
    let stress = measured(&disk(n, Turbulence::Waves(shared), MACH), 3);
    let expected = shared * MACH * MACH;
    let each = n as f64 / 0.8;
    assert_eq!(stress.rings.len(), 8);
    for (k, ring) in stress.rings.iter().enumerate() {
        let width = stress.middle(k).exp() * 2.0 * (0.5 * stress.width).sinh();
        // The variance of v_R v_phi at random places is MACH^4 / 2; the kernel, of the extent 0.05, takes off (4 x 0.05)^2 / 10 of each velocity.
        let sampling = MACH * MACH * (0.5 / (each * width)).sqrt();
        let off = ring.alpha() - expected;
        println!(
            "ring {k}: alpha {:.4e}, {:.2} errors off",
            ring.alpha(),
            off / sampling
        );
        assert!(
            off.abs() < 4.0 * sampling + 8e-3 * expected,
            "ring {k}: {off:e}"
        );
    }
}

#[test]
fn the_noise_of_single_particles_does_not_count() {
    let noise = measured(&disk(20_000, Turbulence::Noise(0.9), MACH), 1);
    let expected = 0.9 * MACH * MACH;
    let part = |ring: &Ring| ring.alpha() / expected;
    println!(
        "parts {:.3?}",
        noise.rings.iter().map(part).collect::<Vec<_>>()
    );
    // A pair counts twice, by weights whose squares add up to a half near the surfaces of so thin a disk: sqrt(2 x 0.5) of the noise among the 1700 particles
    // of the smallest ring; four times that.
    let bar = 4.0 / 1700f64.sqrt() / 0.9;
    assert!(noise.rings.iter().all(|ring| part(ring).abs() < bar));
    let mean = noise.rings.iter().map(part).sum::<f64>() / 8.0;
    assert!(mean.abs() < bar / 8f64.sqrt(), "{mean}");
}

#[test]
fn a_laminar_disk_has_none_and_a_reversed_one_the_floor() {
    // What lines in ln R leave of the mean flow is of second order in a ring's width: 0.1^2 of differences of a tenth of the flows' 2e-2 and 4e-3.
    let laminar = measured(&disk(20_000, Turbulence::Waves(0.0), 0.0), 1);
    for ring in &laminar.rings {
        println!("laminar {:e}", ring.alpha());
        assert!(ring.alpha().abs() < 1e-5, "{:e}", ring.alpha());
    }
    let reversed = measured(&disk(20_000, Turbulence::Waves(-0.9), MACH), 1);
    for (k, ring) in reversed.rings.iter().enumerate() {
        assert!(ring.alpha() < -0.02, "{:e}", ring.alpha());
        assert_eq!(reversed.alpha(reversed.middle(k).exp(), 0.0), (0.0, 0.0));
        assert_eq!(reversed.alpha(reversed.middle(k).exp(), 1e-4).0, 1e-4);
    }
}

#[test]
fn averages_forget_in_an_orbit() {
    let (strong, calm) = (
        disk(5000, Turbulence::Waves(0.9), MACH),
        disk(5000, Turbulence::Waves(0.9), 0.0),
    );
    let mut stress = measured(&strong, 1);
    let before = stress.rings.clone();
    let period = |k: usize| TAU * ((3.0 * stress.middle(k)).exp() / 2.0).sqrt();
    let periods: Vec<f64> = (0..before.len()).map(period).collect();
    stress.measure(&calm, NEIGHBOURS, periods[0]);
    for (k, (now, before)) in stress.rings.iter().zip(&before).enumerate() {
        let left = (-periods[0] / periods[k]).exp();
        assert!(
            (now.stress / before.stress / left - 1.0).abs() < 1e-3,
            "{k}"
        );
    }
}

#[test]
fn alpha_is_continuous_and_its_slope_is_its_own() {
    let ring = |stress: f64| Ring {
        stress,
        pressure: 1.0,
    };
    let stress = Stress {
        inner: 0.0,
        width: 0.1,
        time: 0.0,
        rings: vec![ring(0.1), ring(-0.2), ring(0.3), Ring::default()],
    };
    for n in 0..500 {
        let r = 0.95 + 0.001 * f64::from(n) + 1e-5;
        let (alpha, slope) = stress.alpha(r, 0.01);
        let by = |dr: f64| stress.alpha(r + dr, 0.01).0;
        assert!((by(1e-7) - alpha).abs() < 1e-5 && alpha >= 0.01);
        let corner = (0..4).any(|k| (stress.middle(k) - r.ln()).abs() < 1e-5);
        let found = (by(1e-7) - by(-1e-7)) / 2e-7;
        assert!(
            corner || (found - slope).abs() < 1e-5,
            "{r}: {found} {slope}"
        );
    }
    assert_eq!(Stress::default().alpha(1.0, 0.02), (0.02, 0.0));
}
