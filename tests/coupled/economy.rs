//! Economy: what a scene leaves out is not in the list of operators, holds no memory and is in no file.

use std::collections::BTreeSet;

use nbody::points::Columns;
use tridisk::assemble::{self, Assembly};
use tridisk::scene::Scene;
use tridisk_tests::subsets::{self, PROCESSES};

use crate::allocator::asked;
use crate::bench;

/// Operators of a scene without processes, in order, and which of self-gravity, gas, dust and bodies brings each.
const OPERATORS: [(&str, [bool; 4]); 8] = [
    ("density", [false, true, false, false]),
    ("gravity", [true, false, false, true]),
    ("kick bodies", [false, false, false, true]),
    ("kick dust", [false, false, true, false]),
    ("kick gas", [false, true, false, false]),
    ("drift gas", [false, true, false, false]),
    ("drift dust", [false, false, true, false]),
    ("drift bodies", [false, false, false, true]),
];

fn assembled(scene: &Scene) -> Assembly {
    let system = assemble::start(scene).unwrap_or_else(|refusal| panic!("{refusal}"));
    assemble::assembly(scene, system).unwrap_or_else(|refusal| panic!("{refusal}"))
}

fn names(subset: [bool; 3], set: &[&str]) -> Vec<&'static str> {
    assembled(&subsets::scene(subset, set, 1)).splitting.names()
}

#[test]
fn a_subset_has_the_operators_of_its_populations() {
    for subset in subsets::all() {
        for gravity in [false, true] {
            let [gas, dust, bodies] = subset;
            let there = [gravity, gas, dust, bodies];
            let brought = |by: &[bool; 4]| by.iter().zip(there).any(|(&by, there)| by && there);
            let wanted = OPERATORS.iter().filter(|(_, by)| brought(by));
            let wanted: Vec<&str> = wanted.map(|(name, _)| *name).collect();
            assert_eq!(names(subset, &subsets::gravity(subset, gravity)), wanted);
        }
    }
}

#[test]
fn a_process_brings_its_own_operators_and_no_others() {
    for subset in subsets::all() {
        let without = subsets::gravity(subset, false);
        let bare = names(subset, &without);
        for process in PROCESSES.iter().filter(|process| process.suits(subset)) {
            let mut with = names(subset, &[&without[..], process.set].concat());
            let has = |name: &&str| with.contains(name);
            assert!(
                process.operators.iter().all(has),
                "{}: {with:?}",
                process.name
            );
            with.retain(|name| !process.operators.contains(name));
            assert_eq!(with, bare, "{}", process.name);
        }
    }
}

#[test]
fn who_is_left_out_holds_no_memory() {
    for subset in subsets::all() {
        let mut trial = subsets::trial(subset, &subsets::gravity(subset, true), 1);
        subsets::run(&mut trial, 1);
        let system = &trial.system;
        let (gas, dust) = (&system.gas, &system.dust);
        let sets: [Vec<&dyn Columns>; 3] = [
            vec![&gas.particles, &gas.derived, &gas.rates],
            vec![&dust.particles, &dust.derived, &dust.rates],
            vec![&system.bodies, &system.star],
        ];
        let reserved = sets.map(|sets| sets.iter().map(|set| set.reserved()).sum::<usize>());
        assert_eq!(reserved.map(|bytes| bytes > 0), subset);
        let trees = [&gas.tree, &dust.tree].map(|tree| tree.nodes.capacity() > 0);
        assert_eq!(trees, subset[..2]);
        let seen = system.seen.x.capacity() + system.pending_bodies.capacity() > 0;
        assert_eq!(seen, subset[2] && (subset[0] || subset[1]));
    }
}

/// Calls for memory in the third step of some work on one thread, and bytes held after it.
fn memory<T: Send>(work: impl Fn(usize) -> T + Sync) -> (i64, i64) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.expect("a pool").install(|| {
        let after = |steps: usize| {
            let before = asked();
            let kept = work(steps);
            let now = asked();
            drop(kept);
            (now.0 as i64 - before.0 as i64, now.1 - before.1)
        };
        // The first time readies the thread itself.
        after(2);
        let (two, three) = (after(2), after(3));
        (three.0 - two.0, three.1)
    })
}

#[test]
fn a_population_by_itself_asks_for_the_memory_that_its_crate_asks_for() {
    for (k, of_crate) in [(0, "gas"), (1, "dust"), (2, "nbody")] {
        let subset = [0, 1, 2].map(|i| i == k);
        let set = subsets::gravity(subset, k == 2);
        let trial = |steps: usize| subsets::trial(subset, &set, steps);
        let (calls, held) = memory(|steps| {
            let mut trial = trial(steps);
            subsets::run(&mut trial, steps);
            trial
        });
        let (own_calls, own_held) = memory(|steps| {
            let mut trial = trial(steps);
            let kept = subsets::alone(&trial.scene, &mut trial.system, steps);
            (trial, kept)
        });
        println!(
            "{of_crate}: {calls} calls a step and {held} bytes, alone {own_calls} and {own_held}"
        );
        assert!(
            calls <= own_calls,
            "{of_crate}: {calls} calls, alone {own_calls}"
        );
        // The books, by operator; no part of it grows with the number of particles.
        assert!(
            held - own_held < 8192,
            "{of_crate}: {held} bytes, alone {own_held}"
        );
    }
}

#[test]
fn files_hold_only_who_is_there() {
    for subset in subsets::all() {
        let set = subsets::gravity(subset, true);
        let scene = subsets::scene(subset, &set, 1);
        let operators: BTreeSet<String> = (assembled(&scene).splitting.names().iter())
            .map(|&name| name.to_owned())
            .collect();
        let done = bench::run_scene(scene);
        let snapshot = done.snapshots().pop().expect("a snapshot");
        let file = hdf5::File::open(&snapshot).expect("a file");
        let groups = file.member_names().expect("names").into_iter();
        let groups: Vec<String> = groups.filter(|name| name.starts_with("PartType")).collect();
        let [gas, dust, bodies] = subset;
        let wanted = [("0", gas), ("1", bodies), ("2", dust), ("4", bodies)];
        let wanted = wanted.iter().filter(|(_, there)| *there);
        let wanted: Vec<String> = wanted.map(|(kind, _)| format!("PartType{kind}")).collect();
        assert_eq!(groups, wanted);
        let text = std::fs::read_to_string(done.path("operators.csv")).expect("a table");
        let booked = text
            .lines()
            .skip(1)
            .filter_map(|line| line.split(',').nth(1));
        let booked = booked.filter(|name| *name != "start");
        let booked: BTreeSet<String> = booked.map(str::to_owned).collect();
        assert!(booked.is_subset(&operators), "{booked:?} of {operators:?}");
        assert!(!done.path("torques.csv").exists());
    }
}
