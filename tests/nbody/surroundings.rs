//! Surroundings and test particles in whole runs: aerodynamic drag, capture into resonance, relativity, and what test particles cost.

use std::f64::consts::TAU;

use nbody::orbit::Elements;

use crate::bench::{self, Done};

const HEAD: &str = r#"
title = "trial"
[units]
system = "dimensionless"
[star]
mass = 1.0
"#;

/// Elements of the bodies of a snapshot about the star, ordered by id; G = M = 1.
fn orbits(run: &Done, snapshot: usize) -> Vec<Elements> {
    let path = &run.snapshots()[snapshot];
    let (star, bodies) = (run.particles(path, 4), run.particles(path, 1));
    (0..bodies.len())
        .map(|i| {
            let (x, v) = (bodies.x[i] - star.x[0], bodies.v[i] - star.v[0]);
            Elements::of(1.0 + bodies.m[i], x, v).expect("an orbit")
        })
        .collect()
}

/// Rates times tau0 of a, e and i under du/dt = -|u| u/(tau0 v_K(a)), gas at (1 - eta) v_K(R), density uniform: averages of Gauss's
/// equations over M, and for i > 0 over omega (Adachi, Hayashi & Nakazawa 1976); columns e, i, d ln a/dt, de/dt, di/dt; eta = 0.002, a = 1.
const DECAY: [[f64; 5]; 6] = [
    [0.0001, 0.0, -8.00751267669e-06, -2.99893307701e-07, 0.0],
    [0.01, 0.0, -4.00915940903e-05, -8.16948653285e-05, 0.0],
    [0.05, 0.0, -0.000281080200614, -0.00192681644165, 0.0],
    [0.1, 0.0, -0.00108487854754, -0.00768061150799, 0.0],
    [
        0.02,
        0.05,
        -0.000205537139761,
        -0.000731676640732,
        -0.00113323061906,
    ],
    [
        0.1,
        0.05,
        -0.00124408393617,
        -0.00845852008292,
        -0.00222464811603,
    ],
];

#[test]
fn quadratic_drag_changes_a_e_and_i_at_the_rates_of_gausss_equations() {
    const TAU0: f64 = 1e3;
    const ARGUMENTS: usize = 16;
    // eta = 0.002 by the disk's own pressure: uniform density is Sigma ~ r at constant h, and (1 - eta)^2 = 1 - h^2.
    let pressure = format!(
        "surface_density_slope = 1.0\naspect_ratio = {}",
        (1f64 - 0.998 * 0.998).sqrt()
    );
    for (rotation, flat) in [
        ("aspect_ratio = 0.05\nheadwind = 0.002", false),
        (&*pressure, true),
    ] {
        let mut scene = format!(
            "{HEAD}[run]\nend_time = {TAU}\nsnapshots = [0.0, {TAU}]\n[accuracy]\norbit_step = 0.05\n\
             [surroundings.disk]\nsurface_density = 1e-6\nflaring = 0.0\ninner_radius = 0.1\nouter_radius = 10.0\n\
             {rotation}\ndrag = \"quadratic\"\ncoefficient = {}\n",
            1.0 / TAU0
        );
        let rows: Vec<&[f64; 5]> = DECAY.iter().filter(|row| !flat || row[1] == 0.0).collect();
        for [e, i, ..] in &rows {
            for k in 0..ARGUMENTS {
                let argument = TAU * k as f64 / ARGUMENTS as f64;
                scene += &format!(
                    "[[planet]]\nmass = 0.0\nsemi_major_axis = 1.0\neccentricity = {e}\ninclination = {i}\nargument_of_pericentre = {argument}\n"
                );
            }
        }
        let run = bench::run_text(&scene);
        let (before, after) = (orbits(&run, 0), orbits(&run, 1));
        for (row, &[e, i, da, de, di]) in rows.iter().copied().enumerate() {
            let rate = |f: fn(&Elements) -> f64| {
                let change = |k: usize| f(&after[k]) - f(&before[k]);
                let sum: f64 = (row * ARGUMENTS..(row + 1) * ARGUMENTS).map(change).sum();
                sum / ARGUMENTS as f64 * TAU0 / TAU
            };
            for (name, found, wanted) in [
                ("a", rate(|o| o.semi_major_axis.ln()), da),
                ("e", rate(|o| o.eccentricity), de),
                ("i", rate(|o| o.inclination), di),
            ] {
                println!("e {e} i {i}: {name} {found:e} for {wanted:e}");
                let error = if wanted == 0.0 {
                    found
                } else {
                    found / wanted - 1.0
                };
                assert!(
                    error.abs() < 1.2e-3,
                    "e {e} i {i}: {name} {found:e} for {wanted:e}"
                );
            }
        }
    }
}

