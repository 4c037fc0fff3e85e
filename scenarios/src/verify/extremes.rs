//! Extremes: scenes at the edges of what can be written down, each of which runs and keeps what must be kept, or is refused in one sentence.

mod bodies;
pub(super) mod case;
mod disks;
mod dust;
mod files;
mod gas;
mod inputs;
mod mixed;
mod start;

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::{panic, thread};

use self::case::Case;
pub use self::case::Judgement;
use super::{Problem, Rows};

/// Cases that run at one time: most are too small for more than one processor.
const ABREAST: usize = 2;

const fn of(name: &'static str, about: &'static str, cases: fn() -> Vec<Case>) -> Problem {
    Problem {
        name,
        about,
        rows: Rows::Cases(cases),
    }
}

pub const PROBLEMS: &[Problem] = &[
    of(
        "extremes-bodies",
        "bodies of any mass, size, orbit and number",
        bodies::cases,
    ),
    of(
        "extremes-gas",
        "gas of any speed, density, size, number and cooling",
        gas::cases,
    ),
    of(
        "extremes-disks",
        "gas disks of any cooling, viscosity, thickness and width",
        disks::cases,
    ),
    of(
        "extremes-dust",
        "dust of any stopping time, size, number and turbulence, grains that grow",
        dust::cases,
    ),
    of(
        "extremes-mixed",
        "populations on top of each other and of the star",
        mixed::cases,
    ),
    of(
        "extremes-inputs",
        "numbers in scenes that no run could follow",
        inputs::cases,
    ),
    of(
        "extremes-files",
        "files whose columns hold what is no number, or too much of one",
        files::cases,
    ),
];

/// Runs the cases of the problem `name`, those that take long if `long`; calls `told` for each in their order.
pub fn judge(name: &str, long: bool, mut told: impl FnMut(&Judgement)) -> bool {
    let found = PROBLEMS.iter().find(|problem| problem.name == name);
    let Some(Rows::Cases(cases)) = found.map(|problem| &problem.rows) else {
        panic!("{name} is one of the extremes");
    };
    let mut kept = true;
    for judgement in judgements(cases(), long) {
        told(&judgement);
        kept &= judgement.kept;
    }
    kept
}

/// How all cases came out, in their order.
pub(super) fn judgements(mut cases: Vec<Case>, long: bool) -> Vec<Judgement> {
    cases.retain(|case| long || !case.is_long);
    let (next, found) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let work = || {
        while let Some((place, case)) = {
            let place = next.fetch_add(1, Ordering::Relaxed);
            cases.get(place).map(|case| (place, case))
        } {
            let judgement = case.judgement();
            let mut found = found.lock().expect("nobody panics with it");
            found.push((place, judgement));
        }
    };
    thread::scope(|scope| (0..ABREAST).for_each(|_| drop(scope.spawn(work))));
    let mut found = found.into_inner().expect("nobody panics with it");
    found.sort_by_key(|(place, _)| *place);
    found.into_iter().map(|(_, judgement)| judgement).collect()
}

/// Runs cases and prints a table of them; the verdicts.
pub(super) fn table(cases: Vec<Case>) -> Vec<&'static str> {
    println!("| case | must hold | measured | |");
    println!("| --- | --- | --- | --- |");
    let hook = panic::take_hook();
    panic::set_hook(Box::new(|broken| eprintln!("{broken}")));
    let judgements = judgements(cases, true);
    panic::set_hook(hook);
    let verdict = |kept| if kept { "good" } else { "FAILED" };
    let each = judgements.iter().map(|j| {
        let verdict = verdict(j.kept);
        println!(
            "| {} | {} | {} | {verdict} |",
            j.name, j.must_hold, j.measured
        );
        verdict
    });
    each.collect()
}

/// The head of a dimensionless scene that ends at `end`, with further tables.
fn scene(end: f64, tables: &str) -> String {
    format!(
        "[run]\nend_time = {end:e}\nsnapshots = []\n[units]\nsystem = \"dimensionless\"\n{tables}"
    )
}
