//! Speed and energy error of the integrators on the Sun and the four giants: `cargo run --release --example outer_solar_system [years]`.

use std::ops::Range;
use std::time::Instant;

use nbody::Bodies;
use nbody::integrators::gauss_radau::GaussRadau;
use nbody::integrators::wisdom_holman::jacobi::{Corrector, Jacobi, Kernel, Scheme};
use nbody::integrators::{kick, wisdom_holman};
use nbody::kepler;
use nbody::kepler::abreast::drift_all;
use nbody::points::{Columns, Vec3};

const G: f64 = 0.000_295_912_208_286;
const YEAR: f64 = 365.25;

/// Masses, positions (au) and velocities (au a day) of Hairer, Lubich & Wanner (2006), I.2.3.
#[rustfmt::skip]
const SYSTEM: [(f64, [f64; 3], [f64; 3]); 5] = [
    (1.00000597682, [0.0; 3], [0.0; 3]),
    (0.000954786104043, [-3.5023653, -3.8169847, -1.5507963], [0.00565429, -0.0041249, -0.00190589]),
    (0.000285583733151, [9.0755314, -3.0458353, -1.6483708], [0.00168318, 0.00483525, 0.00192462]),
    (4.37273164546e-05, [8.310142, -16.2901086, -7.2521278], [0.00354178, 0.00137102, 0.00055029]),
    (5.17759138449e-05, [11.4707666, -25.7294829, -10.8169456], [0.0028893, 0.00114527, 0.00039677]),
];

/// The bodies of `range`, seen from the centre of mass of all: a system that drifts away loses digits of its separations.
fn bodies(range: Range<usize>) -> Bodies {
    let total: f64 = SYSTEM.iter().map(|b| b.0).sum();
    let x_cm = SYSTEM.iter().map(|b| Vec3::from(b.1) * b.0).sum::<Vec3>() / total;
    let v_cm = SYSTEM.iter().map(|b| Vec3::from(b.2) * b.0).sum::<Vec3>() / total;
    let mut set = Bodies::default();
    set.resize(range.len());
    for (i, &(m, x, v)) in SYSTEM[range].iter().enumerate() {
        (set.m[i], set.x[i], set.v[i]) = (m, Vec3::from(x) - x_cm, Vec3::from(v) - v_cm);
    }
    set
}

fn pulls(m: &[f64], x: &[Vec3], a: &mut [Vec3]) {
    a.fill(Vec3::zeros());
    for i in 0..m.len() {
        for j in i + 1..m.len() {
            let d = x[j] - x[i];
            let r2 = d.norm_squared();
            let f = d * (G / (r2 * r2.sqrt()));
            a[i] += f * m[j];
            a[j] -= f * m[i];
        }
    }
}

fn energy(m: &[f64], x: &[Vec3], v: &[Vec3]) -> f64 {
    let of = |i: usize| {
        let potential: f64 = (0..i).map(|j| -G * m[j] / (x[i] - x[j]).norm()).sum();
        m[i] * (0.5 * v[i].norm_squared() + potential)
    };
    (0..m.len()).map(of).sum()
}

/// Largest energy error in the first and in the last tenth, the mean error of both, and steps a second.
fn map(years: f64, dt: f64) {
    let (mut star, mut set) = (bodies(0..1), bodies(1..5));
    let total = |star: &Bodies, set: &Bodies| {
        let join = |a: &[Vec3], b: &[Vec3]| [a, b].concat();
        energy(
            &[&star.m[..], &set.m[..]].concat(),
            &join(&star.x, &set.x),
            &join(&star.v, &set.v),
        )
    };
    let start = total(&star, &set);
    let steps = (years * YEAR / dt) as usize;
    let clock = Instant::now();
    let mut tenths = [(0f64, 0f64, 0usize); 10];
    pulls(&set.m, &set.x, &mut set.a);
    for step in 0..steps {
        kick(&mut set.v, &set.a, 0.5 * dt);
        wisdom_holman::drift(&mut star, &mut set, G, dt).expect("orbits");
        pulls(&set.m, &set.x, &mut set.a);
        kick(&mut set.v, &set.a, 0.5 * dt);
        if step % 23 == 0 {
            let error = total(&star, &set) / start - 1.0;
            let tenth = &mut tenths[step * 10 / steps];
            *tenth = (tenth.0.max(error.abs()), tenth.1 + error, tenth.2 + 1);
        }
    }
    let rate = steps as f64 / clock.elapsed().as_secs_f64();
    let [first, last] = [tenths[0], tenths[9]].map(|t| (t.0, t.1 / t.2 as f64));
    println!(
        "Wisdom-Holman, dt {dt} d, {years} yr: max |dE/E| {:.2e} first tenth, {:.2e} last; mean {:+.2e}, {:+.2e}; {rate:.2e} steps/s",
        first.0, last.0, first.1, last.1
    );
}

