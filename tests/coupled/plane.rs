//! Planets in the plane, among gas in two dimensions: pulls are mutual, and the torques that are told are those that turn the planet.

use std::f64::consts::TAU;

use nbody::points::Vec3;
use tridisk::trial::Trial;

use crate::bench;

/// A patch of gas on circular orbits, most of it ahead of a planet.
const PATCH: &str = r#"
[run]
end_time = 100.0
[units]
system = "dimensionless"
[domain]
dimensions = 2
[star]
mass = 1.0
accretion_radius = 0.1
[gas]
softening = 0.0
[gas.eos]
kind = "isothermal"
sound_speed = 0.05
[planetesimals]
integrator = "leapfrog"
softening = 0.05
[gravity]
pulls = { gas = ["planets"], planets = ["gas"] }
[[planet]]
mass = 1e-3
position = [1.0, 0.0, 0.0]
velocity = [0.0, 1.0, 0.0]
[[gas.block]]
lo = [0.8, -0.1, 0.0]
hi = [1.2, 0.3, 0.0]
spacing = 0.02
density = 0.01
"#;

#[test]
fn a_planet_in_the_plane_is_turned_by_the_torques_of_its_gas() {
    let mut trial = Trial::new(PATCH, &[], |gas| {
        for (v, x) in gas.v.iter_mut().zip(&gas.x) {
            *v = Vec3::new(-x.y, x.x, 0.0) / x.norm().powf(1.5);
        }
    })
    .unwrap_or_else(|refusal| panic!("{refusal}"));
    let stops: Vec<f64> = (0..=40).map(|k| 0.1 * TAU * f64::from(k) / 40.0).collect();
    let (mut torques, mut momenta, mut error) = (Vec::new(), Vec::new(), 0.0);
    let done = trial.run(&stops, |stop| {
        let (system, bodies) = (stop.system, &stop.system.bodies);
        let x = bodies.x[0] - system.star.x[0];
        let by_gas = system.torques.iter().find(|torque| torque.source == "gas");
        torques.push(x.cross(&by_gas.expect("gas pulls").force));
        momenta.push(bodies.m[0] * x.cross(&bodies.v[0]));
        error = stop.books.error_angular_momentum;
        assert!(bodies.x[0].z == 0.0 && bodies.v[0].z == 0.0);
        assert!(system.gas.particles.x.iter().all(|x| x.z == 0.0));
    });
    done.unwrap_or_else(|fault| panic!("{fault}"));
    let step = stops[1] - stops[0];
    let impulse = |pair: &[Vec3]| 0.5 * step * (pair[0] + pair[1]);
    let turned: Vec3 = torques.windows(2).map(impulse).sum();
    let gained = momenta[40] - momenta[0];
    println!("gained {gained:?} beside {turned:?}, error {error:e}");
    // Stops are steps, whose kicks are trapezoids too.
    assert!((turned.z / gained.z - 1.0).abs() < 1e-12);
    // A star that nothing pulls stands still: the gas loses what the planet gains.
    assert!(error < 1e-13, "{error:e}");
}

/// The patch for a run through the whole program: all pulls are mutual, and it moves as one.
fn patch() -> String {
    PATCH
        .replace("end_time = 100.0", "end_time = 0.1\nsnapshots = 0.05")
        .replace(
            "pulls = { gas = [\"planets\"], planets = [\"gas\"] }",
            "pulls = { gas = [\"planets\", \"star\"] }",
        )
        + "velocity = [0.0, 1.0, 0.0]\n"
}

#[test]
fn planetesimals_of_a_file_are_refused_in_the_plane() {
    let run = bench::run_text(&patch());
    let start = run.path("snapshot_0000.hdf5");
    let again = format!("{}[initial]\nfile = {start:?}\n", patch());
    let Err(refusal) = bench::attempt(&again) else {
        panic!("the planet of the file, as a planetesimal");
    };
    let sentence = "PartType1: planetesimals need three dimensions";
    assert!(refusal.contains(sentence), "{refusal}");
}
