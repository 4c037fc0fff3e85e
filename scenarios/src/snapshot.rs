//! Snapshots: the state of a scene at one time, in SWIFT's layout and names, coordinates as they are.
//!
//! `BoxSize` of an open scene is the side of the smallest cube about the origin that holds everything.

mod read;

use std::path::Path;

use gas::KernelKind;
use hdf5::{File, Group as Folder, Location};
use nbody::points::{ColumnRef, Columns, Dimension, Keep, Label, Vec3};

pub use self::read::{Contents, Particles, read};
use crate::atomic::publish;
use crate::hdf::{
    FileError, Result, length, write_column, write_number, write_numbers, write_text,
};
use crate::read::gas::{FORMULATIONS, name_of, viscosity_name};
use crate::scene::{Eos, Scene};
use crate::units::Units;

/// Types of particles that SWIFT's header counts.
const TYPES: usize = 7;
const NOT_COSMOLOGICAL: &str = "Conversion factor to CGS (not including cosmological corrections)";
const PHYSICAL: &str = "Conversion factor to physical CGS (including cosmological corrections)";

/// The particles of one type, column by column.
pub struct Group<'a> {
    /// 0 gas, 1 planetesimals and planets, 2 dust, 4 star.
    pub part_type: usize,
    pub columns: Vec<(Label, ColumnRef<'a>)>,
}

impl<'a> Group<'a> {
    pub fn new(part_type: usize) -> Self {
        assert!(part_type < TYPES, "a type of particle that the layout has");
        Self {
            part_type,
            columns: Vec::new(),
        }
    }

    /// With the columns of a set that users see; optional ones that are empty are left out.
    pub fn with(mut self, set: &'a impl Columns) -> Self {
        let seen = set.list().into_iter().filter(|(label, column)| {
            label.keep == Keep::Snapshot && !(label.optional && column.is_empty())
        });
        self.columns.extend(seen);
        self
    }

    /// With one more column; it takes the place of one of the same name.
    pub fn with_column(mut self, label: Label, column: ColumnRef<'a>) -> Self {
        self.columns.retain(|(old, _)| old.name != label.name);
        self.columns.push((label, column));
        self
    }

