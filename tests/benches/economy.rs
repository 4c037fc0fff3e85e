//! What each subset of populations costs, and each process in a scene of all: `cargo bench -p tridisk-tests --bench economy`.
//!
//! 1728 particles a population, one thread: operators, instructions a particle of all and step (valgrind), bytes that the scene holds a particle after
//! two steps, calls for memory in the second step.

#[path = "../allocator.rs"]
#[expect(dead_code, reason = "other tests watch several threads")]
mod allocator;

use allocator::asked;
use tridisk::assemble;
use tridisk_tests::counted;
use tridisk_tests::subsets::{self, PROCESSES};

/// Calls for memory and bytes held after so many steps.
fn memory(subset: [bool; 3], set: &[&str], steps: usize) -> [f64; 2] {
    let before = asked();
    let mut trial = subsets::trial(subset, set, steps);
    subsets::run(&mut trial, steps);
    let now = asked();
    drop(trial);
    [(now.0 - before.0) as f64, (now.1 - before.1) as f64]
}

/// A row of the table; `more` is a process.
fn row(subset: [bool; 3], more: &str, set: &[&str]) {
    let scene = subsets::scene(subset, set, 1);
    let system = assemble::start(&scene).unwrap_or_else(|refusal| panic!("{refusal}"));
    let number = system.gas.len() + system.dust.len() + system.bodies.x.len();
    let assembly = assemble::assembly(&scene, system).unwrap_or_else(|refusal| panic!("{refusal}"));
    let operators = assembly.splitting.names().len();
    let name = format!("{} {more}", subsets::name(subset));
    let name = name.trim();
    let instructions = counted::a_step(env!("CARGO_BIN_EXE_workload"), name) / number as f64;
    // The first time readies the thread itself.
    memory(subset, set, 1);
    let [one, two] = [1, 2].map(|steps| memory(subset, set, steps));
    println!(
        "| {name} | {operators} | {instructions:.0} | {:.0} | {:.0} |",
        two[1] / number as f64,
        two[0] - one[0]
    );
}

fn main() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.expect("a pool").install(|| {
        println!(
            "| scene | operators | instructions a particle | bytes a particle | calls for memory |"
        );
        println!("| --- | --- | --- | --- | --- |");
        for subset in subsets::all() {
            for (more, gravity) in [("", false), ("self-gravity", true)] {
                let alone = subset == [false, false, true];
                if !(alone && gravity) {
                    row(subset, more, &subsets::gravity(subset, gravity || alone));
                }
            }
        }
        let all = [true; 3];
        for process in PROCESSES {
            let set = [&subsets::gravity(all, false)[..], process.set].concat();
            row(all, process.name, &set);
        }
    });
}
