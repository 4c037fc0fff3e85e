//! Gas particles: state, what is derived from it, and the rates of the last sweep.
//!
//! A step of particle i is kick-drift-kick. Pair forces act with the shorter step of the pair: the force sweep at a tick yields the
//! impulses that close the steps ending now (`dv_close`) and those that open the steps beginning now (`dv_open`), for active particles
//! and for inactive ones with an active neighbour, so that momentum is exchanged pair by pair whatever the steps are. Between its ticks
//! a particle is seen through its prediction (`v_pred`, `u_pred`, `h`, `rho`).

use fearless_simd::Level;
use nbody::columns;
use nbody::points::sort::{Cube, Curve, MANY};
use nbody::points::sum::CHUNK;
use nbody::points::{Clock, Columns, Dimension, Domain, Label, Scratch, Tree, Vec3};
use rayon::prelude::*;

use crate::background::Background;
use crate::forces::Pace;
use crate::leaves::{Leaf, UNSEEN};
use crate::timestep::Heat;
use crate::vicinity::Vicinity;
use crate::workspace::Both;

columns! {
    /// State of gas particles, code units.
    pub struct Particles {
        /// identity
        id: Integer = Label::snapshot("ParticleIDs", Dimension::NONE, "identity"),
        /// position
        x: Vector = Label::snapshot("Coordinates", Dimension::LENGTH, "position"),
        /// velocity, kicked to the middle of the step
        v: Vector = Label::snapshot("Velocities", Dimension::VELOCITY, "velocity"),
        /// mass
        m: Real = Label::snapshot("Masses", Dimension::MASS, "mass"),
        /// specific internal energy, kicked to the middle of the step
        u: Real = Label::snapshot("InternalEnergies", Dimension::SPECIFIC_ENERGY, "specific internal energy"),
        /// smoothing length: twice the standard deviation of the kernel (Dehnen & Aly 2012)
        h: Real = Label::snapshot("SmoothingLengths", Dimension::LENGTH, "smoothing length, twice the standard deviation of the kernel"),
        /// mass fraction of water vapour; empty unless ice sublimates
        vapour: Real = Label::snapshot("VapourFractions", Dimension::NONE, "mass fraction of water vapour").optional(),
        /// viscosity parameter alpha
        alpha: Real = Label::snapshot("ViscosityParameters", Dimension::NONE, "viscosity parameter alpha"),
        /// trace of the linear-exact velocity gradient, kept for a switch that asks for its change
        trace_v: Real = Label::checkpoint("VelocityTraces", Dimension::RATE, "trace of the linear-exact velocity gradient").optional(),
        /// density that the continuity equation says, where particles are placed by it
        target: Real = Label::checkpoint("TargetDensities", Dimension::DENSITY, "density that the continuity equation says").optional(),
        /// tick at which the present step began
        begin: Short = Label::checkpoint("StepBegins", Dimension::NONE, "tick at which the step began"),
        /// planned length of the present step in ticks
        span: Short = Label::checkpoint("StepSpans", Dimension::NONE, "planned length of the step in ticks"),
        /// tick at which the present step ends; earlier than planned when woken
        end: Short = Label::checkpoint("StepEnds", Dimension::NONE, "tick at which the step ends"),
        /// tick at which the present step of the field began, where the field has steps of its own
        field_begin: Short = Label::checkpoint("FieldStepBegins", Dimension::NONE, "tick at which the step of the field began").optional(),
        /// length of the present step of the field in ticks
        field_span: Short = Label::checkpoint("FieldStepSpans", Dimension::NONE, "length of the step of the field in ticks").optional(),
    }
}

