//! Dust at the extremes: stopping times, sizes, numbers, turbulence, growth.

use nbody::points::Vec3;

use super::case::{Case, End};
use super::scene;
use super::start::Start;

/// Gas and grains in a periodic box, the grains moving at unit speed.
fn full(dust: &str, tables: &str) -> String {
    format!(
        "[domain]\nkind = \"periodic\"\nsize = [1, 1, 1]\n[[gas.block]]\nlo = [0, 0, 0]\nhi = [1, 1, 1]\nspacing = 0.125\ndensity = 1\npressure = 1\n\
         [[dust.block]]\nlo = [0, 0, 0]\nhi = [1, 1, 1]\nspacing = 0.125\nvelocity = [1, 0, 0]\n{dust}\n{tables}"
    )
}

/// Gas that is a formula about a unit star, with a hundred grains in it.
fn formula(dust: &str) -> String {
    format!(
        "[star]\nmass = 1\n[surroundings.disk]\nsurface_density = 1e-4\nreference_radius = 1\naspect_ratio = 0.05\ninner_radius = 0.5\nouter_radius = 2\n[dust]\nparticles = 100\ninner_radius = 0.9\nouter_radius = 1.1\n{dust}"
    )
}

/// The same of a solar nebula in astronomical units.
fn nebula(dust: &str, particles: usize) -> String {
    let text = scene(1.0, &formula(dust));
    text.replace("[units]\nsystem = \"dimensionless\"\n", "")
        .replace("= 1e-4", "= \"1700 g/cm^2\"")
        .replace("particles = 100", &format!("particles = {particles}"))
}

/// The mean velocity of the grains along x.
fn speed(end: &End) -> f64 {
    let v = end.rows(2).v;
    v.iter().map(|v| v.x).sum::<f64>() / v.len() as f64
}

/// By how much the distances of grains from the axis have changed.
fn changes(end: &End) -> Vec<f64> {
    let (a, b) = (end.start(2), end.rows(2));
    let place = |id: &u64| b.id.iter().position(|other| other == id);
    let radius = |x: Vec3| x.xy().norm();
    let change = |(i, id): (usize, &u64)| {
        place(id).map_or(f64::NAN, |j| (radius(b.x[j]) - radius(a.x[i])).abs())
    };
    a.id.iter().enumerate().map(change).collect()
}

/// The largest change of a grain's distance from the star.
fn drifted(end: &End) -> f64 {
    let all = changes(end).into_iter();
    all.fold(0.0, |a: f64, b| if a >= b { a } else { b })
}

/// The same, root mean square.
fn walked(end: &End) -> f64 {
    let all = changes(end);
    (all.iter().map(|x| x * x).sum::<f64>() / all.len() as f64).sqrt()
}

fn law(key: &str, value: f64) -> String {
    let name = key.replace('_', "-");
    format!("[dust.drag]\nlaw = \"constant-{name}\"\n{key} = {value:e}\n")
}

fn drag(cases: &mut Vec<Case>) {
    for time in [1e-100, 1e-12, 1.0, 1e12, 1e100] {
        for feedback in [true, false] {
            let coupling = format!("[coupling]\nfeedback = {feedback}\n");
            let text = full("density = 0.5", &(law("stopping_time", time) + &coupling));
            let what = format!("stopping time {time:e} in a box, feedback {feedback}");
            let share = if feedback { 1.0 / 3.0 } else { 0.0 };
            let exact = share + (1.0 - share) * f64::exp(-0.1 / (time * (1.0 - share)));
            let case = Case::new(what, scene(0.1, &text))
                .momentum(1e-12)
                .energy(1e-9);
            cases.push(case.figure("velocity", 1e-9, move |e| speed(e) - exact));
        }
        for key in ["stopping_time", "stokes_number"] {
            let text = scene(1.0, &formula(&law(key, time)));
            let case = Case::new(format!("{key} {time:e} of grains about a star"), text);
            // A few eta = 1.25 h^2 or more, by height: 1.6e-2 at St = 1, measured.
            cases.push(case.figure("change of radius", 3.2e-2, drifted));
        }
    }
    for density in [1e-100, 1e-8, 1e8, 1e40] {
        let text = full(
            &format!("density = {density:e}"),
            &law("stopping_time", 0.01),
        );
        let case = Case::new(format!("dust to gas {density:e}"), scene(0.1, &text));
        let share = density / (1.0 + density);
        let exact = share + (1.0 - share) * f64::exp(-10.0 * (1.0 + density));
        let case = case.momentum(1e-12).energy(1e-9);
        cases.push(case.figure("velocity", 1e-9, move |e| speed(e) - exact));
    }
    for size in ["1e-100", "1e100"] {
        let text = full("density = 0.5", &format!("[dust]\nsize = {size}\n"));
        let case = Case::new(format!("grains of size {size} in a box"), scene(0.1, &text));
        cases.push(case.momentum(1e-12).energy(1e-9));
    }
}

