//! Tests of `read`.

use std::path::PathBuf;

use nbody::columns;
use nbody::points::{ColumnRef, Columns, Label};

use super::super::{Group as Out, write};
use super::*;
use crate::hdf;
use crate::scene::Scene;

columns! {
    /// Points with an energy.
    pub struct Points {
        /// identity
        id: Integer = Label::snapshot("ParticleIDs", Dimension::NONE, "identity"),
        /// position
        x: Vector = Label::snapshot("Coordinates", Dimension::LENGTH, "position"),
        /// velocity
        v: Vector = Label::snapshot("Velocities", Dimension::VELOCITY, "velocity"),
        /// mass
        m: Real = Label::snapshot("Masses", Dimension::MASS, "mass"),
        /// energy
        u: Real = Label::snapshot("InternalEnergies", Dimension::SPECIFIC_ENERGY, "energy"),
        /// hidden
        a: Real = Label::checkpoint("Hidden", Dimension::NONE, "hidden"),
    }
}

fn scene() -> Scene {
    let text = "title = \"trial µ\"\n[run]\nend_time = 1\n[[planet]]\nmass = 1\nposition = [0, 0, 0]\nvelocity = [0, 0, 0]\n";
    Scene::parse(text, "trial", Path::new("."), &[]).unwrap()
}

fn points() -> Points {
    let mut points = Points::default();
    points.resize(3);
    for i in 0..3 {
        let c = i as f64;
        points.id[i] = 7 - i as u64;
        points.x[i] = Vec3::new(c, -0.1 * c, 1e-30);
        points.v[i] = Vec3::new(0.3, c / 7.0, -c);
        points.m[i] = 0.1 + c;
        points.u[i] = 1.0 / 3.0;
    }
    points
}

/// A path of its own for each test; removed at the test's end.
struct Spot(PathBuf);

impl Spot {
    fn new(name: &str) -> Self {
        Self(std::env::temp_dir().join(format!("tridisk-{name}-{}.hdf5", std::process::id())))
    }
}