columns! {
    /// What follows from the state; recomputed whenever a particle is active.
    pub struct Derived {
        /// density
        rho: Real = Label::snapshot("Densities", Dimension::DENSITY, "density"),
        /// pressure
        p: Real = Label::snapshot("Pressures", Dimension::PRESSURE, "pressure"),
        /// sound speed (adiabatic where the gas is)
        cs: Real = Label::checkpoint("SoundSpeeds", Dimension::VELOCITY, "sound speed"),
        /// grad-h correction
        grad_h: Real = Label::checkpoint("GradHTerms", Dimension::NONE, "grad-h correction"),
        /// divergence of the velocity
        div_v: Real = Label::checkpoint("VelocityDivergences", Dimension::RATE, "divergence of the velocity"),
        /// modulus of the curl of the velocity, where a switch asks for it
        curl_v: Real = Label::checkpoint("VelocityCurls", Dimension::RATE, "modulus of the curl of the velocity").optional(),
        /// largest signal speed towards a neighbour
        v_sig: Real = Label::checkpoint("SignalSpeeds", Dimension::VELOCITY, "largest signal speed towards a neighbour"),
        /// pressure of the formulation by that of density and energy, where they are two
        p_ratio: Real = Label::checkpoint("PressureRatios", Dimension::NONE, "pressure of the formulation by that of density and energy").optional(),
        /// what it brings into sums of pressures by its mass, where that is solved for
        content: Real = Label::checkpoint("PressureContents", Dimension::SPECIFIC_ENERGY, "what sums of pressures have of the particle, by its mass").optional(),
        /// diagonal of the correction of gradients, where particles bring a stress
        correction: Vector = Label::checkpoint("GradientCorrections", Dimension::NONE, "diagonal of the correction of gradients").optional(),
        /// its yz, zx and xy components
        correction_off: Vector = Label::checkpoint("GradientCorrectionsOff", Dimension::NONE, "correction of gradients, components yz, zx, xy").optional(),
        /// diagonal of the viscous stress, where particles bring one; or of the strain, 1/time, where velocities are reconstructed
        stress: Vector = Label::checkpoint("ViscousStresses", Dimension::PRESSURE, "diagonal of the viscous stress").optional(),
        /// its yz, zx and xy components
        stress_off: Vector = Label::checkpoint("ViscousStressesOff", Dimension::PRESSURE, "viscous stress, components yz, zx, xy").optional(),
        /// shortest step among the neighbours, in ticks
        near_span: Short = Label::checkpoint("NeighbourSpans", Dimension::NONE, "shortest step among the neighbours in ticks"),
    }
}

columns! {
    /// Rates and impulses of the last sweep, and the prediction that they carry.
    pub struct Rates {
        /// velocity predicted to now
        v_pred: Vector = Label::checkpoint("PredictedVelocities", Dimension::VELOCITY, "velocity predicted to now"),
        /// specific internal energy predicted to now
        u_pred: Real = Label::checkpoint("PredictedInternalEnergies", Dimension::SPECIFIC_ENERGY, "internal energy predicted to now"),
        /// acceleration by pressure and viscosity
        hydro: Vector = Label::checkpoint("HydroAccelerations", Dimension::ACCELERATION, "acceleration by pressure and viscosity"),
        /// acceleration by gravity that has the steps of the forces
        gravity: Vector = Label::checkpoint("GravitationalAccelerations", Dimension::ACCELERATION, "acceleration by gravity").optional(),
        /// acceleration by the field that has steps of its own
        field: Vector = Label::checkpoint("FieldAccelerations", Dimension::ACCELERATION, "acceleration by the field of all masses").optional(),
        /// gravitational potential, while it is reported
        potential: Real = Label::checkpoint("Potentials", Dimension::SPECIFIC_ENERGY, "gravitational potential").optional(),
        /// rate of change of the specific internal energy
        du: Real = Label::checkpoint("HeatingRates", Dimension::SPECIFIC_POWER, "rate of change of the specific internal energy"),
        /// change of velocity that closes the pairs' steps ending now
        dv_close: Vector = Label::checkpoint("ClosingImpulses", Dimension::VELOCITY, "change of velocity that closes steps"),
        /// change of velocity that opens the pairs' steps beginning now
        dv_open: Vector = Label::checkpoint("OpeningImpulses", Dimension::VELOCITY, "change of velocity that opens steps"),
        /// change of internal energy that closes steps
        du_close: Real = Label::checkpoint("ClosingHeat", Dimension::SPECIFIC_ENERGY, "change of internal energy that closes steps"),
        /// change of internal energy that opens steps
        du_open: Real = Label::checkpoint("OpeningHeat", Dimension::SPECIFIC_ENERGY, "change of internal energy that opens steps"),
        /// change of velocity by the drag whose step has begun
        drag_dv: Vector = Label::checkpoint("DragImpulses", Dimension::VELOCITY, "change of velocity by the drag that has begun").optional(),
        /// change of internal energy by it
        drag_du: Real = Label::checkpoint("DragHeats", Dimension::SPECIFIC_ENERGY, "change of internal energy by the drag that has begun").optional(),
        /// time at which it began
        drag_since: Real = Label::checkpoint("DragBegins", Dimension::TIME, "time at which the drag began").optional(),
        /// half of its step
        drag_half: Real = Label::checkpoint("DragHalves", Dimension::TIME, "half of the drag's step").optional(),
        /// length of the step that begins now, in ticks
        next_span: Short = Label::checkpoint("NextSpans", Dimension::NONE, "length of the step that begins now in ticks"),
        /// length of the step of the field that begins now, in ticks
        next_field_span: Short = Label::checkpoint("NextFieldSpans", Dimension::NONE, "length of the step of the field that begins now in ticks").optional(),
    }
}

