//! Tests of `forces`.

use nbody::points::{Columns, Domain, Vec3};

use super::*;
use crate::samples::{GAMMA, hydro, lattice, noisy, still};
use crate::{
    BackgroundPressure, Conduction, Formulation, Gradient, Kernel, KernelKind, Physical,
    Reconstruction, Viscosity, WendlandC2,
};

const NOW: Clock = Clock::standing(0.0);

fn pushed(mut gas: Gas, hydro: &Hydro) -> Gas {
    gas.density(hydro, &NOW, Vec3::zeros()).expect("a solution");
    gas.forces(hydro, &NOW, &NOW);
    gas
}

fn domains() -> [Domain; 4] {
    let box_ = Domain::periodic(Vec3::repeat(1.0));
    let plane = [true, true, false];
    [
        Domain::open(),
        box_,
        Domain::open().with_axes(plane),
        box_.with_axes(plane),
    ]
}

/// Settings in `domain` with each kernel, formulation and precision, heat conducted or not.
fn settings(domain: Domain) -> Vec<Hydro> {
    let mut all = Vec::new();
    for kernel in KernelKind::ALL {
        for formulation in [Formulation::Density, Formulation::Pressure] {
            for alpha in [0.0, 1.0] {
                for precision in [Precision::Double, Precision::Single] {
                    all.push(Hydro {
                        kernel,
                        formulation,
                        precision,
                        conduction: Conduction { alpha },
                        ..hydro(domain)
                    });
                }
            }
        }
    }
    all
}

/// Settings in `domain` in which particles bring more into pairs: stresses, corrected gradients, sums of other contents.
fn more_settings(domain: Domain) -> Vec<Hydro> {
    let (alpha, beta) = (1.0, 2.0);
    let viscosities = [
        Viscosity::Constant { alpha, beta },
        Viscosity::NeumannRichtmyer { alpha, beta },
        Viscosity::Tensor { alpha, beta },
        Viscosity::Planar { alpha, beta },
    ];
    let mut all = Vec::new();
    for formulation in Formulation::ALL {
        for viscosity in viscosities {
            for precision in [Precision::Double, Precision::Single] {
                let hydro = Hydro {
                    formulation,
                    viscosity,
                    precision,
                    ..hydro(domain)
                };
                let corrected = Hydro {
                    gradient: Gradient::Matrix,
                    conduction: Conduction { alpha },
                    ..hydro.clone()
                };
                let physical = Hydro {
                    physical: Physical::Constant { nu: 0.1 },
                    exponent: 0.3,
                    ..hydro.clone()
                };
                let followed = Hydro {
                    reconstruction: Reconstruction::Linear,
                    ..hydro.clone()
                };
                if followed.clashing().is_none() {
                    all.push(followed);
                }
                all.extend([hydro, corrected, physical]);
            }
        }
    }
    all
}

#[test]
fn one_evaluation_conserves_momentum_angular_momentum_and_energy() {
    for domain in domains() {
        for hydro in settings(domain).into_iter().chain(more_settings(domain)) {
            let gas = pushed(noisy(&domain, 10, 1.0), &hydro);
            // Forces cancel exactly in both precisions; separations and heats are rounded.
            let [turning, heating] = match (hydro.precision, hydro.plain()) {
                (Precision::Double, true) => [1e-15, 1e-14],
                (Precision::Single, true) => [1e-8, 1e-7],
                (Precision::Double, false) => [1e-15, 1e-14],
                (Precision::Single, false) => [1e-8, 1e-7],
            };
            let (p, r) = (&gas.particles, &gas.rates);
            let (mut force, mut torque, mut power, mut size) =
                (Vec3::zeros(), Vec3::zeros(), 0.0, [0.0; 2]);
            for i in 0..gas.len() {
                let f = p.m[i] * r.hydro[i];
                force += f;
                torque += p.x[i].cross(&f);
                power += f.dot(&p.v[i]) + p.m[i] * r.du[i];
                size[0] += f.norm();
                size[1] += f.dot(&p.v[i]).abs();
            }
            assert!(force.norm() < 1e-15 * size[0], "{}", force.norm() / size[0]);
            assert!(
                power.abs() < heating * size[1],
                "{hydro:?}: {}",
                power / size[1]
            );
            if domain.volume().is_infinite() {
                assert!(
                    torque.norm() < turning * size[0],
                    "{hydro:?}: {}",
                    torque.norm() / size[0]
                );
            }
        }
    }
}

