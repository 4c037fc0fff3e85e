//! Error against cost of the Hermite integrator, of fourth and of sixth order for the star's pull, and of Gauss-Radau, as a table.
//!
//! `cargo run --release --example blocks`. An orbit of e = 0.1 and one of 0.9 (100 revolutions), Sun and giants (1000 yr), two
//! bodies of 1e-6 that meet at a tenth of their Hill radius on their orbits, 100 times. Errors: largest of the relative energy
//! at the ends of 100 parts; CPU time in us a part.

use std::cell::Cell;
use std::f64::consts::TAU;
use std::sync::atomic::{AtomicU64, Ordering};

use cpu_time::ThreadTime;
use nbody::integrators::gauss_radau::GaussRadau;
use nbody::integrators::hermite::{Field, Hermite, Masses};
use nbody::points::Vec3;

const PARTS: usize = 100;

/// Masses, the star first, their places and velocities, and the time of a part.
#[derive(Clone)]
struct Problem {
    name: &'static str,
    m: Vec<f64>,
    x: Vec<Vec3>,
    v: Vec<Vec3>,
    part: f64,
}

fn orbit(name: &'static str, e: f64) -> Problem {
    let far = 1.0 + e;
    Problem {
        name,
        m: vec![1.0, 1e-3],
        x: vec![Vec3::zeros(), Vec3::x() * far],
        v: vec![Vec3::zeros(), Vec3::y() * (1.001 * (1.0 - e) / far).sqrt()],
        part: TAU / 1.001f64.sqrt(),
    }
}

fn giants() -> Problem {
    let rows = [
        (1.00000597682, [0.0; 3], [0.0; 3]),
        (
            0.000954786104043,
            [-3.5023653, -3.8169847, -1.5507963],
            [0.00565429, -0.0041249, -0.00190589],
        ),
        (
            0.000285583733151,
            [9.0755314, -3.0458353, -1.6483708],
            [0.00168318, 0.00483525, 0.00192462],
        ),
        (
            4.37273164546e-05,
            [8.310142, -16.2901086, -7.2521278],
            [0.00354178, 0.00137102, 0.00055029],
        ),
        (
            5.17759138449e-05,
            [11.4707666, -25.7294829, -10.8169456],
            [0.0028893, 0.00114527, 0.00039677],
        ),
    ];
    let unit = 0.000_295_912_208_286f64.sqrt();
    Problem {
        name: "Sun and giants, 10 yr a part",
        m: rows.iter().map(|row| row.0).collect(),
        x: rows.iter().map(|row| Vec3::from(row.1)).collect(),
        v: rows.iter().map(|row| Vec3::from(row.2) / unit).collect(),
        part: 10.0 * TAU,
    }
}

/// Two bodies on orbits apart by less than a Hill radius, 0.5 from conjunction and 0.5 past it.
fn meeting() -> Problem {
    let m = 1e-6f64;
    let hill = (2.0 * m / 3.0).cbrt();
    let place = |a: f64, angle: f64| {
        let speed = (1.0 / a).sqrt();
        (
            Vec3::new(a * angle.cos(), a * angle.sin(), 0.0),
            Vec3::new(-angle.sin(), angle.cos(), 0.0) * speed,
        )
    };
    let (inner, outer) = (place(1.0, 0.0), place(1.0 + 3.2 * hill, 0.2));
    Problem {
        name: "meeting, part of 0.3 orbits",
        m: vec![1.0, m, m],
        x: vec![Vec3::zeros(), inner.0, outer.0],
        v: vec![Vec3::zeros(), inner.1, outer.1],
        part: 0.3 * TAU,
    }
}

fn energy(m: &[f64], x: &[Vec3], v: &[Vec3]) -> f64 {
    let of = |i: usize| {
        let potential: f64 = (0..i).map(|j| -m[j] / (x[i] - x[j]).norm()).sum();
        m[i] * (0.5 * v[i].norm_squared() + potential)
    };
    (0..m.len()).map(of).sum()
}

/// The same bodies with the star's pull among the others'.
struct Fourth<'a>(&'a Masses, AtomicU64, bool);

