//! Tests of `drag`.

use dust::{Dust, Superparticles};
use gas::Particles;
use nbody::Bodies;
use nbody::points::Columns;

use super::*;

mod kinds;
mod stiff;

const REACH: Reach = Reach {
    neighbours: 64.0,
    largest: 3.0,
};

fn settings(law: StoppingLaw) -> Settings {
    Settings::new(law, REACH)
}

fn constant(t: f64) -> Settings {
    settings(StoppingLaw::ConstantStoppingTime(t))
}

/// A cubic lattice of n^3 points of unit spacing, shifted along the diagonal.
fn lattice(n: usize, shift: f64) -> Vec<Vec3> {
    (0..n * n * n)
        .map(|i| Vec3::new((i % n) as f64, (i / n % n) as f64, (i / n / n) as f64))
        .map(|x| x + Vec3::repeat(shift))
        .collect()
}

/// Quasi-random points in the cube [0, side).
fn scattered(n: usize, side: f64, offset: f64) -> Vec<Vec3> {
    let f = |i: usize, k: f64| (i as f64 * k + offset).fract() * side;
    (0..n)
        .map(|i| Vec3::new(f(i, 0.819_172_5), f(i, 0.671_043_6), f(i, 0.549_700_5)))
        .collect()
}

/// Gas of unit density and sound speed.
fn gas(x: Vec<Vec3>, m: f64, v: impl Fn(Vec3) -> Vec3) -> Gas {
    let mut particles = Particles {
        v: x.iter().map(|&x| v(x)).collect(),
        x,
        ..Particles::default()
    };
    let n = particles.v.len();
    particles.id = (0..n as u64).collect();
    particles.resize(n);
    particles.m.fill(m);
    particles.u.fill(1.0);
    let mut gas = Gas::new(particles);
    gas.derived.rho.fill(1.0);
    gas.derived.p.fill(1.0);
    gas
}

fn dust(x: Vec<Vec3>, m: f64, v: impl Fn(Vec3) -> Vec3) -> Dust {
    let mut particles = Superparticles {
        v: x.iter().map(|&x| v(x)).collect(),
        x,
        ..Superparticles::default()
    };
    let n = particles.v.len();
    particles.id = (0..n as u64).collect();
    particles.resize(n);
    particles.m.fill(m);
    particles.grain_radius.fill(1.0);
    particles.grain_density.fill(1.0);
    Dust::new(particles)
}

/// Momentum, angular momentum, kinetic and thermal energy of gas and grains.
#[derive(Clone, Copy, Debug)]
struct Total {
    p: Vec3,
    l: Vec3,
    kinetic: f64,
    heat: f64,
}

fn total(gas: &Gas, dust: &Dust) -> Total {
    let g = &gas.particles;
    let d = &dust.particles;
    let all = || {
        let gas = g.x.iter().zip(&g.v).zip(&g.m);
        gas.chain(d.x.iter().zip(&d.v).zip(&d.m))
    };
    Total {
        p: precise(all().map(|((_, v), &m)| m * v)),
        l: precise(all().map(|((x, v), &m)| m * x.cross(v))),
        kinetic: precise(all().map(|((_, v), &m)| Vec3::x() * (0.5 * m * v.norm_squared()))).x,
        heat: precise(g.u.iter().zip(&g.m).map(|(u, m)| Vec3::x() * (u * m))).x,
    }
}

/// A sum that carries its own rounding error (Neumaier 1974), so that it does not hide that of the exchange.
fn precise(terms: impl Iterator<Item = Vec3>) -> Vec3 {
    let (mut sum, mut rest) = (Vec3::zeros(), Vec3::zeros());
    for term in terms {
        for k in 0..3 {
            let (a, b) = (sum[k], term[k]);
            let (large, small) = if a.abs() > b.abs() { (a, b) } else { (b, a) };
            sum[k] = a + b;
            rest[k] += (large - sum[k]) + small;
        }
    }
    sum + rest
}

/// A scene whose particles stay where they are, all with one step.
struct Box {
    gas: Gas,
    dust: Dust,
    exchange: Exchange,
    active: Vec<u32>,
}

