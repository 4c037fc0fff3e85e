//! Kinds: grains of several stopping times in one gas, whose exchange is exact in uniform fields, too.
//!
//! A row relaxes as if all that loads the gas around it had its own slip u and its own number of e-foldings x (half step by stopping time). What
//! others do differently is added here. At a gas particle kind k has the load S_k = sum |w| m / m_j, the mean slip u_k, the mean kick f_k relative to
//! the gas and the mean x_k. With exp(y) - 1 = y phi(y), phi(y) = sum_p r_p / (y - z_p) for y < 0, the change of such gas over the half step is the sum
//! over p of r_p G_p,
//!     G_p = -sum_k c_k S_k (u_k + f_k / z_p) / (1 + sum_k c_k S_k),   c_k = x_k / (x_k + z_p),
//! which solves a resolvent of the mixture in closed form, and a grain of kind k follows it by c_k G_p. From both is taken what they would be were
//! all like k. Kinds are stopping times within a factor of two, of grains and of bodies each; the stiffest and the loosest are one each. What gives no
//! gas more than a small part of what it has in a half step makes no kind: grains beside planetesimals that hardly push the gas cost what they cost alone.
//! Loads are sums of |w|, so that no denominator vanishes.
//! The poles: Caratheodory-Fejer approximation of exp on the negative axis of type (14, 14), error 6e-14 (Trefethen, Weideman & Schmelzer 2006, BIT 46, 653).

use nalgebra::Complex;

use super::Both;

/// What a kind has at a gas particle: sums of w m u and |w| m, of w m f and |w| m x.
pub type Sums = Both;

/// Poles in the upper half plane, and twice their residues of phi.
const POLES: [[Complex<f64>; 2]; 7] = [
    [
        Complex::new(5.62317153474907, 1.1940664287035054),
        Complex::new(-16.86906600019298, -32.74970824777925),
    ],
    [
        Complex::new(5.089374564868055, 3.5888160956106345),
        Complex::new(20.766649169514505, 3.2934111397898334),
    ],
    [
        Complex::new(3.993400429645279, 6.004818060147936),
        Complex::new(-4.950213208530579, 4.534654507645974),
    ],
    [
        Complex::new(2.269816525848304, 8.461717806887696),
        Complex::new(-0.006966293637173381, -1.1380997388450373),
    ],
    [
        Complex::new(-0.20872377765454347, 10.991232026342253),
        Complex::new(0.06227298587028484, 0.06730172560041692),
    ],
    [
        Complex::new(-3.7032391601860652, 13.656333463723643),
        Complex::new(-0.0026936592713571092, -0.0006518716509266902),
    ],
    [
        Complex::new(-8.897735413193399, 16.63093520843589),
        Complex::new(1.700624732022173e-05, -4.954336853423439e-07),
    ],
];

/// Powers of two of e-foldings in a half step between which kinds are told apart.
const LOOSEST: i32 = -16;
const STIFFEST: i32 = 12;

/// Most e-foldings that are told from infinitely many.
pub const LARGEST: f64 = 1e30;

/// The kinds that there are, a bit each: those of grains, and from the middle on those of bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Kinds(u64);

/// Bits of a family.
const FAMILY: i32 = u64::BITS as i32 / 2;

/// Grains, or bodies: they move differently even where the same time stops them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    Grains,
    Bodies,
}

impl Kinds {
    /// That of a member of a family with `x` e-foldings in a half step.
    pub fn of(family: Family, x: f64) -> Self {
        // The exponent of a positive number is the power of two below it.
        let power = (x.to_bits() >> (f64::MANTISSA_DIGITS - 1)) as i32 - (f64::MAX_EXP - 1);
        Self(1 << (power.clamp(LOOSEST, STIFFEST) - LOOSEST + FAMILY * family as i32))
    }

    pub fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    pub fn count(self) -> usize {
        self.0.count_ones() as usize
    }

    /// Whether there are kinds of a family.
    pub fn has(self, family: Family) -> bool {
        self.0 >> (FAMILY * family as i32) & u64::from(u32::MAX) != 0
    }

