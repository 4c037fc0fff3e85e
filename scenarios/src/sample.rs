//! Gas of a snapshot at given points: density, velocity, sound speed, temperature, pressure, gradients of density and velocity.
//!
//! Values are interpolated from the particles', exactly for fields that are linear in space where the gas surrounds the point (`shape` 1);
//! at an edge of the gas (2 and 3) scalars are means over the neighbours and velocities their rigid rotation. Where there is no gas (0)
//! all is zero but the gradients, which are no numbers. Code units of the snapshot.

use std::fmt::Write;
use std::io::Read;
use std::path::Path;

use gas::probe::{Local, Probe, Reach, Shape};
use gas::{Eos, Gas};
use nbody::points::{ColumnRef, Columns, Dimension, Domain, Vec3};

use crate::atomic::publish;
use crate::hdf::{write_column, write_number};
use crate::populate;
use crate::scene::Scene;
use crate::snapshot::{self, Contents, Particles};
use crate::units::Units;

/// Points look for gas within this many of its largest smoothing lengths.
const FARTHEST: f64 = 2.0;

/// The gas of a snapshot, and what its scene says of it.
struct Source {
    gas: Gas,
    domain: Domain,
    reach: Reach,
    units: Units,
    /// In the order of the gas; empty if the file has none.
    temperature: Vec<f64>,
    /// Not known of files of other programs.
    eos: Option<Eos>,
}

/// Gas at a point.
struct Row {
    x: Vec3,
    local: Local,
    sound_speed: f64,
    temperature: f64,
}

/// The samples of `snapshot` at the points of `points`, a file or `-`: as CSV text, or nothing if they go to the HDF5 file `output`.
pub fn sample(snapshot: &Path, points: &Path, output: Option<&Path>) -> Result<String, String> {
    let contents = snapshot::read(snapshot, None).map_err(|error| error.to_string())?;
    let source =
        Source::new(&contents).map_err(|what| format!("{}: {what}", snapshot.display()))?;
    let rows = source.rows(&places(points)?);
    match output {
        None => Ok(csv(&rows)),
        Some(path) => {
            let written = publish(path, |draft| hdf(draft, &rows, &source.units));
            written.map_err(|trouble| trouble.of(path).to_string())?;
            Ok(String::new())
        }
    }
}

impl Source {
    fn new(contents: &Contents) -> Result<Self, String> {
        let rows = contents.group(0).filter(|rows| !rows.is_empty());
        let rows = rows.ok_or("has no gas (PartType0)")?;
        let scene = match &contents.scene {
            Some(text) => {
                let scene = Scene::parse(text, "sampled", Path::new("."), &[]);
                Some(scene.map_err(|_| "holds a scene that this version does not read")?)
            }
            None => None,
        };
        let hydro = scene
            .as_ref()
            .and_then(|scene| Some(populate::hydro(scene, scene.gas.as_ref()?)));
        let domain = scene
            .as_ref()
            .map_or_else(Domain::open, |scene| scene.domain);
        let column = |name: &str| {
            let values = rows.more.get(name);
            values.ok_or_else(|| format!("has no {name} of the gas"))
        };
        let (rho, p, u) = (
            column("Densities")?,
            column("Pressures")?,
            column("InternalEnergies")?,
        );
        let h = column("SmoothingLengths")?;
        let mut gas = Gas::new(of_rows(rows, u, h));
        let order: Vec<usize> = gas.particles.id.iter().map(|&id| id as usize).collect();
        let sorted = |values: &[f64]| order.iter().map(|&i| values[i]).collect::<Vec<f64>>();
        (gas.derived.rho, gas.derived.p) = (sorted(rho), sorted(p));
        Ok(Self {
            reach: Reach {
                neighbours: hydro.as_ref().map_or(64.0, |hydro| hydro.neighbours),
                largest: FARTHEST * h.iter().copied().fold(0.0, f64::max),
            },
            temperature: rows
                .more
                .get("Temperatures")
                .map_or_else(Vec::new, |t| sorted(t)),
            eos: hydro.map(|hydro| hydro.eos),
            units: contents.units,
            domain,
            gas,
        })
    }

    fn rows(&self, places: &[Vec3]) -> Vec<Row> {
        let mut probe = Probe::default();
        let mut guess = 0.0;
        let mut row = |&x: &Vec3| {
            let local = probe.local(&self.gas, &self.domain, (x, guess), &self.reach);
            guess = if local.shape == Shape::Empty {
                0.0
            } else {
                local.h
            };
            let (rho, u) = (&self.gas.derived.rho, &self.gas.particles.u);
            let speed = |eos: &Eos| probe.scalar(|j| eos.sound_speed(rho[j], u[j]));
            Row {
                x,
                sound_speed: self.eos.as_ref().map_or(f64::NAN, speed),
                temperature: match self.temperature.is_empty() {
                    true => f64::NAN,
                    false => probe.scalar(|j| self.temperature[j]),
                },
                local,
            }
        };
        places.iter().map(&mut row).collect()
    }
}

/// The gas of a file with places in it for ids.
fn of_rows(rows: &Particles, u: &[f64], h: &[f64]) -> gas::Particles {
    let mut particles = gas::Particles {
        id: (0..rows.len() as u64).collect(),
        x: rows.x.clone(),
        v: rows.v.clone(),
        m: rows.m.clone(),
        u: u.to_vec(),
        h: h.to_vec(),
        ..Default::default()
    };
    particles.resize(rows.len());
    particles
}

