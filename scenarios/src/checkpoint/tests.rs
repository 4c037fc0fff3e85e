//! Tests of `checkpoint`.

use nbody::bodies::Bodies;
use nbody::points::Vec3;

use super::*;

fn same_bits(a: &Bodies, b: &Bodies) -> bool {
    a.list()
        .into_iter()
        .zip(b.list())
        .all(|((_, a), (_, b))| match (a, b) {
            (ColumnRef::Real(a), ColumnRef::Real(b)) => a
                .iter()
                .map(|x| x.to_bits())
                .eq(b.iter().map(|x| x.to_bits())),
            (ColumnRef::Vector(a), ColumnRef::Vector(b)) => {
                let bits = |v: &[Vec3]| -> Vec<u64> {
                    v.iter()
                        .flat_map(|x| x.iter().map(|c| c.to_bits()).collect::<Vec<_>>())
                        .collect()
                };
                bits(a) == bits(b)
            }
            (ColumnRef::Integer(a), ColumnRef::Integer(b)) => a == b,
            (ColumnRef::Short(a), ColumnRef::Short(b)) => a == b,
            _ => false,
        })
}

#[test]
fn everything_comes_back_bit_for_bit() {
    let path = std::env::temp_dir().join(format!("tridisk-checkpoint-{}.hdf5", std::process::id()));
    let mut bodies = Bodies::default();
    bodies.resize(3);
    bodies.id = vec![u64::MAX, 0, 1 << 63];
    bodies.kind = vec![u32::MAX, 1, 2];
    bodies.m = vec![
        -0.0,
        f64::from_bits(0x7ff8_0000_0000_1234),
        f64::MIN_POSITIVE / 8.0,
    ];
    bodies.x[1] = Vec3::new(f64::INFINITY, 1.0 / 3.0, -1e308);
    let empty = Bodies::default();
    let mut draft = Draft::default();
    draft.set("bodies", &bodies).set("none", &empty);
    let facts = [
        ("time", Fact::Real(0.1 + 0.2)),
        ("step", Fact::Integer(u64::MAX)),
        (
            "scene",
            Fact::Text("[run]\nend_time = 1 # µ\n".repeat(5000)),
        ),
        ("booked", Fact::Reals(vec![1.0, f64::MAX, -0.0])),
        ("counts", Fact::Integers(vec![])),
    ];
    for (name, fact) in &facts {
        draft.fact(name, fact.clone());
    }
    draft.write(&path).unwrap();
    let checkpoint = Checkpoint::open(&path).unwrap();
    let mut back = Bodies::default();
    checkpoint.read_set("bodies", &mut back).unwrap();
    assert!(same_bits(&back, &bodies));
    back.resize(7);
    checkpoint.read_set("none", &mut back).unwrap();
    assert!(back.is_empty());
    for (name, fact) in &facts {
        assert_eq!(&checkpoint.fact(name).unwrap(), fact);
    }
    assert_eq!(checkpoint.length("bodies"), Some(3));
    let missing = checkpoint
        .read_set("gas", &mut back)
        .unwrap_err()
        .to_string();
    assert!(missing.contains("holds no set gas"), "{missing}");
    assert!(
        checkpoint
            .integer("time")
            .unwrap_err()
            .to_string()
            .contains("whole number")
    );
    std::fs::remove_file(&path).unwrap();
    assert!(Checkpoint::open(&path).is_err());
}
