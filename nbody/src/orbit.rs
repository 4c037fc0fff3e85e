//! An orbit: its six elements, and the position and velocity relative to the attracting mass that they stand for.
//!
//! Ellipse: M = E - e sin E; hyperbola: a < 0, M = e sinh H - H; parabola (e = 1): `semi_major_axis` holds the pericentre distance q,
//! M = D + D^3/3, D = tan(nu/2). In all cases M grows linearly in time, by [`Elements::mean_motion`].
//! Angles in radians. mu = G (M + m) for a body of mass m.
//! Source: Murray & Dermott (1999), chapter 2.

use std::f64::consts::TAU;

use crate::kepler;
use crate::points::Vec3;

/// The elements of a Kepler orbit; angles in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elements {
    /// Negative on hyperbolas; the pericentre distance on parabolas.
    pub semi_major_axis: f64,
    pub eccentricity: f64,
    pub inclination: f64,
    /// Longitude of the ascending node; zero for an orbit in the xy plane.
    pub node: f64,
    /// Angle from the node to the pericentre; zero for a circle.
    pub pericentre: f64,
    pub mean_anomaly: f64,
}

impl Elements {
    /// Distance of the pericentre.
    pub fn pericentre_distance(&self) -> f64 {
        if self.eccentricity == 1.0 {
            self.semi_major_axis
        } else {
            self.semi_major_axis * (1.0 - self.eccentricity)
        }
    }

    /// Rate of the mean anomaly.
    pub fn mean_motion(&self, mu: f64) -> f64 {
        let a = self.semi_major_axis.abs();
        let scale = if self.eccentricity == 1.0 { 2.0 } else { 1.0 };
        (mu / (scale * a)).sqrt() / a
    }

    /// Position and velocity relative to the attracting mass.
    pub fn state(&self, mu: f64) -> (Vec3, Vec3) {
        let q = self.pericentre_distance();
        assert!(q > 0.0, "a < 0 goes with e > 1, a > 0 with e <= 1");
        let time = self.mean_anomaly / self.mean_motion(mu);
        let (x, v) = kepler::from_pericentre(mu, q, self.eccentricity, time);
        let [p, q] = self.axes();
        (p * x[0] + q * x[1], p * v[0] + q * v[1])
    }

    /// Unit vectors in the orbit's plane: towards the pericentre, and a quarter of a turn ahead of it.
    fn axes(&self) -> [Vec3; 2] {
        let (so, co) = self.node.sin_cos();
        let (si, ci) = self.inclination.sin_cos();
        let (sw, cw) = self.pericentre.sin_cos();
        let node = Vec3::new(co, so, 0.0);
        let ahead = Vec3::new(-so * ci, co * ci, si);
        [node * cw + ahead * sw, ahead * cw - node * sw]
    }

    /// The elements of the orbit through position `x` with velocity `v`; none if it is radial, for it has no plane then.
    ///
    /// What is a parabola to eight digits is given as one.
    pub fn of(mu: f64, x: Vec3, v: Vec3) -> Option<Self> {
        let (r, momentum) = (x.norm(), x.cross(&v));
        let h = momentum.norm();
        if h.is_nan() || h <= 0.0 || r <= 0.0 {
            return None;
        }
        let shape = Shape::of(mu, r, x.dot(&v), v.norm_squared(), h)?;
        let flat = momentum.x.hypot(momentum.y);
        let (inclination, node) = if flat > 0.0 {
            (flat.atan2(momentum.z), momentum.x.atan2(-momentum.y))
        } else {
            (0f64.atan2(momentum.z), 0.0)
        };
        let towards_node = Vec3::new(node.cos(), node.sin(), 0.0);
        let ahead = momentum.cross(&towards_node) / h;
        let from_node = x.dot(&ahead).atan2(x.dot(&towards_node));
        Some(Self {
            semi_major_axis: shape.a,
            eccentricity: shape.e,
            inclination,
            node: node.rem_euclid(TAU),
            pericentre: (from_node - shape.true_anomaly).rem_euclid(TAU),
            mean_anomaly: shape.mean_anomaly,
        })
    }
}

