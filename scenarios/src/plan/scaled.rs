//! The cost of many particles from that of a part of them.
//!
//! rate = a N ln N + b N^2, for the tree and for pairs within cut-offs that do not shrink with the number, from samples of two numbers.
//! Where there is gas the Courant condition sets its steps, ~ N^(1/d) of them, and neighbours are always as many: b = 0.

use crate::cost::Cost;
use crate::scene::Scene;

/// The cost of the `scene` with the last of three `numbers` of particles from that with the second; with the first it has this `rate`.
pub fn scaled(cost: Cost, scene: &Scene, numbers: [f64; 3], rate: f64) -> Cost {
    let [_, some, all] = numbers;
    let part = some / all;
    let steps = match scene.gas {
        Some(_) => part.powf(-1.0 / scene.domain.dimensions() as f64),
        None => 1.0,
    };
    Cost {
        rate: cost.rate * grown(numbers, cost.rate / rate, steps),
        start_s: cost.start_s / part,
        report_s: cost.report_s / part,
        updates: cost.updates.map(|updates| updates / part * steps),
        ticks: cost.ticks * steps,
        ..cost
    }
}

/// The rate with the last of `numbers` by that with the second, which is `ratio` times that with the first; `steps` times as many steps are done.
fn grown([few, some, all]: [f64; 3], ratio: f64, steps: f64) -> f64 {
    let tree = |n: f64| n * n.ln() / (some * some.ln());
    let pairs = |n: f64| (n / some).powi(2);
    // The part of pairs among `some`: 1 / ratio = (1 - b) tree + b pairs among the fewest.
    let b = match steps > 1.0 {
        true => 0.0,
        false => (tree(few) - 1.0 / ratio) / (tree(few) - pairs(few)),
    };
    let b = if b > 0.0 { b.min(1.0) } else { 0.0 };
    ((1.0 - b) * tree(all) + b * pairs(all)) * steps
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trees_and_pairs_are_told_apart() {
        let cost = |n: f64, b: f64| n * n.ln() + b * n * n;
        let numbers = [5e4, 2e5, 1e6];
        for b in [0.0, 1e-5, 1e-4] {
            let [few, some, all] = numbers.map(|n| cost(n, b));
            let grown = grown(numbers, some / few, 1.0);
            assert!((grown / (all / some) - 1.0).abs() < 1e-9, "{b}: {grown}");
        }
        // Noise below the tree's growth is none of pairs.
        assert_eq!(grown(numbers, 4.0, 1.0), grown(numbers, 4.3, 1.0));
        assert_eq!(grown(numbers, 9.0, 2.0), 2.0 * grown(numbers, 4.0, 1.0));
    }
}
