//! The sums over the neighbours of one particle, in units of the sweep.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat};

use super::law::Law;
use super::shear::{Gradient, Shear};
use crate::Kernel;
use crate::lanes::{Lanes, Machine, Quad, Real, same};

/// Quads of a row: mass and velocity; sound speed and step.
pub const QUADS: usize = 2;

/// What the sums say of a particle.
pub struct Local {
    pub rho: f64,
    /// g in units of mass.
    pub g: f64,
    pub div_v: f64,
    pub curl_v: f64,
    pub v_sig: f64,
    pub near_span: f64,
    pub gradient: Gradient,
}

/// Sums over neighbours, without and with their masses.
pub struct Sums<S: Simd, E: Real> {
    mass: Lanes<S, E>,
    slope: Lanes<S, E>,
    mass_slope: Lanes<S, E>,
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
    /// H.
    pub reach: f64,
    /// Units of velocity a step of velocity.
    pub velocity_step: f64,
}

impl<S: Simd, E: Real> Sums<S, E> {
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        let zero = same::<S, E>(simd, 0.0);
        Self {
            mass: zero,
            slope: zero,
            mass_slope: zero,
            div: zero,
            mass_div: zero,
            curl: [zero; 3],
            mass_curl: [zero; 3],
            v_sig: zero,
            near_span: same::<S, E>(simd, f64::INFINITY),
            shear: Shear::new(simd),
        }
    }

    /// Adds some neighbours: their columns, separations `d` and distances `r`; with `GRADIENT` to those of the velocity gradient too.
    #[inline(always)]
    pub fn add<K: Kernel, R: Machine<S, E>, const GRADIENT: bool>(
        &mut self,
        simd: S,
        own: &Own<E>,
        columns: [[Lanes<S, E>; 4]; QUADS],
        d: [Lanes<S, E>; 3],
        r: Lanes<S, E>,
    ) {
        let [[m, v_x, v_y, v_z], [cs, span, sign, _]] = columns;
        let [Quad([_, v @ ..]), Quad([cs_i, ..])] = own.row;
        let step = same::<S, E>(simd, own.velocity_step);
        let dv = [
            E::apart(simd, v_x, v[0]) * step,
            E::apart(simd, v_y, v[1]) * step,
            E::apart(simd, v_z, v[2]) * step,
        ];
        let (zero, one) = (same::<S, E>(simd, 0.0), same::<S, E>(simd, 1.0));
        let q = (r * same::<S, E>(simd, 1.0 / own.reach)).min(one);
        let slope = K::slope(q);
        let m_slope = m * slope;
        let fall = q * q;
        let value = m * K::value(q);
        self.mass += value;
        if GRADIENT {
            self.shear.add(d, dv, [m_slope, value, sign]);
        }
        self.slope = fall.mul_add(-slope, self.slope);
        self.mass_slope = fall.mul_add(-m_slope, self.mass_slope);
        let approach = dv[2].mul_add(d[2], dv[1].mul_add(d[1], dv[0] * d[0]));
        self.div = slope.mul_add(approach, self.div);
        self.mass_div = m_slope.mul_add(approach, self.mass_div);
        for a in 0..3 {
            let (b, c) = ((a + 1) % 3, (a + 2) % 3);
            let turn = dv[b].mul_add(d[c], -(dv[c] * d[b]));
            self.curl[a] = slope.mul_add(turn, self.curl[a]);
            self.mass_curl[a] = m_slope.mul_add(turn, self.mass_curl[a]);
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

    /// The velocity gradient along the axes of the domain.
    #[inline(always)]
    pub fn gradient<R: Machine<S, E>>(&self, axes: [bool; 3], div_v: f64) -> Gradient {
        self.shear.gradient::<R>(axes, R::total(self.mass), div_v)
    }

    /// What the sums say; `m` is the mass of the particle, `free` whether H follows the particles.
    #[inline(always)]
    pub fn local<R: Machine<S, E>>(&self, law: &Law, m: f64, reach: f64, free: bool) -> Local {
        let [mass, slope, mass_slope, div] =
            R::totals([self.mass, self.slope, self.mass_slope, self.div]);
        let [mass_x, mass_y, mass_z, mass_div] = R::totals([
            self.mass_curl[0],
            self.mass_curl[1],
            self.mass_curl[2],
            self.mass_div,
        ]);
        let [x, y, z, _] = R::totals([self.curl[0], self.curl[1], self.curl[2], self.div]);
        let mass = mass - law.excess * m;
        let g = if free {
            (mass_slope - law.d * mass) / slope
        } else {
            0.0
        };
        let volume = reach * reach * if law.d > 2.5 { reach } else { 1.0 };
        let rho = law.norm / volume * mass;
        let scale = law.norm / (volume * reach * reach * rho);
        let curl = [mass_x - g * x, mass_y - g * y, mass_z - g * z];
        let curl = (curl[0] * curl[0] + curl[1] * curl[1] + curl[2] * curl[2]).sqrt();
        let fold = |v: Lanes<S, E>, from: f64, pick: fn(f64, f64) -> f64| {
            (v.as_slice().iter()).fold(from, |x, lane| pick(x, lane.to_f64()))
        };
        Local {
            rho,
            g,
            div_v: -scale * (mass_div - g * div),
            curl_v: scale * curl,
            v_sig: fold(self.v_sig, 0.0, f64::max),
            near_span: fold(self.near_span, f64::INFINITY, f64::min),
            gradient: Gradient::default(),
        }
    }
}
