//! The cost of an update: a jittered lattice in a periodic cube with a solenoidal velocity field.
//!
//! box [particles a side] [kernel: wendland | cubic | quintic | c4 | c6] [neighbours] [steps] [precision] [formulation] [viscosity]
//!     [alpha of conduction] [gradient] [reconstruction], as `scheme::set` reads them

use std::f64::consts::TAU;

use gas::{Eos, Gas, Hydro, Particles};
use nbody::points::clock::{Centre, Pacing};
use nbody::points::random::{Purpose, stream};
use nbody::points::{Clock, Columns, Domain, Vec3};
use rand::RngExt;

mod scheme;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let number = |place: usize, default: f64| match words.get(place) {
        Some(word) => word.parse().expect("a number"),
        None => default,
    };
    let domain = Domain::periodic(Vec3::repeat(1.0));
    let mut hydro = Hydro::new(domain, Eos::Ideal { gamma: 5.0 / 3.0 });
    hydro.kernel = scheme::kernel(words.get(1));
    hydro.neighbours = number(2, hydro.neighbours);
    scheme::set(&mut hydro, words.get(4..).unwrap_or_default(), 0.7, 2.0);
    let mut gas = jittered(number(0, 48.0) as usize);
    let mut cost = [
        ("density", 0.0),
        ("steps", 0.0),
        ("forces", 0.0),
        ("kicks", 0.0),
        ("tree", 0.0),
    ];
    let mut timed = |phase: usize, work: &mut dyn FnMut()| {
        let start = cpu_seconds();
        work();
        cost[phase].1 += cpu_seconds() - start;
    };
    let mut clock = Clock::standing(0.0);
    gas.density(&hydro, &clock, Vec3::zeros())
        .expect("a density");
    gas.forces(&hydro, &clock, &clock);
    let (steps, mut updates) = (number(3, 10.0) as usize, 0);
    let base = 0.1;
    for _ in 0..steps {
        let next = if clock.synchronous() {
            clock.next_base(clock.end + base, base)
        } else {
            clock
        };
        timed(0, &mut || {
            updates += gas
                .density(&hydro, &clock, Vec3::zeros())
                .expect("a density")
        });
        timed(1, &mut || {
            gas.steps(&hydro, &clock, &next, &Pacing::free(base))
                .expect("a step");
        });
        timed(2, &mut || {
            gas.forces(&hydro, &clock, &next);
        });
        timed(3, &mut || {
            gas.close(&hydro, &clock, &Centre::default());
            gas.open(&hydro, &clock, &next, &Centre::default());
        });
        let tick = gas.next_tick();
        clock = Clock { tick, ..next };
        timed(4, &mut || {
            gas.refit(&domain, &clock);
        });
    }
    println!(
        "N {} {:?} {:?} {} neighbours, {:?} {:?} {:?}, {updates} updates in {steps} steps",
        gas.len(),
        hydro.precision,
        hydro.kernel,
        hydro.neighbours,
        hydro.formulation,
        hydro.viscosity,
        hydro.conduction,
    );
    let each = |cpu: f64| cpu / updates as f64 * 1e6;
    for (phase, cpu) in cost {
        println!("{phase:8} {:.3} us an update", each(cpu));
    }
    println!(
        "whole    {:.3} us an update",
        each(cost.iter().map(|c| c.1).sum())
    );
}

fn jittered(n: usize) -> Gas {
    let mut particles = Particles::default();
    let d = 1.0 / n as f64;
    for i in 0..n * n * n {
        let mut random = stream(1, Purpose::GasPositions, i as u64, 0);
        let place = [i % n, i / n % n, i / n / n];
        let x = place.map(|k| (k as f64 + 0.5 + 0.2 * (2.0 * random.random::<f64>() - 1.0)) * d);
        let (a, b) = ((TAU * x[0]).sin_cos(), (TAU * x[1]).sin_cos());
        particles.x.push(Vec3::from(x));
        particles
            .v
            .push(0.3 * Vec3::new(a.0 * b.1, -a.1 * b.0, 0.0));
        particles.id.push(i as u64);
    }
    particles.resize(n * n * n);
    particles.m.fill(d.powi(3));
    particles.u.fill(1.5);
    Gas::new(particles)
}

/// CPU time of all threads so far.
fn cpu_seconds() -> f64 {
    let threads = std::fs::read_dir("/proc/self/task").expect("a Linux system");
    let times = threads.map(|thread| {
        let path = thread.expect("a thread").path().join("schedstat");
        let line = std::fs::read_to_string(path).expect("a thread's times");
        let word = line
            .split_whitespace()
            .next()
            .expect("the time on a processor");
        word.parse::<f64>().expect("a number") * 1e-9
    });
    times.sum()
}
