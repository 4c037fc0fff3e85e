//! Gas at the extremes: speeds, densities, numbers, places, units, steps, cooling, viscosity.

use nbody::points::Vec3;

use super::case::{Case, End};
use super::scene;
use super::start::Start;

const ORIGIN: Vec3 = Vec3::new(0.0, 0.0, 0.0);

/// A periodic box of unit size with a lattice of 512 particles.
fn full(keys: &str, tables: &str) -> String {
    format!(
        "[domain]\nkind = \"periodic\"\nsize = [1, 1, 1]\n[[gas.block]]\nlo = [0, 0, 0]\nhi = [1, 1, 1]\nspacing = 0.125\n{keys}\n{tables}"
    )
}

/// Gas of a file about nothing.
fn open(tables: &str) -> String {
    format!("[gas]\n{tables}")
}

fn start(x: &[Vec3], u: f64) -> Start {
    let n = x.len();
    Start::new(0, x, &vec![ORIGIN; n], &vec![1.0; n]).reals(0, "InternalEnergies", &vec![u; n])
}

/// The largest change of a particle's place, after the motion at `v` is taken off, in a periodic box of unit size.
fn astray(end: &End, v: f64, time: f64) -> f64 {
    let (a, b) = (end.start(0), end.rows(0));
    let mut worst = 0.0f64;
    for (i, id) in a.id.iter().enumerate() {
        let j = b.id.iter().position(|other| other == id).unwrap_or(i);
        let mut way = b.x[j] - a.x[i] - Vec3::new(v * time, 0.0, 0.0);
        way.apply(|d| *d -= d.round());
        worst = worst.max(way.norm());
    }
    worst
}

/// The range of a column of the gas at the end, less one.
fn range(end: &End, name: &str) -> f64 {
    let rows = end.rows(0);
    let values = rows.more.get(name).cloned().unwrap_or_default();
    let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    most / least - 1.0
}

fn streams(cases: &mut Vec<Case>) {
    for (mach, end) in [(1e-3, 1.0), (1.0, 1.0), (1e4, 1e-3), (1e8, 1e-7)] {
        let keys = format!("density = 1\ninternal_energy = 0.9\nvelocity = [{mach:e}, 0, 0]");
        let case = Case::new(
            format!("uniform gas at Mach {mach:e}"),
            scene(end, &full(&keys, "")),
        );
        cases.push(
            case.momentum(1e-12)
                .energy(1e-12)
                .figure("place", 1e-9, move |e| astray(e, mach, end)),
        );
    }
    let case = Case::new(
        "gas at rest for 1e5 steps",
        scene(
            2000.0,
            &full("density = 1\ninternal_energy = 0.9", "")
                .replace("spacing = 0.125", "spacing = 0.25"),
        )
        .replace("[run]\n", "[run]\ntime_step = 0.02\n"),
    );
    cases.push(
        case.energy(1e-9)
            .figure("place", 1e-6, |e| astray(e, 0.0, 0.0))
            .long(),
    );
    let case = Case::new(
        "gas at rest for 1000 steps",
        scene(20.0, &full("density = 1\ninternal_energy = 0.9", ""))
            .replace("[run]\n", "[run]\ntime_step = 0.02\n"),
    );
    cases.push(
        case.energy(1e-11)
            .figure("place", 1e-9, |e| astray(e, 0.0, 0.0)),
    );
}

fn units(cases: &mut Vec<Case>) {
    for precision in ["single", "double"] {
        for (length, mass, speed) in [
            (1.0, 1.0, 1.0),
            (1e30, 1.0, 1.0),
            (1e-30, 1.0, 1.0),
            (1.0, 1e30, 1.0),
            (1.0, 1e-30, 1.0),
            (1.0, 1.0, 1e30),
            (1.0, 1.0, 1e-30),
            (1e30, 1e30, 1e30),
            (1e-30, 1e-30, 1e-30),
            (1e60, 1e-60, 1e-60),
            (1e-60, 1e60, 1e60),
            (1e-60, 1e-100, 1e-100),
        ] {
            let density = mass / (length * length * length);
            let text = format!(
                "[domain]\nkind = \"periodic\"\nsize = [{length:e}, {length:e}, {length:e}]\n[[gas.block]]\nlo = [0, 0, 0]\nhi = [{h:e}, {length:e}, {length:e}]\nspacing = {s:e}\ndensity = {density:e}\ninternal_energy = {u:e}\n[[gas.block]]\nlo = [{h:e}, 0, 0]\nhi = [{length:e}, {length:e}, {length:e}]\nspacing = {s:e}\ndensity = {density:e}\ninternal_energy = {u2:e}\n[gas.hydro]\nprecision = \"{precision}\"\n",
                h = 0.5 * length,
                s = 0.125 * length,
                u = speed * speed,
                u2 = 0.1 * speed * speed,
            );
            let time = 0.1 * length / speed;
            let case = Case::new(
                format!(
                    "a shock tube in units of {length:e} (length), {mass:e} (mass), {speed:e} (speed), {precision}"
                ),
                scene(time, &text),
            );
            cases.push(case.momentum(1e-12).energy(1e-2).figure(
                "kinetic by thermal energy",
                0.5,
                |e| e.final_value("kinetic_energy") / e.final_value("internal_energy"),
            ));
        }
    }
    let keys = "density = 1e-320\ninternal_energy = 1";
    cases.push(Case::new("denormal masses", scene(0.1, &full(keys, ""))));
    let keys = "density = 1\ninternal_energy = 5e-324\nvelocity = [5e-324, 0, 0]";
    cases.push(Case::new(
        "denormal energies and velocities",
        scene(0.1, &full(keys, "")),
    ));
}

