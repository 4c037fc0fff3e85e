//! Particle sets that tests begin with.

use nbody::points::random::{Purpose, stream};
use nbody::points::{Columns, Domain, Vec3};
use rand::RngExt;

use crate::{Eos, Gas, Hydro, Particles};

pub const GAMMA: f64 = 5.0 / 3.0;

/// Settings for ideal gas in `domain`.
pub fn hydro(domain: Domain) -> Hydro {
    Hydro::new(domain, Eos::Ideal { gamma: GAMMA })
}

/// Gas at positions `x`, at rest, each particle of mass `m` and internal energy `u`.
pub fn still(x: Vec<Vec3>, m: f64, u: f64) -> Particles {
    let mut particles = Particles::default();
    particles.resize(x.len());
    particles.id = (0..x.len() as u64).collect();
    particles.x = x;
    particles.m.fill(m);
    particles.u.fill(u);
    particles
}

/// A lattice of `n` particles an axis, one every `spacing`.
pub fn lattice(n: [usize; 3], spacing: f64) -> Vec<Vec3> {
    let place = |i: usize| (i as f64 + 0.5) * spacing;
    let mut x = Vec::new();
    for i in 0..n[0] {
        for j in 0..n[1] {
            x.extend((0..n[2]).map(|k| Vec3::new(place(i), place(j), place(k))));
        }
    }
    x
}

/// A vector with components uniform in -1..1, by the particle's id.
pub fn noise(id: u64, step: u64) -> Vec3 {
    let mut random = stream(1, Purpose::GasPositions, id, step);
    Vec3::from_fn(|_, _| 2.0 * random.random::<f64>() - 1.0)
}

/// A lattice in the unit cube (or square) that is disordered in every quantity: positions, masses, velocities and energies.
pub fn noisy(domain: &Domain, n: usize, contrast: f64) -> Gas {
    let third = if domain.dimensions() == 3 { n } else { 1 };
    let spacing = 1.0 / n as f64;
    let mut particles = still(lattice([n, n, third], spacing), 0.0, 0.0);
    for i in 0..particles.len() {
        let (a, b) = (noise(i as u64, 1), noise(i as u64, 2));
        particles.x[i] += 0.3 * spacing * domain.in_plane(a);
        particles.v[i] = noise(i as u64, 3);
        particles.m[i] = (1.0 + 0.5 * b.x) / (n * n * third) as f64;
        particles.u[i] = (contrast * b.y).exp();
    }
    Gas::new(particles)
}
