//! What a density sweep writes, in code units: h, densities, pressure, viscosity, and how the gas flows.

use nalgebra::Matrix3;
use nbody::points::sum::Parts;
use nbody::points::{Clock, Vec3};

use super::sums::Local;
use crate::eos::Binding;
use crate::units::Units;
use crate::viscosity::Flow;
use crate::viscosity::cullen_dehnen::{Compression, decay};
use crate::viscosity::physical;
use crate::viscosity::stress::Place;
use crate::{Derived, Formulation, Hydro, gradients};

/// The columns that the sweep writes.
struct Columns<'a> {
    h: Parts<'a, f64>,
    alpha: Parts<'a, f64>,
    rho: Parts<'a, f64>,
    p: Parts<'a, f64>,
    cs: Parts<'a, f64>,
    /// Predicted.
    u: Parts<'a, f64>,
    /// Empty where pressure follows from density and energy.
    p_ratio: Parts<'a, f64>,
    grad_h: Parts<'a, f64>,
    div_v: Parts<'a, f64>,
    /// Empty without the switch that needs it.
    trace_v: Parts<'a, f64>,
    /// Empty without a switch.
    curl_v: Parts<'a, f64>,
    v_sig: Parts<'a, f64>,
    near_span: Parts<'a, u32>,
    /// Diagonals and what is beside them; empty where particles bring no stress.
    correction: [Parts<'a, Vec3>; 2],
    stress: [Parts<'a, Vec3>; 2],
}

/// What a particle's thermal state and its stress follow from beside the sums.
pub struct Seen<'a> {
    pub x: &'a [Vec3],
    /// The star.
    pub centre: Vec3,
    pub begin: &'a [u32],
}

/// The state that the sweep solves for or remembers.
pub struct State<'a> {
    pub h: &'a mut [f64],
    pub alpha: &'a mut [f64],
    pub trace_v: &'a mut [f64],
    /// Predicted.
    pub u: &'a mut [f64],
}

/// Where results go, and what they follow from beside the sums.
pub struct Out<'a> {
    hydro: &'a Hydro,
    columns: Columns<'a>,
    seen: Seen<'a>,
    tick: u32,
    /// Length of a tick.
    unit: f64,
    /// Code units a unit of length, velocity and density, and h by H in units.
    length: f64,
    velocity: f64,
    density: f64,
    h_by_reach: f64,
}

impl<'a> Out<'a> {
    pub fn new(
        (hydro, clock, units): (&'a Hydro, &Clock, &Units),
        state: State<'a>,
        derived: &'a mut Derived,
        seen: Seen<'a>,
    ) -> Self {
        Self {
            hydro,
            columns: Columns {
                h: Parts::new(state.h),
                alpha: Parts::new(state.alpha),
                rho: Parts::new(&mut derived.rho),
                p: Parts::new(&mut derived.p),
                cs: Parts::new(&mut derived.cs),
                u: Parts::new(state.u),
                p_ratio: Parts::new(&mut derived.p_ratio),
                grad_h: Parts::new(&mut derived.grad_h),
                div_v: Parts::new(&mut derived.div_v),
                trace_v: Parts::new(state.trace_v),
                curl_v: Parts::new(&mut derived.curl_v),
                v_sig: Parts::new(&mut derived.v_sig),
                near_span: Parts::new(&mut derived.near_span),
                correction: [
                    Parts::new(&mut derived.correction),
                    Parts::new(&mut derived.correction_off),
                ],
                stress: [
                    Parts::new(&mut derived.stress),
                    Parts::new(&mut derived.stress_off),
                ],
            },
            seen,
            tick: clock.tick,
            unit: clock.unit(),
            length: units.length,
            velocity: units.velocity,
            density: units.mass / units.length.powi(hydro.dimensions() as i32),
            h_by_reach: units.length / hydro.support(),
        }
    }

    /// Smoothing lengths.
    #[inline(always)]
    pub fn h(&self) -> &Parts<'a, f64> {
        &self.columns.h
    }

