//! Populations on top of each other and of the star.

use nbody::points::Vec3;

use super::case::Case;
use super::scene;
use super::start::Start;

const ORIGIN: Vec3 = Vec3::new(0.0, 0.0, 0.0);

/// A small ball of gas and grains about a place.
fn ball(centre: Vec3) -> Start {
    let place = |i: i32| {
        centre
            + 0.01
                * Vec3::new(
                    f64::from(i % 5 - 2),
                    f64::from(i / 5 % 5 - 2),
                    f64::from(i / 25 - 2),
                )
    };
    let x: Vec<Vec3> = (0..125).map(place).collect();
    let v = vec![ORIGIN; 125];
    Start::new(0, &x, &v, &[1e-6; 125])
        .reals(0, "InternalEnergies", &[1.0; 125])
        .and(2, &x, &v, &[1e-8; 125])
        .reals(2, "GrainRadii", &[1e-3; 125])
}

const FLUIDS: &str =
    "[gas]\n[dust]\n[dust.drag]\nlaw = \"constant-stopping-time\"\nstopping_time = 0.1\n";

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (radius, left) in [("0", 250), ("0.005", 248), ("1", 0)] {
        let text = format!("[star]\nmass = 1\naccretion_radius = {radius}\n{FLUIDS}");
        let case = Case::new(
            format!("gas and dust about the star's own place, accreted within {radius}"),
            scene(1e-3, &text),
        );
        cases.push(case.from(ball(ORIGIN)).momentum(1e-9).left(left));
        let text = format!("{text}[gravity]\nmethod = \"tree\"\n");
        let case = Case::new(
            format!("the same with gravity, accreted within {radius}"),
            scene(1e-3, &text),
        );
        cases.push(case.from(ball(ORIGIN)).momentum(1e-9).left(left));
    }
    for mass in ["1e-300", "1e-12"] {
        let text = format!("[star]\nmass = {mass}\n{FLUIDS}");
        let case = Case::new(
            format!("gas and dust on a star of {mass}"),
            scene(0.1, &text),
        );
        cases.push(case.from(ball(ORIGIN)).momentum(1e-9).left(250));
    }
    let lone = Start::new(0, &[ORIGIN], &[ORIGIN], &[1e-6]).reals(0, "InternalEnergies", &[1.0]);
    let case = Case::new(
        "a gas particle at the very place of the star",
        scene(1.0, "[star]\nmass = 1\n[gas]\n"),
    );
    cases.push(case.from(lone.clone()));
    let lone = Start::new(2, &[ORIGIN], &[ORIGIN], &[1e-6]);
    let case = Case::new(
        "a grain at the very place of the star",
        scene(1.0, "[star]\nmass = 1\n[dust]\n"),
    );
    cases.push(case.from(lone));
    for name in [
        "leapfrog",
        "wisdom-holman",
        "hybrid",
        "hermite",
        "gauss-radau",
    ] {
        let lone = Start::new(1, &[ORIGIN], &[ORIGIN], &[1e-6]);
        for radius in ["0", "0.1"] {
            let text = format!(
                "[star]\nmass = 1\naccretion_radius = {radius}\n[planetesimals]\nintegrator = \"{name}\"\n"
            );
            let case = Case::new(
                format!("a body at the very place of the star of radius {radius}, {name}"),
                scene(1.0, &text),
            );
            cases.push(case.from(lone.clone()));
        }
        let text = format!(
            "[star]\nmass = 1\naccretion_radius = 0.1\n[planetesimals]\nintegrator = \"{name}\"\n[[planet]]\nmass = 1e-3\nposition = [0.05, 0, 0]\nvelocity = [0, 4.47, 0]\n[[planet]]\nmass = 1e-3\nposition = [1, 0, 0]\nvelocity = [0, 1, 0]\n"
        );
        let case = Case::new(
            format!("a planet that begins inside the star, {name}"),
            scene(1.0, &text),
        );
        cases.push(case.momentum(1e-10).left(1));
        let text = format!(
            "{FLUIDS}[star]\nmass = 1\n[planetesimals]\nintegrator = \"{name}\"\n[[planet]]\nmass = 1e-3\nposition = [1, 0, 0]\nvelocity = [0, 1, 0]\n"
        );
        let case = Case::new(
            format!("a planet at the very place of gas and dust, {name}"),
            scene(0.01, &text),
        );
        cases.push(case.from(ball(Vec3::x())).momentum(1e-9).left(251));
        let text = text.replace("mass = 1e-3", "mass = 0");
        let case = Case::new(
            format!("a massless planet in gas and dust, {name}"),
            scene(0.01, &text),
        );
        cases.push(case.from(ball(Vec3::x())).momentum(1e-9).left(251));
        let drag = text.replace(
            "[planetesimals]\n",
            "[planetesimals]\ndrag.law = \"constant-stopping-time\"\ndrag.stopping_time = 1e-12\n",
        );
        let case = Case::new(
            format!("a massless planet with stiff drag, {name}"),
            scene(0.01, &drag),
        );
        cases.push(case.from(ball(Vec3::x())).momentum(1e-9).left(251));
    }
    // Bodies 1e12 times the gas in mass, with drag.
    for mass in ["1e-18", "1e6"] {
        for time in ["1e-12", "1e12"] {
            let text = format!(
                "{FLUIDS}[planetesimals]\ndrag.law = \"constant-stopping-time\"\ndrag.stopping_time = {time}\n[[planet]]\nmass = {mass}\nposition = [1, 0, 0]\nvelocity = [0, 1, 0]\n[gravity]\nmethod = \"none\"\n"
            );
            let case = Case::new(
                format!("a body of {mass} stopped in {time} by gas of 1e-4"),
                scene(0.01, &text),
            );
            cases.push(case.from(ball(Vec3::x())).momentum(1e-9).left(251));
        }
    }
    // All gas swallowed at once and a run that goes on.
    let text = "[star]\nmass = 1\naccretion_radius = 1\n[gas]\n[dust]\n[dust.drag]\nlaw = \"constant-stopping-time\"\nstopping_time = 0.1\n[planetesimals]\n[[planet]]\nmass = 1e-3\nposition = [2, 0, 0]\nvelocity = [0, 0.7, 0]\n".to_string();
    let case = Case::new(
        "all gas and dust swallowed beside a planet",
        scene(5.0, &text),
    );
    cases.push(case.from(ball(ORIGIN)).momentum(1e-9).left(1));
    for text in [
        "[star]\nmass = 1\n[gas]\n",
        "[star]\nmass = 1\n[gas]\n[dust]\n[planetesimals]\n",
    ] {
        let kinds = if text.contains("dust") {
            vec![0, 1, 2]
        } else {
            vec![0]
        };
        let start = kinds.iter().fold(Start::default(), |start, &kind| {
            start.and(kind, &[], &[], &[])
        });
        let start = start.reals(0, "InternalEnergies", &[]);
        cases.push(
            Case::new(
                format!("populations of nobody: {}", text.replace('\n', " ")),
                scene(1.0, text),
            )
            .from(start)
            .left(0),
        );
    }
    cases
}
