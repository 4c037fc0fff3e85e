//! Relative speeds of two grains in gas: Brownian motion, turbulence, and their drift through the gas.
//!
//! v^2 = v_B^2 + v_T^2 + |u_1 - u_2|^2, v_B^2 = 8 k T (m_1 + m_2) / (pi m_1 m_2), k T = (mass of a molecule) c^2.
//! v_T: Ormel & Cuzzi (2007, A&A 466, 413), eqs 16 to 21: eddies of classes I and II in closed form, with V_g^2 = 3/2 alpha c^2, turnover
//! time 1/Omega of the largest and Re = alpha c^2 / (Omega nu), nu = v_th l / 2. The boundary between the classes is y St,
//! 2/3 y (y - 1)^2 - 1/(1 + y) = -St/(1 + St), at most the largest and at least the smallest eddy.
//! u is the motion relative to the gas: the one that superparticles have, or for a head wind w the steady drift (Nakagawa, Sekiya & Hayashi
//! 1986, without reaction) u_r = -2 w St/(1 + St^2), u_phi = w St^2/(1 + St^2), u_z = -z Omega min(St, 1/2) (Birnstiel et al. 2010, A&A 513, A79).
//! Bounds that cost less than the speeds: v <= s_1 + s_2 + max(g_1, g_2).

use std::f64::consts::PI;

use nbody::points::Vec3;

use crate::stopping::{Ambient, Molecules};

/// What the ratio of the largest to the smallest eddies follows from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reynolds {
    Number(f64),
    /// The molecular viscosity of the gas.
    Of(Molecules),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turbulence {
    pub alpha: f64,
    pub reynolds: Reynolds,
}

/// How grains move through the gas on average.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// With it.
    Still,
    /// As the superparticles do.
    Resolved,
    /// Steadily, in a head wind of this speed.
    Steady(f64),
}

/// What makes grains meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sources {
    /// Mass of a molecule; zero for no Brownian motion.
    pub molecule: f64,
    pub turbulence: Option<Turbulence>,
    pub motion: Motion,
}

/// The sources in the gas of one place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Conditions {
    /// 8 k T / pi
    thermal: f64,
    /// V_g^2
    turbulent: f64,
    /// Re^(-1/2)
    smallest: f64,
}

/// A grain as those that it meets see it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grain {
    pub m: f64,
    pub stokes: f64,
    /// velocity relative to the gas
    pub u: Vec3,
}

impl Turbulence {
    /// Reynolds number of the largest eddies.
    pub fn reynolds(&self, gas: &Ambient) -> f64 {
        match self.reynolds {
            Reynolds::Number(number) => number,
            Reynolds::Of(molecules) => {
                let nu = 0.5 * gas.thermal_speed() * molecules.mean_free_path(gas.rho);
                self.alpha * gas.c * gas.c / (gas.omega * nu)
            }
        }
    }
}

impl Sources {
    pub fn conditions(&self, gas: &Ambient) -> Conditions {
        let square = gas.c * gas.c;
        let (turbulent, smallest) = match self.turbulence {
            // Without an orbital frequency there is no largest eddy.
            Some(turbulence) if gas.omega > 0.0 && gas.rho > 0.0 => (
                1.5 * turbulence.alpha * square,
                turbulence.reynolds(gas).powf(-0.5).min(1.0),
            ),
            _ => (0.0, 1.0),
        };
        Conditions {
            thermal: 8.0 / PI * self.molecule * square,
            turbulent,
            smallest,
        }
    }

    /// Velocity relative to the gas of a grain with this Stokes number whose superparticle has the velocity `resolved`, `height` above the plane.
    pub fn drift(&self, stokes: f64, resolved: Vec3, omega: f64, height: f64) -> Vec3 {
        match self.motion {
            Motion::Still => Vec3::zeros(),
            Motion::Resolved => resolved,
            Motion::Steady(wind) => steady(stokes, wind, omega * height),
        }
    }
}

/// Steady drift relative to the gas: radial, azimuthal, vertical; `fall` is Omega z.
pub fn steady(stokes: f64, wind: f64, fall: f64) -> Vec3 {
    let share = 1.0 / (1.0 + stokes * stokes);
    Vec3::new(
        -2.0 * wind * stokes * share,
        wind * stokes * stokes * share,
        -fall * stokes.min(0.5),
    )
}

impl Conditions {
    /// Relative speed of two grains.
    pub fn speed(&self, a: &Grain, b: &Grain) -> f64 {
        let brownian = self.thermal * (a.m + b.m) / (a.m * b.m);
        let turbulent = if self.turbulent > 0.0 {
            self.turbulent * eddies(a.stokes, b.stokes, self.smallest)
        } else {
            0.0
        };
        (brownian + turbulent + (a.u - b.u).norm_squared()).sqrt()
    }

