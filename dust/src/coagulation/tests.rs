//! Tests of `coagulation`.

use nbody::points::{Columns, Domain, Vec3};
use rand::RngExt;

use super::*;
use crate::relative_speed::{Grain, Motion, Reynolds, Turbulence};
use crate::{Ambient, Sphere, Superparticles};

/// Radius of a grain of unit mass and density.
const UNIT: f64 = 0.620_350_490_899_4;

/// Swarms of grains of unit mass, whose own masses are spread over a factor `spread`.
fn monomers(n: usize, spread: f64, seed: u64) -> Dust {
    let mut p = Superparticles {
        id: (0..n as u64).collect(),
        ..Superparticles::default()
    };
    p.resize(n);
    let mut random = stream(seed, Purpose::GrainSizes, 0, 0);
    for m in &mut p.m {
        *m = 1e12 * spread.powf(random.random());
    }
    for x in &mut p.x {
        *x = Vec3::new(random.random(), random.random(), random.random());
    }
    p.grain_radius.fill(UNIT);
    p.grain_density.fill(1.0);
    Dust::new(p)
}

fn mass(dust: &Dust) -> f64 {
    dust.particles.m.iter().sum()
}

/// Sum over the swarms of mass times a power of the grain's mass, by their mass.
fn moment(dust: &Dust, power: f64) -> f64 {
    let p = &dust.particles;
    let grain = |i: usize| Aggregate::new(p.grain_radius[i], p.grain_density[i]).m;
    (0..p.len())
        .map(|i| p.m[i] * grain(i).powf(power - 1.0))
        .sum::<f64>()
        / mass(dust)
}

use crate::porosity::Aggregate;

/// Number and second moment at the times, in a well-mixed box of unit density.
fn box_of(kernel: Kernel, seed: u64, spread: f64, times: &[f64], dt: f64) -> Vec<[f64; 2]> {
    let n = 4000;
    let mut dust = monomers(n, spread, seed);
    let before = dust.particles.m.clone();
    let volume = mass(&dust);
    let mut coagulation = Coagulation::new(kernel, seed);
    let (mut now, mut step) = (0.0, 0);
    let moments = times.iter().map(|&time| {
        while now < time - 1e-9 {
            coagulation.cells.mix(n, volume, (seed, step));
            let tally = coagulation.advance(&mut dust, &|_| Place::default(), dt, step);
            assert_eq!((tally.whole, tally.flat), (0, 0));
            (now, step) = (now + dt, step + 1);
        }
        [moment(&dust, 0.0), moment(&dust, 2.0)]
    });
    let moments = moments.collect();
    assert_eq!(dust.particles.m, before, "each swarm keeps its mass");
    moments
}

/// Mean and standard error.
fn mean(values: impl Iterator<Item = f64> + Clone) -> [f64; 2] {
    let n = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / n;
    let square = values.map(|x| (x - mean).powi(2)).sum::<f64>();
    [mean, (square / (n - 1.0) / n).sqrt()]
}

fn agrees(what: &str, kernel: Kernel, spread: f64, dt: f64, exact: &[(f64, [f64; 2])]) {
    let times: Vec<f64> = exact.iter().map(|(time, _)| *time).collect();
    let runs: Vec<_> = (0..10)
        .map(|seed| box_of(kernel, seed, spread, &times, dt))
        .collect();
    for (k, (time, moments)) in exact.iter().enumerate() {
        for (which, value) in moments.iter().enumerate() {
            let [found, error] = mean(runs.iter().map(|run| run[k][which]));
            let off = (found - value) / error;
            println!(
                "{what} t = {time}, M{}: {found} +- {error:.1e}, exact {value}, {off:+.1}",
                2 * which
            );
            assert!(off.abs() < 3.0, "{what} {time}: {found} {value} {off}");
            assert!(error < 0.02 * value, "{what} {time}: {error:e}");
        }
    }
}

#[test]
fn the_constant_kernel_has_smoluchowskis_moments() {
    let exact = |t: f64| (t, [1.0 / (1.0 + 0.5 * t), 1.0 + t]);
    for spread in [1.0, 30.0] {
        agrees(
            "constant",
            Kernel::Constant(1.0),
            spread,
            0.1,
            &[exact(1.0), exact(10.0)],
        );
    }
}

#[test]
fn the_sum_kernel_has_golovins_moments() {
    let exact = |t: f64| (t, [(-t).exp(), (2.0 * t).exp()]);
    agrees(
        "sum",
        Kernel::Sum(1.0),
        1.0,
        0.025,
        &[exact(0.5), exact(1.0)],
    );
    agrees(
        "sum",
        Kernel::Sum(1.0),
        30.0,
        0.025,
        &[exact(0.5), exact(1.0)],
    );
}

