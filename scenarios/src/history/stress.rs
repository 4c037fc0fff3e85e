//! The history of the gas's stress (`stress.csv`): the alpha of its turbulence in rings about the star, at each report.
//!
//! `alpha` is the average over about an orbit as it is measured, of any sign; `stirring` is what stirs the dust, no less than the scene's floor.

use std::io;

use coupling::stress::Stress;

use super::{Table, cell};

/// Columns of `stress.csv`.
pub const HEAD: [&str; 4] = ["time", "radius", "alpha", "stirring"];

/// Adds a line a ring, as it stands at `time`.
pub fn push(time: f64, stress: &Stress, floor: f64, table: &mut Table) -> io::Result<()> {
    for (k, ring) in stress.rings.iter().enumerate() {
        let radius = stress.middle(k).exp();
        let alpha = ring.alpha();
        table.push(&[time, radius, alpha, alpha.max(floor)].map(cell))?;
    }
    Ok(())
}
