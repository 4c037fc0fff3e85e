//! Velocities followed linearly to the middle of a pair, so that the viscosity sees what a linear flow does not account for.
//!
//! a = v_ij . r_ij,   s_i = r_ij . V_i r_ij: the approach that the flow about i makes it expect
//! v_ij . r_ij -> min(0, max(a, a - minmod(s_i, s_j)))
//!
//! with V linear-exact. Gas that converges evenly has a = s_i = s_j and no viscosity at all, however fast; in a shock the flow is steep
//! on one side alone and nearly all of the approach is left. What is left never exceeds the approach: viscosity heats as without.
//! Sources: Frontiere, Raskin & Owen (2017), JCP 332, 160; Rosswog (2020), MNRAS 498, 4230 (both with van Leer's limiter, which
//! is less strict than minmod, the smaller of two slopes of one sign; Sod's and Noh's errors do not gain by it).

use fearless_simd::{Simd, SimdBase};

use crate::lanes::{Lanes, Real, same};

/// How the viscosity takes the velocities of a pair.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Reconstruction {
    /// As they are.
    #[default]
    None,
    /// Followed linearly to the middle of the pair.
    Linear,
}

/// The approach that is left of `approach` where the flow about both members makes them expect these.
#[inline(always)]
pub fn left<S: Simd, E: Real>(
    simd: S,
    approach: Lanes<S, E>,
    [a, b]: [Lanes<S, E>; 2],
) -> Lanes<S, E> {
    let zero = same::<S, E>(simd, 0.0);
    let minmod = a.min(b).max(zero) + a.max(b).min(zero);
    approach.max(approach - minmod)
}
