//! Sums and loops whose result does not depend on the number of threads.

use std::marker::PhantomData;
use std::ops::{Add, Range};

/// Particles a task of a parallel loop.
pub const CHUNK: usize = 2048;

/// Sum of `part` over fixed chunks of 0..n, combined in a fixed order.
///
/// `part` returns the sum over its range. The same bits come out for any number of threads.
pub fn ordered<T: Add<Output = T> + Send>(
    n: usize,
    zero: T,
    part: impl Fn(Range<usize>) -> T + Sync,
) -> T {
    ordered_by(CHUNK, n, zero, part)
}

/// [`ordered`] in chunks of `chunk`, for what takes longer than a particle.
pub fn ordered_by<T: Add<Output = T> + Send>(
    chunk: usize,
    n: usize,
    zero: T,
    part: impl Fn(Range<usize>) -> T + Sync,
) -> T {
    let chunks = n.div_ceil(chunk);
    if chunks == 0 {
        return zero;
    }
    let of_chunk = |c: usize| part(c * chunk..((c + 1) * chunk).min(n));
    zero + halves(0..chunks, &of_chunk)
}

/// Sum over chunks, as the sum of the sums of both halves: without a buffer, and in a fixed order.
fn halves<T: Add<Output = T> + Send>(
    chunks: Range<usize>,
    of_chunk: &(impl Fn(usize) -> T + Sync),
) -> T {
    if chunks.len() == 1 {
        return of_chunk(chunks.start);
    }
    let middle = chunks.start + chunks.len() / 2;
    let (a, b) = rayon::join(
        || halves(chunks.start..middle, of_chunk),
        || halves(middle..chunks.end, of_chunk),
    );
    a + b
}

/// A slice that tasks write to in parallel, each in ranges of its own.
///
/// Sweeps go over leaves; each leaf owns a range of particles, the ranges are disjoint.
#[derive(Clone, Copy)]
pub struct Parts<'a, T> {
    start: *mut T,
    len: usize,
    life: PhantomData<&'a mut [T]>,
}

// SAFETY: `Parts` hands out ranges of a slice that is exclusively borrowed for 'a; the caller of `part` promises that ranges in
// use at one time do not overlap, so no two threads reach the same element.
unsafe impl<T: Send> Sync for Parts<'_, T> {}
// SAFETY: as above.
unsafe impl<T: Send> Send for Parts<'_, T> {}

impl<'a, T> Parts<'a, T> {
    pub fn new(slice: &'a mut [T]) -> Self {
        Self {
            start: slice.as_mut_ptr(),
            len: slice.len(),
            life: PhantomData,
        }
    }

    /// The elements of `range`.
    ///
    /// # Safety
    /// No other part in use at the same time may overlap `range`.
    #[allow(clippy::mut_from_ref)] // exclusive by the caller's promise
    pub unsafe fn part(&self, range: Range<usize>) -> &'a mut [T] {
        assert!(
            range.start <= range.end && range.end <= self.len,
            "a part lies inside its slice"
        );
        // SAFETY: inside the slice by the assertion; exclusive by the caller's promise.
        unsafe { std::slice::from_raw_parts_mut(self.start.add(range.start), range.len()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sum_has_the_same_bits_for_any_number_of_threads() {
        let values: Vec<f64> = (0..100_000)
            .map(|i| (f64::from(i) * 0.7).sin() * 10f64.powi(i % 17))
            .collect();
        let sum = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("a thread pool");
            pool.install(|| ordered(values.len(), 0.0, |range| values[range].iter().sum::<f64>()))
        };
        let one = sum(1);
        assert!(
            [2, 3, 7]
                .into_iter()
                .all(|threads| sum(threads).to_bits() == one.to_bits())
        );
        let plain: f64 = values.iter().sum();
        assert!(((one - plain) / plain).abs() < 1e-12);
    }
}
