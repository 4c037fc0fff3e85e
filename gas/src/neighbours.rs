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

    /// Separation of candidate k from the target at `place`.
    #[inline(always)]
    pub fn separation(&self, place: [f64; 3], k: usize) -> [f64; 3] {
        [
            self.x[k] - place[0],
            self.y[k] - place[1],
            self.z[k] - place[2],
        ]
    }

    /// Lists the candidates k with r^2 < `limit(k)` about the target at `place`.
    #[inline(always)]
    pub fn list(&self, place: [f64; 3], limit: impl Fn(usize) -> f64, list: &mut List) {
        let n = self.len();
        list.number.resize(n.max(list.number.len()), 0);
        list.r2.resize(n.max(list.r2.len()), 0.0);
        let (x, y, z) = (&self.x[..n], &self.y[..n], &self.z[..n]);
        let mut count = 0;
        for k in 0..n {
            let (dx, dy, dz) = (x[k] - place[0], y[k] - place[1], z[k] - place[2]);
            let r2 = dx * dx + dy * dy + dz * dz;
            list.number[count] = k as u32;
            list.r2[count] = r2;
            count += usize::from(r2 < limit(k));
        }
        list.count = count;
    }
}

/// The neighbours of one target.
#[derive(Debug, Default)]
pub struct List {
    number: Vec<u32>,
    r2: Vec<f64>,
    count: usize,
}

impl List {
    /// Numbers of the neighbours among the candidates.
    pub fn numbers(&self) -> &[u32] {
        &self.number[..self.count]
    }

    /// Squares of the neighbours' distances.
    pub fn r2(&self) -> &[f64] {
        &self.r2[..self.count]
    }
}
