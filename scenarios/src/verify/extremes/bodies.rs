//! Bodies at the extremes: orbits, masses, sizes, numbers, places.

use std::f64::consts::TAU;

use nbody::points::Vec3;

use super::case::{Case, End};
use super::scene;
use super::start::Start;

const ORIGIN: Vec3 = Vec3::new(0.0, 0.0, 0.0);

/// A planet as a table of a scene.
fn planet(mass: f64, x: [f64; 3], v: [f64; 3]) -> String {
    format!("[[planet]]\nmass = {mass:e}\nposition = {x:?}\nvelocity = {v:?}\n")
}

fn star(mass: f64) -> String {
    format!("[star]\nmass = {mass:e}\n")
}

fn integrator(name: &str) -> String {
    format!("[planetesimals]\nintegrator = \"{name}\"\n")
}

/// A planet that begins at the apocentre of an orbit of unit axis about a unit mass.
fn eccentric(rest: f64) -> String {
    let e = 1.0 - rest;
    let v = (rest / (1.0 + e)).sqrt();
    planet(0.0, [1.0 + e, 0.0, 0.0], [0.0, v, 0.0])
}

/// How far the only body is from where it was at the start.
fn moved(end: &End) -> f64 {
    (end.rows(1).x[0] - end.start(1).x[0]).norm()
}

