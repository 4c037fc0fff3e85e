//! Dynamical friction: a planet that is set down in uniform gas and moves straight through it pulls up a wake that brakes it.
//!
//! Linear waves from a source at the speed V from t = 0 on, pulls softened as those of a Plummer sphere of scale epsilon, q = k epsilon:
//!     F = (8 G^2 M^2 rho / c) int_0^t dtau int_0^inf dk (q K_1(q))^2 sin(k c tau) j_1(k V tau)
//! Its limit epsilon -> 0 is F = 4 pi G^2 M^2 rho I / V^2 with Ostriker's I: ln((1 + m)/(1 - m))/2 - m below the speed of sound, m = V/c,
//! ln(1 - 1/m^2)/2 + ln(V t / r_min) above it; a Plummer sphere acts as r_min = 2.25 epsilon (Sanchez-Salcedo & Brandenburg 1999, ApJ 522, L35).
//! Gas that does not pull itself, in a cube whose edges no wave has come back from, GM / (c^2 epsilon) = 0.05, and so thin that its own pull changes
//! little on the way by which the planet lags. Measured is the braking between two times, by the velocities of the planet and of one a million
//! times lighter in the same gas, which feels the cube alone. Forces leave out the pressure at rest, without which a lattice is elastic: its
//! longitudinal waves are then 4 % faster than sound, and friction below the speed of sound is 11 % too weak at any number of particles.
//! Source: Ostriker (1999), ApJ 513, 252, equations 11, 14, 15.

use std::f64::consts::PI;

use super::super::{Bar, Row};
use crate::trial::Trial;

const SCENE: &str = r#"
[run]
end_time = 10.0
[units]
system = "dimensionless"
[gas]
softening = 0.05
[gas.eos]
kind = "isothermal"
sound_speed = 1.0
[gas.hydro]
background_pressure = 1e-3
[gas.viscosity]
kind = "none"
[gravity]
method = "direct"
pulls = { gas = ["planets"], planets = ["gas"] }
"#;

/// epsilon, that of the gas; a planet has none of its own.
const SOFTENING: f64 = 0.05;
const MASS: f64 = 0.05 * SOFTENING;
/// Density of the gas: it takes 1/sqrt(G rho), 33 times longer, to be pulled across.
const DENSITY: f64 = 1e-3;
/// Times between which the braking is measured.
const TIMES: [f64; 2] = [0.2, 0.3];
const MACH: [f64; 4] = [0.5, 0.8, 1.3, 2.0];

/// Velocities of a planet of mass `m` at [`TIMES`], at first `speed` along x.
fn velocities(m: f64, speed: f64, spacing: f64) -> [f64; 2] {
    let start = -0.5 * speed * TIMES[1];
    let overrides = [
        format!("planet=[{{mass={m:e},position=[{start},0.0,0.0],velocity=[{speed},0.0,0.0]}}]"),
        format!(
            "gas.block=[{{lo=[-0.65,-0.65,-0.65],hi=[0.65,0.65,0.65],spacing={spacing},density={DENSITY},lattice=\"bcc\"}}]"
        ),
    ];
    let mut trial = Trial::new(SCENE, &overrides, |_| {})
        .unwrap_or_else(|refusal| panic!("a built-in scene: {refusal}"));
    let mut found = Vec::new();
    let done = trial.run(&[0.0, TIMES[0], TIMES[1]], |stop| {
        found.push(stop.system.bodies.v[0].x);
    });
    done.unwrap_or_else(|fault| panic!("a built-in problem: {fault}"));
    [found[1], found[2]]
}

/// F c^2 / (4 pi G^2 M^2 rho) as measured.
fn measured(mach: f64, spacing: f64) -> f64 {
    let [with, without] = [MASS, 1e-6 * MASS].map(|m| velocities(m, mach, spacing));
    let lost = (without[1] - without[0]) - (with[1] - with[0]);
    lost / (TIMES[1] - TIMES[0]) / (4.0 * PI * DENSITY * MASS)
}

/// Modified Bessel function of the second kind, of order 1, times its argument: int_0^inf exp(-x cosh t) x cosh t dt.
fn x_k1(x: f64) -> f64 {
    const STEP: f64 = 0.05;
    let at = |t: f64| (-x * t.cosh()).exp() * x * t.cosh();
    // The trapezoidal rule converges faster than any power here.
    let rest: f64 = (1..400).map(|i| at(STEP * f64::from(i))).sum();
    STEP * (0.5 * at(0.0) + rest)
}

fn j1(x: f64) -> f64 {
    if x < 1e-3 {
        x / 3.0
    } else {
        (x.sin() / x - x.cos()) / x
    }
}

/// F c^2 / (4 pi G^2 M^2 rho), of linear waves from an `epsilon`-softened source, at the time `t`.
fn linear(mach: f64, epsilon: f64, t: f64) -> f64 {
    const WAVES: u32 = 1500;
    const TAUS: u32 = 300;
    let (dk, dtau) = (12.0 / epsilon / f64::from(WAVES), t / f64::from(TAUS));
    let mut sum = 0.0;
    for wave in 0..WAVES {
        let k = dk * (f64::from(wave) + 0.5);
        let weight = x_k1(k * epsilon).powi(2);
        let along: f64 = (0..TAUS)
            .map(|step| dtau * (f64::from(step) + 0.5))
            .map(|tau| (k * tau).sin() * j1(k * mach * tau))
            .sum();
        sum += weight * along;
    }
    2.0 / PI * sum * dk * dtau
}

/// Mean of `force` between [`TIMES`].
fn mean(force: impl Fn(f64) -> f64) -> f64 {
    let [begin, end] = TIMES;
    // Simpson's rule: in that short time the force is a parabola to 1e-4.
    (force(begin) + 4.0 * force(0.5 * (begin + end)) + force(end)) / 6.0
}

pub fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    for mach in MACH {
        let value = mean(|t| linear(mach, SOFTENING, t));
        // The fewer particles show how it converges.
        let bar = Bar::Reference {
            value,
            good: 0.05,
            acceptable: 0.15,
        };
        for (across, bar) in [(32, Bar::None), (48, bar)] {
            let found = measured(mach, 1.0 / f64::from(across));
            let what = format!("m = {mach}, {across} particles across 1: F c^2/(4 pi G^2 M^2 rho)");
            rows.push(Row::new(what, found, bar));
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same after Ostriker, with r_min = 2.25 epsilon.
    fn ostriker(mach: f64, epsilon: f64, t: f64) -> f64 {
        let i = if mach < 1.0 {
            0.5 * ((1.0 + mach) / (1.0 - mach)).ln() - mach
        } else {
            0.5 * (1.0 - 1.0 / (mach * mach)).ln() + (mach * t / (2.25 * epsilon)).ln()
        };
        i / (mach * mach)
    }

    #[test]
    fn a_small_source_feels_what_a_point_does() {
        for mach in [0.5, 0.8, 1.3, 2.0] {
            let (ours, point) = (linear(mach, 0.02, 1.0), ostriker(mach, 0.02, 1.0));
            assert!((ours / point - 1.0).abs() < 0.02, "{mach}: {ours} {point}");
        }
    }
}
