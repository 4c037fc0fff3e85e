//! Tests of blocks: how members are listed.

use dust::{Dust, Superparticles};
use nbody::points::Columns;

use super::*;
use crate::drag::{Grains, Star};

/// Grains in a ball about `centre` in a box of unit size, wrapped.
fn ball(n: usize, centre: Vec3, domain: &Domain) -> Dust {
    let f = |i: usize, k: f64| (i as f64 * k + 0.5).fract() - 0.5;
    let place = |i| {
        let mut x = centre + 0.1 * Vec3::new(f(i, 0.819_172_5), f(i, 0.671_043_6), f(i, 0.549_7));
        domain.wrap(&mut x);
        x
    };
    let mut particles = Superparticles {
        x: (0..n).map(place).collect(),
        ..Superparticles::default()
    };
    particles.resize(n);
    particles.h.fill(0.03);
    Dust::new(particles)
}

/// Cells of such grains, and how far images are from the first at most.
fn listed(centre: Vec3, domain: &Domain) -> (usize, f64) {
    let mut dust = ball(200, centre, domain);
    let members: Vec<u32> = (0..dust.len() as u32).collect();
    let grains = Grains {
        dust: &mut dust,
        star: Star::default(),
    };
    let reach = Reach {
        neighbours: 57.0,
        largest: 0.1,
    };
    let mut scratch = Scratch::default();
    let (gas, at) = (Gas::default(), (domain, &reach));
    Block::default().list(&gas, &grains, &members, at, &mut scratch);
    let apart = scratch.images.iter().map(|x| (x - scratch.origin).amax());
    (scratch.cells.len(), apart.fold(0.0, f64::max))
}

#[test]
fn members_on_both_sides_of_a_face_share_a_cell() {
    let periodic = Domain::periodic(Vec3::repeat(1.0));
    let shearing = Domain::shearing(Vec3::repeat(1.0), 0.8, 1.5).at(0.3);
    for domain in [periodic, shearing] {
        for centre in [
            Vec3::repeat(0.5),
            Vec3::new(0.0, 0.5, 0.5),
            Vec3::new(0.0, 0.0, 1.0),
        ] {
            let (cells, apart) = listed(centre, &domain);
            assert!(cells == 1 && apart < 0.1, "{centre}: {cells}, {apart}");
        }
    }
}
