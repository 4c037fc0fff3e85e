//! The universal functions G0 to G3 of a Kepler orbit: G_k(s) = s^k c_k(beta s^2), c_k Stumpff's.
//!
//! Source: Stumpff (1962); Mikkola & Innanen (1999); Wisdom & Hernandez (2015).

/// G0..G3 at some s, and G1, G2 as large parts less fine ones.
pub struct Universal {
    pub g: [f64; 4],
    large: [f64; 2],
    fine: [f64; 2],
}

/// G0, G1, G2 moved by a small step: Taylor's series to fourth order; to third the energy would grow by 4e-18 a drift.
///
/// The changes go to the fine parts, so that each sum is rounded once: what is added to a rounded G and is below its last digit is
/// lost, and lost the same way at every step of an orbit, by which the energy of a planet would fall by up to 7e-19 a drift.
#[inline]
pub fn shifted(beta: f64, from: &Universal, d: f64) -> [f64; 3] {
    let [g0, g1, ..] = from.g;
    let (b, h, t) = (beta * d, 0.5 * d, d / 3.0);
    let (m0, m1) = (g0 - 0.25 * b * g1, g1 + 0.25 * d * g0);
    let mean = g1 + h * (g0 - t * beta * m1);
    let slope = g0 - 0.5 * b * (g1 + t * m0);
    let g2 = from.large[1] - (from.fine[1] - d * mean);
    [
        1.0 - beta * g2,
        from.large[0] - (from.fine[0] - d * slope),
        g2,
    ]
}

/// G0..G3: G_k(s) = s^k c_k(beta s^2), c_k Stumpff's functions.
///
/// Long arguments are halved until the series converge and doubled back: G1(2h) = 2 G0 G1, G2 = 2 G1^2, G3 = 2 (G3 + G1 G2). This
/// keeps G1^2 = G2 (2 - beta G2), on which the conservation of energy hangs, free of a bias that a rounded sqrt(beta) would bring.
#[inline]
pub fn universal(beta: f64, s: f64) -> Universal {
    let z = beta * s * s;
    if z.abs() < 0.25 {
        return series::<7>(beta, s);
    }
    if z.abs() < 2.5 {
        return series::<10>(beta, s);
    }
    let (mut h, mut doublings) = (0.5 * s, 1);
    while (beta * h * h).abs() >= 2.5 && doublings < 40 {
        h *= 0.5;
        doublings += 1;
    }
    let mut g = series::<10>(beta, h).g;
    for _ in 0..doublings {
        let g2 = 2.0 * g[1] * g[1];
        g = [
            1.0 - beta * g2,
            2.0 * g[0] * g[1],
            g2,
            2.0 * (g[3] + g[1] * g[2]),
        ];
    }
    Universal {
        g,
        large: [g[1], g[2]],
        fine: [0.0; 2],
    }
}

/// G0..G3 by N terms of the series of c2 and c3.
///
/// The leading terms are divided by whole numbers: a rounded 1/6 would push the energy the same way at every step.
#[inline]
fn series<const N: usize>(beta: f64, s: f64) -> Universal {
    let z = beta * s * s;
    let (mut p2, mut p3) = (0.0, 0.0);
    for n in (0..N - 1).rev() {
        p2 = SERIES[2 * n] - z * p2;
        p3 = SERIES[2 * n + 1] - z * p3;
    }
    let s2 = s * s;
    let g3 = s2 * s * (1.0 - z * p3) / 6.0;
    let large = [s, 0.5 * s2];
    let fine = [beta * g3, s2 * (z * p2 / 24.0)];
    let [g1, g2] = [large[0] - fine[0], large[1] - fine[1]];
    Universal {
        g: [1.0 - beta * g2, g1, g2, g3],
        large,
        fine,
    }
}

/// In turn 4!/(2n + 4)! and 3!/(2n + 5)!.
pub const SERIES: [f64; 18] = {
    let mut terms = [1.0; 18];
    let (mut even, mut odd) = (1.0, 20.0);
    let mut n = 0;
    while n < 9 {
        terms[2 * n] = 1.0 / even;
        terms[2 * n + 1] = 1.0 / odd;
        even *= ((2 * n + 5) * (2 * n + 6)) as f64;
        odd *= ((2 * n + 6) * (2 * n + 7)) as f64;
        n += 1;
    }
    terms
};