/// Internal energy of all gas on the way from where its pressures were `from`, work done on volumes x / y with x constant.
fn energy(gas: &Gas, from: &[f64]) -> f64 {
    (0..gas.len())
        .map(|i| {
            // At this constant u, P is as y.
            let dense = gas.derived.p[i] / from[i];
            gas.particles.m[i] * gas.rates.u_pred[i] * dense.powf(GAMMA - 1.0)
        })
        .sum()
}

fn check_the_gradient(hydro: &Hydro) {
    let gas = pushed(noisy(&hydro.domain, 8, 1.0), hydro);
    for i in [0, gas.len() / 2, gas.len() - 7] {
        for axis in (0..3).filter(|&axis| hydro.domain.axes[axis]) {
            let moved = |e: f64| {
                let mut gas = gas.clone();
                let from = gas.derived.p.clone();
                gas.particles.x[i][axis] += e;
                gas.tree.refit(&gas.particles.x);
                gas.density(hydro, &NOW, Vec3::zeros()).expect("a solution");
                energy(&gas, &from)
            };
            let e = 1e-5;
            let expected = (moved(-e) - moved(e)) / (2.0 * e);
            let force = gas.particles.m[i] * gas.rates.hydro[i][axis];
            let scale =
                gas.particles.m[i] * gas.derived.p[i] / gas.derived.rho[i] / gas.particles.h[i];
            assert!(
                (force - expected).abs() < 1e-5 * scale,
                "{hydro:?}: {force} {expected} {scale}"
            );
        }
    }
}

#[test]
fn the_force_is_the_gradient_of_the_energy() {
    for domain in domains() {
        for formulation in [Formulation::Density, Formulation::Pressure] {
            check_the_gradient(&Hydro {
                viscosity: Viscosity::None,
                tolerance: 1e-13,
                formulation,
                ..hydro(domain)
            });
        }
    }
}

#[test]
fn the_heat_is_what_the_density_says() {
    // Without viscosity du/dt = P / rho^2 drho/dt, and drho/dt = -rho div v.
    let mut hydro = hydro(Domain::periodic(Vec3::repeat(1.0)));
    hydro.viscosity = Viscosity::None;
    let gas = pushed(noisy(&hydro.domain, 10, 1.0), &hydro);
    let d = &gas.derived;
    for i in 0..gas.len() {
        let expected = -d.p[i] / d.rho[i] * d.div_v[i];
        assert!((gas.rates.du[i] - expected).abs() < 1e-11 * (1.0 + expected.abs()));
    }
}

#[test]
fn viscosity_heats_and_only_when_gas_approaches() {
    let mut hydro = hydro(Domain::periodic(Vec3::repeat(1.0)));
    let heating = |hydro: &Hydro, stretch: f64| -> f64 {
        let mut gas = noisy(&hydro.domain, 8, 0.1);
        for i in 0..gas.len() {
            gas.rates.v_pred[i] = stretch * gas.particles.x[i];
        }
        let gas = pushed(gas, hydro);
        let inner = |i: &usize| (gas.particles.x[*i] - Vec3::repeat(0.5)).amax() < 0.15;
        (0..gas.len())
            .filter(inner)
            .map(|i| gas.particles.m[i] * gas.rates.du[i])
            .sum()
    };
    let with = [heating(&hydro, -1.0), heating(&hydro, 1.0)];
    hydro.viscosity = Viscosity::None;
    let without = [heating(&hydro, -1.0), heating(&hydro, 1.0)];
    assert!(with[0] > 1.05 * without[0]);
    assert!((with[1] / without[1] - 1.0).abs() < 1e-14);
}

