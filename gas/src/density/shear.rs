//! The velocity gradient of one particle, exact for linear flows, and how orderly the flow around it converges.
//!
//! V = (sum m_j s_j v_ij d^T) (sum m_j s_j d d^T)^-1, s = dw/dq / q;   R = sum m_j sign(div v_j) W / sum m_j W
//! with V = grad v; its antisymmetric part is the curl. Where the inverse serves for forces too, x_j stands for m_j in it.
//! Source: Cullen & Dehnen (2010), appendix B and eq. 17.

use fearless_simd::{Simd, SimdFloat};
use nalgebra::Matrix3;
use nbody::points::Vec3;

use crate::lanes::{Lanes, Machine, Real, same};

/// Axes of the products of two coordinates.
const PAIRS: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

/// Determinant of sum d d^T, in units of its trace cubed, below which neighbours span no volume.
const FLAT: f64 = 1e-6;

/// What the sums say of the flow, in units of the sweep.
#[derive(Clone, Copy, Debug, Default)]
pub struct Flow {
    /// Trace of V; none where the neighbours span no volume.
    pub trace: Option<f64>,
    /// Modulus of the curl that V has, zero where there is none.
    pub curl: f64,
    /// tr S S^T of the traceless symmetric part S of V.
    pub shear2: f64,
    /// R.
    pub order: f64,
    /// sum m_j s_j v_ij . d
    pub m_div: f64,
    /// sum m_j s_j v_ij d^T and (sum m_j s_j d d^T)^-1, whose product is V; none where the neighbours span no volume.
    pub linear: Option<[Matrix3<f64>; 2]>,
}

/// The sums over neighbours.
pub struct Shear<S: Simd, E: Real> {
    dd: [Lanes<S, E>; 6],
    vd: [[Lanes<S, E>; 3]; 3],
    signs: Lanes<S, E>,
}

impl<S: Simd, E: Real> Shear<S, E> {
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        let zero = same::<S, E>(simd, 0.0);
        Self {
            dd: [zero; 6],
            vd: [[zero; 3]; 3],
            signs: zero,
        }
    }

    /// Adds some neighbours: separations, relative velocities, s times their weight, m W, and the signs of div v.
    #[inline(always)]
    pub fn add(
        &mut self,
        d: [Lanes<S, E>; 3],
        dv: [Lanes<S, E>; 3],
        [slope, m_value, sign]: [Lanes<S, E>; 3],
    ) {
        self.signs = m_value.mul_add(sign, self.signs);
        let weighted = [slope * d[0], slope * d[1], slope * d[2]];
        for (sum, (a, b)) in self.dd.iter_mut().zip(PAIRS) {
            *sum = weighted[a].mul_add(d[b], *sum);
        }
        for (sums, dv) in self.vd.iter_mut().zip(dv) {
            for (sum, weighted) in sums.iter_mut().zip(weighted) {
                *sum = weighted.mul_add(dv, *sum);
            }
        }
    }

    /// The flow along the `axes` of the domain, with its tensors if `whole`; `mass` is sum m_j W.
    #[inline(always)]
    pub fn flow<R: Machine<S, E>>(&self, axes: [bool; 3], mass: f64, whole: bool) -> Flow {
        let [dd, vd] = [&self.dd, self.vd.as_flattened()];
        let a = R::totals([dd[0], dd[1], dd[2], dd[3]]);
        let b = R::totals([dd[4], dd[5], vd[8], self.signs]);
        let c = R::totals([vd[0], vd[1], vd[2], vd[3]]);
        let d = R::totals([vd[4], vd[5], vd[6], vd[7]]);
        let dd = Matrix3::new(a[0], a[1], a[2], a[1], a[3], b[0], a[2], b[0], b[1]);
        let vd = Matrix3::new(c[0], c[1], c[2], c[3], d[0], d[1], d[2], d[3], b[2]);
        let flow = Flow {
            order: b[3] / mass,
            m_div: vd.trace(),
            ..Flow::default()
        };
        let Some(inverse) = inverse(dd, axes) else {
            return flow;
        };
        let v = vd * inverse;
        let (trace, shear2) = strain(&v, axes);
        Flow {
            trace: Some(trace),
            shear2,
            curl: Vec3::new(v.m32 - v.m23, v.m13 - v.m31, v.m21 - v.m12).norm(),
            linear: if whole { Some([vd, inverse]) } else { None },
            ..flow
        }
    }
}

