//! A pair of particles: what each brings, and the force that both compute alike.
//!
//! Every term keeps its value, or changes its sign alone, when the members of the pair change places.

use fearless_simd::{Simd, SimdBase, SimdFloat};

use super::sweep::Grid;
use crate::conduction::Contrast;
use crate::lanes::{Lanes, Machine, Quad, Real, same};
use crate::viscosity::reconstruction;
use crate::{Formulation, Hydro, KernelKind};

/// Quads of a row: coordinates on the grid and mass; velocity and g; H, push, density, sound speed; alpha, age and steps.
pub const QUADS: usize = 4;

/// Quads of a row where particles bring the strain of the flow as well: its diagonal and its components yz, zx, xy.
pub const STRAINED: usize = 6;

/// Quads of a row where particles bring more: the nine components of a stress that is applied to separations (or the strain, as there); content, u and P.
pub const MORE: usize = 7;

/// Columns of some rows; those that are not there are zero.
pub type Columns<S, E> = [[Lanes<S, E>; 4]; MORE];

/// What a particle brings into a pair, a value for each lane; in units of the sweep.
pub struct Member<S: Simd, E: Real> {
    pub m: Lanes<S, E>,
    /// What it brings into the sums of its neighbours, and g in units of that.
    pub content: Lanes<S, E>,
    pub g: Lanes<S, E>,
    pub reach: Lanes<S, E>,
    /// 1 / H.
    pub inverse: Lanes<S, E>,
    /// H^-(d+2).
    pub slope: Lanes<S, E>,
    /// content P / y^2 times the factor of the kernel's slope, norm / H^(d+2).
    pub push: Lanes<S, E>,
    /// The same with what forces leave out of P and heat does not.
    pub work: Lanes<S, E>,
    /// Zero where nothing is conducted.
    pub p: Lanes<S, E>,
    pub rho: Lanes<S, E>,
    pub cs: Lanes<S, E>,
    /// Rows of the stress times the correction of gradients, the particle's content and the factor of the kernel's slope, by y^2; or of
    /// the strain, where velocities are reconstructed.
    pub tensor: [[Lanes<S, E>; 3]; 3],
    pub u: Lanes<S, E>,
    pub alpha: Lanes<S, E>,
    /// Ticks since the present step began, its planned span, and the next one's.
    pub age: Lanes<S, E>,
    pub span: Lanes<S, E>,
    pub next_span: Lanes<S, E>,
}

impl<S: Simd, E: Real> Member<S, E> {
    /// From the columns of some rows.
    #[inline(always)]
    pub fn new<R: Machine<S, E>>(simd: S, columns: Columns<S, E>, flux: &Flux) -> Self {
        let [[.., m], [.., g], [reach, push, rho, cs], last, b, c, e] = columns;
        let [alpha, age, span, next_span] = last;
        let inverse = R::reciprocal(simd, reach);
        let square = inverse * inverse;
        let fourth = square * square;
        let slope = if flux.three { fourth * inverse } else { fourth };
        let content = if flux.plain {
            (flux.formulation).contents::<S, E>(simd, m, cs, flux.square_pressure)
        } else {
            e[1]
        };
        let p = if !flux.plain {
            e[3]
        } else if flux.conducts {
            let scale = slope * same::<S, E>(simd, flux.norm);
            (flux.formulation).pressure::<S, E, R>(simd, push, scale, (m, rho))
        } else {
            same::<S, E>(simd, 0.0)
        };
        Self {
            m,
            content,
            g,
            reach,
            inverse,
            slope,
            push: content * push,
            work: content * push,
            p,
            rho,
            cs,
            tensor: if flux.reconstructs {
                [[b[0], c[1], c[0]], [c[1], b[1], b[3]], [c[0], b[3], b[2]]]
            } else {
                [[b[0], b[1], b[2]], [b[3], c[0], c[1]], [c[2], c[3], e[0]]]
            },
            u: e[2],
            alpha,
            age,
            span,
            next_span,
        }
    }

