//! Tests of the columns.

use super::*;
use crate::columns;

columns! {
    /// A test set.
    pub struct Set {
        /// ids
        id: Integer = Label::snapshot("ParticleIDs", Dimension::NONE, "id"),
        /// positions
        x: Vector = Label::snapshot("Coordinates", Dimension::LENGTH, "position"),
        /// masses
        m: Real = Label::checkpoint("Masses", Dimension::MASS, "mass"),
        /// kinds
        kind: Short = Label::checkpoint("Kinds", Dimension::NONE, "kind"),
        /// charges, if anybody has one
        q: Real = Label::snapshot("Charges", Dimension::NONE, "charge").optional(),
    }
}

fn three() -> Set {
    Set {
        id: vec![7, 8, 9],
        x: (0..3).map(|i| Vec3::repeat(f64::from(i))).collect(),
        m: vec![0.0, 1.0, 2.0],
        kind: vec![4, 5, 6],
        q: Vec::new(),
    }
}

#[test]
fn an_optional_column_is_empty_until_it_is_filled() {
    let mut set = three();
    set.resize(4);
    set.permute(&[3, 2, 1, 0], &mut Scratch::default());
    set.retain(&[true, true, true, false]);
    assert_eq!((set.len(), set.q.capacity()), (3, 0));
    set.q = vec![1.0, 2.0, 3.0];
    set.resize(4);
    set.permute(&[3, 2, 1, 0], &mut Scratch::default());
    set.retain(&[true, true, false, true]);
    assert_eq!(set.q, [0.0, 3.0, 1.0]);
}

#[test]
fn permutation_moves_all_columns_together() {
    let mut set = three();
    set.permute(&[2, 0, 1], &mut Scratch::default());
    let mut other = three();
    other.permute_sparingly(&[2, 0, 1]);
    assert_eq!((&other.id, &other.x, &other.m), (&set.id, &set.x, &set.m));
    assert_eq!(other.kind, set.kind);
    assert_eq!((set.id, set.kind), (vec![9, 7, 8], vec![6, 4, 5]));
    assert_eq!(set.m, [2.0, 0.0, 1.0]);
    assert_eq!(set.x[0], Vec3::repeat(2.0));
}

#[test]
fn removal_and_append_keep_order() {
    let mut set = three();
    set.retain(&[true, false, true]);
    let other = set.clone();
    append(&mut set, &other);
    assert_eq!(set.id, [7, 9, 7, 9]);
    assert_eq!(set.m, [0.0, 2.0, 0.0, 2.0]);
    assert_eq!(set.kind, [4, 6, 4, 6]);
    // An id, a position, a mass and a kind.
    assert_eq!(set.bytes(), 4 * (8 + 24 + 8 + 4));
}

#[test]
fn a_column_that_one_of_two_sets_leaves_empty_is_filled_with_zeros() {
    let (mut plain, charged) = (three(), three());
    let charged = Set {
        q: vec![1.0, 2.0, 3.0],
        ..charged
    };
    append(&mut plain, &charged);
    assert_eq!(plain.q, [0.0, 0.0, 0.0, 1.0, 2.0, 3.0]);
    append(&mut plain, &three());
    assert_eq!((plain.q.len(), plain.len(), plain.q[8]), (9, 9, 0.0));
    let mut both = three();
    append(&mut both, &three());
    assert!(both.q.is_empty() && both.len() == 6);
}

#[test]
fn the_finite_check_names_column_and_place() {
    let mut set = three();
    assert_eq!(set.non_finite(), None);
    set.x[1].y = f64::NAN;
    assert_eq!(set.non_finite(), Some(("Coordinates", 1)));
}
