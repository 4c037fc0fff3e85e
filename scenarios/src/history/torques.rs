//! The history of torques (`torques.csv`): what each population does to each planet, at each report.
//!
//! Torque r x F and power v . F about the star, code units; `outside` leaves out what is within the planet's Hill radius.

use std::io;

use coupling::System;
use coupling::torques::Torque;
use nbody::points::Vec3;

use super::{Table, cell};

/// Columns of `torques.csv`.
pub const HEAD: [&str; 11] = [
    "time",
    "id",
    "source",
    "torque_x",
    "torque_y",
    "torque_z",
    "power",
    "outside_torque_x",
    "outside_torque_y",
    "outside_torque_z",
    "outside_power",
];

/// Adds a line a planet and source, for the system as it stands at `time`.
pub fn push(time: f64, torques: &[Torque], system: &System, table: &mut Table) -> io::Result<()> {
    let (bodies, star) = (&system.bodies, &system.star);
    let centre = |of: &[Vec3]| of.first().copied().unwrap_or_else(Vec3::zeros);
    let (x, v) = (centre(&star.x), centre(&star.v));
    for torque in torques {
        // A planet that was swallowed at this very report has no place any more.
        let Some(i) = bodies.id.iter().position(|&id| id == torque.id) else {
            continue;
        };
        let (x, v) = (bodies.x[i] - x, bodies.v[i] - v);
        let mut cells = vec![cell(time), torque.id.to_string(), torque.source.to_owned()];
        for force in [torque.force, torque.outside] {
            let turn = x.cross(&force);
            cells.extend([turn.x, turn.y, turn.z, v.dot(&force)].map(cell));
        }
        table.push(&cells)?;
    }
    Ok(())
}
