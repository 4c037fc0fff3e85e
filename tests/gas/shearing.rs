//! The shearing box against theory: epicycles, a lattice in pure shear, images across the faces, a shearing wave, drift of dust and gas.
//!
//! Sources: linear shearing waves, Johnson & Gammie (2005), ApJ 626, 978, eqs 11 to 13; drift, Nakagawa, Sekiya & Hayashi (1986).

use std::f64::consts::TAU;

use gas::{Eos, Gas, Hydro, Viscosity};
use nbody::points::random::{Purpose, stream};
use nbody::points::{Clock, Columns, Domain, Hill, Vec3};
use rand::RngExt;
use tridisk::trial::Trial;

use crate::bench;

/// A square of gas without viscosity that turns at Omega = 1, 0.1 scale heights between its particles.
const SQUARE: &str = r#"
[run]
end_time = 1000.0
snapshots = 0.1
[units]
system = "dimensionless"
[domain]
kind = "shearing-box"
size = [1.0, 1.0, 1.0]
dimensions = 2
rate = 1.0
[[gas.block]]
lo = [0, 0, 0]
hi = [1, 1, 1]
spacing = 0.1
density = 1.0
[gas.eos]
kind = "isothermal"
sound_speed = 1.0
[gas.viscosity]
kind = "none"
"#;

/// The frame of [`SQUARE`].
const FRAME: Hill = Hill {
    rate: 1.0,
    shear: 1.5,
    middle: 0.5,
};

/// A particle: place, velocity relative to the shear, density.
type State = (Vec3, Vec3, f64);

/// Runs a scene through `stops` and calls `visit(time, gas in the order of identities)` at each; momentum must be kept.
fn run(
    overrides: &[&str],
    prepare: impl FnOnce(&mut gas::Particles),
    stops: &[f64],
    mut visit: impl FnMut(f64, &[State]),
) {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    let mut trial = Trial::new(SQUARE, &overrides, prepare).expect("a scene");
    let done = trial.run(stops, |stop| {
        let gas = &stop.system.gas;
        let p = &gas.particles;
        let mut order: Vec<usize> = (0..p.m.len()).collect();
        order.sort_by_key(|&i| p.id[i]);
        let state = |&i: &usize| (p.x[i], FRAME.relative(p.x[i], p.v[i]), gas.derived.rho[i]);
        let states: Vec<State> = order.iter().map(state).collect();
        let lost = stop.books.error_momentum;
        assert!(lost < 2e-13, "momentum: {lost:e}");
        visit(stop.books.time, &states);
    });
    done.expect("a run");
}

fn mean(states: &[State]) -> Vec3 {
    states.iter().map(|state| state.1).sum::<Vec3>() / states.len() as f64
}

/// Numbers from -1/2 to 1/2.
fn any() -> impl FnMut() -> f64 {
    let mut random = stream(1, Purpose::GasPositions, 0, 0);
    move || random.random::<f64>() - 0.5
}

/// The largest error of the mean velocity of disordered gas at the ends of `orbits`, in units of what it began with.
fn swing(plane: &str, orbits: usize) -> f64 {
    let plane = format!("domain.plane=\"{plane}\"");
    let stops: Vec<f64> = (0..=orbits).map(|k| k as f64 * TAU).collect();
    let overrides = [
        plane.as_str(),
        "gas.block.0.lattice=\"random\"",
        "gas.block.0.velocity=[0.2,0.05,0.0]",
        "gas.viscosity.kind=\"constant\"",
    ];
    let (mut start, mut error) = (None, 0.0f64);
    run(
        &overrides,
        |_| {},
        &stops,
        |_, states| {
            let start = *start.get_or_insert(mean(states));
            error = error.max((mean(states) - start).norm() / start.norm());
        },
    );
    error
}

