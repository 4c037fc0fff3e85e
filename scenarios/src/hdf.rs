//! HDF5 as snapshots and checkpoints use it: columns as datasets, facts as attributes of one element, texts of fixed length.

use std::io;
use std::path::{Path, PathBuf};

use hdf5::types::{FixedUnicode, VarLenUnicode};
use hdf5::{Dataset, Group, H5Type, Location};
use nbody::points::{ColumnRef, Vec3};
use thiserror::Error;

/// Why a file cannot be written or read.
#[derive(Debug, Error)]
#[error("{}: {what}", path.display())]
pub struct FileError {
    pub path: PathBuf,
    pub what: String,
}

/// Trouble inside a file.
#[derive(Debug, Error)]
pub enum Trouble {
    #[error("{0}")]
    Io(#[from] io::Error),
    #[error("{}", one_line(.0))]
    Hdf5(#[from] hdf5::Error),
    #[error("{0}")]
    Wrong(String),
}

impl Trouble {
    pub fn of(self, path: &Path) -> FileError {
        FileError {
            path: path.to_path_buf(),
            what: self.to_string(),
        }
    }
}

fn one_line(error: &hdf5::Error) -> String {
    error
        .to_string()
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ")
}

pub type Result<T> = std::result::Result<T, Trouble>;

/// A column that owns its values.
#[derive(Clone, Debug, PartialEq)]
pub enum Array {
    Real(Vec<f64>),
    Vector(Vec<Vec3>),
    Integer(Vec<u64>),
    Short(Vec<u32>),
}

impl Array {
    pub fn as_ref(&self) -> ColumnRef<'_> {
        match self {
            Array::Real(v) => ColumnRef::Real(v),
            Array::Vector(v) => ColumnRef::Vector(v),
            Array::Integer(v) => ColumnRef::Integer(v),
            Array::Short(v) => ColumnRef::Short(v),
        }
    }
}

/// Number of values of a column.
pub fn length(column: ColumnRef<'_>) -> usize {
    match column {
        ColumnRef::Real(v) => v.len(),
        ColumnRef::Vector(v) => v.len(),
        ColumnRef::Integer(v) => v.len(),
        ColumnRef::Short(v) => v.len(),
    }
}

/// Writes a column; vectors as (N, 3).
pub fn write_column(group: &Group, name: &str, column: ColumnRef<'_>) -> Result<Dataset> {
    match column {
        ColumnRef::Real(v) => write_values(group, name, v, &[v.len()]),
        ColumnRef::Integer(v) => write_values(group, name, v, &[v.len()]),
        ColumnRef::Short(v) => write_values(group, name, v, &[v.len()]),
        ColumnRef::Vector(v) => write_values(group, name, components(v), &[v.len(), 3]),
    }
}

/// The components of vectors, one after the other.
fn components(v: &[Vec3]) -> &[f64] {
    const {
        assert!(
            size_of::<Vec3>() == 3 * size_of::<f64>() && align_of::<Vec3>() == align_of::<f64>()
        )
    }
    // SAFETY: a vector is its three components, without gaps by the sizes, and lives as long as the slice.
    unsafe { std::slice::from_raw_parts(v.as_ptr().cast(), 3 * v.len()) }
}

fn write_values<T: H5Type>(group: &Group, name: &str, v: &[T], shape: &[usize]) -> Result<Dataset> {
    let dataset = group.new_dataset::<T>().shape(shape).create(name)?;
    if !v.is_empty() {
        dataset.write_raw(v)?;
    }
    Ok(dataset)
}

/// The numbers of a dataset of one axis, converted to f64 or the like.
pub fn read_values<T: H5Type>(dataset: &Dataset) -> Result<Vec<T>> {
    Ok(if dataset.size() == 0 {
        Vec::new()
    } else {
        dataset.read_raw()?
    })
}

/// The vectors of an (N, 3) dataset.
pub fn read_vectors(dataset: &Dataset) -> Result<Vec<Vec3>> {
    let flat: Vec<f64> = read_values(dataset)?;
    Ok(flat
        .chunks_exact(3)
        .map(|x| Vec3::new(x[0], x[1], x[2]))
        .collect())
}

/// Writes an attribute that is an array of numbers.
pub fn write_numbers<T: H5Type>(place: &Location, name: &str, values: &[T]) -> Result<()> {
    place.new_attr_builder().with_data(values).create(name)?;
    Ok(())
}

pub fn write_number<T: H5Type + Copy>(place: &Location, name: &str, value: T) -> Result<()> {
    write_numbers(place, name, &[value])
}

/// Writes a text of fixed length; one beyond the 64 kB of an attribute has variable length.
pub fn write_text(place: &Location, name: &str, text: &str) -> Result<()> {
    let clean = text.replace('\0', " ");
    match clean.len() {
        0..=16 => write_fixed::<16>(place, name, &clean),
        17..=64 => write_fixed::<64>(place, name, &clean),
        65..=256 => write_fixed::<256>(place, name, &clean),
        257..=2048 => write_fixed::<2048>(place, name, &clean),
        2049..=8192 => write_fixed::<8192>(place, name, &clean),
        8193..=32768 => write_fixed::<32768>(place, name, &clean),
        _ => {
            let value: VarLenUnicode = clean
                .parse()
                .map_err(|error| Trouble::Wrong(format!("{name}: {error}")))?;
            place
                .new_attr::<VarLenUnicode>()
                .create(name)?
                .write_scalar(&value)?;
            Ok(())
        }
    }
}

fn write_fixed<const N: usize>(place: &Location, name: &str, text: &str) -> Result<()> {
    let value: FixedUnicode<N> = text
        .parse()
        .map_err(|error| Trouble::Wrong(format!("{name}: {error}")))?;
    place
        .new_attr::<FixedUnicode<N>>()
        .create(name)?
        .write_scalar(&value)?;
    Ok(())
}

/// A text attribute of any length and kind.
pub fn read_text(place: &Location, name: &str) -> Option<String> {
    let attribute = place.attr(name).ok()?;
    attribute
        .read_scalar::<VarLenUnicode>()
        .map(|text| text.as_str().to_owned())
        .or_else(|_| {
            attribute
                .read_scalar::<FixedUnicode<32768>>()
                .map(|text| text.as_str().to_owned())
        })
        .or_else(|_| {
            attribute
                .read_scalar::<hdf5::types::FixedAscii<32768>>()
                .map(|text| text.as_str().to_owned())
        })
        .or_else(|_| {
            attribute
                .read_scalar::<hdf5::types::VarLenAscii>()
                .map(|text| text.as_str().to_owned())
        })
        .ok()
}

/// The first number of a numeric attribute, a scalar or an array.
pub fn read_number(place: &Location, name: &str) -> Option<f64> {
    read_numbers(place, name)?.first().copied()
}

pub fn read_numbers(place: &Location, name: &str) -> Option<Vec<f64>> {
    place.attr(name).ok()?.read_raw::<f64>().ok()
}

/// The object's name inside the file and that of a child.
pub fn path_of(group: &Group, name: &str) -> String {
    format!("{}/{name}", group.name().trim_start_matches('/'))
}