/// Viscous heating of the inner part of a cube of noisy gas at these velocities, two kernels away from its walls.
fn viscous_heat(hydro: &Hydro, velocity: impl Fn(Vec3) -> Vec3) -> f64 {
    let heat = |viscosity| {
        let hydro = Hydro {
            viscosity,
            ..hydro.clone()
        };
        let mut gas = noisy(&hydro.domain, 16, 0.1);
        for i in 0..gas.len() {
            gas.rates.v_pred[i] = velocity(gas.particles.x[i] - Vec3::repeat(0.5));
        }
        let gas = pushed(gas, &hydro);
        let inner = |i: &usize| (gas.particles.x[*i] - Vec3::repeat(0.5)).amax() < 0.15;
        let heats = (0..gas.len()).filter(inner);
        heats
            .map(|i| gas.particles.m[i] * gas.rates.du[i])
            .sum::<f64>()
    };
    heat(hydro.viscosity) - heat(Viscosity::None)
}

#[test]
fn linear_reconstruction_spares_even_flow_and_leaves_shocks() {
    for precision in [Precision::Double, Precision::Single] {
        let [plain, linear] = [Reconstruction::None, Reconstruction::Linear].map(|kind| Hydro {
            reconstruction: kind,
            precision,
            ..hydro(Domain::periodic(Vec3::repeat(1.0)))
        });
        let even: [fn(Vec3) -> Vec3; 3] = [
            |x| -x,
            |x| Vec3::new(-30.0 * x.x, 0.0, 0.0),
            // Shear, and convergence along an oblique axis.
            |x| Vec3::new(-3.0 * x.x - 2.0 * x.y, 5.0 * x.x, 0.0),
        ];
        for velocity in even {
            let [with, without] = [&linear, &plain].map(|hydro| viscous_heat(hydro, velocity));
            // To the rounding of velocities on their grid.
            assert!(
                without > 0.0 && with.abs() < 1e-5 * without,
                "{with} {without}"
            );
        }
        let shock = |x: Vec3| Vec3::new(-3.0 * x.x.signum(), 0.0, 0.0);
        let [with, without] = [&linear, &plain].map(|hydro| viscous_heat(hydro, shock));
        println!(
            "{precision:?}: {} of a shock's heat are left",
            with / without
        );
        assert!(with < without && with > 0.3 * without, "{with} {without}");
    }
}

/// Gas at rest and in pressure equilibrium across a contact in a plane, particles spaced 1 : `ratio`, densities `contrast` : 1.
/// The largest acceleration in units of P / (rho h), and how far pressure rises over the true one.
fn contact(formulation: Formulation, ratio: usize, contrast: f64) -> [f64; 2] {
    let spacing = [1.0, ratio as f64].map(|part| part / 48.0);
    let mut x = Vec::new();
    for (k, spacing) in spacing.into_iter().enumerate() {
        let cells = |length: f64| (length / spacing).round() as usize;
        let shift = Vec3::new(2.0 * k as f64, 0.0, -0.5 * spacing);
        let block = lattice([cells(2.0), cells(1.0), 1], spacing);
        x.extend(block.iter().map(|x| x + shift));
    }
    let mut particles = still(x, 0.0, 0.0);
    for i in 0..particles.len() {
        let dense = particles.x[i].x < 2.0;
        let rho = if dense { contrast } else { 1.0 };
        particles.m[i] = rho * spacing[usize::from(!dense)].powi(2);
        particles.u[i] = 1.0 / ((GAMMA - 1.0) * rho);
    }
    let plane = Domain::periodic(Vec3::new(4.0, 1.0, 1.0)).with_axes([true, true, false]);
    let hydro = Hydro {
        formulation,
        ..hydro(plane)
    };
    let gas = pushed(Gas::new(particles), &hydro);
    let (d, mut most) = (&gas.derived, [0.0, 0.0]);
    for i in 0..gas.len() {
        let push = gas.rates.hydro[i].norm() * d.rho[i] * gas.particles.h[i];
        for (most, x) in most.iter_mut().zip([push, d.p[i] - 1.0]) {
            *most = if x <= *most { *most } else { x };
        }
    }
    most
}