impl Box {
    fn new(gas: Gas, dust: Dust, domain: Domain, settings: Settings) -> Self {
        let active: Vec<u32> = (0..dust.len() as u32).collect();
        let mut exchange = Exchange::new(settings);
        let mut dust = dust;
        dust.rates.excess.resize(dust.len(), Vec3::zeros());
        // Twice, as in a run: the first time the smoothing lengths are found from nothing.
        for _ in 0..2 {
            exchange.prepare(&gas, &mut grains(&mut dust), &active, &domain);
        }
        Self {
            gas,
            dust,
            exchange,
            active,
        }
    }

    fn half(&mut self, step: f64, half: Half) -> Booking {
        let steps = vec![step; self.active.len()];
        let mut grains = grains(&mut self.dust);
        self.exchange.exchange(
            &mut self.gas,
            &mut grains,
            &steps,
            (half, &Clock::standing(0.0)),
        )
    }

    /// An opening and a closing half, each with its kick; kick and drag in the order of a symmetric step.
    fn step(&mut self, dt: f64) -> Booking {
        let mut booking = self.half(0.5 * dt, Half::Opening);
        self.kick(0.5 * dt);
        self.kick(0.5 * dt);
        self.synchronise();
        booking += self.half(0.5 * dt, Half::Closing);
        booking
    }

    fn kick(&mut self, s: f64) {
        for j in 0..self.gas.len() {
            let a = self.gas.acceleration(j);
            self.gas.particles.v[j] += s * a;
        }
        for i in 0..self.dust.len() {
            self.dust.particles.v[i] += s * self.dust.rates.gravity[i];
        }
    }

    fn synchronise(&mut self) {
        self.gas.rates.v_pred.clone_from(&self.gas.particles.v);
        self.dust.rates.v_pred.clone_from(&self.dust.particles.v);
    }

    fn total(&self) -> Total {
        total(&self.gas, &self.dust)
    }
}

fn grains(dust: &mut Dust) -> Grains<'_> {
    Grains {
        dust,
        star: Star::default(),
    }
}

/// Gas and grains on two lattices, shifted by half a cell.
fn dustybox(dust_to_gas: f64, speed: f64, settings: Settings) -> Box {
    let n = 6;
    let gas = gas(lattice(n, 0.0), 1.0, |_| Vec3::zeros());
    let dust = dust(lattice(n, 0.5), dust_to_gas, |_| Vec3::new(speed, 0.0, 0.0));
    let domain = Domain::periodic(Vec3::repeat(n as f64));
    Box::new(gas, dust, domain, settings)
}

/// Largest difference of any component from the velocity `v` along x.
fn off(v: &[Vec3], exact: f64) -> f64 {
    v.iter().fold(0.0, |worst: f64, v| {
        let error = (v - Vec3::new(exact, 0.0, 0.0)).amax();
        if error <= worst { worst } else { error }
    })
}

#[test]
fn dustybox_decays_exactly_for_any_stopping_time_and_load() {
    let (dt, steps) = (0.1, 10);
    for eps in [0.01, 1.0, 100.0] {
        for t_stop in [1e-12, 1e-8, 1e-4, 0.03, 1.0, 30.0, 1e4, 1e8, 1e12] {
            let mut scene = dustybox(eps, 1.0, constant(t_stop));
            let before = scene.total();
            for _ in 0..steps {
                scene.step(dt);
            }
            let left = (-(1.0 + eps) * dt * f64::from(steps) / t_stop).exp();
            let mean = eps / (1.0 + eps);
            let grains = off(&scene.dust.particles.v, mean + left / (1.0 + eps));
            let gas = off(&scene.gas.particles.v, mean * (1.0 - left));
            let case = format!("eps {eps} t_stop {t_stop:e}");
            assert!(grains < 1e-14 && gas < 1e-14, "{case}: {grains:e} {gas:e}");
            let after = scene.total();
            let p = (after.p - before.p).norm() / before.p.norm();
            assert!(p < 1e-14, "{case}: momentum {p:e}");
            let lost = after.kinetic - before.kinetic + after.heat - before.heat;
            let error = lost.abs() / (before.kinetic + before.heat);
            assert!(error < 1e-14, "{case}: energy {error:e}");
        }
    }
}

