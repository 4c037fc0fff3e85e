//! Checkpoints: any number of particle sets and facts, kept to the last bit, in one HDF5 file.

use std::path::Path;

use hdf5::{File, Group};
use nbody::points::{ColumnMut, ColumnRef, Columns};

use crate::atomic::publish;
use crate::hdf::{
    FileError, Result, Trouble, path_of, read_number, read_values, read_vectors, write_column,
    write_number, write_text,
};

/// Changes whenever what a checkpoint holds changes its meaning.
pub const SCHEMA: u64 = 6;

/// A fact that is no column.
#[derive(Clone, Debug, PartialEq)]
pub enum Fact {
    Real(f64),
    Integer(u64),
    Text(String),
    Reals(Vec<f64>),
    Integers(Vec<u64>),
}

/// What a checkpoint is made of.
#[derive(Default)]
pub struct Draft<'a> {
    sets: Vec<(String, &'a dyn Columns)>,
    facts: Vec<(String, Fact)>,
}

impl<'a> Draft<'a> {
    /// Adds a particle set under a name of its own.
    pub fn set(&mut self, name: &str, set: &'a dyn Columns) -> &mut Self {
        assert!(
            self.sets.iter().all(|(other, _)| other != name),
            "{name}: a name of its own"
        );
        self.sets.push((name.to_owned(), set));
        self
    }

    /// Adds a fact under a name of its own.
    pub fn fact(&mut self, name: &str, fact: Fact) -> &mut Self {
        assert!(
            self.facts.iter().all(|(other, _)| other != name),
            "{name}: a name of its own"
        );
        self.facts.push((name.to_owned(), fact));
        self
    }

    /// Writes the checkpoint whole or not at all.
    pub fn write(&self, path: &Path) -> std::result::Result<(), FileError> {
        publish(path, |draft| self.write_draft(draft)).map_err(|trouble| trouble.of(path))
    }

    fn write_draft(&self, path: &Path) -> Result<()> {
        let file = File::create(path)?;
        let header = file.create_group("Checkpoint")?;
        write_number(&header, "Schema", SCHEMA)?;
        write_text(&header, "Generator", "tridisk")?;
        write_text(&header, "Version", env!("CARGO_PKG_VERSION"))?;
        let sets = file.create_group("Sets")?;
        for (name, set) in &self.sets {
            let group = sets.create_group(name)?;
            write_number(&group, "Length", set.len() as u64)?;
            for (label, column) in set.list() {
                write_column(&group, label.name, column)?;
            }
        }
        let facts = file.create_group("Facts")?;
        for (name, fact) in &self.facts {
            write_fact(&facts, name, fact)?;
        }
        file.close()?;
        Ok(())
    }
}

/// Each kind of fact has its own type of dataset; a text is its bytes.
fn write_fact(group: &Group, name: &str, fact: &Fact) -> Result<()> {
    let dataset = match fact {
        Fact::Real(x) => write_column(group, name, ColumnRef::Real(&[*x]))?,
        Fact::Integer(i) => write_column(group, name, ColumnRef::Integer(&[*i]))?,
        Fact::Reals(v) => write_column(group, name, ColumnRef::Real(v))?,
        Fact::Integers(v) => write_column(group, name, ColumnRef::Integer(v))?,
        Fact::Text(text) => {
            let bytes: Vec<u32> = text.bytes().map(u32::from).collect();
            write_column(group, name, ColumnRef::Short(&bytes))?
        }
    };
    let kind = match fact {
        Fact::Real(_) => 0u64,
        Fact::Integer(_) => 1,
        Fact::Text(_) => 2,
        Fact::Reals(_) => 3,
        Fact::Integers(_) => 4,
    };
    write_number(&dataset, "Kind", kind)
}

/// A checkpoint that is open for reading.
pub struct Checkpoint {
    file: File,
    path: std::path::PathBuf,
}

impl Checkpoint {
    pub fn open(path: &Path) -> std::result::Result<Self, FileError> {
        let wrong = |what: String| Trouble::Wrong(what).of(path);
        if !path.is_file() {
            return Err(wrong("there is no such checkpoint".into()));
        }
        let file = File::open(path)
            .map_err(|error| wrong(format!("is not a readable HDF5 file ({error})")))?;
        let header = file
            .group("Checkpoint")
            .map_err(|_| wrong("is no checkpoint".into()))?;
        match read_number(&header, "Schema") {
            Some(schema) if schema == SCHEMA as f64 => Ok(Self {
                file,
                path: path.to_path_buf(),
            }),
            other => Err(wrong(format!(
                "has the schema {}, but this version reads {SCHEMA}",
                other.map_or_else(|| "of no number".into(), |schema| schema.to_string())
            ))),
        }
    }

