//! Growth: from a scene's keys to the laws of collisions.

use std::f64::consts::PI;

use dust::coagulation::{Kernel, Physics};
use dust::outcome::{Cratering, Rules};
use dust::porosity::Monomers;
use dust::relative_speed::{Motion, Reynolds, Sources, Turbulence};

use super::{dust_law, molecules};
use crate::scene::{Collisional, Dust, ExactKernel, GrainMotion, Growth, Scene};

/// How the scene's grains grow; none if they do not.
pub fn kernel(scene: &Scene, dust: &Dust) -> Option<Kernel> {
    Some(match dust.growth? {
        Growth::Exact { kernel, rate } => match kernel {
            ExactKernel::Constant => Kernel::Constant(rate),
            ExactKernel::Sum => Kernel::Sum(rate),
            ExactKernel::Product => Kernel::Product(rate),
        },
        Growth::Physical(growth) => Kernel::Physical(Physics {
            sources: sources(scene, &growth),
            rules: rules(dust, &growth),
            porosity: growth.rolling_energy.map(|rolling_energy| Monomers {
                radius: growth.monomer_radius,
                density: dust.material_density,
                rolling_energy,
                g: scene.gravity.constant,
            }),
            law: dust_law(scene, dust),
            spread: growth.spread,
        }),
    })
}

fn sources(scene: &Scene, growth: &Collisional) -> Sources {
    let molecules = molecules(scene);
    let reynolds = growth
        .reynolds
        .map_or(Reynolds::Of(molecules), Reynolds::Number);
    Sources {
        molecule: if growth.brownian { molecules.mass } else { 0.0 },
        turbulence: (growth.alpha > 0.0).then_some(Turbulence {
            alpha: growth.alpha,
            reynolds,
        }),
        motion: match growth.motion {
            GrainMotion::None => Motion::Still,
            GrainMotion::Resolved => Motion::Resolved,
            GrainMotion::Steady { headwind } => Motion::Steady(headwind),
        },
    }
}

fn rules(dust: &Dust, growth: &Collisional) -> Rules {
    Rules {
        bouncing_speed: growth.bouncing_speed,
        fragmentation_speed: growth.fragmentation_speed,
        transition: growth.transition,
        slope: growth.fragment_slope,
        monomer: 4.0 / 3.0 * PI * growth.monomer_radius.powi(3) * dust.material_density,
        erosion: Cratering {
            ratio: growth.erosion_ratio,
            amount: growth.erosion,
        },
        transfer: Cratering {
            ratio: growth.transfer_ratio,
            amount: growth.transfer,
        },
    }
}
