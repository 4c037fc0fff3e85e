//! The velocity gradient of one particle, exact for linear flows, and how orderly the flow around it converges.
//!
//! V = (sum m_j s_j v_ij d^T) (sum m_j s_j d d^T)^-1, s = dw/dq / q;   R = sum m_j sign(div v_j) W / sum m_j W
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
pub struct Gradient {
    /// Trace of V.
    pub div_v: f64,
    /// tr S S^T of the traceless symmetric part S of V.
    pub shear2: f64,
    /// R.
    pub order: f64,
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

    /// Adds some neighbours: separations, relative velocities, m s, m W, and the signs of div v.
    #[inline(always)]
    pub fn add(
        &mut self,
        d: [Lanes<S, E>; 3],
        dv: [Lanes<S, E>; 3],
        [m_slope, m_value, sign]: [Lanes<S, E>; 3],
    ) {
        self.signs = m_value.mul_add(sign, self.signs);
        let weighted = d.map(|d| m_slope * d);
        for (sum, (a, b)) in self.dd.iter_mut().zip(PAIRS) {
            *sum = weighted[a].mul_add(d[b], *sum);
        }
        for (sums, dv) in self.vd.iter_mut().zip(dv) {
            for (sum, weighted) in sums.iter_mut().zip(weighted) {
                *sum = weighted.mul_add(dv, *sum);
            }
        }
    }

    /// The gradient along the `axes` of the domain; where the neighbours span no volume, `div_v` stands for its trace and shear for nothing.
    #[inline(always)]
    pub fn gradient<R: Machine<S, E>>(&self, axes: [bool; 3], mass: f64, div_v: f64) -> Gradient {
        let mut dd = Matrix3::zeros();
        for (sum, (a, b)) in self.dd.iter().zip(PAIRS) {
            (dd[(a, b)], dd[(b, a)]) = (R::total(*sum), R::total(*sum));
        }
        let vd = Matrix3::from_fn(|a, b| R::total(self.vd[a][b]));
        let order = R::total(self.signs) / mass;
        gradient(dd, vd, axes).map_or(
            Gradient {
                div_v,
                shear2: 0.0,
                order,
            },
            |[div_v, shear2]| Gradient {
                div_v,
                shear2,
                order,
            },
        )
    }
}

/// Trace and squared shear of vd dd^-1 along `axes`, if dd has an inverse.
fn gradient(mut dd: Matrix3<f64>, vd: Matrix3<f64>, axes: [bool; 3]) -> Option<[f64; 2]> {
    let size = dd.trace();
    // Along axes that are missing nothing varies.
    for a in (0..3).filter(|&a| !axes[a]) {
        dd[(a, a)] = size;
    }
    let spanned = dd.determinant().abs() > FLAT * size.abs().powi(3);
    let inverse = dd.try_inverse().filter(|_| spanned)?;
    let v = vd * inverse;
    let present = |a: usize| f64::from(u8::from(axes[a]));
    let along = Vec3::from_fn(|a, _| present(a));
    let mean = v.diagonal().dot(&along) / along.sum();
    let plane = Matrix3::from_fn(|a, b| v[(a, b)] * present(a) * present(b));
    let shear = 0.5 * (plane + plane.transpose()) - mean * Matrix3::from_diagonal(&along);
    Some([mean * along.sum(), shear.norm_squared()])
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
        let [div_v, shear2] = gradient(dd, vd, [true; 3]).expect("a volume");
        let mean = flow.trace() / 3.0;
        let expected = 0.5 * (flow + flow.transpose()) - Matrix3::identity() * mean;
        assert!((div_v + 0.5).abs() < 1e-12);
        assert!((shear2 / expected.norm_squared() - 1.0).abs() < 1e-12);
        let line = Vec3::new(1.0, 2.0, 3.0);
        let flat = line * line.transpose();
        assert!(gradient(flat, flat, [true; 3]).is_none());
    }

    #[test]
    fn in_a_plane_the_third_axis_is_silent() {
        // Rotation has neither divergence nor shear; v_z is a passive number there.
        let dd = -Matrix3::from_diagonal(&Vec3::new(2.0, 3.0, 0.0));
        let flow = Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 5.0, 5.0, 0.0);
        let [div_v, shear2] = gradient(dd, flow * dd, [true, true, false]).expect("a plane");
        assert!(div_v.abs() < 1e-15 && shear2 < 1e-15, "{div_v} {shear2}");
        let kepler = Matrix3::new(0.0, 0.5, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        let [_, shear2] = gradient(dd, kepler * dd, [true, true, false]).expect("a plane");
        assert!((shear2 - 2.0 * 0.75 * 0.75).abs() < 1e-14);
    }
}
