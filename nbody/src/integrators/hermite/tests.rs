//! The Hermite integrator on orbits with known ends.

use super::*;
use crate::integrators::gauss_radau::GaussRadau;
use crate::integrators::problems::*;
use crate::kepler;

fn masses(m: &[f64]) -> Masses {
    Masses::new(1.0, 0.0, m)
}

fn hermite(eta: f64) -> Hermite {
    Hermite {
        eta,
        ..Hermite::default()
    }
}

fn planar(all: &[[f64; 2]]) -> Vec<Vec3> {
    all.iter().map(|&[x, y]| Vec3::new(x, y, 0.0)).collect()
}

fn farthest(a: &[Vec3], b: &[Vec3]) -> f64 {
    assert_eq!(a.len(), b.len());
    let apart = a.iter().zip(b).map(|(a, b)| (a - b).norm());
    apart.fold(0.0, |most, d| if d > most || d.is_nan() { d } else { most })
}

/// Misses in place and relative energy, seen from no star, of a binary of eccentricity 0.6 after 10.3 radians of its mean motion.
fn binary(eta: f64) -> [f64; 2] {
    let m = [0.75, 0.25];
    let (d, w) = (Vec3::x() * 0.4, Vec3::y() * 2.0);
    let mut x = vec![-d * m[1], d * m[0]];
    let mut v = vec![-w * m[1], w * m[0]];
    let start = energy_of(1.0, &m, &x, &v);
    hermite(eta)
        .advance(&masses(&m), (&mut x, &mut v), 10.3)
        .expect("a way");
    let (mut d, mut w) = (d, w);
    kepler::drift(1.0, 10.3, &mut d, &mut w).expect("an orbit");
    [
        (x[1] - x[0] - d).norm(),
        (energy_of(1.0, &m, &x, &v) / start - 1.0).abs(),
    ]
}

#[test]
fn an_eccentric_binary_converges_with_the_fourth_power_of_the_step() {
    let all = [4e-2, 1e-2, 2.5e-3, 6.25e-4].map(binary);
    for pair in all[1..].windows(2) {
        let order = (pair[0][0] / pair[1][0]).log2();
        assert!((order - 4.0).abs() < 0.25, "{all:?}");
    }
    // Nearly symmetric in time, it keeps the energy better than the place.
    let [place, energy] = all[3];
    assert!(place < 1.4e-8 && energy < 1.6e-10, "{all:?}");
}

/// Misses in place of planets of `scale` times their masses after 3000 days, from where Gauss-Radau takes them.
fn giants(scale: f64, eta: f64) -> f64 {
    let (mut star, mut planets) = outer_solar_system();
    planets.m.iter_mut().for_each(|m| *m *= scale);
    let (m, ..) = together(&star, &planets);
    let mut radau = GaussRadau::of(0.0, &star, &planets);
    radau
        .advance_to(3000.0, |x, a| direct(GAUSS, &m, x, a))
        .expect("a way");
    Masses::new(GAUSS, 0.0, &[])
        .drift(&mut hermite(eta), &mut star, &mut planets, 3000.0)
        .expect("a way");
    farthest(&together(&star, &planets).1, radau.x())
}

#[test]
fn the_stars_pull_converges_with_the_sixth_power_of_the_step() {
    // The step about a star goes with the cube root of eta.
    let orbit = |eta| {
        let (mut x, mut v) = (vec![Vec3::x() * 0.4], vec![Vec3::y() * 2.0]);
        let (mut d, mut w) = (x[0], v[0]);
        hermite(eta)
            .advance(&Masses::new(1.0, 0.75, &[0.25]), (&mut x, &mut v), 10.3)
            .expect("a way");
        kepler::drift(1.0, 10.3, &mut d, &mut w).expect("an orbit");
        (x[0] - d).norm()
    };
    let alone = [5e-3, 6.25e-4, 7.8125e-5].map(orbit);
    let light = [5e-3, 6.25e-4].map(|eta| giants(1e-6, eta));
    let heavy = [1e-2, 2.5e-3, 6.25e-4].map(|eta| giants(1.0, eta));
    let order = |pair: &[f64]| (pair[0] / pair[1]).log2();
    assert!(
        alone
            .windows(2)
            .all(|pair| (order(pair) - 6.0).abs() < 0.06),
        "{alone:?}"
    );
    assert!((order(&light) - 6.0).abs() < 0.3, "{light:?}");
    // What planets do to each other is left to the fourth.
    assert!(
        heavy.windows(2).all(|pair| (order(pair) - 4.0).abs() < 0.3),
        "{heavy:?}"
    );
    assert!(alone[2] < 1.6e-12, "{alone:?}");
}

