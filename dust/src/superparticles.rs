//! Superparticles: points that carry the mass of a swarm of equal spherical grains.

use nbody::columns;
use nbody::points::sort::{Cube, Curve};
use nbody::points::{Clock, Columns, Dimension, Domain, Label, Scratch, Tree, Vec3};

columns! {
    /// State of the superparticles, code units.
    pub struct Superparticles {
        /// identity
        id: Integer = Label::snapshot("ParticleIDs", Dimension::NONE, "identity"),
        /// position
        x: Vector = Label::snapshot("Coordinates", Dimension::LENGTH, "position"),
        /// velocity, kicked to the middle of the step
        v: Vector = Label::snapshot("Velocities", Dimension::VELOCITY, "velocity"),
        /// mass of the swarm
        m: Real = Label::snapshot("Masses", Dimension::MASS, "mass of the swarm"),
        /// radius of a grain
        grain_radius: Real = Label::snapshot("GrainRadii", Dimension::LENGTH, "radius of a grain"),
        /// material density of a grain
        grain_density: Real = Label::snapshot("GrainDensities", Dimension::DENSITY, "material density of a grain"),
        /// mass fractions of ice, silicate and iron; empty unless the scene follows them
        composition: Vector = Label::snapshot("Compositions", Dimension::NONE, "mass fractions of ice, silicate and iron").optional(),
        /// what the law of drag holds constant, of the grain's own: a stopping time or a Stokes number; zero: the law's
        stopping: Real = Label::checkpoint("StoppingConstants", Dimension::NONE, "stopping time or Stokes number of the grain's own").optional(),
        /// smoothing length of the gas around: the one that gives the grain its wanted number of gas neighbours
        h: Real = Label::checkpoint("SmoothingLengths", Dimension::LENGTH, "smoothing length of the gas around"),
        /// tick at which the present step began
        begin: Short = Label::checkpoint("StepBegins", Dimension::NONE, "tick at which the step began"),
        /// planned length of the present step in ticks
        span: Short = Label::checkpoint("StepSpans", Dimension::NONE, "planned length of the step in ticks"),
        /// tick at which the present step ends
        end: Short = Label::checkpoint("StepEnds", Dimension::NONE, "tick at which the step ends"),
    }
}

columns! {
    /// What follows from the state and the gas around.
    pub struct Derived {
        /// stopping time
        t_stop: Real = Label::snapshot("StoppingTimes", Dimension::TIME, "stopping time in the gas around"),
        /// Stokes number: stopping time by the orbital frequency about the star (zero without a star)
        stokes: Real = Label::snapshot("StokesNumbers", Dimension::NONE, "stopping time by the orbital frequency"),
        /// density of the gas around
        rho_gas: Real = Label::snapshot("GasDensities", Dimension::DENSITY, "density of the gas around"),
        /// h by the sum of sound speed and relative speed; infinite without gas around, zero before it was looked for
        crossing: Real = Label::checkpoint("CrossingTimes", Dimension::TIME, "time in which sound and grain cross the smoothing length"),
        /// isothermal sound speed of the gas around; empty unless somebody asks for it
        c_gas: Real = Label::checkpoint("GasSoundSpeeds", Dimension::VELOCITY, "sound speed of the gas around").optional(),
        /// velocity relative to the gas around; empty as that
        slip: Vector = Label::checkpoint("GasSlips", Dimension::VELOCITY, "velocity relative to the gas around").optional(),
    }
}

columns! {
    /// Rates of the last sweep and the prediction that they carry.
    pub struct Rates {
        /// velocity predicted to now
        v_pred: Vector = Label::checkpoint("PredictedVelocities", Dimension::VELOCITY, "velocity predicted to now"),
        /// acceleration by gravity of everything
        gravity: Vector = Label::checkpoint("GravitationalAccelerations", Dimension::ACCELERATION, "acceleration by gravity"),
        /// gravitational potential
        potential: Real = Label::checkpoint("Potentials", Dimension::SPECIFIC_ENERGY, "gravitational potential"),
        /// length of the step that begins now, in ticks
        next_span: Short = Label::checkpoint("NextSpans", Dimension::NONE, "length of the step that begins now in ticks"),
        /// acceleration by drag in the first half of the present step; empty unless somebody asks for it
        opening_drag: Vector = Label::checkpoint("OpeningDrags", Dimension::ACCELERATION, "acceleration by drag in the first half of the step").optional(),
        /// acceleration of the gas around by drag beyond what the grain makes it do, as it is expected; empty where grains are light
        excess: Vector = Label::checkpoint("GasExcesses", Dimension::ACCELERATION, "acceleration of the gas around by drag beyond what the grain makes it do").optional(),
    }
}

/// Superparticles a leaf of the dust tree.
pub const LEAF: usize = 32;

/// All dust of a scene: its columns and the tree over them.
#[derive(Clone, Debug, Default)]
pub struct Dust {
    pub particles: Superparticles,
    pub derived: Derived,
    pub rates: Rates,
    pub tree: Tree,
    curve: Curve,
    scratch: Scratch,
}

impl Dust {
    /// Dust at rest on the clock, predicted where it is.
    pub fn new(particles: Superparticles) -> Self {
        let n = particles.len();
        let mut dust = Self {
            particles,
            ..Self::default()
        };
        dust.derived.resize(n);
        dust.rates.resize(n);
        dust.rates.v_pred.clone_from(&dust.particles.v);
        dust.sort();
        dust
    }

    pub fn len(&self) -> usize {
        self.particles.len()
    }

    pub fn is_empty(&self) -> bool {
        self.particles.is_empty()
    }

    /// Brings all columns into the order of the Morton curve and builds the tree anew.
    pub fn sort(&mut self) {
        self.curve
            .thread(&self.particles.x, Cube::around(&self.particles.x));
        self.particles.permute(&self.curve.order, &mut self.scratch);
        self.derived.permute(&self.curve.order, &mut self.scratch);
        self.rates.permute(&self.curve.order, &mut self.scratch);
        self.tree.build(&self.particles.x, &self.curve.keys, LEAF);
    }

    /// Brings the tree up to date with positions that moved; at the ends of base steps that means to sort anew.
    /// Returns the momentum that crossing the faces of a shearing box gave.
    pub fn refit(&mut self, domain: &Domain, clock: &Clock) -> Vec3 {
        let mut gained = Vec3::zeros();
        if self.is_empty() {
            return gained;
        }
        if clock.synchronous() {
            let (p, v_pred) = (&mut self.particles, &mut self.rates.v_pred);
            let velocities = p.v.iter_mut().zip(v_pred);
            for ((x, (v, v_pred)), &m) in p.x.iter_mut().zip(velocities).zip(&p.m) {
                let change = domain.wrap(x);
                if change != Vec3::zeros() {
                    *v += change;
                    *v_pred += change;
                    gained += m * change;
                }
            }
            self.sort();
        } else {
            self.tree.refit(&self.particles.x);
        }
        gained
    }

    /// Dust as it was saved; the next end of a base step sorts it.
    pub fn restored(particles: Superparticles, rates: Rates) -> Self {
        let mut dust = Self {
            particles,
            rates,
            ..Self::default()
        };
        dust.derived.resize(dust.particles.len());
        dust
    }

    /// Removes the superparticles whose flag is false, and builds the tree anew.
    pub fn retain(&mut self, keep: &[bool]) {
        self.particles.retain(keep);
        self.derived.retain(keep);
        self.rates.retain(keep);
        self.sort();
    }
}
