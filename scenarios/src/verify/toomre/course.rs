//! The course of a wave's amplitude, cos(omega t) or cosh(|omega| t), and the omega^2 whose course fits best.

/// cos(omega t), or cosh where omega^2 is negative.
fn course(square: f64, t: f64) -> f64 {
    if square >= 0.0 {
        (square.sqrt() * t).cos()
    } else {
        ((-square).sqrt() * t).cosh()
    }
}

/// The omega^2 whose course is nearest to `wave` (times and amplitudes), and the root mean square of what it leaves, by that of the wave.
pub fn fit(wave: &[[f64; 2]]) -> (f64, f64) {
    let rest = |square: f64| -> f64 {
        let one = |[t, a]: &[f64; 2]| (a - course(square, *t)).powi(2);
        wave.iter().map(one).sum()
    };
    let (mut best, mut width) = (0.0, 4.0);
    // Ever finer rows of values about the best: the sum has one valley within each.
    for _ in 0..12 {
        let row = (-40..=40).map(|k| best + width * f64::from(k) / 40.0);
        best = row
            .min_by(|a, b| rest(*a).total_cmp(&rest(*b)))
            .expect("a row of values");
        width *= 0.1;
    }
    let all: f64 = wave.iter().map(|[_, a]| a * a).sum();
    (best, (rest(best) / all).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    const STOPS: usize = 24;

    #[test]
    fn courses_are_fitted_by_their_own_rates() {
        for square in [0.72, -0.73, 1.9] {
            let wave: Vec<[f64; 2]> = (0..=STOPS)
                .map(|k| 4.0 * k as f64 / STOPS as f64)
                .map(|t| [t, course(square, t)])
                .collect();
            let (found, rest) = fit(&wave);
            assert!(
                (found - square).abs() < 1e-6 && rest < 1e-6,
                "{found} {rest}"
            );
        }
    }
}
