//! Dust that is sampled much more finely than the gas it is stopped by: it must not clump on scales that the gas does not resolve.
//!
//! Grains of short stopping time move as gas that is smooth over their own gas neighbours, so that a flow without divergence leaves grains that begin at
//! random places at random ones. Measure: the density of the eight nearest grains, of which the largest hundredth is 8 / 2.9 of the mean by
//! chance. Were velocities found from few gas particles, grains would gather where these hand over to one another.

use std::f64::consts::TAU;

use nbody::points::Vec3;
use tridisk::trial::Trial;

/// Distances of gas and of grains.
const GAS: f64 = 0.1;
const DUST: f64 = 0.05;

const NEAREST: usize = 8;

fn flow(x: Vec3) -> Vec3 {
    let (s, c) = (x.map(|x| (TAU * x).sin()), x.map(|x| (TAU * x).cos()));
    0.2 * Vec3::new(s.z + c.y, s.x + c.z, s.y + c.x)
}

/// The density of the nearest neighbours by the mean, at the given part of all points in ascending order.
fn contrast(points: &[Vec3], part: f64) -> f64 {
    let nearest = |x: &Vec3| {
        let mut squares: Vec<f64> = (points.iter())
            .map(|y| (y - x).map(|d| d - d.round()).norm_squared())
            .collect();
        let (_, at, _) = squares.select_nth_unstable_by(NEAREST, f64::total_cmp);
        let volume = 2.0 / 3.0 * TAU * at.powf(1.5);
        NEAREST as f64 / (volume * points.len() as f64)
    };
    let mut densities: Vec<f64> = points.iter().map(nearest).collect();
    densities.sort_unstable_by(f64::total_cmp);
    densities[(part * points.len() as f64) as usize]
}

#[test]
fn dust_much_finer_than_gas_does_not_clump() {
    let block = "lo = [0, 0, 0]\nhi = [1, 1, 1]\n";
    let text = format!(
        "[run]\nend_time = 2\n[units]\nsystem = \"dimensionless\"\n[domain]\nkind = \"periodic\"\nsize = [1, 1, 1]\n\
         [gas.eos]\nkind = \"isothermal\"\nsound_speed = 1\n\
         [[gas.block]]\n{block}lattice = \"bcc\"\nspacing = {GAS}\ndensity = 1\n\
         [[dust.block]]\n{block}lattice = \"random\"\nspacing = {DUST}\ndensity = 0.01\n\
         [dust.drag]\nlaw = \"constant-stopping-time\"\nstopping_time = 1e-3\n"
    );
    let trial = Trial::prepared(&text, &[], |gas, dust| {
        for (v, x) in gas.v.iter_mut().zip(&gas.x) {
            *v = flow(*x);
        }
        for (v, x) in dust.v.iter_mut().zip(&dust.x) {
            *v = flow(*x);
        }
    });
    let mut contrasts = Vec::new();
    let done = trial.expect("a scene").run(&[0.0, 1.0, 2.0], |stop| {
        let x = &stop.system.dust.particles.x;
        contrasts.push(contrast(x, 0.99));
    });
    done.expect("a run");
    println!("density of the nearest {NEAREST}, largest hundredth: {contrasts:?}");
    assert!(
        contrasts.iter().all(|c| *c < 1.1 * contrasts[0]),
        "{contrasts:?}"
    );
}
