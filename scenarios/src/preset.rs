//! Presets of accuracy: the keys that each sets where a scene does not set them by hand.
//!
//! Errors of the force are rms and relative; `tolerance` is that of the neighbour number; `acceleration_step` and `orbit_step` are the parts
//! of sqrt(length / |a|) and of 1/Omega that steps last. Numbers of neighbours stay below those at which a kernel pairs: about 60 in
//! space and 20 in the plane for the cubic spline, some 200 and 45 for the quintic (Dehnen & Aly 2012); Wendland's never do.

use gas::KernelKind;

use crate::scene::Preset;

/// What a preset sets, beside the number of neighbours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Values {
    pub force_error: f64,
    pub courant: f64,
    pub tolerance: f64,
    pub acceleration_step: f64,
    pub orbit_step: f64,
}

/// Presets by name, from the cheapest to the most exact.
pub const PRESETS: [(&str, Preset); 4] = [
    ("draft", Preset::Draft),
    ("standard", Preset::Standard),
    ("precise", Preset::Precise),
    ("reference", Preset::Reference),
];

/// In the order of [`PRESETS`].
const VALUES: [Values; 4] = [
    Values {
        force_error: 1e-2,
        courant: 0.4,
        tolerance: 1e-3,
        acceleration_step: 0.4,
        orbit_step: 0.2,
    },
    Values {
        force_error: 1e-3,
        courant: 0.25,
        tolerance: 1e-4,
        acceleration_step: 0.25,
        orbit_step: 0.1,
    },
    Values {
        force_error: 1e-3,
        courant: 0.15,
        tolerance: 1e-6,
        acceleration_step: 0.15,
        orbit_step: 0.05,
    },
    Values {
        force_error: 1e-6,
        courant: 0.075,
        tolerance: 1e-8,
        acceleration_step: 0.075,
        orbit_step: 0.025,
    },
];

/// Errors that presets promise of scenes in the form of `tridisk trade --presets`: metrics, and the presets' bars in the order of [`PRESETS`].
const PROMISES: [(&[&str], [f64; 4]); 3] = [
    (
        &["energy", "angular_momentum", "momentum", "mass"],
        [1.25e-4, 2.5e-5, 5e-6, 2e-6],
    ),
    (
        &["position", "eccentricity", "inclination"],
        [1.25e-4, 2.5e-5, 5e-6, 1e-6],
    ),
    // Particles near the edges of rings make this much.
    (&["gas_profile", "dust_profile", "dust_height"], [4e-2; 4]),
];

/// What a preset promises of a metric of `tridisk trade`; nothing of a torque, whose uncertainty no run knows.
pub fn promised(metric: &str, preset: Preset) -> Option<f64> {
    let found = PROMISES.iter().find(|(names, _)| names.contains(&metric));
    found.map(|(_, bars)| bars[preset as usize])
}

/// Neighbours in the plane and in space.
const fn neighbours(kernel: KernelKind) -> [[f64; 4]; 2] {
    match kernel {
        KernelKind::WendlandC2 => [[16.0, 20.0, 28.0, 36.0], [50.0, 64.0, 100.0, 150.0]],
        KernelKind::WendlandC4 => [[22.0, 30.0, 40.0, 50.0], [100.0, 140.0, 200.0, 300.0]],
        KernelKind::WendlandC6 => [[30.0, 42.0, 60.0, 75.0], [150.0, 220.0, 400.0, 600.0]],
        KernelKind::CubicSpline => [[13.0, 14.0, 16.0, 18.0], [40.0, 42.0, 55.0, 58.0]],
        KernelKind::QuinticSpline => [[19.0, 22.0, 26.0, 30.0], [70.0, 82.0, 113.0, 150.0]],
    }
}

impl Preset {
    /// What it sets.
    pub fn values(self) -> Values {
        VALUES[self as usize]
    }

    /// The neighbours that it gives a kernel in so many dimensions.
    pub fn neighbours(self, kernel: KernelKind, dimensions: usize) -> f64 {
        neighbours(kernel)[usize::from(dimensions != 2)][self as usize]
    }

    /// The word that scenes know it by.
    pub fn name(self) -> &'static str {
        PRESETS[self as usize].0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_preset_is_tighter_than_the_one_before() {
        for pair in PRESETS.windows(2) {
            let [loose, tight] = [pair[0].1, pair[1].1];
            assert_eq!(loose.name(), pair[0].0);
            let (a, b) = (loose.values(), tight.values());
            assert!(b.force_error <= a.force_error && b.courant < a.courant);
            assert!(b.tolerance < a.tolerance && b.orbit_step < a.orbit_step);
            assert!(b.acceleration_step < a.acceleration_step);
            for (_, kernel) in crate::read::gas::KERNELS {
                for dimensions in [2, 3] {
                    let more = tight.neighbours(kernel, dimensions);
                    assert!(more > loose.neighbours(kernel, dimensions));
                }
            }
        }
    }

    #[test]
    fn what_a_scene_sets_by_hand_stays() {
        let text = "[run]\nend_time = 1\n[star]\nmass = 1\n[[planet]]\nmass = 0\nsemi_major_axis = 1\n[accuracy]\npreset = \"reference\"\n";
        let read = |more: &str| {
            let text = format!("{text}{more}");
            crate::scene::Scene::parse(&text, "scene", std::path::Path::new("."), &[])
        };
        let values = VALUES[3];
        let scene = read("").expect("a scene");
        assert_eq!(scene.accuracy.orbit_step, values.orbit_step);
        let opening = crate::scene::Opening::ForceError(values.force_error);
        assert_eq!(scene.gravity.opening, opening);
        let scene = read("orbit_step = 0.3\n").expect("a scene");
        assert_eq!(scene.accuracy.orbit_step, 0.3);
        assert_eq!(scene.accuracy.acceleration_step, values.acceleration_step);
    }
}