    /// Writes what the sums say of particle i, whose support is `reach`.
    #[inline(always)]
    pub fn write(&self, i: usize, local: &Local, reach: f64) {
        let rate = self.velocity / self.length;
        let rho = local.rho * self.density;
        let (p, cs) = if self.hydro.solves_pressure() {
            self.solved(i, rho, self.summed_pressure(local))
        } else {
            self.thermal(i, rho)
        };
        let flow = Flow {
            div_v: local.div_v * rate,
            curl_v: local.curl_v * rate,
            cs,
            h: reach * self.h_by_reach,
        };
        let mut v_sig = local.v_sig * self.velocity;
        let alpha = if self.hydro.wants_tensor() {
            self.stress(i, local, (flow, rho, reach), &mut v_sig)
        } else {
            self.alpha(i, local, flow, reach)
        };
        let (own, out) = (i..i + 1, &self.columns);
        // SAFETY: a branch's task alone touches the branch's particles.
        unsafe {
            out.h.part(own.clone())[0] = flow.h;
            out.alpha.part(own.clone())[0] = alpha;
            out.rho.part(own.clone())[0] = rho;
            if self.hydro.solves_pressure() {
                out.p.part(own.clone())[0] = p;
            } else if self.hydro.formulation.sums_pressure() {
                let sum = self.summed_pressure(local);
                out.p.part(own.clone())[0] = sum;
                out.p_ratio.part(own.clone())[0] = if p > 0.0 { sum / p } else { 1.0 };
            } else {
                out.p.part(own.clone())[0] = p;
            }
            out.grad_h.part(own.clone())[0] = local.grad_h;
            out.div_v.part(own.clone())[0] = flow.div_v;
            if self.hydro.viscosity.switches() {
                out.curl_v.part(own.clone())[0] = flow.curl_v;
            }
            out.v_sig.part(own.clone())[0] = v_sig;
            // Infinite without neighbours: the cast saturates.
            out.near_span.part(own)[0] = local.near_span as u32;
        }
    }

    /// Pressure and sound speed at the density `rho` that particle i turns out to have; u goes with it where it is bound to density.
    #[inline(always)]
    fn thermal(&self, i: usize, rho: f64) -> (f64, f64) {
        let (own, out, eos) = (i..i + 1, &self.columns, &self.hydro.eos);
        // SAFETY: a branch's task alone touches the branch's particles.
        let (u, cs) = unsafe { (out.u.part(own.clone()), out.cs.part(own)) };
        if eos.follows_density() {
            if eos.binding() == Binding::Density {
                u[0] = eos.bound_energy(Vec3::zeros(), rho).unwrap_or(u[0]);
            }
            cs[0] = eos.sound_speed(rho, u[0]);
        }
        (eos.pressure(rho, u[0]), cs[0])
    }

    /// The same where the pressure is solved for, from its sum `q`; of gas that brings nothing into it yet as its density says.
    fn solved(&self, i: usize, rho: f64, q: f64) -> (f64, f64) {
        let (by_density, _) = self.thermal(i, rho);
        let (own, out, eos) = (i..i + 1, &self.columns, &self.hydro.eos);
        // SAFETY: a branch's task alone touches the branch's particles.
        let (u, cs, ratio) = unsafe {
            (
                out.u.part(own.clone())[0],
                &mut out.cs.part(own.clone())[0],
                &mut out.p_ratio.part(own)[0],
            )
        };
        if q <= 0.0 {
            *ratio = 1.0;
            return (by_density, *cs);
        }
        *ratio = q / (by_density + eos.offset());
        *cs = eos.sound_speed(eos.density(q, u, rho), u);
        (q - eos.offset(), *cs)
    }

    /// The viscosity parameter at the end of the step that has passed.
    #[inline(always)]
    fn alpha(&self, i: usize, local: &Local, flow: Flow, reach: f64) -> f64 {
        let (own, out) = (i..i + 1, &self.columns);
        // SAFETY: a branch's task alone touches the branch's particles.
        let present = unsafe { out.alpha.part(own.clone()) }[0];
        self.hydro.viscosity.alpha(flow, present, || {
            let rate = self.velocity / self.length;
            // SAFETY: as above.
            let trace = &mut unsafe { out.trace_v.part(own) }[0];
            let div_v = local.flow.trace.unwrap_or(local.div_v) * rate;
            Compression {
                div_v,
                before: std::mem::replace(trace, div_v),
                dt: f64::from(self.tick - self.seen.begin[i]) * self.unit,
                shear2: local.flow.shear2 * rate * rate,
                order: local.flow.order,
                // Without the part of both sound speeds that a time step needs.
                v_sig: 0.5 * local.v_sig * self.velocity,
                reach: reach * self.length,
            }
        })
    }

