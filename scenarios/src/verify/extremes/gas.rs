//! Gas at the extremes: speeds, densities, numbers, places, units, steps.

use nbody::points::Vec3;

use super::case::{Case, End};
use super::scene;
use super::start::Start;

const ORIGIN: Vec3 = Vec3::new(0.0, 0.0, 0.0);

const STEP: &str = "gas particle ~: needs a time step of ~ at time ~, shorter than the shortest, ~; the snapshots and the last checkpoint stay valid";

const NO_KERNEL: &str = "gas particle ~: no smoothing length gives the wanted neighbour number at time 0 (last try ~); the snapshots and the last checkpoint stay valid";

const TREE: &str = "[gas]\n[gravity]\nmethod = \"tree\"\n";

/// Gas without gravity.
const FREE: &str = "[gas]\n[gravity]\nmethod = \"none\"\n";

const PERIODIC: &str = "[gas]\n[domain]\nkind = \"periodic\"\nsize = [1, 1, 1]\n";

/// A periodic box of unit size with a lattice.
fn full(keys: &str, tables: &str) -> String {
    format!(
        "[domain]\nkind = \"periodic\"\nsize = [1, 1, 1]\n[[gas.block]]\nlo = [0, 0, 0]\nhi = [1, 1, 1]\nspacing = 0.125\nlattice = \"bcc\"\n{keys}\n{tables}"
    )
}

/// Particles of unit mass at rest.
fn start(x: &[Vec3], u: f64) -> Start {
    let n = x.len();
    Start::new(0, x, &vec![ORIGIN; n], &vec![1.0; n]).reals(0, "InternalEnergies", &vec![u; n])
}

fn grid(n: i32, layers: i32) -> Vec<Vec3> {
    let of = |i: i32| [i % n, i / n % n, i / (n * n)];
    (0..n * n * layers)
        .map(|i| Vec3::from_fn(|axis, _| f64::from(of(i)[axis]) + 0.5))
        .collect()
}

/// The largest change of a particle's place in a periodic box of unit size beside motion at `v` along x.
fn astray(end: &End, way: f64) -> f64 {
    let (a, b) = (end.start(0), end.rows(0));
    let apart = |(i, id): (usize, &u64)| {
        let place = b.id.iter().position(|other| other == id);
        let mut d = place.map_or(Vec3::repeat(f64::NAN), |j| b.x[j] - a.x[i]);
        d.x -= way;
        d.map(|d| d - d.round()).norm()
    };
    let all = a.id.iter().enumerate().map(apart);
    all.fold(0.0, |a: f64, b| if a >= b { a } else { b })
}

fn streams(cases: &mut Vec<Case>) {
    for (mach, end) in [(1e-3, 1.0), (1.0, 1.0), (1e4, 1e-3), (1e8, 1e-7)] {
        let keys = format!("density = 1\ninternal_energy = 0.9\nvelocity = [{mach:e}, 0, 0]");
        let text = scene(end, &full(&keys, ""));
        let case = Case::new(format!("uniform gas at Mach {mach:e}"), text).momentum(1e-13);
        cases.push(
            case.energy(1e-12)
                .figure("place", 1e-10, move |e| astray(e, mach * end)),
        );
    }
    let rest = full("density = 1\ninternal_energy = 0.9", "");
    for (steps, spacing) in [(500.0, "0.125"), (1e5, "0.25")] {
        let text = scene(0.02 * steps, &rest.replace("0.125", spacing));
        let text = text.replace("[run]\n", "[run]\ntime_step = 0.02\n");
        let case = Case::new(format!("gas at rest for {steps:e} steps"), text);
        let case = case.momentum(1e-12).energy(1e-9);
        let case = case.figure("place", 1e-6, |e| astray(e, 0.0));
        cases.push(if steps > 1e4 { case.long() } else { case });
    }
}

