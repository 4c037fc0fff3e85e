//! Errors of a run: what its ledger lost, and how far its end lies from that of a reference.
//!
//! Ledger: the largest modulus of a relative error over the reports; its uncertainty is the scatter over the later half of them. Positions: rms
//! distance of bodies of one identity by the rms distance from the star. Eccentricity, inclination: difference of the rms by the
//! reference's. Profiles: sum over rings (slices of a box) of the difference in mass, or in mass times height, by the whole. Torque: difference
//! of the planets' change of angular momentum by the reference's. Uncertainties of these are jackknifes over groups of bodies or rings.

use std::collections::BTreeMap;
use std::path::Path;

use nbody::orbit::Elements;
use nbody::points::Vec3;

use super::jackknife::{Measured, PARTS, jackknife, root_mean};
use super::tail;
use crate::history::read_numbers;
use crate::snapshot::{self, Contents, Particles};

/// What can be measured, in the order of tables.
pub const METRICS: [&str; 11] = [
    "energy",
    "angular_momentum",
    "momentum",
    "mass",
    "position",
    "eccentricity",
    "inclination",
    "gas_profile",
    "dust_profile",
    "dust_height",
    "torque",
];

pub type Errors = BTreeMap<&'static str, Measured>;

/// The end of a run, and its start.
pub struct State {
    start: Contents,
    end: Contents,
    centre: [Vec3; 2],
    mu: f64,
    /// Ids of planets.
    planets: u64,
}

impl State {
    /// Of the run in a folder that has snapshots 0 and 1.
    pub fn read(folder: &Path, g: f64, planets: usize) -> Result<Self, String> {
        let read = |name: &str| {
            let path = folder.join(name);
            snapshot::read(&path, None).map_err(|error| error.to_string())
        };
        let (start, end) = (read("snapshot_0000.hdf5")?, read("snapshot_0001.hdf5")?);
        let star = end.group(4);
        let first = |list: &[Vec3]| list.first().copied().unwrap_or_default();
        Ok(Self {
            centre: star.map_or([Vec3::zeros(); 2], |star| [first(&star.x), first(&star.v)]),
            mu: star.map_or(0.0, |star| g * star.m.first().copied().unwrap_or(0.0)),
            planets: planets as u64,
            start,
            end,
        })
    }

