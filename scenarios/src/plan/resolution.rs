//! Resolution: how fine a scene is against the lengths and masses that matter, and the viscosity that follows from it.
//!
//! An artificial viscosity between pairs acts on shear as nu = alpha c h / (2 (d + 2)) in d dimensions (Lodato & Price 2010; Meru & Bate
//! 2012), with the alpha that the particles have now: a switch may change it. nu = alpha_SS c^2 / Omega, Re = r^2 Omega / nu. A ring has
//! spread when tau = 12 nu t / r^2 is of order one (Lynden-Bell & Pringle 1974).

use std::f64::consts::TAU;

use coupling::System;
use nbody::points::Columns;

use crate::scene::{Eos, Scene, Viscosity};

/// The middle one of some values.
fn middle(mut values: Vec<f64>) -> Option<f64> {
    values.retain(|x| x.is_finite());
    let half = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(half, f64::total_cmp).1)
}

/// What gas at the middle of the particles has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OfGas {
    /// Smoothing length by scale height.
    pub fineness: f64,
    /// Viscosity between pairs; none where it acts on compression alone.
    pub numerical: Option<Numerical>,
}

/// A viscosity that nobody asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Numerical {
    pub alpha: f64,
    pub nu: f64,
    pub shakura_sunyaev: f64,
    pub reynolds: f64,
    /// 12 nu t / r^2 at the end of the run.
    pub spread: f64,
}

impl Numerical {
    /// Orbits after which 12 nu t / r^2 is a tenth.
    pub fn orbits(&self) -> f64 {
        0.1 * self.reynolds / (12.0 * TAU)
    }
}

/// None without gas that orbits.
pub fn of_gas(scene: &Scene, system: &System) -> Option<OfGas> {
    let gas = scene.gas.as_ref()?;
    let (p, derived) = (&system.gas.particles, &system.gas.derived);
    let omega: Vec<f64> = match (scene.domain.hill(), system.star.m.first()) {
        (Some(hill), _) => vec![hill.rate; p.x.len()],
        (None, Some(mass)) => {
            let (gm, centre) = (system.g * mass, system.star.x[0]);
            let rate = |x: &nbody::points::Vec3| (gm / (x - centre).xy().norm().powi(3)).sqrt();
            p.x.iter().map(rate).collect()
        }
        _ => return None,
    };
    let root = match gas.eos {
        Eos::Ideal { gamma } => gamma.sqrt(),
        _ => 1.0,
    };
    let n = p.x.len();
    let over = |of: &dyn Fn(usize) -> f64| middle((0..n).map(of).collect());
    let fineness = over(&|i| p.h[i] * omega[i] * root / derived.cs[i])?;
    let pairwise = matches!(
        gas.viscosity,
        Viscosity::Constant { .. }
            | Viscosity::Balsara { .. }
            | Viscosity::CullenDehnen { .. }
            | Viscosity::PlanarSwitch { .. }
    );
    let d = scene.domain.dimensions() as f64;
    let nu = |i: usize| p.alpha[i] * derived.cs[i] * p.h[i] / (2.0 * (d + 2.0));
    let square = |i: usize| match scene.domain.hill() {
        // Of a box the scale height is the length that counts.
        Some(_) => (derived.cs[i] / omega[i]).powi(2),
        None => (p.x[i] - system.star.x[0]).xy().norm_squared(),
    };
    let numerical = pairwise.then(|| -> Option<Numerical> {
        let mass: f64 = p.m.iter().sum();
        let mean = |of: &dyn Fn(usize) -> f64| (0..n).map(|i| p.m[i] * of(i)).sum::<f64>() / mass;
        let inverse = mean(&|i| nu(i) / (square(i) * omega[i]));
        Some(Numerical {
            alpha: mean(&|i| p.alpha[i]),
            nu: mean(&nu),
            shakura_sunyaev: mean(&|i| nu(i) * omega[i] * root * root / derived.cs[i].powi(2)),
            reynolds: inverse.recip(),
            spread: 12.0 * scene.run.end_time * mean(&|i| nu(i) / square(i)),
        })
    });
    Some(OfGas {
        fineness,
        numerical: numerical.flatten(),
    })
}

