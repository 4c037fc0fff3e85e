//! Neighbours: the candidates of a leaf, gathered once into small contiguous arrays, and the list of those near one target.
//!
//! Coordinates are relative to the middle of the targets' box, periodic images moved next to it, zero along missing axes.

use nbody::points::{Domain, Tree, Vec3};

/// A box around targets.
pub type Span = (Vec3, Vec3);

/// The box around the positions.
pub fn bounding(x: impl Iterator<Item = Vec3>) -> Span {
    let empty = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    x.fold(empty, |(lo, hi), p| (lo.inf(&p), hi.sup(&p)))
}

/// How far a search goes.
pub struct Search<'a> {
    pub tree: &'a Tree,
    pub domain: &'a Domain,
    pub x: &'a [Vec3],
    /// Reach of the targets.
    pub reach: f64,
    /// Reach of the candidates for each node of the tree, as [`Tree::near`] wants it.
    pub extent: &'a [f64],
}

/// Particles that may be neighbours of some target in a box.
#[derive(Debug, Default)]
pub struct Candidates {
    pub index: Vec<u32>,
    pub x: Vec<f64>,
    pub y: Vec<f64>,
    pub z: Vec<f64>,
    origin: Vec3,
    axes: Vec3,
}

impl Candidates {
    /// Gathers all particles j within max(reach, own(j)) of the box; a negative `own` excludes j.
    pub fn gather(&mut self, search: &Search, (lo, hi): Span, own: impl Fn(usize) -> f64) {
        self.index.clear();
        self.x.clear();
        self.y.clear();
        self.z.clear();
        self.origin = 0.5 * (lo + hi);
        self.axes = search.domain.in_plane(Vec3::repeat(1.0));
        let half = 0.5 * (hi - lo);
        let Search {
            tree,
            domain,
            x,
            reach,
            extent,
        } = *search;
        tree.near(domain, (lo, hi), reach, extent, |range, shift| {
            let origin = self.origin - shift;
            for j in range {
                let d = (x[j] - origin).component_mul(&self.axes);
                let gap = (d.abs() - half).sup(&Vec3::zeros());
                let (gap, own) = (gap.norm_squared(), own(j));
                let far = reach.max(own);
                if own >= 0.0 && gap <= far * far {
                    self.index.push(j as u32);
                    self.x.push(d.x);
                    self.y.push(d.y);
                    self.z.push(d.z);
                }
            }
        });
    }

    pub fn len(&self) -> usize {
        self.index.len()
    }

    pub fn is_empty(&self) -> bool {
        self.index.is_empty()
    }

    /// A target's position in the frame of the candidates.
    pub fn place(&self, x: Vec3) -> [f64; 3] {
        (x - self.origin).component_mul(&self.axes).into()
    }

    /// Lists the candidates k with r^2 < max(`reach2`, own[k]) about the target at `place`; `own` is a value a candidate, or empty.
    ///
    /// The list is filled up to a multiple of [`LANES`] with candidates at the distance [`FAR`].
    #[inline(always)]
    pub fn list(&self, place: [f64; 3], reach2: f64, own: &[f64], list: &mut List) {
        let n = self.len();
        let room = n + LANES;
        if list.number.len() < room {
            list.number.resize(room, 0);
            list.r2.resize(room, 0.0);
            list.all.resize(room, 0.0);
            list.limit.resize(room, 0.0);
        }
        let (x, y, z) = (&self.x[..n], &self.y[..n], &self.z[..n]);
        let all = &mut list.all[..n];
        for k in 0..n {
            let (dx, dy, dz) = (x[k] - place[0], y[k] - place[1], z[k] - place[2]);
            all[k] = dx * dx + dy * dy + dz * dz;
        }
        let limit = &mut list.limit[..n];
        if own.is_empty() {
            limit.fill(reach2);
        } else {
            let own = &own[..n];
            for k in 0..n {
                limit[k] = own[k].max(reach2);
            }
        }
        let (number, r2) = (&mut list.number[..room], &mut list.r2[..room]);
        let mut count = 0;
        for k in 0..n {
            // Never past k: the list is no longer than what was tried.
            number[count] = k as u32;
            r2[count] = all[k];
            count += usize::from(all[k] < limit[k]);
        }
        number[count..count + LANES].fill(0);
        r2[count..count + LANES].fill(FAR * FAR);
        list.count = count;
    }
}

/// Pairs that are worked on together.
pub const LANES: usize = 8;

/// The distance of what fills up a list: beyond any kernel.
pub const FAR: f64 = 1e100;

/// The neighbours of one target.
#[derive(Debug, Default)]
pub struct List {
    number: Vec<u32>,
    r2: Vec<f64>,
    all: Vec<f64>,
    limit: Vec<f64>,
    count: usize,
}

impl List {
    /// Number of neighbours.
    pub fn len(&self) -> usize {
        self.count
    }

    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Numbers of the neighbours among the candidates, filled up.
    #[inline(always)]
    pub fn numbers(&self) -> &[[u32; LANES]] {
        self.number[..self.count.next_multiple_of(LANES)]
            .as_chunks()
            .0
    }

    /// Squares of the neighbours' distances, filled up.
    #[inline(always)]
    pub fn r2(&self) -> &[[f64; LANES]] {
        self.r2[..self.count.next_multiple_of(LANES)].as_chunks().0
    }
}

/// One value a lane.
pub type Lanes = [f64; LANES];

/// The sum over the lanes.
#[inline(always)]
pub fn total(lanes: Lanes) -> f64 {
    let [a, b, c, d, e, f, g, h] = lanes;
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}