fn orbits(cases: &mut Vec<Case>) {
    for name in ["wisdom-holman", "hybrid", "gauss-radau", "hermite"] {
        for (passages, bar) in [(1.0, 1e-6), (10.0, 1e-5)] {
            let text = star(1.0) + &integrator(name) + &eccentric(1e-9);
            let case = Case::new(
                format!("e = 1 - 1e-9 through {passages} pericentres, {name}"),
                scene(passages * TAU, &text),
            );
            cases.push(case.figure("place after whole periods", bar, moved));
        }
    }
    let text = star(1.0) + &integrator("leapfrog") + &eccentric(1e-9);
    cases.push(Case::new("e = 1 - 1e-9, leapfrog", scene(TAU, &text)));
    let text = star(1.0) + &eccentric(1e-9);
    cases.push(Case::new("e = 1 - 1e-9, auto", scene(TAU, &text)));
    for name in ["auto", "leapfrog", "hybrid", "hermite", "gauss-radau"] {
        let flying = planet(1e-3, [-1e6, 0.5, 0.0], [1e6, 0.0, 0.0]);
        let text = star(1.0) + &integrator(name) + &flying;
        let case = Case::new(format!("hyperbolic at v = 1e6, {name}"), scene(2.0, &text));
        cases.push(
            case.energy(1e-12)
                .momentum(1e-12)
                .figure("place", 1e-6, |end| {
                    (end.rows(1).x[0] - Vec3::new(1e6, 0.5, 0.0)).norm()
                }),
        );
        let back = planet(1e-3, [1.0, 0.0, 0.0], [0.0, -1.0, 0.0])
            + &planet(1e-3, [2.0, 0.0, 0.0], [0.0, 0.707, 0.0]);
        let text = star(1.0) + &integrator(name) + &back;
        let case = Case::new(
            format!("one retrograde and one prograde, {name}"),
            scene(10.0, &text),
        );
        cases.push(case.energy(1e-4).momentum(1e-11).angular_momentum(1e-9));
    }
    let jacobi = "[planetesimals]\nintegrator = \"wisdom-holman\"\ncoordinates = \"jacobi\"\ntime_step = 62.0\n";
    let text = star(1.0) + jacobi + &planet(1e-6, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    let case = Case::new("1e7 orbits of one body", scene(1e7 * TAU, &text));
    cases.push(case.energy(1e-9).long());
}

/// Two planets about a star in units of these lengths and masses.
fn in_units(length: f64, mass: f64) -> (f64, String) {
    let time = (length.powi(3) / mass).sqrt();
    let speed = length / time;
    let text = star(mass)
        + &planet(1e-3 * mass, [length, 0.0, 0.0], [0.0, speed, 0.0])
        + &planet(
            1e-4 * mass,
            [-2.0 * length, 0.0, 0.0],
            [0.0, -0.7 * speed, 0.1 * speed],
        );
    (time, text)
}

fn magnitudes(cases: &mut Vec<Case>) {
    for (length, mass) in [
        (1e30, 1.0),
        (1e-30, 1.0),
        (1e30, 1e30),
        (1e-30, 1e-30),
        (1e60, 1e-60),
        (1e-60, 1e60),
        (1e100, 1e100),
        (1e-100, 1e-100),
    ] {
        for name in [
            "leapfrog",
            "wisdom-holman",
            "hybrid",
            "hermite",
            "gauss-radau",
        ] {
            let (time, text) = in_units(length, mass);
            let text = integrator(name) + &text;
            let case = Case::new(
                format!("lengths of {length:e}, masses of {mass:e}, {name}"),
                scene(6.0 * time, &text),
            );
            cases.push(case.energy(1e-3).momentum(1e-11).angular_momentum(1e-9));
        }
    }
    for name in [
        "leapfrog",
        "wisdom-holman",
        "hybrid",
        "hermite",
        "gauss-radau",
    ] {
        let text = star(1.0)
            + &integrator(name)
            + &planet(5e-324, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
            + &planet(1e-310, [1.5, 0.0, 0.0], [0.0, 0.8, 0.0]);
        let case = Case::new(format!("denormal masses, {name}"), scene(1.0, &text));
        cases.push(case.energy(1e-3));
        let text = star(1.0)
            + &integrator(name)
            + &planet(1e-3, [1.0, 1e-310, 0.0], [5e-324, 1.0, 1e-320]);
        let case = Case::new(format!("denormal velocity, {name}"), scene(1.0, &text));
        cases.push(case.energy(1e-3));
        let text = star(1e-12)
            + &integrator(name)
            + &planet(1.0, [1.0, 0.0, 0.0], [0.0, 0.0, 0.0])
            + &planet(1e-24, [1.0, 1.0, 0.0], [1.0, 0.0, 0.0]);
        let case = Case::new(
            format!("a planet 1e12 times its star's mass, {name}"),
            scene(1.0, &text),
        );
        cases.push(case.energy(1e-3));
        let text =
            star(5e-324) + &integrator(name) + &planet(1e-3, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        cases.push(
            Case::new(
                format!("a star of denormal mass, {name}"),
                scene(1.0, &text),
            )
            .energy(1e-3),
        );
        let text =
            star(1.0) + &integrator(name) + &planet(1e-3, [1e-200, 0.0, 0.0], [0.0, 0.0, 0.0]);
        cases.push(Case::new(
            format!("a planet 1e-200 from the star, {name}"),
            scene(1.0, &text),
        ));
        let text = star(1.0)
            + &integrator(name)
            + &planet(1e-3, [1e-12, 0.0, 0.0], [0.0, 1e6, 0.0])
            + &planet(1e-3, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        cases.push(Case::new(
            format!("periods 1e18 apart, {name}"),
            scene(6.0, &text),
        ));
        let text = star(1.0) + &integrator(name) + &planet(1e-3, [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]);
        cases.push(Case::new(
            format!("a radial fall into a point star, {name}"),
            scene(3.0, &text),
        ));
    }
}

/// Bodies of a file.
fn set(name: &str, collisions: &str, more: &str) -> String {
    format!(
        "[planetesimals]\nintegrator = \"{name}\"\ncollisions.outcome = \"{collisions}\"\n{more}"
    )
}

fn numbers(cases: &mut Vec<Case>) {
    for name in [
        "leapfrog",
        "hybrid",
        "hermite",
        "gauss-radau",
        "wisdom-holman",
    ] {
        let x = vec![Vec3::new(1.0, 0.0, 0.0); 300];
        let v = vec![Vec3::new(0.0, 1.0, 0.0); 300];
        let start = Start::new(1, &x, &v, &[1e-9; 300]);
        for (softening, collisions) in [("0", "none"), ("1e-3", "none"), ("0", "merge")] {
            let text = star(1.0) + &set(name, collisions, &format!("softening = {softening}\n"));
            let start = match collisions {
                "merge" => start.clone().reals(1, "Radii", &[1e-4; 300]),
                _ => start.clone(),
            };
            cases.push(
                Case::new(
                    format!("300 bodies at one place, softening {softening}, {collisions}, {name}"),
                    scene(0.5, &text),
                )
                .from(start),
            );
        }
        let line: Vec<Vec3> = (0..300)
            .map(|i| Vec3::new(1.0 + 0.01 * f64::from(i), 0.0, 0.0))
            .collect();
        let start = Start::new(1, &line, &vec![ORIGIN; 300], &[1e-9; 300]);
        let text = set(name, "none", "softening = 1e-3\n");
        let case = Case::new(
            format!("300 bodies on a line without a star, {name}"),
            scene(0.5, &text),
        );
        cases.push(case.from(start).momentum(1e-9));
        for n in [0, 1, 2] {
            let x: Vec<Vec3> = (0..n)
                .map(|i| Vec3::new(1.0 + f64::from(i), 0.0, 0.0))
                .collect();
            let start = Start::new(1, &x, &vec![Vec3::y(); n as usize], &vec![1e-3; n as usize]);
            let text = star(1.0) + &set(name, "merge", "");
            let start = start.reals(1, "Radii", &vec![1e-3; n as usize]);
            cases.push(
                Case::new(format!("{n} bodies of a file, {name}"), scene(1.0, &text))
                    .from(start)
                    .left(n as usize),
            );
        }
        let start = Start::new(1, &[ORIGIN, Vec3::x() * 0.9], &[ORIGIN; 2], &[1.0, 1e-12]);
        let start = start.reals(1, "Radii", &[1.0, 1e-12]);
        let text = set(name, "merge", "");
        cases.push(
            Case::new(
                format!("a body inside one 1e12 times its size, {name}"),
                scene(1.0, &text),
            )
            .from(start)
            .left(1),
        );
    }
}

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    orbits(&mut cases);
    magnitudes(&mut cases);
    numbers(&mut cases);
    cases
}