#[test]
fn gas_swings_in_epicycles_for_a_hundred_orbits() {
    let (plane, upright) = (swing("xy", 100), swing("xz", 5));
    println!("epicycle: {plane:e} in xy, {upright:e} in xz");
    // Disordered gas: twelve runs that began with velocities apart by up to 1.5e-3 had 0.5e-5 to 8.5e-5, rms 4.4e-5; twice that.
    assert!(plane < 8.8e-5 && upright < 2.9e-6, "{plane:e}, {upright:e}");
}

#[test]
fn a_lattice_in_pure_shear_feels_nothing() {
    for precision in ["double", "single"] {
        let precision = format!("gas.hydro.precision=\"{precision}\"");
        let mut most = [0.0f64; 2];
        run(
            &[&precision],
            |_| {},
            &[0.0, 0.1, 0.5, 1.0],
            |_, states| {
                for (_, w, rho) in states {
                    most[0] = most[0].max(w.norm());
                    most[1] = most[1].max((rho / states[0].2 - 1.0).abs());
                }
            },
        );
        println!("{precision}: velocity {:e}, density {:e}", most[0], most[1]);
        let bar = if precision.contains("double") {
            1e-14
        } else {
            2.4e-6
        };
        assert!(most[0] < bar && most[1] < bar, "{most:?}");
    }
}

#[test]
fn where_the_faces_are_makes_no_difference() {
    let states = |shift: Vec3| {
        let mut end = Vec::new();
        let disorder = |gas: &mut gas::Particles| {
            let mut any = any();
            for (x, v) in gas.x.iter_mut().zip(&mut gas.v) {
                *x += Vec3::new(0.05 * any(), 0.05 * any(), 0.0);
                let w = Vec3::new(0.3 * any(), 0.3 * any(), 0.0);
                *x += shift;
                *v = w + Vec3::y() * FRAME.stream(*x);
            }
        };
        let overrides = ["gas.viscosity.kind=\"constant\""];
        run(&overrides, disorder, &[0.0, 0.5], |_, states| {
            end = states.to_vec();
        });
        end
    };
    let (here, there) = (states(Vec3::zeros()), states(Vec3::new(0.437, 0.211, 0.0)));
    let apart = |(a, b): (&State, &State)| (a.1 - b.1).norm().max((a.2 - b.2).abs());
    let error = here.iter().zip(&there).map(apart).fold(0.0, f64::max);
    println!("moved across the faces: {error:e}");
    assert!(error < 1e-13, "{error:e}");
}

/// Density contrast and relative velocities of a shearing wave that began with w_x alone, in units of that, after `t`.
fn wave(k: impl Fn(f64) -> [f64; 2], c: f64, t: f64) -> [f64; 3] {
    // delta = D sin, w = (X, Y) cos.
    let rate = |t: f64, [d, x, y]: [f64; 3]| {
        let [kx, ky] = k(t);
        [
            kx * x + ky * y,
            2.0 * y - kx * c * c * d,
            -0.5 * x - ky * c * c * d,
        ]
    };
    let steps = 4000;
    let dt = t / f64::from(steps);
    let ahead = |s: [f64; 3], by: f64, r: [f64; 3]| [0, 1, 2].map(|a| s[a] + by * r[a]);
    let mut s = [0.0, 1.0, 0.0];
    for n in 0..steps {
        let t = f64::from(n) * dt;
        let a = rate(t, s);
        let b = rate(t + 0.5 * dt, ahead(s, 0.5 * dt, a));
        let c = rate(t + 0.5 * dt, ahead(s, 0.5 * dt, b));
        let d = rate(t + dt, ahead(s, dt, c));
        s = [0, 1, 2].map(|i| s[i] + dt / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]));
    }
    s
}