/// The points of a file or of standard input: x, y and z a line, by blanks or commas; a first line of words is a heading.
fn places(path: &Path) -> Result<Vec<Vec3>, String> {
    let name = path.display();
    let text = if path == Path::new("-") {
        let mut text = String::new();
        let read = std::io::stdin().read_to_string(&mut text);
        read.map_err(|error| format!("standard input: {error}"))?;
        text
    } else {
        std::fs::read_to_string(path).map_err(|error| format!("{name}: {error}"))?
    };
    let mut places = Vec::new();
    let lines = text.lines().enumerate();
    let lines = lines.filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
    for (nth, (k, line)) in lines.enumerate() {
        let words: Vec<&str> = line
            .split(|c: char| c == ',' || c.is_whitespace())
            .filter(|word| !word.is_empty())
            .collect();
        let numbers: Vec<f64> = words.iter().filter_map(|word| word.parse().ok()).collect();
        match numbers[..] {
            [x, y, z] if words.len() == 3 && numbers.iter().all(|x| x.is_finite()) => {
                places.push(Vec3::new(x, y, z));
            }
            [] if nth == 0 => {}
            _ => {
                return Err(format!(
                    "{name}: line {} must be three finite numbers, x, y and z",
                    k + 1
                ));
            }
        }
    }
    Ok(places)
}

/// Names of the columns of numbers.
const HEADING: &str = "x,y,z,shape,density,velocity_x,velocity_y,velocity_z,sound_speed,temperature,pressure,\
density_gradient_x,density_gradient_y,density_gradient_z,\
velocity_gradient_xx,velocity_gradient_xy,velocity_gradient_xz,\
velocity_gradient_yx,velocity_gradient_yy,velocity_gradient_yz,\
velocity_gradient_zx,velocity_gradient_zy,velocity_gradient_zz,smoothing_length";

fn shape(shape: Shape) -> u32 {
    match shape {
        Shape::Empty => 0,
        Shape::Linear => 1,
        Shape::Rigid => 2,
        Shape::Plain => 3,
    }
}

fn csv(rows: &[Row]) -> String {
    let mut text = format!("{HEADING}\n");
    for row in rows {
        let (x, local) = (row.x, &row.local);
        let (v, g) = (local.v, local.grad_rho);
        let before = [x.x, x.y, x.z].map(|x| format!("{x:?}")).join(",");
        write!(text, "{before},{}", shape(local.shape)).expect("text");
        let values = [
            local.rho,
            v.x,
            v.y,
            v.z,
            row.sound_speed,
            row.temperature,
            local.p,
        ];
        let gradients = local.grad_v.transpose();
        let values = values.into_iter().chain([g.x, g.y, g.z]);
        for value in values.chain(gradients.iter().copied()).chain([local.h]) {
            write!(text, ",{value:?}").expect("text");
        }
        text.push('\n');
    }
    text
}

fn hdf(path: &Path, rows: &[Row], units: &Units) -> crate::hdf::Result<()> {
    let file = hdf5::File::create(path)?;
    let write = |name: &str, column: ColumnRef<'_>, dimension: Dimension| {
        let dataset = write_column(&file, name, column)?;
        write_number(&dataset, "Conversion factor to CGS", units.cgs(dimension))
    };
    let real = |of: &dyn Fn(&Row) -> f64| rows.iter().map(of).collect::<Vec<f64>>();
    let vector = |of: &dyn Fn(&Row) -> Vec3| rows.iter().map(of).collect::<Vec<Vec3>>();
    let shapes: Vec<u32> = rows.iter().map(|row| shape(row.local.shape)).collect();
    write("Shapes", ColumnRef::Short(&shapes), Dimension::NONE)?;
    let steep = Dimension::new(-4, 1, 0, 0);
    let reals: [(&str, Vec<f64>, Dimension); 5] = [
        ("Densities", real(&|row| row.local.rho), Dimension::DENSITY),
        (
            "SoundSpeeds",
            real(&|row| row.sound_speed),
            Dimension::VELOCITY,
        ),
        (
            "Temperatures",
            real(&|row| row.temperature),
            Dimension::TEMPERATURE,
        ),
        ("Pressures", real(&|row| row.local.p), Dimension::PRESSURE),
        (
            "SmoothingLengths",
            real(&|row| row.local.h),
            Dimension::LENGTH,
        ),
    ];
    for (name, values, dimension) in &reals {
        write(name, ColumnRef::Real(values), *dimension)?;
    }
    let gradient = |i: usize| vector(&move |row: &Row| row.local.grad_v.row(i).transpose());
    let vectors: [(&str, Vec<Vec3>, Dimension); 6] = [
        ("Coordinates", vector(&|row| row.x), Dimension::LENGTH),
        (
            "Velocities",
            vector(&|row| row.local.v),
            Dimension::VELOCITY,
        ),
        ("DensityGradients", vector(&|row| row.local.grad_rho), steep),
        ("VelocityGradientsX", gradient(0), Dimension::RATE),
        ("VelocityGradientsY", gradient(1), Dimension::RATE),
        ("VelocityGradientsZ", gradient(2), Dimension::RATE),
    ];
    for (name, values, dimension) in &vectors {
        write(name, ColumnRef::Vector(values), *dimension)?;
    }
    file.close()?;
    Ok(())
}

#[cfg(test)]
mod tests;
