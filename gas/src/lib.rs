//! Gas: self-gravitating smoothed particle hydrodynamics.

pub mod alone;
pub mod background;
pub mod conduction;
pub mod cooling;
pub mod density;
pub mod eos;
mod field;
pub mod forces;
pub mod formulation;
pub mod gradients;
pub mod hydro;
pub mod kernel;
mod lanes;
pub mod lean;
mod leaves;
mod neighbours;
pub mod particles;
pub mod probe;
pub mod rearrangement;
#[cfg(test)]
mod samples;
pub mod timestep;
pub mod totals;
mod units;
mod vicinity;
pub mod viscosity;
mod workspace;

pub use background::BackgroundPressure;
pub use conduction::Conduction;
pub use cooling::Cooling;
pub use eos::{Barotropic, Eos, Stiffened, Table, Tillotson};
pub use formulation::Formulation;
pub use gradients::Gradient;
pub use hydro::{Hydro, UNLIMITED};
pub use kernel::{
    CubicSpline, Kernel, KernelKind, QuinticSpline, WendlandC2, WendlandC4, WendlandC6,
};
pub use particles::{Derived, Gas, Particles, Rates};
pub use rearrangement::{Rearrangement, Solves};
pub use timestep::Heat;
pub use totals::Totals;
pub use viscosity::Viscosity;
pub use viscosity::physical::Physical;
pub use viscosity::reconstruction::Reconstruction;
pub use workspace::Precision;
