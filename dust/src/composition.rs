//! Composition: mass fractions of ice, silicate and iron in a compact grain, and the geometry that follows from them.
//!
//! 1/rho = sum f_k / rho_k; the ice is a mantle around a core of the rest. Densities of ice at 100 to 200 K, of olivine and of iron: 0.92,
//! 3.3 and 7.87 g/cm^3 (CRC Handbook of Chemistry and Physics).

use nbody::points::Vec3;

/// Densities of ice, silicate and iron, g/cm^3.
pub const DENSITIES: [f64; 3] = [0.92, 3.3, 7.87];

/// Densities of ice, silicate and iron, code units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Materials(pub [f64; 3]);

impl Materials {
    /// Density of the ice.
    pub fn ice(&self) -> f64 {
        self.0[0]
    }

    /// Density of a grain of these mass fractions.
    pub fn density(&self, fractions: Vec3) -> f64 {
        let volumes = fractions.iter().zip(self.0);
        1.0 / volumes.map(|(f, rho)| f / rho).sum::<f64>()
    }

    /// Radius of the core, by that of the grain.
    pub fn core(&self, fractions: Vec3) -> f64 {
        let core = fractions.y / self.0[1] + fractions.z / self.0[2];
        (core * self.density(fractions)).cbrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn densities_and_cores_follow_from_fractions() {
        let materials = Materials([1.0, 3.0, 8.0]);
        // Half of the mass is ice: volumes 1/2 and 1/8 + 1/64 a unit mass, by hand.
        let fractions = Vec3::new(0.5, 0.375, 0.125);
        assert!((materials.density(fractions) - 64.0 / 41.0).abs() < 1e-15);
        assert!((materials.core(fractions).powi(3) - 9.0 / 41.0).abs() < 1e-15);
        assert_eq!(materials.density(Vec3::x()), 1.0);
        assert_eq!(materials.core(Vec3::x()), 0.0);
        assert!((materials.core(Vec3::new(0.0, 0.2, 0.8)) - 1.0).abs() < 1e-15);
    }
}