/// Ends of three bodies at `time`, by references in quadruple precision (Szebehely & Peters 1967; Chenciner & Montgomery 2000).
fn three(m: [f64; 3], x: [[f64; 2]; 3], v: [[f64; 2]; 3], eta: f64, time: f64) -> Vec<Vec3> {
    let (mut x, mut v) = (planar(&x), planar(&v));
    hermite(eta)
        .advance(&masses(&m), (&mut x, &mut v), time)
        .expect("a way");
    x
}

#[test]
fn the_figure_eight_is_where_it_should_be() {
    let x = [
        [0.97000436, -0.24308753],
        [-0.97000436, 0.24308753],
        [0.0, 0.0],
    ];
    let v = [
        [0.466203685, 0.43236573],
        [0.466203685, 0.43236573],
        [-0.93240737, -0.86473146],
    ];
    let expected = planar(&[
        [0.984337134122274, 0.22908012805979],
        [-0.0299118477376859, 0.0277015751814856],
        [-0.954425286384588, -0.256781703241276],
    ]);
    let miss = |eta| farthest(&three([1.0; 3], x, v, eta, 20.0), &expected);
    let (coarse, fine) = (miss(1.6e-3), miss(1e-4));
    assert!(coarse < 2.2e-7 && fine < 6e-10, "{coarse:e} {fine:e}");
}

#[test]
fn the_pythagorean_problem_from_rest_is_where_it_should_be() {
    let x = [[1.0, 3.0], [-2.0, -1.0], [1.0, -1.0]];
    let expected = planar(&[
        [0.778480410138085, 0.141392300290086],
        [-2.0250924779782, 0.0972193841460584],
        [1.15298573629971, -0.162610887490898],
    ]);
    let miss = |eta| {
        farthest(
            &three([3.0, 4.0, 5.0], x, [[0.0; 2]; 3], eta, 10.0),
            &expected,
        )
    };
    let (coarse, fine) = (miss(1.6e-3), miss(1e-4));
    assert!(coarse < 1e-6 && fine < 2.2e-9, "{coarse:e} {fine:e}");
}

/// How often pulls were asked for.
struct Counted<'a>(&'a Masses, std::sync::atomic::AtomicU64);

impl Field for Counted<'_> {
    type Common = [Vec3; 2];

    fn common(&self, x: &[Vec3], v: &[Vec3]) -> [Vec3; 2] {
        self.0.common(x, v)
    }

    fn pull(&self, i: usize, x: &[Vec3], v: &[Vec3], common: &[Vec3; 2]) -> [Vec3; 2] {
        self.1.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        self.0.pull(i, x, v, common)
    }
}

#[test]
fn blocks_do_as_well_as_short_steps_for_all_and_ask_for_less() {
    // A binary of period 0.02 about a star, and 20 bodies far out: alone and beside each other.
    let m: Vec<f64> = [1.0, 1e-3, 1e-3]
        .into_iter()
        .chain((0..20).map(|k| 1e-9 * f64::from(k)))
        .collect();
    let mut x = vec![Vec3::zeros(), Vec3::x(), Vec3::x() * 1.004];
    let mut v = vec![
        Vec3::zeros(),
        Vec3::y(),
        Vec3::y() * (1.0 + (2e-3f64 / 0.004).sqrt()),
    ];
    for k in 0..20 {
        let r = 5.0 + f64::from(k);
        x.push(Vec3::new(0.0, r, 0.0));
        v.push(Vec3::new(-(1.0 / r).sqrt(), 0.0, 0.0));
    }
    let field = masses(&m);
    let counted = Counted(&field, Default::default());
    let (mut x_end, mut v_end) = (x.clone(), v.clone());
    hermite(1e-3)
        .advance(&counted, (&mut x_end, &mut v_end), 0.5)
        .expect("a way");
    let mut radau = GaussRadau::new(0.0, &x, &v);
    radau
        .advance_to(0.5, |x, a| direct(1.0, &m, x, a))
        .expect("a way");
    let far = farthest(&x_end[3..], &radau.x()[3..]);
    let near = farthest(&x_end[..3], &radau.x()[..3]);
    let asked = counted.1.into_inner();
    assert!(far < 1.2e-10 && near < 1e-10, "{far:e} {near:e}");
    // Of 23 bodies, 2 are quick.
    assert!(asked < 70_000, "{asked}");
}

