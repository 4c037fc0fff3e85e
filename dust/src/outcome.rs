//! Outcome: what becomes of two grains that collide, and in which of the products the mass of one of them is found.
//!
//! Below the bouncing speed grains stick, above it they bounce, above the fragmentation speed they break; each turns into the next
//! linearly in probability over the last part `transition` of its speed (Birnstiel et al. 2010, A&A 513, A79, sect. 5). Fragments have n(m) ~ m^-slope
//! from that of a monomer up to the larger grain. A grain heavier than the other by more than `erosion.ratio` survives: it loses
//! `erosion.amount` of the projectile's mass, or gains it by mass transfer where `transfer.ratio` is passed (Windmark et al. 2012, A&A 540, A73).
//! Representative mass: every unit of mass of a collision goes with equal right, so grain 1 is found in product p with a probability P_1(p)
//! such that m_1 P_1 + m_2 P_2 is the mass in p (Zsom & Dullemond 2008, A&A 489, 931). Bounced grains stay as they are.

/// What happens to small mass ratios beyond the fragmentation speed: from this ratio of masses on, so much per mass of the projectile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cratering {
    pub ratio: f64,
    pub amount: f64,
}

/// The rules of collisions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rules {
    /// Infinite: grains never bounce.
    pub bouncing_speed: f64,
    /// Infinite: grains never break.
    pub fragmentation_speed: f64,
    /// Part of a speed below it over which the probability rises from 0 to 1; zero is a sharp threshold.
    pub transition: f64,
    /// Of the fragments, n(m) ~ m^-slope.
    pub slope: f64,
    /// Mass of the smallest fragment.
    pub monomer: f64,
    pub erosion: Cratering,
    /// An infinite ratio: none.
    pub transfer: Cratering,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    Sticking,
    Bouncing,
    Fragmentation,
    Erosion,
    MassTransfer,
}

impl Outcome {
    pub const ALL: [Self; 5] = [
        Self::Sticking,
        Self::Bouncing,
        Self::Fragmentation,
        Self::Erosion,
        Self::MassTransfer,
    ];
}

/// The product in which a grain's mass is found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Product {
    /// Grain 1 and so many of grain 2.
    Merged(f64),
    Unchanged,
    /// Of this mass.
    Fragment(f64),
    /// What is left of grain 1, of this mass.
    Remnant(f64),
    /// Grain 2, with mass of this amount out of grain 1.
    Coated(f64),
}

impl Rules {
    /// Grains that always stick.
    pub const STICKING: Self = Self {
        bouncing_speed: f64::INFINITY,
        fragmentation_speed: f64::INFINITY,
        transition: 0.0,
        slope: 11.0 / 6.0,
        monomer: 0.0,
        erosion: Cratering {
            ratio: f64::INFINITY,
            amount: 0.0,
        },
        transfer: Cratering {
            ratio: f64::INFINITY,
            amount: 0.0,
        },
    };

    /// Probability that a threshold is passed.
    fn passed(&self, threshold: f64, speed: f64) -> f64 {
        if speed >= threshold {
            return 1.0;
        }
        if threshold.is_infinite() || self.transition == 0.0 {
            return 0.0;
        }
        let width = self.transition * threshold;
        (1.0 - (threshold - speed) / width).max(0.0)
    }

    /// What grains of masses `m` do that meet at `speed`; `chance` is between 0 and 1.
    pub fn outcome(&self, m: [f64; 2], speed: f64, chance: f64) -> Outcome {
        let (large, small) = (m[0].max(m[1]), m[0].min(m[1]));
        if chance < self.passed(self.fragmentation_speed, speed) {
            let ratio = large / small;
            // A monomer does not break.
            if large < 2.0 * self.monomer {
                return Outcome::Bouncing;
            }
            if ratio >= self.transfer.ratio {
                return Outcome::MassTransfer;
            }
            return match ratio >= self.erosion.ratio {
                true => Outcome::Erosion,
                false => Outcome::Fragmentation,
            };
        }
        if chance < self.passed(self.bouncing_speed, speed) {
            return Outcome::Bouncing;
        }
        Outcome::Sticking
    }

    /// The most of grain 2 that may be taken together in one event of grain 1, if these are to change it by at most the part `change`.
    pub fn together(&self, m: [f64; 2], change: f64) -> f64 {
        let each = self.erosion.amount.max(1.0) * m[1];
        (change * m[0] / each).max(1.0)
    }

    /// Where the mass of grain 1 is found after collisions with `many` of grain 2; chances are between 0 and 1.
    pub fn product(&self, outcome: Outcome, m: [f64; 2], many: f64, chances: [f64; 2]) -> Product {
        let [one, two] = m;
        let fragment = |largest: f64| Product::Fragment(self.fragment(largest, chances[1]));
        match outcome {
            Outcome::Sticking => Product::Merged(many),
            Outcome::Bouncing => Product::Unchanged,
            Outcome::Fragmentation => fragment(one.max(two)),
            Outcome::Erosion if one >= two => {
                let lost = self.erosion.amount * many * two;
                // The target itself may be what is dug out.
                match chances[0] < lost / one {
                    true => fragment(two),
                    false => Product::Remnant(one - lost),
                }
            }
            Outcome::Erosion => fragment(one),
            Outcome::MassTransfer if one >= two => {
                Product::Remnant(one + self.transfer.amount * many * two)
            }
            Outcome::MassTransfer => match chances[0] < self.transfer.amount {
                true => Product::Coated(self.transfer.amount * one),
                false => fragment(one),
            },
        }
    }

