//! Tests of grains of several stopping times in one gas.

use super::*;

/// Scattered gas, and grains of a number of kinds whose stopping times spread evenly, in logarithms, from `least` over a factor of a million.
fn mixture(dust_to_gas: f64, least: f64, (grains, kinds): (usize, f64)) -> Box {
    let wild = |x: Vec3| {
        let v = [7.0 * x.x + 5.0 * x.y, 9.0 * x.z, 11.0 * x.y];
        Vec3::from(v.map(f64::sin))
    };
    let gas = gas(scattered(1000, 10.0, 0.0), 1.0, wild);
    let m = dust_to_gas * 1000.0 / grains as f64;
    let mut dust = dust(scattered(grains, 10.0, 0.6), m, |x| {
        wild(3.0 * x) + Vec3::x()
    });
    let kind = |i: usize| ((i as f64 * 0.618_034).fract() * kinds).floor() / kinds;
    dust.particles.stopping = (0..grains).map(|i| least * 1e6f64.powf(kind(i))).collect();
    let mut settings = constant(1.0);
    settings.several = true;
    Box::new(gas, dust, Domain::periodic(Vec3::repeat(10.0)), settings)
}

#[test]
fn mixtures_lose_energy_and_keep_momentum_whatever_their_load() {
    for of in [(1000, 3.0), (1000, 30.0), (100, 30.0)] {
        for dust_to_gas in [1e-4, 1.0, 8.0, 32.0, 1e4] {
            for least in [1e-12, 1e-4, 1e-2] {
                let name = format!("{of:?}, {dust_to_gas}, {least}");
                let mut scene = mixture(dust_to_gas, least, of);
                let start = scene.total();
                let mut before = start;
                for _ in 0..20 {
                    scene.step(0.1);
                    let after = scene.total();
                    let [old, new] = [before.kinetic, after.kinetic];
                    assert!(new <= old * (1.0 + 1e-14), "{name}: {old} to {new}");
                    before = after;
                }
                let error = (before.p - start.p).norm() / start.p.norm();
                assert!(error < 1e-13, "{name}: momentum {error:e}");
                let energy = |total: Total| total.kinetic + total.heat;
                let error = energy(before) / energy(start) - 1.0;
                assert!(error.abs() < 1e-13, "{name}: energy {error:e}");
            }
        }
    }
}

#[test]
fn grains_of_one_kind_do_what_they_do_where_no_kinds_are_solved() {
    let velocities = [false, true].map(|several| {
        let mut settings = constant(0.01);
        settings.several = several;
        let gas = gas(scattered(500, 8.0, 0.0), 1.0, |_| Vec3::zeros());
        let dust = dust(scattered(500, 8.0, 0.6), 3.0, |x| Vec3::new(1.0, x.x, 0.0));
        let mut scene = Box::new(gas, dust, Domain::periodic(Vec3::repeat(8.0)), settings);
        scene.step(0.1);
        scene.dust.particles.v.clone()
    });
    assert_eq!(velocities[0], velocities[1]);
}