fn contrasts(cases: &mut Vec<Case>) {
    for power in [4, 10] {
        let ratio = 10f64.powi(power);
        let text = format!(
            "[domain]\nkind = \"periodic\"\nsize = [1, 1, 1]\n[[gas.block]]\nlo = [0, 0, 0]\nhi = [0.5, 1, 1]\nspacing = 0.125\ndensity = 1\npressure = 1\n[[gas.block]]\nlo = [0.5, 0, 0]\nhi = [1, 1, 1]\nspacing = 0.125\ndensity = {:e}\npressure = 1\n",
            1.0 / ratio
        );
        let case = Case::new(
            format!("densities of 1 to {ratio:e} in balance"),
            scene(1e-6, &text),
        );
        cases.push(case.momentum(1e-12).energy(1e-2));
        let text = text.replace(
            &format!("density = {:e}\npressure = 1", 1.0 / ratio),
            &format!("density = {:e}\npressure = {:e}", 1.0 / ratio, 1.0 / ratio),
        );
        let case = Case::new(
            format!("gas into gas {ratio:e} times thinner of its temperature"),
            scene(0.05, &text),
        );
        cases.push(case.momentum(1e-12).energy(1e-2));
    }
    let text = full("density = 1\ninternal_energy = 0.9", "");
    let text = text.replace("hi = [1, 1, 1]\nspacing", "hi = [0.5, 1, 1]\nspacing");
    let case = Case::new("gas beside a vacuum in a periodic box", scene(0.2, &text));
    cases.push(case.momentum(1e-12).energy(1e-2));
}

fn numbers(cases: &mut Vec<Case>) {
    for n in [0, 1, 2] {
        let x: Vec<Vec3> = (0..n).map(|i| Vec3::new(f64::from(i), 0.0, 0.0)).collect();
        let case = Case::new(format!("{n} particles of a file"), scene(0.5, &open("")));
        cases.push(
            case.from(start(&x, 1.0))
                .momentum(1e-12)
                .energy(1e-3)
                .left(x.len()),
        );
        let tables = "[gas]\n[domain]\nkind = \"periodic\"\nsize = [1, 1, 1]\n";
        let x: Vec<Vec3> = x.iter().map(|x| 0.3 * x + Vec3::repeat(0.2)).collect();
        let case = Case::new(
            format!("{n} particles in a periodic box"),
            scene(0.5, tables),
        );
        cases.push(
            case.from(start(&x, 1.0))
                .momentum(1e-12)
                .energy(1e-3)
                .left(x.len()),
        );
        let tables = "[gas]\n[domain]\nkind = \"shearing-box\"\nsize = [1, 1, 1]\nrate = 1\n";
        let case = Case::new(
            format!("{n} particles in a shearing box"),
            scene(0.5, tables),
        );
        cases.push(case.from(start(&x, 1.0)).left(x.len()));
        let tables = "[gas]\n[gravity]\nmethod = \"tree\"\n";
        let case = Case::new(
            format!("{n} particles that pull each other"),
            scene(0.5, tables),
        );
        cases.push(case.from(start(&x, 1.0)).momentum(1e-12).left(x.len()));
    }
    for spacing in [1.0, 0.5, 0.25] {
        for precision in ["single", "double"] {
            let keys = "density = 1\ninternal_energy = 0.9\nvelocity = [1, 0.3, 0]";
            let text = full(keys, &format!("[gas.hydro]\nprecision = \"{precision}\"\n"))
                .replace("spacing = 0.125", &format!("spacing = {spacing}"));
            let what =
                format!("smoothing length of {spacing} of ~2 spacings in a unit box, {precision}");
            cases.push(
                Case::new(what, scene(0.5, &text))
                    .momentum(1e-12)
                    .energy(1e-9),
            );
        }
    }
    let flat = full(
        "density = 1\ninternal_energy = 0.9\nvelocity = [1, 0.3, 0]",
        "",
    )
    .replace("size = [1, 1, 1]", "size = [1, 1, 0.125]")
    .replace("hi = [1, 1, 1]", "hi = [1, 1, 0.125]");
    cases.push(
        Case::new("a box one particle high", scene(0.5, &flat))
            .momentum(1e-12)
            .energy(1e-9),
    );
}

