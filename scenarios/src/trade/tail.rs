//! Heavy tails: how much larger a sum over bodies may be with another seed, where a few that met others closely make most of it.
//!
//! P(x > y) ~ y^-a of the largest of N, a by the k = sqrt(N) largest, 1/a = mean ln(x_i / x_k) (Hill 1975, Ann. Stat. 3, 1163). Where a is
//! below that at which a variance exists, the sum is as its largest term, whose p-quantile is (ln 2 / -ln p)^(1/a) medians (Frechet's law);
//! p = 0.977, as two standard errors. An encounter within b stretches distances as b^-2 and is met within b as often as b^2: a >= 1.

/// The quantile of a normal law at two standard errors.
const LIKELY: f64 = 0.977;

/// Values by which a tail is told, at least.
const LEAST: usize = 10;

/// The factor of a sum of `sizes`, or for `variance` = 4 of the root of a sum of their squares; 1 for tails above the index `variance`, or too few.
pub fn spread(mut sizes: Vec<f64>, variance: f64) -> f64 {
    let k = sizes.len().isqrt();
    sizes.sort_unstable_by(|a, b| b.total_cmp(a));
    if k < LEAST || sizes[k] <= 0.0 || !sizes[0].is_finite() {
        return 1.0;
    }
    let logarithms = sizes[..k].iter().map(|x| (x / sizes[k]).ln());
    let index = k as f64 / logarithms.sum::<f64>();
    if index >= variance {
        return 1.0;
    }
    (2f64.ln() / -LIKELY.ln()).powf(1.0 / index.max(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sizes of which the part 1 - u lies below u^(-1/index), as evenly as can be but turned by `shift`.
    fn tailed(index: f64, shift: f64) -> Vec<f64> {
        let part = |i: usize| (0.618_034 * i as f64 + shift).fract();
        (1..=2000).map(|i| part(i).powf(-1.0 / index)).collect()
    }

    #[test]
    fn the_spread_holds_what_other_draws_of_a_heavy_tail_give() {
        use nbody::points::random::{Purpose, stream};
        use rand::RngExt;
        let mut random = stream(1, Purpose::Orbits, 0, 0);
        let mut draw = || -> Vec<f64> {
            let each = (0..2000).map(|_| 1.0 / random.random::<f64>());
            each.collect()
        };
        let rms = |sizes: &[f64]| sizes.iter().map(|x| x * x).sum::<f64>().sqrt();
        let bounds: Vec<(f64, f64)> = (0..400)
            .map(|_| {
                let sizes = draw();
                (rms(&sizes), rms(&sizes) * spread(sizes, 4.0))
            })
            .collect();
        // Of pairs of draws; two standard errors by the jackknife hold only 7 of 10.
        let held = (0..400).filter(|&i| bounds[(i + 1) % 400].0 <= bounds[i].1);
        assert!(held.count() >= 380);
    }

    #[test]
    fn a_tail_with_a_variance_has_no_spread_of_its_own() {
        assert_eq!(spread(tailed(6.0, 0.0), 4.0), 1.0);
        assert_eq!(spread(vec![1.0; 2000], 4.0), 1.0);
        assert_eq!(spread(vec![1e3, 1.0], 4.0), 1.0);
        let whole = spread(tailed(2.0, 0.0), 4.0);
        assert!((whole / 29.8f64.sqrt() - 1.0).abs() < 0.3, "{whole}");
        assert!((spread(tailed(0.5, 0.0), 4.0) / 29.8 - 1.0).abs() < 0.01);
    }
}
