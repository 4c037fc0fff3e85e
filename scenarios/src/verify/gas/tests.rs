//! The battery's machinery: a small problem from its scene to its rows and its picture.

use super::*;

#[test]
fn a_small_tube_runs_by_the_scheme_it_is_given() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = |keys: &[&str]| {
        let keys: Vec<String> = keys.iter().map(|key| key.to_string()).collect();
        let scheme = Scheme::new(false, &keys, Some(folder.path())).expect("a scheme");
        let end = scheme.end(&sod::TUBE.scene(14), 0.1, |_| {});
        sod::TUBE.picture(&scheme, "tube", &end);
        assert_eq!(end.gas.len(), 8064);
        end
    };
    let [plain, viscous] = [
        run(&["gas.viscosity.kind=none"]),
        run(&["gas.viscosity.kind=constant", "gas.viscosity.alpha=2"]),
    ];
    let scatter = |end: &End| end.mean(|p| Some(p.v.y.abs() + p.v.z.abs()));
    let [plain, viscous] = [scatter(&plain), scatter(&viscous)];
    println!("motion across the tube: {plain:.2e} without viscosity, {viscous:.2e} with");
    assert!(viscous < 0.5 * plain, "{viscous} {plain}");
    let picture = std::fs::read(folder.path().join("tube.png")).expect("a picture");
    assert_eq!(picture[1..4], *b"PNG");
}

#[test]
fn the_order_is_the_slope_of_errors() {
    let n = [16.0, 24.0, 50.0f64];
    let errors = n.map(|n| 3.0 * n.powf(-1.7));
    assert!((order(&n, &errors) - 1.7).abs() < 1e-12);
    assert!(order(&n, &[0.1, f64::NAN, 0.2]).is_nan());
}

#[test]
fn stretched_particles_have_the_density_asked_for() {
    // rho = 1 + x: the part q below x is (x + x^2 / 2) / 1.5.
    let (place, mass) = stretched(|x| 1.0 + x);
    assert!((mass - 1.5).abs() < 1e-12);
    for x in [0.0, 0.3, 0.77, 1.0] {
        let part = (x + 0.5 * x * x) / 1.5;
        assert!((place(part) - x).abs() < 1e-8, "{x}");
    }
}
