//! Sod's shock tube in three dimensions (gamma = 5/3): error norms against the exact solution, and the cost of an update.
//!
//! sod [n] [kernel: wendland | cubic | quintic | c4 | c6] [neighbours] [alpha] [beta] [courant] [precision] [formulation] [viscosity]
//!     [alpha of conduction] [gradient] [reconstruction], as `scheme::set` reads them
//! Box 2 x 16/n x 16/n; equal-mass body-centred lattices with cell 1/n at rho 1 and 2/n at rho 1/8; P = 1 and 0.1; t = 0.2.
//! Norm: volume-weighted mean of |f - exact| over |x - 1| < 0.5.

use gas::{Eos, Gas, Hydro, Particles, alone};
use nbody::points::{Columns, Domain, Vec3};

mod scheme;

const GAMMA: f64 = 5.0 / 3.0;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let number = |place: usize, default: f64| match words.get(place) {
        Some(word) => word.parse().expect("a number"),
        None => default,
    };
    let n = number(0, 100.0) as usize;
    let mut gas = tube(n);
    let side = 16.0 / n as f64;
    let domain = Domain::periodic(Vec3::new(2.0, side, side));
    let mut hydro = Hydro::new(domain, Eos::Ideal { gamma: GAMMA });
    hydro.kernel = scheme::kernel(words.get(1));
    hydro.neighbours = number(2, hydro.neighbours);
    scheme::set(
        &mut hydro,
        words.get(6..).unwrap_or_default(),
        number(3, 0.7),
        number(4, 2.0),
    );
    hydro.courant = number(5, hydro.courant);
    let before = gas.totals();
    let start = cpu_seconds();
    let account = alone::advance(&mut gas, &hydro, 0.0, 0.2, 0.2).expect("a run");
    let cpu = cpu_seconds() - start;
    let after = gas.totals();
    let energy = (after.kinetic + after.internal) / (before.kinetic + before.internal) - 1.0;
    let [rho, v, p] = norms(&gas, 0.2);
    println!(
        "N {} {:?} {:?} {} {:?} {:?} {:?} courant {}",
        gas.len(),
        hydro.precision,
        hydro.kernel,
        hydro.neighbours,
        hydro.formulation,
        hydro.viscosity,
        hydro.conduction,
        hydro.courant
    );
    println!(
        "L1 rho {rho:.5}  v_x {v:.5}  P {p:.5}  energy error {energy:.2e}  floors {}",
        account.heat.floors
    );
    println!(
        "{} ticks, {} updates, {} targets, {:.3} us an update",
        account.ticks,
        account.updates,
        account.targets,
        cpu / account.updates as f64 * 1e6
    );
}

fn tube(n: usize) -> Gas {
    let a = 1.0 / n as f64;
    let mut particles = Particles::default();
    for (cell, cells, start, rho, p) in [
        (a, [n, 16, 16], 0.0, 1.0, 1.0),
        (2.0 * a, [n / 2, 8, 8], 1.0, 0.125, 0.1),
    ] {
        for i in 0..2 * cells[0] * cells[1] * cells[2] {
            let (half, i) = (i % 2, i / 2);
            let place = [
                i % cells[0],
                i / cells[0] % cells[1],
                i / cells[0] / cells[1],
            ];
            let x = place.map(|k| cell * (k as f64 + 0.25 + 0.5 * half as f64));
            particles.x.push(Vec3::new(start + x[0], x[1], x[2]));
            particles.u.push(p / ((GAMMA - 1.0) * rho));
        }
    }
    particles.id = (0..particles.x.len() as u64).collect();
    particles.resize(particles.len());
    particles.m.fill(0.5 * a.powi(3));
    Gas::new(particles)
}

fn norms(gas: &Gas, t: f64) -> [f64; 3] {
    let exact = Riemann::new();
    let (mut sum, mut volume) = ([0.0; 3], 0.0);
    for i in 0..gas.len() {
        let x = gas.particles.x[i].x - 1.0;
        if x.abs() < 0.5 {
            let weight = gas.particles.m[i] / gas.derived.rho[i];
            let found = [gas.derived.rho[i], gas.particles.v[i].x, gas.derived.p[i]];
            for (sum, (a, b)) in sum
                .iter_mut()
                .zip(found.into_iter().zip(exact.state(x / t)))
            {
                *sum += weight * (a - b).abs();
            }
            volume += weight;
        }
    }
    sum.map(|sum| sum / volume)
}

/// The exact solution: rarefaction to the left, contact, shock to the right.
struct Riemann {
    p: f64,
    u: f64,
}

const LEFT: [f64; 2] = [1.0, 1.0];
const RIGHT: [f64; 2] = [0.125, 0.1];

impl Riemann {
    fn new() -> Self {
        let fan = |p: f64| {
            2.0 * sound(LEFT) / (GAMMA - 1.0)
                * ((p / LEFT[1]).powf(0.5 * (GAMMA - 1.0) / GAMMA) - 1.0)
        };
        let shock = |p: f64| {
            let [rho, ahead] = RIGHT;
            (p - ahead)
                * (2.0 / (GAMMA + 1.0) / rho / (p + (GAMMA - 1.0) / (GAMMA + 1.0) * ahead)).sqrt()
        };
        let (mut low, mut high) = (RIGHT[1], LEFT[1]);
        for _ in 0..100 {
            let p = 0.5 * (low + high);
            if fan(p) + shock(p) > 0.0 {
                high = p;
            } else {
                low = p;
            }
        }
        Self {
            p: low,
            u: shock(low),
        }
    }

    /// rho, v, P at x / t.
    fn state(&self, xi: f64) -> [f64; 3] {
        let Self { p, u } = *self;
        let cl = sound(LEFT);
        let star = LEFT[0] * p.powf(1.0 / GAMMA);
        let k = (GAMMA - 1.0) / (GAMMA + 1.0);
        let jump = p / RIGHT[1];
        let speed = sound(RIGHT)
            * ((GAMMA + 1.0) / (2.0 * GAMMA) * jump + 0.5 * (GAMMA - 1.0) / GAMMA).sqrt();
        if xi < -cl {
            [LEFT[0], 0.0, LEFT[1]]
        } else if xi < u - sound([star, p]) {
            let c = 2.0 / (GAMMA + 1.0) - k * xi / cl;
            [
                c.powf(2.0 / (GAMMA - 1.0)),
                2.0 / (GAMMA + 1.0) * (cl + xi),
                c.powf(2.0 * GAMMA / (GAMMA - 1.0)),
            ]
        } else if xi < u {
            [star, u, p]
        } else if xi < speed {
            [RIGHT[0] * (jump + k) / (k * jump + 1.0), u, p]
        } else {
            [RIGHT[0], 0.0, RIGHT[1]]
        }
    }
}

fn sound([rho, p]: [f64; 2]) -> f64 {
    (GAMMA * p / rho).sqrt()
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