    /// The number of a kind among these, if it is one of them.
    pub fn number(self, kind: Self) -> Option<usize> {
        let below = (self.0 & (kind.0 - 1)).count_ones() as usize;
        (self.0 & kind.0 != 0).then_some(below)
    }
}

/// From the sums of each kind at a gas particle, by its mass, to what a grain of each does beyond its own relaxation, and what the gas does beyond
/// what such a grain takes it to do: the first and the second three columns.
pub fn respond(kinds: &mut [Sums]) {
    let load: f64 = kinds.iter().map(|sums| sums[3]).sum();
    let gas = POLES.map(|[z, _]| mixture(kinds, z));
    for sums in kinds.iter_mut().filter(|sums| sums[3] > 0.0) {
        let mut answer = [0.0; 8];
        for ([z, residue], gas) in POLES.iter().zip(&gas) {
            let c = follows(sums, *z);
            let alike = c * load / ((c * load + 1.0) * sums[3]);
            for axis in 0..3 {
                let beyond = residue * (gas[axis] + alike * pull(sums, *z, axis));
                answer[axis] += (c * beyond).re;
                answer[4 + axis] += beyond.re;
            }
        }
        *sums = answer;
    }
}

/// How a kind follows the gas, c_k, at a pole.
fn follows(sums: &Sums, z: Complex<f64>) -> Complex<f64> {
    let x = sums[7] / sums[3];
    Complex::from(x) / (z + x)
}

/// S_k (u_k + f_k / z) along an axis.
fn pull(sums: &Sums, z: Complex<f64>, axis: usize) -> Complex<f64> {
    Complex::from(sums[4 + axis]) / z + sums[axis]
}

/// G_p of the mixture.
fn mixture(kinds: &[Sums], z: Complex<f64>) -> [Complex<f64>; 3] {
    let (mut pulls, mut resistance) = ([Complex::from(0.0); 3], Complex::from(1.0));
    for sums in kinds.iter().filter(|sums| sums[3] > 0.0) {
        let c = follows(sums, z);
        for (axis, sum) in pulls.iter_mut().enumerate() {
            *sum -= c * pull(sums, z, axis);
        }
        resistance += c * sums[3];
    }
    pulls.map(|sum| sum / resistance)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_poles_make_an_exponential() {
        for x in [1e-12f64, 1e-6, 1e-3, 0.1, 1.0, 3.0, 10.0, 30.0, 1e3, 1e9] {
            let phi: f64 = (POLES.iter())
                .map(|[z, residue]| (residue / (Complex::from(-x) - z)).re)
                .sum();
            let error = phi * x + (-x).exp_m1();
            assert!(error.abs() < 2e-13_f64.min(5e-12 * x), "{x}: {error:e}");
        }
    }

    #[test]
    fn kinds_are_powers_of_two_and_numbered_in_their_order() {
        let own = |x| Kinds::of(Family::Grains, x);
        let kinds = [1e-9, 0.3, 0.4, 5.0, 1e9, f64::INFINITY].map(own);
        let all = kinds.into_iter().fold(Kinds::default(), Kinds::with);
        let numbers = kinds.map(|kind| all.number(kind));
        assert_eq!(numbers, [0, 1, 1, 2, 3, 3].map(Some));
        assert_eq!(all.count(), 4);
        assert_eq!(all.number(own(1.0)), None);
        // Bodies that the same times stop come after all grains.
        let bodies = [1e-9, f64::INFINITY].map(|x| Kinds::of(Family::Bodies, x));
        assert_eq!(bodies.map(|kind| all.number(kind)), [None; 2]);
        let both = bodies.into_iter().fold(all, Kinds::with);
        assert!(both.has(Family::Bodies) && both.has(Family::Grains));
        assert!(all.has(Family::Grains) && !all.has(Family::Bodies));
        assert_eq!(bodies.map(|kind| both.number(kind)), [4, 5].map(Some));
        assert_eq!(own(0.0), kinds[0]);
    }
}
