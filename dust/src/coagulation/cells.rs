//! Cells: groups of neighbouring superparticles whose grains meet each other, and the volume that each fills.
//!
//! Small nodes of the tree are halved at the median of their longest side, down to at most 32 members, so that a cell has at least 16 where there are
//! as many. Faces lie midway between neighbours: cells fill a periodic domain, and a lattice, without gaps. Where dust ends a cell ends at its members, with the gap
//! that random points leave there; nowhere does it reach further into empty space than 0.6 of the mean distance of its members.
//! Volumes count n/(n - 1) times: over random points the mean of n/V is that much too large, since V varies. Then the mean
//! density that they see is right to 1 %, and 1/n too low on a lattice.

use std::ops::Range;

use nbody::points::random::{Purpose, stream};
use nbody::points::sum::Parts;
use nbody::points::{Domain, Tree, Vec3};
use rand::seq::SliceRandom;
use rayon::prelude::*;

/// Most members of a cell.
pub const CELL: usize = 32;

/// Nodes of the tree of at most so many members are halved at medians; larger ones as the tree is, unless that leaves a child
/// less than half a cell in a node of fewer than the second number.
const GROUP: usize = 256;
const LONELY: usize = 4096;

/// How far a face may be from the members, by their mean distance.
const FARTHEST: f64 = 0.6;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Member {
    x: Vec3,
    place: u32,
}

/// A cell: where its members stand in the list, and its volume (area in two dimensions).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    pub first: u32,
    pub end: u32,
    pub volume: f64,
}

/// All superparticles, cell by cell.
#[derive(Clone, Debug, Default)]
pub struct Cells {
    members: Vec<Member>,
    pub cells: Vec<Cell>,
    groups: Vec<Group>,
}

/// The part of space that a group has: its faces, and which of them are the end of all dust.
#[derive(Clone, Copy, Debug)]
struct Part {
    lo: Vec3,
    hi: Vec3,
    ends: [[bool; 2]; 3],
}

impl Part {
    /// What lies below and above a face.
    fn cut(self, axis: usize, face: f64) -> [Self; 2] {
        let [mut below, mut above] = [self; 2];
        below.hi[axis] = face;
        above.lo[axis] = face;
        below.ends[axis][1] = false;
        above.ends[axis][0] = false;
        [below, above]
    }
}

/// A node of the tree that is divided further, with its members and its cells.
#[derive(Clone, Copy, Debug)]
struct Group {
    first: u32,
    end: u32,
    first_cell: u32,
    end_cell: u32,
    part: Part,
}

impl Group {
    fn members(&self) -> Range<usize> {
        self.first as usize..self.end as usize
    }

    fn cells(&self) -> Range<usize> {
        self.first_cell as usize..self.end_cell as usize
    }
}

impl Cells {
    /// Divides points, in the order of their tree, into cells.
    pub fn divide(&mut self, x: &[Vec3], tree: &Tree, domain: &Domain) {
        self.members.clear();
        self.members
            .extend((0..).zip(x).map(|(place, &x)| Member { x, place }));
        self.cells.clear();
        self.groups.clear();
        let Some(root) = tree.nodes.first() else {
            return;
        };
        let mut part = Part {
            lo: root.lo,
            hi: root.hi,
            ends: [[true; 2]; 3],
        };
        for axis in (0..3).filter(|&axis| domain.period(axis) > 0.0) {
            (part.lo[axis], part.hi[axis]) = (0.0, domain.period(axis));
            part.ends[axis] = [false; 2];
        }
        self.descend(tree, 0, part, domain.axes);
        let (members, cells) = (Parts::new(&mut self.members), Parts::new(&mut self.cells));
        self.groups.par_iter().with_min_len(16).for_each(|group| {
            // SAFETY: groups have members and cells of their own.
            let (members, cells) =
                unsafe { (members.part(group.members()), cells.part(group.cells())) };
            halve(members, cells, group.part, domain.axes);
        });
    }

