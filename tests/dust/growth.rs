//! Growth of grains through the whole program: rates, the barrier that turbulence sets, and the same bits however it is run.

use crate::bench;

/// Random swarms of grains of unit mass, a million in a unit of volume, that stick at a rate of one.
const STICKING: &str = r#"
[run]
end_time = 0.5
snapshots = 0.25
time_step = 0.05
[units]
system = "dimensionless"
[domain]
kind = "periodic"
size = [1, 1, 1]
[dust]
size = 0.6203504908994
material_density = 1.0
[[dust.block]]
lo = [0, 0, 0]
hi = [1, 1, 1]
lattice = "random"
spacing = 0.04
density = 1e6
[dust.growth]
kernel = "constant"
rate = 1e-6
"#;

#[test]
fn grains_become_fewer_at_the_rate_of_the_kernel() {
    let run = bench::run_text(STICKING);
    for path in run.snapshots() {
        let dust = run.particles(&path, 2);
        let number: f64 = dust.more["SwarmNumbers"].iter().sum::<f64>() / 1e6;
        let time = run.time(&path);
        let lost = 1.0 - number;
        let exact = 0.5 * time / (1.0 + 0.5 * time);
        println!("t = {time}: {number}, lost {lost} of {exact}");
        // 15 625 swarms: some 6000 collisions; cells keep their members, and so their density, which spreads by n^-1/2.
        assert!(
            (lost - exact).abs() < 0.04 * exact + 1e-12,
            "{lost} {exact}"
        );
    }
    assert!(run.snapshots().len() == 3 && run.largest("error_mass") < 1e-15);
}

/// Two streams of small grains against each other through gas at rest, which hardly stops them.
const STREAMS: &str = r#"
[run]
end_time = 0.0333333333333
snapshots = 0.0333333333333
time_step = 0.00333333333333
[units]
system = "dimensionless"
[domain]
kind = "periodic"
size = [1, 1, 1]
[[gas.block]]
lo = [0, 0, 0]
hi = [1, 1, 1]
lattice = "cubic"
spacing = 0.125
density = 1.0
[gas.eos]
kind = "isothermal"
sound_speed = 1.0
[dust]
size = 1e-6
material_density = 1.0
[[dust.block]]
lo = [0, 0, 0]
hi = [1, 1, 1]
lattice = "random"
spacing = 0.05
density = 0.5e-6
velocity = [1, 0, 0]
[[dust.block]]
lo = [0, 0, 0]
hi = [1, 1, 1]
lattice = "random"
spacing = 0.05
density = 0.5e-6
velocity = [-1, 0, 0]
[dust.drag]
law = "constant-stopping-time"
stopping_time = 1e3
[dust.growth]
"#;

#[test]
fn streams_collide_as_often_as_their_resolved_speeds_say() {
    let run = bench::run_text(STREAMS);
    let grain = 4.0 / 3.0 * std::f64::consts::PI * 1e-18;
    let start = 1e-6 / grain;
    let last = run.snapshots().pop().expect("a snapshot");
    let number: f64 = run.particles(&last, 2).more["SwarmNumbers"].iter().sum();
    // dN/dt = -n_1 n_2 pi (2 s)^2 2 v, with n_1 = n_2 = n/2: at first n K / 4, K = 8 pi s^2 v.
    let rate = start * 8.0 * std::f64::consts::PI * 1e-12 / 4.0;
    let expected = rate * run.time(&last);
    let lost = 1.0 - number / start;
    println!("lost {lost}, at the first rate {expected}");
    // 1600 events: 2.5 %; the second order is half of what is lost, 2.5 %.
    assert!((lost / expected - 1.0).abs() < 0.08, "{lost} {expected}");
}

#[test]
fn turbulent_growth_ends_where_grains_break() {
    let run = bench::run("dust/growth.toml", &[]);
    let paths = run.snapshots();
    let start = run.particles(&paths[0], 2);
    let of = |path: &std::path::Path| {
        let dust = run.particles(path, 2);
        assert_eq!(dust.m, start.m, "each swarm keeps its mass");
        let mut stokes = dust.more["StokesNumbers"].clone();
        stokes.sort_unstable_by(f64::total_cmp);
        let n = stokes.len();
        (stokes.iter().sum::<f64>() / n as f64, stokes[n - n / 50])
    };
    // Means of the last two years: most mass at 0.37 of the largest.
    let late: Vec<_> = paths[paths.len() - 4..]
        .iter()
        .map(|path| of(path))
        .collect();
    let mean = late.iter().map(|s| s.0).sum::<f64>() / 4.0;
    let largest = late.iter().map(|s| s.1).sum::<f64>() / 4.0;
    let limit = 9e-6 / 3e-3;
    println!("mean {mean:e}, largest {largest:e}, both by {limit:e}");
    assert!((mean / (0.37 * limit) - 1.0).abs() < 0.25, "{mean:e}");
    assert!((largest / limit - 1.0).abs() < 0.25, "{largest:e}");
    assert!(run.largest("error_mass") < 1e-13);
}

const SHORT: [&str; 3] = [
    "run.end_time=\"0.2 yr\"",
    "run.snapshots=\"0.05 yr\"",
    "dust.growth.motion=\"resolved\"",
];

#[test]
fn growth_has_the_same_bits_for_any_number_of_threads_and_after_a_restart() {
    let radii = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("a pool").install(|| {
            let run = bench::run("dust/growth.toml", &SHORT);
            let last = run.snapshots().pop().expect("a snapshot");
            run.particles(&last, 2).more["GrainRadii"].clone()
        })
    };
    let one = radii(1);
    let grown = one.iter().filter(|&&r| r != one[0]).count();
    assert!(grown > 10, "{grown} grains have grown");
    assert!(one == radii(2) && one == radii(7));
    assert!(bench::resumes(
        bench::scene("dust/growth.toml", &SHORT),
        2.0
    ));
}
