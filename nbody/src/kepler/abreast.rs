//! The Kepler drift of several bodies abreast, a lane each: the usual case, with the scalar drift for every lane that is not usual.
//!
//! The same equations as the scalar drift, solved by a fixed scheme: the series of s in dt, then steps of Danby's fourth order in their
//! expanded form, s += n (1 - a + 2 a^2 - c), n = -miss/d1, a = n d2/(2 d1), c = n^2 d3/(6 d1), until a and c are so small that Taylor's
//! series carries G1 and G2 over the last of them. A lane is usual if (v^2 + mu/r) (dt/r)^2 < 1.2, |beta| s^2 < 1.5 and three
//! evaluations suffice: elliptic or not, moderate steps. What comes out of a lane does not depend on its neighbours.
//! Relative error: a few 1e-16 times the orbit's condition number, as of the scalar drift.
//! Source: Danby (1988); Wisdom & Hernandez (2015).

use std::sync::LazyLock;

use fearless_simd::{Level, Select, Simd, SimdFloat, SimdMask, f64x4, f64x8};

use super::landing::NEAR;
use super::universal::SERIES;
use super::{Refusal, drift};
use crate::points::Vec3;

/// Several f64 abreast.
pub trait Wide<S: Simd>: SimdFloat<S, Element = f64> {}
impl<S: Simd, V: SimdFloat<S, Element = f64>> Wide<S> for V {}

/// The instructions of this machine.
pub static LEVEL: LazyLock<Level> = LazyLock::new(Level::new);

/// Evaluations of Kepler's equation after which a lane is left to the scalar drift.
const EVALUATIONS: usize = 3;
/// Terms of the series of c2 and c3: rounding for |beta| s^2 < 1.5.
const TERMS: usize = 8;
/// 1/6 and what its rounding has lost: a rounded 1/6 would push the energy the same way at every step.
const SIXTH: [f64; 2] = [1.0 / 6.0, f64::EPSILON / 24.0];

/// What a drift adds to positions and velocities, and the lanes for which that holds.
pub struct Change<S: Simd, V: Wide<S>> {
    pub x: [V; 3],
    pub v: [V; 3],
    pub usual: V::Mask,
}

#[inline(always)]
fn dot<S: Simd, V: Wide<S>>(a: [V; 3], b: [V; 3]) -> V {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}

/// Kepler's equation of each lane.
struct Orbits<V> {
    mu: V,
    r0: V,
    eta: V,
    beta: V,
    /// mu - beta r0
    zeta: V,
}

/// The change that a drift by `dt` about masses `mu` makes.
#[inline(always)]
pub fn change<S: Simd, V: Wide<S>>(simd: S, mu: V, dt: f64, x: [V; 3], v: [V; 3]) -> Change<S, V> {
    let r0 = dot::<S, V>(x, x).sqrt();
    let inverse = V::splat(simd, 1.0) / r0;
    let eta = dot::<S, V>(x, v);
    let pull = mu * inverse;
    let beta = pull + pull - dot::<S, V>(v, v);
    let zeta = mu - beta * r0;
    let q = inverse * dt;
    let speed = eta * inverse;
    let wide = (pull * 3.0 - beta) * (q * q);
    let bend = (speed * speed).mul_add(V::splat(simd, 3.0), beta - pull);
    let guess = q * (V::splat(simd, 1.0) - q * (speed * 0.5 - q * SIXTH[0] * bend));
    let orbits = Orbits {
        mu,
        r0,
        eta,
        beta,
        zeta,
    };
    let narrow = wide.simd_lt(V::splat(simd, 1.2));
    let ([g0, g1, g2], found) = orbits.anomaly::<S>(simd, dt, guess, narrow);
    let r = mu.mul_add(g2, eta.mul_add(g1, r0 * g0));
    let (f1, g) = (-(pull * g2), eta.mul_add(g2, r0 * g1));
    let per_r = mu / r;
    let (back, slow) = (per_r * inverse * g1, per_r * g2);
    Change {
        x: std::array::from_fn(|k| v[k].mul_add(g, x[k] * f1)),
        v: std::array::from_fn(|k| -v[k].mul_add(slow, x[k] * back)),
        usual: found & r.simd_gt(r0 * NEAR),
    }
}

impl<V> Orbits<V> {
    /// G0, G1, G2 of the universal anomaly after `dt`, and the lanes in which it was found.
    #[inline(always)]
    fn anomaly<S: Simd>(&self, simd: S, dt: f64, guess: V, narrow: V::Mask) -> ([V; 3], V::Mask)
    where
        V: Wide<S>,
    {
        let Self {
            mu,
            r0,
            eta,
            beta,
            zeta,
        } = *self;
        let below = |a: V, limit: f64| a.abs().simd_lt(V::splat(simd, limit));
        let one = V::splat(simd, 1.0);
        let mut s = guess;
        let mut evaluations = 0;
        loop {
            let here = series(simd, beta, s);
            let g = here.g;
            let d1 = mu.mul_add(g[2], eta.mul_add(g[1], r0 * g[0]));
            let inverse = one / d1;
            let miss = mu.mul_add(
                g[3],
                eta.mul_add(g[2], r0.mul_add(g[1], V::splat(simd, -dt))),
            );
            let d2 = zeta.mul_add(g[1], eta * g[0]);
            let d3 = zeta * g[0] - beta * (eta * g[1]);
            let newton = -(miss * inverse);
            let a = newton * d2 * inverse * 0.5;
            let c = newton * newton * d3 * inverse * SIXTH[0];
            let step = newton * (a.mul_add(a + a - one, one) - c);
            // Each is below 1e-4 of the lengths over which Kepler's equation bends, so that the error of the step is 1e-16.
            let small = below(a, 0.5e-4) & below(c, 1e-9) & below(beta * step * step, 1e-8);
            let found = small & narrow & below(beta * s * s, 1.5);
            evaluations += 1;
            if evaluations == EVALUATIONS || (found | !narrow).all_true() {
                return (shifted(simd, beta, &here, step), found);
            }
            s = found.select(s, s + step);
        }
    }
}

