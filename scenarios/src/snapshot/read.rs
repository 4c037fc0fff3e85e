//! Reading particles from files of the layout of SWIFT, GADGET or our own snapshots, brought to code units.

use std::collections::BTreeMap;
use std::path::Path;

use hdf5::{Dataset, File, Group, H5Type};
use nbody::points::{Dimension, Vec3};

use crate::hdf::{
    FileError, Result, Trouble, path_of, read_number, read_numbers, read_text, read_values,
    read_vectors,
};
use crate::units::{System, Units};

/// The particles of one type.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Particles {
    pub part_type: usize,
    /// Empty if the file has none.
    pub id: Vec<u64>,
    pub x: Vec<Vec3>,
    pub v: Vec<Vec3>,
    pub m: Vec<f64>,
    /// Angular momenta of rotation, and mass fractions of ice, rock and iron; empty if the file has none.
    pub spin: Vec<Vec3>,
    pub composition: Vec<Vec3>,
    /// What else the file has, under our own names: `InternalEnergies`, `SmoothingLengths`, ...
    pub more: BTreeMap<&'static str, Vec<f64>>,
}

impl Particles {
    pub fn len(&self) -> usize {
        self.x.len()
    }

    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }
}

/// What a file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Contents {
    pub time: f64,
    pub title: String,
    /// The resolved scene, if the file is one of ours.
    pub scene: Option<String>,
    /// The file's own; the scene's where it has none.
    pub units: Units,
    pub box_size: Vec<f64>,
    pub groups: Vec<Particles>,
}

impl Contents {
    pub fn group(&self, part_type: usize) -> Option<&Particles> {
        self.groups
            .iter()
            .find(|group| group.part_type == part_type)
    }
}

/// Our name, GADGET's, dimension.
const MORE: [(&str, &str, Dimension); 17] = [
    (
        "InternalEnergies",
        "InternalEnergy",
        Dimension::SPECIFIC_ENERGY,
    ),
    ("Densities", "Density", Dimension::DENSITY),
    ("SmoothingLengths", "SmoothingLength", Dimension::LENGTH),
    ("Pressures", "Pressure", Dimension::PRESSURE),
    ("Temperatures", "Temperature", Dimension::TEMPERATURE),
    (
        "ViscosityParameters",
        "ArtificialViscosity",
        Dimension::NONE,
    ),
    ("VapourFractions", "VapourFraction", Dimension::NONE),
    ("Radii", "Radius", Dimension::LENGTH),
    ("GrainRadii", "GrainRadius", Dimension::LENGTH),
    ("GrainDensities", "GrainDensity", Dimension::DENSITY),
    ("SwarmNumbers", "SwarmNumber", Dimension::NONE),
    ("StoppingTimes", "StoppingTime", Dimension::TIME),
    ("StokesNumbers", "StokesNumber", Dimension::NONE),
    ("GasDensities", "GasDensity", Dimension::DENSITY),
    ("Potentials", "Potential", Dimension::SPECIFIC_ENERGY),
    ("Ages", "Age", Dimension::TIME),
    ("AccretionRadii", "AccretionRadius", Dimension::LENGTH),
];

/// Reads all particles of a file; `units` are those wanted, and those of a file that names none. Without them the file's own are kept.
pub fn read(path: &Path, units: Option<&Units>) -> std::result::Result<Contents, FileError> {
    contents(path, units).map_err(|trouble| trouble.of(path))
}

