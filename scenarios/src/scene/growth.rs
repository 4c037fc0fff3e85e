//! Growth of grains as a scene has it.

/// How grains grow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Growth {
    /// By a kernel with an exact solution; the rate is in code units.
    Exact {
        kernel: ExactKernel,
        rate: f64,
    },
    Physical(Collisional),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExactKernel {
    Constant,
    Sum,
    Product,
}

/// Growth by cross section and relative speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collisional {
    pub brownian: bool,
    /// Of the turbulence; zero without.
    pub alpha: f64,
    /// `None`: by the molecules' viscosity.
    pub reynolds: Option<f64>,
    pub motion: GrainMotion,
    /// Infinite without a threshold.
    pub bouncing_speed: f64,
    pub fragmentation_speed: f64,
    pub transition: f64,
    /// Whether impact speeds are spread as Maxwell's.
    pub spread: bool,
    /// n(m) ~ m^-slope.
    pub fragment_slope: f64,
    /// Of the smallest fragments, and of what aggregates are made of.
    pub monomer_radius: f64,
    pub erosion_ratio: f64,
    pub erosion: f64,
    /// Infinite without mass transfer.
    pub transfer_ratio: f64,
    pub transfer: f64,
    /// The energy of porous aggregates that rolls monomers; `None`: compact grains.
    pub rolling_energy: Option<f64>,
}

/// Motion of grains through the gas that makes them meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GrainMotion {
    None,
    /// That of the superparticles.
    Resolved,
    /// Steady drift in a head wind.
    Steady {
        headwind: f64,
    },
}
