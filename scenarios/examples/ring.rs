//! How long a cold ring lives: ring PARTICLES ORBITS [key.path=value]...

use tridisk::verify::ring;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let number = |k: usize| words[k].parse().expect("a whole number");
    let life = ring::life(number(0), number(1), "", &words[2..]).expect("a run");
    println!("{life:?}");
}