    /// s and g of a grain: with others' they bound relative speeds, where `mean` is the same for all.
    pub fn bounds(&self, grain: &Grain, mean: Vec3) -> [f64; 2] {
        let own = (self.thermal / grain.m).sqrt() + (grain.u - mean).norm();
        let stokes = grain.stokes;
        let square = if 1.61 * stokes < self.smallest {
            stokes * stokes / self.smallest
        } else {
            3.0 * stokes.min(0.5)
        };
        [own, (self.turbulent * square).sqrt()]
    }

    /// Mean square speed by turbulence of a grain relative to the gas.
    pub fn stirred(&self, stokes: f64) -> f64 {
        self.turbulent * stokes / (1.0 + stokes)
    }
}

/// Square of the speed by turbulence in units of V_g^2; `smallest` is Re^(-1/2).
pub fn eddies(stokes_1: f64, stokes_2: f64, smallest: f64) -> f64 {
    let (a, b) = (stokes_1.max(stokes_2), stokes_1.min(stokes_2));
    if a == 0.0 {
        return 0.0;
    }
    let between = if a < 1.0 { boundary(a) * a } else { 1.0 };
    let between = between.clamp(smallest, 1.0);
    // s^2/(x + s), at x less that at y, without cancellation.
    let less = |s: f64, x: f64, y: f64| s * s * (y - x) / ((x + s) * (y + s));
    let first = (a - b) / (a + b) * (less(a, between, 1.0) - less(b, between, 1.0));
    let second =
        2.0 * (between - smallest) - less(a, smallest, between) - less(b, smallest, between);
    first.max(0.0) + second.max(0.0)
}

