//! The settings of the hydrodynamics, and the defaults that they have.

use nbody::points::Domain;

use crate::kernel::unit_sphere;
use crate::{
    BackgroundPressure, Conduction, Eos, Formulation, Gradient, KernelKind, Physical, Precision,
    Reconstruction, Viscosity,
};

/// The limiter of gas whose steps heed no neighbour: to show what that costs.
pub const UNLIMITED: u32 = u32::MAX;

/// The least P / rho by the square of the largest speed that a stress reckons with: far below its rounding.
const LEAST: f64 = 1e-14;

/// What the gas of a scene is and how it is solved; constant over a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Hydro {
    pub domain: Domain,
    pub formulation: Formulation,
    /// zeta of the pressure formulation, which sums P^zeta.
    pub exponent: f64,
    /// Whether the sums follow the smoothing length.
    pub grad_h: bool,
    pub gradient: Gradient,
    pub kernel: KernelKind,
    pub precision: Precision,
    /// Wanted smooth neighbour number V_d H^d n.
    pub neighbours: f64,
    /// Relative error of h.
    pub tolerance: f64,
    /// h of a particle that has too few neighbours; infinite: what encloses all gas.
    pub largest_h: f64,
    pub eos: Eos,
    pub viscosity: Viscosity,
    pub reconstruction: Reconstruction,
    pub physical: Physical,
    /// Without effect on gas that is bound to a temperature.
    pub conduction: Conduction,
    /// A uniform pressure that forces leave out, see [`crate::background`].
    pub background_pressure: BackgroundPressure,
    /// C in dt <= 2 C h / v_sig; v_sig is about twice the sound speed.
    pub courant: f64,
    /// C in dt <= C sqrt(h / |acceleration|).
    pub force_factor: f64,
    /// How many times longer than its neighbour's a step may be, a power of two; [`UNLIMITED`] leaves neighbours to their own criteria.
    pub limiter: u32,
    /// Internal energy below which gas does not cool by expansion.
    pub least_u: f64,
}

impl Hydro {
    /// Settings that suit most scenes.
    pub fn new(domain: Domain, eos: Eos) -> Self {
        Self {
            domain,
            formulation: Formulation::Density,
            exponent: 1.0,
            grad_h: true,
            gradient: Gradient::Standard,
            kernel: KernelKind::WendlandC2,
            precision: Precision::Double,
            neighbours: if domain.dimensions() == 3 { 58.0 } else { 24.0 },
            tolerance: 1e-4,
            largest_h: f64::INFINITY,
            eos,
            viscosity: Viscosity::Constant {
                alpha: 0.7,
                beta: 2.0,
            },
            reconstruction: Reconstruction::None,
            physical: Physical::None,
            conduction: Conduction::NONE,
            background_pressure: BackgroundPressure::NONE,
            courant: 0.25,
            force_factor: 0.25,
            limiter: 4,
            least_u: 0.0,
        }
    }

    /// The same in the domain as it is at `time`.
    pub fn at(self, time: f64) -> Self {
        Self {
            domain: self.domain.at(time),
            ..self
        }
    }

    /// 2 or 3.
    pub fn dimensions(&self) -> usize {
        self.domain.dimensions()
    }

