//! Tests of the kernels.

use super::super::lanes::Job;
use super::quadrupole::*;
use super::*;
use fearless_simd::Level;

/// One source of each kind at the same place, pulling on one target.
struct Once<'a, E> {
    targets: &'a Targets<E>,
    points: &'a Points<E>,
    quadrupoles: &'a Quadrupoles<E>,
    pulls: &'a mut [Pull],
}

impl<E: Real> Job<E> for Once<'_, E> {
    #[inline(always)]
    fn run<S: Simd, R: Lanes<S, E>>(self, simd: S) {
        let (one, two) = self.pulls.split_at_mut(1);
        let none = E::from_f64(0.0);
        pull_of_points::<S, E, R, true, false>(
            simd,
            self.targets,
            self.points,
            none,
            one,
            &mut [0],
        );
        pull_of_quadrupoles::<S, E, R, true>(simd, self.targets, self.quadrupoles, two);
    }
}

fn block<E: Real, const C: usize>(rows: &[[f64; C]]) -> Block<E, C> {
    let mut block = Block::with_capacity(rows.len());
    block.len = rows.len();
    for (i, row) in rows.iter().enumerate() {
        for (column, &value) in block.columns.iter_mut().zip(row) {
            column[i] = E::from_f64(value);
        }
    }
    block.pad();
    block
}

/// A batch of one quadrupole.
fn batch<E: Real>(row: [f64; 12]) -> Batch<E> {
    let mut batch = Quadrupoles::empty_batch();
    for (column, value) in batch.iter_mut().zip(row) {
        column[0] = E::from_f64(value);
    }
    batch
}

/// Relative error of the quadrupole of a few points at `distance`, in force and potential.
fn truncation<E: Real>(level: Level, distance: f64) -> (f64, f64) {
    let points = [
        [0.5, 0.1, -0.3, 0.04, 0.2],
        [-0.4, 0.3, 0.2, 0.04, 0.3],
        [0.04, -0.22, 0.0, 0.04, 0.5],
    ];
    let mut s = [0.0; 6];
    for [x, y, z, _, m] in points {
        for (s, p) in s.iter_mut().zip([x * x, y * y, z * z, x * y, x * z, y * z]) {
            *s -= 3.0 * m * p;
        }
    }
    let trace = 0.5 * (s[0] + s[1] + s[2]);
    let row = [
        0.0, 0.0, 0.0, 0.04, 1.0, s[0], s[1], s[2], s[3], s[4], s[5], trace,
    ];
    let centre: [f64; 3] = std::array::from_fn(|axis| points.iter().map(|p| p[4] * p[axis]).sum());
    assert!(
        centre.iter().all(|c| c.abs() < 1e-12),
        "the points balance: {centre:?}"
    );
    let mut pulls = [Pull::default(); 2];
    E::run(
        level,
        Once {
            targets: &block(&[[0.48 * distance, -0.6 * distance, 0.64 * distance, 0.01]]),
            points: &block(&points),
            quadrupoles: &Quadrupoles {
                batches: vec![batch(row)],
            },
            pulls: &mut pulls,
        },
    );
    let [exact, far] = pulls;
    let square = |a: [f64; 3]| a.iter().map(|a| a * a).sum::<f64>();
    let error = square(std::array::from_fn(|i| far.a[i] - exact.a[i]));
    (
        (error / square(exact.a)).sqrt(),
        ((far.phi - exact.phi) / exact.phi).abs(),
    )
}

#[test]
fn quadrupoles_leave_a_third_order_error() {
    for level in [Level::new(), Level::baseline()] {
        let (near, far) = (
            truncation::<f64>(level, 8.0),
            truncation::<f64>(level, 16.0),
        );
        assert!(
            (near.0 / far.0).log2() > 2.9 && near.0 < 2e-3,
            "{near:?} {far:?}"
        );
        assert!(
            (near.1 / far.1).log2() > 2.9 && near.1 < 1e-3,
            "{near:?} {far:?}"
        );
        let single = truncation::<f32>(level, 8.0);
        assert!((single.0 - near.0).abs() < 1e-6 && (single.1 - near.1).abs() < 1e-6);
    }
}