/// The inverse of dd along `axes`, if it has one.
#[inline(always)]
fn inverse(mut dd: Matrix3<f64>, axes: [bool; 3]) -> Option<Matrix3<f64>> {
    let size = dd.trace();
    // Along axes that are missing nothing varies.
    for a in (0..3).filter(|&a| !axes[a]) {
        dd[(a, a)] = size;
    }
    let [x, y, z] = [dd.column(0), dd.column(1), dd.column(2)].map(|c| c.into_owned());
    // Rows of the inverse times the determinant, whose columns are those of dd.
    let rows = [y.cross(&z), z.cross(&x), x.cross(&y)];
    let determinant = x.dot(&rows[0]);
    let spanned = determinant.abs() > FLAT * (size * size * size).abs();
    let adjoint = Matrix3::from_rows(&rows.map(|row| row.transpose()));
    spanned.then(|| adjoint * (1.0 / determinant))
}

/// Trace, and square of the traceless symmetric part, along `axes`.
#[inline(always)]
fn strain(v: &Matrix3<f64>, axes: [bool; 3]) -> (f64, f64) {
    let present = axes.map(|axis| f64::from(u8::from(axis)));
    let trace = v.m11 * present[0] + v.m22 * present[1] + v.m33 * present[2];
    let mean = trace / (present[0] + present[1] + present[2]);
    let along = |x: f64, a: usize| (x - mean) * present[a];
    let across = |x: f64, y: f64, a: usize, b: usize| 0.5 * (x + y) * present[a] * present[b];
    let diagonal = [along(v.m11, 0), along(v.m22, 1), along(v.m33, 2)];
    let off = [
        across(v.m12, v.m21, 0, 1),
        across(v.m13, v.m31, 0, 2),
        across(v.m23, v.m32, 1, 2),
    ];
    let square = |x: [f64; 3]| x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
    (trace, square(diagonal) + 2.0 * square(off))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_flow_is_found_exactly_wherever_the_neighbours_are() {
        let flow = Matrix3::new(1.0, 2.0, -0.5, 0.3, -4.0, 0.7, 0.2, 1.1, 2.5);
        let (mut dd, mut vd) = (Matrix3::zeros(), Matrix3::zeros());
        for i in 1..20 {
            let f = |k: f64| (f64::from(i) * k).fract() - 0.3;
            let d = Vec3::new(f(0.618), f(0.414), f(0.732));
            let weight = -0.1 - f(0.236).abs();
            dd += weight * d * d.transpose();
            vd += weight * flow * d * d.transpose();
        }
        let v = vd * inverse(dd, [true; 3]).expect("a volume");
        let (div_v, shear2) = strain(&v, [true; 3]);
        let mean = flow.trace() / 3.0;
        let expected = 0.5 * (flow + flow.transpose()) - Matrix3::identity() * mean;
        assert!((div_v + 0.5).abs() < 1e-12);
        assert!((shear2 / expected.norm_squared() - 1.0).abs() < 1e-12);
        let line = Vec3::new(1.0, 2.0, 3.0);
        let flat = line * line.transpose();
        assert!(inverse(flat, [true; 3]).is_none());
    }

    #[test]
    fn in_a_plane_the_third_axis_is_silent() {
        // Rotation has neither divergence nor shear; v_z is a passive number there.
        let dd = -Matrix3::from_diagonal(&Vec3::new(2.0, 3.0, 0.0));
        let flow = Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 5.0, 5.0, 0.0);
        let plane = [true, true, false];
        let v = flow * dd * inverse(dd, plane).expect("a plane");
        let (div_v, shear2) = strain(&v, plane);
        assert!(div_v.abs() < 1e-15 && shear2 < 1e-15, "{div_v} {shear2}");
        let kepler = Matrix3::new(0.0, 0.5, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        let v = kepler * dd * inverse(dd, plane).expect("a plane");
        let (_, shear2) = strain(&v, plane);
        assert!((shear2 - 2.0 * 0.75 * 0.75).abs() < 1e-14);
    }
}