fn contents(path: &Path, wanted: Option<&Units>) -> Result<Contents> {
    let bytes = std::fs::metadata(path)?;
    if !bytes.is_file() {
        return Err(Trouble::Wrong("is not a file".into()));
    }
    let file = File::open(path)
        .map_err(|error| Trouble::Wrong(format!("is not a readable HDF5 file ({error})")))?;
    let header = file.group("Header").ok();
    let fallback = wanted.copied().unwrap_or(Units::new(System::Dimensionless));
    let own = file_units(&file)?.unwrap_or(fallback);
    let wanted = wanted.copied().unwrap_or(own);
    let same = (own.length, own.mass, own.time) == (wanted.length, wanted.mass, wanted.time);
    if !same && wanted.system == System::Dimensionless {
        return Err(Trouble::Wrong(
            "has units (group Units), but the scene is dimensionless: remove the group, or set units.system".into(),
        ));
    }
    let number = |name| {
        header
            .as_ref()
            .and_then(|header| read_numbers(header, name))
    };
    let masses = number("MassTable").unwrap_or_default();
    let factor = |d| {
        if same {
            1.0
        } else {
            own.cgs(d) / wanted.cgs(d)
        }
    };
    let mut groups = Vec::new();
    for part_type in 0..7 {
        if let Ok(group) = file.group(&format!("PartType{part_type}")) {
            let table = masses.get(part_type).copied().unwrap_or(0.0);
            groups.push(particles(&group, part_type, table, &factor)?);
        }
    }
    if groups.is_empty() {
        return Err(Trouble::Wrong(
            "has no group of particles, PartType0 to PartType6".into(),
        ));
    }
    unique(&groups)?;
    let scene = file.group("Parameters").ok();
    Ok(Contents {
        time: number("Time")
            .and_then(|t| t.first().copied())
            .unwrap_or(0.0)
            * factor(Dimension::TIME),
        title: header
            .as_ref()
            .and_then(|header| read_text(header, "RunTitle"))
            .unwrap_or_default(),
        scene: scene.and_then(|parameters| read_text(&parameters, "Scene")),
        units: wanted,
        box_size: number("BoxSize").unwrap_or_default(),
        groups,
    })
}

fn file_units(file: &File) -> Result<Option<Units>> {
    let Ok(group) = file.group("Units") else {
        return Ok(None);
    };
    let unit = |name: &str| match read_number(&group, name) {
        Some(x) if x.is_finite() && x > 0.0 => Ok(x),
        Some(x) => Err(Trouble::Wrong(format!(
            "Units: {name} is {x}, which is no unit"
        ))),
        None => Err(Trouble::Wrong(format!("Units: has no number {name}"))),
    };
    let system = match file
        .group("Parameters")
        .ok()
        .and_then(|p| read_text(&p, "UnitSystem"))
        .as_deref()
    {
        Some("astronomical") => System::Astronomical,
        Some("dimensionless") => System::Dimensionless,
        _ => System::Cgs,
    };
    Ok(Some(Units {
        system,
        length: unit("Unit length in cgs (U_L)")?,
        mass: unit("Unit mass in cgs (U_M)")?,
        time: unit("Unit time in cgs (U_t)")?,
    }))
}

fn particles(
    group: &Group,
    part_type: usize,
    mass_of_all: f64,
    factor: &dyn Fn(Dimension) -> f64,
) -> Result<Particles> {
    let x = vectors(group, "Coordinates", factor(Dimension::LENGTH))?;
    let n = x.len();
    let v = vectors(group, "Velocities", factor(Dimension::VELOCITY))?;
    same_length(group, "Velocities", v.len(), n)?;
    let m = match find(group, "Masses", "Mass") {
        Some((name, dataset)) => reals(group, &name, &dataset, n, factor(Dimension::MASS))?,
        None if mass_of_all > 0.0 => vec![mass_of_all * factor(Dimension::MASS); n],
        None => return Err(missing(group, "Masses")),
    };
    not_negative(group, "Masses", &m)?;
    let mut more = BTreeMap::new();
    for (ours, singular, dimension) in MORE {
        if let Some((name, dataset)) = find(group, ours, singular) {
            more.insert(ours, reals(group, &name, &dataset, n, factor(dimension))?);
        }
    }
    for name in [
        "InternalEnergies",
        "GrainRadii",
        "Radii",
        "SmoothingLengths",
        "Densities",
        "GrainDensities",
        "VapourFractions",
    ] {
        if let Some(values) = more.get(name) {
            not_negative(group, name, values)?;
        }
    }
    let id = match find(group, "ParticleIDs", "ParticleID") {
        Some((name, dataset)) => {
            let id = column::<u64>(group, &name, &dataset)?;
            same_length(group, &name, id.len(), n)?;
            id
        }
        None => Vec::new(),
    };
    let vectors = |name: &str, dimension: Dimension| {
        if !group.link_exists(name) {
            return Ok(Vec::new());
        }
        let values = vectors(group, name, factor(dimension))?;
        same_length(group, name, values.len(), n)?;
        Ok::<_, Trouble>(values)
    };
    let spin = vectors("Spins", Dimension::ANGULAR_MOMENTUM)?;
    let composition = vectors("Compositions", Dimension::NONE)?;
    fractions(group, &composition)?;
    Ok(Particles {
        part_type,
        id,
        x,
        v,
        m,
        spin,
        composition,
        more,
    })
}

