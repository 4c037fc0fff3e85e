//! A column: one quantity of all particles of a set, with the name, dimension and text under which files know it.
//!
//! A set lists its columns once, by the `columns!` macro; snapshot, checkpoint, sorting, removal, append and the finite check
//! walk that list.

use rayon::prelude::*;

use super::Vec3;
use super::sum::CHUNK;

mod declaration;

/// Exponents of length, mass, time and temperature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dimension {
    pub length: i8,
    pub mass: i8,
    pub time: i8,
    pub temperature: i8,
}

impl Dimension {
    pub const NONE: Self = Self::new(0, 0, 0, 0);
    pub const LENGTH: Self = Self::new(1, 0, 0, 0);
    pub const MASS: Self = Self::new(0, 1, 0, 0);
    pub const TIME: Self = Self::new(0, 0, 1, 0);
    pub const TEMPERATURE: Self = Self::new(0, 0, 0, 1);
    pub const VELOCITY: Self = Self::new(1, 0, -1, 0);
    pub const ACCELERATION: Self = Self::new(1, 0, -2, 0);
    pub const DENSITY: Self = Self::new(-3, 1, 0, 0);
    /// Mass an area: the density of a two-dimensional scene.
    pub const SURFACE_DENSITY: Self = Self::new(-2, 1, 0, 0);
    pub const PRESSURE: Self = Self::new(-1, 1, -2, 0);
    pub const SPECIFIC_ENERGY: Self = Self::new(2, 0, -2, 0);
    pub const SPECIFIC_POWER: Self = Self::new(2, 0, -3, 0);
    pub const RATE: Self = Self::new(0, 0, -1, 0);
    pub const ANGULAR_MOMENTUM: Self = Self::new(2, 1, -1, 0);

    pub const fn new(length: i8, mass: i8, time: i8, temperature: i8) -> Self {
        Self {
            length,
            mass,
            time,
            temperature,
        }
    }
}

/// Which files hold a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keep {
    /// Snapshots and checkpoints.
    Snapshot,
    /// Checkpoints alone.
    Checkpoint,
}

/// What files say of a column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Label {
    pub name: &'static str,
    pub dimension: Dimension,
    pub keep: Keep,
    pub text: &'static str,
    /// Whether the column may be empty in a set that is not: it stays so until it is filled.
    pub optional: bool,
}

impl Label {
    /// The same column where it may be empty.
    pub const fn optional(self) -> Self {
        Self {
            optional: true,
            ..self
        }
    }

    /// A column that users see in snapshots.
    pub const fn snapshot(name: &'static str, dimension: Dimension, text: &'static str) -> Self {
        Self {
            name,
            dimension,
            keep: Keep::Snapshot,
            text,
            optional: false,
        }
    }

    /// A column that only a restart needs.
    pub const fn checkpoint(name: &'static str, dimension: Dimension, text: &'static str) -> Self {
        Self {
            name,
            dimension,
            keep: Keep::Checkpoint,
            text,
            optional: false,
        }
    }
}

