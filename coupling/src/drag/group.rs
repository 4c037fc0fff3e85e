//! Group: a run of immersed particles close enough to share their candidates.

use gas::probe::radius;
use nbody::points::{Domain, Vec3};

use super::Immersed;

/// Most members of a group.
const MOST: usize = 16;

/// Largest extent of a group by the radius of its first member's neighbourhood.
const EXTENT: f64 = 1.5;

/// Ratio of the radii in a group.
const RATIO: f64 = 1.5;

pub struct Group {
    pub lo: Vec3,
    pub hi: Vec3,
    /// Largest radius of a member's neighbourhood; zero for a group of one that has none yet.
    pub radius: f64,
    pub count: usize,
}

impl Group {
    /// The longest group that the list `members` begins with.
    pub fn new<I: Immersed>(immersed: &I, members: &[u32], domain: &Domain) -> Self {
        let own = |i: u32| {
            let i = i as usize;
            (immersed.position(i), radius(domain, immersed.smoothing(i)))
        };
        let (x, first) = own(members[0]);
        let mut group = Self {
            lo: x,
            hi: x,
            radius: first,
            count: 1,
        };
        for &i in members[1..].iter().take(MOST - 1) {
            let (x, radius) = own(i);
            let (lo, hi) = (group.lo.inf(&x), group.hi.sup(&x));
            let near = domain.in_plane(hi - lo).max() <= EXTENT * first;
            let alike = radius < RATIO * first && first < RATIO * radius;
            if !(near && alike) {
                break;
            }
            (group.lo, group.hi) = (lo, hi);
            group.radius = group.radius.max(radius);
            group.count += 1;
        }
        group
    }
}
