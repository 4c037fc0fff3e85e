//! The thermal state of particles as the force sweep takes it, in its units.

use super::pair::Flux;
use crate::units::Units;
use crate::{Derived, Hydro, Particles};

pub struct States<'a> {
    pub units: Units,
    pub particles: &'a Particles,
    pub derived: &'a Derived,
    pub hydro: &'a Hydro,
    pub flux: &'a Flux,
    /// The pressure that forces leave out.
    pub background: f64,
    /// What sums of pressures have beside the pressure, in units of the sweep.
    pub offset: f64,
}

impl States<'_> {
    /// Density and specific pressure of particle i in units of the sweep.
    #[inline(always)]
    pub fn state(&self, i: usize) -> (f64, f64) {
        let (derived, units) = (self.derived, &self.units);
        let power = self.hydro.dimensions() as i32;
        let rho = derived.rho[i] * (units.length.powi(power) / units.mass);
        let specific = derived.p[i] / (derived.rho[i] * units.velocity * units.velocity);
        (rho, self.hydro.floored(specific))
    }

    /// The background by the pressure of particle i.
    #[inline(always)]
    pub fn part(&self, i: usize) -> f64 {
        let p = self.derived.p[i];
        if self.background == 0.0 || p == 0.0 {
            0.0
        } else {
            self.background / p
        }
    }

    /// What the heat of particle i has and forces leave out: content P_0 / y^2 times the factor of the kernel's slope.
    pub fn left_out(&self, i: usize) -> f64 {
        if self.background == 0.0 || !self.hydro.eos.is_free() {
            return 0.0;
        }
        let m = self.particles.m[i] / self.units.mass;
        let reach = self.hydro.support() * self.particles.h[i] / self.units.length;
        let (rho, specific) = self.state(i);
        self.part(i) * self.content(i, m, rho) * self.pushing(reach, (m, specific, rho))
    }

    /// P / y^2 times the factor of the kernel's slope.
    #[inline(always)]
    pub fn pushing(&self, reach: f64, (m, specific, rho): (f64, f64, f64)) -> f64 {
        let power = self.hydro.dimensions() as i32;
        let push = if self.hydro.solves_pressure() {
            let (p, q) = (specific * rho, specific * rho + self.offset);
            p / (q * q)
        } else {
            (self.hydro.formulation).push(m, specific, rho, self.hydro.exponent)
        };
        self.flux.norm / reach.powi(power + 2) * push
    }

    /// What particle i of mass `m` brings into the sums of its neighbours.
    #[inline(always)]
    pub fn content(&self, i: usize, m: f64, rho: f64) -> f64 {
        let units = &self.units;
        if let Some(content) = self.derived.content.get(i) {
            return m * content / (units.velocity * units.velocity);
        }
        let cs = self.derived.cs[i] / units.velocity;
        let specific = self.hydro.floored(self.flux.square_pressure * cs * cs);
        let formulation = self.hydro.formulation;
        formulation.content(m, specific, rho, self.hydro.exponent)
    }
}