/// The map in Jacobi coordinates: the same figures, looked at a thousand times.
fn jacobi(years: f64, dt: f64, kernel: Kernel, corrector: Corrector) {
    let (mut star, mut set) = (bodies(0..1), bodies(1..5));
    let total = |star: &Bodies, set: &Bodies| {
        let join = |a: &[Vec3], b: &[Vec3]| [a, b].concat();
        energy(
            &[&star.m[..], &set.m[..]].concat(),
            &join(&star.x, &set.x),
            &join(&star.v, &set.v),
        )
    };
    let start = total(&star, &set);
    let mut map = Jacobi::of(Scheme { kernel, corrector }, G, &star, &set);
    let looks = 1000;
    let steps = (years * YEAR / dt) as u64 / looks;
    let mut seconds = 0.0;
    let mut tenths = [(0f64, 0f64); 10];
    for look in 0..looks {
        let clock = Instant::now();
        map.advance(dt, steps).expect("orbits");
        seconds += clock.elapsed().as_secs_f64();
        map.store(&mut star, &mut set).expect("orbits");
        let error = total(&star, &set) / start - 1.0;
        let tenth = &mut tenths[(look * 10 / looks) as usize];
        *tenth = (
            tenth.0.max(error.abs()),
            tenth.1 + error / (looks / 10) as f64,
        );
    }
    let most = tenths.iter().fold(0f64, |most, t| most.max(t.0));
    let rate = (steps * looks) as f64 / seconds;
    let means: Vec<String> = tenths.iter().map(|t| format!("{:+.1e}", t.1)).collect();
    println!(
        "Jacobi, {kernel:?} kernel, corrector {}, dt {dt:.2} d, {years} yr: max |dE/E| {most:.2e}; {rate:.2e} steps/s; means of the tenths {}",
        corrector.order(),
        means.join(" ")
    );
}

/// Nanoseconds a body of the Kepler drift, one by one and abreast.
fn drifts(bodies: usize, rounds: usize) {
    let start = |i: usize| {
        let angle = i as f64 * 0.7;
        let x = Vec3::new(angle.cos(), angle.sin(), 0.1) * (1.0 + 0.01 * (i % 50) as f64);
        let v = Vec3::new(-angle.sin(), angle.cos(), 0.05);
        (x, v * (1.0 + 0.003 * (i % 30) as f64) / x.norm().sqrt())
    };
    let (mut x, mut v): (Vec<_>, Vec<_>) = (0..bodies).map(start).unzip();
    let per_body = |clock: Instant| 1e9 * clock.elapsed().as_secs_f64() / (bodies * rounds) as f64;
    let clock = Instant::now();
    for _ in 0..rounds {
        for (x, v) in x.iter_mut().zip(&mut v) {
            kepler::drift(1.0, 0.0628, x, v).expect("an orbit");
        }
    }
    let single = per_body(clock);
    let clock = Instant::now();
    for _ in 0..rounds {
        drift_all(1.0, 0.0628, &mut x, &mut v).expect("orbits");
    }
    let abreast = per_body(clock);
    println!(
        "Kepler drift of {bodies} bodies: {single:.1} ns a body one by one, {abreast:.1} ns abreast"
    );
}

fn adaptive(years: f64) {
    let all = bodies(0..5);
    let mut radau = GaussRadau::new(0.0, &all.x, &all.v);
    let start = energy(&all.m, &all.x, &all.v);
    let mut evaluations = 0u64;
    let clock = Instant::now();
    for tenth in 1..=10 {
        let end = years * YEAR * f64::from(tenth) / 10.0;
        radau
            .advance_to(end, |x, a| {
                evaluations += 1;
                pulls(&all.m, x, a)
            })
            .expect("a way");
        let error = energy(&all.m, radau.x(), radau.v()) / start - 1.0;
        print!("{error:+.1e} ");
    }
    let seconds = clock.elapsed().as_secs_f64();
    println!(
        "\nGauss-Radau, {years} yr: errors above; {evaluations} forces, {:.2e} forces/s, {seconds} s",
        evaluations as f64 / seconds
    );
}