/// Two halves of a box, the right one a tenth as hot, in units of length, mass and speed; and the end.
fn halves(length: f64, mass: f64, speed: f64, precision: &str) -> (f64, String) {
    let density = mass / length / length / length;
    let (middle, spacing, u) = (0.5 * length, 0.125 * length, speed * speed);
    let block = |lo: f64, hi: f64, u: f64| {
        format!(
            "[[gas.block]]\nlo = [{lo:e}, 0, 0]\nhi = [{hi:e}, {length:e}, {length:e}]\nspacing = {spacing:e}\ndensity = {density:e}\ninternal_energy = {u:e}\n"
        )
    };
    let text = format!(
        "[domain]\nkind = \"periodic\"\nsize = [{length:e}, {length:e}, {length:e}]\n{}{}[gas.hydro]\nprecision = \"{precision}\"\n",
        block(0.0, middle, u),
        block(middle, length, 0.1 * u),
    );
    (0.1 * length / speed, text)
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
        ] {
            let (time, text) = halves(length, mass, speed, precision);
            let what =
                format!("a shock tube in units of {length:e}, {mass:e}, {speed:e}, {precision}");
            let case = Case::new(what, scene(time, &text));
            // What part of the energy has become kinetic does not hang on units.
            let part = |e: &End| {
                e.final_value("kinetic_energy") / e.final_value("internal_energy") / KINETIC - 1.0
            };
            let case = case.momentum(1e-12).energy(1e-6);
            cases.push(case.figure("kinetic part", 1e-4, part));
        }
    }
}

/// Kinetic by thermal energy at the end of the tube in units of one and double precision, as the program has it.
const KINETIC: f64 = 0.021_397_8;

fn contrasts(cases: &mut Vec<Case>) {
    let tube = |rho: f64, p: f64| {
        format!(
            "[domain]\nkind = \"periodic\"\nsize = [1, 1, 1]\n[[gas.block]]\nlo = [0, 0, 0]\nhi = [0.5, 1, 1]\nspacing = 0.125\ndensity = 1\npressure = 1\n[[gas.block]]\nlo = [0.5, 0, 0]\nhi = [1, 1, 1]\nspacing = 0.125\ndensity = {rho:e}\npressure = {p:e}\n"
        )
    };
    for thin in [1e-4, 1e-10] {
        let case = Case::new(
            format!("densities of 1 and {thin:e} in balance"),
            scene(1e-6, &tube(thin, 1.0)),
        );
        cases.push(case.momentum(1e-12).energy(1e-2));
    }
    let case = Case::new(
        "gas into gas 1e4 times thinner",
        scene(0.05, &tube(1e-4, 1e-4)),
    );
    cases.push(case.momentum(1e-12).energy(1e-2));
    let text = scene(0.05, &tube(1e-10, 1e-10));
    cases.push(Case::refused("gas into gas 1e10 times thinner", text, STEP));
    let text = full("density = 1\ninternal_energy = 0.9", "").replace("hi = [1,", "hi = [0.5,");
    let case = Case::new("gas beside a vacuum", scene(0.2, &text));
    cases.push(case.momentum(1e-12).energy(1e-2));
}

fn numbers(cases: &mut Vec<Case>) {
    const SHEARING: &str = "[gas]\n[domain]\nkind = \"shearing-box\"\nsize = [1, 1, 1]\nrate = 1\n";
    for n in [0, 1, 2] {
        let x: Vec<Vec3> = (0..n)
            .map(|i| Vec3::new(0.2 + 0.3 * f64::from(i), 0.2, 0.2))
            .collect();
        for (where_, tables) in [
            ("", FREE),
            (" in a periodic box", PERIODIC),
            (" in a shearing box", SHEARING),
            (" that pull each other", TREE),
        ] {
            let what = format!("{n} particles{where_}");
            let text = scene(0.5, tables);
            cases.push(if n == 0 {
                let nothing =
                    "there is nothing to model: the scene's tables and its file have no particles";
                Case::refused(what, text, nothing).from(start(&x, 1.0))
            } else {
                Case::new(what, text).from(start(&x, 1.0)).left(x.len())
            });
        }
    }
    for spacing in ["1", "0.5", "0.25"] {
        for precision in ["single", "double"] {
            let keys = "density = 1\ninternal_energy = 0.9\nvelocity = [1, 0.3, 0]";
            let text = full(keys, &format!("[gas.hydro]\nprecision = \"{precision}\"\n"));
            let text = text.replace("0.125\nlattice = \"bcc\"", spacing);
            let what = format!("kernels that reach {spacing} x 2.5 in a unit box, {precision}");
            cases.push(
                Case::new(what, scene(0.5, &text))
                    .momentum(1e-12)
                    .energy(1e-5),
            );
        }
    }
    let flat = full(
        "density = 1\ninternal_energy = 0.9\nvelocity = [1, 0.3, 0]",
        "",
    );
    let flat = flat
        .replace(", 1]", ", 0.125]")
        .replace("lattice = \"bcc\"\n", "");
    let case = Case::new("a box one particle high", scene(0.5, &flat));
    cases.push(case.momentum(1e-12).energy(1e-5));
}

