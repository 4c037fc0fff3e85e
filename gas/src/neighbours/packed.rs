//! Particles as a sweep sees them: packed leaf by leaf, coordinates from the middle of the leaf, what a pair needs in rows of quads.

use nbody::points::sum::Parts;
use nbody::points::tree::Node;
use nbody::points::{Domain, Tree, Vec3};
use rayon::prelude::*;

use crate::lanes::{MOST, Quad, Real};
use crate::units::Units;

/// Where the particles of a sweep are.
#[derive(Clone, Copy)]
pub struct Frame<'a> {
    pub tree: &'a Tree,
    pub domain: &'a Domain,
    pub x: &'a [Vec3],
    pub units: Units,
}

impl Frame<'_> {
    fn middle<E: Real>(&self, leaf: usize) -> Middle {
        let (node, step) = (&self.tree.nodes[leaf], self.units.step);
        let steps = node.centre().component_div(&step).map(f64::round);
        let half = 0.5 * (node.hi - node.lo).amax() + step.max();
        Middle {
            x: self.domain.in_plane(steps.component_mul(&step)),
            coarser: coarser::<E>(&self.units, half / self.units.length),
        }
    }

    /// Calls `visit(node, shift)` for leaves whose box, moved by a shift of the domain, comes within max(`reach`, `extent[leaf]`) of the
    /// box [lo, hi], as [`Tree::near`] does.
    pub(super) fn near(
        &self,
        (lo, hi): Span,
        reach: f64,
        extent: &[f64],
        mut visit: impl FnMut(u32, Vec3),
    ) {
        let nodes = &self.tree.nodes;
        let root = &nodes[0];
        let far = reach.max(extent.first().copied().unwrap_or(0.0));
        let margin = Vec3::repeat(far);
        (self.domain).shifts(lo - margin, hi + margin, root.lo, root.hi, |shift| {
            let (lo, hi) = (lo - shift, hi - shift);
            let mut i = 0;
            while i < nodes.len() {
                let node = &nodes[i];
                let own = extent.get(i).copied().unwrap_or(0.0);
                let far = larger(reach, own);
                if own < 0.0 || gap2(node, lo, hi) > far * far {
                    i = node.skip as usize;
                } else {
                    i += 1;
                    if node.skip as usize == i {
                        visit(i as u32 - 1, shift);
                    }
                }
            }
        });
    }
}

/// The larger of two numbers, in one instruction: neither is NaN.
#[inline(always)]
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// Square of the distance between a node and the box [lo, hi].
#[inline(always)]
pub(super) fn gap2(node: &Node, lo: Vec3, hi: Vec3) -> f64 {
    let mut sum = 0.0;
    for a in 0..3 {
        let gap = larger(larger(node.lo[a] - hi[a], lo[a] - node.hi[a]), 0.0);
        sum += gap * gap;
    }
    sum
}

/// Particles that leaves share one walk through the tree for.
const BRANCH: usize = 256;

/// Fills `branches` with the largest nodes of at most [`BRANCH`] particles, and the leaves that are larger.
pub fn branches(tree: &Tree, branches: &mut Vec<u32>) {
    branches.clear();
    let mut i = 0;
    while i < tree.nodes.len() {
        let node = &tree.nodes[i];
        if node.count() <= BRANCH || tree.is_leaf(i) {
            branches.push(i as u32);
            i = node.skip as usize;
        } else {
            i += 1;
        }
    }
}

/// A box: its least and its largest coordinates.
pub type Span = (Vec3, Vec3);

/// The middle of a leaf, on the grid, zero along missing axes; and how many times the steps of the leaf's own grid are doubled.
#[derive(Clone, Copy, Debug, Default)]
pub struct Middle {
    pub x: Vec3,
    pub coarser: i32,
}

/// How many times steps are to be doubled for whole numbers of them to reach `far`, in units of length.
#[inline(always)]
pub(super) fn coarser<E: Real>(units: &Units, far: f64) -> i32 {
    let step = units.step;
    let mut room = E::STEPS * step.x.min(step.y).min(step.z) / units.length;
    let mut coarser = 0;
    while room < far {
        room *= 2.0;
        coarser += 1;
    }
    coarser
}

/// All particles as the sweeps see them.
#[derive(Clone, Debug, Default)]
pub struct Packed<E> {
    /// Coordinates from the middle of the particle's leaf.
    pub(super) x: [Vec<E>; 3],
    /// The particle's own reach, negative if it is not active.
    pub(super) reach: Vec<E>,
    /// Middles of the leaves, by node.
    middles: Vec<Middle>,
    /// Rows of `stride` quads.
    pub(super) quads: Vec<Quad<E>>,
    pub(super) stride: usize,
}

impl<E: Real> Packed<E> {
    /// Packs the particles of `leaves`: `source(i, d, coarser)` is the reach and the row of particle i, which stands at d from the middle of its
    /// leaf, where steps are doubled `coarser` times.
    pub fn fill<const Q: usize>(
        &mut self,
        frame: &Frame,
        leaves: &[u32],
        source: impl Fn(usize, Vec3, i32) -> (f64, [Quad<E>; Q]) + Sync,
    ) {
        let n = frame.x.len();
        self.stride = Q;
        for column in self.x.iter_mut().chain([&mut self.reach]) {
            column.resize(n + MOST, E::default());
        }
        self.quads.resize(n * Q, Quad::default());
        self.middles
            .resize(frame.tree.nodes.len(), Middle::default());
        let middles = Parts::new(&mut self.middles);
        let x = self.x.each_mut().map(|x| Parts::new(x));
        let (reaches, quads) = (Parts::new(&mut self.reach), Parts::new(&mut self.quads));
        let by_length = 1.0 / frame.units.length;
        leaves.par_iter().for_each(|&leaf| {
            let leaf = leaf as usize;
            let middle = frame.middle::<E>(leaf);
            let range = frame.tree.nodes[leaf].range();
            // SAFETY: a leaf's task alone touches the leaf and its particles.
            unsafe { middles.part(leaf..leaf + 1)[0] = middle };
            // SAFETY: as above.
            let (mut x, reaches, quads) = unsafe {
                (
                    x.each_ref().map(|x| x.part(range.clone())),
                    reaches.part(range.clone()),
                    quads.part(range.start * Q..range.end * Q),
                )
            };
            let rows = quads.as_chunks_mut::<Q>().0;
            for (k, (row, i)) in rows.iter_mut().zip(range).enumerate() {
                let d = frame.domain.in_plane(frame.x[i]) - middle.x;
                let (reach, quads) = source(i, d, middle.coarser);
                *row = quads;
                reaches[k] = E::from_f64(reach);
                for (x, d) in x.iter_mut().zip(&d) {
                    x[k] = E::from_f64(d * by_length);
                }
            }
        });
    }

    /// The middle of a leaf.
    #[inline(always)]
    pub fn middle(&self, leaf: usize) -> Middle {
        self.middles[leaf]
    }

    /// Coordinates of particle i from the middle of its leaf.
    #[inline(always)]
    pub fn place(&self, i: usize) -> [E; 3] {
        [self.x[0][i], self.x[1][i], self.x[2][i]]
    }

    /// The own reach of particle i.
    #[inline(always)]
    pub fn reach(&self, i: usize) -> f64 {
        self.reach[i].to_f64().abs()
    }

    /// The row of particle i.
    #[inline(always)]
    pub fn row<const Q: usize>(&self, i: usize) -> [Quad<E>; Q] {
        self.quads.as_chunks::<Q>().0[i]
    }
}
