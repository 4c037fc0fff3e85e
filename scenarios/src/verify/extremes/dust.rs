//! Dust at the extremes: stopping times, sizes, numbers, turbulence, growth.

use nbody::points::Vec3;

use super::case::{Case, End};
use super::scene;
use super::start::Start;

/// Gas and grains in a periodic box, the grains moving at unit speed.
fn full(dust: &str, tables: &str) -> String {
    format!(
        "[domain]\nkind = \"periodic\"\nsize = [1, 1, 1]\n[[gas.block]]\nlo = [0, 0, 0]\nhi = [1, 1, 1]\nspacing = 0.125\ndensity = 1\npressure = 1\n\
         [[dust.block]]\nlo = [0, 0, 0]\nhi = [1, 1, 1]\nspacing = 0.25\nlattice = \"random\"\nvelocity = [1, 0, 0]\n{dust}\n{tables}"
    )
}

/// Gas that is a formula about a unit star, with grains in it.
fn formula(dust: &str) -> String {
    format!(
        "[star]\nmass = 1\n[surroundings.disk]\nsurface_density = 1e-4\nreference_radius = 1\naspect_ratio = 0.05\ninner_radius = 0.5\nouter_radius = 2\n[dust]\nparticles = 100\ninner_radius = 0.9\nouter_radius = 1.1\n{dust}"
    )
}

/// The mean velocity of the grains along x.
fn speed(end: &End) -> f64 {
    let v = end.rows(2).v;
    v.iter().map(|v| v.x).sum::<f64>() / v.len() as f64
}

fn drag(cases: &mut Vec<Case>) {
    for time in [1e-300, 1e-12, 1e12, 1e300] {
        for feedback in [true, false] {
            let law = format!(
                "[dust.drag]\nlaw = \"constant-stopping-time\"\nstopping_time = {time:e}\n[coupling]\nfeedback = {feedback}\n"
            );
            let text = scene(0.1, &full("density = 0.5", &law));
            let case = Case::new(
                format!("stopping time {time:e} in a box, feedback {feedback}"),
                text,
            );
            let share = if feedback { 1.0 / 3.0 } else { 0.0 };
            let exact = share + (1.0 - share) * f64::exp(-0.1 / (time * (1.0 - share)));
            cases.push(
                case.momentum(1e-10)
                    .energy(1e-2)
                    .figure("velocity", 0.1, move |e| speed(e) - exact),
            );
        }
        let law =
            format!("[dust.drag]\nlaw = \"constant-stopping-time\"\nstopping_time = {time:e}\n");
        let text = scene(1.0, &formula(&law));
        cases.push(Case::new(
            format!("stopping time {time:e} about a star"),
            text,
        ));
        let law =
            format!("[dust.drag]\nlaw = \"constant-stokes-number\"\nstokes_number = {time:e}\n");
        let text = scene(1.0, &formula(&law));
        cases.push(Case::new(
            format!("Stokes number {time:e} about a star"),
            text,
        ));
    }
    for law in [
        "law = \"quadratic\"\ncoefficient = 1e-300",
        "law = \"quadratic\"\ncoefficient = 1e300",
        "law = \"epstein\"",
    ] {
        for size in ["1e-300", "1e300"] {
            let text = full(
                "density = 0.5",
                &format!("[dust]\nsize = {size}\n[dust.drag]\n{law}\n"),
            );
            cases.push(
                Case::new(format!("{law}, size {size}"), scene(0.1, &text))
                    .momentum(1e-11)
                    .energy(1e-2),
            );
        }
    }
    for density in ["1e-300", "1e-8", "1e8", "1e300"] {
        let law = "[dust.drag]\nlaw = \"constant-stopping-time\"\nstopping_time = 0.01\n";
        let text = full(&format!("density = {density}"), law);
        cases.push(
            Case::new(format!("dust to gas {density}"), scene(0.1, &text))
                .momentum(1e-11)
                .energy(1e-2),
        );
    }
}

