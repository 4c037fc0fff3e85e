//! Units: what a code unit is in cgs, and quantities like `"5.2 au"` brought to code units.
//!
//! Astronomical: au, solar mass, yr/2pi rounded so that G = 1 exactly. Sources: IAU 2012 B2 (au), IAU 2015 B3 (nominal masses),
//! CODATA 2018 (G).

/// Systems of code units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum System {
    Astronomical,
    Dimensionless,
    Cgs,
}

/// Code units in cgs; all one for dimensionless scenes. The unit of temperature is the kelvin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    pub system: System,
    /// cm
    pub length: f64,
    /// g
    pub mass: f64,
    /// s
    pub time: f64,
}