#[test]
fn the_product_kernel_has_its_moments_and_gels_in_time() {
    let exact = |t: f64| (t, [1.0 - 0.5 * t, 1.0 / (1.0 - t)]);
    agrees(
        "product",
        Kernel::Product(1.0),
        1.0,
        0.025,
        &[exact(0.25), exact(0.5)],
    );
    // 1 / M2 falls in a straight line to zero at the time of gelation.
    let times = [0.2, 0.6];
    let found = (0..10).map(|seed| {
        let run = box_of(Kernel::Product(1.0), 100 + seed, 1.0, &times, 0.0125);
        let [a, b] = [1.0 / run[0][1], 1.0 / run[1][1]];
        times[0] + (times[1] - times[0]) * a / (a - b)
    });
    let [gelation, error] = mean(found.collect::<Vec<_>>().into_iter());
    println!("gelation at {gelation} +- {error}");
    assert!((gelation - 1.0).abs() < 0.03 && error < 0.02, "{gelation}");
}

#[test]
fn a_grain_does_not_outweigh_its_swarm() {
    let mut dust = monomers(64, 1.0, 1);
    dust.particles.m.fill(40.0);
    let mut coagulation = Coagulation::new(Kernel::Product(1.0), 1);
    let mut refused = 0;
    for step in 0..200 {
        coagulation.cells.mix(64, mass(&dust), (1, step));
        let tally = coagulation.advance(&mut dust, &|_| Place::default(), 0.05, step);
        refused += tally.whole;
    }
    let largest = (dust.particles.grain_radius.iter()).fold(0.0f64, |m, &r| m.max(r / UNIT));
    assert!(refused > 0);
    assert!(largest.powi(3) <= 40.0 * (1.0 + 1e-12) && largest.powi(3) > 20.0);
}

/// Gas of unit sound speed around everybody, as drag would leave it.
fn surround(dust: &mut Dust, rho: f64) {
    let n = dust.len();
    dust.derived.rho_gas.fill(rho);
    dust.derived.c_gas = vec![1.0; n];
    dust.derived.slip = (0..n)
        .map(|i| 1e-3 * Vec3::new((i % 3) as f64, (i % 5) as f64, (i % 7) as f64))
        .collect();
}

fn physics() -> Physics {
    Physics {
        sources: Sources {
            molecule: 1e-9,
            turbulence: Some(Turbulence {
                alpha: 1e-3,
                reynolds: Reynolds::Number(1e8),
            }),
            motion: Motion::Resolved,
        },
        rules: Rules::STICKING,
        porosity: None,
        law: StoppingLaw::Epstein,
        spread: false,
    }
}

const PLACE: Place = Place {
    omega: 1.0,
    height: 0.0,
};

/// Grains of many sizes.
fn mixture(n: usize) -> Dust {
    let mut dust = monomers(n, 10.0, 5);
    for i in 0..n {
        let id = dust.particles.id[i];
        dust.particles.grain_radius[i] = 10f64.powf(-3.0 + (id % 16) as f64 / 8.0);
    }
    surround(&mut dust, 1.0);
    dust
}

#[test]
fn collisions_come_as_often_as_cross_section_and_speed_say() {
    let n = 32;
    let dust = mixture(n);
    let rules = Rules {
        bouncing_speed: 0.0,
        ..Rules::STICKING
    };
    let physics = Physics { rules, ..physics() };
    let gas = Ambient {
        rho: 1.0,
        c: 1.0,
        omega: 1.0,
    };
    let conditions = physics.sources.conditions(&gas);
    let grain = |i: usize| {
        let p = &dust.particles;
        let sphere = Sphere {
            radius: p.grain_radius[i],
            density: p.grain_density[i],
        };
        let u = dust.derived.slip[i];
        let stokes = physics.law.stopping_time(&sphere, &gas, u.norm());
        let m = Aggregate::new(sphere.radius, sphere.density).m;
        (Grain { m, stokes, u }, sphere.radius, p.m[i])
    };
    let volume = 1e18;
    let mut rate = 0.0;
    for i in 0..n {
        for j in (0..n).filter(|&j| j != i) {
            let ((one, s1, _), (two, s2, swarm)) = (grain(i), grain(j));
            let many = (0.05 * one.m / two.m).max(1.0);
            let number = swarm / two.m / volume * n as f64 / (n - 1) as f64;
            let kernel = std::f64::consts::PI * (s1 + s2).powi(2) * conditions.speed(&one, &two);
            rate += number * kernel / many;
        }
    }
    let mut coagulation = Coagulation::new(Kernel::Physical(physics), 3);
    coagulation.cells.mix(n, volume, (0, 0));
    let dt = 2e5 / rate;
    let mut after = dust.clone();
    let tally = coagulation.advance(&mut after, &|_| PLACE, dt, 0);
    let [_, bounced, ..] = tally.collisions;
    assert_eq!(tally.total(), bounced);
    let off = (bounced as f64 - 2e5) / 2e5f64.sqrt();
    println!(
        "{bounced} collisions of {} drawn, {off:+.1} standard errors",
        tally.drawn
    );
    assert!(off.abs() < 3.0, "{bounced}");
    assert!(tally.drawn < 4 * bounced);
    assert_eq!(after.particles.grain_radius, dust.particles.grain_radius);
}

