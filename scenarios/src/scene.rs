//! A scene: what is modelled and how, with every default filled in.
//!
//! All numbers are in code units of `units` (angles in radians), except wall-clock times, which are in seconds. A population that is
//! not modelled is `None` here and nowhere else. Made by `Scene::load` or `Scene::parse`; trusted by everything that follows.

use coupling::edge::Zone;
use gas::rearrangement::Order;
use std::path::PathBuf;
use std::sync::Arc;

mod dust;
mod growth;

pub use self::dust::{Composition, Dust, DustAmount, DustBlock, DustDrag, Sizes, Turbulence};
pub use self::growth::{Collisional, ExactKernel, GrainMotion, Growth};
pub use gas::{
    BackgroundPressure, Formulation, Gradient, KernelKind, Physical, Precision, Reconstruction,
    Viscosity,
};
use nbody::integrators::wisdom_holman::jacobi::Scheme;
use nbody::points::{Domain, Vec3};

use crate::units::Units;

/// A resolved scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Stem of the file's name.
    pub name: String,
    pub title: String,
    pub run: Run,
    pub units: Units,
    pub domain: Domain,
    pub local: Local,
    /// Particles of any population that the scene has, beside or instead of generators; an absolute path.
    pub initial_file: Option<PathBuf>,
    pub star: Option<Star>,
    pub gas: Option<Gas>,
    pub dust: Option<Dust>,
    /// Present when the scene has planetesimals or planets: it also says how all bodies move.
    pub planetesimals: Option<Planetesimals>,
    pub planets: Vec<Planet>,
    pub surroundings: Surroundings,
    pub gravity: Gravity,
    pub coupling: Coupling,
    pub accuracy: Accuracy,
}

/// How long, with what output and from what seed.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    pub end_time: f64,
    pub snapshots: Snapshots,
    /// Wall-clock seconds between checkpoints.
    pub checkpoint: f64,
    pub seed: u64,
    /// The base step of everything; bodies may have their own in `Planetesimals::time_step`.
    pub time_step: TimeStep,
    pub write_accelerations: bool,
}

/// When snapshots are written. The start and the end are written too unless it is `None`.
#[derive(Clone, Debug, PartialEq)]
pub enum Snapshots {
    None,
    Every(f64),
    /// Ascending.
    At(Vec<f64>),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimeStep {
    Auto,
    Fixed(f64),
}

/// What a shearing box takes over from the disk that it is cut from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Local {
    /// Whether the star pulls towards the plane in the middle of the box.
    pub vertical_gravity: bool,
    /// How much slower than Kepler's gas without dust turns: it is pushed outwards by 2 Omega times this.
    pub headwind: f64,
}

/// The star, at the origin and at rest at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Star {
    pub mass: f64,
    /// Zero: nothing is accreted.
    pub accretion_radius: f64,
}

/// Softening length of gravity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Softening {
    /// Each particle's own smoothing length.
    SmoothingLength,
    Fixed(f64),
}

#[derive(Clone, Debug, PartialEq)]
pub struct Gas {
    /// Particles of the disk; zero without a disk.
    pub particles: usize,
    pub softening: Softening,
    pub disk: Option<Disk>,
    pub blocks: Vec<GasBlock>,
    pub eos: Eos,
    /// None of what is no gas.
    pub mean_molecular_weight: Option<f64>,
    pub cooling: Cooling,
    /// Zones that damp waves.
    pub edge: Option<Edge>,
    pub hydro: Hydro,
    pub viscosity: Viscosity,
    pub reconstruction: Reconstruction,
    pub physical: Physical,
    /// alpha of the conduction; none if zero.
    pub conduction: f64,
    pub rearrange: Option<Order>,
}

/// A disk about the star: Sigma ~ r^slope between the radii, c_s ~ r^-exponent, H/r = aspect_ratio at the reference radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk {
    pub amount: DiskAmount,
    pub slope: f64,
    pub reference_radius: f64,
    /// At `reference_radius`, of the gas's (isothermal) sound speed; agrees with the equation of state.
    pub aspect_ratio: f64,
    pub exponent: f64,
    pub inner_radius: f64,
    pub outer_radius: f64,
    /// Width of the edges in scale heights.
    pub taper: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DiskAmount {
    /// At the reference radius.
    SurfaceDensity(f64),
    /// Of the whole disk.
    Mass(f64),
}