#[test]
fn dustybox_agrees_with_the_table() {
    // K = 1, rho_g = rho_d = 1: v_g, v_d and heat per volume.
    let mut scene = dustybox(1.0, 1.0, constant(1.0));
    let mut heat = 0.0;
    let mut time = 0.0;
    for (until, steps, v_g, v_d, table) in [
        (0.05, 1, 0.047581290982, 0.952418709018, 0.0453173117305),
        (0.2, 2, 0.164839976982, 0.835160023018, 0.137667758971),
        (1.0, 3, 0.432332358382, 0.567667641618, 0.245421090278),
        (5.0, 1, 0.499977300035, 0.500022699965, 0.249999999485),
    ] {
        for _ in 0..steps {
            heat += scene.step((until - time) / f64::from(steps)).heat;
        }
        time = until;
        let error = off(&scene.gas.particles.v, v_g)
            + off(&scene.dust.particles.v, v_d)
            + (heat / 216.0 - table).abs();
        // The table has twelve digits.
        assert!(error < 1e-12, "t = {until}: {error:e}");
    }
}

#[test]
fn epstein_drag_decays_as_the_mixed_dustybox() {
    // K = 1, rho_g = 1, rho_d = 1/2, so t = 1/2 at rest; a = 9 pi/128 for unit sound speed.
    let mut scene = dustybox(0.5, 3.0, settings(StoppingLaw::Epstein));
    let v_th = (8.0 / std::f64::consts::PI).sqrt();
    let density = 0.5 * v_th * sampled_density(&scene);
    scene.dust.particles.grain_density.fill(density);
    let mut time = 0.0;
    for (until, u) in [
        (0.05, 2.35935544003),
        (0.2, 1.31234679238),
        (1.0, 0.109550999594),
        (5.0, 6.7265908977e-7),
    ] {
        for _ in 0..2 {
            scene.step(0.5 * (until - time));
        }
        time = until;
        let seen = scene.dust.particles.v[7].x - scene.gas.particles.v[5].x;
        let error = (seen - u).abs();
        assert!(error < 1e-11, "t = {until}: {seen} {u} {error:e}");
    }
}

/// The density that grains of a lattice see.
fn sampled_density(scene: &Box) -> f64 {
    let mut probe = gas::probe::Probe::default();
    let domain = Domain::periodic(Vec3::repeat(6.0));
    let (x, h) = (scene.dust.particles.x[0], scene.dust.particles.h[0]);
    probe.sample(&scene.gas, &domain, x, h, &REACH).rho
}

#[test]
fn angular_momentum_is_kept_even_at_the_edge() {
    let spin = |x: Vec3| Vec3::new(0.2, -0.4, 1.0).cross(&x);
    let gas = gas(scattered(1000, 10.0, 0.0), 1.0, spin);
    let dust = dust(scattered(1000, 11.0, 0.6), 0.7, |x| {
        Vec3::new(x.y, 1.0, -x.x)
    });
    let mut scene = Box::new(gas, dust, Domain::open(), constant(0.3));
    let start = scene.total();
    let mut booking = Booking::default();
    for _ in 0..5 {
        booking += scene.step(0.1);
    }
    let end = scene.total();
    let error = (end.l - start.l).norm() / start.l.norm();
    assert_eq!(booking.plain, 0);
    assert!(booking.rigid > 100, "{booking:?}");
    assert!(error < 1e-14, "angular momentum {error:e}");
    let error = (end.p - start.p).norm() / start.p.norm();
    assert!(error < 1e-14, "momentum {error:e}");
    let sum = booking.gas.kinetic + booking.immersed.kinetic + booking.heat;
    assert!(sum.abs() < 1e-13 * start.kinetic, "{sum:e}");
    let l = booking.gas.angular_momentum + booking.immersed.angular_momentum;
    assert!(l.norm() < 1e-12 * start.l.norm());
}