fn sizes(cases: &mut Vec<Case>) {
    let range = |min: &str, max: &str, slope: &str| {
        scene(
            0.5,
            &formula(&format!(
                "size = {{ min = {min}, max = {max}, slope = {slope} }}\n"
            )),
        )
    };
    cases.push(Case::refused(
        "sizes from a value to itself",
        range("1e-3", "1e-3", "-3.5"),
        "case.toml:18: dust.size.min = 1e-3: must be less than dust.size.max",
    ));
    for (min, max, slope) in [
        ("1e-100", "1e100", "-3.5"),
        ("1e-6", "1e6", "-4"),
        ("1e-6", "1e6", "-1e3"),
        ("1e-6", "1e6", "1e3"),
        ("1", "1.0000000000000002", "-3.5"),
    ] {
        let what = format!("sizes from {min} to {max} of slope {slope}");
        let (lo, hi): (f64, f64) = (
            min.parse().unwrap_or(f64::NAN),
            max.parse().unwrap_or(f64::NAN),
        );
        let outside = move |end: &End| {
            let rows = end.rows(2);
            let radii = rows.more.get("GrainRadii").cloned().unwrap_or_default();
            let inside = |a: &&f64| (lo * (1.0 - 1e-12)..=hi * (1.0 + 1e-12)).contains(*a);
            radii.len() as f64 - radii.iter().filter(inside).count() as f64
        };
        cases.push(Case::new(what, range(min, max, slope)).left(100).figure(
            "sizes outside",
            0.0,
            outside,
        ));
    }
    let pair = Start::new(
        2,
        &[Vec3::x(), 1.1 * Vec3::x()],
        &[Vec3::y(), 0.9 * Vec3::y()],
        &[1e-9; 2],
    );
    const FILE: &str = "particles = 100\ninner_radius = 0.9\nouter_radius = 1.1\n";
    for law in ["epstein", "stokes", "auto", "adachi"] {
        let text = nebula(&format!("[dust.drag]\nlaw = \"{law}\"\n"), 100).replace(FILE, "");
        for (size, density) in [(1e-100, 1.0), (1e60, 1.0), (1.0, 1e-100), (1e-6, 1e60)] {
            let start = pair.clone().reals(2, "GrainRadii", &[size; 2]).reals(
                2,
                "GrainDensities",
                &[density; 2],
            );
            let case = Case::new(
                format!("grains of size {size:e} and density {density:e}, {law}"),
                text.clone(),
            );
            cases.push(case.from(start).left(2));
        }
        let start = pair.clone().reals(2, "GrainRadii", &[0.0; 2]);
        cases.push(Case::refused(
            format!("grains without a size, {law}"),
            text,
            "start.hdf5: PartType2: GrainRadii: entry 0 (from 0) is 0, but the law of drag asks for the size and the density of grains",
        ).from(start));
    }
    let text = nebula("[dust.drag]\nlaw = \"epstein\"\n", 100).replace(FILE, "");
    let sized = pair.reals(2, "GrainRadii", &[1e-12; 2]);
    let start = sized.clone().reals(2, "GrainDensities", &[0.0; 2]);
    let sentence = "start.hdf5: PartType2: GrainDensities: entry 0 (from 0) is 0, but the law of drag asks for the size and the density of grains";
    cases.push(Case::refused("grains without a density", text, sentence).from(start));
}

fn numbers(cases: &mut Vec<Case>) {
    let drag = law("stopping_time", 0.1);
    for n in [0, 1, 2] {
        let x: Vec<Vec3> = (1..=n).map(|i| f64::from(i) * 0.3 * Vec3::x()).collect();
        let n = x.len();
        let start = Start::new(2, &x, &vec![0.1 * Vec3::y(); n], &vec![1e-9; n]);
        let shearing = "[dust]\n[domain]\nkind = \"shearing-box\"\nsize = [1, 1, 1]\nrate = 1\n";
        for (where_, tables) in [
            ("alone", "[dust]\n"),
            (
                "that pull each other",
                "[dust]\n[gravity]\nmethod = \"tree\"\n",
            ),
            ("in a shearing box", shearing),
        ] {
            let (what, text) = (format!("{n} grains {where_}"), scene(0.5, tables));
            let nothing =
                "there is nothing to model: the scene's tables and its file have no particles";
            cases.push(match n {
                0 => Case::refused(what, text, nothing).from(start.clone()),
                _ => Case::new(what, text).from(start.clone()).left(n),
            });
        }
        let gas = full("", &format!("[dust]\n{drag}")).replace("0.125", "0.25");
        let block = gas.find("[[dust").unwrap_or(0)..gas.find("[dust]").unwrap_or(0);
        let text = scene(0.5, &gas.replace(&gas[block], ""));
        let case = Case::new(format!("{n} grains in gas"), text).from(start.clone());
        cases.push(case.momentum(1e-12).left(n + 64));
        let one = start.and(0, &[Vec3::repeat(0.2)], &[Vec3::zeros()], &[1.0]);
        let one = one.reals(0, "InternalEnergies", &[1.0]);
        let text = scene(0.5, &format!("[gas]\n[dust]\n{drag}"));
        let case = Case::new(format!("{n} grains and one gas particle"), text).from(one);
        cases.push(case.momentum(1e-12).left(n + 1));
    }
    let heap = Start::new(2, &[Vec3::x(); 100], &[Vec3::y(); 100], &[1e-3; 100]);
    for (what, tables) in [
        ("", ""),
        (" with gravity", "[gravity]\nmethod = \"tree\"\n"),
        (" about a star", "[star]\nmass = 1\n"),
    ] {
        let case = Case::new(
            format!("100 grains at one place{what}"),
            scene(0.5, &format!("[dust]\n{tables}")),
        );
        cases.push(case.from(heap.clone()).momentum(1e-12).left(100));
    }
    let light = Start::new(2, &[Vec3::x(), 2.0 * Vec3::x()], &[Vec3::y(); 2], &[0.0; 2]);
    let gas = light
        .and(0, &[Vec3::repeat(0.2)], &[Vec3::zeros()], &[1.0])
        .reals(0, "InternalEnergies", &[1.0]);
    let case = Case::new(
        "grains without mass in gas",
        scene(0.5, &format!("[gas]\n[dust]\n{drag}")),
    );
    cases.push(case.from(gas).momentum(1e-12).left(3));
}

