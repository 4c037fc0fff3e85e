//! Tests of `tridisk sample`.

use std::collections::BTreeMap;

use nbody::points::Label;

use super::*;
use crate::snapshot::Group;

const SCENE: &str = r#"
[run]
end_time = 1.0
[units]
system = "dimensionless"
[gas.eos]
kind = "ideal"
gamma = 1.4
[[gas.block]]
lo = [0, 0, 0]
hi = [1, 1, 1]
spacing = 0.05
density = 1.0
pressure = 1.0
"#;

fn velocity(x: Vec3) -> Vec3 {
    Vec3::new(1.0 + x.y, 2.0 * x.z - x.x, 0.5 * x.x)
}

fn density(x: Vec3) -> f64 {
    2.0 + 0.3 * x.x - 0.2 * x.y + 0.1 * x.z
}

/// A snapshot of a lattice with fields linear in space, the same c_s = 1.4 everywhere.
fn snapshot(path: &Path) {
    let scene = Scene::parse(SCENE, "linear", Path::new("."), &[]).expect("a scene");
    let n = 12;
    let place = |k: usize| (k as f64 + 0.5) / n as f64;
    let x: Vec<Vec3> = (0..n * n * n)
        .map(|i| Vec3::new(place(i % n), place(i / n % n), place(i / n / n)))
        // No lattice: moved by up to a third of its spacing.
        .map(|x| x + 0.03 * Vec3::new((97.0 * x.y).sin(), (83.0 * x.z).sin(), (71.0 * x.x).sin()))
        .collect();
    let rho: Vec<f64> = x.iter().map(|&x| density(x)).collect();
    let mut particles = gas::Particles {
        id: (0..x.len() as u64).map(|i| 7 * i).collect(),
        v: x.iter().map(|&x| velocity(x)).collect(),
        m: rho.iter().map(|rho| rho / (n * n * n) as f64).collect(),
        u: vec![3.5; x.len()],
        h: vec![0.15; x.len()],
        x,
        ..Default::default()
    };
    particles.resize(rho.len());
    let p: Vec<f64> = rho.iter().map(|rho| 1.4 * rho).collect();
    let mut group = Group::new(0).with(&particles);
    let more: [(Label, &[f64]); 2] = [
        (
            Label::snapshot("Densities", Dimension::DENSITY, "density"),
            &rho,
        ),
        (
            Label::snapshot("Pressures", Dimension::PRESSURE, "pressure"),
            &p,
        ),
    ];
    for (label, values) in more {
        group = group.with_column(label, ColumnRef::Real(values));
    }
    snapshot::write(path, &scene, 0.0, &[group]).expect("a snapshot");
}

/// The columns of the text, by name.
fn columns(text: &str) -> BTreeMap<&str, Vec<f64>> {
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().expect("a heading").split(',').collect();
    let rows: Vec<Vec<f64>> = lines
        .map(|line| {
            line.split(',')
                .map(|x| x.parse().expect("a number"))
                .collect()
        })
        .collect();
    assert!(rows.iter().all(|row| row.len() == names.len()));
    let column = |k: usize| rows.iter().map(|row| row[k]).collect();
    names
        .iter()
        .enumerate()
        .map(|(k, &name)| (name, column(k)))
        .collect()
}

#[test]
fn linear_fields_come_back_exactly_with_their_gradients() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("linear.hdf5");
    snapshot(&file);
    let points = folder.path().join("points.csv");
    let text = "x,y,z\n0.5,0.5,0.5\n# a remark\n0.31 0.62 0.47\n\n20 0 0\n";
    std::fs::write(&points, text).expect("points");
    let text = sample(&file, &points, None).expect("samples");
    let found = columns(&text);
    assert_eq!(found["shape"], [1.0, 1.0, 0.0]);
    for (k, x) in [Vec3::repeat(0.5), Vec3::new(0.31, 0.62, 0.47)]
        .into_iter()
        .enumerate()
    {
        let near = |name: &str, expected: f64| {
            let error = found[name][k] - expected;
            assert!(error.abs() < 1e-12, "{name} at {x}: {error}");
        };
        near("density", density(x));
        near("pressure", 1.4 * density(x));
        near("sound_speed", 1.4);
        for (axis, component) in ["x", "y", "z"].into_iter().enumerate() {
            near(&format!("velocity_{component}"), velocity(x)[axis]);
            near(
                &format!("density_gradient_{component}"),
                [0.3, -0.2, 0.1][axis],
            );
            for (of, by) in ["x", "y", "z"].into_iter().enumerate() {
                let slopes = [[0.0, 1.0, 0.0], [-1.0, 0.0, 2.0], [0.5, 0.0, 0.0]];
                near(
                    &format!("velocity_gradient_{component}{by}"),
                    slopes[axis][of],
                );
            }
        }
        assert!(found["temperature"][k].is_nan(), "the file has none");
    }
    assert_eq!(found["density"][2], 0.0);
    assert!(found["density_gradient_x"][2].is_nan());
    let output = folder.path().join("samples.hdf5");
    assert_eq!(sample(&file, &points, Some(&output)), Ok(String::new()));
    let hdf = hdf5::File::open(&output).expect("a file");
    let read = |name: &str| crate::hdf::read_values::<f64>(&hdf.dataset(name).expect("a dataset"));
    assert_eq!(read("Densities").expect("values"), found["density"]);
    let slopes = read("VelocityGradientsY").expect("values");
    assert_eq!(slopes[2], found["velocity_gradient_yz"][0]);
}

#[test]
fn points_and_files_that_are_none_are_refused_in_words() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("linear.hdf5");
    snapshot(&file);
    let points = folder.path().join("points.txt");
    let fault = |text: &str| {
        std::fs::write(&points, text).expect("points");
        sample(&file, &points, None).expect_err("a refusal")
    };
    assert!(fault("1 2 3\n1 2\n").contains("line 2 must be three finite numbers"));
    assert!(fault("1 2 inf\n").contains("line 1 must be"));
    assert!(fault("x y z\n1 2 z\n").contains("line 2 must be"));
    let none = folder.path().join("none.txt");
    assert!(
        sample(&file, &none, None)
            .expect_err("a refusal")
            .contains("none.txt")
    );
    assert!(
        sample(&points, &points, None)
            .expect_err("a refusal")
            .contains("points.txt")
    );
}
