//! Cooling of a disk of ideal gas: all that it loses stands in the ledger, and the disk becomes what the law says.

use crate::bench::{Done, run};

/// A quarter of an orbit at 1 au of 2000 particles, of aspect ratio 0.07 where they start.
fn cooled(cooling: &str, more: &[&str]) -> Done {
    let mut overrides = vec![
        "gas.particles=2000",
        "gas.eos={ kind = \"ideal\", gamma = 1.4 }",
        "gas.disk.aspect_ratio=0.07",
        "run.end_time=\"0.25 yr\"",
        "run.snapshots=\"0.25 yr\"",
        "gravity.method=\"none\"",
        cooling,
    ];
    overrides.extend(more);
    run("gas/disk.toml", &overrides)
}

/// What the energies sum to beside what was radiated, relative; and the part of the internal energy that was radiated.
fn books(run: &Done) -> (f64, f64) {
    let (radiated, internal) = (run.ledger("radiated_energy"), run.ledger("internal_energy"));
    let part = radiated.last().expect("a row") / internal[0];
    (run.largest("error_energy"), part)
}

#[test]
fn what_a_disk_radiates_stands_in_the_ledger() {
    let without = books(&cooled("gas.cooling.kind=\"none\"", &[]));
    assert_eq!(without.1, 0.0);
    for beta in ["1e-6", "1", "1e6"] {
        let law = format!("gas.cooling={{ kind = \"beta\", beta = {beta}, aspect_ratio = 0.035 }}");
        let (error, part) = books(&cooled(&law, &[]));
        println!(
            "beta {beta}: error {error:e} beside {:e}, radiated {part}",
            without.0
        );
        // As well as gas that does not cool: the books add no error.
        assert!(error < 2.0 * without.0, "beta {beta}: {error:e}");
        // The disk was as warm as it is now to be a quarter of; what falls together and shocks as it cools is radiated too.
        let expected = match beta {
            "1e-6" => 0.75..f64::INFINITY,
            "1" => 0.3..f64::INFINITY,
            _ => 0.0..1e-5,
        };
        assert!(expected.contains(&part), "beta {beta}: {part}");
    }
}

#[test]
fn gas_that_relaxes_at_once_has_the_temperature_of_its_place() {
    let law = "gas.cooling={ kind = \"relaxation\", beta = 1e-9, aspect_ratio = 0.07 }";
    let run = cooled(law, &[]);
    let last = run.snapshots().pop().expect("a snapshot");
    let gas = run.particles(&last, 0);
    let u = &gas.more["InternalEnergies"];
    for (x, u) in gas.x.iter().zip(u) {
        // c^2 = 0.07^2 / R^0.5 in units of 1 au.
        let expected = 0.0049 / (x.x.hypot(x.y).sqrt() * 0.4);
        assert!((u / expected - 1.0).abs() < 1e-6, "{u} at {x}");
    }
}

#[test]
fn gas_cools_alike_in_steps_of_any_length() {
    let law = "gas.cooling={ kind = \"beta\", beta = 3 }";
    let internal = |more: &[&str]| {
        let run = cooled(law, more);
        *run.ledger("internal_energy").last().expect("a row")
    };
    let (own, short) = (internal(&[]), internal(&["run.time_step=\"0.25 day\""]));
    println!("{own} {short} {}", own / short - 1.0);
    assert!((own / short - 1.0).abs() < 1e-3);
}