    /// The same particle in all lanes.
    #[inline(always)]
    pub fn alone<R: Machine<S, E>>(simd: S, row: &[Quad<E>; MORE], flux: &Flux) -> Self {
        let mut columns = [[same::<S, E>(simd, 0.0); 4]; MORE];
        for (columns, quad) in columns.iter_mut().zip(row).take(flux.quads()) {
            for (column, &value) in columns.iter_mut().zip(&quad.0) {
                *column = Lanes::<S, E>::splat(simd, value);
            }
        }
        Self::new::<R>(simd, columns, flux)
    }
}

/// What the particles of a pair know of each other.
pub struct Separation<S: Simd, E: Real> {
    pub d: [Lanes<S, E>; 3],
    pub dv: [Lanes<S, E>; 3],
    pub r2: Lanes<S, E>,
    /// v_ij . r_ij
    pub approach: Lanes<S, E>,
}

impl<S: Simd, E: Real> Separation<S, E> {
    /// Of neighbours with these columns from the particle with this row.
    #[inline(always)]
    pub fn new(simd: S, row: &[Quad<E>; MORE], columns: &Columns<S, E>, grid: &Grid<E>) -> Self {
        let velocity = Lanes::<S, E>::splat(simd, grid.velocity);
        let mut d = [velocity; 3];
        let mut dv = d;
        for a in 0..3 {
            let length = Lanes::<S, E>::splat(simd, grid.length[a]);
            d[a] = E::apart(simd, columns[0][a], row[0].0[a]) * length;
            dv[a] = E::apart(simd, columns[1][a], row[1].0[a]) * velocity;
        }
        let shear = Lanes::<S, E>::splat(simd, grid.shear);
        dv[1] -= shear * d[0];
        Self {
            r2: dot::<S, E>(&d, &d),
            approach: dot::<S, E>(&dv, &d),
            dv,
            d,
        }
    }
}

/// The scalar product; the same to the last bit when both vectors are reversed.
#[inline(always)]
fn dot<S: Simd, E: Real>(a: &[Lanes<S, E>; 3], b: &[Lanes<S, E>; 3]) -> Lanes<S, E> {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}

/// d . T d of a tensor of these rows; the same to the last bit when d is reversed.
#[inline(always)]
fn stretch<S: Simd, E: Real>(rows: &[[Lanes<S, E>; 3]; 3], d: &[Lanes<S, E>; 3]) -> Lanes<S, E> {
    let [x, y, z] = rows;
    let turned = [dot::<S, E>(x, d), dot::<S, E>(y, d), dot::<S, E>(z, d)];
    dot::<S, E>(&turned, d)
}

/// Pressure, viscosity and conduction of a pair.
#[derive(Clone, Copy)]
pub struct Flux {
    kernel: KernelKind,
    formulation: Formulation,
    pub three: bool,
    /// Whether what particles bring follows from mass and sound speed, and whether they bring a stress: branches that are always the same way.
    pub plain: bool,
    pub stressed: bool,
    /// Whether they bring the strain that velocities are reconstructed by.
    pub reconstructs: bool,
    /// Whether that acts on masses.
    by_mass: bool,
    /// Whether heat is conducted: a branch that is always the same way.
    pub conducts: bool,
    /// The factor of the kernel's slope.
    pub norm: f64,
    /// P / rho by the square of the sound speed.
    pub square_pressure: f64,
    /// beta by alpha.
    beta_ratio: f64,
    /// h / H.
    h_by_reach: f64,
    /// alpha_u, times u by the square of the sound speed where that stands for u.
    conduction: f64,
}

impl Flux {
    pub fn new(hydro: &Hydro) -> Self {
        let d = hydro.dimensions();
        Self {
            three: d == 3,
            plain: hydro.plain(),
            stressed: hydro.stressed(),
            reconstructs: hydro.reconstructs(),
            by_mass: hydro.stress_by_mass(),
            conducts: hydro.conducts(),
            kernel: hydro.kernel,
            formulation: hydro.formulation,
            norm: hydro.kernel.norm(d),
            square_pressure: hydro.eos.pressure_by_square(),
            beta_ratio: hydro.viscosity.ratio(),
            h_by_reach: 1.0 / hydro.support(),
            conduction: if hydro.plain() {
                hydro.conduction.alpha * hydro.eos.energy_by_square()
            } else {
                hydro.conduction.alpha
            },
        }
    }