/// A column to read.
#[derive(Clone, Copy, Debug)]
pub enum ColumnRef<'a> {
    Real(&'a [f64]),
    Vector(&'a [Vec3]),
    Integer(&'a [u64]),
    Short(&'a [u32]),
}

/// A column to write.
#[derive(Debug)]
pub enum ColumnMut<'a> {
    Real(&'a mut Vec<f64>),
    Vector(&'a mut Vec<Vec3>),
    Integer(&'a mut Vec<u64>),
    Short(&'a mut Vec<u32>),
}

impl ColumnRef<'_> {
    pub fn is_empty(&self) -> bool {
        match self {
            Self::Real(v) => v.is_empty(),
            Self::Vector(v) => v.is_empty(),
            Self::Integer(v) => v.is_empty(),
            Self::Short(v) => v.is_empty(),
        }
    }
}

impl ColumnMut<'_> {
    pub fn is_empty(&self) -> bool {
        match self {
            Self::Real(v) => v.is_empty(),
            Self::Vector(v) => v.is_empty(),
            Self::Integer(v) => v.is_empty(),
            Self::Short(v) => v.is_empty(),
        }
    }
}

impl ColumnMut<'_> {
    fn reborrow(&mut self) -> ColumnMut<'_> {
        match self {
            Self::Real(v) => ColumnMut::Real(v),
            Self::Vector(v) => ColumnMut::Vector(v),
            Self::Integer(v) => ColumnMut::Integer(v),
            Self::Short(v) => ColumnMut::Short(v),
        }
    }

    fn permute(self, order: &[u32], scratch: &mut Scratch) {
        match self {
            Self::Real(v) => gather(v, order, &mut scratch.real),
            Self::Vector(v) => gather(v, order, &mut scratch.vector),
            Self::Integer(v) => gather(v, order, &mut scratch.integer),
            Self::Short(v) => gather(v, order, &mut scratch.short),
        }
    }

    /// Makes the column `n` long; new entries are zero.
    fn resize(self, n: usize) {
        match self {
            Self::Real(v) => v.resize(n, 0.0),
            Self::Vector(v) => v.resize(n, Vec3::zeros()),
            Self::Integer(v) => v.resize(n, 0),
            Self::Short(v) => v.resize(n, 0),
        }
    }
}

/// Buffers that a permutation needs, kept between calls so that steady state allocates nothing.
#[derive(Clone, Debug, Default)]
pub struct Scratch {
    real: Vec<f64>,
    vector: Vec<Vec3>,
    integer: Vec<u64>,
    short: Vec<u32>,
}

/// A set of columns of equal length; those that are optional may be empty instead.
pub trait Columns {
    /// All columns, in the order of their declaration.
    fn list(&self) -> Vec<(Label, ColumnRef<'_>)>;

    /// Bytes that the columns hold reserved, filled or not.
    fn reserved(&self) -> usize;

    /// All columns, in the order of their declaration.
    fn list_mut(&mut self) -> Vec<(Label, ColumnMut<'_>)>;

    /// Number of particles.
    fn len(&self) -> usize;

    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Puts particle `order[i]` at place i. `order` is a permutation of 0..len.
    fn permute(&mut self, order: &[u32], scratch: &mut Scratch) {
        assert_eq!(
            order.len(),
            self.len(),
            "a permutation names every particle once"
        );
        for (label, column) in self.list_mut() {
            if !(label.optional && column.is_empty()) {
                column.permute(order, scratch);
            }
        }
    }

    /// The same with no buffers kept: holds the memory of one column at a time.
    fn permute_sparingly(&mut self, order: &[u32]) {
        assert_eq!(
            order.len(),
            self.len(),
            "a permutation names every particle once"
        );
        for (label, column) in self.list_mut() {
            if !(label.optional && column.is_empty()) {
                column.permute(order, &mut Scratch::default());
            }
        }
    }

    /// Removes particle i where `keep[i]` is false; the others keep their order.
    fn retain(&mut self, keep: &[bool]) {
        assert_eq!(keep.len(), self.len(), "one flag a particle");
        for (_, column) in self.list_mut() {
            match column {
                ColumnMut::Real(v) => sift(v, keep),
                ColumnMut::Vector(v) => sift(v, keep),
                ColumnMut::Integer(v) => sift(v, keep),
                ColumnMut::Short(v) => sift(v, keep),
            }
        }
    }

    /// Makes every column `n` long, but for optional ones that are empty; new entries are zero.
    fn resize(&mut self, n: usize) {
        for (label, column) in self.list_mut() {
            if label.optional && column.is_empty() {
                continue;
            }
            column.resize(n);
        }
    }

    /// The first value that is not finite: its column's name and the particle's place.
    fn non_finite(&self) -> Option<(&'static str, usize)> {
        self.list().into_iter().find_map(|(label, column)| {
            let place = match column {
                ColumnRef::Real(v) => v.iter().position(|x| !x.is_finite()),
                ColumnRef::Vector(v) => v
                    .iter()
                    .position(|x| !(x.x.is_finite() && x.y.is_finite() && x.z.is_finite())),
                ColumnRef::Integer(_) | ColumnRef::Short(_) => None,
            };
            place.map(|i| (label.name, i))
        })
    }

    /// Bytes that the columns fill.
    fn bytes(&self) -> usize {
        self.list()
            .iter()
            .map(|(_, column)| match column {
                ColumnRef::Real(v) => size_of_val(*v),
                ColumnRef::Vector(v) => size_of_val(*v),
                ColumnRef::Integer(v) => size_of_val(*v),
                ColumnRef::Short(v) => size_of_val(*v),
            })
            .sum()
    }
}

/// Appends all particles of `other` to `set`. Where an optional column is empty in one of them alone, its entries are zero.
pub fn append<C: Columns>(set: &mut C, other: &C) {
    let (before, after) = (set.len(), set.len() + other.len());
    let filled = |set: &C| -> Vec<bool> { set.list().iter().map(|(_, c)| !c.is_empty()).collect() };
    let wanted: Vec<bool> = filled(set)
        .into_iter()
        .zip(filled(other))
        .map(|(a, b)| a || b)
        .collect();
    let columns = set.list_mut().into_iter().zip(other.list()).zip(wanted);
    for (((label, mut to), (_, from)), _) in columns.filter(|(_, wanted)| *wanted) {
        if label.optional && to.is_empty() {
            to.reborrow().resize(before);
        }
        if label.optional && from.is_empty() {
            to.resize(after);
            continue;
        }
        match (to, from) {
            (ColumnMut::Real(a), ColumnRef::Real(b)) => a.extend_from_slice(b),
            (ColumnMut::Vector(a), ColumnRef::Vector(b)) => a.extend_from_slice(b),
            (ColumnMut::Integer(a), ColumnRef::Integer(b)) => a.extend_from_slice(b),
            (ColumnMut::Short(a), ColumnRef::Short(b)) => a.extend_from_slice(b),
            _ => unreachable!("two sets of one type list the same columns"),
        }
    }
}

fn gather<T: Copy + Send + Sync>(values: &mut Vec<T>, order: &[u32], scratch: &mut Vec<T>) {
    let sorted = order.par_iter().with_min_len(CHUNK);
    let sorted = sorted.map(|&i| values[i as usize]);
    sorted.collect_into_vec(scratch);
    std::mem::swap(values, scratch);
}

fn sift<T>(values: &mut Vec<T>, keep: &[bool]) {
    let mut flags = keep.iter();
    values.retain(|_| *flags.next().expect("one flag a particle"));
}

#[cfg(test)]
mod tests;