/// The largest error of velocities and of c times the density contrast of the wave, in units of its amplitude, with `n` particles along each side.
fn wave_error(n: usize) -> f64 {
    const AMPLITUDE: f64 = 0.002;
    const C: f64 = 0.2;
    let k = |t: f64| [TAU * (1.5 * t - 2.0), TAU];
    let kick = |gas: &mut gas::Particles| {
        for (x, v) in gas.x.iter().zip(&mut gas.v) {
            v.x += AMPLITUDE * (k(0.0)[0] * x.x + k(0.0)[1] * x.y).cos();
        }
    };
    let spacing = format!("gas.block.0.spacing={}", 1.0 / n as f64);
    let overrides = [
        spacing.as_str(),
        "gas.eos.sound_speed=0.2",
        "gas.hydro.neighbours=50",
    ];
    let mut most = 0.0f64;
    run(&overrides, kick, &[0.0, 0.5, 1.0, 1.5], |t, states| {
        let expected = wave(k, C, t);
        // The wave moves with the shear of x = 0, where phases are counted from.
        let phase = |x: &Vec3| k(t)[0] * x.x + k(t)[1] * (x.y - 1.5 * t * FRAME.middle);
        let n = states.len() as f64;
        let sum =
            |of: &dyn Fn(&State) -> f64| 2.0 / (n * AMPLITUDE) * states.iter().map(of).sum::<f64>();
        let rho_0 = states.iter().map(|state| state.2).sum::<f64>() / n;
        let found = [
            sum(&|(x, _, rho)| (rho / rho_0 - 1.0) * phase(x).sin()),
            sum(&|(x, w, _)| w.x * phase(x).cos()),
            sum(&|(x, w, _)| w.y * phase(x).cos()),
        ];
        let apart = Vec3::from_fn(|a, _| found[a] - expected[a]);
        let error = apart.component_mul(&Vec3::new(C, 1.0, 1.0)).norm();
        println!("wave at {t}: {found:?}, expected {expected:?}: {error:.4}");
        most = most.max(error);
    });
    most
}

#[test]
fn a_wave_is_sheared_from_leading_to_trailing() {
    let (coarse, fine) = (wave_error(24), wave_error(48));
    println!("wave: {coarse:.4} and {fine:.4}");
    assert!(fine < 0.06 && coarse / fine > 2.5, "{coarse}, {fine}");
}

#[test]
fn dust_and_gas_drift_as_two_fluids_do() {
    const HEADWIND: f64 = 0.1;
    const STOKES: f64 = 0.1;
    const DUST: &str = r#"
[[dust.block]]
lo = [0, 0, 0]
hi = [1, 1, 1]
spacing = 0.1
density = 0.5
[dust.drag]
law = "constant-stokes-number"
stokes_number = 0.1
"#;
    // w of dust and gas, from the shear on.
    let exact = |t: f64| {
        let rate = |[a, b, c, d]: [f64; 4]| {
            let (x, y) = ((a - c) / STOKES, (b - d) / STOKES);
            [
                2.0 * b - x,
                -0.5 * a - y,
                2.0 * d + 2.0 * HEADWIND + 0.5 * x,
                -0.5 * c + 0.5 * y,
            ]
        };
        let ahead = |s: [f64; 4], by: f64, r: [f64; 4]| [0, 1, 2, 3].map(|i| s[i] + by * r[i]);
        let dt = t / 4000.0;
        (0..4000).fold([0.0; 4], |s, _| {
            let half = rate(ahead(s, 0.5 * dt, rate(s)));
            ahead(s, dt, half)
        })
    };
    let scene = format!("{SQUARE}{DUST}");
    let overrides = [format!("domain.headwind={HEADWIND}")];
    let mut trial = Trial::new(&scene, &overrides, |_| {}).expect("a scene");
    let done = trial.run(&[0.0, 0.3, 1.0, 3.0], |stop| {
        let (gas, dust) = (&stop.system.gas.particles, &stop.system.dust.particles);
        let mean = |x: &[Vec3], v: &[Vec3]| {
            let sum: Vec3 = (x.iter().zip(v)).map(|(&x, &v)| FRAME.relative(x, v)).sum();
            sum / x.len() as f64
        };
        let (d, g) = (mean(&dust.x, &dust.v), mean(&gas.x, &gas.v));
        let expected = exact(stop.books.time);
        let found = [d.x, d.y, g.x, g.y];
        let error = (0..4).map(|i| (found[i] - expected[i]).abs());
        let error = error.fold(0.0, f64::max) / HEADWIND;
        let t = stop.books.time;
        println!("drift at {t}: {found:?}, expected {expected:?}: {error:e}");
        assert!(error < 1e-3, "{error} at {t}");
        assert!(stop.books.error_momentum < 2e-13);
    });
    done.expect("a run");
}