fn turbulence(cases: &mut Vec<Case>) {
    for alpha in ["0", "1e-100", "1"] {
        for stokes in [1e-12, 1.0, 1e12] {
            let text = formula(&format!(
                "{}[dust.turbulence]\nalpha = {alpha}\n",
                law("stokes_number", stokes)
            ));
            let what = format!("turbulence of alpha {alpha}, Stokes number {stokes:e}");
            let case = Case::new(what, scene(1.0, &text)).left(100);
            // Those that the gas carries walk as sqrt(2 alpha c H t / (1 + St^2)), five standard errors of 100 grains; others as above.
            cases.push(if alpha == "1" && stokes <= 1.0 {
                let exact = 0.05 * (2.0 / (1.0 + stokes * stokes)).sqrt();
                case.figure("walk, relative", 0.35, move |e| walked(e) / exact - 1.0)
            } else {
                case.figure("change of radius", 3.2e-2, drifted)
            });
        }
    }
}

/// What growth refuses.
const CROWDED: &str = "dust body ~ cannot be moved at time ~: in ~ cells of grains more than 1e9 collisions would fall into a step of ~; the snapshots and the last checkpoint stay valid";

fn growth(cases: &mut Vec<Case>) {
    for particles in [1, 2, 100] {
        for size in ["1 um", "1 km"] {
            let text = nebula(
                &format!("size = \"{size}\"\n[dust.growth]\nalpha = 1e-3\n"),
                particles,
            );
            cases.push(
                Case::new(format!("growth of {particles} swarms of {size}"), text).left(particles),
            );
        }
    }
    let text = nebula("size = \"1e-12 um\"\n[dust.growth]\nalpha = 1e-3\n", 100);
    cases.push(Case::refused("growth from 1e-12 um", text, CROWDED));
    let text = nebula(
        "size = { min = \"1e-3 um\", max = \"1 m\" }\n[dust.growth]\nalpha = 1e-3\n",
        100,
    );
    cases.push(Case::new("growth of masses 1e27 apart", text).left(100));
    for (what, keys) in [
        ("without motion", "alpha = 0\nbrownian = false"),
        ("at alpha 1", "alpha = 1"),
        (
            "that breaks at 1e-12 m/s",
            "alpha = 1e-3\nmonomer_radius = \"0.1 um\"\nfragmentation_speed = \"1e-12 m/s\"",
        ),
        (
            "of porous grains",
            "alpha = 1e-3\nporosity = true\nmonomer_radius = \"0.1 um\"",
        ),
    ] {
        let text = nebula(&format!("size = \"1 um\"\n[dust.growth]\n{keys}\n"), 100);
        cases.push(Case::new(format!("growth {what}"), text).left(100));
    }
    for kernel in ["constant", "sum", "product"] {
        let text = |rate: &str| {
            let text = format!(
                "[domain]\nkind = \"periodic\"\nsize = [1, 1, 1]\n[dust]\nsize = 1e-3\n[[dust.block]]\nlo = [0, 0, 0]\nhi = [1, 1, 1]\nspacing = 0.2\ndensity = 1\n[dust.growth]\nkernel = \"{kernel}\"\nrate = {rate}\n"
            );
            scene(1.0, &text)
        };
        let case = Case::new(format!("kernel {kernel} of rate 1e-100"), text("1e-100"));
        cases.push(case.left(125));
        cases.push(Case::refused(
            format!("kernel {kernel} of rate 1e100"),
            text("1e100"),
            CROWDED,
        ));
    }
}

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    drag(&mut cases);
    sizes(&mut cases);
    numbers(&mut cases);
    turbulence(&mut cases);
    growth(&mut cases);
    cases
}