/// Particles a leaf of the gas tree.
pub const LEAF: usize = 64;

/// All gas of a scene: its columns and the tree over them.
#[derive(Clone, Debug, Default)]
pub struct Gas {
    pub particles: Particles,
    pub derived: Derived,
    pub rates: Rates,
    pub tree: Tree,
    /// Largest kernel support a node, of all its particles and of the active ones; of the last force sweep.
    pub(crate) extent: Vec<f64>,
    pub(crate) active_extent: Vec<f64>,
    /// The tick by which a neighbour wants each particle to end its step; of the last force sweep.
    pub(crate) wake: Vec<u32>,
    /// What bounds each leaf's particles, by node.
    pub(crate) leaves: Vec<Leaf>,
    /// The tick at which all gas was last seen; where sorted gas stands.
    pub(crate) now: u32,
    pub(crate) vicinity: Vicinity,
    pub(crate) nearby: Vec<u32>,
    /// Active particles whose neighbours reach beyond the vicinity.
    pub(crate) beyond: Vec<u32>,
    pub(crate) heats: Vec<Heat>,
    /// How each leaf stands on the clock; of the last force sweep.
    pub(crate) paces: Vec<Pace>,
    /// All gas as the sweeps see it.
    pub(crate) packed: Both,
    /// The instructions that sweeps use, if not the machine's best.
    pub(crate) level: Option<Level>,
    /// What growth of the active leaves has cost since the gas was sorted, in particles that meet their neighbours.
    pub(crate) waste: f64,
    pub(crate) curve: Curve,
    /// The cube that the curve was counted in.
    pub(crate) cube: Option<Cube>,
    /// What predictions are while gas leans.
    pub(crate) upright: (Vec<Vec3>, Vec<f64>),
    /// What forces leave out of pressures.
    pub background: Background,
    scratch: Scratch,
}

/// What sorting costs, a particle: this many particles that meet their neighbours.
const SORT: f64 = 0.1;

impl Gas {
    /// Gas at rest on the clock, predicted where it is.
    pub fn new(particles: Particles) -> Self {
        let n = particles.len();
        let mut gas = Self {
            particles,
            now: UNSEEN,
            ..Self::default()
        };
        gas.derived.resize(n);
        gas.rates.resize(n);
        gas.rates.v_pred.clone_from(&gas.particles.v);
        gas.rates.u_pred.clone_from(&gas.particles.u);
        gas.sort();
        gas
    }

