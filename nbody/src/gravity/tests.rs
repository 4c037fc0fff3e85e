//! Tests of `gravity`.

use super::*;

fn settings(accuracy: Accuracy, method: Method) -> Settings {
    Settings {
        accuracy,
        method,
        constant: 1.3,
    }
}

/// Fractions in [0, 1) without pattern: a permuted congruential generator.
struct Dice(u64);

impl Dice {
    fn throw(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let word = ((self.0 >> 18) ^ self.0) >> 27;
        f64::from((word as u32).rotate_right((self.0 >> 59) as u32)) / 2f64.powi(32)
    }
}

struct Set {
    x: Vec<Vec3>,
    m: Vec<f64>,
    softening: Vec<f64>,
}

/// Thin ring with surface density a^-1.5 between 0.5 and 1.5 and height 0.005 r.
fn annulus(n: usize) -> Set {
    let mut dice = Dice(3);
    let place = |_| {
        let (lo, hi) = (0.5f64.sqrt(), 1.5f64.sqrt());
        let r = (lo + dice.throw() * (hi - lo)).powi(2);
        let angle = std::f64::consts::TAU * dice.throw();
        let height = (0..12).map(|_| dice.throw()).sum::<f64>() - 6.0;
        Vec3::new(r * angle.cos(), r * angle.sin(), 0.005 * r * height)
    };
    Set {
        x: (0..n).map(place).collect(),
        m: vec![3e-5 / n as f64; n],
        softening: vec![0.0; n],
    }
}

fn plummer(n: usize) -> Set {
    let mut dice = Dice(5);
    let place = |_| {
        let r = 1.0 / ((dice.throw() * 0.985).powf(-2.0 / 3.0) - 1.0).sqrt();
        let (z, angle) = (
            2.0 * dice.throw() - 1.0,
            std::f64::consts::TAU * dice.throw(),
        );
        let s = (1.0 - z * z).sqrt();
        r * Vec3::new(s * angle.cos(), s * angle.sin(), z)
    };
    Set {
        x: (0..n).map(place).collect(),
        m: vec![1.0 / n as f64; n],
        softening: vec![0.0; n],
    }
}

/// A heavy softened population with light, less softened and massless members among it.
fn mix(n: usize) -> Set {
    let mut set = plummer(n);
    for i in 0..n {
        (set.m[i], set.softening[i]) = match i % 5 {
            0 => (1e-4 / n as f64, 0.001),
            1 => (0.0, 0.01),
            _ => (1.0 / n as f64, 0.05),
        };
    }
    set
}

/// Softened alike, every third without mass.
fn alike(n: usize) -> Set {
    let mut set = plummer(n);
    set.softening.fill(0.05);
    set.m.iter_mut().step_by(3).for_each(|m| *m = 0.0);
    set
}

/// The obvious sum.
fn plain(set: &Set, i: usize) -> (Vec3, f64) {
    let (mut a, mut phi) = (Vec3::zeros(), 0.0);
    for j in (0..set.x.len()).filter(|&j| j != i) {
        let d = set.x[j] - set.x[i];
        let q = (d.norm_squared() + set.softening[i].powi(2) + set.softening[j].powi(2)).sqrt();
        if q > 0.0 {
            a += 1.3 * set.m[j] / q.powi(3) * d;
            phi -= 1.3 * set.m[j] / q;
        }
    }
    (a, phi)
}

fn field(set: &Set, settings: Settings) -> (Vec<Vec3>, Vec<f64>) {
    let mut gravity = Gravity::new(settings);
    gravity.build(&set.x, &set.m, &set.softening);
    all(&mut gravity, set.x.len())
}

fn all(gravity: &mut Gravity, n: usize) -> (Vec<Vec3>, Vec<f64>) {
    let active: Vec<u32> = (0..n as u32).collect();
    let (mut a, mut phi) = (vec![Vec3::zeros(); n], vec![0.0; n]);
    let count = gravity.field(&active, &mut a, &mut phi);
    assert_eq!(count.targets, n as u64);
    (a, phi)
}

/// rms and 99th percentile.
fn spread(mut errors: Vec<f64>) -> (f64, f64) {
    errors.sort_by(f64::total_cmp);
    let n = errors.len();
    let rms = (errors.iter().map(|e| e * e).sum::<f64>() / n as f64).sqrt();
    (rms, errors[n * 99 / 100])
}

fn force_errors(a: &[Vec3], exact: &[Vec3]) -> (f64, f64) {
    let error = |(a, exact): (&Vec3, &Vec3)| (a - exact).norm() / exact.norm();
    spread(a.iter().zip(exact).map(error).collect())
}

const EXACT: Settings = Settings {
    accuracy: Accuracy::ForceError(1e-3),
    method: Method::Direct,
    constant: 1.3,
};