impl Drop for Spot {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

#[test]
fn a_snapshot_reads_back_bit_for_bit() {
    let spot = Spot::new("back");
    let points = points();
    let extra = vec![1.0, 2.0, 4.0];
    let label = Label::snapshot("Temperatures", Dimension::TEMPERATURE, "temperature");
    let group = Out::new(0)
        .with(&points)
        .with_column(label, ColumnRef::Real(&extra));
    write(&spot.0, &scene(), 0.7, &[group]).unwrap();
    let found = read(&spot.0, None).unwrap();
    assert_eq!(found.time, 0.7);
    assert_eq!(found.title, "trial µ");
    assert_eq!(found.scene.as_deref(), Some(scene().to_toml().as_str()));
    let group = found.group(0).unwrap();
    assert_eq!((&group.id, &group.m), (&points.id, &points.m));
    assert_eq!((&group.x, &group.v), (&points.x, &points.v));
    assert_eq!(group.more["InternalEnergies"], points.u);
    assert_eq!(group.more["Temperatures"], extra);
    assert!(found.group(1).is_none());
}

#[test]
fn the_header_has_the_layout_of_swift() {
    let spot = Spot::new("header");
    let points = points();
    write(
        &spot.0,
        &scene(),
        0.7,
        &[Out::new(0).with(&points), Out::new(1)],
    )
    .unwrap();
    let file = File::open(&spot.0).unwrap();
    let header = file.group("Header").unwrap();
    let kind = header
        .attr("Code")
        .unwrap()
        .dtype()
        .unwrap()
        .to_descriptor()
        .unwrap();
    assert!(
        matches!(kind, hdf5::types::TypeDescriptor::FixedUnicode(_)),
        "{kind:?}"
    );
    assert_eq!(read_text(&header, "Code").unwrap(), "SWIFT");
    assert_eq!(header.attr("Time").unwrap().shape(), [1]);
    assert_eq!(
        read_numbers(&header, "NumPart_ThisFile").unwrap()[..2],
        [3.0, 0.0]
    );
    let side = read_numbers(&header, "BoxSize").unwrap();
    assert!(side.len() == 3 && side[0] > 4.0 && side[0] < 4.001);
    let units = file.group("InternalCodeUnits").unwrap();
    let au = read_number(&units, "Unit length in cgs (U_L)").unwrap();
    assert!((au / 1.495978707e13 - 1.0).abs() < 1e-15);
    let dataset = file.dataset("PartType0/Velocities").unwrap();
    assert_eq!(read_number(&dataset, "U_L exponent"), Some(1.0));
    assert_eq!(read_number(&dataset, "U_t exponent"), Some(-1.0));
    let name = "Conversion factor to CGS (not including cosmological corrections)";
    let cgs = read_number(&dataset, name).unwrap();
    assert!((cgs / 2.97847e6 - 1.0).abs() < 1e-5);
    let text = read_text(&dataset, "Expression for physical CGS units").unwrap();
    assert_eq!(text, "[ cm s^-1 ]");
    assert!(!file.group("PartType0").unwrap().link_exists("Hidden"));
    for group in [
        "Policy",
        "Cosmology",
        "Parameters",
        "HydroScheme",
        "SubgridScheme",
        "Units",
    ] {
        assert!(file.link_exists(group), "{group}");
    }
}

fn flat(group: &Group, name: &str, shape: &[usize], values: &[f32]) {
    let dataset = group
        .new_dataset::<f32>()
        .shape(shape)
        .create(name)
        .unwrap();
    dataset.write_raw(values).unwrap();
}

/// A file of two particles at rest with the datasets that `more` adds must be refused in these words.
fn refused(name: &str, wanted: &str, more: impl Fn(&Group)) {
    let spot = Spot::new(name);
    let file = File::create(&spot.0).unwrap();
    let group = file.create_group("PartType1").unwrap();
    flat(&group, "Coordinates", &[2, 3], &[0.0; 6]);
    more(&group);
    file.close().unwrap();
    let units = Units::new(System::Astronomical);
    let message = read(&spot.0, Some(&units)).unwrap_err().to_string();
    assert!(message.contains(wanted), "{message}");
}

#[test]
fn what_is_wrong_with_a_file_is_named() {
    let moving = |group: &Group| flat(group, "Velocities", &[2, 3], &[0.0; 6]);
    refused("missing", "PartType1/Velocities is missing", |_| {});
    refused(
        "shape",
        "PartType1/Velocities has the shape [6], where (N, 3)",
        |group| {
            flat(group, "Velocities", &[6], &[0.0; 6]);
        },
    );
    refused(
        "nan",
        "PartType1/Velocities: entry 1 (from 0) is not a finite",
        |group| {
            flat(
                group,
                "Velocities",
                &[2, 3],
                &[0.0, 0.0, 0.0, 0.0, f32::NAN, 0.0],
            );
        },
    );
    refused("massless", "PartType1/Masses is missing", |group| {
        moving(group)
    });
    refused(
        "negative",
        "PartType1/Masses: entry 1 (from 0) is negative",
        |group| {
            moving(group);
            flat(group, "Masses", &[2], &[1.0, -1.0]);
        },
    );
    refused("count", "has 3 entries, but Coordinates has 2", |group| {
        moving(group);
        flat(group, "Masses", &[3], &[1.0; 3]);
    });
    refused("twins", "5 occurs twice", |group| {
        moving(group);
        flat(group, "Masses", &[2], &[1.0; 2]);
        group
            .new_dataset::<i64>()
            .shape([2])
            .create("ParticleIDs")
            .unwrap()
            .write_raw(&[5i64; 2])
            .unwrap();
    });
    let spot = Spot::new("text");
    std::fs::write(&spot.0, "not hdf5").unwrap();
    let message = read(&spot.0, None).unwrap_err().to_string();
    assert!(message.contains("is not a readable HDF5 file"), "{message}");
    let message = read(Path::new("/nowhere.hdf5"), None)
        .unwrap_err()
        .to_string();
    assert!(message.contains("No such file"), "{message}");
}

#[test]
fn names_units_and_masses_of_gadget_are_understood() {
    let spot = Spot::new("gadget");
    let file = File::create(&spot.0).unwrap();
    let header = file.create_group("Header").unwrap();
    hdf::write_numbers(
        &header,
        "MassTable",
        &[2.0 * 1.98841e33, 0.0, 0.0, 0.0, 0.0, 0.0],
    )
    .unwrap();
    let units = file.create_group("Units").unwrap();
    for name in [
        "Unit length in cgs (U_L)",
        "Unit mass in cgs (U_M)",
        "Unit time in cgs (U_t)",
    ] {
        hdf::write_number(&units, name, 1.0).unwrap();
    }
    let group = file.create_group("PartType0").unwrap();
    flat(&group, "Coordinates", &[1, 3], &[1.495_978_7e13, 0.0, 0.0]);
    flat(&group, "Velocities", &[1, 3], &[0.0, 2.978_47e6, 0.0]);
    flat(&group, "InternalEnergy", &[1], &[1e12]);
    file.close().unwrap();
    let found = read(&spot.0, Some(&Units::new(System::Astronomical))).unwrap();
    let group = found.group(0).unwrap();
    assert!((group.x[0].x - 1.0).abs() < 1e-6 && (group.v[0].y - 1.0).abs() < 1e-5);
    assert!((group.m[0] - 2.0).abs() < 1e-4);
    let energy = group.more["InternalEnergies"][0];
    assert!((energy / (1e12 / 2.97847e6f64.powi(2)) - 1.0).abs() < 1e-4);
    assert!(group.id.is_empty());
    let plain = read(&spot.0, Some(&Units::new(System::Dimensionless))).unwrap();
    assert_eq!(plain.group(0).unwrap().m[0], 2.0 * 1.98841e33);
}
