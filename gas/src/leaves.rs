//! Leaves between the ticks at which somebody looks at them: their particles stay where they were last seen, and the leaf bounds where
//! they are by now.
//!
//! x(t) = x + (t - t_seen) v,   lo + (t - t_seen) min v <= x(t) <= hi + (t - t_seen) max v
//! h(t) <= max h exp((t - t_seen) max div v / d)
//!
//! A particle moves on a straight line from kick to kick, and whoever is kicked has been seen: the bounds hold to the last bit, since
//! rounding keeps order. What a tick costs then follows the particles that it looks at.

use std::ops::Range;

use nbody::points::sort::BITS;
use nbody::points::sum::Parts;
use nbody::points::tree::Node;
use nbody::points::{Clock, Domain, Vec3};
use rayon::prelude::*;

use crate::field::Pulls;
use crate::{Derived, Gas, Particles, Rates};

/// The tick of gas that is new: it stands where it stands at the first tick that it is asked for.
pub(crate) const UNSEEN: u32 = u32::MAX;

/// Leaves a task.
pub(crate) const FEW: usize = 16;

/// What bounds the particles of a leaf; `lo`, `hi` and `h` when they were last moved.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Leaf {
    seen: u32,
    lo: Vec3,
    hi: Vec3,
    slow: Vec3,
    fast: Vec3,
    h: f64,
    /// Largest divergence of the velocity, if positive.
    swelling: f64,
    /// The size that the leaf has when it is sorted.
    fresh: f64,
}

impl Leaf {
    fn of(gas: &Columns, domain: &Domain, node: &Node, seen: u32) -> Self {
        let lowest = Vec3::repeat(f64::INFINITY);
        let mut leaf = Self {
            seen,
            lo: lowest,
            hi: -lowest,
            slow: lowest,
            fast: -lowest,
            h: 0.0,
            swelling: 0.0,
            fresh: 0.0,
        };
        for i in node.range() {
            let v = domain.in_plane(gas.v[i]);
            (leaf.slow, leaf.fast) = (leaf.slow.inf(&v), leaf.fast.sup(&v));
            leaf.swelling = leaf.swelling.max(gas.div_v[i]);
            leaf.meet(gas.x[i], gas.h[i]);
        }
        leaf
    }

    fn meet(&mut self, x: Vec3, h: f64) {
        (self.lo, self.hi) = (self.lo.inf(&x), self.hi.sup(&x));
        self.h = self.h.max(h);
    }

    fn elapsed(&self, clock: &Clock) -> f64 {
        if self.seen == UNSEEN {
            return 0.0;
        }
        (f64::from(clock.tick) - f64::from(self.seen)) * clock.unit()
    }

    /// The box that holds all particles now.
    pub fn span(&self, clock: &Clock) -> (Vec3, Vec3) {
        let dt = self.elapsed(clock);
        (self.lo + dt * self.slow, self.hi + dt * self.fast)
    }

    /// What the leaf's particles cost more than when they were sorted, at supports of `reach`, in particles that meet their neighbours.
    pub fn waste(&self, node: &Node, reach: f64, dimensions: usize) -> f64 {
        let now = (node.hi - node.lo).norm() + 2.0 * reach;
        let growth = now / (self.fresh + 2.0 * reach);
        node.count() as f64 * (growth.powi(dimensions as i32) - 1.0).max(0.0)
    }

    /// A bound of the smoothing lengths now.
    pub fn largest_h(&self, clock: &Clock, dimensions: usize) -> f64 {
        let growth = self.swelling * self.elapsed(clock) / dimensions as f64;
        // A hair more, for what rounding adds.
        self.h * (growth.exp() * (1.0 + 1e-12))
    }
}

/// What bounds follow from.
struct Columns<'a> {
    x: &'a [Vec3],
    v: &'a [Vec3],
    h: &'a [f64],
    div_v: &'a [f64],
}

