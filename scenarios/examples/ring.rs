//! How long a cold ring lives: ring PARTICLES ORBITS [key.path=value]...

use tridisk::verify::ring;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let number = |k: usize| words[k].parse().expect("a whole number");
    let mut told = 0.0;
    let life = ring::life(number(0), number(1), "", &words[2..], |life| {
        if life.survived >= told {
            println!("{life:?}");
            told = if life.survived < 1.0 {
                1.0
            } else {
                told + 10.0
            };
        }
    });
    println!("{:?}", life.expect("a run"));
}
