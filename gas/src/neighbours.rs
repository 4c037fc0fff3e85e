//! Neighbours: the candidates of a leaf, gathered once into small contiguous arrays, and the list of those near one target.
//!
//! Coordinates are relative to the middle of the targets' box, periodic images moved next to it, zero along missing axes.

use fearless_simd::{Simd, SimdBase, SimdMask, f64x8};
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
    /// Gathers all particles j within max(reach, own(j)) of the box; a negative `own` excludes j. Filled up to a multiple of [`LANES`].
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
        // Fill up the last lanes with what is near nobody.
        let filled = self.index.len().next_multiple_of(LANES);
        let first = self.index.first().copied().unwrap_or(0);
        self.index.resize(filled, first);
        for x in [&mut self.x, &mut self.y, &mut self.z] {
            x.resize(filled, FAR);
        }
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
    pub fn list<S: Simd>(
        &self,
        simd: S,
        place: [f64; 3],
        (reach2, own): (f64, &[f64]),
        list: &mut List,
    ) {
        let room = self.len() + LANES;
        if list.number.len() < room {
            list.number.resize(room, 0);
            list.all.resize(room, 0.0);
        }
        let (x, y, z) = (
            self.x.as_chunks().0,
            self.y.as_chunks().0,
            self.z.as_chunks().0,
        );
        let own = own.as_chunks().0;
        let all: &mut [Lanes] = list.all.as_chunks_mut().0;
        let lanes = |lanes: &Lanes| f64x8::from_slice(simd, lanes);
        let mut count = 0;
        for (c, ((x, y), z)) in x.iter().zip(y).zip(z).enumerate() {
            let d = [
                lanes(x) - place[0],
                lanes(y) - place[1],
                lanes(z) - place[2],
            ];
            let r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
            r2.store_slice(&mut all[c]);
            let limit = own
                .get(c)
                .map_or(f64x8::splat(simd, reach2), |own| lanes(own).max(reach2));
            let inside = r2.simd_lt(limit).to_bitmask() as u8;
            // All lanes are written, those inside first; the next ones overwrite the rest.
            let numbers = &mut list.number[count..count + LANES];
            for (number, &lane) in numbers.iter_mut().zip(&FIRST[usize::from(inside)]) {
                *number = (c * LANES) as u32 + u32::from(lane);
            }
            count += inside.count_ones() as usize;
        }
        list.count = count;
        list.r2.clear();
        let filled = count.next_multiple_of(LANES);
        list.number[count..filled].fill(0);
        let all = &list.all;
        list.r2
            .extend(list.number[..count].iter().map(|&k| all[k as usize]));
        list.r2.resize(filled, FAR * FAR);
    }
}

/// For each set of lanes their numbers, ascending; then zeros.
const FIRST: [[u8; LANES]; 256] = {
    let mut table = [[0; LANES]; 256];
    let mut set = 0;
    while set < 256 {
        let (mut lane, mut count) = (0, 0);
        while lane < LANES {
            if set >> lane & 1 == 1 {
                table[set][count] = lane as u8;
                count += 1;
            }
            lane += 1;
        }
        set += 1;
    }
    table
};

/// Pairs that are worked on together.
pub const LANES: usize = 8;

/// The distance of what fills up a list: beyond any kernel.
pub const FAR: f64 = 1e100;

/// The neighbours of one target.
#[derive(Debug, Default)]
pub struct List {
    number: Vec<u32>,
    r2: Vec<f64>,
    /// r^2 of all candidates.
    all: Vec<f64>,
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
