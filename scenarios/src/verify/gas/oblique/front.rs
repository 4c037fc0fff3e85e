//! A shock front that moves into gas at rest, as particles have it: its place and width, what viscosity does in it, and the gas that it leaves.
//!
//! v(x) = v* (1 - tanh((x - place) / half)) / 2 by least squares; the width is 2 half, v* by the largest slope.

/// A front by its velocities.
#[derive(Clone, Copy, Debug)]
pub struct Front {
    pub place: f64,
    pub half: f64,
}

impl Front {
    /// The best for places and velocities by v*, near a guess.
    pub fn fit(points: &[[f64; 2]], guess: Front) -> Self {
        let rest = |front: &Front| -> f64 {
            let one = |[x, v]: &[f64; 2]| (v - front.velocity(*x)).powi(2);
            points.iter().map(one).sum()
        };
        let mut best = guess;
        let mut step = 1.0;
        // Ever finer squares of fronts about the best: the sum has one valley near a guess.
        for _ in 0..14 {
            let around = (-6..=6).flat_map(|i| (-6..=6).map(move |j| [i, j].map(f64::from)));
            let fronts = around.map(|[i, j]| Front {
                place: best.place + step * i / 6.0 * guess.half,
                half: best.half * (step * j / 6.0).exp(),
            });
            best = fronts
                .min_by(|a, b| rest(a).total_cmp(&rest(b)))
                .expect("a square of fronts");
            step *= 0.5;
        }
        best
    }

    fn velocity(&self, x: f64) -> f64 {
        0.5 * (1.0 - ((x - self.place) / self.half).tanh())
    }

    pub fn width(&self) -> f64 {
        2.0 * self.half
    }
}

/// The root of the mean of squares.
pub fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut number) = (0.0, 0.0);
    for value in values {
        sum += value * value;
        number += 1.0;
    }
    f64::sqrt(sum / number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_front_is_found_by_its_velocities() {
        let exact = Front {
            place: 1.33,
            half: 0.02,
        };
        let points: Vec<[f64; 2]> = (0..300)
            .map(|k| 1.2 + 0.001 * f64::from(k))
            .map(|x| [x, exact.velocity(x) + 1e-3 * (700.0 * x).sin()])
            .collect();
        let guess = Front {
            place: 1.36,
            half: 0.05,
        };
        let found = Front::fit(&points, guess);
        assert!((found.place - exact.place).abs() < 2e-4, "{found:?}");
        assert!((found.half / exact.half - 1.0).abs() < 0.01, "{found:?}");
    }
}