/// Where |1 - e^2| and r/|a| are below this, a and e would lose more digits of the pericentre than calling it a parabola does.
const PARABOLIC: f64 = 1e-8;

/// The elements within the plane, but for the direction of the pericentre.
struct Shape {
    a: f64,
    e: f64,
    true_anomaly: f64,
    mean_anomaly: f64,
}

impl Shape {
    fn of(mu: f64, r: f64, eta: f64, v2: f64, h: f64) -> Option<Self> {
        let beta = 2.0 * mu / r - v2;
        let k = beta.abs().sqrt();
        // Square root of |1 - e^2|: exact where e itself is rounded to 1.
        let oblate = h * k / mu;
        if oblate * oblate < PARABOLIC && r * beta.abs() < PARABOLIC * mu {
            return Some(Self::parabola(mu, eta, h));
        }
        let (e_cos, e_sin) = (1.0 - r * beta / mu, eta * k / mu);
        if beta > 0.0 {
            let e = if oblate < 0.5 {
                (1.0 - oblate * oblate).sqrt()
            } else {
                e_cos.hypot(e_sin)
            };
            if e < 1.0 {
                let anomaly = if e > 0.0 { e_sin.atan2(e_cos) } else { 0.0 };
                let (sin, cos) = anomaly.sin_cos();
                return Some(Self {
                    a: mu / beta,
                    e,
                    true_anomaly: (oblate * sin).atan2(cos - e),
                    mean_anomaly: anomaly - e_sin,
                });
            }
        } else {
            let e = (1.0 + oblate * oblate).sqrt();
            if e > 1.0 {
                let sinh = e_sin / e;
                return Some(Self {
                    a: mu / beta,
                    e,
                    true_anomaly: (oblate * sinh).atan2(e - sinh.hypot(1.0)),
                    mean_anomaly: e_sin - sinh.asinh(),
                });
            }
        }
        // A needle: e is rounded to 1 though the orbit is bound or fast.
        None
    }

