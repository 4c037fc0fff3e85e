//! Drag of an analytic gas disk on planetesimals and massless bodies: du/dt = -u/t_s(|u|), u = v - v_gas, at the body's place.
//!
//! Solved over the half step by the law's own decay ([`StoppingLaw::e_foldings`]; exact for the quadratic law), so any stopping time is
//! stable. The gas gains the momentum at its own velocity; the rest of the energy, (u^2 - u'^2)/2, is heat. Planets with mass feel no
//! drag here (torques of density waves are far stronger), nor do bodies without a size where the law asks for one.
//! Source: Adachi, Hayashi & Nakazawa (1976, Prog. Theor. Phys. 56, 1756); laws as in [`dust::stopping`].

use dust::{Ambient, Sphere, StoppingLaw};

use super::disk::GasDisk;
use super::{Change, Law, Target};

/// The drag of a disk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiskDrag {
    pub disk: GasDisk,
    pub law: StoppingLaw,
}

impl DiskDrag {
    /// Whether the law depends on a body's size.
    fn sized(&self) -> bool {
        !matches!(
            self.law,
            StoppingLaw::None
                | StoppingLaw::ConstantStoppingTime(_)
                | StoppingLaw::ConstantStokes(_)
                | StoppingLaw::Quadratic(_)
        )
    }
}

impl Law for DiskDrag {
    const NAME: &'static str = "disk drag";

    fn change(&self, target: &Target, span: f64) -> Change {
        let point = target.radius == 0.0 || target.density == 0.0;
        if (target.planet && target.m > 0.0) || (point && self.sized()) {
            return Change::default();
        }
        let Some(gas) = self.disk.at(target.x, target.gm()) else {
            return Change::default();
        };
        let sphere = Sphere {
            radius: target.radius,
            density: target.density,
        };
        let ambient = Ambient {
            rho: gas.rho,
            c: gas.c,
            omega: gas.omega,
        };
        let u = target.v - gas.v;
        let depth = self.law.e_foldings(&sphere, &ambient, u.norm(), span);
        Change {
            dv: u * (-depth).exp_m1(),
            heat: -0.5 * u.norm_squared() * (-2.0 * depth).exp_m1(),
        }
    }
}
