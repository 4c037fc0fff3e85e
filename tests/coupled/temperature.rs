//! Gas bound to a temperature keeps it while drag heats it and forces see it as drag will leave it.

use tridisk::trial::Trial;

const SCENE: &str = r#"
[run]
end_time = 10.0
[units]
system = "dimensionless"
[star]
mass = 1.0
[gas]
particles = 2000
[gas.disk]
surface_density = 1e-4
reference_radius = 1.0
inner_radius = 0.7
outer_radius = 1.5
[gas.eos]
kind = "locally-isothermal"
aspect_ratio = 0.05
exponent = 0.25
reference_radius = 1.0
[dust]
particles = 500
dust_to_gas = 0.1
[dust.drag]
law = "constant-stokes-number"
stokes_number = 1.0
[gravity]
pulls = { gas = [], dust = [] }
"#;

#[test]
fn gas_bound_to_a_temperature_keeps_it_beside_dust() {
    let mut trial = Trial::new(SCENE, &[], |_| {}).expect("a scene");
    let mut worst: f64 = 0.0;
    let done = trial.run(&[0.0, 1.0, 2.0], |stop| {
        let (gas, star) = (&stop.system.gas.particles, stop.system.star.x[0]);
        // u goes as the square of the sound speed, H/R R^(-1/4), at the distance from the star.
        let whole: Vec<f64> = (gas.x.iter().zip(&gas.u))
            .map(|(x, u)| u * (x - star).xy().norm().sqrt())
            .collect();
        let low = whole.iter().copied().fold(f64::MAX, f64::min);
        let high = whole.iter().copied().fold(0.0, f64::max);
        worst = worst.max(high / low - 1.0);
    });
    done.expect("a run");
    assert!(worst < 1e-12, "{worst:e}");
}
