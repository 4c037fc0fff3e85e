//! Random numbers keyed by what they are for, so that they depend neither on threads nor on restarts.

use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

/// What a stream of random numbers is for; streams of different purposes are independent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    GasPositions = 1,
    DustPositions = 2,
    GrainSizes = 3,
    Orbits = 4,
    Turbulence = 5,
    Growth = 16,
    GrowthCells = 17,
}

/// The stream for `purpose`, particle `id` and step `step` of a run with seed `seed`.
pub fn stream(seed: u64, purpose: Purpose, id: u64, step: u64) -> Pcg64Mcg {
    let key = [purpose as u64, id, step]
        .into_iter()
        .fold(mix(seed), |key, word| mix(key ^ mix(word)));
    Pcg64Mcg::seed_from_u64(key)
}

/// The finaliser of SplitMix64 (Steele, Lea & Flood 2014).
fn mix(word: u64) -> u64 {
    let z = word.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ z >> 31
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;

    #[test]
    fn each_key_has_a_stream_of_its_own_and_their_mean_is_a_half() {
        let first = |id: u64, step: u64| stream(1, Purpose::Orbits, id, step).random::<f64>();
        assert_eq!(first(3, 4).to_bits(), first(3, 4).to_bits());
        assert_ne!(first(3, 4).to_bits(), first(4, 3).to_bits());
        let n = 10_000;
        let mean = (0..n).map(|id| first(id, 0)).sum::<f64>() / n as f64;
        // Four standard errors of the mean of a uniform number.
        assert!(
            (mean - 0.5).abs() < 4.0 / (12.0 * n as f64).sqrt(),
            "mean {mean}"
        );
    }
}