/// The columns that a drift changes, and those that it follows.
struct Drift<'a> {
    domain: &'a Domain,
    x: Parts<'a, Vec3>,
    v_pred: Parts<'a, Vec3>,
    h: Parts<'a, f64>,
    rho: Parts<'a, f64>,
    u: Parts<'a, f64>,
    v: &'a [Vec3],
    hydro: &'a [Vec3],
    pulls: Pulls<'a>,
    div_v: &'a [f64],
    du: &'a [f64],
}

impl<'a> Drift<'a> {
    fn new(
        domain: &'a Domain,
        particles: &'a mut Particles,
        derived: &'a mut Derived,
        rates: &'a mut Rates,
    ) -> Self {
        Self {
            domain,
            x: Parts::new(&mut particles.x),
            v_pred: Parts::new(&mut rates.v_pred),
            h: Parts::new(&mut particles.h),
            rho: Parts::new(&mut derived.rho),
            u: Parts::new(&mut rates.u_pred),
            v: &particles.v,
            hydro: &rates.hydro,
            pulls: Pulls {
                gravity: &rates.gravity,
                field: &rates.field,
            },
            div_v: &derived.div_v,
            du: &rates.du,
        }
    }

    /// Moves the particles of a leaf by `dt`, and predicts what is seen of them; `leaf` then holds them tightly.
    ///
    /// # Safety
    /// Nobody else may touch the particles of `node` meanwhile.
    unsafe fn drift(&self, dt: f64, node: &Node, leaf: &mut Leaf) {
        let range = node.range();
        // SAFETY: promised by the caller.
        let (x, v_pred, h, rho, u) = unsafe {
            (
                self.x.part(range.clone()),
                self.v_pred.part(range.clone()),
                self.h.part(range.clone()),
                self.rho.part(range.clone()),
                self.u.part(range.clone()),
            )
        };
        let d = self.domain.dimensions() as i32;
        let frame = self.domain.hill().map(|hill| (hill, hill.turn(dt)));
        leaf.lo = Vec3::repeat(f64::INFINITY);
        leaf.hi = -leaf.lo;
        leaf.h = 0.0;
        for (k, i) in range.enumerate() {
            let relative = self.domain.relative(x[k], v_pred[k]);
            x[k] += dt * self.domain.in_plane(self.v[i]);
            v_pred[k] = match frame {
                None => relative,
                Some((hill, turn)) => turn.of(relative) + Vec3::y() * hill.stream(x[k]),
            };
            v_pred[k] += dt * (self.hydro[i] + self.pulls.of(i));
            let stretch = (self.div_v[i] * dt / f64::from(d)).exp();
            h[k] *= stretch;
            rho[k] /= stretch.powi(d);
            let du = self.du[i];
            // Cooling as a decay: of the same first order, and positive.
            u[k] = if du < 0.0 {
                u[k] * (du * dt / u[k]).exp()
            } else {
                u[k] + du * dt
            };
            leaf.meet(x[k], h[k]);
        }
    }
}

impl Gas {
    /// Takes all particles as standing where they are at the tick that was last asked for, and bounds them anew.
    pub(crate) fn bound(&mut self) {
        self.leaves.resize(self.tree.nodes.len(), Leaf::default());
        let (columns, seen) = (columns(&self.particles, &self.derived), self.now);
        // Of a domain of two dimensions these bounds are wide along the third axis until the first tick.
        let side = self.cube.map_or(f64::INFINITY, |cube| cube.side);
        let cell = |range: Range<usize>| match &self.curve.keys[range] {
            [first, .., last] => side * diagonal(first ^ last),
            _ => 0.0,
        };
        let (nodes, leaves) = (&self.tree.nodes, Parts::new(&mut self.leaves));
        (self.tree.leaves.par_iter())
            .with_min_len(FEW)
            .for_each(|&at| {
                let at = at as usize;
                let mut leaf = Leaf::of(&columns, &Domain::open(), &nodes[at], seen);
                leaf.fresh = (leaf.hi - leaf.lo).norm().min(cell(nodes[at].range()));
                // SAFETY: each leaf is listed once.
                unsafe { leaves.part(at..at + 1)[0] = leaf };
            });
    }