    pub fn len(&self) -> usize {
        self.columns
            .first()
            .map_or(0, |(_, column)| length(*column))
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Writes a snapshot whole or not at all.
pub fn write(
    path: &Path,
    scene: &Scene,
    time: f64,
    groups: &[Group<'_>],
) -> std::result::Result<(), FileError> {
    publish(path, |draft| write_draft(draft, scene, time, groups)).map_err(|error| error.of(path))
}

fn write_draft(path: &Path, scene: &Scene, time: f64, groups: &[Group<'_>]) -> Result<()> {
    let file = File::create(path)?;
    header(&file, scene, time, groups)?;
    for name in ["Units", "InternalCodeUnits"] {
        units(&file.create_group(name)?, &scene.units)?;
    }
    circumstances(&file, scene)?;
    for group in groups {
        particles(&file, scene, group)?;
    }
    file.close()?;
    Ok(())
}

fn header(file: &File, scene: &Scene, time: f64, groups: &[Group<'_>]) -> Result<()> {
    let header = file.create_group("Header")?;
    let mut counts = [0u64; TYPES];
    for group in groups {
        counts[group.part_type] += group.len() as u64;
    }
    write_text(&header, "Code", "SWIFT")?;
    write_text(&header, "Generator", "tridisk")?;
    write_text(&header, "Version", env!("CARGO_PKG_VERSION"))?;
    write_text(&header, "RunName", &scene.name)?;
    write_text(&header, "RunTitle", &scene.title)?;
    write_text(&header, "OutputType", "FullVolume")?;
    write_numbers(&header, "BoxSize", box_size(scene, groups).as_slice())?;
    write_number(&header, "Dimension", scene.domain.dimensions() as i32)?;
    write_number(&header, "Time", time)?;
    write_number(&header, "Redshift", 0.0)?;
    write_number(&header, "Scale-factor", 1.0)?;
    write_number(&header, "Virtual", 0i32)?;
    write_number(&header, "ThisFile", 0i32)?;
    write_number(&header, "NumFilesPerSnapshot", 1i32)?;
    write_number(&header, "NumPartTypes", TYPES as i32)?;
    write_numbers(&header, "NumPart_ThisFile", &counts)?;
    write_numbers(&header, "NumPart_Total", &counts.map(|n| n as u32))?;
    write_numbers(
        &header,
        "NumPart_Total_HighWord",
        &counts.map(|n| (n >> 32) as u32),
    )?;
    write_numbers(&header, "MassTable", &[0.0; TYPES])?;
    write_numbers(&header, "Flag_Entropy_ICs", &[0u32; TYPES])
}

fn box_size(scene: &Scene, groups: &[Group<'_>]) -> Vec3 {
    if let Some(size) = scene.domain.size() {
        return size;
    }
    let mut largest = 0.0f64;
    for (label, column) in groups.iter().flat_map(|group| &group.columns) {
        if let (Dimension::LENGTH, ColumnRef::Vector(x)) = (label.dimension, column) {
            largest = x.iter().fold(largest, |largest, x| largest.max(x.amax()));
        }
    }
    // Strictly inside: readers drop what lies on the upper face.
    Vec3::repeat(2.0 * largest * (1.0 + 1e-6))
}

fn units(group: &Folder, units: &Units) -> Result<()> {
    write_number(group, "Unit length in cgs (U_L)", units.length)?;
    write_number(group, "Unit mass in cgs (U_M)", units.mass)?;
    write_number(group, "Unit time in cgs (U_t)", units.time)?;
    write_number(group, "Unit temperature in cgs (U_T)", 1.0)?;
    write_number(group, "Unit current in cgs (U_I)", 1.0)
}

/// The groups that readers of SWIFT's files expect, and the scene as text.
fn circumstances(file: &File, scene: &Scene) -> Result<()> {
    let policy = file.create_group("Policy")?;
    write_number(&policy, "cosmological integration", 0i32)?;
    let cosmology = file.create_group("Cosmology")?;
    write_number(&cosmology, "Cosmological run", 0i32)?;
    write_number(&cosmology, "Redshift", 0.0)?;
    write_number(&cosmology, "Scale-factor", 1.0)?;
    let parameters = file.create_group("Parameters")?;
    let periodic = scene.domain.size().is_some();
    write_text(
        &parameters,
        "InitialConditions:periodic",
        if periodic { "1" } else { "0" },
    )?;
    write_text(&parameters, "UnitSystem", scene.units.system.name())?;
    write_text(&parameters, "Scene", &scene.to_toml())?;
    let subgrid = file.create_group("SubgridScheme")?;
    write_text(&subgrid, "Chemistry model", "none")?;
    hydro_scheme(&file.create_group("HydroScheme")?, scene)
}

fn hydro_scheme(group: &Folder, scene: &Scene) -> Result<()> {
    let Some(gas) = &scene.gas else {
        return write_text(group, "Scheme", "none");
    };
    let formulation = name_of(&FORMULATIONS, gas.hydro.formulation);
    write_text(group, "Scheme", &format!("{formulation} SPH"))?;
    write_text(group, "Viscosity Model", viscosity_name(&gas.viscosity))?;
    write_number(group, "Thermal conduction alpha", gas.conduction)?;
    write_number(group, "Dimension", scene.domain.dimensions() as i32)?;
    let kernel = match gas.hydro.kernel {
        KernelKind::WendlandC2 => "Wendland C2",
        KernelKind::WendlandC4 => "Wendland C4",
        KernelKind::WendlandC6 => "Wendland C6",
        KernelKind::CubicSpline => "Cubic spline (M4)",
        KernelKind::QuinticSpline => "Quintic spline (M6)",
    };
    write_text(group, "Kernel function", kernel)?;
    write_number(group, "Kernel target N_ngb", gas.hydro.neighbours)?;
    write_number(group, "CFL parameter", gas.hydro.courant)?;
    write_text(group, "Equation of state", gas.eos.name())?;
    let gamma = match &gas.eos {
        Eos::Ideal { gamma } => *gamma,
        Eos::Isothermal { .. } | Eos::LocallyIsothermal { .. } => 1.0,
        Eos::Barotropic(law) => law.gamma,
        Eos::Stiffened(law) => law.gamma,
        // No number says what these do.
        Eos::Tillotson { .. } | Eos::Tabulated { .. } => return Ok(()),
    };
    write_number(group, "Adiabatic index", gamma)
}

fn particles(file: &File, scene: &Scene, group: &Group<'_>) -> Result<()> {
    let folder = file.create_group(&format!("PartType{}", group.part_type))?;
    write_number(&folder, "NumberOfParticles", group.len() as u64)?;
    write_number(&folder, "NumberOfFields", group.columns.len() as i32)?;
    for (label, column) in &group.columns {
        assert_eq!(
            length(*column),
            group.len(),
            "{}: one value a particle",
            label.name
        );
        let dataset = write_column(&folder, label.name, *column)?;
        describe(&dataset, *label, scene)?;
    }
    Ok(())
}

fn describe(dataset: &Location, label: Label, scene: &Scene) -> Result<()> {
    let d = planar(label, scene);
    let powers = [
        ("U_L exponent", d.length),
        ("U_M exponent", d.mass),
        ("U_t exponent", d.time),
        ("U_T exponent", d.temperature),
        ("U_I exponent", 0),
        ("a-scale exponent", 0),
        ("h-scale exponent", 0),
    ];
    for (name, power) in powers {
        write_number(dataset, name, f32::from(power))?;
    }
    let factor = scene.units.cgs(d);
    write_number(dataset, NOT_COSMOLOGICAL, factor)?;
    write_number(dataset, PHYSICAL, factor)?;
    write_text(dataset, "Expression for physical CGS units", &expression(d))?;
    write_text(dataset, "Description", label.text)
}

/// In two dimensions the densities and pressures of gas are by area.
fn planar(label: Label, scene: &Scene) -> Dimension {
    let by_volume = ["Densities", "Pressures", "GasDensities"].contains(&label.name);
    let shift = i8::from(by_volume && scene.domain.dimensions() == 2);
    Dimension {
        length: label.dimension.length + shift,
        ..label.dimension
    }
}

/// Such as `[ g cm^-3 ]`, the way SWIFT writes it.
fn expression(d: Dimension) -> String {
    let bases = [
        ("g", d.mass),
        ("cm", d.length),
        ("s", d.time),
        ("K", d.temperature),
    ];
    let mut text = String::from("[");
    for (symbol, power) in bases.iter().filter(|base| base.1 != 0) {
        if *power == 1 {
            text += &format!(" {symbol}");
        } else {
            text += &format!(" {symbol}^{power}");
        }
    }
    if text.len() == 1 {
        text += " -";
    }
    text + " ]"
}
