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

/// How much larger than its members' places in single precision a cell is, by its distance from the origin of these.
const SLACK: f64 = 1e-6;

/// A member: where it is in space, relative to an origin near by, and its place in the block's list.
#[derive(Clone, Copy, Debug)]
pub struct Member {
    pub x: [f32; 3],
    pub place: u32,
}

/// Members `first..end` that share candidates: the box around them, relative to their origin, and the largest of their smoothing lengths.
#[derive(Clone, Copy, Debug)]
pub struct Cell {
    pub first: usize,
    pub end: usize,
    pub lo: Vec3,
    pub hi: Vec3,
    pub h: f64,
}

/// The box around members.
fn ends(members: &[Member]) -> (Vec3, Vec3) {
    let (mut lo, mut hi) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for member in members {
        for axis in 0..3 {
            lo[axis] = lo[axis].min(member.x[axis]);
            hi[axis] = hi[axis].max(member.x[axis]);
        }
    }
    let vector = |x: [f32; 3]| Vec3::from(x.map(f64::from));
    (vector(lo), vector(hi))
}

impl Cell {
    /// Of the smoothing lengths `h` by place.
    fn around(members: &[Member], first: usize, h: &[f64]) -> Self {
        let (lo, hi) = ends(members);
        let slack = Vec3::repeat(SLACK * lo.amax().max(hi.amax()));
        let lengths = members.iter().map(|member| h[member.place as usize]);
        Self {
            first,
            end: first + members.len(),
            lo: lo - slack,
            hi: hi + slack,
            h: lengths.fold(0.0, f64::max),
        }
    }

    /// Whether its members are close enough, and their smoothing lengths alike.
    fn is_compact(&self, members: &[Member], h: &[f64], domain: &Domain) -> bool {
        let extent = domain.in_plane(self.hi - self.lo).max();
        let alike = |member: &Member| self.h <= RATIO * h[member.place as usize];
        members.len() == 1
            || members.len() <= MOST && extent <= EXTENT * self.h && members.iter().all(alike)
    }
}

/// Brings the members, whose smoothing lengths by place are `h`, into an order in which those that follow each other are neighbours, and lists the
/// cells.
pub fn cut(
    members: &mut [Member],
    first: usize,
    (h, domain): (&[f64], &Domain),
    cells: &mut Vec<Cell>,
) {
    let cell = Cell::around(members, first, h);
    if cell.is_compact(members, h, domain) {
        arrange(members, domain);
        cells.push(cell);
    } else {
        let middle = halve(members, domain);
        let (low, high) = members.split_at_mut(middle);
        cut(low, first, (h, domain), cells);
        cut(high, first + middle, (h, domain), cells);
    }
}

/// Orders the members of a cell so that each run of them is compact.
fn arrange(members: &mut [Member], domain: &Domain) {
    if members.len() > RUN {
        let middle = halve(members, domain);
        let (low, high) = members.split_at_mut(middle);
        arrange(low, domain);
        arrange(high, domain);
    }
}

/// Puts the lower half along the longest axis first, in whole runs if there are several; returns where the other begins.
fn halve(members: &mut [Member], domain: &Domain) -> usize {
    let (lo, hi) = ends(members);
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
