//! What particles bring into the sums over neighbours, packed from their columns.

use nbody::points::Vec3;

use super::sums::QUADS;
use crate::lanes::{Quad, Real};
use crate::units::Units;
use crate::{Hydro, Particles};

/// The columns from which particles are packed.
pub struct Pack<'a> {
    pub hydro: &'a Hydro,
    pub units: Units,
    pub particles: &'a Particles,
    pub cs: &'a [f64],
    pub rho: &'a [f64],
    /// Empty where contents follow from sound speeds.
    pub content: &'a [f64],
    pub v: &'a [Vec3],
}

impl Pack<'_> {
    /// The row of particle i.
    #[inline(always)]
    pub fn source<E: Real>(&self, i: usize) -> [Quad<E>; QUADS] {
        let (units, p) = (&self.units, self.particles);
        // Without a switch that remembers them, there are no traces.
        let trace = p.trace_v.get(i).copied().unwrap_or(0.0);
        let sign = if trace == 0.0 { 0.0 } else { trace.signum() };
        let v = self.hydro.domain.relative(p.x[i], self.v[i]);
        let v = v.map(|v| E::place(v / units.velocity_step));
        // Before the first step there is none that could limit others.
        let span = match p.span[i] {
            0 => f64::INFINITY,
            span => f64::from(span),
        };
        let (m, cs) = (p.m[i] / units.mass, self.cs[i] / units.velocity);
        let p_by_rho = self.hydro.eos.pressure_by_square() * cs * cs;
        let formulation = self.hydro.formulation;
        // Not known yet before the first sums, which are made twice then.
        let rho = if self.rho[i] > 0.0 {
            self.rho[i] * (units.length.powi(self.hydro.dimensions() as i32) / units.mass)
        } else {
            1.0
        };
        let p_by_rho = self.hydro.floored(p_by_rho);
        let content = match self.content.get(i) {
            Some(content) => m * content / (units.velocity * units.velocity),
            None => formulation.summand(m, p_by_rho, rho, self.hydro.exponent),
        };
        [
            Quad([E::from_f64(m), v.x, v.y, v.z]),
            Quad([cs, span, sign, content].map(E::from_f64)),
        ]
    }
}