fn sizes(cases: &mut Vec<Case>) {
    let sizes = |min: &str, max: &str, slope: &str| {
        format!(
            "size = {{ min = {min}, max = {max}, slope = {slope} }}\n[dust.drag]\nlaw = \"epstein\"\n"
        )
    };
    cases.push(Case::refused(
        "sizes from a value to itself",
        scene(1.0, &formula(&sizes("1e-3", "1e-3", "-3.5"))),
        "",
    ));
    for (min, max, slope) in [
        ("1e-300", "1e300", "-3.5"),
        ("1e-6", "1e6", "-4"),
        ("1e-6", "1e6", "-1e3"),
        ("1e-6", "1e6", "1e3"),
        ("1", "1.0000000000000002", "-3.5"),
    ] {
        let text = scene(0.5, &formula(&sizes(min, max, slope)));
        cases.push(Case::new(
            format!("sizes from {min} to {max} of slope {slope}"),
            text,
        ));
    }
    let x = [Vec3::x(), 1.1 * Vec3::x()];
    let v = [Vec3::y(), 0.9 * Vec3::y()];
    for (what, size) in [("0", 0.0), ("5e-324", 5e-324), ("1e300", 1e300)] {
        for law in ["epstein", "auto", "stokes"] {
            let text = format!(
                "[star]\nmass = \"1 Msun\"\n[surroundings.disk]\nsurface_density = \"1700 g/cm^2\"\nreference_radius = 1\naspect_ratio = 0.05\ninner_radius = 0.5\nouter_radius = 2\n[dust]\n[dust.drag]\nlaw = \"{law}\"\n"
            );
            let text = scene(0.5, &text).replace("[units]\nsystem = \"dimensionless\"\n", "");
            let start = Start::new(2, &x, &v, &[1e-9; 2]).reals(2, "GrainRadii", &[size; 2]);
            cases.push(
                Case::new(format!("grains of size {what}, {law}"), text)
                    .from(start)
                    .left(2),
            );
        }
    }
    let start = Start::new(2, &x, &v, &[1e-9; 2])
        .reals(2, "GrainRadii", &[1e-6; 2])
        .reals(2, "GrainDensities", &[0.0; 2]);
    let text = formula("[dust.drag]\nlaw = \"epstein\"\n").replace(
        "particles = 100\ninner_radius = 0.9\nouter_radius = 1.1\n",
        "",
    );
    cases.push(
        Case::new("grains of density 0", scene(0.5, &text))
            .from(start.clone())
            .left(2),
    );
    let start = start.reals(2, "GrainDensities", &[-1.0; 2]);
    cases.push(Case::new("grains of density -1", scene(0.5, &text)).from(start));
}

fn numbers(cases: &mut Vec<Case>) {
    for n in [0, 1, 2] {
        let x: Vec<Vec3> = (1..=n).map(|i| f64::from(i) * 0.3 * Vec3::x()).collect();
        let n = x.len();
        let start = Start::new(2, &x, &vec![0.1 * Vec3::y(); n], &vec![1e-9; n]);
        let case = Case::new(format!("{n} grains alone"), scene(0.5, "[dust]\n"));
        cases.push(case.from(start.clone()).momentum(1e-12).left(n));
        let text = "[dust]\n[domain]\nkind = \"periodic\"\nsize = [1, 1, 1]\n[[gas.block]]\nlo = [0, 0, 0]\nhi = [1, 1, 1]\nspacing = 0.25\ndensity = 1\npressure = 1\n[dust.drag]\nlaw = \"constant-stopping-time\"\nstopping_time = 0.1\n";
        let case = Case::new(format!("{n} grains in gas"), scene(0.5, text));
        cases.push(case.from(start.clone()).momentum(1e-12).left(n + 64));
        let case = Case::new(
            format!("{n} grains that pull each other"),
            scene(0.5, "[dust]\n[gravity]\nmethod = \"tree\"\n"),
        );
        cases.push(case.from(start.clone()).momentum(1e-12).left(n));
        let case = Case::new(
            format!("{n} grains in a shearing box"),
            scene(
                0.5,
                "[dust]\n[domain]\nkind = \"shearing-box\"\nsize = [1, 1, 1]\nrate = 1\n",
            ),
        );
        cases.push(case.from(start.clone()).left(n));
        let gas = start
            .clone()
            .and(0, &[Vec3::repeat(0.2)], &[Vec3::zeros()], &[1.0])
            .reals(0, "InternalEnergies", &[1.0]);
        let text =
            "[dust]\n[gas]\n[dust.drag]\nlaw = \"constant-stopping-time\"\nstopping_time = 0.1\n";
        let case = Case::new(format!("{n} grains and one gas particle"), scene(0.5, text));
        cases.push(case.from(gas).momentum(1e-12).left(n + 1));
    }
    let heap = Start::new(2, &[Vec3::x(); 100], &[Vec3::y(); 100], &[1e-3; 100]);
    for tables in ["", "[gravity]\nmethod = \"tree\"\n", "[star]\nmass = 1\n"] {
        let case = Case::new(
            format!("100 grains at one place {tables}"),
            scene(0.5, &format!("[dust]\n{tables}")),
        );
        cases.push(case.from(heap.clone()).momentum(1e-12).left(100));
    }
    let start = Start::new(
        2,
        &[Vec3::x(), 2.0 * Vec3::x()],
        &[Vec3::y(); 2],
        &[0.0, 0.0],
    );
    let case = Case::new(
        "grains without mass",
        scene(0.5, "[dust]\n[star]\nmass = 1\n"),
    );
    cases.push(case.from(start.clone()).left(2));
    let text =
        "[dust]\n[gas]\n[dust.drag]\nlaw = \"constant-stopping-time\"\nstopping_time = 0.1\n";
    let gas = start
        .and(0, &[Vec3::repeat(0.2)], &[Vec3::zeros()], &[1.0])
        .reals(0, "InternalEnergies", &[1.0]);
    let case = Case::new("grains without mass in gas", scene(0.5, text));
    cases.push(case.from(gas).momentum(1e-12).left(3));
}

