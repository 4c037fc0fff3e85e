//! What particles bring into the sums over neighbours, packed from their columns.

use nbody::points::Vec3;

use super::sums::{QUADS, Terms};
use crate::formulation::Content;
use crate::lanes::{Quad, Real};
use crate::units::Units;
use crate::{Hydro, Particles};

/// The columns from which particles are packed.
pub struct Pack<'a> {
    pub hydro: &'a Hydro,
    pub units: Units,
    pub particles: &'a Particles,
    pub cs: &'a [f64],
    pub v: &'a [Vec3],
}

impl Pack<'_> {
    /// The row of particle i.
    #[inline(always)]
    pub fn source<T: Terms, E: Real>(&self, i: usize) -> [Quad<E>; QUADS] {
        let (units, p) = (&self.units, self.particles);
        let sign = if T::GRADIENT && p.trace_v[i] != 0.0 {
            p.trace_v[i].signum()
        } else {
            0.0
        };
        let v = self.v[i].map(|v| E::place(v / units.velocity_step));
        // Before the first step there is none that could limit others.
        let span = match p.span[i] {
            0 => f64::INFINITY,
            span => f64::from(span),
        };
        let (m, cs) = (p.m[i] / units.mass, self.cs[i] / units.velocity);
        let content = if T::Content::IS_MASS {
            0.0
        } else {
            let p_by_rho = self.hydro.eos.pressure_by_square() * cs * cs;
            self.hydro.formulation.content(m, p_by_rho)
        };
        [
            Quad([E::from_f64(m), v.x, v.y, v.z]),
            Quad([cs, span, sign, content].map(E::from_f64)),
        ]
    }
}
