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

/// Three kinds of grains in accelerated gas: K = 300, 30, 3, rho = 0.3 each; a = 0.1. Largest error at t = 0.1, if `several` kinds are solved as such.
fn mixture_error(steps: i32, several: bool) -> f64 {
    let n = 6;
    let gas = gas(lattice(n, 0.0), 1.0, |_| Vec3::zeros());
    let mut x = lattice(n, 0.5);
    x.extend(lattice(n, 0.5));
    x.extend(lattice(n, 0.5));
    let mut dust = dust(x, 0.3, |_| Vec3::new(1.0, 0.0, 0.0));
    // Stopping times 0.001, 0.01, 0.1, as Stokes numbers of one orbital frequency would not give: by grain size in Epstein's law.
    let kind = |id: u64| (id / (n * n * n) as u64) as i32;
    let domain = Domain::periodic(Vec3::repeat(n as f64));
    let ids = dust.particles.id.clone();
    let mut scene = {
        for (i, &id) in ids.iter().enumerate() {
            dust.particles.grain_radius[i] = 1e-3 * 10f64.powi(kind(id));
        }
        let mut settings = settings(StoppingLaw::Epstein);
        settings.several = several;
        Box::new(gas, dust, domain, settings)
    };
    // A sound speed so large that Kwok's correction is nothing.
    let c = 1e9;
    scene.gas.derived.p.fill(c * c);
    let active = scene.active.clone();
    scene
        .exchange
        .prepare(&scene.gas, &mut grains(&mut scene.dust), &active, &domain);
    let rho = sampled_density(&scene);
    let density = rho * (8.0 / std::f64::consts::PI).sqrt() * c;
    scene.dust.particles.grain_density.fill(density);
    scene.gas.rates.hydro.fill(Vec3::new(0.1, 0.0, 0.0));
    for _ in 0..steps {
        scene.step(0.1 / f64::from(steps));
    }
    let exact = [0.450583308826, 0.446584838812, 0.632892807823];
    let mut worst = off(&scene.gas.particles.v, 0.450981713362);
    for (v, &id) in scene.dust.particles.v.iter().zip(&ids) {
        let error = (v.x - exact[kind(id) as usize]).abs();
        worst = if error <= worst { worst } else { error };
    }
    worst
}

#[test]
fn a_mixture_of_grains_converges_with_second_order() {
    let errors: Vec<f64> = [40, 80, 160]
        .into_iter()
        .map(|steps| mixture_error(steps, false))
        .collect();
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!(order > 1.8, "{errors:?}");
    }
}

#[test]
fn a_mixture_of_grains_is_exact_in_any_step_where_kinds_are_solved() {
    for steps in [1, 2, 10] {
        let error = mixture_error(steps, true);
        assert!(error < 1e-11, "{steps}: {error:e}");
    }
}