impl Field for Fourth<'_> {
    type Common = [Vec3; 2];

    fn common(&self, x: &[Vec3], v: &[Vec3]) -> [Vec3; 2] {
        self.0.common(x, v)
    }

    fn centre(&self, i: usize) -> [f64; 2] {
        if self.2 { self.0.centre(i) } else { [0.0; 2] }
    }

    fn pull(&self, i: usize, x: &[Vec3], v: &[Vec3], common: &[Vec3; 2]) -> [Vec3; 2] {
        self.1.fetch_add(1, Ordering::Relaxed);
        let mut sum = self.0.pull(i, x, v, common);
        if !self.2 {
            let [mu, _] = self.0.centre(i);
            let inverse = 1.0 / x[i].norm_squared();
            let pull = -mu * inverse * inverse.sqrt();
            sum[0] += x[i] * pull;
            sum[1] += (v[i] - x[i] * (3.0 * inverse * x[i].dot(&v[i]))) * pull;
        }
        sum
    }
}

/// From the star to the centre of mass and back.
fn inertial(m: &[f64], x: &[Vec3]) -> Vec<Vec3> {
    let total: f64 = m.iter().sum();
    let mean = x.iter().zip(&m[1..]).map(|(x, m)| x * *m).sum::<Vec3>() / total;
    std::iter::once(-mean)
        .chain(x.iter().map(|x| x - mean))
        .collect()
}

fn blocks(problem: &Problem, sixth: bool, eta: f64) {
    let Problem { m, x, v, part, .. } = problem;
    let from = |all: &[Vec3]| all[1..].iter().map(|x| x - all[0]).collect::<Vec<_>>();
    let (mut x, mut v) = (from(x), from(v));
    let masses = Masses::new(1.0, m[0], &m[1..]);
    let field = Fourth(&masses, AtomicU64::new(0), sixth);
    let start = energy(m, &inertial(m, &x), &inertial(m, &v));
    let mut hermite = Hermite::default();
    hermite.eta = eta;
    let (mut most, mut spent) = (0f64, 0.0);
    for _ in 0..PARTS {
        let clock = ThreadTime::now();
        hermite
            .advance(&field, (&mut x, &mut v), *part)
            .expect("a way");
        spent += clock.elapsed().as_secs_f64();
        most = most.max((energy(m, &inertial(m, &x), &inertial(m, &v)) / start - 1.0).abs());
    }
    let order = if sixth {
        "Hermite 4 and 6"
    } else {
        "Hermite 4"
    };
    row(
        problem,
        order,
        eta,
        field.1.into_inner() as f64 / x.len() as f64,
        most,
        spent,
    );
}

fn row(problem: &Problem, order: &str, eta: f64, evaluations: f64, most: f64, spent: f64) {
    println!(
        "| {} | {order} | {eta:.1e} | {:.0} | {most:.1e} | {:.1} |",
        problem.name,
        evaluations / PARTS as f64,
        1e6 * spent / PARTS as f64
    );
}

fn radau(problem: &Problem) {
    let Problem { m, x, v, part, .. } = problem;
    let evaluations = Cell::new(0u64);
    let start = energy(m, x, v);
    let (mut most, mut spent) = (0f64, 0.0);
    let mut radau = GaussRadau::new(0.0, x, v);
    let force = |x: &[Vec3], a: &mut [Vec3]| {
        evaluations.set(evaluations.get() + 1);
        for i in 0..x.len() {
            for j in 0..i {
                let d = x[j] - x[i];
                let r2 = d.norm_squared();
                let f = d / (r2 * r2.sqrt());
                a[i] += f * m[j];
                a[j] -= f * m[i];
            }
        }
    };
    for k in 1..=PARTS {
        let clock = ThreadTime::now();
        radau.advance_to(k as f64 * part, force).expect("a way");
        spent += clock.elapsed().as_secs_f64();
        most = most.max((energy(m, radau.x(), radau.v()) / start - 1.0).abs());
    }
    row(
        problem,
        "Gauss-Radau",
        0.0,
        evaluations.get() as f64,
        most,
        spent,
    );
}

fn main() {
    println!("| problem | integrator | eta | evaluations a part | energy error | CPU us a part |");
    println!("| --- | --- | --- | --- | --- | --- |");
    for problem in [
        orbit("e = 0.1", 0.1),
        orbit("e = 0.9", 0.9),
        giants(),
        meeting(),
    ] {
        for eta in [4e-2, 1e-2, 2.5e-3, 6.25e-4, 1.6e-4] {
            blocks(&problem, false, eta);
            blocks(&problem, true, eta);
        }
        radau(&problem);
    }
}
