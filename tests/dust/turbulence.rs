//! Turbulent stirring in whole runs: tracers stay mixed with gas that is a formula and with gas particles, and the same bits come out.

use nbody::points::Vec3;
use tridisk::trial::Trial;

use crate::bench;

/// How far shares of `n` grains are from `expected`, in standard errors: the root mean square over all bands.
fn deviation(found: &[f64], expected: &[f64], n: usize) -> f64 {
    let square = |(f, e): (&f64, &f64)| (f - e).powi(2) * n as f64 / (e * (1.0 - e));
    let sum: f64 = found.iter().zip(expected).map(square).sum();
    (sum / found.len() as f64).sqrt()
}

/// Shares of `values` between `edges`.
fn shares(values: impl Iterator<Item = f64>, edges: &[f64]) -> Vec<f64> {
    let mut counts = vec![0.0; edges.len() - 1];
    let mut all = 0.0;
    for value in values {
        let band = edges.windows(2).position(|e| e[0] <= value && value < e[1]);
        if let Some(band) = band {
            counts[band] += 1.0;
        }
        all += 1.0;
    }
    counts.iter().map(|count| count / all).collect()
}

const FORMULA: &str = r#"
[run]
end_time = 100.0
[units]
system = "dimensionless"
[star]
mass = 1.0
[surroundings.disk]
surface_density = 1e-3
surface_density_slope = -1.0
reference_radius = 1.0
aspect_ratio = 0.1
flaring = 0.25
inner_radius = 0.9
outer_radius = 1.1
[dust]
particles = 2000
mass = 1e-9
[dust.drag]
law = "constant-stokes-number"
stokes_number = 1e-6
[dust.turbulence]
alpha = 0.1
"#;

/// Upper and lower edges of tenths of a Gaussian, by height.
const TENTHS: [f64; 11] = [
    0.0, 0.125661, 0.253347, 0.385320, 0.524401, 0.674490, 0.841621, 1.036433, 1.281552, 1.644854,
    1e9,
];

#[test]
fn tracers_stay_mixed_with_a_disk_that_is_a_formula() {
    let mut trial = Trial::new(FORMULA, &[], |_| {}).expect("a scene");
    let mut found = [Vec::new(), Vec::new()];
    let done = trial.run(&[0.0, 60.0], |stop| {
        let p = &stop.system.dust.particles;
        let r = |x: &Vec3| x.xy().norm();
        let height = |x: &Vec3| x.z.abs() / (0.1 * r(x).powf(1.25));
        let radii: Vec<f64> = (0..=10).map(|k| 0.9 + 0.02 * f64::from(k)).collect();
        found = [
            shares(p.x.iter().map(height), &TENTHS),
            shares(p.x.iter().map(r), &radii),
        ];
    });
    done.expect("a run");
    for (what, shares) in ["height", "radius"].iter().zip(&found) {
        let off = deviation(shares, &[0.1; 10], 2000);
        println!("{what}: {off:.2} standard errors in {shares:.3?}");
        assert!(off < 1.6, "{what}: {off}");
    }
}

/// A column of gas in the plane of x and z that holds itself up against the star's pull; H = 1.
const COLUMN: &str = r#"
[run]
end_time = 100.0
snapshots = 0.5
[units]
system = "dimensionless"
[domain]
kind = "shearing-box"
size = [2.0, 1.0, 12.0]
dimensions = 2
plane = "xz"
rate = 1.0
vertical_gravity = true
[[gas.block]]
lo = [0, 0, 3]
hi = [2, 0, 9]
spacing = 0.1
density = 1.0
[gas.eos]
kind = "isothermal"
sound_speed = 1.0
[gas.viscosity]
kind = "constant"
[[dust.block]]
lo = [0, 0, 4.5]
hi = [2, 0, 7.5]
lattice = "random"
spacing = 0.06324555
density = 1e-9
[dust.drag]
law = "constant-stokes-number"
stokes_number = 1e-3
[dust.turbulence]
alpha = 0.1
[coupling]
feedback = false
"#;

/// z of a Gaussian below which the part `u` lies, by bisection of a sum of its density.
fn gaussian(u: f64) -> f64 {
    let step = 1e-3;
    let mut z = -5.0f64;
    let mut sum = 0.0;
    while sum < u && z < 5.0 {
        sum += step * (-0.5 * z * z).exp() / std::f64::consts::TAU.sqrt();
        z += step;
    }
    z
}