    /// Gas as it was saved; the next end of a base step sorts it.
    pub fn restored(particles: Particles, rates: Rates) -> Self {
        let mut gas = Self {
            particles,
            rates,
            now: UNSEEN,
            ..Self::default()
        };
        gas.derived.resize(gas.particles.len());
        gas
    }

    pub fn len(&self) -> usize {
        self.particles.len()
    }

    pub fn is_empty(&self) -> bool {
        self.particles.is_empty()
    }

    /// Brings all columns into the order of the Morton curve and builds the tree anew.
    pub fn sort(&mut self) {
        self.sort_with(|_| ());
    }

    /// The same; `permute` brings what others keep of the gas into the new order.
    pub(crate) fn sort_with(&mut self, permute: impl FnOnce(&[u32])) {
        if self.len() > MANY {
            // Sweeps fill it anew: until then its memory serves to sort.
            self.packed = Both::default();
        }
        let cube = Cube::around(&self.particles.x);
        self.curve.thread(&self.particles.x, cube);
        self.cube = Some(cube);
        self.waste = 0.0;
        let order = &self.curve.order;
        permute(order);
        let sets: [&mut dyn Columns; 3] = [&mut self.particles, &mut self.derived, &mut self.rates];
        for set in sets {
            if order.len() > MANY {
                set.permute_sparingly(order);
            } else {
                set.permute(order, &mut self.scratch);
            }
        }
        if order.len() > MANY {
            self.curve.order = Vec::new();
        }
        self.tree.build(&self.particles.x, &self.curve.keys, LEAF);
        self.bound();
    }

    /// Brings the tree to the tick of `clock`: its boxes hold what has moved there and what may have. At the ends of base steps, and when the
    /// growth of leaves has cost as much as sorting, that means to move everything, to bring positions back into the box and to sort anew.
    /// Returns the momentum that crossing the faces of a shearing box gave.
    pub fn refit(&mut self, domain: &Domain, clock: &Clock) -> Vec3 {
        if self.is_empty() {
            return Vec3::zeros();
        }
        for &leaf in &self.tree.leaves {
            let node = &mut self.tree.nodes[leaf as usize];
            (node.lo, node.hi) = self.leaves[leaf as usize].span(clock);
        }
        self.tree.enclose();
        if clock.synchronous() || self.waste > SORT * self.len() as f64 {
            self.arrive(domain, clock);
            let gained = self.wrap(domain);
            self.sort();
            return gained;
        }
        Vec3::zeros()
    }

    /// Brings positions back into the box.
    pub(crate) fn wrap(&mut self, domain: &Domain) -> Vec3 {
        let (p, v_pred) = (&mut self.particles, &mut self.rates.v_pred);
        if domain.hill().is_none() {
            p.x.par_iter_mut().with_min_len(CHUNK).for_each(|x| {
                domain.wrap(x);
            });
            return Vec3::zeros();
        }
        let mut gained = Vec3::zeros();
        let velocities = p.v.iter_mut().zip(v_pred);
        for ((x, (v, v_pred)), &m) in p.x.iter_mut().zip(velocities).zip(&p.m) {
            let change = domain.wrap(x);
            *v += change;
            *v_pred += change;
            gained += m * change;
        }
        gained
    }

    /// Removes the particles whose flag is false, of gas that has arrived, and builds the tree anew; the others keep their order.
    pub fn retain(&mut self, keep: &[bool]) {
        self.particles.retain(keep);
        self.derived.retain(keep);
        self.rates.retain(keep);
        if self.curve.keys.len() == keep.len() {
            let mut flags = keep.iter();
            let keys = &mut self.curve.keys;
            keys.retain(|_| *flags.next().expect("one flag a particle"));
            self.tree.build(&self.particles.x, keys, LEAF);
            self.bound();
        } else {
            // Restored gas has not been sorted yet.
            self.sort();
        }
    }

    /// Acceleration by everything but drag, of particle i.
    pub fn acceleration(&self, i: usize) -> Vec3 {
        self.rates.hydro[i] + self.rates.attraction(i)
    }
}
