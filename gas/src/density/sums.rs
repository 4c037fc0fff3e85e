//! The sums over the neighbours of one particle, in units of the sweep.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat};

use super::law::Law;
use super::shear::{Flow, Shear};
use crate::Formulation;
use crate::lanes::{Lanes, Machine, Quad, Real, same};

/// Quads of a row: mass and velocity; sound speed, step, sign of the divergence, content.
pub const QUADS: usize = 2;

/// What the sums say of a particle.
pub struct Local {
    pub rho: f64,
    /// What is summed beside the mass: y, or a smoothed pressure; the density again where nothing is.
    pub y: f64,
    /// g by the particle's own content.
    pub grad_h: f64,
    pub div_v: f64,
    pub curl_v: f64,
    pub v_sig: f64,
    pub near_span: f64,
    /// Empty where no gradient is wanted.
    pub flow: Flow,
}

/// Sums over neighbours, without and with their masses.
pub struct Sums<S: Simd, E: Real> {
    mass: Lanes<S, E>,
    slope: Lanes<S, E>,
    mass_slope: Lanes<S, E>,
    content: Lanes<S, E>,
    content_slope: Lanes<S, E>,
    div: Lanes<S, E>,
    mass_div: Lanes<S, E>,
    curl: [Lanes<S, E>; 3],
    mass_curl: [Lanes<S, E>; 3],
    v_sig: Lanes<S, E>,
    near_span: Lanes<S, E>,
    shear: Shear<S, E>,
}

/// The particle that the sums are about.
pub struct Own<E> {
    pub row: [Quad<E>; QUADS],
    pub m: f64,
    /// H.
    pub reach: f64,
    /// Units of velocity a step of velocity.
    pub velocity_step: f64,
    /// -dv_y/dx of the shear that velocities are relative to.
    pub shear: f64,
}

