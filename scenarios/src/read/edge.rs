//! The zones at the edges of a disk that damp waves, and what holds the inner one.

use coupling::edge::Zone;

use super::Facts;
use crate::reader::{Range, Section};
use crate::scene::{Disk, Edge};
use crate::units::Kind;

pub fn edge(gas: &Section<'_>, facts: &Facts, disk: Option<&Disk>) -> Option<Edge> {
    let section = gas.section("edge");
    if !section.present {
        return None;
    }
    let has_disk = gas.has("disk");
    if !has_disk && !facts.has_star {
        section.wrong(
            "",
            "needs [gas.disk], whose edges they are, or a [star], about which they are",
        );
    }
    let inner = section.choice("inner", &[("open", false), ("supported", true)], &[]);
    let supported = inner == Some(true);
    if supported && !has_disk {
        section.wrong("inner", "needs [gas.disk], whose pressure holds it");
    }
    if !["inner_radius", "outer_radius", "inner"]
        .iter()
        .any(|key| section.has(key))
    {
        section.wrong("", "needs inner_radius, outer_radius or inner");
    }
    let radii = disk.map(|disk| [disk.inner_radius, disk.outer_radius]);
    let [inner, outer] = [0, 1].map(|side| zone(&section, side, radii, has_disk));
    if let (Some(inner), Some(outer)) = (inner, outer)
        && inner.begin >= outer.begin
    {
        section.wrong("inner_radius", "must be less than outer_radius");
    }
    let edge = Edge {
        inner,
        outer,
        time: section.number("time", Range::POSITIVE).unwrap_or(1.0),
        supported,
    };
    section.close();
    Some(edge)
}

/// Keys of where a zone begins and of where its damping is whole, inside and outside.
const KEYS: [[&str; 2]; 2] = [["inner_radius", "inner_end"], ["outer_radius", "outer_end"]];

/// The zone at the inner (0) or the outer (1) edge, whole at the radius of the generated disk unless the scene says where.
fn zone(
    section: &Section<'_>,
    side: usize,
    radii: Option<[f64; 2]>,
    has_disk: bool,
) -> Option<Zone> {
    let [begin_key, end_key] = KEYS[side];
    let begin = section.quantity(begin_key, Kind::LENGTH, Range::POSITIVE);
    let end = section.quantity(end_key, Kind::LENGTH, Range::POSITIVE);
    if !section.has(begin_key) {
        let sentence = format!("needs {begin_key}, where the zone begins");
        section.misplaced(&[end_key], &sentence);
        return None;
    }
    if !has_disk && !section.has(end_key) {
        let sentence = format!("needs {end_key}, where the damping is whole, without [gas.disk]");
        section.wrong(begin_key, &sentence);
    }
    let outside = |begin: f64| radii.is_some_and(|[inner, outer]| inner >= begin || begin >= outer);
    if begin.is_some_and(outside) {
        let sentence = "must lie between the inner and the outer radius of gas.disk";
        section.wrong(begin_key, sentence);
    }
    let zone = Zone {
        begin: begin?,
        whole: end.or(radii.map(|radii| radii[side]))?,
    };
    let (ordered, than) = [
        (zone.whole < zone.begin, "less"),
        (zone.whole > zone.begin, "greater"),
    ][side];
    if section.has(end_key) && !ordered {
        let sentence = format!("must be {than} than {begin_key}");
        section.wrong(end_key, &sentence);
    }
    Some(zone)
}