    /// Lists the groups of a node of the tree, and lays out their cells.
    fn descend(&mut self, tree: &Tree, node: usize, part: Part, axes: [bool; 3]) {
        let (own, n) = (tree.nodes[node], tree.nodes[node].count());
        let children = tree.children(node).filter(|&(left, right)| {
            let least = (tree.nodes[left].count()).min(tree.nodes[right].count());
            n > GROUP && (least >= CELL / 2 || n > LONELY)
        });
        if let Some((left, right)) = children {
            let (below, above) = (&tree.nodes[left], &tree.nodes[right]);
            let gap = |axis: usize| match axes[axis] {
                true => above.lo[axis] - below.hi[axis],
                false => f64::NEG_INFINITY,
            };
            // Along the axis on which the node was halved they do not overlap.
            let axis = (1..3).fold(0, |best, a| if gap(a) > gap(best) { a } else { best });
            let [low, high] = part.cut(axis, 0.5 * (below.hi[axis] + above.lo[axis]));
            self.descend(tree, left, low, axes);
            self.descend(tree, right, high, axes);
            return;
        }
        let first_cell = self.cells.len() as u32;
        count(own.first as usize, n, &mut self.cells);
        self.groups.push(Group {
            first: own.first,
            end: own.end,
            first_cell,
            end_cell: self.cells.len() as u32,
            part,
        });
    }

    /// Deals out `n` points of a well-mixed space of this volume: everybody may meet everybody, others at every step.
    pub fn mix(&mut self, n: usize, volume: f64, (seed, step): (u64, u64)) {
        self.members.clear();
        self.members.extend((0..n as u32).map(|place| Member {
            place,
            ..Member::default()
        }));
        let mut random = stream(seed, Purpose::GrowthCells, 0, step);
        self.members.shuffle(&mut random);
        self.cells.clear();
        count(0, n, &mut self.cells);
        for cell in &mut self.cells {
            cell.volume = volume * f64::from(cell.end - cell.first) / n as f64;
        }
    }

    /// Places of a cell's members.
    pub fn places(&self, cell: &Cell) -> impl ExactSizeIterator<Item = usize> + '_ {
        let members = &self.members[cell.first as usize..cell.end as usize];
        members.iter().map(|member| member.place as usize)
    }

    pub fn len(&self) -> usize {
        self.members.len()
    }

    pub fn is_empty(&self) -> bool {
        self.members.is_empty()
    }
}

/// The cells of `n` members from `first` on.
fn count(first: usize, n: usize, cells: &mut Vec<Cell>) {
    if n > CELL {
        count(first, n / 2, cells);
        count(first + n / 2, n - n / 2, cells);
    } else if n > 0 {
        cells.push(Cell {
            first: first as u32,
            end: (first + n) as u32,
            volume: 0.0,
        });
    }
}

/// Number of cells of `n` members.
fn cells_of(n: usize) -> usize {
    match n {
        0 => 0,
        1..=CELL => 1,
        _ => cells_of(n / 2) + cells_of(n - n / 2),
    }
}

fn extent(members: &[Member]) -> (Vec3, Vec3) {
    let none = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    members
        .iter()
        .fold(none, |(lo, hi), m| (lo.inf(&m.x), hi.sup(&m.x)))
}

/// Sorts members into cells and measures these.
fn halve(members: &mut [Member], cells: &mut [Cell], part: Part, axes: [bool; 3]) {
    let n = members.len();
    let (lo, hi) = extent(members);
    if n <= CELL {
        if let Some(cell) = cells.first_mut() {
            cell.volume = volume(n, (lo, hi), &part, axes);
        }
        return;
    }
    let side = |axis: usize| match axes[axis] {
        true => hi[axis] - lo[axis],
        false => -1.0,
    };
    let axis = (1..3).fold(0, |best, a| if side(a) > side(best) { a } else { best });
    let by_side =
        |a: &Member, b: &Member| (a.x[axis].total_cmp(&b.x[axis])).then(a.place.cmp(&b.place));
    members.select_nth_unstable_by(n / 2, by_side);
    let (low, high) = members.split_at_mut(n / 2);
    let last = low.iter().fold(f64::NEG_INFINITY, |m, p| m.max(p.x[axis]));
    let [below, above] = part.cut(axis, 0.5 * (last + high[0].x[axis]));
    let (cells_low, cells_high) = cells.split_at_mut(cells_of(n / 2));
    halve(low, cells_low, below, axes);
    halve(high, cells_high, above, axes);
}

