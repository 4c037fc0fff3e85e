//! Pictures of made-up snapshots: that they are drawn at all; how they look, a person has to judge.

use std::f64::consts::TAU;

use nbody::bodies::Bodies;
use nbody::points::{ColumnRef, Columns, Label, Vec3};

use super::*;
use crate::history::{LedgerRow, Table};
use crate::scene::Scene;
use crate::snapshot::{Group, write};

/// Numbers in [0, 1) without pattern.
fn fraction(i: usize, salt: u64) -> f64 {
    let mut z = (i as u64 + 1)
        .wrapping_mul(0x9e37_79b9_7f4a_7c15)
        .wrapping_add(salt << 32);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

fn disk(n: usize, thickness: f64, mass: f64, salt: u64) -> Bodies {
    let mut bodies = Bodies::default();
    bodies.resize(n);
    for i in 0..n {
        let phi = TAU * fraction(i, salt);
        let r = 0.5 + 1.5 * fraction(i, salt + 1) + 0.05 * (3.0 * phi).cos();
        let z =
            thickness * r * (0..6).map(|k| fraction(i, salt + 2 + k) - 0.5).sum::<f64>() * 1.414;
        bodies.id[i] = i as u64;
        bodies.x[i] = Vec3::new(r * phi.cos(), r * phi.sin(), z);
        let v = r.powf(-0.5);
        let e = thickness * (fraction(i, salt + 9) - 0.5);
        bodies.v[i] = Vec3::new(-v * phi.sin(), v * phi.cos(), e);
        bodies.m[i] = mass / n as f64;
    }
    bodies
}

#[test]
fn a_run_s_folder_becomes_pictures() {
    let keep = std::env::var_os("TRIDISK_PICTURES").map(PathBuf::from);
    let own = std::env::temp_dir().join(format!("tridisk-plot-{}", std::process::id()));
    let folder = keep.clone().unwrap_or(own);
    std::fs::create_dir_all(&folder).unwrap();
    let text = crate::new::write(Some("disk"), Some(Path::new("-"))).unwrap();
    let scene = Scene::parse(&text, "disk", Path::new("."), &[]).unwrap();
    std::fs::write(folder.join("scene.toml"), scene.to_toml()).unwrap();
    let gas = disk(20000, 0.05, 1e-3, 1);
    let h = vec![0.03; gas.len()];
    let (dust, mut bodies) = (disk(3000, 0.02, 1e-5, 20), disk(500, 0.005, 3e-6, 40));
    bodies.m[0] = 1e-5;
    let mut star = disk(1, 0.0, 1.0, 60);
    (star.x[0], star.v[0]) = (Vec3::zeros(), Vec3::zeros());
    let label = Label::snapshot("SmoothingLengths", Dimension::LENGTH, "smoothing length");
    let groups = [
        Group::new(0)
            .with(&gas)
            .with_column(label, ColumnRef::Real(&h)),
        Group::new(1).with(&bodies),
        Group::new(2).with(&dust),
        Group::new(4).with(&star),
    ];
    write(&folder.join("snapshot_0003.hdf5"), &scene, 20.0, &groups).unwrap();
    let mut table = Table::create(&folder.join("ledger.csv"), &LedgerRow::HEAD).unwrap();
    for i in 0..50u32 {
        let t = f64::from(i);
        let row = LedgerRow {
            time: t,
            kinetic_energy: 1e-4 + 1e-6 * (0.3 * t).sin(),
            potential_energy: -2e-4 - 1e-6 * (0.3 * t).sin(),
            error_energy: 1e-9 * t * t,
            error_angular_momentum: 1e-13 * (1.0 + (1.7 * t).sin()),
            ..LedgerRow::default()
        };
        row.push_to(&mut table).unwrap();
    }
    let pictures = draw(&folder, None).unwrap();
    assert_eq!(pictures.len(), 5, "{pictures:?}");
    for picture in pictures {
        assert!(std::fs::read(&picture).unwrap().starts_with(b"\x89PNG"));
    }
    if keep.is_none() {
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