    /// Mass of the fragment in which a unit of mass is found, in a power law from a monomer up to `largest`.
    pub fn fragment(&self, largest: f64, chance: f64) -> f64 {
        if largest <= self.monomer {
            return self.monomer;
        }
        let (power, ratio) = (2.0 - self.slope, (largest / self.monomer).ln());
        // [1 + chance ((largest/monomer)^power - 1)]^(1/power), also for a power near zero.
        let grown = if power.abs() < 1e-8 {
            chance * ratio
        } else {
            (chance * (power * ratio).exp_m1()).ln_1p() / power
        };
        self.monomer * grown.exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rules() -> Rules {
        Rules {
            bouncing_speed: 1.0,
            fragmentation_speed: 10.0,
            transition: 0.2,
            slope: 11.0 / 6.0,
            monomer: 1e-6,
            erosion: Cratering {
                ratio: 10.0,
                amount: 2.0,
            },
            transfer: Cratering {
                ratio: 1000.0,
                amount: 0.3,
            },
        }
    }

    #[test]
    fn grains_stick_bounce_and_break_one_after_the_other() {
        let of = |ratio: f64, speed: f64| rules().outcome([1.0, 1.0 / ratio], speed, 0.5);
        assert_eq!(of(1.0, 0.85), Outcome::Sticking);
        assert_eq!(of(1.0, 0.95), Outcome::Bouncing);
        assert_eq!(of(1.0, 8.9), Outcome::Bouncing);
        assert_eq!(of(1.0, 9.1), Outcome::Fragmentation);
        assert_eq!(of(20.0, 11.0), Outcome::Erosion);
        assert_eq!(of(2000.0, 11.0), Outcome::MassTransfer);
        assert_eq!(
            rules().outcome([1e-6, 1.9e-6], 100.0, 0.5),
            Outcome::Bouncing
        );
        let sharp = Rules {
            transition: 0.0,
            ..rules()
        };
        assert_eq!(sharp.outcome([1.0, 1.0], 9.999, 0.0), Outcome::Bouncing);
        assert_eq!(
            Rules::STICKING.outcome([1.0, 1.0], 1e9, 0.0),
            Outcome::Sticking
        );
    }

    /// Mass of a collision that is found in fragments, and in what is left of grain 1 with others stuck to it, and the mean masses there:
    /// over evenly spread chances.
    fn shares(m: [f64; 2], outcome: Outcome, many: f64) -> [f64; 3] {
        let n = 4000;
        let mut sum = [0.0; 3];
        for k in 0..n {
            let chances = [(f64::from(k) + 0.5) / f64::from(n), 0.5];
            match rules().product(outcome, m, many, chances) {
                Product::Fragment(_) => sum[0] += m[0] / f64::from(n),
                Product::Remnant(mass) => {
                    sum[1] += m[0] / f64::from(n);
                    sum[2] = mass;
                }
                Product::Coated(_) => sum[1] += m[0] / f64::from(n),
                Product::Merged(_) | Product::Unchanged => {}
            }
        }
        sum
    }

    #[test]
    fn both_sides_of_a_crater_see_the_same_masses() {
        // One target 1 and one projectile 0.01 that digs out 0.02: fragments hold 0.03, the remnant 0.98.
        let (target, projectile) = (
            shares([1.0, 0.01], Outcome::Erosion, 1.0),
            shares([0.01, 1.0], Outcome::Erosion, 1.0),
        );
        assert!((target[0] + projectile[0] - 0.03).abs() < 1e-3);
        assert!(
            (target[1] + projectile[1] - 0.98).abs() < 1e-3 && (target[2] - 0.98).abs() < 1e-12
        );
        // Three tenths of the projectile stay on the target.
        let (target, projectile) = (
            shares([1.0, 1e-4], Outcome::MassTransfer, 1.0),
            shares([1e-4, 1.0], Outcome::MassTransfer, 1.0),
        );
        assert!((projectile[0] - 0.7e-4).abs() < 1e-7);
        assert!((target[1] + projectile[1] - 1.00003).abs() < 1e-7);
        assert!((target[2] - 1.00003).abs() < 1e-12);
        // Many at once dig as many times as deep.
        let deep = shares([1.0, 1e-3], Outcome::Erosion, 20.0);
        assert!((deep[0] - 0.04).abs() < 1e-3 && (deep[2] - 0.96).abs() < 1e-12);
        assert_eq!(rules().together([1.0, 1e-3], 0.05), 25.0);
    }

    #[test]
    fn fragments_have_the_power_law() {
        // Mass below m: (m^p - 1) / (M^p - 1) with p = 2 - slope.
        for slope in [11.0 / 6.0, 2.0, 2.5] {
            let rules = Rules { slope, ..rules() };
            let below = |m: f64| match slope {
                2.0 => m.ln(),
                _ => (m.powf(2.0 - slope) - 1.0) / (2.0 - slope),
            };
            for chance in [0.0, 0.1, 0.5, 0.9, 1.0] {
                let found = rules.fragment(1.0, chance) / rules.monomer;
                let error = below(found) / below(1e6) - chance;
                assert!(error.abs() < 1e-12, "{slope} {chance}: {error:e}");
            }
        }
    }
}