impl<S: Simd, E: Real> Sums<S, E> {
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        let zero = same::<S, E>(simd, 0.0);
        Self {
            mass: zero,
            slope: zero,
            mass_slope: zero,
            content: zero,
            content_slope: zero,
            div: zero,
            mass_div: zero,
            curl: [zero; 3],
            mass_curl: [zero; 3],
            v_sig: zero,
            near_span: same::<S, E>(simd, f64::INFINITY),
            shear: Shear::new(simd),
        }
    }

    /// Adds some neighbours: their columns, separations `d` and distances `r`.
    #[inline(always)]
    pub fn add<const GRADIENT: bool, R: Machine<S, E>>(
        &mut self,
        simd: S,
        law: &Law,
        own: &Own<E>,
        columns: [[Lanes<S, E>; 4]; QUADS],
        (d, r): ([Lanes<S, E>; 3], Lanes<S, E>),
    ) {
        let [[m, v_x, v_y, v_z], [cs, span, sign, content]] = columns;
        let [Quad([_, v @ ..]), Quad([cs_i, ..])] = own.row;
        let step = same::<S, E>(simd, own.velocity_step);
        let dv = [
            E::apart(simd, v_x, v[0]) * step,
            d[0].mul_add(
                same::<S, E>(simd, -own.shear),
                E::apart(simd, v_y, v[1]) * step,
            ),
            E::apart(simd, v_z, v[2]) * step,
        ];
        let (zero, one) = (same::<S, E>(simd, 0.0), same::<S, E>(simd, 1.0));
        let q = (r * same::<S, E>(simd, 1.0 / own.reach)).min(one);
        let slope = law.kernel.slope(q);
        let m_slope = m * slope;
        let fall = q * q;
        let value = law.kernel.value(q);
        let m_value = m * value;
        self.mass += m_value;
        self.slope = fall.mul_add(-slope, self.slope);
        self.mass_slope = fall.mul_add(-m_slope, self.mass_slope);
        if law.formulation.sums_more() {
            self.content = content.mul_add(value, self.content);
            self.content_slope = (fall * content).mul_add(-slope, self.content_slope);
        }
        let approach = dv[2].mul_add(d[2], dv[1].mul_add(d[1], dv[0] * d[0]));
        self.div = slope.mul_add(approach, self.div);
        if GRADIENT {
            let weighted = if law.weighs_contents {
                content * slope
            } else {
                m_slope
            };
            self.shear.add(d, dv, [weighted, m_value, sign]);
        } else {
            self.mass_div = m_slope.mul_add(approach, self.mass_div);
            for a in 0..3 {
                let (b, c) = ((a + 1) % 3, (a + 2) % 3);
                let turn = dv[b].mul_add(d[c], -(dv[c] * d[b]));
                self.curl[a] = slope.mul_add(turn, self.curl[a]);
                self.mass_curl[a] = m_slope.mul_add(turn, self.mass_curl[a]);
            }
        }
        let inside = q.simd_lt(one);
        let tiny = same::<S, E>(simd, E::TINY.sqrt());
        let closing = approach.min(zero) * R::reciprocal(simd, r.max(tiny));
        let speed = closing.mul_add(same::<S, E>(simd, -3.0), cs + cs_i);
        self.v_sig = self.v_sig.max(inside.select(speed, zero));
        let other = inside & r.simd_gt(zero);
        let none = same::<S, E>(simd, f64::INFINITY);
        self.near_span = self.near_span.min(other.select(span, none));
    }

    /// What the sums say; `free` is whether H follows the particles, `axes` those of the domain.
    #[inline(always)]
    pub fn local<const GRADIENT: bool, R: Machine<S, E>>(
        &self,
        law: &Law,
        own: &Own<E>,
        free: bool,
        axes: [bool; 3],
    ) -> Local {
        let [mass, slope, mass_slope, div] =
            R::totals([self.mass, self.slope, self.mass_slope, self.div]);
        let own_content = own.row[1].0[3].to_f64();
        let grad = |sum: f64, fall: f64| {
            if free && law.grad_h {
                (fall - law.d * sum) / slope
            } else {
                0.0
            }
        };
        let volume = own.reach * own.reach * if law.d > 2.5 { own.reach } else { 1.0 };
        let counted = mass - law.excess * own.m;
        let per_volume = law.norm / volume;
        let rho = per_volume * counted;
        let g = grad(counted, mass_slope);
        let summed = if law.formulation.sums_more() {
            let content = R::total(self.content) - law.excess * own_content;
            Some((content, R::total(self.content_slope)))
        } else {
            None
        };
        let y = summed.map_or(rho, |(content, _)| per_volume * content);
        let grad_h = match summed {
            Some((content, fall)) if !law.formulation.sums_mass() => {
                let by_own = if own_content > 0.0 {
                    1.0 / own_content
                } else {
                    0.0
                };
                grad(content, fall) * by_own
            }
            _ => g / own.m,
        };
        let scale = law.norm / (volume * own.reach * own.reach * rho);
        let rho = match law.formulation {
            Formulation::Number => own.m * y,
            _ => rho,
        };
        let (div_v, curl_v, flow) = if GRADIENT {
            let flow = self.shear.flow::<R>(axes, mass, law.wants_tensor);
            let div_v = if law.weighs_contents {
                flow.trace.unwrap_or(0.0)
            } else {
                -scale * (flow.m_div - g * div)
            };
            (div_v, flow.curl, flow)
        } else {
            let (mass_div, curl) = self.turning::<R>(g);
            (-scale * (mass_div - g * div), scale * curl, Flow::default())
        };
        let fold = |v: Lanes<S, E>, from: f64, pick: fn(f64, f64) -> f64| {
            (v.as_slice().iter()).fold(from, |x, lane| pick(x, lane.to_f64()))
        };
        Local {
            rho,
            y,
            grad_h,
            div_v,
            curl_v,
            v_sig: fold(self.v_sig, 0.0, f64::max),
            near_span: fold(self.near_span, f64::INFINITY, f64::min),
            flow,
        }
    }

    /// The sum of the divergence with masses, and the modulus of that of the curl.
    #[inline(always)]
    fn turning<R: Machine<S, E>>(&self, g: f64) -> (f64, f64) {
        let [mass_x, mass_y, mass_z, mass_div] = R::totals([
            self.mass_curl[0],
            self.mass_curl[1],
            self.mass_curl[2],
            self.mass_div,
        ]);
        let [x, y, z, _] = R::totals([self.curl[0], self.curl[1], self.curl[2], self.div]);
        let curl = [mass_x - g * x, mass_y - g * y, mass_z - g * z];
        let square = curl[0] * curl[0] + curl[1] * curl[1] + curl[2] * curl[2];
        (mass_div, square.sqrt())
    }
}