    /// P, where it is summed.
    #[inline(always)]
    fn summed_pressure(&self, local: &Local) -> f64 {
        let zeta = self.hydro.exponent;
        let p = if self.hydro.formulation == Formulation::Pressure && zeta != 1.0 {
            local.y.powf(1.0 / zeta)
        } else {
            local.y
        };
        p * (self.density * self.velocity * self.velocity)
    }

    /// The place of particle i: its velocity gradient in code units, along the axes of the domain. It has the correction that forces have:
    /// three neighbours in a row would give it any size.
    fn place(&self, local: &Local, (flow, rho, reach): (Flow, f64, f64)) -> Place {
        let mut gradient = match local.flow.linear {
            Some([vd, _]) => {
                let rate = self.velocity / self.length / self.scale(local, reach);
                vd * self.correction(local, reach) * rate
            }
            None => Matrix3::zeros(),
        };
        for a in (0..3).filter(|&a| !self.hydro.domain.axes[a]) {
            gradient.row_mut(a).fill(0.0);
            gradient.column_mut(a).fill(0.0);
        }
        Place {
            gradient,
            rho,
            cs: flow.cs,
            h: flow.h,
        }
    }

    /// The correction of gradients.
    fn correction(&self, local: &Local, reach: f64) -> Matrix3<f64> {
        match &local.flow.linear {
            Some([_, inverse]) => gradients::correction(inverse, self.scale(local, reach)),
            None => Matrix3::identity(),
        }
    }

    /// -y H^(d+2) / norm
    fn scale(&self, local: &Local, reach: f64) -> f64 {
        let (hydro, d) = (self.hydro, self.hydro.dimensions());
        let y = if hydro.stress_by_mass() {
            local.rho
        } else {
            local.y
        };
        -y * reach.powi(d as i32 + 2) / hydro.kernel.norm(d)
    }

    /// Writes what particle i brings into pairs as a tensor; returns its alpha, and adds to `v_sig` what shortens its steps.
    fn stress(
        &self,
        i: usize,
        local: &Local,
        (flow, rho, reach): (Flow, f64, f64),
        v_sig: &mut f64,
    ) -> f64 {
        let hydro = self.hydro;
        let mut alpha = self.alpha(i, local, flow, reach);
        let place = self.place(local, (flow, rho, reach));
        let mut stress = Matrix3::zeros();
        if hydro.viscosity.heeds_strain() {
            let dt = f64::from(self.tick - self.seen.begin[i]) * self.unit;
            let crossings = 0.5 * *v_sig * dt / (reach * self.length);
            (alpha, stress) = hydro.viscosity.stress(&place, alpha, decay(crossings));
        }
        let nu = (hydro.physical).nu(flow.cs, self.seen.x[i] - self.seen.centre);
        if nu > 0.0 {
            stress += physical::stress(&place, nu, hydro.domain.axes);
            *v_sig += 4.0 * nu / flow.h;
        }
        if hydro.stressed() {
            self.write_matrix(&self.columns.correction, i, &self.correction(local, reach));
        }
        if hydro.reconstructs() {
            let strain = 0.5 * (place.gradient + place.gradient.transpose());
            self.write_matrix(&self.columns.stress, i, &strain);
        }
        if hydro.viscous_stress() {
            self.write_matrix(&self.columns.stress, i, &stress);
        }
        alpha
    }

    fn write_matrix(&self, [diagonal, off]: &[Parts<'a, Vec3>; 2], i: usize, m: &Matrix3<f64>) {
        // SAFETY: a branch's task alone touches the branch's particles.
        unsafe {
            diagonal.part(i..i + 1)[0] = m.diagonal();
            off.part(i..i + 1)[0] = Vec3::new(m.m23, m.m31, m.m12);
        }
    }
}
