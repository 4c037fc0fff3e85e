//! The snow line of a disk: the radius at which grains have half of their ice.
//!
//! Grains so small that they have come to balance before they drift: what is left of the ice at R is the integral over z of
//! max(0, f rho_d - rho_sat(T(R))) by that of f rho_d, Gaussians of height. Nothing that is not in the scene is fitted.

use std::f64::consts::TAU;

use super::{BOLTZMANN, Bar, MOLECULE, PART, Row, saturated, water};
use crate::trial::{Stop, Trial};

/// T = 280 K (r / au)^(-1/2) about the Sun, grains of 0.1 mm.
const DISK: &str = r#"
[run]
end_time = "0.5 yr"
[star]
mass = "1 Msun"
[gas]
particles = 20000
[gas.disk]
surface_density = "1700 g/cm^2"
reference_radius = "1 au"
slope = -1.5
inner_radius = "2 au"
outer_radius = "5 au"
[gas.eos]
kind = "locally-isothermal"
aspect_ratio = 0.0333
reference_radius = "1 au"
exponent = 0.25
mean_molecular_weight = 2.34
[gas.hydro]
neighbours = 50
[dust]
particles = 20000
dust_to_gas = 0.01
size = "0.1 mm"
[dust.composition]
ice = 0.5
silicate = 0.5
[gravity]
pulls = { gas = ["star"], dust = ["star"] }
"#;

/// What is left of the ice at `r` au of that disk.
fn left(r: f64) -> f64 {
    const AU: f64 = 1.495_978_707e13;
    let speed = (1.327_124_4e26 / AU).sqrt();
    let t = MOLECULE / BOLTZMANN * (0.0333 * speed).powi(2) / r.sqrt();
    let (sigma, height) = (1700.0 * r.powf(-1.5), 0.0333 * AU * r.powf(1.25));
    let ice = |z: f64| 0.01 * PART * sigma / (TAU.sqrt() * height) * (-0.5 * z * z).exp();
    let steps = 2000;
    let heights = (0..steps).map(|k| 6.0 * (f64::from(k) + 0.5) / f64::from(steps));
    let (mut some, mut all) = (0.0, 0.0);
    for z in heights {
        some += (ice(z) - saturated(t)).max(0.0);
        all += ice(z);
    }
    some / all
}

/// The radius between `low` and `high` at which an increasing share is a half.
fn half(mut low: f64, mut high: f64, share: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if share(middle) < 0.5 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// The same of the grains: by straight lines through the shares of rings.
fn found(stop: &Stop) -> f64 {
    const WIDTH: f64 = 0.1;
    let p = &stop.system.dust.particles;
    let mut rings = [[0.0; 2]; 30];
    for (i, x) in p.x.iter().enumerate() {
        let ring = ((x.xy().norm() - 2.0) / WIDTH) as usize;
        if let Some([ice, rock]) = rings.get_mut(ring) {
            *ice += p.m[i] * p.composition[i].x;
            *rock += p.m[i] * p.composition[i].y;
        }
    }
    let share = |ring: usize| rings[ring][0] / rings[ring][1] * (1.0 - PART) / PART;
    half(2.5, 4.5, |r| {
        let place = (r - 2.0) / WIDTH - 0.5;
        let (ring, part) = (place as usize, place.fract());
        (1.0 - part) * share(ring) + part * share(ring + 1)
    })
}

pub fn add(rows: &mut Vec<Row>) {
    let mut trial = Trial::new(DISK, &[], |_| {}).expect("a scene");
    let end = trial.scene.run.end_time;
    let (mut radius, mut start, mut lost, mut books) = (0.0, 0.0, 0.0, [0.0; 3]);
    let done = trial.run(&[0.0, end], |stop| {
        let all: f64 = water(stop).iter().sum();
        if stop.books.time == 0.0 {
            start = all;
        }
        (radius, lost) = (found(stop), all / start - 1.0);
        let b = stop.books;
        books = [b.error_mass, b.error_momentum, b.error_energy];
    });
    done.unwrap_or_else(|fault| panic!("a built-in problem: {fault}"));
    let bar = Bar::Reference {
        value: half(2.5, 4.5, left),
        // Over a kernel rho_sat has a mean above that at its middle: 1 %, by 20 000 particles.
        good: 0.02,
        acceptable: 0.03,
    };
    rows.push(Row::new(
        "disk: radius with half of the ice, au",
        radius,
        bar,
    ));
    let limit = |good, acceptable| Bar::Limit([good, acceptable]);
    rows.push(Row::new("disk: water", lost, limit(1e-13, 1e-11)));
    let [mass, momentum, energy] = books;
    rows.push(Row::new("disk: mass", mass, limit(1e-14, 1e-12)));
    rows.push(Row::new("disk: momentum", momentum, limit(1e-13, 1e-12)));
    rows.push(Row::new("disk: energy", energy, limit(1e-3, 1e-2)));
}
