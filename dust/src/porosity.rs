//! Porosity: volume of aggregates of equal monomers after collisions, and under the pressure of gas and of their own gravity.
//!
//! Hit and stick: V = V_1 + V_2 + min(0.99 - 1.03 ln(2/(V_1/V_2 + 1)), 6.94) V_2, V_1 >= V_2 (Okuzumi, Tanaka & Sakagami 2009, ApJ 707, 1247, eq. 16).
//! Compression with e = E_imp / (3 b E_roll), b = 0.15 (Okuzumi et al. 2012, ApJ 752, 106, eq. 15), S = V_1^(5/6) + V_2^(5/6), N monomers V_0:
//!   e < 1: V^(5/6) = (1 - e) V_hit^(5/6) + e S;   e > 1: V^(-10/3) = (3/5)^5 3 (e - 1) / (N^5 V_0^(10/3)) + S^-4.
//! Static: filling factor phi = (P r_0^3 / E_roll)^(1/3) (Kataoka et al. 2013, A&A 557, L4), P = m u / (t_stop pi a^2) by gas that streams
//! past at u, and G m^2 / (pi a^4). Aggregates count as spheres of their volume; fragments keep the filling factor, bounces do not compress.

use std::f64::consts::PI;

/// The monomers of all aggregates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Monomers {
    pub radius: f64,
    /// material density
    pub density: f64,
    /// energy that rolls one over another by a quarter turn
    pub rolling_energy: f64,
    /// constant of gravity; zero for aggregates that do not pull themselves together
    pub g: f64,
}

/// Mass and volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aggregate {
    pub m: f64,
    pub volume: f64,
}

impl Aggregate {
    /// A sphere.
    pub fn new(radius: f64, density: f64) -> Self {
        let volume = 4.0 / 3.0 * PI * radius.powi(3);
        Self {
            m: volume * density,
            volume,
        }
    }

    pub fn radius(&self) -> f64 {
        (0.75 / PI * self.volume).cbrt()
    }

    pub fn density(&self) -> f64 {
        self.m / self.volume
    }
}

/// b of the compression.
const COMPRESSION: f64 = 0.15;

/// Volume of the voids that open when two aggregates of these volumes stick without restructuring.
pub fn void(v1: f64, v2: f64) -> f64 {
    let (large, small) = (v1.max(v2), v1.min(v2));
    let factor = 0.99 - 1.03 * (2.0 / (large / small + 1.0)).ln();
    factor.min(6.94) * small
}

impl Monomers {
    /// Volume of a monomer.
    pub fn volume(&self) -> f64 {
        4.0 / 3.0 * PI * self.radius.powi(3)
    }

    /// Volume without any voids.
    pub fn compact(&self, m: f64) -> f64 {
        m / self.density
    }

    /// Volume of two aggregates that have stuck at a relative speed.
    pub fn merged(&self, one: &Aggregate, two: &Aggregate, speed: f64) -> f64 {
        let m = one.m + two.m;
        let energy = 0.5 * one.m * two.m / m * speed * speed;
        let e = energy / (3.0 * COMPRESSION * self.rolling_energy);
        let sum = one.volume.powf(5.0 / 6.0) + two.volume.powf(5.0 / 6.0);
        let volume = if e < 1.0 {
            let hit = one.volume + two.volume + void(one.volume, two.volume);
            ((1.0 - e) * hit.powf(5.0 / 6.0) + e * sum).powf(1.2)
        } else {
            // In units of the monomer's volume: the powers are large.
            let unit = self.volume();
            let n = self.compact(m) / unit;
            let sum = sum / unit.powf(5.0 / 6.0);
            let stiff = 0.6f64.powi(5) * 3.0 * (e - 1.0) / n.powi(5);
            unit * (stiff + sum.powi(-4)).powf(-0.3)
        };
        volume.max(self.compact(m))
    }

    /// Volume after sticking to `many` of another that are much lighter together.
    pub fn coated(&self, one: &Aggregate, other: &Aggregate, many: f64, speed: f64) -> f64 {
        let change = self.merged(one, other, speed) - one.volume;
        let compact = self.compact(one.m + many * other.m);
        (one.volume + many * change).max(compact)
    }

