//! Collisions: what becomes of bodies that touched, by a law that the scene chooses: they merge, bounce, or break.
//!
//! In every outcome mass, momentum, centre of mass and angular momentum, spins included, are kept; energy about the pair's centre of mass
//! that is gone is told with the event (it may be negative: what holds a body together is not in the books). Merged bodies and pieces
//! have the bulk density of what they are from (R^3 = R_i^3 + R_j^3) and its mixture of materials, body for body: mantles are not
//! stripped first. Impacts are done in the order of time, then ids. Bodies that overlap and recede merge, or are left alone. A body
//! without mass that touches another only merges or bounces; points touch bodies, not each other.

mod impact;
mod products;
mod queue;
pub mod regime;
mod shares;
mod star;

use std::cmp::Ordering;

use crate::bodies::Bodies;
use crate::encounters::Encounter;
use crate::points::{Columns, Vec3};

pub use impact::Field;
use impact::{Impact, impact};
pub use products::Restitution;
use products::{Origin, Product};
use queue::Queue;
pub use regime::Strength;
use regime::{Meeting, Regime};
pub use shares::Limits;
pub use star::accrete;

/// What happens when bodies touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    Merge,
    Bounce(Restitution),
    Fragment(Strength, Limits),
}

/// What happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Accretion,
    Merger,
    Bounce,
    GrazeAndMerge,
    HitAndRun,
    /// A hit-and-run that broke the lighter body.
    ErosiveHitAndRun,
    PartialAccretion,
    Erosion,
    SuperCatastrophic,
}

impl Kind {
    pub fn name(self) -> &'static str {
        match self {
            Self::Accretion => "accretion",
            Self::Merger => "merger",
            Self::Bounce => "bounce",
            Self::GrazeAndMerge => "graze-and-merge",
            Self::HitAndRun => "hit-and-run",
            Self::ErosiveHitAndRun => "erosive-hit-and-run",
            Self::PartialAccretion => "partial-accretion",
            Self::Erosion => "erosion",
            Self::SuperCatastrophic => "super-catastrophic",
        }
    }
}

/// An event between two bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collision {
    pub time: f64,
    pub kind: Kind,
    /// Who keeps its identity, and the other, which is there still after a bounce or a hit-and-run.
    pub id_kept: u64,
    pub id_lost: u64,
    /// Masses before the impact.
    pub mass_kept: f64,
    pub mass_lost: f64,
    /// Mass of the largest body after it, and number of new bodies.
    pub mass_largest: f64,
    pub fragments: usize,
    /// Centre of mass at the touch.
    pub position: Vec3,
    /// Impact speed in units of the pair's escape speed; infinite for massless pairs.
    pub speed: f64,
    /// 0 head-on, pi/2 grazing.
    pub angle: f64,
    /// Kinetic and mutual potential energy about the centre of mass that the products have no longer.
    pub energy_lost: f64,
}

/// What a round of collisions did: who stays (for `retain`), and the events in their order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    pub keep: Vec<bool>,
    pub events: Vec<Collision>,
}

/// Does what `law` says to the pairs of `encounters`. Bodies to be removed stay in place, marked in `keep`; new ones are appended, with ids
/// from `next_id` on.
pub fn collide(
    bodies: &mut Bodies,
    encounters: &[Encounter],
    law: &Law,
    field: &Field,
    next_id: &mut u64,
) -> Outcome {
    let mut outcome = Outcome {
        keep: vec![true; bodies.x.len()],
        events: Vec::new(),
    };
    if encounters.is_empty() {
        return outcome;
    }
    let mut queue = Queue::new(bodies, encounters);
    while let Some(encounter) = queue.next() {
        let impact = impact(bodies, encounter, field);
        if *law != Law::Merge && impact.recedes() {
            continue;
        }
        let (kind, products) = law.products(&impact);
        let mut event = collision(bodies, &impact, kind, &products, field.now - encounter.held);
        let places = place(bodies, &impact, &products, next_id);
        let bond = |k: usize, l: usize| field.bond(bodies, [places[k], places[l]]);
        event.energy_lost = impact.energy() - products::energy(&products, bond);
        outcome.events.push(event);
        if survivors(&products) == 2 {
            queue.part(bodies, &field.domain, impact.place, encounter.time);
        } else {
            outcome.keep[impact.place[1]] = false;
            queue.unite(bodies, &field.domain, impact.place, encounter.time);
        }
    }
    outcome.keep.resize(bodies.x.len(), true);
    outcome
}

/// How many of the pair are among the products.
fn survivors(products: &[Product]) -> usize {
    match products[0].origin {
        Origin::Both => 1,
        Origin::First | Origin::Second => 2,
    }
}

impl Law {
    fn products(&self, impact: &Impact) -> (Kind, Vec<Product>) {
        match self {
            Self::Bounce(restitution) => (Kind::Bounce, products::rebound(impact, restitution)),
            Self::Fragment(strength, limits) if impact.reduced() > 0.0 => {
                broken(impact, strength, limits)
            }
            Self::Fragment(..) | Self::Merge => (Kind::Merger, products::merged(impact)),
        }
    }
}