/// y of the eddies between the classes, in units of the stopping time.
pub fn boundary(stokes: f64) -> f64 {
    if stokes >= 1.0 {
        return 1.0;
    }
    let shift = stokes / (1.0 + stokes);
    // The left side is convex and grows: from above Newton's steps come down to the root.
    let mut y = 1.61;
    for _ in 0..12 {
        let f = 2.0 / 3.0 * y * (y - 1.0) * (y - 1.0) - 1.0 / (1.0 + y) + shift;
        let slope = 2.0 / 3.0 * (y - 1.0) * (3.0 * y - 1.0) + 1.0 / ((1.0 + y) * (1.0 + y));
        let step = f / slope;
        y -= step;
        if step.abs() < 1e-9 {
            break;
        }
    }
    y
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both Stokes numbers, Reynolds number, v/V_g: the integrals over the eddies by other hands.
    const TABLE: [[f64; 4]; 12] = [
        [1e-6, 1e-7, 1e6, 2.84319090893e-05],
        [1e-6, 1e-7, 1e8, 8.95447577274e-05],
        [0.001, 0.001, 1e6, 0.0311261743904],
        [0.001, 0.001, 1e8, 0.0441662417917],
        [0.01, 0.001, 1e6, 0.165032459832],
        [0.01, 0.001, 1e8, 0.166782915435],
        [0.1, 0.1, 1e6, 0.432568169512],
        [0.1, 0.01, 1e8, 0.512577811883],
        [0.5, 0.1, 1e6, 0.993096008005],
        [2.0, 0.5, 1e8, 0.999999987502],
        [10.0, 10.0, 1e6, 0.426401198214],
        [10.0, 10.0, 1e8, 0.426401430366],
    ];

    #[test]
    fn turbulence_moves_grains_as_tabulated() {
        for [a, b, reynolds, speed] in TABLE {
            let found = eddies(b, a, reynolds.powf(-0.5)).sqrt();
            let error = (found / speed - 1.0).abs();
            // The table has twelve digits; the smallest speeds come out of its differences with fewer.
            assert!(error < 1e-8, "{a} {b} {reynolds}: {found}, {error:e}");
        }
    }

    #[test]
    fn turbulence_has_the_limits_of_small_intermediate_and_heavy_grains() {
        let speed = |a: f64, b: f64, reynolds: f64| eddies(a, b, reynolds.powf(-0.5)).sqrt();
        let near = |found: f64, limit: f64, bar: f64| {
            assert!((found / limit - 1.0).abs() < bar, "{found} {limit}");
        };
        // Ormel & Cuzzi, eqs 27 to 29; what remains is of the order of St Re^(1/2), of Re^(-1/2) / St and St.
        near(speed(1e-6, 1e-7, 1e8), 1e2 * 0.9e-6, 0.006);
        near(
            speed(0.001, 0.001, 1e8),
            (0.001f64 * 1.9692307).sqrt(),
            0.005,
        );
        near(
            speed(30.0, 4.0, 1e8),
            (1.0 / 31.0 + 1.0 / 5.0f64).sqrt(),
            1e-4,
        );
    }

    #[test]
    fn the_boundary_between_the_classes_is_as_tabulated() {
        for (stokes, y) in [
            (1e-4, 1.60030889919),
            (0.05, 1.57091119434),
            (0.3, 1.43400780717),
            (0.7, 1.21885180191),
            (0.9, 1.08696526709),
            (1.0, 1.0),
        ] {
            let error = (boundary(stokes) - y).abs();
            assert!(error < 1e-9, "{stokes}: {error:e}");
        }
    }

    #[test]
    fn molecules_make_grains_tremble() {
        const BOLTZMANN: f64 = 1.380649e-16;
        for (m1, m2, temperature, speed) in [
            (1e-12, 1e-12, 100.0, 0.265171409032),
            (1e-12, 1e-9, 280.0, 0.313911880727),
        ] {
            let sources = Sources {
                molecule: 3.9e-24,
                turbulence: None,
                motion: Motion::Still,
            };
            let c = (BOLTZMANN * temperature / 3.9e-24f64).sqrt();
            let gas = Ambient {
                rho: 1e-10,
                c,
                omega: 0.0,
            };
            let grain = |m| Grain {
                m,
                stokes: 0.1,
                u: Vec3::zeros(),
            };
            let found = sources.conditions(&gas).speed(&grain(m1), &grain(m2));
            assert!((found / speed - 1.0).abs() < 1e-9, "{found} {speed}");
        }
    }

    #[test]
    fn drift_has_its_largest_speed_at_unit_stokes_number_and_bodies_feel_all_the_wind() {
        let u = steady(1.0, 30.0, 2.0);
        assert!((u - Vec3::new(-30.0, 15.0, -1.0)).norm() < 1e-13);
        for stokes in [0.5, 0.99, 1.01, 2.0] {
            assert!(steady(stokes, 30.0, 0.0).x > u.x);
        }
        assert!((steady(1e9, 30.0, 0.0) - Vec3::new(0.0, 30.0, 0.0)).norm() < 1e-6);
        let small = steady(1e-3, 30.0, 2.0);
        assert!((small - Vec3::new(-0.06, 3e-5, -2e-3)).norm() < 1e-7);
    }

    #[test]
    fn the_reynolds_number_is_that_of_the_molecules() {
        let molecules = Molecules {
            mass: 3.9e-24,
            cross_section: 2e-15,
        };
        let gas = Ambient {
            rho: 1e-9,
            c: 1e5,
            omega: 2e-7,
        };
        let turbulence = Turbulence {
            alpha: 1e-3,
            reynolds: Reynolds::Of(molecules),
        };
        // nu = sqrt(2/pi) 1e5 cm/s 1.95 cm.
        let expected = 1e-3 * 1e10 / 2e-7 / ((2.0 / PI).sqrt() * 1e5 * 1.95);
        assert!((turbulence.reynolds(&gas) / expected - 1.0).abs() < 1e-12);
    }

    /// Largest bound by the speed, over grains of very different sizes, in gas of unit sound speed; no speed may be above.
    fn looseness(sources: &Sources, mean: Vec3) -> f64 {
        let gas = Ambient {
            rho: 1.0,
            c: 1.0,
            omega: 1.0,
        };
        let conditions = sources.conditions(&gas);
        let grain = |stokes: f64| Grain {
            m: stokes.powi(3),
            stokes,
            u: sources.drift(stokes, Vec3::zeros(), 1.0, 0.1),
        };
        let sizes = || (0..90).map(|k| grain(10f64.powf(-7.0 + 0.1 * f64::from(k))));
        let mut most: f64 = 0.0;
        for (one, two) in sizes().flat_map(|one| sizes().map(move |two| (one, two))) {
            let speed = conditions.speed(&one, &two);
            let [[s1, g1], [s2, g2]] = [one, two].map(|grain| conditions.bounds(&grain, mean));
            let bound = s1 + s2 + g1.max(g2);
            assert!(
                speed <= bound * (1.0 + 1e-12),
                "{one:?} {two:?}: {speed} {bound}"
            );
            if one.stokes > 2.0 * two.stokes && two.stokes < 0.1 {
                most = most.max(bound / speed);
            }
        }
        most
    }

    #[test]
    fn bounds_hold_and_are_not_far_above() {
        let turbulence = Some(Turbulence {
            alpha: 0.01,
            reynolds: Reynolds::Number(1e7),
        });
        let alone = Sources {
            molecule: 0.0,
            turbulence,
            motion: Motion::Still,
        };
        let all = Sources {
            molecule: 1e-10,
            motion: Motion::Steady(0.03),
            ..alone
        };
        let found = [
            looseness(&alone, Vec3::zeros()),
            looseness(&all, Vec3::new(-1e-3, 0.0, 0.0)),
        ];
        println!("{found:?}");
        assert!(found[0] < 4.5 && found[1] < 2.0, "{found:?}");
    }
}
