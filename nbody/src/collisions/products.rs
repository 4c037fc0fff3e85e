//! Products: what is left of two bodies after an impact, about their centre of mass; the sums of mass, momentum, moment and angular
//! momentum are those before.
//!
//! - Rebound: normal speed e_n of that before, contact point's velocity across e_t of that before; J_t = -(1 - e_t)(2/7) m u_t for spheres
//!   of one density (Richardson 1994, section 2.3). 1 and 1 is elastic and smooth.
//! - Hit-and-run: normal speed 0, tangential at least 1.05 v_esc (Kokubo & Genda 2010, section 2.2).
//! - Fragments begin on a ring about the largest piece in the plane of the impact, clear of each other, and leave it with 1.05 of the
//!   escape speed there (Chambers 2013, section 2), when the step ends.
//!
//! Angular momentum that the orbits do not take is spin: by the radii in two bodies that rub, as one rate of rotation in pieces.

use std::f64::consts::PI;

use super::impact::{Bond, Impact, Way};
use crate::points::Vec3;

/// Speed at which pieces leave, by their escape speed.
const ESCAPE: f64 = 1.05;
/// Room between pieces on their ring.
const CLEARANCE: f64 = 1.1;

/// What a piece is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    Both,
    First,
    Second,
}

/// A body after the impact; position and velocity about the centre of mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Product {
    pub m: f64,
    pub radius: f64,
    pub x: Vec3,
    pub v: Vec3,
    pub spin: Vec3,
    pub origin: Origin,
}

/// Restitution of a rebound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Restitution {
    pub normal: f64,
    pub tangential: f64,
}

fn at_rest(m: f64, radius: f64, origin: Origin) -> Product {
    Product {
        m,
        radius,
        x: Vec3::zeros(),
        v: Vec3::zeros(),
        spin: Vec3::zeros(),
        origin,
    }
}

/// Radius of a piece of mass `m` at the mean density of both.
fn bulk_radius(impact: &Impact, m: f64) -> f64 {
    let volume = impact.radius[0].powi(3) + impact.radius[1].powi(3);
    let part = if impact.total() > 0.0 {
        m / impact.total()
    } else {
        1.0
    };
    (volume * part).cbrt()
}

/// One body of both.
pub fn merged(impact: &Impact) -> Vec<Product> {
    let total = impact.total();
    vec![Product {
        spin: impact.angular_momentum(),
        ..at_rest(total, bulk_radius(impact, total), Origin::Both)
    }]
}

/// Both bodies on a way out, rubbed so that the angular momentum is kept.
fn parted(impact: &Impact, (d, w): Way) -> Vec<Product> {
    let share = impact.share();
    let deficit = (impact.d.cross(&impact.w) - d.cross(&w)) * impact.reduced();
    let body = |k: usize, origin: Origin, part: f64| Product {
        x: d * part,
        v: w * part,
        spin: impact.spin[k] + deficit * (impact.radius[k] / impact.reach()),
        ..at_rest(impact.m[k], impact.radius[k], origin)
    };
    vec![
        body(0, Origin::First, -share),
        body(1, Origin::Second, 1.0 - share),
    ]
}

/// Both bodies after a rebound.
pub fn rebound(impact: &Impact, restitution: &Restitution) -> Vec<Product> {
    // Speed at the equator of a homogeneous sphere: R S/(2/5 m R^2).
    let surface = |k: usize| {
        let inertia = 0.4 * impact.m[k] * impact.radius[k];
        if inertia > 0.0 {
            impact.spin[k] / inertia
        } else {
            Vec3::zeros()
        }
    };
    let across = impact.tangential();
    let rubbing = across - (surface(0) + surface(1)).cross(&impact.n);
    let across = across - rubbing * ((1.0 - restitution.tangential) * 2.0 / 7.0);
    let depth = impact.depth(impact.reach());
    let way = impact.way_out(
        restitution.normal * impact.approach(),
        across,
        depth,
        impact.reach(),
    );
    parted(impact, way)
}

/// The way out of a hit-and-run, to at least `apart`.
fn passing(impact: &Impact, apart: f64) -> Way {
    let across = impact.tangential();
    let least = ESCAPE * impact.escape();
    let across = match across.try_normalize(0.0) {
        Some(side) => side * across.norm().max(least),
        None => side_of(impact.n) * least,
    };
    impact.way_out(0.0, across, impact.true_depth(), apart)
}

/// A direction across `n`.
fn side_of(n: Vec3) -> Vec3 {
    let axis = if n.x.abs() < 0.5 {
        Vec3::x()
    } else {
        Vec3::y()
    };
    n.cross(&axis).normalize()
}