#[test]
fn results_do_not_depend_on_threads() {
    let run = |threads: usize| {
        let mut dust = mixture(3000);
        let mut coagulation = Coagulation::new(Kernel::Physical(physics()), 3);
        (coagulation.cells).divide(&dust.particles.x, &dust.tree, &Domain::open());
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.expect("a thread pool");
        let tally = pool.install(|| coagulation.advance(&mut dust, &|_| PLACE, 1e-14, 9));
        let p = &dust.particles;
        let mut radii: Vec<(u64, u64)> = (p.id.iter().zip(&p.grain_radius))
            .map(|(&id, r)| (id, r.to_bits()))
            .collect();
        radii.sort_unstable();
        (tally, radii)
    };
    let one = run(1);
    assert!(one.0.total() > 1000, "{:?}", one.0);
    assert!(one == run(2) && one == run(7));
}

#[test]
fn grown_grains_have_their_new_stopping_times() {
    let mut dust = mixture(320);
    let physics = physics();
    let mut coagulation = Coagulation::new(Kernel::Physical(physics), 3);
    coagulation.cells.mix(320, 1e10, (0, 0));
    let before = dust.particles.grain_radius.clone();
    coagulation.advance(&mut dust, &|_| PLACE, 1e-3, 0);
    let (p, derived) = (&dust.particles, &dust.derived);
    let gas = Ambient {
        rho: 1.0,
        c: 1.0,
        omega: 1.0,
    };
    let grown = (0..320).filter(|&i| p.grain_radius[i] != before[i]);
    let worst = grown.map(|i| {
        let sphere = Sphere {
            radius: p.grain_radius[i],
            density: p.grain_density[i],
        };
        let t = (physics.law).stopping_time(&sphere, &gas, derived.slip[i].norm());
        (derived.t_stop[i] / t - 1.0)
            .abs()
            .max((derived.stokes[i] / t - 1.0).abs())
    });
    let worst: Vec<f64> = worst.collect();
    assert!(worst.len() > 100, "{}", worst.len());
    assert!(worst.iter().all(|&w| w < 1e-12));
}

#[test]
fn brownian_motion_makes_fractal_grains() {
    let n = 1000;
    let mut dust = monomers(n, 1.0, 2);
    surround(&mut dust, 1.0);
    let monomers = Monomers {
        radius: UNIT,
        density: 1.0,
        // No impact compresses, nor does gas.
        rolling_energy: 1e30,
        g: 0.0,
    };
    let physics = Physics {
        sources: Sources {
            molecule: 1e-6,
            turbulence: None,
            motion: Motion::Still,
        },
        porosity: Some(monomers),
        ..physics()
    };
    let volume = mass(&dust);
    let mut coagulation = Coagulation::new(Kernel::Physical(physics), 3);
    let mean = |dust: &Dust| {
        let p = &dust.particles;
        let logs = (0..n).map(|i| {
            let (a, rho): (f64, f64) = (p.grain_radius[i], p.grain_density[i]);
            [a.ln(), Aggregate::new(a, rho).m.ln()]
        });
        logs.fold([0.0; 2], |sum, log| {
            [sum[0] + log[0] / n as f64, sum[1] + log[1] / n as f64]
        })
    };
    let (mut step, mut dt) = (0, 3.0);
    let mut seen = Vec::new();
    while mean(&dust)[1] < 9.0 {
        coagulation.cells.mix(n, volume, (3, step));
        let tally = coagulation.advance(&mut dust, &|_| Place::default(), dt, step);
        // About a fifth of the swarms at a time.
        dt *= if tally.total() < n as u64 / 5 {
            1.3
        } else {
            0.8
        };
        step += 1;
        seen.push(mean(&dust));
    }
    let middle = seen
        .iter()
        .find(|log| log[1] > 4.5)
        .expect("a state half way");
    let last = seen.last().expect("a state");
    let dimension = (last[1] - middle[1]) / (last[0] - middle[0]);
    println!("fractal dimension {dimension} after {step} steps");
    // Equal grains: 1.90; grains that meet smaller ones fill up more.
    assert!((dimension - 1.95).abs() < 0.1, "{dimension}");
}

/// Cost of a call in which little happens: `cargo test --release -p tridisk-dust --lib cost -- --ignored --nocapture`.
#[test]
#[ignore = "a measurement"]
fn cost() {
    let n = 1_000_000;
    let mut dust = mixture(n);
    let mut coagulation = Coagulation::new(Kernel::Physical(physics()), 3);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.expect("a thread pool").install(|| {
        for dt in [0.0, 1e-17, 1e-16, 1e-15] {
            let start = std::time::Instant::now();
            (coagulation.cells).divide(&dust.particles.x, &dust.tree, &Domain::open());
            let divided = start.elapsed().as_secs_f64();
            let tally = coagulation.advance(&mut dust, &|_| PLACE, dt, 0);
            let all = start.elapsed().as_secs_f64();
            let each = |s: f64| s * 1e6 / n as f64;
            println!(
                "dt {dt}: cells {:.3} us, collisions {:.3} us, a superparticle; {} collisions of {} drawn",
                each(divided),
                each(all - divided),
                tally.total(),
                tally.drawn
            );
        }
    });
}