fn find(group: &Group, ours: &str, singular: &str) -> Option<(String, Dataset)> {
    [ours, singular].into_iter().find_map(|name| {
        let found = group
            .link_exists(name)
            .then(|| group.dataset(name).ok())??;
        Some((name.to_owned(), found))
    })
}

fn missing(group: &Group, name: &str) -> Trouble {
    Trouble::Wrong(format!("{} is missing", path_of(group, name)))
}

fn vectors(group: &Group, name: &str, factor: f64) -> Result<Vec<Vec3>> {
    let (_, dataset) = find(group, name, name).ok_or_else(|| missing(group, name))?;
    let shape = dataset.shape();
    if shape.len() != 2 || shape[1] != 3 {
        let place = path_of(group, name);
        return Err(Trouble::Wrong(format!(
            "{place} has the shape {shape:?}, where (N, 3) is wanted"
        )));
    }
    let mut v = read_vectors(&dataset)
        .map_err(|error| Trouble::Wrong(format!("{}: {error}", path_of(group, name))))?;
    if let Some(i) = v.iter().position(|x| !x.iter().all(|c| c.is_finite())) {
        return Err(not_finite(group, name, i));
    }
    if factor != 1.0 {
        v.iter_mut().for_each(|x| *x *= factor);
    }
    Ok(v)
}

fn column<T: H5Type>(group: &Group, name: &str, dataset: &Dataset) -> Result<Vec<T>> {
    let shape = dataset.shape();
    if shape.len() != 1 && !(shape.len() == 2 && shape[1] == 1) {
        let place = path_of(group, name);
        return Err(Trouble::Wrong(format!(
            "{place} has the shape {shape:?}, where (N) is wanted"
        )));
    }
    read_values(dataset)
        .map_err(|error| Trouble::Wrong(format!("{}: {error}", path_of(group, name))))
}

fn reals(group: &Group, name: &str, dataset: &Dataset, n: usize, factor: f64) -> Result<Vec<f64>> {
    let mut values = column::<f64>(group, name, dataset)?;
    same_length(group, name, values.len(), n)?;
    // Grains without gas around are never stopped.
    let endless = name.starts_with("Stopping") || name.starts_with("Stokes");
    if let Some(i) = values
        .iter()
        .position(|x| !(x.is_finite() || endless && *x == f64::INFINITY))
    {
        return Err(not_finite(group, name, i));
    }
    if factor != 1.0 {
        values.iter_mut().for_each(|x| *x *= factor);
    }
    Ok(values)
}

fn not_finite(group: &Group, name: &str, i: usize) -> Trouble {
    let place = path_of(group, name);
    Trouble::Wrong(format!(
        "{place}: entry {i} (from 0) is not a finite number"
    ))
}

fn not_negative(group: &Group, name: &str, values: &[f64]) -> Result<()> {
    match values.iter().position(|&x| x < 0.0) {
        Some(i) => {
            let place = path_of(group, name);
            Err(Trouble::Wrong(format!(
                "{place}: entry {i} (from 0) is negative, {:e}",
                values[i]
            )))
        }
        None => Ok(()),
    }
}

fn fractions(group: &Group, mixtures: &[Vec3]) -> Result<()> {
    let whole = |mixture: &Vec3| mixture.min() >= 0.0 && (mixture.sum() - 1.0).abs() <= 1e-6;
    match mixtures.iter().position(|mixture| !whole(mixture)) {
        Some(i) => {
            let place = path_of(group, "Compositions");
            Err(Trouble::Wrong(format!(
                "{place}: entry {i} (from 0) is no set of mass fractions that make 1"
            )))
        }
        None => Ok(()),
    }
}

fn same_length(group: &Group, name: &str, found: usize, wanted: usize) -> Result<()> {
    if found == wanted {
        return Ok(());
    }
    let place = path_of(group, name);
    Err(Trouble::Wrong(format!(
        "{place} has {found} entries, but Coordinates has {wanted}"
    )))
}

/// No two particles of a group may have one identity.
fn unique(groups: &[Particles]) -> Result<()> {
    for group in groups {
        let mut sorted = group.id.clone();
        sorted.sort_unstable();
        if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
            let what = format!(
                "PartType{}/ParticleIDs: {} occurs twice",
                group.part_type, pair[0]
            );
            return Err(Trouble::Wrong(what));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
