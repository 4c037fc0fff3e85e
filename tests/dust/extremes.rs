//! Dust at the extremes: everything stays finite, and momentum and energy are kept.

use coupling::ledger::Report;
use nbody::points::Vec3;
use tridisk::trial::Trial;

/// A box of 512 gas particles with a block of dust, and further tables.
fn scene(gas: &str, dust: &str, more: &str) -> String {
    let block = "lo = [0, 0, 0]\nhi = [1, 1, 1]\n";
    format!(
        "[run]\nend_time = 0.1\ntime_step = 0.02\n[units]\nsystem = \"dimensionless\"\n\
         [domain]\nkind = \"periodic\"\nsize = [1, 1, 1]\n[[gas.block]]\n{block}lattice = \"cubic\"\nspacing = 0.125\n\
         {gas}[[dust.block]]\n{block}{dust}velocity = [1, 0.5, -0.2]\n{more}"
    )
}

const GAS: &str = "density = 1\npressure = 1\n";
const CONSTANT: &str = "[dust.drag]\nlaw = \"constant-stopping-time\"\nstopping_time = 0.01\n";

/// Momentum lost, by what all would have at the speed that the energy could give.
fn lost(books: &Report) -> f64 {
    let (mass, energy) = (
        books.mass.iter().sum::<f64>(),
        books.kinetic + books.internal,
    );
    books.error_momentum * books.momentum.norm() / (mass * energy).sqrt()
}

/// Runs a scene; everything must be finite, momentum be kept to 1e-12 and energy to `bar`. Answers the mean velocity of the dust.
fn kept(what: &str, text: &str, bar: f64, place: impl Fn(&mut Vec<Vec3>)) -> Vec3 {
    let trial = Trial::prepared(text, &[], |_, dust| place(&mut dust.x));
    let mut trial = trial.unwrap_or_else(|refusal| panic!("{what}: {refusal}"));
    let mut mean = Vec3::repeat(f64::NAN);
    let done = trial.run(&[0.0, 0.1], |stop| {
        let system = stop.system;
        let (p, g) = (&system.dust.particles, &system.gas.particles);
        let sums = p.v.iter().chain(&p.x).chain(&g.v).chain(&g.x);
        assert!(sums.sum::<Vec3>().norm().is_finite(), "{what}");
        assert!(g.u.iter().all(|u| *u > 0.0), "{what}");
        let (momentum, energy) = (lost(stop.books), stop.books.error_energy);
        println!("{what}: momentum {momentum:.1e}, energy {energy:.1e}");
        assert!(momentum.abs() < 1e-12, "{what}: momentum {momentum:e}");
        assert!(energy.abs() < bar, "{what}: energy {energy:e}");
        mean = p.v.iter().sum::<Vec3>() / p.v.len() as f64;
    });
    done.unwrap_or_else(|fault| panic!("{what}: {fault}"));
    mean
}

fn as_made(_: &mut Vec<Vec3>) {}

#[test]
fn any_ratio_of_dust_to_gas() {
    for power in [-8, -4, 0, 3, 6] {
        let eps = 10f64.powi(power);
        let dust = format!("lattice = \"cubic\"\nspacing = 0.125\ndensity = {eps:e}\n");
        let what = format!("dust to gas {eps:e}");
        let v = kept(&what, &scene(GAS, &dust, CONSTANT), 1e-11, as_made);
        let mean = eps / (1.0 + eps);
        let exact = mean + (1.0 - mean) * (-10.0 * (1.0 + eps)).exp();
        assert!((v.x - exact).abs() < 1e-9, "{what}: {} of {exact}", v.x);
    }
}

/// In cgs: gas of 1e-9 g/cm^3 at 1 km/s, mean free path 2 cm.
#[test]
fn grains_of_a_nanometre_and_of_a_thousand_kilometres() {
    for size in ["1e-7", "1e8"] {
        for law in ["epstein", "stokes", "auto", "adachi"] {
            let dust = "lattice = \"cubic\"\nspacing = 0.125\ndensity = 1e-11\n";
            let more = format!(
                "[dust]\nsize = {size}\nmaterial_density = 2\n[dust.drag]\nlaw = \"{law}\"\n"
            );
            let gas = "density = 1e-9\npressure = 10\n";
            let text = scene(gas, dust, &more).replace(
                "end_time = 0.1\ntime_step = 0.02",
                "end_time = 0.1\ntime_step = 1e-7",
            );
            let text = text.replace("end_time = 0.1", "end_time = 5e-7");
            kept_until(&format!("{law}, {size} cm"), &text, 5e-7);
        }
    }
}

fn kept_until(what: &str, text: &str, end: f64) {
    let mut trial = Trial::new(text, &[], |_| {}).unwrap_or_else(|r| panic!("{what}: {r}"));
    let done = trial.run(&[0.0, end], |stop| {
        let (momentum, energy) = (lost(stop.books), stop.books.error_energy);
        assert!(momentum.abs() < 1e-12, "{what}: momentum {momentum:e}");
        assert!(energy.abs() < 1e-11, "{what}: energy {energy:e}");
        let derived = &stop.system.dust.derived;
        let sound = |t: &f64| *t > 0.0 && t.is_finite();
        // Nothing has been looked for at the start.
        assert!(
            stop.books.time == 0.0 || derived.t_stop.iter().all(sound),
            "{what}"
        );
    });
    done.unwrap_or_else(|fault| panic!("{what}: {fault}"));
}

#[test]
fn one_grain_and_grains_at_one_point_and_on_gas_particles() {
    let one = "lattice = \"cubic\"\nspacing = 1\ndensity = 1e-3\n";
    kept("one grain", &scene(GAS, one, CONSTANT), 1e-5, as_made);
    let many = "lattice = \"cubic\"\nspacing = 0.125\ndensity = 1\n";
    kept("at one point", &scene(GAS, many, CONSTANT), 1e-2, |x| {
        x.fill(Vec3::new(0.3, 0.4, 0.55));
    });
    kept(
        "at a gas particle",
        &scene(GAS, many, CONSTANT),
        1e-2,
        |x| {
            x.fill(Vec3::repeat(0.0625));
        },
    );
}

#[test]
fn dust_without_gas_moves_straight_on() {
    let text = scene(
        GAS,
        "lattice = \"cubic\"\nspacing = 0.25\ndensity = 1\n",
        "",
    );
    let (gas, dust) = (
        text.find("[[gas").expect("gas"),
        text.find("[[dust").expect("dust"),
    );
    let text = format!("{}{}", &text[..gas], &text[dust..]);
    let v = kept("no gas", &text, 1e-15, as_made);
    assert!((v - Vec3::new(1.0, 0.5, -0.2)).norm() < 1e-15, "{v}");
}