#[test]
fn direct_sum_is_the_plain_sum() {
    for set in [annulus(700), plummer(701), mix(702), alike(703)] {
        let single = settings(Accuracy::ForceError(1e-5), Method::Automatic);
        for (settings, bar) in [(EXACT, 1e-13), (single, 5e-6)] {
            let (a, phi) = field(&set, settings);
            for i in 0..set.x.len() {
                let (exact, depth) = plain(&set, i);
                assert!((a[i] - exact).norm() / exact.norm() < bar, "force {i}");
                assert!(((phi[i] - depth) / depth).abs() < bar, "potential {i}");
            }
        }
    }
}

#[test]
fn tree_has_the_error_that_was_asked_for() {
    for (name, set) in [
        ("annulus", annulus(20_000)),
        ("Plummer", plummer(20_000)),
        ("mix", mix(20_000)),
    ] {
        let (exact, depth) = field(&set, EXACT);
        for wanted in [1e-5, 2e-4, 3e-3] {
            let (a, phi) = field(&set, settings(Accuracy::ForceError(wanted), Method::Tree));
            let (rms, percentile) = force_errors(&a, &exact);
            let ratios = phi.iter().zip(&depth);
            let (potential, _) = spread(ratios.map(|(p, d)| ((p - d) / d).abs()).collect());
            println!(
                "{name} {wanted}: rms {rms:.2e} 99 % {percentile:.2e} potential {potential:.2e}"
            );
            assert!(rms < wanted, "{name} {wanted}: {rms}");
            assert!(rms > 0.25 * wanted, "{name} {wanted} paid too much: {rms}");
            assert!(percentile < 3.5 * wanted, "{name} {wanted}: {percentile}");
            assert!(potential < wanted, "{name} {wanted}: {potential}");
        }
    }
}

#[test]
fn opening_angle_bounds_the_error() {
    let set = plummer(5000);
    let (exact, _) = field(&set, EXACT);
    let error = |angle| {
        let settings = settings(Accuracy::OpeningAngle(angle), Method::Tree);
        force_errors(&field(&set, settings).0, &exact).0
    };
    let (wide, narrow) = (error(0.6), error(0.3));
    assert!(wide < 2e-3, "{wide}");
    // Third order of force error and what the steeper lists add.
    assert!(narrow < wide / 8.0, "{narrow} {wide}");
}

#[test]
fn total_force_vanishes() {
    for set in [annulus(10_000), plummer(10_000), mix(10_000)] {
        let (a, _) = field(&set, settings(Accuracy::ForceError(1e-3), Method::Tree));
        let pull = |i: usize| a[i] * set.m[i];
        let total: Vec3 = (0..a.len()).map(pull).sum();
        let squares: f64 = (0..a.len()).map(|i| pull(i).norm_squared()).sum();
        // Errors of 1e-3 of each force, alike within a group, else at random.
        let bar = 1e-3 * (GROUP as f64).sqrt() * squares.sqrt();
        assert!(total.norm() < bar, "{} {bar}", total.norm());
    }
}

#[test]
fn potential_slopes_as_the_force() {
    let mut set = plummer(3000);
    let probe = set.x.len();
    set.x.push(Vec3::new(0.7, -0.4, 0.3));
    set.m.push(0.0);
    set.softening.push(0.02);
    let settings = settings(Accuracy::ForceError(1e-7), Method::Tree);
    let (a, _) = field(&set, settings);
    let step = 1e-3;
    for axis in 0..3 {
        let depth = |side: f64| {
            let mut moved = Set {
                x: set.x.clone(),
                m: set.m.clone(),
                softening: set.softening.clone(),
            };
            moved.x[probe][axis] += side * step;
            field(&moved, settings).1[probe]
        };
        let slope = (depth(-1.0) - depth(1.0)) / (2.0 * step);
        assert!(
            (slope - a[probe][axis]).abs() < 3e-4 * a[probe].norm(),
            "{slope} {}",
            a[probe][axis]
        );
    }
}

#[test]
fn few_or_coincident_particles_give_finite_forces() {
    let tree = settings(Accuracy::ForceError(1e-3), Method::Tree);
    let empty = Set {
        x: vec![],
        m: vec![],
        softening: vec![],
    };
    assert!(field(&empty, tree).0.is_empty());
    let lone = Set {
        x: vec![Vec3::repeat(7.0)],
        m: vec![1.0],
        softening: vec![0.1],
    };
    let (a, phi) = field(&lone, tree);
    // What is taken out of the potential as its own is rounded to f32.
    assert!(a == [Vec3::zeros()] && phi[0].abs() < 1e-6 * 1.3 / 0.1);
    for softening in [0.0, 0.5] {
        for n in [2, 200] {
            let set = Set {
                x: vec![Vec3::repeat(0.3); n],
                m: vec![2.0; n],
                softening: vec![softening; n],
            };
            let (a, phi) = field(&set, tree);
            assert!(a.iter().all(|a| *a == Vec3::zeros()));
            let depth = if softening > 0.0 {
                -1.3 * 2.0 * (n - 1) as f64 / (softening * 2f64.sqrt())
            } else {
                0.0
            };
            assert!(
                phi.iter()
                    .all(|phi| (phi - depth).abs() <= 1e-6 * depth.abs())
            );
        }
    }
    let mut massless = plummer(300);
    massless.m.fill(0.0);
    assert!(field(&massless, tree).0.iter().all(|a| *a == Vec3::zeros()));
}

