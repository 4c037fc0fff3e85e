//! Symplectic correctors: the change of variables between the states that the Wisdom-Holman map steps through and real states.
//!
//! With A the Kepler part over a step and B the kick, the map is exp(A/2) exp(B) exp(A/2), and to first order in B a real state is one
//! of the map moved by C = (phi(L) - 1)/L B, L = [A, ], phi(L) = (L/2)/sinh(L/2) = 1 - L^2/24 + 7 L^4/5760 - ... It is made of pairs of
//! kicks Z(a, b) = A(a) B(b) A(-2a) B(-b) A(a) at a = k alpha, alpha = sqrt(7/40), k = -n..n: sum_k 4 b_k sinh(k alpha L) = C to order
//! L^(2n - 1), so that the error left is of order dt^(2n + 1) m/M and dt^2 (m/M)^2.
//! Source: Wisdom, Holman & Touma (1996); Wisdom (2006).

/// How many of the terms of first order in the masses a corrector takes out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Corrector {
    #[default]
    None,
    Third,
    Fifth,
    Seventh,
    Eleventh,
    Seventeenth,
}

/// sqrt(7/40): the spacing of the kicks in steps.
pub const SPACING: f64 = 0.418_330_013_267_037_8;

impl Corrector {
    pub const ALL: [Self; 6] = [
        Self::None,
        Self::Third,
        Self::Fifth,
        Self::Seventh,
        Self::Eleventh,
        Self::Seventeenth,
    ];

    /// The power of the step in the error of first order in the masses; zero without a corrector.
    pub fn order(self) -> u32 {
        match self {
            Self::None => 0,
            _ => 2 * self.weights().len() as u32 + 1,
        }
    }

    /// b_1..b_n in steps.
    pub fn weights(self) -> &'static [f64] {
        match self {
            Self::None => &[],
            Self::Third => &[-0.024_900_596_027_799_867],
            Self::Fifth => &[-0.041_500_993_379_666_446, 0.008_300_198_675_933_289],
            Self::Seventh => &[
                -0.053_964_399_093_127_5,
                0.018_270_923_246_702_133,
                -0.002_492_681_142_692_210_6,
            ],
            Self::Eleventh => &[
                -0.072_593_394_748_842_74,
                0.038_121_613_681_288_65,
                -0.012_309_078_592_019_946,
                0.002_348_721_529_229_535_6,
                -0.000_203_615_796_478_546_5,
            ],
            Self::Seventeenth => &[
                -0.093_056_103_771_425_96,
                0.065_192_863_576_377_9,
                -0.032_422_198_864_713_58,
                0.012_071_760_822_342_29,
                -0.003_313_257_706_938_065_6,
                0.000_635_999_830_758_176_6,
                -0.000_076_436_355_227_935_74,
                0.000_004_334_741_547_337_358,
            ],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_weights_make_the_series_of_the_corrector_to_their_order() {
        // Coefficients of L^2, L^4, ... in (L/2)/sinh(L/2).
        let wanted = [
            -1.0 / 24.0,
            7.0 / 5760.0,
            -31.0 / 967_680.0,
            127.0 / 154_828_800.0,
            -73.0 / 3_503_554_560.0,
            1_414_477.0 / 2_678_117_105_664_000.0,
            -8191.0 / 612_141_052_723_200.0,
            16_931_177.0 / 49_950_709_902_213_120_000.0,
        ];
        for corrector in Corrector::ALL {
            let weights = corrector.weights();
            for (j, wanted) in wanted.iter().enumerate() {
                let power = 2 * j as i32 + 1;
                let factorial: f64 = (1..=power).map(f64::from).product();
                let term = |(k, b): (usize, &f64)| {
                    4.0 * b * ((k + 1) as f64 * SPACING).powi(power) / factorial
                };
                let made: f64 = weights.iter().enumerate().map(term).sum();
                let size: f64 = weights.iter().enumerate().map(|t| term(t).abs()).sum();
                let error = (made - wanted).abs();
                if j < weights.len() {
                    assert!(error < 4e-16 * size, "{corrector:?} {power}: {error:e}");
                } else if !weights.is_empty() {
                    assert!(error > 1e-3 * wanted.abs(), "{corrector:?} {power}");
                }
            }
        }
        let orders = Corrector::ALL.map(Corrector::order);
        assert_eq!(orders, [0, 3, 5, 7, 11, 17]);
    }
}
