//! Tests of `tree`.

use super::*;
use crate::points::sort::{Cube, Curve};

fn points(n: u32) -> Vec<Vec3> {
    let f = |i: u32, k: f64| (f64::from(i) * k).fract();
    (0..n)
        .map(|i| Vec3::new(f(i, 0.618_034), f(i, 0.414_214), f(i, 0.732_051)))
        .collect()
}

fn sorted_tree(mut x: Vec<Vec3>, leaf_size: usize) -> (Vec<Vec3>, Tree) {
    let mut curve = Curve::default();
    curve.thread(&x, Cube::around(&x));
    x = curve.order.iter().map(|&i| x[i as usize]).collect();
    let mut tree = Tree::default();
    tree.build(&x, &curve.keys, leaf_size);
    (x, tree)
}

#[test]
fn leaves_tile_the_particles_and_boxes_hold_them() {
    for x in [
        points(1),
        points(2),
        points(1000),
        vec![Vec3::repeat(0.3); 100],
    ] {
        let (x, tree) = sorted_tree(x, 16);
        let mut next = 0;
        for &leaf in &tree.leaves {
            let node = &tree.nodes[leaf as usize];
            assert_eq!(node.first, next);
            assert!(node.count() <= 16);
            next = node.end;
        }
        assert_eq!(next as usize, x.len());
        for node in &tree.nodes {
            assert!(
                x[node.range()]
                    .iter()
                    .all(|p| (0..3).all(|a| node.lo[a] <= p[a] && p[a] <= node.hi[a]))
            );
        }
    }
}

#[test]
fn values_and_boxes_of_many_particles_are_those_of_a_plain_pass() {
    let (mut x, tree) = sorted_tree(points(3 * FEW as u32 + 17), 16);
    x.iter_mut()
        .for_each(|x| *x = Vec3::new(x.y, -x.z, 2.0 * x.x));
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let mut tree = tree.clone();
        let mut ends = Vec::new();
        let leaf = |node: &Node| [node.first, node.end];
        pool.build().expect("a thread pool").install(|| {
            tree.refit(&x);
            tree.accumulate(&mut ends, &leaf, &|a, b| [a[0], b[1]]);
        });
        (tree.nodes, ends)
    };
    for threads in [1, 2, 7] {
        let (nodes, ends) = with(threads);
        for (node, end) in nodes.iter().zip(ends) {
            assert_eq!(end, [node.first, node.end]);
            let own = &x[node.range()];
            let (lo, hi) = own[1..]
                .iter()
                .fold((own[0], own[0]), |(lo, hi), x| (lo.inf(x), hi.sup(x)));
            assert_eq!((node.lo, node.hi), (lo, hi));
        }
    }
}

#[test]
fn near_finds_every_neighbour_of_a_periodic_box_once() {
    let (x, tree) = sorted_tree(points(2000), 8);
    let domain = Domain::periodic(Vec3::repeat(1.0));
    let mut extent = Vec::new();
    tree.largest(|i| if i % 100 == 0 { 0.3 } else { 0.02 }, &mut extent);
    for i in (0..x.len()).step_by(97) {
        let mut found = Vec::new();
        tree.near(&domain, (x[i], x[i]), 0.1, &extent, |range, shift| {
            found.extend(range.filter(|&j| {
                let reach = if j % 100 == 0 { 0.3 } else { 0.1 };
                (x[j] + shift - x[i]).norm() < reach
            }));
        });
        let expected: Vec<usize> = (0..x.len())
            .filter(|&j| domain.nearest(x[j] - x[i]).norm() < if j % 100 == 0 { 0.3 } else { 0.1 })
            .collect();
        found.sort_unstable();
        assert_eq!(found, expected);
    }
}

#[test]
fn an_empty_tree_has_nothing_near() {
    let tree = Tree::default();
    tree.near(
        &Domain::open(),
        (Vec3::zeros(), Vec3::zeros()),
        1.0,
        &[],
        |_, _| panic!("nothing is there"),
    );
}