#[test]
fn grains_without_gas_keep_their_epicycles_to_rounding() {
    const DUST: &str = r#"
[run]
end_time = 700.0
[units]
system = "dimensionless"
[domain]
kind = "shearing-box"
size = [1.0, 1.0, 1.0]
rate = 1.0
[[dust.block]]
lo = [0, 0, 0]
hi = [1, 1, 1]
spacing = 0.5
density = 1.0
velocity = [0.2, 0.05, 0.0]
"#;
    let mut trial = Trial::new(DUST, &[], |_| {}).expect("a scene");
    let mut error = 0.0f64;
    let done = trial.run(&[0.0, 10.0 * TAU, 100.0 * TAU, 100.25 * TAU], |stop| {
        let dust = &stop.system.dust.particles;
        let (sin, cos) = stop.books.time.sin_cos();
        let exact = Vec3::new(0.2 * cos + 0.1 * sin, 0.05 * cos - 0.1 * sin, 0.0);
        for (&x, &v) in dust.x.iter().zip(&dust.v) {
            error = error.max((FRAME.relative(x, v) - exact).norm());
        }
    });
    done.expect("a run");
    println!("grains after 100 orbits: {error:e}");
    assert!(error < 2.4e-14, "{error:e}");
}

/// Disordered gas and dust in a stratified box of three dimensions.
pub const STRATIFIED: &str = r#"
[run]
end_time = 0.4
snapshots = 0.1
[units]
system = "dimensionless"
[domain]
kind = "shearing-box"
size = [1.0, 1.0, 2.0]
rate = 1.0
vertical_gravity = true
headwind = 0.05
[[gas.block]]
lo = [0, 0, 0]
hi = [1, 1, 2]
lattice = "random"
spacing = 0.125
density = 1.0
[gas.eos]
kind = "isothermal"
sound_speed = 0.5
[[dust.block]]
lo = [0, 0, 0.5]
hi = [1, 1, 1.5]
lattice = "random"
spacing = 0.2
density = 0.1
[dust.drag]
law = "constant-stopping-time"
stopping_time = 0.05
"#;

#[test]
fn a_shearing_box_has_the_same_bits_for_1_and_2_threads_and_after_a_restart() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().expect("a pool").install(|| {
            let run = bench::run_text(STRATIFIED);
            let lost = run.largest("error_momentum");
            println!("momentum: {lost:e}");
            assert!(lost < 2e-13, "{lost:e}");
            std::fs::read_to_string(run.path("ledger.csv")).expect("a ledger")
        })
    };
    assert!(run(1) == run(2));
    assert!(bench::resumes(bench::parsed(STRATIFIED), 2.0));
}

#[test]
fn gas_placed_by_the_continuity_equation_has_the_same_bits_after_a_restart() {
    let text = STRATIFIED.replace("vertical_gravity = true\nheadwind = 0.05\n", "");
    let text = text.replace("lattice = \"random\"\nspacing = 0.125", "spacing = 0.125");
    let text = text + "[gas.rearrange]\nkind = \"continuity\"\niterations = 5\n";
    let run = bench::run_text(&text);
    let timings = std::fs::read_to_string(run.path("timings.json")).expect("timings");
    assert!(timings.contains("\"mean_iterations\""), "{timings}");
    let lost = [run.largest("error_momentum"), run.largest("error_energy")];
    println!("{lost:?}");
    assert!(lost[0] < 2e-13, "{lost:?}");
    assert!(bench::resumes(bench::parsed(&text), 2.0));
}

