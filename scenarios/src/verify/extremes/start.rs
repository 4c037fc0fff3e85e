//! A start: the file of particles that a case begins from, with any value in any column.

use std::path::Path;

use hdf5::File;
use nbody::points::Vec3;

use crate::hdf::{Array, Trouble, write_column};

/// Columns of groups of particles.
#[derive(Clone, Default)]
pub struct Start {
    columns: Vec<(usize, &'static str, Array)>,
}

impl Start {
    /// Particles of one type.
    pub fn new(part_type: usize, x: &[Vec3], v: &[Vec3], m: &[f64]) -> Self {
        Self::default().and(part_type, x, v, m)
    }

    /// The same and particles of another type.
    pub fn and(self, part_type: usize, x: &[Vec3], v: &[Vec3], m: &[f64]) -> Self {
        self.with(part_type, "Coordinates", Array::Vector(x.to_vec()))
            .with(part_type, "Velocities", Array::Vector(v.to_vec()))
            .with(part_type, "Masses", Array::Real(m.to_vec()))
    }

    /// With one more column, or in place of the one that it has.
    pub fn with(mut self, part_type: usize, name: &'static str, column: Array) -> Self {
        self.columns
            .retain(|(kind, known, _)| (*kind, *known) != (part_type, name));
        self.columns.push((part_type, name, column));
        self
    }

    /// With numbers.
    pub fn reals(self, part_type: usize, name: &'static str, values: &[f64]) -> Self {
        self.with(part_type, name, Array::Real(values.to_vec()))
    }

    /// With one number of one column in place of what is there.
    pub fn spoiled(mut self, part_type: usize, name: &'static str, value: f64) -> Self {
        let found = self
            .columns
            .iter_mut()
            .find(|(kind, known, _)| (*kind, *known) == (part_type, name));
        match found {
            Some((.., Array::Real(values))) => values[1] = value,
            Some((.., Array::Vector(values))) => values[1].y = value,
            _ => panic!("a start has {name}"),
        }
        self
    }

    pub fn write(&self, path: &Path) -> Result<(), Trouble> {
        let file = File::create(path)?;
        for (kind, name, column) in &self.columns {
            let group = format!("PartType{kind}");
            let group = file.group(&group).or_else(|_| file.create_group(&group))?;
            write_column(&group, name, column.as_ref())?;
        }
        Ok(())
    }
}