/// e_f^2 = ln(a_f/a_i)/(j + 1) for a test particle carried outward in the exterior (j + 1):j resonance (Malhotra 1993, 1995; Murray &
/// Dermott 1999, section 8.12); phi = (j + 1) lambda' - j lambda - varpi' librates.
#[test]
fn a_planet_that_moves_outward_carries_a_test_particle_in_resonance() {
    for (j, ratio, mass, wanted) in [
        (1, 1.2f64, 3e-4, 0.301928432575),
        (2, 1.31, 3e-4, 0.300015075851),
        (3, 1.1, 3e-4, 0.154361734089),
    ] {
        let time = 3e4;
        let nominal = f64::powf(f64::from(j + 1) / f64::from(j), 2.0 / 3.0);
        // A little outside of the nominal place: the resonance passes by there first.
        let place = 1.01 * nominal;
        let end = time;
        let scene = format!(
            "{HEAD}[run]\nend_time = {end}\nsnapshots = {}\n[planetesimals]\nintegrator = \"wisdom-holman\"\ntime_step = 0.25\n\
             [[planet]]\nmass = {mass}\nsemi_major_axis = 1.0\nmigration_time = {}\n\
             [[planet]]\nmass = 0.0\nsemi_major_axis = {place}\neccentricity = 0.001\nmean_anomaly = 2.0\n",
            end / 200.0,
            time / (ratio * 1.01).ln(),
        );
        let run = bench::run_text(&scene);
        let last = run.snapshots().len() - 1;
        let late: Vec<[Elements; 2]> = (last - 40..=last)
            .map(|k| <[Elements; 2]>::try_from(orbits(&run, k)).expect("two bodies"))
            .collect();
        let phase = |[planet, particle]: &[Elements; 2]| {
            let longitude = |o: &Elements| o.node + o.pericentre + o.mean_anomaly;
            let jay = f64::from(j);
            (jay + 1.0) * longitude(particle)
                - jay * longitude(planet)
                - particle.node
                - particle.pericentre
        };
        let mean =
            |f: &dyn Fn(&[Elements; 2]) -> f64| late.iter().map(f).sum::<f64>() / late.len() as f64;
        let gathered = mean(&|o| phase(o).cos()).hypot(mean(&|o| phase(o).sin()));
        let axes = mean(&|[p, q]| q.semi_major_axis / p.semi_major_axis / nominal);
        let [planet, _] = late[late.len() - 1];
        // The formula at the planet's place of each snapshot; the resonance passes by when the planet is at 1.01.
        let formula = |p: &Elements| ((p.semi_major_axis / 1.01).ln() / f64::from(j + 1)).sqrt();
        let e = wanted * mean(&|[p, q]| q.eccentricity / formula(p));
        println!(
            "{}:{j}: e {e} for {wanted}, axes by nominal {axes}, phases gathered to {gathered}, planet at {}",
            j + 1,
            planet.semi_major_axis
        );
        assert!(
            gathered > 0.5,
            "captured: the argument librates, {gathered}"
        );
        assert!((axes - 1.0).abs() < 0.01, "captured: axes {axes}");
        assert!((e / wanted - 1.0).abs() < 0.08, "e {e} for {wanted}");
    }
}

/// 42.98 arcseconds a century: 6 pi G M/(c^2 a (1 - e^2)) an orbit, a = 0.38709893 au, e = 0.20563069; no other planet.
#[test]
fn mercurys_perihelion_advances_by_43_arcseconds_a_century() {
    let run = bench::run_text(
        r#"
        title = "Mercury"
        [run]
        end_time = "120.4198 yr"
        snapshots = [0.0, "120.4198 yr"]
        [star]
        mass = "1 Msun"
        [[planet]]
        mass = 0.0
        semi_major_axis = "0.38709893 au"
        eccentricity = 0.20563069
        inclination = "7 deg"
        argument_of_pericentre = "29 deg"
        [surroundings]
        relativity = true
        "#,
    );
    let (before, after) = (orbits(&run, 0)[0], orbits(&run, 1)[0]);
    let arcseconds = (after.pericentre - before.pericentre).to_degrees() * 3600.0;
    // A Julian century has 1/1.0000196 of a hundred years of sqrt(au^3/G M).
    let century = arcseconds / 1.204198 / 1.0000196;
    println!("{century} arcseconds a century");
    assert!((century / 42.98 - 1.0).abs() < 4e-4, "{century}");
}

/// A belt of test particles between two planets: no pull among them in the tree, and the same orbits by both integrators.
#[test]
fn test_particles_cost_no_gravity_between_themselves() {
    let run = |number: usize, integrator: &str| {
        let scene = format!(
            "{HEAD}[run]\nend_time = 3.0\nsnapshots = [0.0, 3.0]\nwrite_accelerations = true\n[accuracy]\norbit_step = 0.01\n\
             [planetesimals]\nnumber = {number}\nmass = 0.0\ninner_radius = 1.5\nouter_radius = 2.0\nintegrator = \"{integrator}\"\n\
             [[planet]]\nmass = 1e-4\nsemi_major_axis = 1.0\n[[planet]]\nmass = 1e-4\nsemi_major_axis = 3.0\n\
             [[planet]]\nmass = 0.0\nsemi_major_axis = 1.7\n"
        );
        let run = bench::run_text(&scene);
        let text = std::fs::read_to_string(run.path("timings.json")).expect("timings");
        let timings: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        let count = |phase: &str| {
            timings["phases"][phase]["interactions"]
                .as_f64()
                .unwrap_or(0.0)
        };
        let last = run.snapshots().pop().expect("a snapshot");
        (count("gravity"), run.particles(&last, 1))
    };
    let (tree, fast) = run(40, "wisdom-holman");
    assert_eq!(tree, 0.0, "a tree of no masses");
    let (_, exact) = run(40, "gauss-radau");
    for i in 0..fast.len() {
        let error = (fast.x[i] - exact.x[i]).norm();
        assert!(error < 1e-7, "{i}: {error:e}");
    }
}