#[test]
fn tracers_mix_with_gas_particles_that_hold_themselves_up() {
    let rows = 60.0;
    let stratify = |gas: &mut gas::Particles| {
        for x in &mut gas.x {
            let row = ((x.z - 3.0) / 0.1).floor();
            x.z = 6.0 + gaussian((row + 0.5) / rows);
        }
    };
    let mut trial = Trial::new(COLUMN, &[], stratify).expect("a scene");
    let (mut dust, mut gas, mut times) = (vec![0.0; 5], vec![0.0; 5], 0.0);
    let edges = [0.0, 0.4, 0.8, 1.2, 1.8, 1e9];
    let done = trial.run(&[0.0, 30.0, 40.0, 50.0], |stop| {
        if stop.books.time == 0.0 {
            return;
        }
        let height = |x: &Vec3| (x.z - 6.0).abs();
        let system = stop.system;
        let found = [&system.dust.particles.x, &system.gas.particles.x]
            .map(|x| shares(x.iter().map(height), &edges));
        println!(
            "{}: dust {:.3?}, gas {:.3?}",
            stop.books.time, found[0], found[1]
        );
        times += 1.0;
        for k in 0..5 {
            dust[k] += found[0][k];
            gas[k] += found[1][k];
        }
    });
    done.expect("a run");
    let mean = |sums: &[f64]| -> Vec<f64> { sums.iter().map(|s| s / times).collect() };
    let n = trial.system.dust.particles.x.len();
    let off = deviation(&mean(&dust), &mean(&gas), n);
    println!("{n} tracers: {off:.2} standard errors");
    assert!(off < 1.6, "{off}");
}

#[test]
fn a_stirred_disk_has_the_same_bits_for_any_threads_and_after_a_restart() {
    let overrides = [
        "run.end_time=\"3 yr\"",
        "run.snapshots=\"1 yr\"",
        "dust.particles=700",
    ];
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().expect("a pool").install(|| {
            let run = bench::run("dust/settling-disk.toml", &overrides);
            std::fs::read_to_string(run.path("ledger.csv")).expect("a ledger")
        })
    };
    let one = run(1);
    assert!(one == run(2) && one == run(7));
    assert!(bench::resumes(
        bench::scene("dust/settling-disk.toml", &overrides),
        2.0
    ));
    let column = COLUMN.replace("end_time = 100.0", "end_time = 1.5");
    assert!(bench::resumes(bench::parsed(&column), 2.0));
}

/// A disk whose own stress stirs its dust.
const MEASURED: [&str; 7] = [
    "run.end_time=\"0.5 yr\"",
    "run.snapshots=\"0.1 yr\"",
    "gas.particles=3000",
    "dust.particles=1000",
    "planetesimals.number=10",
    "dust.turbulence.alpha=\"measured\"",
    "dust.turbulence.floor=1e-6",
];

#[test]
fn the_stress_of_the_gas_stirs_and_is_written_and_a_resumed_run_has_its_bits() {
    let scene = bench::scene("coupled/minimum-mass-disk.toml", &MEASURED);
    assert!(bench::resumes(scene.clone(), 2.0));
    let run = bench::run_scene(scene);
    let columns = tridisk::history::read_numbers(&run.path("stress.csv")).expect("a history");
    let column = |name: &str| &columns.iter().find(|(n, _)| n == name).expect("a column").1;
    let (time, alpha, stirring) = (column("time"), column("alpha"), column("stirring"));
    // Rings of a tenth in ln R from 0.5 to 1.5 au and the taper's beyond.
    let rings = time.iter().filter(|t| **t == time[0]).count();
    assert!((11..16).contains(&rings), "{rings} rings");
    for (alpha, stirring) in alpha.iter().zip(stirring) {
        assert_eq!(*stirring, alpha.max(1e-6));
    }
    // No subsonic flow has more than a sound speed's square.
    let last = &alpha[alpha.len() - rings..];
    println!("alpha of the settling disk: {last:.4?}");
    assert!(last.iter().all(|a| a.abs() < 1.0) && last.iter().any(|a| *a != 0.0));
}
