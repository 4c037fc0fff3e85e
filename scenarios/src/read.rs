//! Reading a scene: from a TOML text and `--set` overrides to a resolved `Scene`, or everything that is wrong with it.

mod bodies;
pub mod composition;
mod cooling;
pub mod dust;
mod edge;
mod eos;
mod frame;
pub mod gas;
pub mod gravity;
pub mod growth;
mod surroundings;
mod turbulence;

use std::fmt;
use std::path::{Path, PathBuf};

use crate::document::{self, Place};
use crate::reader::{Door, Section};
use crate::scene::{Preset, Scene};
use crate::units::Kind;
use crate::validate;

/// Everything that is wrong with a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    pub file: String,
    pub problems: Vec<(Place, String)>,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, (place, sentence)) in self.problems.iter().enumerate() {
            let end = if i == 0 { "" } else { "\n" };
            match place {
                Place::Line(0) => write!(f, "{end}{}: {sentence}", self.file)?,
                Place::Line(line) => write!(f, "{end}{}:{line}: {sentence}", self.file)?,
                Place::Set(argument) => write!(f, "{end}--set {argument}: {sentence}")?,
            }
        }
        Ok(())
    }
}

impl std::error::Error for Refusal {}

impl Scene {
    /// The scene of a file, with `--set` overrides.
    pub fn load(path: &Path, overrides: &[String]) -> Result<Self, Refusal> {
        let file = path.display().to_string();
        let bytes = std::fs::read(path).map_err(|error| Refusal {
            file: file.clone(),
            problems: vec![(Place::Line(0), format!("cannot be read: {error}"))],
        })?;
        let text = String::from_utf8(bytes).map_err(|error| {
            let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
            let line = 1 + good.iter().filter(|&&byte| byte == b'\n').count();
            Refusal {
                file: file.clone(),
                problems: vec![(Place::Line(line), "is not UTF-8 text".to_owned())],
            }
        })?;
        let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
        let name = path
            .file_stem()
            .map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        Self::parse(&text, &name, &folder, overrides).map_err(|problems| Refusal { file, problems })
    }

    /// The scene of a text; `folder` is where its initial file is looked for.
    pub fn parse(
        text: &str,
        name: &str,
        folder: &Path,
        overrides: &[String],
    ) -> Result<Self, Vec<(Place, String)>> {
        let mut entries = document::parse(text)?;
        let wrong: Vec<_> = overrides
            .iter()
            .filter_map(|argument| document::lay_over(&mut entries, argument).err())
            .collect();
        if !wrong.is_empty() {
            return Err(wrong);
        }
        let door = Door::default();
        let scene = scene(Section::root(&entries, &door), name, folder, &door);
        validate::rules(&scene, &validate::Complaints::new(&entries, &door));
        let problems = door.into_problems();
        if problems.is_empty() {
            Ok(scene)
        } else {
            Err(problems)
        }
    }
}

/// What the populations' readers know of the rest of the scene.
pub struct Facts {
    dimensions: usize,
    gravity: f64,
    /// Not a number without a good star.
    star_mass: f64,
    has_star: bool,
    /// Whether there is an orbital frequency.
    has_orbits: bool,
    has_file: bool,
    has_gas: bool,
    has_disk: bool,
    /// Whether the gas is a disk of the surroundings.
    has_formula: bool,
    has_planets: bool,
    preset: Preset,
    /// Where files of the scene are looked for.
    folder: PathBuf,
}

impl Facts {
    /// Kind of a density in the scene's dimensions.
    fn density(&self) -> Kind {
        if self.dimensions == 2 {
            Kind::SURFACE_DENSITY
        } else {
            Kind::DENSITY
        }
    }

    fn pressure(&self) -> Kind {
        if self.dimensions == 2 {
            Kind::PLANAR_PRESSURE
        } else {
            Kind::PRESSURE
        }
    }
}

fn scene(root: Section<'_>, name: &str, folder: &Path, door: &Door) -> Scene {
    let units = frame::units(&root, door);
    let (domain, local) = frame::domain(&root);
    let star = frame::star(&root);
    let initial_file = frame::initial_file(&root, folder);
    let accuracy = frame::accuracy(&root);
    let constant = gravity::constant(&root);
    let facts = Facts {
        dimensions: domain.dimensions(),
        gravity: constant,
        star_mass: star.map_or(f64::NAN, |star| star.mass),
        has_star: root.has("star"),
        has_orbits: root.has("star") || domain.hill().is_some(),
        has_file: initial_file.is_some(),
        has_gas: root.has("gas"),
        has_disk: root.section("gas").has("disk"),
        has_formula: root.section("surroundings").has("disk") && !root.has("gas"),
        has_planets: root.has("planet"),
        preset: accuracy.preset,
        folder: folder.to_path_buf(),
    };
    let gas = gas::gas(&root, &facts);
    let surroundings = surroundings::surroundings(&root, &facts);
    let dust = dust::dust(&root, &facts, (gas.as_ref(), &surroundings));
    let planets = bodies::planets(&root, &facts);
    let planetesimals = bodies::planetesimals(&root, &facts);
    let run = frame::run(&root);
    let scene = Scene {
        name: frame::name(&root, name),
        title: root.text("title").unwrap_or_default().to_owned(),
        run,
        units,
        domain,
        local,
        initial_file,
        star,
        gas,
        dust,
        planetesimals,
        planets,
        surroundings,
        gravity: gravity::none(constant),
        coupling: gravity::no_coupling(),
        accuracy,
    };
    let scene = gravity::with_coupling(scene, &root);
    let scene = gravity::with_gravity(scene, &root, &facts);
    root.close();
    scene
}

/// An absolute form of a path given relative to the scene's folder.
fn absolute(folder: &Path, file: &str) -> PathBuf {
    let joined = folder.join(file);
    std::fs::canonicalize(&joined)
        .unwrap_or_else(|_| std::path::absolute(&joined).unwrap_or(joined))
}