#[test]
fn star_and_planets_go_where_gauss_radau_takes_them() {
    let (mut star, mut planets) = outer_solar_system();
    planets.softening = vec![0.0, 0.1, 0.2, 0.3];
    let (m, ..) = together(&star, &planets);
    let softening: Vec<f64> = [0.0].into_iter().chain(planets.softening.clone()).collect();
    let mut radau = GaussRadau::of(0.0, &star, &planets);
    let softened = |x: &[Vec3], a: &mut [Vec3]| {
        a.fill(Vec3::zeros());
        for (i, j) in (0..5)
            .flat_map(|i| (0..5).map(move |j| (i, j)))
            .filter(|(i, j)| i != j)
        {
            let d = x[j] - x[i];
            let q2 = d.norm_squared() + softening[i].powi(2) + softening[j].powi(2);
            a[i] += d * (GAUSS * m[j] / q2.powf(1.5));
        }
    };
    radau.advance_to(10_000.0, softened).expect("a way");
    let mut field = Masses::new(GAUSS, 0.0, &[]);
    let mut hermite = hermite(1e-3);
    for _ in 0..10 {
        field
            .drift(&mut hermite, &mut star, &mut planets, 1000.0)
            .expect("a way");
    }
    let (_, x, _) = together(&star, &planets);
    let miss = farthest(&x, radau.x());
    assert!(miss < 1.2e-7, "{miss:e}");
}

#[test]
fn a_field_that_is_no_number_stalls() {
    let mut x = vec![Vec3::zeros(), Vec3::repeat(f64::NAN)];
    let mut v = x.clone();
    let done = Hermite::default().advance(&masses(&[1.0, 1.0]), (&mut x, &mut v), 1.0);
    assert!(done.is_err());
}

/// Height, over what the impulse 2 G m/(b w) makes of it, of a massless body on a circular orbit a fifth of a radian after one of mass `m` has
/// passed above it at the distance b with the velocity w.
fn deflection(m: f64) -> f64 {
    let (b, w, time) = (1e-4, 0.5, 0.2);
    let mut x = vec![Vec3::x(), Vec3::x() + Vec3::z() * b];
    let mut v = vec![Vec3::y(), Vec3::y() + Vec3::x() * w];
    for (x, v) in x.iter_mut().zip(&mut v) {
        kepler::drift(1.0, -time, x, v).expect("an orbit");
    }
    hermite(0.01)
        .advance(
            &Masses::new(1.0, 1.0, &[0.0, m]),
            (&mut x, &mut v),
            2.0 * time,
        )
        .expect("a way");
    x[0].z / (2.0 * m / (b * w) * time.sin())
}

#[test]
fn a_small_body_does_not_pass_unseen() {
    for m in [1e-9, 1e-12] {
        let part = deflection(m);
        println!("{m:e}: {part}");
        assert!((part - 1.0).abs() < 1.6e-5, "{m:e}: {part}");
    }
}

/// A centre, and others whose pull is rounding alone.
struct Faded(f64);

impl Field for Faded {
    type Common = ();

    fn common(&self, _: &[Vec3], _: &[Vec3]) {}

    fn centre(&self, _: usize) -> [f64; 2] {
        [1.0, 0.0]
    }

    fn pull(&self, i: usize, x: &[Vec3], v: &[Vec3], (): &()) -> [Vec3; 2] {
        [x[i], v[i]].map(|vector| vector.map(|part| self.0 * (1e9 * part).sin()))
    }
}

#[test]
fn what_fades_away_costs_no_steps() {
    let steps = |size: f64| {
        let (field, mut hermite) = (Faded(size), hermite(0.01));
        hermite
            .begin(&field, std::iter::once((Vec3::x(), Vec3::y())), 6.0)
            .expect("a way");
        let mut count = 0;
        while hermite.now < SPAN {
            hermite.step(&field).expect("a step");
            count += 1;
        }
        count
    };
    let alone = steps(0.0);
    println!("{alone} steps");
    assert!(alone > 30 && steps(1e-14) <= alone + 2);
}