    fn parabola(mu: f64, eta: f64, h: f64) -> Self {
        let d = eta / h;
        Self {
            a: 0.5 * h * h / mu,
            e: 1.0,
            true_anomaly: 2.0 * d.atan(),
            mean_anomaly: d + d * d * d / 3.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn elements(a: f64, e: f64, angles: [f64; 4]) -> Elements {
        let [inclination, node, pericentre, mean_anomaly] = angles;
        Elements {
            semi_major_axis: a,
            eccentricity: e,
            inclination,
            node,
            pericentre,
            mean_anomaly,
        }
    }

    fn difference(a: Elements, b: Elements) -> f64 {
        let turn = |a: f64, b: f64| ((a - b + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU).abs();
        [
            (a.semi_major_axis / b.semi_major_axis - 1.0).abs(),
            (a.eccentricity - b.eccentricity).abs(),
            turn(a.inclination, b.inclination),
            turn(a.node, b.node),
            turn(a.pericentre, b.pericentre),
            (a.mean_anomaly - b.mean_anomaly).abs(),
        ]
        .into_iter()
        .fold(0.0, |most, d| if d > most || d.is_nan() { d } else { most })
    }

    #[test]
    fn states_agree_with_forty_digits() {
        // mu = 1; a, e, i, Omega, omega, M and the position and velocity there.
        #[rustfmt::skip]
        let table = [
            (elements(1.0, 0.0, [0.1, 0.2, 0.3, 0.4]), [0.6222493666562041, 0.7801726583644164, 0.06431445278125644, -0.7825677891167766, 0.6178651092221131, 0.07635680875224371]),
            (elements(1.0, 0.5, [0.5, 1.0, 2.0, -1.0]), [0.5425218024892488, 0.7967006218108424, -0.014235098143694364, -0.939304597406075, 0.02150003122191682, 0.43814228937248245]),
            (elements(1.0, 0.99, [1.0, 1.0, 2.0, 0.5]), [0.5356595238347154, -0.04788554034646818, -0.742283282944046, 0.6899192522163858, 0.08061438595158209, -0.8363137663610599]),
            (elements(1.0, 0.999999, [0.3, 0.4, 0.5, 1.0]), [-0.8550964887840443, -1.0345175420566708, -0.19174624987235242, -0.43394458563094235, -0.5265772243291903, -0.09775760485122947]),
            (elements(-1.0, 1.3, [0.2, 0.1, 0.4, -1.0]), [0.04255034318570439, -1.6573406232293497, -0.3351422793797272, 0.4558005376375586, 1.3792531567093178, 0.2689675358629325]),
        ];
        for (orbit, [x, y, z, u, v, w]) in table {
            let e = orbit.eccentricity;
            let (position, velocity) = orbit.state(1.0);
            let error =
                (position - Vec3::new(x, y, z)).norm() + (velocity - Vec3::new(u, v, w)).norm();
            // 0.999999 is no binary number: its rounding is 5e-11 of the pericentre distance.
            let bar = if e > 0.9999 && e < 1.0 { 3e-13 } else { 3e-15 };
            assert!(error < bar, "{orbit:?}: {error:e}");
        }
    }

    #[test]
    fn elements_survive_the_way_to_positions_and_back() {
        for (a, e) in [
            (2.0, 1e-6),
            (0.3, 0.1),
            (1.0, 0.9),
            (1.5, 1.0),
            (-0.5, 1.1),
            (-2.0, 4.0),
        ] {
            for angles in [
                [0.1, 0.2, 0.3, 0.4],
                [3.0, 5.0, 6.0, -2.0],
                [1.5, 3.0, 2.0, 3.0],
            ] {
                let orbit = elements(a, e, angles);
                let (x, v) = orbit.state(2.5);
                let error = difference(Elements::of(2.5, x, v).expect("a plane"), orbit);
                // Where the pericentre of a near circle lies is known to 1e-16/e.
                assert!(error < 4e-15 + 1e-15 / e, "{orbit:?}: {error:e}");
            }
        }
    }

    #[test]
    fn orbits_without_node_or_pericentre_come_back_as_states() {
        for (e, i) in [
            (0.0, 0.0),
            (0.0, 0.3),
            (0.2, 0.0),
            (0.2, 0.5 * TAU),
            (1e-16, 1e-16),
        ] {
            let (x, v) = elements(1.0, e, [i, 0.0, 0.0, 0.7]).state(1.0);
            let (y, w) = Elements::of(1.0, x, v).expect("a plane").state(1.0);
            let error = (x - y).norm() + (v - w).norm();
            assert!(error < 3e-15, "{e} {i}: {error:e}");
        }
    }

    #[test]
    fn the_mean_anomaly_grows_by_the_mean_motion() {
        for (a, e) in [(2.0, 0.3), (1.5, 1.0), (-0.5, 1.7)] {
            let orbit = elements(a, e, [0.3, 1.0, 2.0, -0.4]);
            let (mut x, mut v) = orbit.state(1.0);
            kepler::drift(1.0, 0.8, &mut x, &mut v).expect("an orbit");
            let grown = orbit.mean_anomaly + 0.8 * orbit.mean_motion(1.0);
            let (y, w) = elements(a, e, [0.3, 1.0, 2.0, grown]).state(1.0);
            let error = (x - y).norm() + (v - w).norm();
            assert!(error < 5e-15, "e {e}: {error:e}");
        }
    }

    #[test]
    fn a_radial_orbit_has_no_elements() {
        for speed in [0.0, 0.3, 2f64.sqrt(), 3.0] {
            assert_eq!(Elements::of(1.0, Vec3::x(), speed * Vec3::x()), None);
        }
        assert_eq!(Elements::of(1.0, Vec3::zeros(), Vec3::x()), None);
    }
}