fn places(cases: &mut Vec<Case>) {
    let heap = start(&[0.5 * Vec3::x(); 100], 1.0);
    for (what, tables) in [
        ("", "[gas]\n"),
        (" with gravity", TREE),
        (" of a periodic box", PERIODIC),
    ] {
        let what = format!("100 particles at one place{what}");
        cases.push(Case::refused(what, scene(0.5, tables), NO_KERNEL).from(heap.clone()));
    }
    let plane = grid(20, 1);
    let line: Vec<Vec3> = (0..100).map(|i| f64::from(i) * Vec3::x()).collect();
    for (what, x) in [("plane", &plane), ("line", &line)] {
        for (how, tables) in [("", FREE), (" with gravity", TREE)] {
            let what = format!("gas on a {what}{how}");
            let case = Case::new(what, scene(0.2, tables)).from(start(x, 1.0));
            // The tree leaves an impulse of the size of its error until it is taken back.
            cases.push(case.momentum(2e-10).energy(2e-3).left(x.len()));
        }
    }
    let mut far = plane.clone();
    far.push(Vec3::new(1e12, 0.0, 0.0));
    far.push(Vec3::new(0.0, -1e30, 1e3));
    cases.push(
        Case::refused(
            "a particle 1e30 sizes away",
            scene(2.0, "[gas]\n"),
            NO_KERNEL,
        )
        .from(start(&far, 1.0)),
    );
}

fn ratios(cases: &mut Vec<Case>) {
    let x: Vec<Vec3> = grid(8, 8).iter().map(|x| 0.125 * x).collect();
    let n = x.len();
    let other =
        |a: f64, b: f64| -> Vec<f64> { (0..n).map(|i| if i % 2 == 0 { a } else { b }).collect() };
    let start = |u: f64| start(&x, u);
    let lengths = |a, b| start(1.0).reals(0, "SmoothingLengths", &other(a, b));
    for (what, h) in [
        ("1e-30 and 1", lengths(1e-30, 1.0)),
        ("0", lengths(0.0, 0.0)),
    ] {
        let what = format!("first smoothing lengths of {what}");
        let case = Case::new(what, scene(0.1, PERIODIC)).from(h);
        cases.push(case.momentum(1e-12).energy(1e-5));
    }
    let sentence = "start.hdf5: PartType0: SmoothingLengths: entry 1 (from 0) is 1e30, more than 10 times the periodic box";
    let what = "smoothing lengths of 1e30 in a box of 1";
    cases.push(Case::refused(what, scene(0.1, PERIODIC), sentence).from(lengths(1e-30, 1e30)));
    let case = Case::new("gas without heat", scene(0.5, PERIODIC));
    cases.push(
        case.from(start(0.0))
            .figure("place", 0.0, |e| astray(e, 0.0)),
    );
    let mut u = vec![1.0; n];
    u[n / 2] = 1e24;
    let hot = start(1.0).reals(0, "InternalEnergies", &u);
    let case = Case::new("one particle 1e24 times as hot", scene(1e-10, PERIODIC));
    cases.push(case.from(hot.clone()).momentum(1e-11).energy(1e-2).left(n));
    let text = scene(1.0, PERIODIC);
    cases.push(Case::refused("the same among steps 2^30 times longer", text, STEP).from(hot));
}

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    streams(&mut cases);
    units(&mut cases);
    contrasts(&mut cases);
    numbers(&mut cases);
    places(&mut cases);
    ratios(&mut cases);
    cases
}