/// A box [lo, hi) filled with particles of equal mass. In two dimensions `density` is a mass an area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    pub lo: Vec3,
    pub hi: Vec3,
    /// Distance between neighbours on the cubic lattice; every lattice holds one particle in `spacing`^dimensions.
    pub spacing: f64,
    pub lattice: Lattice,
    pub density: f64,
    pub velocity: Vec3,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GasBlock {
    pub block: Block,
    pub thermal: Thermal,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lattice {
    Cubic,
    Bcc,
    Random,
    /// Settled to equal density, continued periodically.
    Glass,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Thermal {
    Pressure(f64),
    InternalEnergy(f64),
    /// The equation of state alone sets the pressure.
    Eos,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Eos {
    Ideal {
        gamma: f64,
    },
    Isothermal {
        sound_speed: f64,
    },
    /// c_s = sound_speed (R / reference_radius)^-exponent, R the distance from the star in the disk's plane.
    LocallyIsothermal {
        aspect_ratio: f64,
        /// At the reference radius: aspect_ratio times the Keplerian speed.
        sound_speed: f64,
        exponent: f64,
        reference_radius: f64,
    },
    Barotropic(gas::Barotropic),
    Stiffened(gas::Stiffened),
    /// One of the materials that are known by name.
    Tillotson {
        material: &'static str,
    },
    /// `table` is what stands in the file, an absolute path, in code units.
    Tabulated {
        file: PathBuf,
        table: Arc<gas::Table>,
    },
}

impl Eos {
    /// The word that scenes know it by.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Ideal { .. } => "ideal",
            Self::Isothermal { .. } => "isothermal",
            Self::LocallyIsothermal { .. } => "locally-isothermal",
            Self::Barotropic(_) => "barotropic",
            Self::Stiffened(_) => "stiffened",
            Self::Tillotson { .. } => "tillotson",
            Self::Tabulated { .. } => "tabulated",
        }
    }

    /// Whether the internal energy follows from heating and work alone.
    pub fn is_free(&self) -> bool {
        !matches!(
            self,
            Self::Isothermal { .. } | Self::LocallyIsothermal { .. } | Self::Barotropic(_)
        )
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cooling {
    None,
    /// In beta / Omega, down to a floor if there is one.
    Beta {
        beta: f64,
        floor: Option<Temperature>,
    },
    /// Down and up.
    Relaxation {
        time: CoolingTime,
        towards: Temperature,
    },
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CoolingTime {
    /// In 1/Omega.
    Orbital(f64),
    Time(f64),
}

/// Isothermal sound speeds about the star, as those of a locally isothermal gas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Temperature {
    pub aspect_ratio: f64,
    /// At the reference radius.
    pub sound_speed: f64,
    pub exponent: f64,
    pub reference_radius: f64,
}

/// Zones at a disk's edges that damp waves, and what holds the inner edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    pub inner: Option<Zone>,
    pub outer: Option<Zone>,
    /// Of the damping, in 1/Omega.
    pub time: f64,
    /// Whether gas at the accretion radius feels the pressure of what the star has accreted.
    pub supported: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hydro {
    pub formulation: Formulation,
    /// zeta of the pressure formulation.
    pub exponent: f64,
    pub grad_h: bool,
    pub gradient: Gradient,
    pub kernel: KernelKind,
    pub neighbours: f64,
    pub courant: f64,
    /// Relative error of the neighbour number at which the smoothing length is found.
    pub tolerance: f64,
    pub precision: Precision,
    /// Pressure that forces leave out.
    pub background_pressure: BackgroundPressure,
}

/// The generated belt, and how all bodies (planetesimals, planets, star) move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planetesimals {
    /// Zero when all bodies are planets or come from a file: then mass to density mean nothing and are zero.
    pub number: usize,
    /// Of each.
    pub mass: f64,
    pub inner_radius: f64,
    pub outer_radius: f64,
    /// Of the surface density.
    pub slope: f64,
    /// Root mean square.
    pub eccentricity: f64,
    /// Root mean square, radians.
    pub inclination: f64,
    /// Zero: bodies without a size.
    pub density: f64,
    /// Of bodies without mass; zero for the others, whose mass and density give it.
    pub radius: f64,
    pub integrator: Integrator,
    pub coordinates: Coordinates,
    /// Of the hybrid map, in Hill radii.
    pub cutoff: f64,
    pub softening: f64,
    pub time_step: TimeStep,
    pub drag: BodyDrag,
    pub collisions: Collisions,
    /// Mass fractions of ice, rock and iron at the start; `None`: not followed.
    pub composition: Option<[f64; 3]>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Integrator {
    Auto,
    Leapfrog,
    WisdomHolman,
    Hermite,
    Hybrid,
    GaussRadau,
    /// In a shearing box.
    Epicycles,
}

/// Coordinates of the Wisdom-Holman map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coordinates {
    DemocraticHeliocentric,
    Jacobi(Scheme),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BodyDrag {
    None,
    Adachi,
    ConstantStoppingTime(f64),
    /// a = -coefficient |v| v; coefficient per length.
    Quadratic(f64),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Collisions {
    None,
    Merge,
    /// Speed along and across the line of centres after by that before.
    Bounce {
        restitution: f64,
        tangential_restitution: f64,
    },
    Fragment {
        /// Of the smallest fragment.
        fragment_mass: f64,
        /// Of one impact, beside the largest remnant.
        most_fragments: usize,
        /// c* and mu of the scaling laws, and the density that they refer to.
        c_star: f64,
        mu: f64,
        reference_density: f64,
    },
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planet {
    pub mass: f64,
    /// Zero: without a size.
    pub radius: f64,
    /// Of a planet without mass that has a size; zero for the others.
    pub density: f64,
    /// The time in which the semi-major axis grows by e; negative inward. `None`: no prescribed migration.
    pub migration_time: Option<f64>,
    pub orbit: Orbit,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Orbit {
    /// About the star; angles in radians.
    Elements {
        semi_major_axis: f64,
        eccentricity: f64,
        inclination: f64,
        longitude_of_node: f64,
        argument_of_pericentre: f64,
        mean_anomaly: f64,
    },
    State {
        position: Vec3,
        velocity: Vec3,
    },
}

/// What acts on bodies by a formula instead of by particles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Surroundings {
    /// With relativity: the speed of light.
    pub speed_of_light: Option<f64>,
    pub oblateness: Option<Oblateness>,
    pub disk: Option<GasDisk>,
}

/// The star's flattening.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oblateness {
    pub j2: f64,
    pub equatorial_radius: f64,
    /// Unit vector.
    pub pole: Vec3,
}

/// A disk of gas that is a formula: Sigma ~ r^slope, H/r ~ r^flaring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GasDisk {
    /// At the reference radius.
    pub surface_density: f64,
    pub slope: f64,
    pub reference_radius: f64,
    /// At the reference radius.
    pub aspect_ratio: f64,
    pub flaring: f64,
    pub inner_radius: f64,
    pub outer_radius: f64,
    /// How much slower than circular the gas is, as a part; `None`: what its pressure says.
    pub headwind: Option<f64>,
    pub mean_molecular_weight: f64,
    pub drag: BodyDrag,
    /// Whether bodies with mass feel its torques.
    pub migration: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gravity {
    pub method: GravityMethod,
    pub opening: Opening,
    /// G in code units.
    pub constant: f64,
    pub pulls: Pulls,
    /// Whether the field of fluids and planetesimals kicks the gas at steps of its own (FAST).
    pub separate_steps: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GravityMethod {
    Tree,
    Direct,
    None,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Opening {
    /// Wanted root mean square relative error of the force.
    ForceError(f64),
    Angle(f64),
}

/// Who pulls and is pulled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mass {
    Gas = 0,
    Dust = 1,
    Planetesimals = 2,
    Planets = 3,
    Star = 4,
}

/// Which masses pull which; what the scene does not have pulls nothing and is pulled by nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Pulls(pub [[bool; 5]; 5]);

impl Scene {
    /// Whether dust is in gas that is a formula.
    pub fn has_dust_in_formula(&self) -> bool {
        self.dust.is_some() && self.surroundings.disk.is_some()
    }

    /// Whether the stress of the gas stirs the dust.
    pub fn has_measured_alpha(&self) -> bool {
        let dust = self.dust.as_ref();
        dust.is_some_and(|dust| dust.turbulence.known().is_none())
    }

    /// Whether anything kicks bodies by a formula.
    pub fn has_surroundings(&self) -> bool {
        self.surroundings != Surroundings::default()
            || self.planets.iter().any(|p| p.migration_time.is_some())
    }
}

impl Gravity {
    /// Whether gas or dust pull the gas.
    pub fn fluids_pull_gas(&self) -> bool {
        let pulls = |source| self.pulls.has(source, Mass::Gas);
        self.method != GravityMethod::None && (pulls(Mass::Gas) || pulls(Mass::Dust))
    }
}

impl Pulls {
    /// Whether `source` pulls `target`.
    pub fn has(&self, source: Mass, target: Mass) -> bool {
        self.0[source as usize][target as usize]
    }
}

/// Which pairs exchange momentum by drag, and whether the gas feels it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupling {
    pub gas_dust: bool,
    pub gas_planetesimals: bool,
    pub feedback: bool,
    /// Of the heat of friction, what the gas keeps; the rest is radiated.
    pub heat_share: f64,
    /// Whether grains of several stopping times, and bodies, are solved together with the gas that they share.
    pub mixtures: bool,
    /// Error of the splitting that base steps keep to; `None`: they do not depend on it.
    pub tolerance: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    pub preset: Preset,
    /// dt <= acceleration_step sqrt(length / |a|), the length being smoothing length or softening.
    pub acceleration_step: f64,
    /// dt <= orbit_step / Omega at the distance from the star.
    pub orbit_step: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    Draft,
    Standard,
    Precise,
    Reference,
}
