//! A workload of a few equal steps, for whoever counts instructions: `workload NAME STEPS`.

use tridisk_tests::{subsets, workloads};

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [name, steps] = words.as_slice() else {
        panic!("workload NAME STEPS");
    };
    let steps = steps.parse().expect("a number of steps");
    if !subsets::named(name, steps) {
        println!("{}", workloads::run(name, steps));
    }
}
