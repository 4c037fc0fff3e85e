//! What particles bring into pairs, packed from their columns, and where they stand on the clock.

use nalgebra::Matrix3;
use nbody::points::sum::Parts;
use nbody::points::{Clock, Tree, Vec3};
use rayon::prelude::*;

use super::NEVER;
use super::pair::{MORE, QUADS, STRAINED};
use super::state::States;
use crate::Gradient;
use crate::lanes::{Quad, Real};

/// Where particles stand on the clock: ticks since the present step began, its planned span, and the next one's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pace {
    age: u32,
    span: u32,
    pub next_span: u32,
}

impl Pace {
    /// Of a leaf whose particles differ.
    pub const MIXED: Self = Self {
        age: NEVER,
        span: 0,
        next_span: 0,
    };

    /// What closes and what opens the steps of pairs at this pace, in ticks.
    pub fn weights(&self) -> [f64; 2] {
        let half = 0.5 * f64::from(self.span);
        [f64::from(self.age) - half, 0.5 * f64::from(self.next_span)]
    }
}

/// The columns from which particles are packed.
pub struct Pack<'a> {
    pub clock: &'a Clock,
    pub v: &'a [Vec3],
    pub u: &'a [f64],
    pub next_span: &'a [u32],
    pub states: &'a States<'a>,
}