fn places(cases: &mut Vec<Case>) {
    let x = [0.5 * Vec3::x(); 100];
    for tables in ["", "[gravity]\nmethod = \"tree\"\n"] {
        let case = Case::new(
            format!("100 particles at one place {tables}"),
            scene(0.5, &open(tables)),
        );
        cases.push(
            case.from(start(&x, 1.0))
                .momentum(1e-12)
                .energy(1e-2)
                .left(100),
        );
    }
    let periodic = "[domain]\nkind = \"periodic\"\nsize = [1, 1, 1]\n";
    let case = Case::new(
        "100 particles at one place of a periodic box",
        scene(0.5, &open(periodic)),
    );
    cases.push(
        case.from(start(&x, 1.0))
            .momentum(1e-12)
            .energy(1e-2)
            .left(100),
    );
    let plane: Vec<Vec3> = (0..400)
        .map(|i| Vec3::new(f64::from(i % 20), f64::from(i / 20), 0.0))
        .collect();
    let line: Vec<Vec3> = (0..100)
        .map(|i| Vec3::new(f64::from(i), 0.0, 0.0))
        .collect();
    for (what, x) in [("plane", &plane), ("line", &line)] {
        for tables in ["", "[gravity]\nmethod = \"tree\"\n"] {
            let case = Case::new(
                format!("gas on a {what} {tables}"),
                scene(2.0, &open(tables)),
            );
            cases.push(
                case.from(start(x, 1.0))
                    .momentum(1e-12)
                    .energy(1e-2)
                    .left(x.len()),
            );
        }
    }
    let mut far = plane.clone();
    far.push(Vec3::new(1e12, 0.0, 0.0));
    far.push(Vec3::new(0.0, -1e30, 1e3));
    let case = Case::new("particles 1e12 and 1e30 sizes away", scene(2.0, &open("")));
    cases.push(
        case.from(start(&far, 1.0))
            .momentum(1e-12)
            .energy(1e-2)
            .left(far.len()),
    );
    let mut hot = start(&plane, 1.0);
    let mut u = vec![1.0; 400];
    u[210] = 1e24;
    hot = hot.reals(0, "InternalEnergies", &u);
    let case = Case::new("one particle 1e24 times as hot", scene(1e-9, &open("")));
    cases.push(
        case.from(hot.clone())
            .momentum(1e-11)
            .energy(1e-2)
            .left(400),
    );
    let case = Case::new("the same to steps 2^30 times longer", scene(1.0, &open("")));
    cases.push(case.from(hot).momentum(1e-11).energy(1e-2).left(400));
    let m: Vec<f64> = (0..400)
        .map(|i| if i % 2 == 0 { 1.0 } else { 1e-12 })
        .collect();
    let case = Case::new("masses 1e12 apart", scene(0.5, &open("")));
    cases.push(
        case.from(start(&plane, 1.0).reals(0, "Masses", &m))
            .momentum(1e-11)
            .energy(1e-2)
            .left(400),
    );
    let m: Vec<f64> = (0..400)
        .map(|i| if i % 2 == 0 { 1.0 } else { 0.0 })
        .collect();
    let case = Case::new("every other particle without mass", scene(0.5, &open("")));
    cases.push(
        case.from(start(&plane, 1.0).reals(0, "Masses", &m))
            .momentum(1e-11)
            .energy(1e-2)
            .left(400),
    );
    let case = Case::new("all particles without mass", scene(0.5, &open("")));
    cases.push(
        case.from(start(&plane, 1.0).reals(0, "Masses", &[0.0; 400]))
            .left(400),
    );
    let h: Vec<f64> = (0..400)
        .map(|i| if i % 2 == 0 { 1e-30 } else { 1e30 })
        .collect();
    let case = Case::new(
        "first smoothing lengths of 1e-30 and 1e30",
        scene(0.5, &open("")),
    );
    cases.push(
        case.from(start(&plane, 1.0).reals(0, "SmoothingLengths", &h))
            .momentum(1e-11)
            .energy(1e-2)
            .left(400),
    );
    let case = Case::new("first smoothing lengths of 0", scene(0.5, &open("")));
    cases.push(
        case.from(start(&plane, 1.0).reals(0, "SmoothingLengths", &[0.0; 400]))
            .momentum(1e-11)
            .energy(1e-2)
            .left(400),
    );
    let case = Case::new("no heat at all", scene(0.5, &open("")));
    cases.push(case.from(start(&plane, 0.0)).left(400));
}

