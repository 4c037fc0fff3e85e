//! Populations on top of each other and of the star.

use nbody::points::Vec3;

use super::case::{Case, End};
use super::scene;
use super::start::Start;

const ORIGIN: Vec3 = Vec3::new(0.0, 0.0, 0.0);

const INTEGRATORS: [&str; 5] = [
    "leapfrog",
    "wisdom-holman",
    "hybrid",
    "hermite",
    "gauss-radau",
];

const FLUIDS: &str =
    "[gas]\n[dust]\n[dust.drag]\nlaw = \"constant-stopping-time\"\nstopping_time = 0.1\n";

const TREE: &str = "[gravity]\nmethod = \"tree\"\n";

/// What stands in the star.
const INSIDE: &str = "~ particle ~ stands at the very place of the star, where its pull has no value: move it, or give star.accretion_radius";

/// A small ball of gas and grains on each other about a place.
fn ball(centre: Vec3) -> Start {
    let of = |i: i32| [i % 5, i / 5 % 5, i / 25];
    let place = |i: i32| centre + Vec3::from_fn(|axis, _| 0.01 * f64::from(of(i)[axis] - 2));
    let x: Vec<Vec3> = (0..125).map(place).collect();
    let v = vec![ORIGIN; 125];
    Start::new(0, &x, &v, &[1e-6; 125])
        .reals(0, "InternalEnergies", &[1.0; 125])
        .and(2, &x, &v, &[1e-8; 125])
}

fn star(mass: &str, radius: &str) -> String {
    format!("[star]\nmass = {mass}\naccretion_radius = {radius}\n")
}

/// Keeps momentum, and has a star of unit mass swallow `mass` at rest: roundings of the sums, and of pulls that cancel.
fn fed(case: Case, mass: f64) -> Case {
    let gained = move |end: &End| (end.final_value("mass_star") - 1.0) / mass - 1.0;
    let speed = |end: &End| end.rows(4).v[0].norm();
    let case = case.momentum(1e-12).figure("mass swallowed", 1e-9, gained);
    case.figure("speed of the star", 1e-15, speed)
}

fn on_the_star(cases: &mut Vec<Case>) {
    for gravity in ["", TREE] {
        let text = |radius: &str| scene(1e-3, &(star("1", radius) + FLUIDS + gravity));
        let how = if gravity.is_empty() {
            ""
        } else {
            " with gravity"
        };
        let what = format!("gas and dust at the star's own place{how}");
        cases.push(Case::refused(what, text("0"), INSIDE).from(ball(ORIGIN)));
        // One of each stands in the star.
        for (radius, left, mass) in [("0.001", 248, 1.01e-6), ("1", 0, 125.0 * 1.01e-6)] {
            let what = format!("the same{how}, accreted within {radius}");
            let case = Case::new(what, text(radius)).from(ball(ORIGIN));
            cases.push(fed(case, mass).left(left));
        }
        let aside = ball(Vec3::repeat(0.005));
        let what = format!("gas and dust about the star{how}");
        let soon = text("0").replace("end_time = 1e-3", "end_time = 1e-4");
        cases.push(
            Case::new(what, soon)
                .from(aside.clone())
                .momentum(1e-12)
                .left(250),
        );
        let light = scene(0.1, &(star("1e-100", "0") + FLUIDS + gravity));
        let what = format!("gas and dust about a star of 1e-100{how}");
        cases.push(Case::new(what, light).from(aside).momentum(1e-9).left(250));
    }
    for (kind, name) in [(0, "gas"), (1, "planetesimals"), (2, "dust")] {
        let lone = Start::new(kind, &[ORIGIN], &[ORIGIN], &[1e-6]);
        let lone = if kind == 0 {
            lone.reals(0, "InternalEnergies", &[1.0])
        } else {
            lone
        };
        let text = |radius: &str| scene(1.0, &format!("{}[{name}]\n", star("1", radius)));
        let what = format!("{name} at the very place of the star");
        cases.push(Case::refused(what.clone(), text("0"), INSIDE).from(lone.clone()));
        let case = Case::new(format!("{what}, which swallows"), text("0.1")).from(lone);
        cases.push(fed(case, 1e-6).left(0));
    }
    let text = star("1", "1")
        + FLUIDS
        + "[[planet]]\nmass = 1e-3\nposition = [2, 0, 0]\nvelocity = [0, 0.7, 0]\n";
    let case = Case::new(
        "all gas and dust swallowed beside a planet",
        scene(5.0, &text),
    );
    cases.push(case.from(ball(ORIGIN)).momentum(1e-9).left(1));
}

fn on_planets(cases: &mut Vec<Case>) {
    for name in INTEGRATORS {
        let head = |radius: &str| {
            format!(
                "{}[planetesimals]\nintegrator = \"{name}\"\n",
                star("1", radius)
            )
        };
        let text = head("0.1")
            + "[[planet]]\nmass = 1e-3\nposition = [0.05, 0, 0]\nvelocity = [0, 4.47, 0]\n[[planet]]\nmass = 1e-3\nposition = [1, 0, 0]\nvelocity = [0, 1, 0]\n";
        let case = Case::new(
            format!("a planet that begins inside the star, {name}"),
            scene(1.0, &text),
        );
        cases.push(case.momentum(1e-12).left(1));
        let planet = |mass: &str| {
            format!("[[planet]]\nmass = {mass}\nposition = [1, 0, 0]\nvelocity = [0, 1, 0]\n")
        };
        for mass in ["1e-3", "0", "1e-24"] {
            let text = scene(1e-3, &(head("0") + FLUIDS + &planet(mass)));
            let what = format!("a planet of {mass} at the very place of gas and dust, {name}");
            let case = Case::new(what, text).from(ball(Vec3::x()));
            cases.push(case.momentum(1e-9).left(251));
        }
    }
    for mass in ["0", "1e-18", "1e6"] {
        for time in ["1e-12", "1e12"] {
            let text = format!(
                "{FLUIDS}[planetesimals]\nintegrator = \"leapfrog\"\ndrag = {{ law = \"constant-stopping-time\", stopping_time = {time} }}\n[[planet]]\nmass = {mass}\nposition = [1, 0, 0]\nvelocity = [0, 1, 0]\n[gravity]\nmethod = \"none\"\n"
            );
            let what = format!("a body of {mass} stopped in {time} by gas of 1e-4");
            let case = Case::new(what, scene(0.01, &text)).from(ball(Vec3::x()));
            cases.push(case.momentum(1e-9).left(251));
        }
    }
}

fn nobody(cases: &mut Vec<Case>) {
    for (what, kinds, tables) in [
        ("no gas", &[0][..], "[gas]\n"),
        ("no dust", &[2], "[dust]\n"),
        ("no bodies", &[1], "[planetesimals]\n"),
        (
            "no gas, no dust, no bodies",
            &[0, 1, 2],
            "[gas]\n[dust]\n[planetesimals]\n",
        ),
    ] {
        let start = kinds.iter().fold(Start::default(), |start, &kind| {
            start.and(kind, &[], &[], &[])
        });
        let start = if kinds.contains(&0) {
            start.reals(0, "InternalEnergies", &[])
        } else {
            start
        };
        let text = scene(1.0, &(star("1", "0") + tables));
        cases.push(
            Case::new(format!("a star and {what}"), text)
                .from(start)
                .left(0),
        );
    }
}

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    on_the_star(&mut cases);
    on_planets(&mut cases);
    nobody(&mut cases);
    cases
}