#[test]
fn gas_in_the_xz_plane_is_gas_in_the_xy_plane_turned() {
    let end = |plane: &str| {
        let up = if plane == "xy" { 1 } else { 2 };
        let disorder = |gas: &mut gas::Particles| {
            let mut any = any();
            let mut order: Vec<usize> = (0..gas.x.len()).collect();
            order.sort_by_key(|&i| gas.id[i]);
            for i in order {
                let mut vector = |size: f64| {
                    let mut vector = Vec3::zeros();
                    (vector[0], vector[up]) = (size * any(), size * any());
                    vector
                };
                gas.x[i] = Vec3::repeat(0.5) + vector(1.0);
                gas.v[i] = vector(0.5);
            }
        };
        let text = SQUARE.replace("shearing-box", "periodic");
        let text = text.replace("rate = 1.0", &format!("plane = \"{plane}\""));
        let mut trial = Trial::new(&text, &[], disorder).expect("a scene");
        let mut end = Vec::new();
        let done = trial.run(&[0.0, 0.3], |stop| {
            let (p, rho) = (&stop.system.gas.particles, &stop.system.gas.derived.rho);
            end = (0..p.m.len())
                .map(|i| (p.id[i], [p.v[i].x, p.v[i][up], rho[i], p.v[i][3 - up]]))
                .collect();
        });
        done.expect("a run");
        end.sort_by_key(|particle| particle.0);
        end
    };
    type Numbers = (u64, [f64; 4]);
    let apart =
        |(a, b): (&Numbers, &Numbers)| (0..4).map(|k| (a.1[k] - b.1[k]).abs()).fold(0.0, f64::max);
    let error = end("xy")
        .iter()
        .zip(&end("xz"))
        .map(apart)
        .fold(0.0, f64::max);
    println!("turned: {error:e}");
    assert!(error < 1e-13, "{error:e}");
}

#[test]
fn far_from_the_faces_forces_are_those_of_open_space() {
    let gas = |domain: Domain| {
        let mut hydro = Hydro {
            viscosity: Viscosity::Balsara {
                alpha: 1.0,
                beta: 2.0,
            },
            ..Hydro::new(domain, Eos::Ideal { gamma: 1.4 })
        };
        hydro.largest_h = 0.5;
        let (mut any, mut p) = (any(), gas::Particles::default());
        p.resize(400);
        for i in 0..400 {
            p.x[i] = Vec3::new(5.0 + any(), 5.0 + any(), 0.0);
            p.v[i] = Vec3::new(any(), any(), 0.0) + Vec3::y() * -1.5 * (p.x[i].x - 5.0);
            (p.m[i], p.u[i], p.id[i], p.h[i]) = (1.0 / 400.0, 0.2, i as u64, 0.1);
        }
        let mut gas = Gas::new(p);
        let clock = Clock::standing(0.0);
        gas.density(&hydro, &clock, Vec3::zeros()).expect("density");
        gas.forces(&hydro, &clock, &clock);
        gas
    };
    let axes = [true, true, false];
    let open = gas(Domain::open().with_axes(axes));
    let boxed = gas(Domain::shearing(Vec3::repeat(10.0), 1.0, 1.5).with_axes(axes));
    let (mut error, mut size) = (0.0f64, 0.0f64);
    for i in 0..open.len() {
        assert_eq!(open.particles.id[i], boxed.particles.id[i]);
        let (a, b) = (&open.derived, &boxed.derived);
        error = error
            .max((open.rates.hydro[i] - boxed.rates.hydro[i]).norm())
            .max((open.rates.du[i] - boxed.rates.du[i]).abs())
            .max((a.div_v[i] - b.div_v[i]).abs())
            .max((a.curl_v[i] - b.curl_v[i]).abs())
            .max((a.v_sig[i] - b.v_sig[i]).abs());
        size = size.max(open.rates.hydro[i].norm());
    }
    println!("in the middle of the box: {error:e} of {size:e}");
    assert!(error < 1e-12 * size, "{error:e} of {size:e}");
}