/// Sentences on the scene as it stands in `system`.
pub fn sentences(scene: &Scene, system: &System) -> Vec<String> {
    let mut said = Vec::new();
    if let Some(gas) = of_gas(scene, system) {
        said.push(format!(
            "smoothing length / scale height of the gas: {:.2}",
            gas.fineness
        ));
        match gas.numerical {
            Some(n) => {
                said.push(format!(
                    "numerical viscosity at the viscosity's present alpha of {:.3}: nu = {:.2e}, alpha_SS = {:.1e}, Re = {:.1e}",
                    n.alpha, n.nu, n.shakura_sunyaev, n.reynolds
                ));
                said.push(format!(
                    "  12 nu t / r^2 at the end: {:.1e} (a ring spreads at 1); a tenth of that after {:.0} orbits",
 n.spread,
 n.orbits()
));
            }
            None => said.push(
                "numerical viscosity: none on pure shear by this kind; noise is not estimated"
                    .to_owned(),
            ),
        }
    }
    said.extend(of_bodies(system));
    said
}

fn of_bodies(system: &System) -> Vec<String> {
    let mut said = Vec::new();
    let (bodies, dust) = (&system.bodies, &system.dust.particles);
    let heavy: Vec<usize> = (0..bodies.len()).filter(|&i| bodies.m[i] > 0.0).collect();
    if let Some(star) = system.star.x.first().filter(|_| !heavy.is_empty()) {
        let hill = |i: usize| {
            (bodies.x[i] - star).norm() * (bodies.m[i] / (3.0 * system.star.m[0])).cbrt()
        };
        let soft = middle(
            heavy
                .iter()
                .map(|&i| bodies.softening[i] / hill(i))
                .collect(),
        );
        let size = middle(heavy.iter().map(|&i| bodies.radius[i] / hill(i)).collect());
        if let (Some(soft), Some(size)) = (soft, size) {
            said.push(format!(
                "bodies: softening {soft:.2e} and radius {size:.2e} of the Hill radius (the middle one)"
            ));
        }
    }
    let body = middle(heavy.iter().map(|&i| bodies.m[i]).collect());
    for (name, masses) in [
        ("superparticle", &dust.m),
        ("gas particle", &system.gas.particles.m),
    ] {
        if let (Some(one), Some(body)) = (middle(masses.clone()), body) {
            said.push(format!(
                "mass of a {name} / mass of a body: {:.2e}",
                one / body
            ));
        }
    }
    said
}

#[cfg(test)]
mod tests {
    use super::*;

    const DISK: &str = r#"
[run]
end_time = "10 yr"
[star]
mass = "1 Msun"
[gas]
particles = 2000
[gas.disk]
surface_density = "1700 g/cm^2"
inner_radius = "0.9 au"
outer_radius = "1.1 au"
[gas.eos]
kind = "locally-isothermal"
aspect_ratio = 0.05
[gas.viscosity]
kind = "constant"
alpha = 2.0
"#;

    #[test]
    fn the_viscosity_of_pairs_is_that_of_shakura_and_sunyaev_by_the_fineness() {
        let scene = Scene::parse(DISK, "disk", std::path::Path::new("."), &[]).expect("a scene");
        let sampled = crate::cost::sample(&scene, 0.0).expect("a start");
        let gas = of_gas(&scene, &sampled.system).expect("a disk");
        let n = gas.numerical.expect("a viscosity of pairs");
        assert_eq!(n.alpha, 2.0);
        // alpha_SS = 0.1 alpha h / H; one is a mean over the disk, the other its middle.
        let by = n.shakura_sunyaev / (0.1 * n.alpha * gas.fineness);
        // Re = r^2 Omega / nu = 1 / (alpha_SS (H / r)^2), the disk being narrow.
        let reynolds = n.reynolds * n.shakura_sunyaev * 0.05f64.powi(2);
        // 12 nu t / r^2 with t of ten orbits.
        let spread = n.spread * n.reynolds / (12.0 * 10.0 * TAU);
        println!("{by:.3} {reynolds:.3} {spread:.3}");
        for ratio in [by, reynolds, spread] {
            assert!((ratio - 1.0).abs() < 0.1, "{by} {reynolds} {spread}");
        }
    }
}
