//! Tubes of turned lattices: their set-up, and what a small one shows.

use super::*;

fn scheme(keys: &[&str]) -> Scheme {
    let keys: Vec<String> = keys.iter().map(|key| (*key).to_owned()).collect();
    Scheme::new(false, &keys, None).expect("a scheme")
}

#[test]
fn turned_lattices_have_one_density_a_side_and_no_force_within() {
    for tilt in TILTS {
        let tube = Tube::new(tilt, 60.0);
        let ends = scheme(&[]).run(&tube.scene(), &[], |gas| tube.lay_out(gas));
        for (from, to, state) in [(0.3, 0.7, TUBE.left.state), (1.3, 1.7, TUBE.right.state)] {
            let inside = |p: &&super::super::State| (from..to).contains(&p.x.x);
            for p in ends[0].gas.iter().filter(inside) {
                // Sums over 24 neighbours of a square lattice are 1.35 % too large, however it is turned.
                assert!((p.rho / state.rho - 1.0135).abs() < 1e-3, "{}", p.rho);
                let push = p.a.norm() * tube.distance() * state.rho / state.p;
                // What a relative error of 1e-4 of H leaves.
                assert!(push < 2e-6, "{tilt:?}: {push}");
            }
        }
        let width = tube.side * f64::from(tube.tiles[1]);
        let mass: f64 = ends[0].gas.iter().map(|p| p.m).sum();
        assert!((mass / (1.125 * width) - 1.0).abs() < 1e-12);
    }
}

#[test]
fn a_viscosity_between_pairs_pushes_across_and_one_along_the_axis_hardly() {
    let tube = Tube::new(TILTS[2], 120.0);
    let [pairs, axis] = ["planar-switch", "planar"]
        .map(|kind| tube.seen(&scheme(&[&format!("gas.viscosity.kind={kind}")])));
    println!("{pairs:?}\n{axis:?}");
    assert!(pairs.across > 0.04 && axis.across < 0.5 * pairs.across);
    for seen in [pairs, axis] {
        assert!(seen.net < 1e-14 && (1.0..6.0).contains(&seen.width));
        // A few columns of particles between contact and shock.
        assert!(seen.entropy.abs() < 0.05);
    }
}

#[test]
fn a_scheme_is_turned_with_the_viscosities_that_it_names_or_allows() {
    let names = |scheme: &Scheme| -> Vec<String> {
        viscosities(scheme)
            .into_iter()
            .map(|(name, _)| name)
            .collect()
    };
    assert_eq!(names(&scheme(&[])), VISCOSITIES[1..]);
    assert_eq!(
        names(&scheme(&["gas.viscosity.kind=\"planar\""])),
        ["planar"]
    );
    // Sums of pressures heat no single particles.
    let pairs = ["constant", "balsara", "cullen-dehnen", "planar-switch"];
    assert_eq!(names(&scheme(&["gas.hydro.formulation=pressure"])), pairs);
}