/// G0..G3 at some s, and G1, G2 as large parts less fine ones.
struct Universal<V> {
    g: [V; 4],
    large: [V; 2],
    fine: [V; 2],
}

/// G0, G1, G2 moved by a small step: Taylor's series to fourth order, added to the fine parts as in the scalar drift.
#[inline(always)]
fn shifted<S: Simd, V: Wide<S>>(simd: S, beta: V, from: &Universal<V>, d: V) -> [V; 3] {
    let [g0, g1, ..] = from.g;
    let (b, h, t) = (beta * d, d * 0.5, d * (1.0 / 3.0));
    let quarter = b * 0.25;
    let (m0, m1) = (g0 - quarter * g1, (d * 0.25).mul_add(g0, g1));
    let mean = h.mul_add(g0 - t * (beta * m1), g1);
    let slope = g0 - b * 0.5 * t.mul_add(m0, g1);
    let g2 = from.large[1] - (from.fine[1] - d * mean);
    let g1 = from.large[0] - (from.fine[0] - d * slope);
    [V::splat(simd, 1.0) - beta * g2, g1, g2]
}

/// G0..G3: G_k(s) = s^k c_k(beta s^2), c_k Stumpff's functions, by their series.
#[inline(always)]
fn series<S: Simd, V: Wide<S>>(simd: S, beta: V, s: V) -> Universal<V> {
    let s2 = s * s;
    let z = beta * s2;
    let minus = -z;
    let mut p2 = V::splat(simd, SERIES[2 * TERMS - 2]);
    let mut p3 = V::splat(simd, SERIES[2 * TERMS - 1]);
    for n in (0..TERMS - 1).rev() {
        p2 = minus.mul_add(p2, V::splat(simd, SERIES[2 * n]));
        p3 = minus.mul_add(p3, V::splat(simd, SERIES[2 * n + 1]));
    }
    let [high, low] = SIXTH;
    let fourth = z * p2 * 0.25;
    let fourth = fourth.mul_add(V::splat(simd, high), fourth * low);
    let sixfold = s * s2 * minus.mul_add(p3, V::splat(simd, 1.0));
    let g3 = sixfold.mul_add(V::splat(simd, high), sixfold * low);
    let large = [s, s2 * 0.5];
    let fine = [beta * g3, s2 * fourth];
    let [g1, g2] = [large[0] - fine[0], large[1] - fine[1]];
    Universal {
        g: [V::splat(simd, 1.0) - beta * g2, g1, g2, g3],
        large,
        fine,
    }
}

/// Moves bodies by `dt` along their orbits about one mass at the origin with G times mass `mu` >= 0; tells the first that cannot be moved.
/// The others are moved in any case.
pub fn drift_all(mu: f64, dt: f64, x: &mut [Vec3], v: &mut [Vec3]) -> Result<(), (usize, Refusal)> {
    assert!(mu >= 0.0, "a centre attracts");
    assert_eq!(x.len(), v.len(), "a velocity a body");
    crate::widest!(*LEVEL, simd => every(simd, mu, dt, x, v))
}

#[inline(always)]
fn every<S: Simd>(
    simd: S,
    mu: f64,
    dt: f64,
    x: &mut [Vec3],
    v: &mut [Vec3],
) -> Result<(), (usize, Refusal)> {
    let mut stuck = Ok(());
    for (batch, (x, v)) in x.chunks_mut(8).zip(v.chunks_mut(8)).enumerate() {
        let done = if x.len() > 4 {
            few::<S, f64x8<S>>(simd, mu, dt, x, v)
        } else {
            few::<S, f64x4<S>>(simd, mu, dt, x, v)
        };
        if let (Err((place, refusal)), Ok(())) = (done, stuck) {
            stuck = Err((8 * batch + place, refusal));
        }
    }
    stuck
}

/// As many bodies as there are lanes, or fewer.
#[inline(always)]
fn few<S: Simd, V: Wide<S>>(
    simd: S,
    mu: f64,
    dt: f64,
    x: &mut [Vec3],
    v: &mut [Vec3],
) -> Result<(), (usize, Refusal)> {
    let last = x.len() - 1;
    // Lanes beyond the last body do as it does.
    let of = |set: &[Vec3], axis: usize| V::from_fn(simd, |i| set[i.min(last)][axis]);
    let (start, speed) = (
        [of(x, 0), of(x, 1), of(x, 2)],
        [of(v, 0), of(v, 1), of(v, 2)],
    );
    let change = change::<S, V>(simd, V::splat(simd, mu), dt, start, speed);
    let there: [V; 3] = std::array::from_fn(|k| start[k] + change.x[k]);
    let swift: [V; 3] = std::array::from_fn(|k| speed[k] + change.v[k]);
    let mut stuck = Ok(());
    let all = change.usual.all_true();
    for i in 0..=last {
        if all || change.usual.test(i) {
            x[i] = Vec3::new(there[0][i], there[1][i], there[2][i]);
            v[i] = Vec3::new(swift[0][i], swift[1][i], swift[2][i]);
        } else if let (Err(refusal), Ok(())) = (drift(mu, dt, &mut x[i], &mut v[i]), stuck) {
            stuck = Err((i, refusal));
        }
    }
    stuck
}

#[cfg(test)]
mod tests;