    /// Volume under the pressure of gas that streams past at `speed` and of its own gravity; at most its present one.
    pub fn settled(&self, grain: &Aggregate, speed: f64, t_stop: f64) -> f64 {
        let strength = self.rolling_energy / self.radius.powi(3);
        let radius = grain.radius();
        let ram = grain.m * speed / (t_stop * PI * radius * radius);
        let by_gas = (ram / strength).cbrt();
        // P ~ phi^(4/3), so phi^(5/3) is its value at phi = 1.
        let solid = (0.75 / PI * self.compact(grain.m)).cbrt();
        let weight = self.g * grain.m * grain.m / (PI * solid.powi(4));
        let by_gravity = (weight / strength).powf(0.6);
        let filling = by_gas.max(by_gravity).min(1.0);
        let compact = self.compact(grain.m);
        if filling * grain.volume > compact {
            compact / filling
        } else {
            grain.volume
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Icy monomers of 0.1 um, cgs.
    const ICE: Monomers = Monomers {
        radius: 1e-5,
        density: 1.0,
        rolling_energy: 4.74e-9,
        g: 6.674e-8,
    };

    fn doubled(one: &Aggregate, speed: f64) -> Aggregate {
        Aggregate {
            m: 2.0 * one.m,
            volume: ICE.merged(one, one, speed),
        }
    }

    #[test]
    fn hit_and_stick_makes_fractals() {
        let mut grain = Aggregate::new(ICE.radius, ICE.density);
        let mut fill = Vec::new();
        for _ in 0..20 {
            grain = doubled(&grain, 0.0);
            fill.push(grain.density() / ICE.density);
        }
        for (doublings, filling) in [
            (1, 0.66889632107),
            (10, 0.0179303213612),
            (20, 0.000321496424115),
        ] {
            let error = fill[doublings - 1] / filling - 1.0;
            assert!(error.abs() < 1e-10, "{doublings}: {error:e}");
        }
        // Volume grows by 2.99 a doubling: N ~ a^D.
        let dimension = 3.0 * 2f64.ln() / (2.0 * fill[18] / fill[19]).ln();
        assert!((dimension - 1.89855936024).abs() < 1e-9, "{dimension}");
    }

    #[test]
    fn unequal_grains_leave_voids_of_at_most_seven_small_volumes() {
        let [one, big] = [1.0, 1e6];
        assert!((void(big, one) - 6.94).abs() < 1e-12);
        assert_eq!(void(one, one), 0.99);
        assert_eq!(void(3.0, one), void(one, 3.0));
        // A coat of many is as many single hits on a target that stays what it is.
        let aggregate = |m: f64| Aggregate { m, volume: m };
        let coat = ICE.coated(&aggregate(1.0), &aggregate(1e-7), 1e4, 0.0);
        assert!((coat - 1.0 - 7.94e-3).abs() < 1e-9, "{coat}");
    }

    #[test]
    fn impacts_compress_without_a_jump_and_as_the_energy() {
        let mut grain = Aggregate::new(ICE.radius, ICE.density);
        for _ in 0..30 {
            grain = doubled(&grain, 0.0);
        }
        let threshold = (3.0 * COMPRESSION * ICE.rolling_energy * 4.0 / grain.m).sqrt();
        let volume = |factor: f64| ICE.merged(&grain, &grain, factor * threshold);
        let jump = volume(1.0 + 1e-9) / volume(1.0 - 1e-9) - 1.0;
        assert!(jump.abs() < 1e-7, "{jump:e}");
        assert!((volume(1.0) / grain.volume - 2f64.powf(1.2)).abs() < 1e-6);
        // Far above: V ~ (E_imp / N^5)^(-3/10), by hand for 2^31 monomers, in units of one.
        let (e, n) = (1e8 * 1e8, 2f64.powi(31));
        let far = (0.6f64.powi(5) * 3.0 * e / n.powi(5)).powf(-0.3) * ICE.volume();
        let error = volume(1e8) / far.max(ICE.compact(2.0 * grain.m)) - 1.0;
        assert!(error.abs() < 1e-6, "{error:e}");
        assert!(volume(1e30) == ICE.compact(2.0 * grain.m));
    }

    #[test]
    fn gas_and_gravity_hold_aggregates_together() {
        // phi by gravity of 1e10 g: P = G m^2/(pi a^4) = E_roll/r_0^3 phi^3 is solved by the filling factor found.
        let loose = Aggregate {
            m: 1e10,
            volume: 1e16,
        };
        let settled = Aggregate {
            volume: ICE.settled(&loose, 0.0, 1.0),
            ..loose
        };
        let phi = settled.density() / ICE.density;
        let pressure = ICE.g * loose.m * loose.m / (PI * settled.radius().powi(4));
        let strength = ICE.rolling_energy / ICE.radius.powi(3) * phi.powi(3);
        assert!((pressure / strength - 1.0).abs() < 1e-9 && phi < 0.9);
        // By gas: Epstein's pressure 4/3 rho v_th u does not depend on the size.
        let (rho, v_th, speed) = (1e-11, 1e5, 1e3);
        let grain = Aggregate {
            m: 1e-3,
            volume: 1e3,
        };
        let t_stop = grain.density() * grain.radius() / (rho * v_th);
        let phi = grain.m / ICE.settled(&grain, speed, t_stop);
        let expected = (4.0 / 3.0 * rho * v_th * speed * 1e-15 / 4.74e-9f64).cbrt();
        assert!((phi / expected - 1.0).abs() < 1e-9, "{phi} {expected}");
        // What is denser already stays.
        let dense = Aggregate::new(1.0, 0.5);
        assert_eq!(ICE.settled(&dense, 0.0, 1.0), dense.volume);
    }
}
