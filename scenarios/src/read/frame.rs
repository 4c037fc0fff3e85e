//! What frames a scene: run, units, domain, star, initial file, accuracy.

use std::path::{Path, PathBuf};

use nbody::points::{Dimension, Domain, Vec3};

use super::absolute;
use crate::preset::PRESETS;
use crate::reader::{Door, Range, Section};
use crate::scene::{Accuracy, Local, Preset, Run, Snapshots, Star, TimeStep};
use crate::units::{Kind, System, Units};

/// Snapshots that a run may write.
const MOST_SNAPSHOTS: f64 = 1e6;

pub fn name(root: &Section<'_>, stem: &str) -> String {
    let Some(name) = root.text("name") else {
        return stem.to_owned();
    };
    if name.is_empty() || name == "." || name == ".." || name.contains(['/', '\0']) {
        root.wrong("name", "must be usable as the name of a folder");
    }
    name.to_owned()
}

pub fn units(root: &Section<'_>, door: &Door) -> Units {
    let section = root.section("units");
    let systems = [
        ("astronomical", System::Astronomical),
        ("dimensionless", System::Dimensionless),
        ("cgs", System::Cgs),
    ];
    let system = section.choice("system", &systems, &[]);
    section.close();
    let units = Units::new(system.unwrap_or(System::Astronomical));
    door.units.set(units);
    units
}

pub fn run(root: &Section<'_>) -> Run {
    let section = root.section("run");
    let end_time = section.quantity("end_time", Kind::TIME, Range::POSITIVE);
    let end_time = section.required("end_time", end_time, "a time such as \"10 yr\"", f64::NAN);
    let time_step = time_step(&section);
    if let TimeStep::Fixed(dt) = time_step
        && dt > end_time
    {
        section.wrong("time_step", "is longer than run.end_time");
    }
    let run = Run {
        end_time,
        snapshots: snapshots(&section, end_time),
        checkpoint: section.wall_clock("checkpoint").unwrap_or(300.0),
        seed: section.whole("seed", 0, i64::MAX as u64).unwrap_or(1),
        time_step,
        write_accelerations: section.flag("write_accelerations").unwrap_or(false),
    };
    section.close();
    run
}

/// `time_step`: "auto" or a time.
pub fn time_step(section: &Section<'_>) -> TimeStep {
    if section.is_text("time_step", "auto") {
        section.text("time_step");
        return TimeStep::Auto;
    }
    section
        .quantity("time_step", Kind::TIME, Range::POSITIVE)
        .map_or(TimeStep::Auto, TimeStep::Fixed)
}

fn snapshots(section: &Section<'_>, end_time: f64) -> Snapshots {
    const KEY: &str = "snapshots";
    if section.is_text(KEY, "none") {
        section.text(KEY);
        return Snapshots::None;
    }
    if section.is_list(KEY) {
        let times = section.quantities(KEY, Kind::TIME).unwrap_or_default();
        if times.windows(2).any(|pair| pair[0] >= pair[1]) {
            section.wrong(KEY, "must be a list of ascending times");
        }
        if times.iter().any(|&time| time < 0.0 || time > end_time) {
            section.wrong(KEY, "must lie between 0 and run.end_time");
        }
        return Snapshots::At(times);
    }
    let interval = section.quantity(KEY, Kind::TIME, Range::POSITIVE);
    if interval.is_some_and(|interval| end_time / interval > MOST_SNAPSHOTS) {
        section.wrong(KEY, "would write more than 1000000 snapshots");
    }
    Snapshots::Every(interval.unwrap_or(end_time / 10.0))
}

/// What lies beyond the faces of a domain.
#[derive(Clone, Copy, PartialEq)]
enum Kinds {
    Open,
    Periodic,
    Shearing,
}

/// Keys of a shearing box alone.
const OF_THE_FRAME: [&str; 4] = ["rate", "shear", "vertical_gravity", "headwind"];

