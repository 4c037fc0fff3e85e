//! Rows of particles that pass each other at rest: how the force on a particle changes with where its neighbours happen to stand.
//!
//! A periodic square of uniform pressure holds two square lattices, one above the other, of equal densities or in contact with a contrast of about 2.
//! The upper one is moved sideways by parts of a distance, all by itself. The exact force is none at every offset; measured is the rms over
//! offsets of the acceleration's change about its mean, and that mean, for the row of the lower gas that is next to the face, by P / (rho d), d its
//! distance of neighbours. The mean is what a formulation makes of a contact; the change is what rows feel of each other in shear.
//! The test is named in Makino (2013, lecture slides): the force always changes as a particle passes.

use gas::Particles;
use nbody::points::Vec3;

use super::{Bar, Row, Scheme};

/// Particles a side of the lower gas; of the upper, where it is denser.
const LOWER: u32 = 24;
const DENSER: u32 = 34;
const OFFSETS: u32 = 16;

fn scene(upper: u32) -> String {
    let block = |lo: f64, hi: f64, n: u32| {
        let contrast = (f64::from(n) / f64::from(LOWER)).powi(2);
        format!(
            "[[gas.block]]\nlo = [0, {lo:?}, 0]\nhi = [1, {hi:?}, 0]\nlattice = \"cubic\"\nspacing = {}\ndensity = {contrast}\npressure = 1\n",
            1.0 / f64::from(n)
        )
    };
    format!(
        "[run]\nend_time = 1\n[units]\nsystem = \"dimensionless\"\n[domain]\nkind = \"periodic\"\nsize = [1, 1, 1]\ndimensions = 2\n{}{}\
         [gas.eos]\ngamma = 1.6666666666666667\n",
        block(0.0, 0.5, LOWER),
        block(0.5, 1.0, upper)
    )
}

fn slide(gas: &mut Particles, way: f64) {
    for x in gas.x.iter_mut().filter(|x| x.y > 0.5) {
        x.x = (x.x + way).rem_euclid(1.0);
    }
}

/// The mean over offsets of the acceleration, and the rms change about it, by P / (rho d).
fn pushes(scheme: &Scheme, upper: u32) -> [f64; 2] {
    let spacing = 1.0 / f64::from(LOWER);
    let near = 0.5 - 0.75 * spacing..0.5;
    let rows: Vec<Vec<Vec3>> = (0..OFFSETS)
        .map(|k| {
            let way = spacing * f64::from(k) / f64::from(OFFSETS);
            let start = scheme.run(&scene(upper), &[], |gas| slide(gas, way));
            let row = start[0].gas.iter().filter(|p| near.contains(&p.x.y));
            row.map(|p| p.a * spacing).collect()
        })
        .collect();
    let all = || rows.iter().flatten();
    let number = f64::from(OFFSETS * LOWER);
    let mean = all().sum::<Vec3>() / number;
    let change = all().map(|a| (a - mean).norm_squared()).sum::<f64>() / number;
    [mean.norm(), change.sqrt()]
}

pub fn of(scheme: &Scheme) -> Vec<Row> {
    let cases = [("one gas", LOWER), ("a contact", DENSER)];
    let rows = cases.map(|(name, upper)| {
        let [mean, change] = pushes(scheme, upper);
        [("mean", mean), ("rms change", change)]
            .map(|(what, push)| Row::new(format!("{what} of the force, {name}"), push, Bar::None))
    });
    rows.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(keys: &[&str]) -> [f64; 4] {
        let keys: Vec<String> = keys.iter().map(|key| (*key).to_owned()).collect();
        let rows = of(&Scheme::new(false, &keys, None).expect("a scheme"));
        let values: Vec<f64> = rows.iter().map(|row| row.measured).collect();
        println!("{keys:?} {values:?}");
        [values[0], values[1], values[2], values[3]]
    }

    #[test]
    fn sums_of_pressure_calm_a_contact_and_a_background_left_out_passing_rows() {
        let density = measured(&[]);
        let pressure = measured(&["gas.hydro.formulation=pressure"]);
        let calm = measured(&[
            "gas.hydro.formulation=pressure",
            "gas.hydro.background_pressure=least",
        ]);
        let wide = measured(&["gas.hydro.kernel=wendland-c4", "gas.hydro.neighbours=140"]);
        // One lattice is no contact to either, and both are the same then.
        assert!((density[1] / pressure[1] - 1.0).abs() < 1e-6);
        // A tenth: two lattices are no smooth sum of pressures either.
        assert!(density[2] > 0.1 && pressure[2] < 0.2 * density[2]);
        for k in [1, 3] {
            // What is left goes with P - P_0 = P / 20.
            assert!(calm[k] < 0.1 * pressure[k] && calm[k] > 0.02 * pressure[k]);
            assert!(wide[k] < 0.3 * density[k]);
        }
    }
}
