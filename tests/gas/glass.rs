//! Blocks of glass: as many particles as a cubic lattice has, of nearly equal density, and no rows.

use nbody::points::{Columns, Vec3};
use tridisk::trial::Trial;

fn scene(dimensions: u32, lattice: &str) -> String {
    format!(
        "[run]\nend_time = 1\n[units]\nsystem = \"dimensionless\"\n[domain]\nkind = \"periodic\"\nsize = [1, 1, 1]\n\
         dimensions = {dimensions}\n[[gas.block]]\nlo = [0, 0, 0]\nhi = [1, 1, {}]\nlattice = \"{lattice}\"\nspacing = 0.0625\n\
         density = 2\npressure = 1\n",
        dimensions - 2
    )
}

/// Number of particles, rms of rho / 2 - 1, and how much all of them scatter a wave of twice the spacing, by their number.
fn block(dimensions: u32, lattice: &str) -> (usize, f64, f64) {
    let mut trial = Trial::new(&scene(dimensions, lattice), &[], |_| {}).expect("a scene");
    let mut found = (0, 0.0, 0.0);
    let done = trial.run(&[0.0], |stop| {
        let gas = &stop.system.gas;
        let n = gas.particles.len();
        let noise = gas.derived.rho.iter().map(|rho| (rho / 2.0 - 1.0).powi(2));
        let wave = |x: &Vec3| std::f64::consts::TAU * 16.0 * x.x;
        let [sine, cosine] = [f64::sin, f64::cos].map(|part| {
            let sum: f64 = gas.particles.x.iter().map(|x| part(wave(x))).sum();
            sum / n as f64
        });
        let noise = (noise.sum::<f64>() / n as f64).sqrt();
        found = (n, noise, sine.hypot(cosine));
    });
    done.expect("a run");
    found
}

#[test]
fn a_glass_is_even_and_has_no_rows() {
    for dimensions in [2, 3] {
        let (number, _, rows) = block(dimensions, "cubic");
        assert!(rows > 0.99, "{rows}");
        let (glass, noise, rows) = block(dimensions, "glass");
        let (_, scattered, _) = block(dimensions, "random");
        println!(
            "{dimensions}: {number} {glass}, noise {noise:.4} of {scattered:.4}, rows {rows:.3}"
        );
        assert_eq!(glass, number);
        assert!(
            noise < 0.02 && noise < 0.1 * scattered,
            "{noise}, {scattered}"
        );
        // Less than a quarter of the power of the lattice: order reaches a few particles, not through the box.
        assert!(rows < 0.5, "{rows}");
    }
}
