//! Group: immersed particles in the order in which a block serves them, cut into cells that share candidates and runs that share weights.

use nbody::points::{Domain, Vec3};

/// Most members of a run.
pub const RUN: usize = 8;

/// Most members of a cell.
const MOST: usize = 256;

/// Largest extent of a cell by the largest smoothing length of a member.
const EXTENT: f64 = 3.0;

/// Ratio of the smoothing lengths in a cell.
const RATIO: f64 = 1.5;

/// A member: where it is in space, the last smoothing length of the gas around it, and its place in the block's list.
#[derive(Clone, Copy, Debug)]
pub struct Member {
    pub x: Vec3,
    pub h: f64,
    pub place: u32,
}

/// Members `first..end` that share candidates: the box around them and the largest of their smoothing lengths.
#[derive(Clone, Copy, Debug)]
pub struct Cell {
    pub first: usize,
    pub end: usize,
    pub lo: Vec3,
    pub hi: Vec3,
    pub h: f64,
}

impl Cell {
    fn around(members: &[Member], first: usize) -> Self {
        let empty = Self {
            first,
            end: first + members.len(),
            lo: Vec3::repeat(f64::INFINITY),
            hi: Vec3::repeat(f64::NEG_INFINITY),
            h: 0.0,
        };
        members.iter().fold(empty, |cell, member| Self {
            lo: cell.lo.inf(&member.x),
            hi: cell.hi.sup(&member.x),
            h: cell.h.max(member.h),
            ..cell
        })
    }

    /// Whether its members are close enough, and their smoothing lengths alike.
    fn is_compact(&self, members: &[Member], domain: &Domain) -> bool {
        let extent = domain.in_plane(self.hi - self.lo).max();
        let alike = |member: &Member| self.h <= RATIO * member.h;
        members.len() == 1
            || members.len() <= MOST && extent <= EXTENT * self.h && members.iter().all(alike)
    }
}

/// Brings the members into an order in which those that follow each other are neighbours, and lists the cells.
pub fn cut(members: &mut [Member], first: usize, domain: &Domain, cells: &mut Vec<Cell>) {
    let cell = Cell::around(members, first);
    let compact = cell.is_compact(members, domain);
    if compact {
        arrange(members, (cell.lo, cell.hi), domain);
        cells.push(cell);
    } else {
        let middle = halve(members, (cell.lo, cell.hi), domain);
        let (low, high) = members.split_at_mut(middle);
        cut(low, first, domain, cells);
        cut(high, first + middle, domain, cells);
    }
}

/// Orders the members of a cell so that each run of them is compact.
fn arrange(members: &mut [Member], ends: (Vec3, Vec3), domain: &Domain) {
    if members.len() > RUN {
        let middle = halve(members, ends, domain);
        let (low, high) = members.split_at_mut(middle);
        for half in [low, high] {
            let cell = Cell::around(half, 0);
            arrange(half, (cell.lo, cell.hi), domain);
        }
    }
}

/// Puts the lower half along the longest axis first, in whole runs if there are several; returns where the other begins.
fn halve(members: &mut [Member], (lo, hi): (Vec3, Vec3), domain: &Domain) -> usize {
    let axis = domain.in_plane(hi - lo).imax();
    let half = members.len() / 2;
    let middle = if members.len() > RUN {
        half.next_multiple_of(RUN)
    } else {
        half
    };
    members.select_nth_unstable_by(middle, |a, b| a.x[axis].total_cmp(&b.x[axis]));
    middle
}