/// A ring of gas about a unit star.
fn ring(tables: &str) -> String {
    format!(
        "[star]\nmass = 1\n[gas]\nparticles = 2000\n[gas.disk]\nmass = 1e-3\naspect_ratio = 0.1\ninner_radius = 1\nouter_radius = 2\nreference_radius = 1\n{tables}"
    )
}

fn disks(cases: &mut Vec<Case>) {
    for beta in ["1e-12", "1e12"] {
        let tables = format!("[gas.cooling]\nkind = \"beta\"\nbeta = {beta}\n");
        let case = Case::new(
            format!("cooling in {beta} / Omega"),
            scene(0.3, &ring(&tables)),
        );
        cases.push(case.momentum(1e-10).energy(1e-1));
        let tables =
            format!("[gas.cooling]\nkind = \"beta\"\nbeta = {beta}\naspect_ratio = 0.05\n");
        let case = Case::new(
            format!("cooling in {beta} / Omega to a floor"),
            scene(0.3, &ring(&tables)),
        );
        cases.push(case.momentum(1e-10).energy(1e-1));
        let tables =
            format!("[gas.cooling]\nkind = \"relaxation\"\nbeta = {beta}\naspect_ratio = 0.1\n");
        let case = Case::new(
            format!("relaxation in {beta} / Omega"),
            scene(0.3, &ring(&tables)),
        );
        cases.push(case.momentum(1e-10).energy(1e-1));
    }
    for alpha in ["100", "1e6"] {
        let tables = format!("[gas.viscosity]\nkind = \"constant\"\nalpha = {alpha}\n");
        let case = Case::new(
            format!("artificial viscosity alpha {alpha}"),
            scene(0.1, &ring(&tables)),
        );
        cases.push(case.momentum(1e-10).energy(1e-1));
    }
    for keys in [
        "shakura_sunyaev = 100",
        "kinematic = 1e12",
        "kinematic = 1e-300",
        "shakura_sunyaev = 1",
    ] {
        let tables = format!("[gas.viscosity]\n{keys}\n");
        let case = Case::new(format!("viscosity {keys}"), scene(0.01, &ring(&tables)));
        cases.push(case.momentum(1e-10).energy(1e-1));
    }
    let none = "[gas.viscosity]\nkind = \"none\"\n";
    let case = Case::new("no viscosity", scene(0.1, &ring(none)));
    cases.push(case.momentum(1e-10).energy(1e-1));
    let thin = ring("").replace("aspect_ratio = 0.1", "aspect_ratio = 1e-12");
    cases.push(Case::new("aspect ratio 1e-12", scene(0.1, &thin)).momentum(1e-10));
    for mass in ["1e-300", "1e-12"] {
        let light = ring("").replace("[star]\nmass = 1\n", &format!("[star]\nmass = {mass}\n"));
        cases.push(
            Case::new(format!("star of {mass} below its disk"), scene(0.1, &light)).momentum(1e-10),
        );
    }
    let few = ring("").replace("particles = 2000", "particles = 1");
    cases.push(Case::new("a disk of one particle", scene(0.1, &few)).momentum(1e-10));
    let few = ring("").replace("particles = 2000", "particles = 2");
    cases.push(Case::new("a disk of two particles", scene(0.1, &few)).momentum(1e-10));
    let narrow = ring("").replace("outer_radius = 2", "outer_radius = 1.000000000001");
    cases.push(Case::new("a disk 1e-12 wide", scene(0.1, &narrow)).momentum(1e-10));
    let wide = ring("").replace("outer_radius = 2", "outer_radius = 1e12");
    cases.push(Case::new("a disk 1e12 wide", scene(0.1, &wide)).momentum(1e-10));
    let _ = range;
}

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    streams(&mut cases);
    units(&mut cases);
    contrasts(&mut cases);
    numbers(&mut cases);
    places(&mut cases);
    disks(&mut cases);
    cases
}
