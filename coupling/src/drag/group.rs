//! Group: immersed particles in the order in which a block serves them, cut into cells that share candidates and runs that share weights.

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, f32x4, i32x16};
use nbody::points::{Domain, Vec3};

/// Most members of a run.
pub const RUN: usize = 8;

/// Most members of a cell.
const MOST: usize = 1024;

/// Largest extent of a cell by the largest smoothing length of a member.
const EXTENT: f64 = 5.0;

/// Ratio of the smoothing lengths in a cell.
const RATIO: f64 = 1.5;

/// Most members that are brought into order by counting how many come before each.
const COUNTED: usize = 256;

/// Members that are counted for at once.
const WIDE: usize = 16;

/// How much larger than its members' places in single precision a cell is, by its distance from the origin of these.
const SLACK: f64 = 1e-6;

/// A member: where it is in space, relative to an origin near by, and its place in the block's list.
#[derive(Clone, Copy, Debug, Default)]
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
    nbody::widest!(Level::new(), simd => ends_lanes(simd, members))
}

#[inline(always)]
fn ends_lanes<S: Simd>(simd: S, members: &[Member]) -> (Vec3, Vec3) {
    let mut lo = f32x4::splat(simd, f32::INFINITY);
    let mut hi = -lo;
    for &Member { x: [x, y, z], .. } in members {
        let x = f32x4::simd_from(simd, [x, y, z, 0.0]);
        (lo, hi) = (lo.min(x), hi.max(x));
    }
    let vector = |x: f32x4<S>| Vec3::new(f64::from(x[0]), f64::from(x[1]), f64::from(x[2]));
    (vector(lo), vector(hi))
}

impl Cell {
    /// The members in the box `lo`, `hi`, with the smoothing lengths `h` by place; none if these are not alike or the box is too large for them.
    fn compact(
        members: &[Member],
        first: usize,
        (lo, hi): (Vec3, Vec3),
        (h, domain): (&[f64], &Domain),
    ) -> Option<Self> {
        let lengths = || members.iter().map(|member| h[member.place as usize]);
        let largest = lengths().fold(0.0, |most: f64, h| if h > most { h } else { most });
        let fits = domain.in_plane(hi - lo).max() <= EXTENT * largest
            && lengths().all(|h| largest <= RATIO * h);
        let slack = Vec3::repeat(SLACK * lo.amax().max(hi.amax()));
        (members.len() == 1 || fits).then(|| Self {
            first,
            end: first + members.len(),
            lo: lo - slack,
            hi: hi + slack,
            h: largest,
        })
    }
}

/// Brings the members, whose smoothing lengths by place are `h`, into an order in which those that follow each other are neighbours, and lists the
/// cells.
pub fn cut(members: &mut [Member], (h, domain): (&[f64], &Domain), cells: &mut Vec<Cell>) {
    let largest = h.iter().copied().fold(0.0, f64::max);
    part(members, 0, (h, largest, domain), cells);
}

/// The same for those from the `first` on, whose smoothing lengths are at most `largest`.
fn part(
    members: &mut [Member],
    first: usize,
    (h, largest, domain): (&[f64], f64, &Domain),
    cells: &mut Vec<Cell>,
) {
    let ends = ends(members);
    let extent = domain.in_plane(ends.1 - ends.0).max();
    // Most need not ask each member for its smoothing length.
    let small = members.len() <= MOST && extent <= EXTENT * largest || members.len() == 1;
    let cell = small.then(|| Cell::compact(members, first, ends, (h, domain)));
    if let Some(cell) = cell.flatten() {
        arrange(members, domain);
        cells.push(cell);
    } else {
        let middle = halve(members, ends, domain);
        let (low, high) = members.split_at_mut(middle);
        part(low, first, (h, largest, domain), cells);
        part(high, first + middle, (h, largest, domain), cells);
    }
}

/// Orders the members of a cell so that each run of them is compact.
fn arrange(members: &mut [Member], domain: &Domain) {
    if members.len() > RUN {
        let middle = halve(members, ends(members), domain);
        let (low, high) = members.split_at_mut(middle);
        arrange(low, domain);
        arrange(high, domain);
    }
}