    /// The setting that the equation of state cannot stand beside: sums of energy and conduction take P/rho and u from the sound speed.
    pub fn unsuited(&self) -> Option<&'static str> {
        if self.eos.follows_sound_speed() {
            return None;
        }
        match (self.formulation, self.conduction.alpha > 0.0) {
            (Formulation::Smoothed, _) => Some("hydro.formulation"),
            (_, true) => Some("conduction.alpha"),
            _ => None,
        }
    }

    /// Whether pressures and what is summed to them are solved for together.
    #[inline(always)]
    pub fn solves_pressure(&self) -> bool {
        self.formulation == Formulation::Pressure && self.eos.follows_density()
    }

    /// Whether heat is conducted.
    pub fn conducts(&self) -> bool {
        assert!(
            self.conduction.alpha >= 0.0,
            "heat is conducted from the hotter to the colder"
        );
        self.conduction.alpha > 0.0 && self.eos.is_free() && self.eos.follows_sound_speed()
    }

    /// Whether stresses act on masses, whatever the pressure acts on: sums of pressures weigh nothing where gas is cold.
    pub(crate) fn stress_by_mass(&self) -> bool {
        let apart =
            self.formulation == Formulation::Pressure && self.gradient == Gradient::Standard;
        apart || self.formulation.sums_mass()
    }

    /// The setting that others of these rule out, and why.
    pub fn clashing(&self) -> Option<(&'static str, &'static str)> {
        if self.background_pressure.is_some()
            && self.gradient == Gradient::Matrix
            && self.eos.is_free()
        {
            return Some((
                "hydro.background_pressure",
                "is left out of the forces of gas of free energy where gradient = \"standard\"",
            ));
        }
        if self.solves_pressure() && self.exponent != 1.0 {
            return Some((
                "hydro.pressure_exponent",
                "has no meaning where pressures may be negative or are solved for; allowed there is 1",
            ));
        }
        if self.solves_pressure() && self.gradient == Gradient::Matrix {
            return Some((
                "hydro.gradient",
                "\"matrix\" weighs by pressures, which may be negative in this equation of state; allowed there is \"standard\"",
            ));
        }
        if self.reconstructs() && self.stressed() {
            return Some((
                "viscosity.reconstruction",
                "is of viscosities between pairs beside which no particle has a stress: it goes with \"constant\", \"balsara\", \"cullen-dehnen\" and \"planar-switch\" where gradient = \"standard\" and no physical viscosity acts",
            ));
        }
        match self.formulation {
            Formulation::Smoothed if self.gradient == Gradient::Matrix => Some((
                "hydro.gradient",
                "\"matrix\" drives particles at a surface apart without bound where formulation = \"smoothed-energy\"; allowed there is \"standard\"",
            )),
            Formulation::Pressure | Formulation::Smoothed
                if self.viscosity.is_stress() && self.eos.is_free() =>
            {
                Some((
                    "viscosity.kind",
                    "heats single particles, which has no bound where sums are of pressures or energies and gas is cold; allowed there are viscosities between pairs: \"constant\", \"balsara\", \"cullen-dehnen\", \"planar-switch\"",
                ))
            }
            _ => None,
        }
    }

    /// Whether particles bring a stress into pairs: a viscous one, or a pressure whose gradient is corrected.
    pub(crate) fn stressed(&self) -> bool {
        self.viscous_stress() || self.gradient == Gradient::Matrix
    }

    /// Whether they bring a viscous one.
    pub(crate) fn viscous_stress(&self) -> bool {
        self.viscosity.is_stress() || self.physical != Physical::None
    }

    /// P / rho in units of a sweep, which a stress needs to be more than nothing where x goes with it: it is weighed by x / y.
    #[inline(always)]
    pub(crate) fn floored(&self, p_by_rho: f64) -> f64 {
        if self.formulation == Formulation::Pressure && self.stressed() && !self.solves_pressure() {
            p_by_rho.max(LEAST)
        } else {
            p_by_rho
        }
    }

    /// Whether they bring the strain of the flow about them.
    pub(crate) fn reconstructs(&self) -> bool {
        self.reconstruction == Reconstruction::Linear && self.viscosity.parameters().is_some()
    }

    /// Whether tensors of the flow are wanted.
    pub(crate) fn wants_tensor(&self) -> bool {
        self.stressed() || self.reconstructs() || self.viscosity.heeds_strain()
    }

    /// Whether the linear-exact gradient of the velocity is wanted.
    pub(crate) fn wants_gradient(&self) -> bool {
        self.viscosity.remembers() || self.wants_tensor()
    }

    /// Whether what a particle brings into pairs follows from its mass and sound speed.
    pub(crate) fn plain(&self) -> bool {
        let zeta = self.formulation == Formulation::Pressure && self.exponent != 1.0;
        let smoothed = self.formulation == Formulation::Smoothed && self.conducts();
        let shifted = self.formulation == Formulation::Pressure
            && self.background_pressure.is_some()
            && self.conducts();
        !(self.stressed() || zeta || smoothed || shifted || self.solves_pressure())
    }

    /// Kernel support by smoothing length, H / h.
    pub fn support(&self) -> f64 {
        self.kernel.support(self.dimensions())
    }

    /// Radius within which the wanted neighbours are, if there are `density` particles a volume.
    pub fn reach_at(&self, density: f64) -> f64 {
        let d = self.dimensions();
        (self.neighbours / (unit_sphere(d) * density)).powf(1.0 / d as f64)
    }

    /// The largest kernel support of gas that fills a box of diagonal `extent`.
    pub(crate) fn largest_reach(&self, extent: f64) -> f64 {
        let set = self.support() * self.largest_h;
        match self.domain.size() {
            Some(size) => set.min(4.0 * size.max()),
            None if set.is_finite() => set,
            None if extent > 0.0 => 2.0 * extent,
            None => 1.0,
        }
    }
}
