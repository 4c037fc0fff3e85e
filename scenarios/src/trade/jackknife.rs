//! Uncertainties by the jackknife: how much a ratio of sums changes when groups of what is summed are left out, one at a time.
//!
//! sigma^2 = (n - 1) / n sum_k (x_k - mean x)^2, x_k being the value without group k of n (Quenouille 1956, Tukey 1958).

use super::tail;

/// Rings of a profile and groups of a jackknife.
pub const PARTS: usize = 20;

/// An error with its uncertainty; not a number where that is not known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    pub error: f64,
    pub uncertainty: f64,
    /// How many times larger it may be with another seed, for heavy tails; 1 where the uncertainty says it all.
    pub spread: f64,
}

/// Difference of two rms values by the second.
pub fn root_mean(mine: &[[f64; 2]], theirs: &[[f64; 2]], k: usize) -> Option<Measured> {
    let of = |list: &[[f64; 2]]| -> Vec<[f64; 2]> { list.iter().map(|s| [s[k], 1.0]).collect() };
    let (mine, theirs) = (of(mine), of(theirs));
    let root = |sums: [f64; 2]| (sums[0] / sums[1]).sqrt();
    let sums = |list: &[[f64; 2]]| {
        list.iter()
            .fold([0.0; 2], |s, x| [s[0] + x[0], s[1] + x[1]])
    };
    let wanted = root(sums(&theirs));
    if wanted == 0.0 || !wanted.is_finite() || mine.is_empty() {
        return None;
    }
    let error = ((root(sums(&mine)) - wanted) / wanted).abs();
    // Of the same bodies in both the difference scatters, by the pairs' own jackknife; of others each rms by itself.
    let mut spread = 1.0;
    let uncertainty = if mine.len() == theirs.len() {
        let changes = mine.iter().zip(&theirs).map(|(a, b)| (a[0] - b[0]).abs());
        spread = tail::spread(changes.collect(), 2.0);
        let both: Vec<[f64; 2]> = mine
            .iter()
            .zip(&theirs)
            .map(|(a, b)| [a[0], b[0]])
            .collect();
        jackknife(&both, |sums| (sums[0] / sums[1]).sqrt())?.uncertainty
    } else {
        let alone = |list: &[[f64; 2]]| {
            let own = jackknife(list, |sums| (sums[0] / sums[1]).sqrt());
            own.map_or(f64::NAN, |own| own.uncertainty)
        };
        alone(&mine).hypot(alone(&theirs)) / wanted
    };
    Some(Measured {
        error,
        uncertainty,
        spread,
    })
}

/// A function of sums over items, and its standard error from leaving out one of at most some groups of them at a time.
pub fn jackknife(items: &[[f64; 2]], of: impl Fn([f64; 2]) -> f64) -> Option<Measured> {
    let groups = items.len().min(PARTS);
    let mut parts = vec![[0.0; 2]; groups];
    for (i, item) in items.iter().enumerate() {
        let part = &mut parts[i % groups];
        *part = [part[0] + item[0], part[1] + item[1]];
    }
    let whole = parts
        .iter()
        .fold([0.0; 2], |s, x| [s[0] + x[0], s[1] + x[1]]);
    let error = of(whole);
    if !error.is_finite() {
        return None;
    }
    let without: Vec<f64> = parts
        .iter()
        .map(|part| of([whole[0] - part[0], whole[1] - part[1]]))
        .collect();
    let n = groups as f64;
    let mean = without.iter().sum::<f64>() / n;
    let scatter: f64 = without.iter().map(|x| (x - mean).powi(2)).sum();
    let uncertainty = if groups > 1 {
        ((n - 1.0) / n * scatter).sqrt()
    } else {
        f64::NAN
    };
    Some(Measured {
        error,
        uncertainty,
        spread: 1.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jackknife_of_a_mean_is_its_standard_error() {
        let items: Vec<[f64; 2]> = (0..PARTS).map(|i| [(i as f64).sin(), 1.0]).collect();
        let measured = jackknife(&items, |sums| sums[0] / sums[1]).expect("a mean");
        let n = PARTS as f64;
        let mean = items.iter().map(|x| x[0]).sum::<f64>() / n;
        let square: f64 = items.iter().map(|x| (x[0] - mean).powi(2)).sum();
        let wanted = (square / (n * (n - 1.0))).sqrt();
        assert!((measured.error - mean).abs() < 1e-14);
        assert!((measured.uncertainty / wanted - 1.0).abs() < 1e-12);
    }

    #[test]
    fn rms_values_differ_by_their_part() {
        let shapes = |e: f64| vec![[e * e, 0.0]; 3];
        let measured = root_mean(&shapes(0.11), &shapes(0.1), 0).expect("an error");
        assert!((measured.error - 0.1).abs() < 1e-12, "{measured:?}");
        assert!(measured.uncertainty < 1e-12);
        assert_eq!(root_mean(&shapes(0.1), &shapes(0.0), 0), None);
    }
}