impl Pack<'_> {
    fn pace(&self, i: usize) -> Pace {
        Pace {
            age: self.clock.tick - self.states.particles.begin[i],
            span: self.states.particles.span[i],
            next_span: self.next_span[i],
        }
    }

    /// The paces of some leaves. Steps that end too early count as mixed: their weights are no powers of two.
    pub fn paces(&self, tree: &Tree, leaves: &[u32], paces: &mut Vec<Pace>) {
        paces.resize(tree.nodes.len(), Pace::MIXED);
        let paces = Parts::new(paces);
        leaves.par_iter().with_min_len(64).for_each(|&leaf| {
            let leaf = leaf as usize;
            let mut range = tree.nodes[leaf].range();
            let first = self.pace(range.start);
            let same = first.age == first.span && range.all(|i| self.pace(i) == first);
            // SAFETY: each leaf is listed once.
            unsafe { paces.part(leaf..leaf + 1)[0] = if same { first } else { Pace::MIXED } };
        });
    }

    /// Reach and row of particle i, which stands at `d` from the middle of its leaf, where steps are doubled `coarser` times.
    #[inline(always)]
    pub fn source<E: Real>(&self, i: usize, d: Vec3, coarser: i32) -> (f64, [Quad<E>; QUADS]) {
        let states = self.states;
        let (p, derived, units) = (states.particles, states.derived, &states.units);
        let real = E::from_f64;
        let (m, cs) = (p.m[i] / units.mass, derived.cs[i] / units.velocity);
        let reach = self.states.hydro.support() * p.h[i] / units.length;
        let (rho, specific) = self.states.state(i);
        let push = match self.states.hydro.gradient {
            Gradient::Standard => {
                (1.0 - self.states.part(i)) * self.states.pushing(reach, (m, specific, rho))
            }
            // The stress has it.
            Gradient::Matrix => 0.0,
        };
        let content = self.states.content(i, m, rho);
        let alpha = if self.states.hydro.viscosity.is_stress() {
            0.0
        } else {
            p.alpha[i]
        };
        let x = (d * 0.5f64.powi(coarser)).component_div(&units.step);
        let x = x.map(E::place);
        let v = self.states.hydro.domain.relative(p.x[i], self.v[i]);
        let v = v.map(|v| E::place(v / units.velocity_step));
        let active = self.clock.synchronous() || p.end[i] == self.clock.tick;
        let ticks = |n: u32| real(f64::from(n));
        (
            if active { reach } else { -reach },
            [
                Quad([x.x, x.y, x.z, real(m)]),
                Quad([v.x, v.y, v.z, real(derived.grad_h[i] * content)]),
                Quad([reach, push, rho, cs].map(real)),
                Quad([
                    real(alpha),
                    ticks(self.clock.tick - p.begin[i]),
                    ticks(p.span[i]),
                    ticks(self.next_span[i]),
                ]),
            ],
        )
    }

    /// The same where particles bring the strain of the flow about them.
    pub fn strained<E: Real>(&self, i: usize, d: Vec3, coarser: i32) -> (f64, [Quad<E>; STRAINED]) {
        let (reach, [q0, q1, q2, q3]) = self.source::<E>(i, d, coarser);
        let [q4, q5] = self.strain(i);
        (reach, [q0, q1, q2, q3, q4, q5])
    }

    /// The strain about particle i: its diagonal and its components yz, zx, xy.
    fn strain<E: Real>(&self, i: usize) -> [Quad<E>; 2] {
        let (derived, units) = (self.states.derived, &self.states.units);
        let time = units.length / units.velocity;
        let (diagonal, off) = (derived.stress[i] * time, derived.stress_off[i] * time);
        [
            Quad([diagonal.x, diagonal.y, diagonal.z, off.x].map(E::from_f64)),
            Quad([off.y, off.z, 0.0, 0.0].map(E::from_f64)),
        ]
    }

    /// The same where particles bring more.
    pub fn more<E: Real>(&self, i: usize, d: Vec3, coarser: i32) -> (f64, [Quad<E>; MORE]) {
        let (reach, [q0, q1, q2, q3]) = self.source::<E>(i, d, coarser);
        let states = self.states;
        let (derived, units, hydro) = (states.derived, &states.units, states.hydro);
        let (m, speed2) = (
            self.states.particles.m[i] / units.mass,
            units.velocity * units.velocity,
        );
        let (rho, specific) = self.states.state(i);
        let content = self.states.content(i, m, rho);
        let mut tensor = Matrix3::zeros();
        if hydro.stressed() {
            let power = hydro.dimensions() as i32;
            let matrix = |diagonal: &[Vec3], off: &[Vec3]| symmetric(diagonal[i], off[i]);
            let mut q = Matrix3::zeros();
            if hydro.viscous_stress() {
                let unit = units.length.powi(power) / (units.mass * speed2);
                q = matrix(&derived.stress, &derived.stress_off) * unit;
            }
            if hydro.gradient == Gradient::Matrix {
                q += Matrix3::identity() * ((1.0 - self.states.part(i)) * specific * rho);
            }
            let (x, y) = if hydro.stress_by_mass() {
                (m, rho)
            } else {
                let formulation = hydro.formulation;
                (content, formulation.sum(m, specific, rho, hydro.exponent))
            };
            let correction = matrix(&derived.correction, &derived.correction_off);
            let scale = self.states.flux.norm / reach.abs().powi(power + 2) * x / (y * y);
            tensor = q * correction * scale;
        }
        let u = self.u[i] / speed2;
        let s = |a: usize, b: usize| E::from_f64(tensor[(a, b)]);
        let mut tensor_quads = [
            Quad([s(0, 0), s(0, 1), s(0, 2), s(1, 0)]),
            Quad([s(1, 1), s(1, 2), s(2, 0), s(2, 1)]),
        ];
        if hydro.reconstructs() {
            tensor_quads = self.strain(i);
        }
        let [q4, q5] = tensor_quads;
        let last = [content, u, specific * rho].map(E::from_f64);
        (
            reach,
            [
                q0,
                q1,
                q2,
                q3,
                q4,
                q5,
                Quad([s(2, 2), last[0], last[1], last[2]]),
            ],
        )
    }
}

/// The symmetric matrix of this diagonal and these components yz, zx, xy.
fn symmetric(diagonal: Vec3, off: Vec3) -> Matrix3<f64> {
    Matrix3::new(
        diagonal.x, off.z, off.y, off.z, diagonal.y, off.x, off.y, off.x, diagonal.z,
    )
}

/// A row of what is beyond any kernel and has no mass.
pub fn nobody<E: Real, const Q: usize>() -> [Quad<E>; Q] {
    // Beyond what the coordinates of the candidates span: the difference is a whole number still.
    let far = E::place(if E::STEPS.is_finite() {
        2.5 * E::STEPS
    } else {
        1e30
    });
    let (zero, one) = (E::from_f64(0.0), E::from_f64(1.0));
    let never = E::from_f64(f64::INFINITY);
    let mut row = [Quad([zero; 4]); Q];
    row[0] = Quad([far, far, far, zero]);
    row[2] = Quad([one, zero, one, zero]);
    row[3] = Quad([zero, zero, zero, never]);
    row
}