/// Volume of a cell of `n` members that reach from `lo` to `hi`.
fn volume(n: usize, (lo, hi): (Vec3, Vec3), part: &Part, axes: [bool; 3]) -> f64 {
    let active = || (0..3).filter(|&axis| axes[axis]);
    let sides: f64 = active().map(|axis| part.hi[axis] - part.lo[axis]).product();
    let distance = (sides / n as f64).powf(1.0 / active().count() as f64);
    let reach = |axis: usize, face: usize| match part.ends[axis][face] {
        // The gap that n random points leave on average at either end.
        true if n > 1 => (hi[axis] - lo[axis]) / (n - 1) as f64,
        _ => FARTHEST * distance,
    };
    let side = |axis: usize| {
        let floor = (lo[axis] - reach(axis, 0)).max(match part.ends[axis][0] {
            true => f64::NEG_INFINITY,
            false => part.lo[axis],
        });
        let top = (hi[axis] + reach(axis, 1)).min(match part.ends[axis][1] {
            true => f64::INFINITY,
            false => part.hi[axis],
        });
        top - floor
    };
    let volume: f64 = active().map(side).product();
    volume * n as f64 / (n - 1).max(1) as f64
}

#[cfg(test)]
mod tests {
    use nbody::points::Columns;
    use rand::RngExt;

    use super::*;
    use crate::{Dust, Superparticles};

    fn random(n: usize, seed: u64) -> Vec<Vec3> {
        let mut random = stream(seed, Purpose::DustPositions, 0, 0);
        (0..n)
            .map(|_| Vec3::new(random.random(), random.random(), random.random()))
            .collect()
    }

    /// Mean over the points of the density that their cell has, by the true one.
    fn density(x: &[Vec3], domain: &Domain, density: f64) -> f64 {
        let mut particles = Superparticles {
            x: x.to_vec(),
            id: vec![0; x.len()],
            ..Superparticles::default()
        };
        particles.resize(x.len());
        let dust = Dust::new(particles);
        let mut cells = Cells::default();
        cells.divide(&dust.particles.x, &dust.tree, domain);
        let mut all: Vec<usize> = cells.cells.iter().flat_map(|c| cells.places(c)).collect();
        all.sort_unstable();
        assert!(all.iter().enumerate().all(|(i, &place)| i == place));
        let of = |c: &Cell| {
            let n = f64::from(c.end - c.first);
            n * n / c.volume
        };
        cells.cells.iter().map(of).sum::<f64>() / (x.len() as f64 * density)
    }

    #[test]
    fn cells_of_a_lattice_have_its_density() {
        let x: Vec<Vec3> = (0..4096)
            .map(|i| Vec3::new((i % 16) as f64, (i / 16 % 16) as f64, (i / 256) as f64))
            .map(|x| (x + Vec3::repeat(0.5)) / 16.0)
            .collect();
        let found = density(&x, &Domain::periodic(Vec3::repeat(1.0)), 4096.0);
        // Cells of 32.
        assert!((found - 31.0 / 32.0).abs() < 1e-12, "{found}");
    }

    #[test]
    fn cells_of_random_points_have_their_density_but_for_their_spread() {
        let found: Vec<f64> = (0..8)
            .map(|seed| {
                density(
                    &random(20_000, seed),
                    &Domain::periodic(Vec3::repeat(1.0)),
                    2e4,
                )
            })
            .collect();
        let mean = found.iter().sum::<f64>() / 8.0;
        println!("periodic: {mean}");
        // 160 000 points in all; without the part 1/n it would be 1.056.
        assert!((mean - 1.0).abs() < 0.01, "{mean}");
        let open = density(&random(20_000, 9), &Domain::open(), 2e4);
        println!("open: {open}");
        assert!((open - 1.0).abs() < 0.02, "{open}");
    }

    #[test]
    fn thin_layers_and_holes_are_not_filled() {
        // A layer that one cell reaches through, over a ring with nothing inside or around.
        let x: Vec<Vec3> = random(20_000, 3)
            .into_iter()
            .map(|x| 2.0 * x - Vec3::repeat(1.0))
            .filter(|x| (0.5..1.0).contains(&x.xy().norm()))
            .map(|x| Vec3::new(x.x, x.y, 1e-3 * x.z))
            .collect();
        let area = std::f64::consts::PI * 0.75;
        let found = density(&x, &Domain::open(), x.len() as f64 / (area * 2e-3));
        println!("ring: {found}");
        assert!((found - 1.0).abs() < 0.04, "{found}");
    }

    #[test]
    fn mixing_gives_everybody_a_cell_and_fills_the_volume() {
        let mut cells = Cells::default();
        cells.mix(1000, 7.0, (1, 2));
        let total: f64 = cells.cells.iter().map(|c| c.volume).sum();
        assert!((total - 7.0).abs() < 1e-12);
        let first: Vec<usize> = cells.places(&cells.cells[0]).collect();
        cells.mix(1000, 7.0, (1, 3));
        assert_ne!(first, cells.places(&cells.cells[0]).collect::<Vec<usize>>());
    }
}
