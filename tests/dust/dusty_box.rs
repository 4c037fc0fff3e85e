//! Dusty box (Laibe & Price 2011): uniform gas and dust that move through each other in a periodic box.
//!
//! dv(t) = dv0 exp[-(1 + eps) t / t_stop], whatever the stopping time and the mass ratio eps; momentum stays, lost kinetic energy is heat.

use crate::bench;

#[test]
fn the_relative_velocity_decays_as_it_must_for_any_stopping_time() {
    let mut worst = 0.0f64;
    for eps in [0.01, 1.0, 100.0] {
        for power in [-12, -8, -6, -4, -2, -1, 0, 1, 2, 4, 8, 12] {
            let t_stop = 10f64.powi(power);
            let (density, stopping) = (
                format!(
                    "dust.block=[{{lo=[0.0,0.0,0.0],hi=[1.0,1.0,1.0],lattice=\"cubic\",spacing=0.125,density={eps},velocity=[1.0,0.0,0.0]}}]"
                ),
                format!("dust.drag.stopping_time={t_stop:e}"),
            );
            let gas = "gas.block=[{lo=[0.0,0.0,0.0],hi=[1.0,1.0,1.0],lattice=\"cubic\",spacing=0.125,density=1.0,pressure=1.0}]";
            let run = bench::run(
                "dust/dusty-box.toml",
                &[
                    gas,
                    &density,
                    &stopping,
                    "run.end_time=0.5",
                    "run.snapshots=0.25",
                ],
            );
            for path in run.snapshots() {
                let (gas, dust) = (run.particles(&path, 0), run.particles(&path, 2));
                let exact = (-(1.0 + eps) * run.time(&path) / t_stop).exp();
                for (g, d) in gas.v.iter().zip(&dust.v) {
                    let error = ((d - g).x - exact).abs() + (d - g).yz().norm();
                    worst = worst.max(if error.is_nan() { f64::INFINITY } else { error });
                }
            }
            let case = format!("eps {eps}, t_stop {t_stop:e}");
            let (momentum, energy) = (run.largest("error_momentum"), run.largest("error_energy"));
            assert!(momentum < 1e-13, "{case}: momentum {momentum:e}");
            assert!(energy < 1e-10, "{case}: energy {energy:e}");
        }
    }
    println!("dusty box: largest error of the relative velocity {worst:e}");
    assert!(worst < 1e-5, "{worst:e}");
}