#[test]
fn a_contact_is_no_wall_where_pressure_is_summed() {
    let both = |ratio, contrast| {
        let both = [Formulation::Density, Formulation::Pressure];
        let both = both.map(|formulation| contact(formulation, ratio, contrast));
        println!("spaced 1 : {ratio}, {contrast} : 1, push and wall of both: {both:?}");
        both
    };
    // Masses as the densities: the sum of pressure is that of a lattice without any contact.
    for (contrast, blip) in [(4.0, 1.4), (64.0, 50.0)] {
        let [density, pressure] = both(1, contrast);
        assert!(density[0] > blip && density[1] > 0.6);
        assert!(pressure[0] < 1e-12 && pressure[1] < 0.0073, "{pressure:?}");
    }
    // Equal masses: what is left is the noise of few and coarse neighbours.
    let [density, pressure] = both(2, 4.0);
    assert!(pressure[0] < 0.15 * density[0] && pressure[1] < 0.15 * density[1]);
    let [density, pressure] = both(8, 64.0);
    assert!(pressure[1] < 0.25 * density[1]);
}

#[test]
fn conducted_heat_is_the_sum_over_all_pairs() {
    let domain = Domain::periodic(Vec3::repeat(1.0));
    for formulation in [Formulation::Density, Formulation::Pressure] {
        let alpha = 0.7;
        let without = Hydro {
            formulation,
            ..hydro(domain)
        };
        let with = Hydro {
            conduction: Conduction { alpha },
            ..without.clone()
        };
        let gas = noisy(&domain, 8, 0.7);
        let (without, gas) = (pushed(gas.clone(), &without), pushed(gas, &with));
        let (p, d, u) = (&gas.particles, &gas.derived, &gas.rates.u_pred);
        for i in (0..gas.len()).step_by(7) {
            let mut expected = 0.0;
            for j in 0..gas.len() {
                let r = domain.nearest(p.x[i] - p.x[j]).norm();
                let slope = |k: usize| match r {
                    0.0 => 0.0,
                    r => WendlandC2::dw(r, (p.h[k] * with.support()).max(r), 3),
                };
                let rho = 0.5 * (d.rho[i] + d.rho[j]);
                let v_sig = ((d.p[i] - d.p[j]).abs() / rho).sqrt();
                let f = 0.5 * (slope(i) + slope(j));
                expected += p.m[j] * alpha * v_sig / rho * (u[i] - u[j]) * f;
            }
            let found = gas.rates.du[i] - without.rates.du[i];
            let scale = expected.abs() + u[i] * d.cs[i] / p.h[i];
            assert!(
                (found - expected).abs() < 1e-13 * scale,
                "{found} {expected}"
            );
            assert_eq!(gas.rates.hydro[i], without.rates.hydro[i]);
        }
    }
}

#[test]
fn heat_is_conducted_down_the_slope_of_temperature_and_none_is_lost() {
    let hydro = Hydro {
        conduction: Conduction { alpha: 1.0 },
        ..hydro(Domain::periodic(Vec3::new(24.0, 6.0, 6.0)))
    };
    let mut gas = Gas::new(still(lattice([24, 6, 6], 1.0), 1.0, 1.0));
    let warm = |x: f64| x > 6.0 && x < 18.0;
    for i in 0..gas.len() {
        gas.rates.u_pred[i] = if warm(gas.particles.x[i].x) {
            1.05
        } else {
            1.0
        };
    }
    let total = |gas: &Gas| gas.rates.u_pred.iter().sum::<f64>();
    let before = total(&gas);
    let mut order: Vec<usize> = (0..gas.len()).collect();
    order.sort_by(|&i, &j| gas.particles.x[i].x.total_cmp(&gas.particles.x[j].x));
    let mut steepest = 0.05;
    for _ in 0..40 {
        gas = pushed(gas, &hydro);
        // A quarter of the time that a signal takes through a smoothing length.
        let dt = 0.25 * gas.particles.h[0] / hydro.eos.sound_speed(1.0, 1.05);
        for i in 0..gas.len() {
            gas.rates.u_pred[i] += dt * gas.rates.du[i];
        }
        let mut steep = 0.0;
        for pair in order.windows(2) {
            let rise = gas.rates.u_pred[pair[1]] - gas.rates.u_pred[pair[0]];
            let rise = if gas.particles.x[pair[1]].x < 12.0 {
                rise
            } else {
                -rise
            };
            assert!(rise > -1e-13, "{rise}");
            steep = if rise <= steep { steep } else { rise };
        }
        assert!(steep < steepest);
        steepest = steep;
    }
    assert!((total(&gas) / before - 1.0).abs() < 1e-14);
    // A third of what the step was.
    assert!((0.014..0.016).contains(&steepest), "{steepest}");
}