/// Puts the lower half along the longest axis of the box around them first, in whole runs if there are several; returns where the other begins.
fn halve(members: &mut [Member], (lo, hi): (Vec3, Vec3), domain: &Domain) -> usize {
    let axis = domain.in_plane(hi - lo).imax();
    let half = members.len() / 2;
    let middle = if members.len() > RUN {
        half.next_multiple_of(RUN)
    } else {
        half
    };
    match members.len() {
        0..=16 => nbody::widest!(Level::new(), simd => order::<_, 16>(simd, members, axis)),
        17..=64 => nbody::widest!(Level::new(), simd => order::<_, 64>(simd, members, axis)),
        65..=COUNTED => {
            nbody::widest!(Level::new(), simd => order::<_, COUNTED>(simd, members, axis));
        }
        _ => {
            members.select_nth_unstable_by(middle, |a, b| a.x[axis].total_cmp(&b.x[axis]));
        }
    }
    middle
}

/// Orders up to N members along an axis, to some 16 bits of their places.
#[inline(always)]
fn order<S: Simd, const N: usize>(simd: S, members: &mut [Member], axis: usize) {
    let n = members.len();
    let mut keys = [i32::MAX; N];
    for ((key, member), k) in keys.iter_mut().zip(&*members).zip(0..) {
        let bits = member.x[axis].to_bits().cast_signed();
        // Of negative numbers the larger bits are the lower number. The lowest bits make the keys differ.
        let rising = bits ^ ((bits >> 31) & i32::MAX);
        *key = rising & !(N as i32 - 1) | k;
    }
    let mut ordered = [Member::default(); N];
    for (own, members) in keys.as_chunks::<WIDE>().0.iter().zip(members.chunks(WIDE)) {
        let own = i32x16::from_slice(simd, own);
        let mut before = i32x16::splat(simd, 0);
        for &key in &keys[..n] {
            let later = own.simd_gt(i32x16::splat(simd, key));
            before = later.select(before + 1, before);
        }
        let mut ranks = [0; WIDE];
        before.store_slice(&mut ranks);
        for (member, rank) in members.iter().zip(ranks) {
            ordered[rank as usize % N] = *member;
        }
    }
    members.copy_from_slice(&ordered[..n]);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Members at scattered places on both sides of their origin, some of them at the same.
    fn scattered(n: usize) -> Vec<Member> {
        let place = |k: usize, factor: f64| ((k as f64 * factor).fract() - 0.5) as f32;
        (0..n)
            .map(|k| Member {
                x: [
                    place(k % 90, 0.819_172_5),
                    place(k, 0.671_043_6),
                    place(k / 2, 0.549_700_5),
                ],
                place: k as u32,
            })
            .collect()
    }

    #[test]
    fn members_are_halved_along_the_longest_axis_in_whole_runs() {
        for n in [2, 8, 9, 16, 17, 40, 64, 65, 100, 256, 257, 500] {
            for axis in 0..3 {
                let mut members = scattered(n);
                members.iter_mut().for_each(|member| member.x[axis] *= 3.0);
                let box_around = ends(&members);
                let middle = halve(&mut members, box_around, &Domain::open());
                assert!(
                    middle == n / 2 || middle.is_multiple_of(RUN),
                    "{middle} of {n}"
                );
                let (low, high) = members.split_at(middle);
                let largest = low.iter().fold(f32::NEG_INFINITY, |m, a| m.max(a.x[axis]));
                let least = high.iter().fold(f32::INFINITY, |m, a| m.min(a.x[axis]));
                // Sixteen bits of one and a half.
                assert!(
                    largest <= least + 1.5 / 32768.0,
                    "{n}, {axis}: {largest} {least}"
                );
                let mut places: Vec<u32> = members.iter().map(|member| member.place).collect();
                places.sort_unstable();
                assert!(places.into_iter().eq(0..n as u32), "{n}");
            }
        }
    }
}
