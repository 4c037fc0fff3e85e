//! Shares: how the mass of a broken body falls to its pieces.
//!
//! The largest remnant is given; the k-th piece (k = 2, 3, ...) has m_k = m_2 (k/2)^(-3/beta), so that n(>D) ~ D^-beta with beta = 2.85, and the
//! second m_2 = M (3 - beta)/(2 beta) (1 - m_1/M), at most m_1. Pieces below `least` are not followed one by one: their mass makes
//! equal pieces of at least `least`. Where their number is at its limit, all but the largest are heavier in proportion; where the largest is
//! smaller than that, all are equal.
//! Source: Leinhardt & Stewart (2012), equations 31 to 37; equal pieces: Chambers (2013).

/// Slope of the cumulative number over the diameter.
const BETA: f64 = 2.85;

/// How fine pieces may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Mass of the smallest piece.
    pub least: f64,
    /// Pieces beside the largest.
    pub most: usize,
}

/// Masses of the pieces of a body of mass `total`, the largest first; one alone if the rest is less than the smallest piece.
pub fn shares(total: f64, largest: f64, limits: &Limits) -> Vec<f64> {
    let rest = total - largest;
    if rest < limits.least || limits.most == 0 {
        return vec![total];
    }
    if largest < limits.least {
        return equal(total, limits);
    }
    let mut pieces = vec![largest];
    let second = (total * (3.0 - BETA) / (2.0 * BETA) * (1.0 - largest / total)).min(largest);
    let mut left = rest;
    while pieces.len() <= limits.most {
        let rank = (pieces.len() + 1) as f64;
        let piece = second * (0.5 * rank).powf(-3.0 / BETA);
        if piece < limits.least || piece > left {
            break;
        }
        pieces.push(piece);
        left -= piece;
    }
    let more = whole(left / limits.least);
    let room = limits.most + 1 - pieces.len();
    if more > 0 && more <= room {
        pieces.extend(std::iter::repeat_n(left / more as f64, more));
    } else {
        pieces.extend(std::iter::repeat_n(limits.least, more.min(room)));
        let sum: f64 = pieces[1..].iter().sum();
        pieces[1..]
            .iter_mut()
            .for_each(|piece| *piece *= rest / sum);
    }
    if pieces.iter().any(|&piece| piece > largest) {
        return equal(total, limits);
    }
    pieces[1..].sort_by(|a, b| b.total_cmp(a));
    pieces
}

fn equal(total: f64, limits: &Limits) -> Vec<f64> {
    let number = whole(total / limits.least).clamp(1, limits.most + 1);
    vec![total / number as f64; number]
}

/// A quotient as a number of pieces; one that is whole but for rounding counts as whole.
fn whole(quotient: f64) -> usize {
    (quotient * (1.0 + 1e-12)) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_hold_the_mass_and_keep_the_limits() {
        for largest in [0.001, 0.01, 0.07, 0.3, 0.6, 0.9, 0.99, 0.9995] {
            for least in [1e-5, 1e-4, 1e-3, 0.02, 0.2, 0.7] {
                for most in [1, 2, 7, 30, 300] {
                    let pieces = shares(1.0, largest, &Limits { least, most });
                    let sum: f64 = pieces.iter().sum();
                    assert!((sum - 1.0).abs() < 1e-13, "{largest} {least} {most}: {sum}");
                    assert!(pieces.len() <= most + 1);
                    let smallest = pieces[pieces.len() - 1];
                    assert!(
                        smallest >= least * (1.0 - 1e-11),
                        "{largest} {least} {most}"
                    );
                    assert!(pieces.iter().all(|&piece| piece <= pieces[0]));
                }
            }
        }
    }

    #[test]
    fn well_resolved_pieces_follow_the_law() {
        let limits = Limits {
            least: 1e-5,
            most: 100_000,
        };
        let pieces = shares(1.0, 0.4, &limits);
        assert!((pieces[0] - 0.4).abs() < 1e-15);
        assert!((pieces[1] - 0.6 * 0.15 / 5.7).abs() < 1e-15);
        // Ten times smaller bodies across: 10^2.85 times as many.
        let number = |mass: f64| pieces.iter().filter(|&&piece| piece > mass).count() as f64;
        let slope = (number(1.5e-5) / number(1.5e-2)).log10();
        // One more or less of the two pieces above the upper mass is no more than a tenth here.
        assert!((slope - 2.85).abs() < 0.03, "{slope}");
    }

    #[test]
    fn without_room_the_pieces_are_equal() {
        let limits = Limits {
            least: 0.1,
            most: 20,
        };
        assert_eq!(shares(1.0, 0.01, &limits), [0.1; 10]);
        assert_eq!(shares(1.0, 0.95, &limits), [1.0]);
        let few = Limits { most: 3, ..limits };
        assert_eq!(shares(1.0, 0.15, &few), [0.25; 4]);
    }
}