#[test]
fn a_grain_moving_with_sheared_gas_feels_nothing() {
    let shear = |x: Vec3| Vec3::new(2.0 + 1.5 * x.y, -0.5 * x.x + x.z, 3.0);
    let gas = gas(scattered(4000, 16.0, 0.0), 1.0, shear);
    let inside: Vec<Vec3> = scattered(100, 8.0, 0.3)
        .into_iter()
        .map(|x| x + Vec3::repeat(4.0))
        .collect();
    let dust = dust(inside, 5.0, shear);
    let mut scene = Box::new(gas, dust, Domain::open(), constant(1e-6));
    let before = scene.dust.particles.v.clone();
    scene.step(1.0);
    for (after, before) in scene.dust.particles.v.iter().zip(&before) {
        let error = (after - before).norm();
        assert!(error < 2e-13, "{error:e}");
    }
}

#[test]
fn strange_places_are_finite_and_keep_momentum() {
    let still = |_: Vec3| Vec3::zeros();
    let moving = |_: Vec3| Vec3::new(1.0, 2.0, 3.0);
    let place = Vec3::repeat(3.1);
    let cases = [
        ("alone", vec![], vec![place]),
        ("one and one", vec![place], vec![place + Vec3::x()]),
        ("coincident", vec![place], vec![place]),
        (
            "all at one point",
            scattered(200, 6.0, 0.0),
            vec![place; 300],
        ),
        (
            "all gas at one point",
            vec![place; 200],
            scattered(200, 6.0, 0.0),
        ),
        (
            "far away",
            scattered(200, 6.0, 0.0),
            vec![Vec3::repeat(1e6)],
        ),
        (
            "gas in a plane",
            flat(scattered(200, 6.0, 0.0)),
            scattered(50, 6.0, 0.1),
        ),
        ("gas on a line", line(60), scattered(50, 6.0, 0.1)),
        ("nobody", scattered(20, 6.0, 0.0), vec![]),
    ];
    for (name, gas_x, dust_x) in cases {
        let mut scene = Box::new(
            gas(gas_x, 1.0, still),
            dust(dust_x, 10.0, moving),
            Domain::open(),
            constant(1e-3),
        );
        let before = scene.total();
        let booking = scene.step(1.0);
        let after = scene.total();
        assert!(scene.dust.particles.non_finite().is_none(), "{name}");
        assert!(scene.gas.particles.non_finite().is_none(), "{name}");
        let error = (after.p - before.p).norm();
        assert!(error <= 1e-13 * before.p.norm(), "{name}: {error:e}");
        assert!(after.kinetic <= before.kinetic * (1.0 + 1e-14), "{name}");
        let sum = booking.gas.kinetic + booking.immersed.kinetic + booking.heat;
        assert!(sum.abs() <= 1e-12 * before.kinetic, "{name}: {sum:e}");
        if booking.plain == 0 {
            let error = (after.l - before.l).norm();
            assert!(error <= 1e-12 * before.l.norm(), "{name}: {error:e}");
        }
    }
}

fn flat(mut x: Vec<Vec3>) -> Vec<Vec3> {
    x.iter_mut().for_each(|x| x.z = 3.0);
    x
}

fn line(n: usize) -> Vec<Vec3> {
    (0..n)
        .map(|i| Vec3::new(0.1 * i as f64, 3.0, 3.0))
        .collect()
}

#[test]
fn two_dimensional_and_periodic_dustybox_is_exact() {
    let n = 12;
    let plane = |shift: f64, z: f64| {
        (0..n * n)
            .map(|i| Vec3::new((i % n) as f64 + shift, (i / n) as f64 + shift, z))
            .collect::<Vec<_>>()
    };
    let gas = gas(plane(0.0, 0.0), 1.0, |_| Vec3::zeros());
    let dust = dust(plane(0.5, 0.2), 2.0, |_| Vec3::x());
    let domain = Domain::periodic(Vec3::repeat(n as f64)).with_axes([true, true, false]);
    let reach = Reach {
        neighbours: 18.0,
        largest: 4.0,
    };
    let law = StoppingLaw::ConstantStoppingTime(0.7);
    let mut scene = Box::new(gas, dust, domain, Settings::new(law, reach));
    for _ in 0..4 {
        scene.step(0.1);
    }
    let exact = 2.0 / 3.0 + (-3.0f64 * 0.4 / 0.7).exp() / 3.0;
    let error = off(&scene.dust.particles.v, exact);
    assert!(error < 1e-14, "{error:e}");
}

