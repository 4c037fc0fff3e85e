//! Dust as a scene has it.

use super::{Block, Growth, Softening};

#[derive(Clone, Debug, PartialEq)]
pub struct Dust {
    /// Superparticles of the disk; zero without one.
    pub particles: usize,
    pub softening: Softening,
    /// Of the disk's dust; `None` without one.
    pub amount: Option<DustAmount>,
    /// `None`: the initial file says, or no law needs it.
    pub sizes: Option<Sizes>,
    pub material_density: f64,
    /// `None`: not followed; else the material density follows from it.
    pub composition: Option<Composition>,
    /// Dust's scale height by that of the gas.
    pub scale_height: f64,
    /// Edges of the dust disk; those of the gas disk unless given. Zero without a disk.
    pub inner_radius: f64,
    pub outer_radius: f64,
    pub blocks: Vec<DustBlock>,
    pub drag: DustDrag,
    pub turbulence: Turbulence,
    /// `None`: grains stay as they are.
    pub growth: Option<Growth>,
}

/// The turbulence that stirs dust.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Turbulence {
    None,
    /// Of this alpha.
    Given(f64),
    /// Of the alpha of the gas's stress, no less than this.
    Measured {
        floor: f64,
    },
}

impl Turbulence {
    /// alpha where it is known beforehand; zero without turbulence.
    pub fn known(self) -> Option<f64> {
        match self {
            Self::None => Some(0.0),
            Self::Given(alpha) => Some(alpha),
            Self::Measured { .. } => None,
        }
    }
}

/// What grains are made of at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Composition {
    /// Mass fractions of ice, silicate and iron.
    pub fractions: [f64; 3],
    /// Whether ice sublimates and vapour condenses.
    pub sublimation: bool,
}

/// A block of dust, and what its grains have of their own; the rest they have from the dust.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DustBlock {
    pub block: Block,
    pub size: Option<f64>,
    pub material_density: Option<f64>,
    /// What the law of drag holds constant: stopping time or Stokes number.
    pub stopping: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DustAmount {
    DustToGas(f64),
    Mass(f64),
}

/// Radii of grains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sizes {
    One(f64),
    /// dn/ds ~ s^slope.
    Range {
        min: f64,
        max: f64,
        slope: f64,
    },
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DustDrag {
    None,
    Epstein,
    Stokes,
    /// Epstein's and Stokes' laws, joined.
    Auto,
    Adachi,
    ConstantStoppingTime(f64),
    ConstantStokesNumber(f64),
    /// a = -coefficient |v| v; coefficient per length.
    Quadratic(f64),
}

impl DustDrag {
    /// Whether it follows from grains and the molecules of the gas.
    pub fn is_physical(&self) -> bool {
        matches!(
            self,
            Self::Epstein | Self::Stokes | Self::Auto | Self::Adachi
        )
    }
}