    /// Bounds the particles near the active ones anew; they stand at the tick of `clock`.
    pub(crate) fn bound_near(&mut self, domain: &Domain, clock: &Clock) {
        let columns = columns(&self.particles, &self.derived);
        let (nodes, leaves) = (&self.tree.nodes, Parts::new(&mut self.leaves));
        let near = self.vicinity.near.par_iter().with_min_len(FEW);
        near.for_each(|&at| {
            let at = at as usize;
            // SAFETY: each leaf is listed once.
            let leaf = &mut unsafe { leaves.part(at..at + 1) }[0];
            let fresh = leaf.fresh;
            *leaf = Leaf::of(&columns, domain, &nodes[at], clock.tick);
            leaf.fresh = fresh;
        });
    }

    /// Moves all gas to the tick of `clock`, and predicts what is seen of it.
    ///
    /// Positions leave the box of a closed domain until [`Gas::refit`] brings them back.
    pub fn arrive(&mut self, domain: &Domain, clock: &Clock) {
        let all = std::mem::take(&mut self.tree.leaves);
        self.arrive_in(&all, domain, clock);
        self.tree.leaves = all;
        self.now = clock.tick;
    }

    /// Moves the particles of the leaves `which` to the tick of `clock`.
    pub(crate) fn arrive_in(&mut self, which: &[u32], domain: &Domain, clock: &Clock) {
        let drift = Drift::new(
            domain,
            &mut self.particles,
            &mut self.derived,
            &mut self.rates,
        );
        let (nodes, leaves) = (
            Parts::new(&mut self.tree.nodes),
            Parts::new(&mut self.leaves),
        );
        which.par_iter().with_min_len(FEW).for_each(|&at| {
            let own = at as usize..at as usize + 1;
            // SAFETY: each leaf is listed once, and no two leaves have particles in common.
            let (node, leaf) =
                unsafe { (&mut nodes.part(own.clone())[0], &mut leaves.part(own)[0]) };
            let dt = leaf.elapsed(clock);
            if dt != 0.0 {
                // SAFETY: as above.
                unsafe { drift.drift(dt, node, leaf) };
                (node.lo, node.hi) = (leaf.lo, leaf.hi);
            }
            leaf.seen = clock.tick;
        });
    }

    /// Brings to the tick of `clock` the leaves that may hold gas within `radius` of `centre`, and adds their particles to `places`.
    pub fn arrive_near(
        &mut self,
        (centre, radius): (Vec3, f64),
        domain: &Domain,
        clock: &Clock,
        places: &mut Vec<usize>,
    ) {
        let mut near = std::mem::take(&mut self.nearby);
        near.clear();
        near.extend(self.tree.leaves.iter().copied().filter(|&at| {
            let (lo, hi) = self.leaves[at as usize].span(clock);
            let gap = (lo - centre).sup(&(centre - hi)).sup(&Vec3::zeros());
            gap.norm_squared() < radius * radius
        }));
        self.arrive_in(&near, domain, clock);
        let nodes = &self.tree.nodes;
        places.extend(near.iter().flat_map(|&at| nodes[at as usize].range()));
        self.nearby = near;
    }
}

/// Diagonal of the smallest cell that holds keys which differ in no bits above those of `differ`, in sides of the curve's cube.
fn diagonal(differ: u64) -> f64 {
    let doublings = (64 - differ.leading_zeros()).div_ceil(3);
    3f64.sqrt() * f64::from(doublings).exp2() / f64::from(1u32 << BITS)
}

fn columns<'a>(particles: &'a Particles, derived: &'a Derived) -> Columns<'a> {
    Columns {
        x: &particles.x,
        v: &particles.v,
        h: &particles.h,
        div_v: &derived.div_v,
    }
}
