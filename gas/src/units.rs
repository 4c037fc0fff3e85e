//! Units of a sweep: powers of two that bring lengths, velocities and masses near one, and the grid that coordinates lie on.
//!
//! The grid is the same for all leaves, and what lies on it has the same separation from wherever it is seen: both members of a pair
//! compute the same force to the last bit. Along a periodic axis the period is a whole number of steps. A leaf whose neighbours lie
//! too far apart for whole numbers takes a coarser grid of its own.

use nbody::points::{Domain, Tree, Vec3, sum};

use crate::Hydro;

/// Steps of the grid in the smallest smoothing length: as fine as f32 at distances of a few smoothing lengths.
const FINENESS: f64 = (1 << 21) as f64;

/// Steps of velocity in the largest one.
const SPEEDS: f64 = (1 << 30) as f64;

/// Code units a unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    pub length: f64,
    pub velocity: f64,
    pub mass: f64,
    /// Steps of the grid, lengths along the axes.
    pub step: Vec3,
    /// Step of velocities.
    pub velocity_step: f64,
    /// -dv_y/dx of the shear that velocities are relative to, units of velocity by units of length.
    pub shear: f64,
}

/// What the units follow from.
#[derive(Clone, Copy)]
struct Sizes {
    number: usize,
    h: f64,
    least_h: f64,
    m: f64,
    speed: f64,
    cs: f64,
}

const NONE: Sizes = Sizes {
    number: 0,
    h: 0.0,
    least_h: f64::INFINITY,
    m: 0.0,
    speed: 0.0,
    cs: 0.0,
};

impl std::ops::Add for Sizes {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            number: self.number + other.number,
            h: self.h + other.h,
            least_h: self.least_h.min(other.least_h),
            m: self.m + other.m,
            speed: self.speed.max(other.speed),
            cs: self.cs.max(other.cs),
        }
    }
}

impl Units {
    /// Units for the particles of some leaves: of smoothing lengths `h` (zero if not known), masses `m`, velocities `v` (relative to the shear,
    /// if there is one), sound speeds `cs`.
    pub fn new(
        hydro: &Hydro,
        (tree, leaves): (&Tree, &[u32]),
        h: &[f64],
        m: &[f64],
        v: impl Fn(usize) -> Vec3 + Sync,
        cs: &[f64],
    ) -> Self {
        let one = |i: usize| Sizes {
            number: 1,
            h: h[i],
            least_h: if h[i] > 0.0 { h[i] } else { f64::INFINITY },
            m: m[i],
            speed: v(i).amax(),
            cs: cs[i],
        };
        let sizes = sum::ordered(leaves.len(), NONE, |range| {
            leaves[range].iter().fold(NONE, |sizes, &leaf| {
                let range = tree.nodes[leaf as usize].range();
                range.fold(sizes, |sizes, i| sizes + one(i))
            })
        });
        let n = sizes.number;
        let length = if sizes.h > 0.0 {
            hydro.support() * sizes.h / n as f64
        } else {
            // Nothing is known yet: what is between particles that fill their box.
            let side = hydro
                .domain
                .in_plane(tree.nodes[0].hi - tree.nodes[0].lo)
                .norm();
            side / (n as f64).powf(1.0 / hydro.dimensions() as f64)
        };
        let length = power_of_two(length);
        let least_h = if sizes.least_h.is_finite() {
            sizes.least_h
        } else {
            length
        };
        let across = hydro.domain.shear_rate() * length;
        let velocity = power_of_two(sizes.speed.max(sizes.cs).max(across));
        Self {
            length,
            velocity,
            mass: power_of_two(sizes.m / n as f64),
            step: grid(&hydro.domain, power_of_two(least_h / FINENESS)),
            velocity_step: power_of_two(sizes.speed) * (2.0 / SPEEDS),
            shear: across / velocity,
        }
    }
}

/// Steps of about `step` along the axes.
fn grid(domain: &Domain, step: f64) -> Vec3 {
    Vec3::from_fn(|axis, _| {
        let period = domain.period(axis);
        if period > 0.0 {
            period / power_of_two(period / step)
        } else {
            step
        }
    })
}

/// The power of two at or below `size`; one if that is none.
fn power_of_two(size: f64) -> f64 {
    if size > 0.0 && size.is_finite() {
        size.log2().floor().clamp(-900.0, 900.0).exp2()
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_powers_of_two_and_divide_the_period() {
        let period = Vec3::new(1.0, 0.37, 11.0);
        let step = grid(&Domain::periodic(period), 2f64.powi(-20));
        for axis in 0..3 {
            let steps = period[axis] / step[axis];
            assert_eq!(steps, steps.round());
            assert!((0.99..2.0).contains(&(step[axis] * 2f64.powi(20))));
        }
        let open = grid(&Domain::open(), 2f64.powi(-20));
        assert_eq!(open, Vec3::repeat(2f64.powi(-20)));
        assert_eq!(power_of_two(0.3), 0.25);
        assert_eq!(power_of_two(0.0), 1.0);
    }
}