#[test]
fn without_reaction_the_gas_keeps_its_velocity_and_the_loss_is_booked() {
    let mut settings = constant(0.5);
    settings.feedback = false;
    let mut scene = dustybox(3.0, 1.0, settings);
    let before = scene.total();
    let booking = scene.step(0.2);
    assert_eq!(off(&scene.gas.particles.v, 0.0), 0.0);
    assert!(off(&scene.dust.particles.v, (-0.4f64).exp()) < 1e-14);
    let after = scene.total();
    let lost = before.p - after.p - booking.gas.momentum;
    assert!(lost.norm() < 1e-14 * before.p.norm());
    let energy = before.kinetic - after.kinetic - booking.gas.kinetic - booking.radiated;
    assert!(energy.abs() < 1e-14 * before.kinetic, "{energy:e}");
}

#[test]
fn a_body_slows_quadratically() {
    let mut gas = gas(lattice(8, 0.0), 1.0, |_| Vec3::zeros());
    let mut bodies = Bodies::default();
    bodies.resize(1);
    bodies.x[0] = Vec3::repeat(3.3);
    bodies.v[0] = Vec3::new(0.0, 2.0, 0.0);
    bodies.m[0] = 1e-12;
    bodies.radius[0] = 0.1;
    let mut h = [0.0];
    let mut immersed = BodiesInGas {
        bodies: &mut bodies,
        h: &mut h,
        star: Star::default(),
    };
    let mut exchange = Exchange::new(settings(StoppingLaw::Quadratic(0.4)));
    let domain = Domain::periodic(Vec3::repeat(8.0));
    for _ in 0..10 {
        exchange.prepare(&gas, &mut immersed, &[0], &domain);
        for half in [Half::Closing, Half::Opening] {
            exchange.exchange(
                &mut gas,
                &mut immersed,
                &[0.05],
                (half, &Clock::standing(0.0)),
            );
        }
    }
    let error = (bodies.v[0].y - 2.0 / (1.0 + 0.4 * 2.0)).abs();
    // The gas gains 1e-12 of the body's speed.
    assert!(error < 1e-12, "{error:e}");
}

#[test]
fn the_same_bits_come_out_for_any_number_of_threads() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("a thread pool").install(|| {
            let gas = gas(scattered(3000, 14.0, 0.0), 1.0, |x| {
                Vec3::new(x.y, -x.x, x.z)
            });
            let dust = dust(scattered(2000, 14.5, 0.2), 0.5, |x| {
                Vec3::new(x.z, 1.0, x.y)
            });
            let mut scene = Box::new(gas, dust, Domain::open(), constant(0.1));
            for _ in 0..3 {
                scene.step(0.1);
            }
            let bits = |v: &[Vec3]| -> Vec<[u64; 3]> {
                v.iter()
                    .map(|v| [v.x, v.y, v.z].map(f64::to_bits))
                    .collect()
            };
            (bits(&scene.gas.particles.v), bits(&scene.dust.particles.v))
        })
    };
    let one = run(1);
    assert!(run(2) == one && run(7) == one);
}

#[test]
fn grains_that_know_nothing_find_what_they_would_find_alone() {
    // Some are in the gas, some at its edges, some far out.
    let gas = gas(lattice(12, 0.5), 1.0, |_| Vec3::zeros());
    let smoothing = |x: Vec<Vec3>| {
        let mut dust = dust(x, 1e-3, |_| Vec3::zeros());
        let active: Vec<u32> = (0..dust.len() as u32).collect();
        let mut grains = Grains {
            dust: &mut dust,
            star: Star::default(),
        };
        let mut exchange = Exchange::new(constant(1.0));
        exchange.prepare(&gas, &mut grains, &active, &Domain::open());
        dust.particles.h
    };
    let mut sorted = scattered(30_000, 20.0, 0.3);
    let cube = nbody::points::sort::Cube::around(&sorted);
    sorted.sort_by_cached_key(|&x| cube.key(x));
    let together = smoothing(sorted.clone());
    for (&x, h) in sorted.iter().zip(together).step_by(7) {
        let alone = smoothing(vec![x])[0];
        // The number of neighbours is wanted to 1e-3, and grows at least as h^3 as long as it is not reached.
        assert!((h / alone - 1.0).abs() < 2e-3 / 3.0, "{x}: {h} for {alone}");
    }
}