    /// Quads of a row.
    #[inline(always)]
    pub fn quads(&self) -> usize {
        match (self.plain, self.reconstructs) {
            (true, false) => QUADS,
            (true, true) => STRAINED,
            _ => MORE,
        }
    }

    /// The same where the quads of a row are known as it is compiled: what a sweep leaves out costs it nothing.
    #[inline(always)]
    pub fn of<const Q: usize>(&self) -> Self {
        Self {
            plain: Q != MORE,
            stressed: Q == MORE && self.stressed,
            reconstructs: Q == STRAINED || (Q == MORE && self.reconstructs),
            ..*self
        }
    }

    /// The force of a pair on its member `a`, and the heat that stays with `a`, a time.
    #[inline(always)]
    pub fn between<S: Simd, E: Real, R: Machine<S, E>>(
        &self,
        simd: S,
        a: &Member<S, E>,
        b: &Member<S, E>,
        pair: &Separation<S, E>,
    ) -> ([Lanes<S, E>; 3], Lanes<S, E>) {
        let constant = |x: f64| same::<S, E>(simd, x);
        let (zero, half, one) = (constant(0.0), constant(0.5), constant(1.0));
        let r2 = pair.r2.max(constant(E::TINY));
        let r = r2 * R::inverse_root(simd, r2);
        let slope_a = self.kernel.slope((r * a.inverse).min(one));
        let slope_b = self.kernel.slope((r * b.inverse).min(one));
        let [span_a, span_b] = [(b.content - a.g) * slope_a, (a.content - b.g) * slope_b];
        let [pressure_a, pressure_b] = [a.push * span_a, b.push * span_b];
        let h = (a.reach + b.reach) * constant(0.5 * self.h_by_reach);
        let rho = (a.rho + b.rho) * half;
        let spread = (h * h).mul_add(constant(0.01), pair.r2);
        // Both divisions in one: mu = h approach / spread, and 1 / rho.
        let inverse = R::reciprocal(simd, spread * rho);
        let mut approach = pair.approach;
        if self.reconstructs {
            let expected = [&a.tensor, &b.tensor].map(
                #[inline(always)]
                |strain| stretch::<S, E>(strain, &pair.d),
            );
            approach = reconstruction::left::<S, E>(simd, approach, expected);
        }
        let mu = h * approach.min(zero) * (rho * inverse);
        let alpha = (a.alpha + b.alpha) * half;
        let speed = (a.cs + b.cs) * half;
        let strength = alpha * mu * (mu * constant(self.beta_ratio) - speed);
        let slope = (a.slope * slope_a + b.slope * slope_b) * constant(0.5 * self.norm);
        let volume = spread * inverse;
        let grip = (a.m * b.m) * slope;
        let viscous = grip * (strength * volume);
        let pull = (pressure_a + pressure_b) + viscous;
        let mut heat = viscous.mul_add(half, a.work * span_a) * pair.approach;
        if self.conducts {
            let contrast = Contrast {
                u: if self.plain {
                    (a.cs - b.cs) * (a.cs + b.cs)
                } else {
                    a.u - b.u
                },
                p: a.p - b.p,
                volume,
            };
            let flux = contrast.flux::<R>(simd, self.conduction);
            heat = (grip * r).mul_add(flux, heat);
        }
        let mut force = pair.d.map(
            #[inline(always)]
            |d| pull * d,
        );
        if self.stressed {
            let (own, other) = if self.by_mass {
                (b.m * slope_a, a.m * slope_b)
            } else {
                (b.content * slope_a, a.content * slope_b)
            };
            for ((force, dv), (row_a, row_b)) in
                (force.iter_mut().zip(pair.dv)).zip(a.tensor.iter().zip(&b.tensor))
            {
                let own = own * dot::<S, E>(row_a, &pair.d);
                let both = own + other * dot::<S, E>(row_b, &pair.d);
                *force += both;
                heat = own.mul_add(dv, heat);
            }
        }
        (force, heat)
    }
}
