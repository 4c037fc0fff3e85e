//! Kinds: grains of several stopping times in one gas, whose exchange is exact in uniform fields, too.
//!
//! A row relaxes as if all that loads the gas around it had its own slip and its own number of e-foldings x (half step by stopping time). What others
//! do differently is added: [`super::response`].
//! Kinds are stopping times within a factor of two, of grains and of bodies each; the stiffest and the loosest are one each. What gives no
//! gas more than a small part of what it has in a half step makes no kind: grains beside planetesimals that hardly push the gas cost what they cost alone.

use rayon::prelude::*;

use super::Both;

/// What a kind has at a gas particle: sums of w m u and |w| m, of w m f and |w| m x.
pub type Sums = Both;

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

/// What each kind has at a number of places, where it is there at all.
#[derive(Clone, Debug, Default)]
pub struct ByKind {
    kinds: usize,
    /// of each place the kinds that are there, a bit each
    present: Vec<u64>,
    /// by place, then by kind; without meaning, but finite, where the kind is not there
    sums: Vec<Sums>,
}

impl ByKind {
    /// Makes room for `kinds` kinds at each of `places`; none is there.
    pub fn clear(&mut self, places: usize, kinds: usize) {
        self.kinds = kinds;
        self.present.clear();
        self.present.resize(places, 0);
        self.sums.resize(places * kinds, Sums::default());
    }

    /// The sums of all kinds at a place; those of `added`, a bit each, are there from now on.
    #[inline(always)]
    pub fn with(&mut self, place: usize, added: u64) -> &mut [Sums] {
        let sums = &mut self.sums[place * self.kinds..][..self.kinds];
        let mut fresh = added & !self.present[place];
        self.present[place] |= fresh;
        while fresh != 0 {
            sums[fresh.trailing_zeros() as usize] = Sums::default();
            fresh &= fresh - 1;
        }
        sums
    }

    /// The sums of all kinds at a place.
    #[inline(always)]
    pub fn at(&self, place: usize) -> &[Sums] {
        &self.sums[place * self.kinds..][..self.kinds]
    }

    /// The kinds that are at a place, a bit each.
    pub fn present(&self, place: usize) -> u64 {
        self.present[place]
    }

    /// The kinds that are there, by their numbers.
    pub fn there(&self, place: usize) -> impl Iterator<Item = (usize, &Sums)> {
        let (sums, present) = (self.at(place), self.present[place]);
        numbers(present).map(|kind| (kind, &sums[kind]))
    }

    /// All places from end to end in runs of so many: the sums, by place and kind.
    pub fn runs(&mut self, length: usize) -> impl IndexedParallelIterator<Item = &mut [Sums]> {
        self.sums.par_chunks_mut(length * self.kinds)
    }
}

/// The places of the bits that are set.
pub fn numbers(mut bits: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let first = (bits != 0).then(|| bits.trailing_zeros() as usize);
        bits &= bits.wrapping_sub(1);
        first
    })
}

#[cfg(test)]
mod tests {
    use super::*;

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
