//! A wave in gas and as much dust, coupled so tightly that sound crosses a distance of particles in many stopping times (Laibe & Price 2012).
//!
//! The mixture is gas of half the square of the sound speed: v = A cos(k t / sqrt 2) sin kx, undamped; energy moves between motion and pressure.

use std::f64::consts::TAU;

use tridisk::trial::Trial;

const AMPLITUDE: f64 = 0.01;
const CELLS: u32 = 16;
const ACROSS: u32 = 8;

fn scene(stopping_time: f64) -> String {
    let width = f64::from(ACROSS) / f64::from(CELLS);
    let block = format!(
        "lo = [0, 0, 0]\nhi = [1, {width}, {width}]\nlattice = \"bcc\"\nspacing = {}\ndensity = 1\n",
        0.5f64.cbrt() / f64::from(CELLS)
    );
    format!(
        "[run]\nend_time = 0.71\n[units]\nsystem = \"dimensionless\"\n[domain]\nkind = \"periodic\"\nsize = [1, {width}, {width}]\n\
         [gas.eos]\ngamma = 1.4\n[gas.viscosity]\nkind = \"none\"\n[[gas.block]]\n{block}pressure = {}\n[[dust.block]]\n{block}\
         [dust.drag]\nlaw = \"constant-stopping-time\"\nstopping_time = {stopping_time:e}\n",
        1.0 / 1.4
    )
}

/// Part of the velocity of the gas that goes as sin kx after half a period, by its amplitude at the start; error of the energy by that of the wave; and
/// updates of superparticles.
fn wave(stopping_time: f64) -> (f64, f64, u64) {
    let velocity = |x: f64| AMPLITUDE * (TAU * x).sin();
    let trial = Trial::prepared(&scene(stopping_time), &[], |gas, dust| {
        for (v, x) in gas.v.iter_mut().zip(&gas.x) {
            v.x = velocity(x.x);
        }
        for (v, x) in dust.v.iter_mut().zip(&dust.x) {
            v.x = velocity(x.x);
        }
    });
    let mut trial = trial.expect("a scene");
    let (mut part, mut error) = (f64::NAN, f64::NAN);
    let done = trial.run(&[0.0, 0.5f64.sqrt()], |stop| {
        let gas = &stop.system.gas.particles;
        let sum: f64 = (gas.v.iter().zip(&gas.x))
            .map(|(v, x)| v.x * (TAU * x.x).sin())
            .sum();
        part = 2.0 * sum / gas.x.len() as f64 / AMPLITUDE;
        let books = stop.books;
        let all = books.kinetic + books.internal;
        error = books.error_energy * all / (0.5 * AMPLITUDE * AMPLITUDE);
    });
    done.expect("a run");
    let drag = trial.watch.laps[coupling::Phase::Drag as usize].targets;
    (part, error, drag)
}

#[test]
fn tightly_coupled_dust_makes_sound_slow_but_does_not_damp_it() {
    let exact = -1.0;
    let mut updates = Vec::new();
    for stopping_time in [1e-4, 1e-8, 1e-12] {
        let (part, error, drag) = wave(stopping_time);
        println!(
            "t_stop {stopping_time:e}: {part:.4} of {exact:.4}, energy {error:.2e}, {drag} updates"
        );
        assert!((part - exact).abs() < 0.03, "{part}");
        assert!(error.abs() < 0.01, "{error:e}");
        updates.push(drag);
    }
    // Steps do not depend on stopping times.
    let (loose, _, drag) = wave(1e12);
    println!("t_stop 1e12: {loose:.4}, {drag} updates");
    updates.push(drag);
    let (least, most) = (updates.iter().min().copied(), updates.iter().max().copied());
    assert_eq!(least, most);
}