    /// Distances from `reference`.
    pub fn errors(&self, reference: &Self) -> Errors {
        let mut errors = Errors::new();
        let mut add = |name: &'static str, measured: Option<Measured>| {
            if let Some(measured) = measured {
                errors.insert(name, measured);
            }
        };
        let pair = |part: usize| {
            let groups = (self.end.group(part)?, reference.end.group(part)?);
            (!groups.0.is_empty() && !groups.1.is_empty()).then_some(groups)
        };
        if let Some((mine, theirs)) = pair(1) {
            // Bodies of one identity are the same where there are as many.
            let number = |state: &Self| state.start.group(1).map_or(0, Particles::len);
            if number(self) == number(reference) {
                add("position", self.positions(reference, mine, theirs));
            }
            if let [Some(mine), Some(theirs)] = [self.shapes(mine), reference.shapes(theirs)] {
                add("eccentricity", root_mean(&mine, &theirs, 0));
                add("inclination", root_mean(&mine, &theirs, 1));
            }
            add("torque", self.torque(reference));
        }
        if let Some((mine, theirs)) = pair(0) {
            add(
                "gas_profile",
                self.profile(reference, [mine, theirs], |_| 1.0),
            );
        }
        if let Some((mine, theirs)) = pair(2) {
            add(
                "dust_profile",
                self.profile(reference, [mine, theirs], |_| 1.0),
            );
            add("dust_height", self.heights(reference, [mine, theirs]));
        }
        errors
    }

    /// Bodies that both have, relative to the star where there is one.
    fn positions(&self, other: &Self, mine: &Particles, theirs: &Particles) -> Option<Measured> {
        let places: BTreeMap<u64, Vec3> = theirs
            .id
            .iter()
            .copied()
            .zip(theirs.x.iter().copied())
            .collect();
        let here: BTreeMap<u64, Vec3> = mine
            .id
            .iter()
            .copied()
            .zip(mine.x.iter().copied())
            .collect();
        let squares: Vec<[f64; 2]> = here
            .iter()
            .filter_map(|(id, x)| {
                let there = places.get(id)? - other.centre[0];
                Some([
                    (x - self.centre[0] - there).norm_squared(),
                    there.norm_squared(),
                ])
            })
            .collect();
        let distances = squares.iter().map(|square| square[0].sqrt());
        let spread = tail::spread(distances.collect(), 4.0);
        let measured = jackknife(&squares, |sums| (sums[0] / sums[1]).sqrt())?;
        Some(Measured { spread, ..measured })
    }

    /// Squares of eccentricities and inclinations of planetesimals, of planets where there are no others; `None` without a star.
    fn shapes(&self, group: &Particles) -> Option<Vec<[f64; 2]>> {
        if self.mu == 0.0 {
            return None;
        }
        let others = group.id.iter().any(|&id| id > self.planets);
        let counted = |i: &usize| !others || group.id[*i] > self.planets;
        let shape = |i: usize| {
            let [x, v] = [group.x[i] - self.centre[0], group.v[i] - self.centre[1]];
            let orbit = Elements::of(self.mu, x, v)?;
            let squares = [orbit.eccentricity.powi(2), orbit.inclination.powi(2)];
            Some((group.id[i], squares))
        };
        let shapes: BTreeMap<u64, [f64; 2]> =
            (0..group.len()).filter(counted).filter_map(shape).collect();
        Some(shapes.into_values().collect())
    }

    /// Change of the planets' angular momentum along the axis.
    fn change(&self) -> Option<f64> {
        let turning = |contents: &Contents| {
            let group = contents.group(1)?;
            let planets = (0..group.len()).filter(|&i| group.id[i] <= self.planets);
            Some(
                planets
                    .map(|i| group.m[i] * group.x[i].cross(&group.v[i]).z)
                    .sum::<f64>(),
            )
        };
        Some(turning(&self.end)? - turning(&self.start)?)
    }

    fn torque(&self, other: &Self) -> Option<Measured> {
        let (mine, theirs) = (self.change()?, other.change()?);
        let others = |part: usize| self.end.group(part).map_or(0, Particles::len);
        let torqued = others(0) > 0 || others(1) as u64 > self.planets;
        (self.planets > 0 && torqued && theirs != 0.0).then(|| Measured {
            error: ((mine - theirs) / theirs).abs(),
            uncertainty: f64::NAN,
            spread: 1.0,
        })
    }

    /// Where particles lie: distance from the star's axis, or along the longest side of a box.
    fn places(&self, group: &Particles, side: usize) -> Vec<f64> {
        let place = |x: &Vec3| match self.mu {
            0.0 => x[side],
            _ => (x - self.centre[0]).xy().norm(),
        };
        group.x.iter().map(place).collect()
    }

    fn profile(
        &self,
        other: &Self,
        groups: [&Particles; 2],
        weight: impl Fn(&Vec3) -> f64,
    ) -> Option<Measured> {
        let side = longest(groups[1]);
        let places = [self.places(groups[0], side), other.places(groups[1], side)];
        let edges = edges(&places[1]);
        let sums = [0, 1].map(|k: usize| {
            let mut sums = [0.0; PARTS];
            for (i, place) in places[k].iter().enumerate() {
                let ring = edges.partition_point(|edge| edge <= place);
                sums[ring] += groups[k].m[i] * weight(&groups[k].x[i]);
            }
            sums
        });
        let rings: Vec<[f64; 2]> = (0..PARTS)
            .map(|ring| [(sums[0][ring] - sums[1][ring]).abs(), sums[1][ring]])
            .collect();
        jackknife(&rings, |sums| sums[0] / sums[1])
    }

    /// Of the heights above the plane, rms in each ring.
    fn heights(&self, other: &Self, groups: [&Particles; 2]) -> Option<Measured> {
        let side = longest(groups[1]);
        let places = [self.places(groups[0], side), other.places(groups[1], side)];
        let edges = edges(&places[1]);
        let middle = [self.centre[0].z, other.centre[0].z];
        let mut rings = vec![[0.0; 3]; 2 * PARTS];
        for k in 0..2 {
            for (i, place) in places[k].iter().enumerate() {
                let ring = 2 * edges.partition_point(|edge| edge <= place) + k;
                let (m, z) = (groups[k].m[i], groups[k].x[i].z - middle[k]);
                rings[ring][0] += m;
                rings[ring][1] += m * z * z;
            }
        }
        let rms = |sums: &[f64; 3]| {
            if sums[0] > 0.0 {
                (sums[1] / sums[0]).sqrt()
            } else {
                0.0
            }
        };
        let rings: Vec<[f64; 2]> = rings
            .chunks(2)
            .map(|pair| {
                let (mine, theirs) = (rms(&pair[0]), rms(&pair[1]));
                [pair[1][0] * (mine - theirs).abs(), pair[1][0] * theirs]
            })
            .collect();
        let flat = rings.iter().all(|ring| ring[1] == 0.0);
        if flat {
            None
        } else {
            jackknife(&rings, |sums| sums[0] / sums[1])
        }
    }
}

/// The side along which a group is longest.
fn longest(group: &Particles) -> usize {
    let start = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    let (lo, hi) = group
        .x
        .iter()
        .fold(start, |(lo, hi), x| (lo.inf(x), hi.sup(x)));
    (hi - lo).imax()
}

/// Inner edges that cut the places into parts of equal number.
fn edges(places: &[f64]) -> Vec<f64> {
    let mut sorted = places.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    (1..PARTS)
        .map(|k| sorted[k * sorted.len() / PARTS])
        .collect()
}

/// What the ledger of a run lost.
pub fn of_ledger(folder: &Path) -> Result<Errors, String> {
    let path = folder.join("ledger.csv");
    let columns = read_numbers(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let mut errors = Errors::new();
    for name in &METRICS[..4] {
        let column = columns
            .iter()
            .find(|(head, _)| *head == format!("error_{name}"));
        let Some((_, values)) = column else { continue };
        let sizes: Vec<f64> = values.iter().map(|x| x.abs()).collect();
        if sizes.is_empty() || sizes.iter().any(|x| !x.is_finite()) {
            continue;
        }
        let late = &sizes[sizes.len() / 2..];
        let n = late.len() as f64;
        let mean = late.iter().sum::<f64>() / n;
        let square: f64 = late.iter().map(|x| (x - mean).powi(2)).sum();
        let measured = Measured {
            error: sizes.iter().copied().fold(0.0, f64::max),
            uncertainty: (square / n).sqrt(),
            spread: 1.0,
        };
        errors.insert(name, measured);
    }
    Ok(errors)
}