/// The outcome by the scaling laws.
fn broken(impact: &Impact, strength: &Strength, limits: &Limits) -> (Kind, Vec<Product>) {
    // The heavier is the target, whoever keeps its identity.
    let small = usize::from(impact.m[1] <= impact.m[0]);
    let order = [1 - small, small];
    let meeting = Meeting {
        g: impact.g,
        m: order.map(|k| impact.m[k]),
        radius: order.map(|k| impact.radius[k]),
        speed: impact.speed(),
        sine: impact.sine(),
    };
    let verdict = meeting.verdict(strength);
    let kind = match verdict.regime {
        Regime::Merging => return (Kind::Merger, products::merged(impact)),
        Regime::GrazeAndMerge => return (Kind::GrazeAndMerge, products::merged(impact)),
        Regime::HitAndRun => {
            let own = impact.m[small];
            let pieces = shares::shares(own, meeting.projectile_remnant(strength), limits);
            return if pieces.len() > 1 {
                let products = products::eroded(impact, small, &pieces);
                (Kind::ErosiveHitAndRun, products)
            } else {
                (Kind::HitAndRun, products::passed(impact))
            };
        }
        Regime::PartialAccretion => Kind::PartialAccretion,
        Regime::Erosion => Kind::Erosion,
        Regime::SuperCatastrophic => Kind::SuperCatastrophic,
    };
    let total = impact.total();
    let pieces = shares::shares(total, verdict.largest * total, limits);
    let products = if pieces.len() > 1 {
        products::shattered(impact, &pieces)
    } else {
        products::merged(impact)
    };
    (kind, products)
}

/// The event of an impact, but for its energy.
fn collision(
    bodies: &Bodies,
    impact: &Impact,
    kind: Kind,
    products: &[Product],
    now: f64,
) -> Collision {
    let [kept, lost] = impact.place;
    let escape = impact.escape();
    let centre = bodies.x[kept] + impact.d * impact.share();
    let drift = bodies.v[kept] + impact.w * impact.share();
    Collision {
        time: now - impact.since,
        kind,
        id_kept: bodies.id[kept],
        id_lost: bodies.id[lost],
        mass_kept: impact.m[0],
        mass_lost: impact.m[1],
        mass_largest: products.iter().map(|p| p.m).fold(0.0, f64::max),
        fragments: products.len() - survivors(products),
        position: centre - drift * impact.since,
        speed: if escape > 0.0 {
            impact.speed() / escape
        } else {
            f64::INFINITY
        },
        angle: impact.sine().asin(),
        energy_lost: 0.0,
    }
}

/// Puts the products where the pair was; answers their places.
fn place(
    bodies: &mut Bodies,
    impact: &Impact,
    products: &[Product],
    next_id: &mut u64,
) -> Vec<usize> {
    let [kept, lost] = impact.place;
    let share = impact.share();
    let centre = bodies.x[kept] + impact.d * share;
    let drift = bodies.v[kept] + impact.w * share;
    let a = bodies.a[kept] + (bodies.a[lost] - bodies.a[kept]) * share;
    let mixtures = mixtures(bodies, impact);
    let softening = bodies.softening[kept].max(bodies.softening[lost]);
    let (first, survivors) = (bodies.x.len(), survivors(products));
    let mut places = impact.place[..survivors].to_vec();
    places.extend(first..first + products.len() - survivors);
    bodies.resize(first + products.len() - survivors);
    for (product, &i) in products.iter().zip(&places) {
        bodies.x[i] = centre + product.x;
        bodies.v[i] = drift + product.v;
        bodies.m[i] = product.m;
        bodies.radius[i] = product.radius;
        bodies.spin[i] = product.spin;
        if survivors == 1 || i >= first {
            bodies.a[i] = a;
            bodies.softening[i] = softening;
        }
        if let Some(mixture) = mixtures {
            bodies.composition[i] = mixture[product.origin as usize];
        }
        if i >= first {
            bodies.id[i] = *next_id;
            if let Some(&h) = bodies.h.get(kept) {
                bodies.h[i] = h;
            }
            *next_id += 1;
        }
    }
    places
}

/// What both together, the first and the second are made of; none if the bodies' materials are not followed.
fn mixtures(bodies: &Bodies, impact: &Impact) -> Option<[Vec3; 3]> {
    let [first, second] = impact.place;
    let (one, other) = (
        *bodies.composition.get(first)?,
        *bodies.composition.get(second)?,
    );
    Some([one + (other - one) * impact.share(), one, other])
}

/// Whether body i keeps its identity before j: planets before planetesimals, then the heavier, then the smaller id.
fn outranks(bodies: &Bodies, i: usize, j: usize) -> bool {
    let planet = |i: usize| bodies.kind[i] == crate::Kind::Planet as u32;
    let order = planet(i)
        .cmp(&planet(j))
        .then(bodies.m[i].total_cmp(&bodies.m[j]))
        .then(bodies.id[j].cmp(&bodies.id[i]));
    order == Ordering::Greater
}

#[cfg(test)]
mod tests;