    /// Names of the particle sets.
    pub fn sets(&self) -> Vec<String> {
        self.file
            .group("Sets")
            .and_then(|group| group.member_names())
            .unwrap_or_default()
    }

    /// Number of particles of a set.
    pub fn length(&self, name: &str) -> Option<usize> {
        let group = self.file.group(&format!("Sets/{name}")).ok()?;
        read_number(&group, "Length").map(|n| n as usize)
    }

    /// Fills a set with what the checkpoint holds of it, bit for bit.
    pub fn read_set(
        &self,
        name: &str,
        set: &mut dyn Columns,
    ) -> std::result::Result<(), FileError> {
        self.fill(name, set)
            .map_err(|trouble| trouble.of(&self.path))
    }

    fn fill(&self, name: &str, set: &mut dyn Columns) -> Result<()> {
        let group = self
            .file
            .group(&format!("Sets/{name}"))
            .map_err(|_| Trouble::Wrong(format!("holds no set {name}")))?;
        let n = read_number(&group, "Length").unwrap_or(0.0) as usize;
        for (label, column) in set.list_mut() {
            let dataset = group.dataset(label.name).map_err(|_| {
                Trouble::Wrong(format!("{} is missing", path_of(&group, label.name)))
            })?;
            let found = match column {
                ColumnMut::Real(v) => {
                    *v = read_values(&dataset)?;
                    v.len()
                }
                ColumnMut::Vector(v) => {
                    *v = read_vectors(&dataset)?;
                    v.len()
                }
                ColumnMut::Integer(v) => {
                    *v = read_values(&dataset)?;
                    v.len()
                }
                ColumnMut::Short(v) => {
                    *v = read_values(&dataset)?;
                    v.len()
                }
            };
            if found != n && !(label.optional && found == 0) {
                let place = path_of(&group, label.name);
                return Err(Trouble::Wrong(format!(
                    "{place} has {found} entries instead of {n}"
                )));
            }
        }
        Ok(())
    }

    /// A fact by its name.
    pub fn fact(&self, name: &str) -> std::result::Result<Fact, FileError> {
        self.read_fact(name)
            .map_err(|trouble| trouble.of(&self.path))
    }

    pub fn real(&self, name: &str) -> std::result::Result<f64, FileError> {
        match self.fact(name)? {
            Fact::Real(x) => Ok(x),
            other => Err(self.unfit(name, "a real number", &other)),
        }
    }

    pub fn integer(&self, name: &str) -> std::result::Result<u64, FileError> {
        match self.fact(name)? {
            Fact::Integer(i) => Ok(i),
            other => Err(self.unfit(name, "a whole number", &other)),
        }
    }

    pub fn text(&self, name: &str) -> std::result::Result<String, FileError> {
        match self.fact(name)? {
            Fact::Text(text) => Ok(text),
            other => Err(self.unfit(name, "a text", &other)),
        }
    }

    pub fn reals(&self, name: &str) -> std::result::Result<Vec<f64>, FileError> {
        match self.fact(name)? {
            Fact::Reals(v) => Ok(v),
            other => Err(self.unfit(name, "a list of real numbers", &other)),
        }
    }

    pub fn integers(&self, name: &str) -> std::result::Result<Vec<u64>, FileError> {
        match self.fact(name)? {
            Fact::Integers(v) => Ok(v),
            other => Err(self.unfit(name, "a list of whole numbers", &other)),
        }
    }

    fn unfit(&self, name: &str, wanted: &str, found: &Fact) -> FileError {
        Trouble::Wrong(format!(
            "the fact {name} is {found:?}, where {wanted} is wanted"
        ))
        .of(&self.path)
    }

    fn read_fact(&self, name: &str) -> Result<Fact> {
        let missing = || Trouble::Wrong(format!("holds no fact {name}"));
        let dataset = self
            .file
            .dataset(&format!("Facts/{name}"))
            .map_err(|_| missing())?;
        let kind = read_number(&dataset, "Kind").ok_or_else(missing)?;
        let first = |v: Vec<f64>| v.first().copied().ok_or_else(missing);
        Ok(match kind as u64 {
            0 => Fact::Real(first(read_values(&dataset)?)?),
            1 => Fact::Integer(
                read_values::<u64>(&dataset)?
                    .first()
                    .copied()
                    .ok_or_else(missing)?,
            ),
            2 => {
                let bytes: Vec<u8> = read_values::<u32>(&dataset)?
                    .iter()
                    .map(|&b| b as u8)
                    .collect();
                Fact::Text(String::from_utf8(bytes).map_err(|_| missing())?)
            }
            3 => Fact::Reals(read_values(&dataset)?),
            _ => Fact::Integers(read_values(&dataset)?),
        })
    }
}

#[cfg(test)]
mod tests;