/// Both bodies after a hit-and-run.
pub fn passed(impact: &Impact) -> Vec<Product> {
    parted(impact, passing(impact, impact.reach()))
}

/// Both bodies after a hit-and-run that broke body `k` into `pieces`.
pub fn eroded(impact: &Impact, k: usize, pieces: &[f64]) -> Vec<Product> {
    let origin = [Origin::First, Origin::Second][k];
    let radius = |m: f64| impact.radius[k] * (m / impact.m[k]).cbrt();
    let pieces: Vec<Product> = pieces
        .iter()
        .map(|&m| at_rest(m, radius(m), origin))
        .collect();
    let pieces = ring(pieces, impact);
    let extent = pieces
        .iter()
        .map(|piece| piece.x.norm() + piece.radius)
        .fold(0.0, f64::max);
    let apart = impact.radius[1 - k] + CLEARANCE * extent;
    let mut whole = parted(impact, passing(impact, apart));
    let centre = whole[k];
    let moved = pieces.into_iter().map(|piece| Product {
        x: centre.x + piece.x,
        v: centre.v + piece.v,
        ..piece
    });
    let other = [Origin::Second, Origin::First][k];
    let mut products: Vec<Product> = moved.collect();
    whole.retain(|body| body.origin == other);
    products.splice(1 - k..1 - k, whole);
    spun(products, impact)
}

/// Pieces of both bodies.
pub fn shattered(impact: &Impact, pieces: &[f64]) -> Vec<Product> {
    let pieces = pieces
        .iter()
        .map(|&m| at_rest(m, bulk_radius(impact, m), Origin::Both))
        .collect();
    spun(ring(pieces, impact), impact)
}

/// Sets the pieces after the first on a ring about it, and all of them about their centre of mass.
fn ring(mut pieces: Vec<Product>, impact: &Impact) -> Vec<Product> {
    let number = pieces.len() - 1;
    let total: f64 = pieces.iter().map(|piece| piece.m).sum();
    let largest = pieces[1..].iter().map(|p| p.radius).fold(0.0, f64::max);
    let beside = largest / (PI / number.max(2) as f64).sin();
    let radius = CLEARANCE * impact.reach().max(pieces[0].radius + largest).max(beside);
    // What escapes in truth escapes in the run, whose potential may be softened, or none.
    let escape2 = 2.0 * impact.g * total / radius;
    let pull2 = 2.0 * impact.piece_bond.g * total / radius;
    let softened2 = 2.0 * impact.piece_bond.depth(total, radius, radius);
    let speed = (ESCAPE * ESCAPE * escape2 - pull2 + softened2).sqrt();
    let across = impact.tangential().try_normalize(0.0);
    let across = across.unwrap_or_else(|| side_of(impact.n));
    for (k, piece) in pieces[1..].iter_mut().enumerate() {
        let (sine, cosine) = (2.0 * PI * (k as f64 + 0.5) / number as f64).sin_cos();
        let line = impact.n * cosine + across * sine;
        (piece.x, piece.v) = (line * radius, line * speed);
    }
    let mean = |of: fn(&Product) -> Vec3| {
        pieces
            .iter()
            .fold(Vec3::zeros(), |sum, piece| sum + of(piece) * piece.m)
            / total
    };
    let (x, v) = (mean(|piece| piece.x), mean(|piece| piece.v));
    for piece in &mut pieces {
        piece.x -= x;
        piece.v -= v;
    }
    pieces
}

/// Gives the pieces, as one rate of rotation, the angular momentum that their orbits lack.
fn spun(mut pieces: Vec<Product>, impact: &Impact) -> Vec<Product> {
    let orbits = pieces
        .iter()
        .fold(Vec3::zeros(), |sum, p| sum + p.x.cross(&p.v) * p.m);
    let rest = impact.angular_momentum() - orbits;
    let inertia = |p: &Product| p.m * p.radius * p.radius;
    let whole: f64 = pieces.iter().map(inertia).sum();
    for piece in &mut pieces {
        piece.spin = rest * (inertia(piece) / whole);
    }
    pieces
}

/// Kinetic and mutual potential energy of the products about their centre of mass; `bond` is that between two of them.
pub fn energy(products: &[Product], bond: impl Fn(usize, usize) -> Bond) -> f64 {
    let mut energy = 0.0;
    for (k, one) in products.iter().enumerate() {
        energy += 0.5 * one.m * one.v.norm_squared();
        for (l, other) in products[..k].iter().enumerate() {
            let least = one.radius + other.radius;
            let distance = (one.x - other.x).norm();
            energy -= one.m * bond(l, k).depth(other.m, distance, least);
        }
    }
    energy
}