fn turbulence(cases: &mut Vec<Case>) {
    for alpha in ["0", "1e-300", "1"] {
        for stokes in ["1e-12", "1", "1e12"] {
            let text = formula(&format!(
                "[dust.drag]\nlaw = \"constant-stokes-number\"\nstokes_number = {stokes}\n[dust.turbulence]\nalpha = {alpha}\n"
            ));
            cases.push(Case::new(
                format!("turbulence alpha {alpha}, Stokes number {stokes}"),
                scene(1.0, &text),
            ));
        }
    }
}

fn growth(cases: &mut Vec<Case>) {
    let grow = |particles: &str, keys: &str| {
        let text = formula(&format!("{keys}\n"))
            .replace("particles = 100", &format!("particles = {particles}"));
        let text = text
            .replace(
                "surface_density = 1e-4",
                "surface_density = \"1700 g/cm^2\"",
            )
            .replace("mass = 1\n", "mass = \"1 Msun\"\n");
        scene(1.0, &text).replace("[units]\nsystem = \"dimensionless\"\n", "")
    };
    for particles in ["1", "2", "100"] {
        for size in ["\"1 um\"", "\"1e-12 um\"", "\"1 km\""] {
            let text = grow(
                particles,
                &format!("size = {size}\n[dust.growth]\nalpha = 1e-3"),
            );
            cases.push(Case::new(
                format!("growth of {particles} swarms of {size}"),
                text,
            ));
        }
    }
    let text = grow(
        "100",
        "size = { min = \"1 nm\", max = \"1 m\" }\n[dust.growth]\nalpha = 1e-3",
    );
    cases.push(Case::new("growth of masses 1e27 apart", text));
    for keys in [
        "alpha = 0\nbrownian = false",
        "alpha = 1",
        "alpha = 1e-3\nfragmentation_speed = 1e-300",
        "alpha = 1e-3\nfragmentation_speed = \"1 m/s\"\nmonomer_radius = \"0.1 um\"",
        "alpha = 1e-3\nporosity = true\nmonomer_radius = \"0.1 um\"",
    ] {
        let text = grow("100", &format!("size = \"1 um\"\n[dust.growth]\n{keys}"));
        cases.push(Case::new(format!("growth, {keys}"), text));
    }
    for kernel in ["constant", "sum", "product"] {
        for rate in ["1e-300", "1", "1e300"] {
            let text = format!(
                "[domain]\nkind = \"periodic\"\nsize = [1, 1, 1]\n[dust]\nsize = 1e-3\n[[dust.block]]\nlo = [0, 0, 0]\nhi = [1, 1, 1]\nspacing = 0.2\ndensity = 1\n[dust.growth]\nkernel = \"{kernel}\"\nrate = {rate}\n"
            );
            cases.push(
                Case::new(format!("kernel {kernel} of rate {rate}"), scene(1.0, &text)).left(125),
            );
        }
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
