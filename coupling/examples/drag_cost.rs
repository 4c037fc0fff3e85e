//! What drag between dust and gas costs: CPU time of the parts of a tick, an active grain.
//!
//! `RAYON_NUM_THREADS=1 cargo run --release -p tridisk-coupling --example drag_cost -- 10 4 40 1`: ten grains a gas particle, four ticks, 40^3 gas
//! particles, grains of one kind; of several kinds the radii spread over a factor of a thousand.

use coupling::drag::{Exchange, Grains, Half, Settings, Star};
use cpu_time::ProcessTime;
use dust::{Dust, StoppingLaw, Superparticles};
use gas::probe::Reach;
use gas::{Gas, Particles};
use nbody::points::sort::Cube;
use nbody::points::{Clock, Columns, Domain, Vec3};

const STEP: f64 = 1e-3;

/// Ticks that are not measured: the first finds the smoothing lengths from nothing, and buffers grow.
const WARM: usize = 3;

/// Quasi-random points in the unit box, along the curve.
fn scattered(n: usize) -> Vec<Vec3> {
    let f = |i: usize, k: f64| (i as f64 * k + 0.5).fract();
    let place = |i| Vec3::new(f(i, 0.819_172_5), f(i, 0.671_043_6), f(i, 0.549_700_5));
    let mut x: Vec<Vec3> = (0..n).map(place).collect();
    let cube = Cube::around(&x);
    x.sort_by_cached_key(|&x| cube.key(x));
    x
}

/// A jittered lattice of unit density and pressure that shears.
fn gas(edge: usize) -> Gas {
    let n = edge * edge * edge;
    let spacing = 1.0 / edge as f64;
    let noise = |i: usize, k: f64| 0.3 * ((i as f64 * k).fract() - 0.5);
    let cell = |i: usize| {
        Vec3::new(
            (i % edge) as f64,
            (i / edge % edge) as f64,
            (i / edge / edge) as f64,
        )
    };
    let jitter = |i| {
        Vec3::new(
            noise(i, 0.754_877_7),
            noise(i, 0.569_840_3),
            noise(i, 0.346_014_6),
        )
    };
    let mut x: Vec<Vec3> = (0..n)
        .map(|i| spacing * (cell(i) + jitter(i) + Vec3::repeat(0.5)))
        .collect();
    let cube = Cube::around(&x);
    x.sort_by_cached_key(|&x| cube.key(x));
    let mut particles = Particles {
        v: x.iter().map(|x| Vec3::new(x.y, -x.z, 0.5)).collect(),
        x,
        ..Particles::default()
    };
    particles.id = (0..n as u64).collect();
    particles.resize(n);
    particles.m.fill(1.0 / n as f64);
    particles.u.fill(1.0);
    let mut gas = Gas::new(particles);
    gas.derived.rho.fill(1.0);
    gas.derived.p.fill(1.0);
    gas
}

fn grains(n: usize) -> Dust {
    let x = scattered(n);
    let mut particles = Superparticles {
        v: x.iter().map(|x| Vec3::new(0.1, x.x, x.z)).collect(),
        x,
        ..Superparticles::default()
    };
    particles.id = (0..n as u64).collect();
    particles.resize(n);
    particles.m.fill(0.01 / n as f64);
    particles.grain_radius.fill(1.0);
    particles.grain_density.fill(1.0);
    Dust::new(particles)
}

fn main() {
    let mut arguments = std::env::args()
        .skip(1)
        .map(|word| word.parse().expect("a number"));
    let ratio: f64 = arguments.next().unwrap_or(10.0);
    let ticks = arguments.next().unwrap_or(4.0) as usize;
    let edge = arguments.next().unwrap_or(40.0) as usize;
    let (mut gas, domain) = (gas(edge), Domain::periodic(Vec3::repeat(1.0)));
    let kinds = arguments.next().unwrap_or(1.0);
    let mut dust = grains((ratio * gas.len() as f64) as usize);
    for (i, radius) in dust.particles.grain_radius.iter_mut().enumerate() {
        *radius = 1e3f64.powf((i as f64 % kinds) / kinds);
    }
    let reach = Reach {
        neighbours: 57.0,
        largest: 4.0 / edge as f64,
    };
    let mut settings = Settings::new(StoppingLaw::Epstein, reach);
    settings.several = kinds > 1.0;
    let mut exchange = Exchange::new(settings);
    let active: Vec<u32> = (0..dust.len() as u32).collect();
    let steps = vec![STEP; active.len()];
    let mut spent = [0.0; 3];
    for tick in 0..WARM + ticks {
        for x in &mut dust.particles.x {
            // Smoothing lengths change from tick to tick.
            *x += 0.01 / edge as f64 * Vec3::new(0.6, -0.5, 0.6);
        }
        for x in &mut dust.particles.x {
            domain.wrap(x);
        }
        let start = ProcessTime::now();
        let mut seen = Grains {
            dust: &mut dust,
            star: Star::default(),
        };
        exchange.prepare(&gas, &mut seen, &active, &domain);
        let prepared = start.elapsed();
        let clock = Clock::standing(tick as f64);
        exchange.exchange(&mut gas, &mut seen, &steps, (Half::Closing, &clock));
        let closed = start.elapsed();
        exchange.exchange(&mut gas, &mut seen, &steps, (Half::Opening, &clock));
        let opened = start.elapsed();
        if tick >= WARM {
            let parts = [prepared, closed - prepared, opened - closed];
            parts
                .iter()
                .zip(&mut spent)
                .for_each(|(part, sum)| *sum += part.as_secs_f64());
        }
    }
    let each = 1e6 / (ticks.max(1) * active.len()) as f64;
    println!(
        "{} grains in {} gas particles, CPU us a grain and tick:",
        active.len(),
        gas.len()
    );
    for (name, time) in ["prepare", "close", "open"].iter().zip(spent) {
        println!("{name:8} {:.3}", each * time);
    }
    println!("{:8} {:.3}", "all", each * spent.iter().sum::<f64>());
    let sum: f64 = dust
        .particles
        .v
        .iter()
        .map(|v| v.x + 2.0 * v.y + 3.0 * v.z)
        .sum();
    println!("sum of velocities {sum:.15e}");
}