pub fn domain(root: &Section<'_>) -> (Domain, Local) {
    let section = root.section("domain");
    let kinds = [
        ("open", Kinds::Open),
        ("periodic", Kinds::Periodic),
        ("shearing-box", Kinds::Shearing),
    ];
    let kind = section.choice("kind", &kinds, &[]);
    if section.has("kind") && kind.is_none() {
        section.pass_over(&["size"]);
        section.pass_over(&OF_THE_FRAME);
    }
    let kind = kind.unwrap_or(Kinds::Open);
    if kind != Kinds::Shearing {
        section.misplaced(&OF_THE_FRAME, "belongs to kind = \"shearing-box\"");
    }
    let mut local = Local::default();
    let whole = match kind {
        Kinds::Open => {
            section.misplaced(
                &["size"],
                "belongs to kind = \"periodic\" or \"shearing-box\"",
            );
            Domain::open()
        }
        Kinds::Periodic => Domain::periodic(size(&section, "the periodic box")),
        Kinds::Shearing => {
            local = self::local(&section);
            shearing(&section)
        }
    };
    let dimensions = section.whole("dimensions", 2, 3).unwrap_or(3);
    let planes = [("xy", [true, true, false]), ("xz", [true, false, true])];
    let plane = section.choice("plane", &planes, &[]);
    if plane.is_some() && dimensions == 3 {
        section.wrong("plane", "belongs to dimensions = 2");
    }
    let axes = if dimensions == 2 {
        plane.unwrap_or(planes[0].1)
    } else {
        [true; 3]
    };
    if local.vertical_gravity && !axes[2] {
        section.wrong(
            "vertical_gravity",
            "needs heights, which plane = \"xy\" has not",
        );
    }
    section.close();
    (whole.with_axes(axes), local)
}

fn size(section: &Section<'_>, what: &str) -> Vec3 {
    let nowhere = Vec3::repeat(f64::NAN);
    let size = section.vector("size", Kind::LENGTH);
    let what = format!("the lengths [x, y, z] of {what}");
    let size = section.required("size", size, &what, nowhere);
    if size.iter().any(|&length| length <= 0.0) {
        section.wrong("size", "must be greater than 0 along every axis");
        return nowhere;
    }
    size
}

fn shearing(section: &Section<'_>) -> Domain {
    const STABLE: Range = Range {
        test: |q| (0.0..2.0).contains(&q),
        text: "at least 0 and less than 2, where orbits are no longer stable",
    };
    let rate = section.quantity("rate", Kind::of(Dimension::RATE), Range::POSITIVE);
    let what = "the orbital frequency Omega of the box";
    let rate = section.required("rate", rate, what, f64::NAN);
    let shear = section.number("shear", STABLE).unwrap_or(1.5);
    Domain::shearing(size(section, "the shearing box"), rate, shear)
}

fn local(section: &Section<'_>) -> Local {
    let headwind = section.quantity("headwind", Kind::VELOCITY, Range::ANY);
    Local {
        vertical_gravity: section.flag("vertical_gravity").unwrap_or(false),
        headwind: headwind.unwrap_or(0.0),
    }
}

pub fn star(root: &Section<'_>) -> Option<Star> {
    let section = root.section("star");
    if !section.present {
        return None;
    }
    let mass = section.quantity("mass", Kind::MASS, Range::POSITIVE);
    let radius = section.quantity("accretion_radius", Kind::LENGTH, Range::NOT_NEGATIVE);
    let star = Star {
        mass: section.required("mass", mass, "a mass such as \"1 Msun\"", f64::NAN),
        accretion_radius: radius.unwrap_or(0.0),
    };
    section.close();
    Some(star)
}

pub fn initial_file(root: &Section<'_>, folder: &Path) -> Option<PathBuf> {
    let section = root.section("initial");
    if !section.present {
        return None;
    }
    let file = section.text("file");
    let file = section.required("file", file, "the name of a snapshot file", "");
    section.close();
    let path = absolute(folder, file);
    if !file.is_empty() && !path.is_file() {
        root.section("initial")
            .wrong("file", &format!("there is no file {}", path.display()));
    }
    Some(path)
}

pub fn accuracy(root: &Section<'_>) -> Accuracy {
    let section = root.section("accuracy");
    let preset = section.choice("preset", &PRESETS, &[]);
    let preset = preset.unwrap_or(Preset::Standard);
    let acceleration = section.number("acceleration_step", Range::POSITIVE);
    let orbit = section.number("orbit_step", Range::POSITIVE);
    section.close();
    Accuracy {
        preset,
        acceleration_step: acceleration.unwrap_or(preset.values().acceleration_step),
        orbit_step: orbit.unwrap_or(preset.values().orbit_step),
    }
}
