//! Drag against forces, and stiff drag: terminal velocities, balance at random places, and the energy that heavy grains lose.

use super::*;

#[test]
fn terminal_velocity_is_exact_for_steps_of_any_length() {
    for (t_stop, bar) in [(1e-9, 1e-15), (1e-3, 1e-15), (0.5, 1e-14)] {
        for eps in [0.01, 100.0] {
            let terminal = 0.3 * t_stop / (1.0 + eps);
            let mut scene = dustybox(eps, terminal, constant(t_stop));
            scene.dust.rates.gravity.fill(Vec3::new(0.3, 0.0, 0.0));
            for _ in 0..5 {
                scene.step(0.2);
            }
            let u = scene.dust.particles.v[0].x - scene.gas.particles.v[0].x;
            let error = (u - terminal).abs();
            assert!(
                error < bar,
                "{t_stop:e} {eps}: {u:e} {terminal:e} {error:e}"
            );
        }
    }
}

fn noise(x: Vec3) -> Vec3 {
    let f = |k: f64| (x.dot(&Vec3::new(7.3, 3.1, 9.7)) * k).sin();
    Vec3::new(f(13.7), f(71.3), f(31.1))
}

#[test]
fn at_random_places_drag_comes_to_balance_forces_and_stiff_drag_heats_nobody() {
    for (t_stop, eps) in [(1e-12, 0.5), (1e-12, 10.0), (0.1, 0.5), (0.1, 10.0)] {
        let gas = gas(scattered(200, 5.6, 0.0), 1.0, |_| Vec3::zeros());
        let dust = dust(scattered(100, 5.6, 0.37), eps * 2.0, |_| Vec3::zeros());
        let domain = Domain::periodic(Vec3::repeat(5.6));
        let mut scene = Box::new(gas, dust, domain, constant(t_stop));
        let pulls: Vec<Vec3> = scene.dust.particles.x.iter().map(|&x| noise(x)).collect();
        scene.dust.rates.gravity = pulls;
        let half = 0.1;
        for _ in 0..1000 {
            scene.step(2.0 * half);
        }
        let warm = scene.gas.particles.u.clone();
        scene.step(2.0 * half);
        let drag: Vec<Vec3> = scene.exchange.rows().map(|row| row.dv / half).collect();
        scene.half(0.0, Half::Closing);
        for (row, a) in scene.exchange.rows().zip(&drag) {
            let lacking = (row.u_tick + t_stop * a).norm();
            assert!(lacking < 1e-13, "{t_stop:e}, {eps}: {lacking:e}");
        }
        for (u, before) in scene.gas.particles.u.iter().zip(&warm) {
            let heat = (u - before).abs();
            assert!(t_stop > 1e-9 || heat < 4e-12, "{eps}: heat {heat:e}");
        }
    }
}

#[test]
fn heavy_stiff_dust_at_random_places_only_loses_energy() {
    for (t_stop, eps, steps) in [(1e-8, 100.0, 10_000), (0.1, 100.0, 1000), (0.01, 1.0, 1000)] {
        let gas = gas(scattered(200, 5.6, 0.0), 1.0, noise);
        let mut dust = dust(scattered(100, 5.6, 0.37), eps * 2.0, noise);
        for (i, s) in dust.particles.grain_radius.iter_mut().enumerate() {
            *s = 10f64.powi(i as i32 % 5);
        }
        let domain = Domain::periodic(Vec3::repeat(5.6));
        let settings = if t_stop == 0.1 {
            settings(StoppingLaw::Epstein)
        } else {
            constant(t_stop)
        };
        let mut scene = Box::new(gas, dust, domain, settings);
        let start = scene.total();
        let mut last = start;
        for _ in 0..steps {
            scene.step(1.0);
            let now = scene.total();
            let slack = 1e-14 * start.kinetic;
            assert!(now.kinetic <= last.kinetic + slack, "{now:?} {last:?}");
            last = now;
        }
        let p = (last.p - start.p).norm() / (2.0 * start.kinetic * 2e2 * (1.0 + eps)).sqrt();
        assert!(p < 1e-12, "momentum {p:e}");
        let energy = (last.kinetic + last.heat) / (start.kinetic + start.heat) - 1.0;
        assert!(energy.abs() < 1e-12, "energy {energy:e}");
        assert!(scene.gas.particles.u.iter().all(|&u| u > 0.99));
    }
}