/// Root mean square and mean energy error of Gauss-Radau over a set of slightly different systems, at each quarter of `years`.
fn walk(years: f64, systems: u32) {
    let mut errors = [const { Vec::new() }; 4];
    for system in 0..systems {
        let mut all = bodies(0..5);
        all.x[1] *= 1.0 + 1e-6 * f64::from(system);
        let mut radau = GaussRadau::new(0.0, &all.x, &all.v);
        let start = energy(&all.m, &all.x, &all.v);
        for (quarter, errors) in (1..=4).zip(&mut errors) {
            radau
                .advance_to(years * YEAR * f64::from(quarter) / 4.0, |x, a| {
                    pulls(&all.m, x, a)
                })
                .expect("a way");
            errors.push(energy(&all.m, radau.x(), radau.v()) / start - 1.0);
        }
    }
    print!("Gauss-Radau, {systems} systems over {years} yr, quarters:");
    for errors in errors {
        let n = f64::from(systems);
        let mean = errors.iter().sum::<f64>() / n;
        let square = errors.iter().map(|e| e * e).sum::<f64>() / n;
        print!("  rms {:.1e} mean {mean:+.1e}", square.sqrt());
    }
    println!();
}

/// Largest errors of semi-major axis and eccentricity (e = 0.999999) outside of the pericentres of `orbits` orbits.
fn needle(orbits: u32) {
    let e = 0.999_999;
    let period = std::f64::consts::TAU;
    let (x0, v0) = (
        Vec3::new(-1.0 - e, 0.0, 0.0),
        Vec3::new(0.0, -((1.0 - e) / (1.0 + e)).sqrt(), 0.0),
    );
    let errors = |x: Vec3, v: Vec3| {
        let a = 1.0 / (2.0 / x.norm() - v.norm_squared());
        let vector = v.cross(&x.cross(&v)) - x / x.norm();
        ((a - 1.0).abs(), (vector.norm() - e).abs())
    };
    let (mut x, mut v) = (x0, v0);
    let mut most = (0f64, 0f64);
    // Steps that pass the pericentre without standing there, where a rounding of the place is 1e-10 of the distance.
    for _ in 0..3 * orbits {
        kepler::drift(1.0, 0.36 * period, &mut x, &mut v).expect("an orbit");
        if x.norm() > 0.1 {
            let (a, e) = errors(x, v);
            most = (most.0.max(a), most.1.max(e));
        }
    }
    println!(
        "e = 0.999999, {orbits} orbits, Kepler drift: a {:.1e}, e {:.1e}",
        most.0, most.1
    );
    let mut radau = GaussRadau::new(0.0, &[x0], &[v0]);
    most = (0.0, 0.0);
    let mut evaluations = 0u64;
    for orbit in 1..=orbits {
        let end = period * f64::from(orbit);
        let pull = |x: &[Vec3], a: &mut [Vec3]| {
            evaluations += 1;
            a[0] -= x[0] / x[0].norm().powi(3);
        };
        radau.advance_to(end, pull).expect("a way");
        let (a, e) = errors(radau.x()[0], radau.v()[0]);
        most = (most.0.max(a), most.1.max(e));
    }
    println!(
        "e = 0.999999, {orbits} orbits, Gauss-Radau: a {:.1e}, e {:.1e}; {evaluations} forces",
        most.0, most.1
    );
}

fn main() {
    let years = std::env::args()
        .nth(1)
        .and_then(|y| y.parse().ok())
        .unwrap_or(1e4);
    drifts(4, 200_000);
    drifts(1000, 1000);
    for (kernel, corrector) in [
        (Kernel::Standard, Corrector::None),
        (Kernel::Standard, Corrector::Seventeenth),
        (Kernel::Lazy, Corrector::Seventeenth),
    ] {
        jacobi(years, 0.1186 * YEAR, kernel, corrector);
    }
    for dt in [0.0593, 0.1779] {
        jacobi(years, dt * YEAR, Kernel::Lazy, Corrector::Seventeenth);
    }
    map(years, 100.0);
    map(years, 0.1186 * YEAR);
    adaptive(years);
    walk(0.25 * years, 8);
    needle(1000);
}
