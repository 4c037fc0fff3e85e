//! What a force sweep writes: rates of active particles, and the impulses of all that met one.

use std::ops::Range;

use nbody::points::sum::Parts;
use nbody::points::{Clock, Vec3};

use super::NEVER;
use super::sums::Total;
use crate::Rates;
use crate::units::Units;

/// The columns that the sweep writes.
struct Columns<'a> {
    hydro: Parts<'a, Vec3>,
    du: Parts<'a, f64>,
    dv_close: Parts<'a, Vec3>,
    dv_open: Parts<'a, Vec3>,
    du_close: Parts<'a, f64>,
    du_open: Parts<'a, f64>,
    wake: Parts<'a, u32>,
}

/// Where results go, in code units.
pub struct Out<'a> {
    columns: Columns<'a>,
    m: &'a [f64],
    next_span: &'a [u32],
    next: &'a Clock,
    /// Time of a tick: of the steps that end, and of those that begin.
    ticks: [f64; 2],
    /// How many times longer than a neighbour's a step may be.
    limiter: u32,
    /// Code units of a force, and of a velocity.
    force: f64,
    velocity: f64,
}

impl<'a> Out<'a> {
    pub fn new(
        rates: &'a mut Rates,
        (wake, limiter): (&'a mut [u32], u32),
        m: &'a [f64],
        units: &Units,
        clocks: [&'a Clock; 2],
    ) -> Self {
        let [clock, next] = clocks;
        Self {
            columns: Columns {
                hydro: Parts::new(&mut rates.hydro),
                du: Parts::new(&mut rates.du),
                dv_close: Parts::new(&mut rates.dv_close),
                dv_open: Parts::new(&mut rates.dv_open),
                du_close: Parts::new(&mut rates.du_close),
                du_open: Parts::new(&mut rates.du_open),
                wake: Parts::new(wake),
            },
            m,
            next_span: &rates.next_span,
            next,
            ticks: [clock.unit(), next.unit()],
            limiter,
            force: units.mass * units.velocity * units.velocity / units.length,
            velocity: units.velocity,
        }
    }

    /// What particles get that meet nobody.
    pub fn rest(&self, which: Range<usize>) {
        let out = &self.columns;
        // SAFETY: a branch's task alone touches the branch's particles.
        unsafe {
            out.dv_close.part(which.clone()).fill(Vec3::zeros());
            out.dv_open.part(which.clone()).fill(Vec3::zeros());
            out.du_close.part(which.clone()).fill(0.0);
            out.du_open.part(which.clone()).fill(0.0);
            out.wake.part(which).fill(NEVER);
        }
    }

    /// Writes what particle i gets; returns whether it meets anybody.
    #[inline(always)]
    pub fn write(&self, i: usize, total: &Total, active: bool) -> bool {
        let by_mass = self.force / self.m[i];
        let closing = by_mass * self.ticks[0];
        let opening = by_mass * self.ticks[1];
        let span = self.next_span[i];
        let wake = if total.near < f64::from(span / self.limiter) {
            self.next.waking(self.limiter * total.near as u32)
        } else {
            NEVER
        };
        let [rate, close, open] = total.force;
        let heat = total.heat.map(
            #[inline(always)]
            |heat| self.velocity * heat,
        );
        let (own, out) = (i..i + 1, &self.columns);
        // SAFETY: a branch's task alone touches the branch's particles.
        unsafe {
            if active {
                out.hydro.part(own.clone())[0] = scaled(by_mass, rate);
                out.du.part(own.clone())[0] = by_mass * heat[0];
            }
            out.dv_close.part(own.clone())[0] = scaled(closing, close);
            out.dv_open.part(own.clone())[0] = scaled(opening, open);
            out.du_close.part(own.clone())[0] = closing * heat[1];
            out.du_open.part(own.clone())[0] = opening * heat[2];
            out.wake.part(own)[0] = wake;
        }
        total.near.is_finite()
    }
}

#[inline(always)]
fn scaled(factor: f64, [x, y, z]: [f64; 3]) -> Vec3 {
    Vec3::new(factor * x, factor * y, factor * z)
}