#[test]
fn half_of_the_gas_alone_gets_the_forces_that_all_get_together() {
    for hydro in settings(Domain::periodic(Vec3::repeat(1.0))) {
        check_half(&hydro);
    }
}

fn check_half(hydro: &Hydro) {
    let mut gas = pushed(noisy(&hydro.domain, 10, 1.0), hydro);
    let all = gas.clone();
    let clock = Clock {
        start: 0.0,
        end: 1.0,
        tick: 64,
        step: 1,
    };
    for i in 0..gas.len() {
        let active = gas.particles.x[i].x < 0.3;
        gas.particles.span[i] = if active { 64 } else { 128 };
        gas.particles.end[i] = gas.particles.span[i];
    }
    gas.rates.next_span.clone_from(&gas.particles.span);
    gas.rates.hydro.fill(Vec3::zeros());
    // It stands where it is.
    gas.now = clock.tick;
    gas.bound();
    gas.look(hydro, &clock);
    let targets = gas.forces(hydro, &clock, &clock);
    let (mut impulse, mut size, mut touched) = (Vec3::zeros(), 0.0, 0);
    let (mut work, mut power) = ([0.0; 2], 0.0);
    for i in 0..gas.len() {
        let active = gas.active(&clock, i);
        let (now, then) = (gas.rates.hydro[i], all.rates.hydro[i]);
        if active {
            // The same pairs in the same order; impulses of 32 ticks.
            assert_eq!(now, then);
            let expected = now * 32.0 * clock.unit();
            assert!((gas.rates.dv_close[i] - expected).norm() < 1e-14 * expected.norm());
            assert!((gas.rates.dv_open[i] - expected).norm() < 1e-14 * expected.norm());
        } else {
            assert_eq!(now, Vec3::zeros());
        }
        impulse += gas.particles.m[i] * gas.rates.dv_close[i];
        size += (gas.particles.m[i] * gas.rates.dv_close[i]).norm();
        let (m, v, r) = (gas.particles.m[i], gas.rates.v_pred[i], &gas.rates);
        work[0] += m * (v.dot(&r.dv_close[i]) + r.du_close[i]);
        work[1] += m * (v.dot(&r.dv_open[i]) + r.du_open[i]);
        power += m * v.dot(&r.dv_close[i]).abs();
        touched += usize::from(active || gas.rates.dv_close[i] != Vec3::zeros());
    }
    assert_eq!(touched, targets);
    assert!(targets < gas.len());
    assert!(impulse.norm() < 1e-15 * size, "{}", impulse.norm() / size);
    let bar = match hydro.precision {
        Precision::Double => 1e-14,
        Precision::Single => 1e-7,
    };
    assert!(
        work.iter().all(|work| work.abs() < bar * power),
        "{work:?} {power}"
    );
    assert_eq!(gas.rates.non_finite(), None);
}

/// Largest acceleration in a sheared lattice of gas at the pressure 1, of which forces leave out `background`.
fn elastic(background: f64) -> f64 {
    let domain = Domain::periodic(Vec3::repeat(1.0)).with_axes([true, true, false]);
    let n = 24;
    let spacing = 1.0 / n as f64;
    let mut x = lattice([n, n, 1], spacing);
    for x in &mut x {
        x.y += 0.2 * spacing * (std::f64::consts::TAU * x.x).sin();
    }
    let hydro = Hydro {
        background_pressure: BackgroundPressure::Fixed(background),
        viscosity: Viscosity::None,
        ..Hydro::new(
            domain,
            crate::Eos::Isothermal {
                sound_speed: 1.0,
                gamma: GAMMA,
            },
        )
    };
    let gas = pushed(Gas::new(still(x, spacing * spacing, 1.0)), &hydro);
    gas.rates.hydro.iter().map(|a| a.norm()).fold(0.0, f64::max)
}