#[test]
fn close_pairs_keep_their_force() {
    for method in [Method::Tree, Method::Automatic] {
        for distance in [1e-3, 1e-6, 1e-10] {
            let mut set = annulus(3000);
            for i in (0..1500).step_by(7) {
                set.x[i + 1] = set.x[i] + Vec3::new(0.6, 0.0, 0.8) * distance;
            }
            let (a, _) = field(&set, settings(Accuracy::ForceError(1e-4), method));
            for i in (0..2).chain(7..9).chain(2800..3000) {
                let exact = plain(&set, i).0;
                let error = (a[i] - exact).norm() / exact.norm();
                assert!(error < 2e-3, "{distance}: {error}");
            }
        }
    }
}

#[test]
fn tiny_masses_and_wide_sets_stay_within_range() {
    let mut set = plummer(5000);
    for (i, x) in set.x.iter_mut().enumerate() {
        *x *= 10f64.powi((i % 9) as i32 - 4);
    }
    set.m.fill(1e-16);
    let (exact, _) = field(&set, EXACT);
    let (a, _) = field(&set, settings(Accuracy::ForceError(1e-3), Method::Tree));
    let (rms, _) = force_errors(&a, &exact);
    assert!(rms < 1e-3, "{rms}");
}

#[test]
fn active_targets_get_what_they_get_among_all() {
    let set = mix(4000);
    let tree = settings(Accuracy::OpeningAngle(0.5), Method::Tree);
    let (exact, _) = field(&set, EXACT);
    let mut gravity = Gravity::new(tree);
    gravity.build(&set.x, &set.m, &set.softening);
    let active: Vec<u32> = (0..4000).rev().step_by(37).collect();
    let mut a = vec![Vec3::zeros(); active.len()];
    let count = gravity.field(&active, &mut a, &mut []);
    assert_eq!(count.targets, active.len() as u64);
    let exact: Vec<Vec3> = active.iter().map(|&i| exact[i as usize]).collect();
    let (rms, _) = force_errors(&a, &exact);
    assert!(rms < 2e-3, "{rms}");
    assert_eq!(gravity.field(&[], &mut [], &mut []), Count::default());
}

#[test]
fn field_has_the_same_bits_for_any_number_of_threads() {
    let set = mix(8000);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a thread pool");
        pool.install(|| field(&set, settings(Accuracy::ForceError(1e-3), Method::Tree)))
    };
    let one = with(1);
    assert!([2, 7].into_iter().all(|threads| with(threads) == one));
}

#[test]
fn refit_is_as_good_as_build() {
    let mut set = annulus(8000);
    let mut gravity = Gravity::new(settings(Accuracy::ForceError(3e-4), Method::Tree));
    gravity.build(&set.x, &set.m, &set.softening);
    let mut dice = Dice(9);
    for x in &mut set.x {
        *x *= 1.0 + 0.2 * (dice.throw() - 0.5);
    }
    gravity.refit(&set.x, &set.m, &set.softening);
    let (a, _) = all(&mut gravity, 8000);
    let (rms, _) = force_errors(&a, &field(&set, EXACT).0);
    assert!(rms < 3e-4, "{rms}");
}

#[test]
fn a_lone_particle_with_resolved_pairs_is_pulled_by_what_there_is() {
    let mut set = plummer(3000);
    for x in [40.0, 110.0] {
        set.x.push(Vec3::new(x, 0.3 * x, 0.1));
        set.m.push(1e-4);
        set.softening.push(0.0);
    }
    let mut gravity = Gravity::new(settings(Accuracy::ForceError(1e-3), Method::Tree));
    gravity.resolve(0.5);
    gravity.build(&set.x, &set.m, &set.softening);
    let (a, phi) = all(&mut gravity, set.x.len());
    for i in [0, 1500, 3000, 3001] {
        let (exact, depth) = plain(&set, i);
        assert!((a[i] - exact).norm() < 3e-3 * exact.norm(), "force {i}");
        assert!((phi[i] / depth - 1.0).abs() < 1e-3, "potential {i}");
    }
}