#[test]
fn a_sheared_lattice_is_elastic_unless_forces_leave_out_its_pressure() {
    // Of shear at constant density nothing is left but what the sums of density see of it.
    let (whole, rest) = (elastic(0.0), elastic(1.0));
    println!("{whole:e} {rest:e}");
    assert!(whole > 0.0 && rest < 0.02 * whole, "{rest:e} of {whole:e}");
}

#[test]
fn what_forces_leave_out_heats_free_gas_all_the_same() {
    let domain = Domain::periodic(Vec3::repeat(1.0)).with_axes([true, true, false]);
    for formulation in Formulation::ALL {
        let hydro = |background_pressure| Hydro {
            background_pressure,
            formulation,
            tolerance: 1e-10,
            viscosity: Viscosity::None,
            ..Hydro::new(domain, crate::Eos::Ideal { gamma: GAMMA })
        };
        let whole = pushed(noisy(&domain, 16, 0.5), &hydro(BackgroundPressure::NONE));
        let part = pushed(noisy(&domain, 16, 0.5), &hydro(BackgroundPressure::Least));
        let (derived, background) = (&whole.derived, part.background.pressure);
        // Sound takes H / c across the kernel, in which expanding gas loses rho c^2 / P div v H / c of ln P.
        let support = hydro(BackgroundPressure::NONE).support();
        let least = (0..whole.len())
            .map(|i| {
                let crossing = support * whole.particles.h[i] / derived.cs[i];
                let by_density = derived.rho[i] * derived.cs[i].powi(2) / derived.p[i];
                let fall = by_density * crossing * derived.div_v[i];
                derived.p[i] * (-(fall - 1.0).max(0.0)).exp()
            })
            .fold(f64::INFINITY, f64::min);
        println!("{formulation:?} {}", background / least);
        assert!((background / least - 0.95).abs() < 1e-12);
        let work = |gas: &Gas| -> f64 {
            let p = &gas.particles;
            let power = |i: usize| p.m[i] * (gas.rates.du[i] + p.v[i].dot(&gas.rates.hydro[i]));
            (0..gas.len()).map(power).sum()
        };
        let size: f64 = (whole.particles.m.iter().zip(&whole.rates.du))
            .map(|(m, du)| (m * du).abs())
            .sum();
        for (a, b) in whole.rates.du.iter().zip(&part.rates.du) {
            assert!((a - b).abs() <= 1e-12 * a.abs().max(1.0), "{a} {b}");
        }
        assert!(work(&whole).abs() < 1e-13 * size);
        // P_0 d(sum x / y)/dt at constant x, from two sums a moment apart.
        let moved = |dt: f64| {
            let mut gas = noisy(&domain, 16, 0.5);
            for i in 0..gas.len() {
                let v = gas.particles.v[i];
                gas.particles.x[i] += dt * v;
            }
            let gas = pushed(gas, &hydro(BackgroundPressure::NONE));
            let weighs = formulation == Formulation::Pressure;
            let volume = |i: usize| {
                let rho = gas.derived.rho[i];
                let own = 2.0 / 3.0 * rho * gas.particles.u[i];
                let share = if weighs { own / gas.derived.p[i] } else { 1.0 };
                gas.particles.m[i] / rho * share
            };
            (0..gas.len()).map(volume).sum::<f64>()
        };
        let dt = 1e-6;
        let rate = (moved(dt) - moved(-dt)) / (2.0 * dt);
        let lost = -work(&part) / background;
        println!("{formulation:?} {lost:e} {rate:e}");
        assert!((lost - rate).abs() < 1e-7 * rate.abs(), "{lost} {rate}");
    }
}
