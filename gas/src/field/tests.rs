//! Tests of `field`.

use nbody::points::{Columns, Domain, Vec3};

use crate::alone::advance;
use crate::samples::{hydro, noisy};
use crate::{Gas, Hydro};

const TIME: f64 = 0.08;

/// Differences of places, velocities and energies that rounding makes.
const BARS: [f64; 3] = [4e-15, 1e-13, 4e-14];

/// Gas with a hot spot, so that steps of many lengths meet.
fn mixed(domain: &Domain) -> Gas {
    let mut gas = noisy(domain, 10, 0.5);
    for i in 0..gas.len() {
        let r = (gas.particles.x[i] - Vec3::repeat(0.5)).norm();
        gas.particles.u[i] *= 1.0 + 300.0 * (-(r / 0.15).powi(2)).exp();
    }
    gas.rates.u_pred.clone_from(&gas.particles.u);
    gas
}

/// Places, velocities and energies in the order of identities, after a run in a uniform field, whose steps are its own or those of the forces.
fn ended(hydro: &Hydro, pull: Vec3, apart: bool) -> Vec<(Vec3, Vec3, f64)> {
    let mut gas = mixed(&hydro.domain);
    gas.feel(!apart, apart);
    let column = if apart {
        &mut gas.rates.field
    } else {
        &mut gas.rates.gravity
    };
    column.fill(pull);
    let account = advance(&mut gas, hydro, 0.0, TIME, TIME).expect("a run");
    // Several bins at work, below the step of the field.
    assert!(
        account.ticks > 20 && 2 * account.updates < account.ticks * gas.len(),
        "{account:?}"
    );
    let p = &gas.particles;
    let mut order: Vec<usize> = (0..p.len()).collect();
    order.sort_by_key(|&i| p.id[i]);
    (order.into_iter())
        .map(|i| (p.x[i], p.v[i], p.u[i]))
        .collect()
}

#[test]
fn gas_that_falls_freely_does_what_it_does_at_rest() {
    let hydro = hydro(Domain::open());
    let pull = Vec3::new(0.9, -0.4, 0.2);
    let rest = ended(&hydro, Vec3::zeros(), true);
    // Both kinds of steps are exact in a uniform field: what is left is rounding, which the shocks of the hot spot multiply.
    let falling = ended(&hydro, pull, true);
    let mut worst = [0.0; 3];
    for ((x, v, u), (x0, v0, u0)) in falling.into_iter().zip(rest) {
        let dx = x - x0 - 0.5 * TIME * TIME * pull;
        let dv = v - v0 - TIME * pull;
        for (worst, error) in (worst.iter_mut()).zip([dx.norm(), dv.norm(), u / u0 - 1.0]) {
            *worst = f64::max(*worst, error.abs());
        }
    }
    assert!(worst.iter().zip(BARS).all(|(&w, bar)| w < bar), "{worst:?}");
}

#[test]
fn steps_of_the_field_do_not_shorten_those_of_the_forces_but_end_them() {
    // A field that asks for shorter steps than pressure: forces follow.
    let hydro = hydro(Domain::open());
    let updates = |pull: f64| {
        let mut gas = noisy(&hydro.domain, 8, 0.0);
        gas.feel(false, true);
        gas.rates.field.fill(Vec3::new(pull, 0.0, 0.0));
        advance(&mut gas, &hydro, 0.0, TIME, TIME)
            .expect("a run")
            .updates
    };
    let (none, weak, strong) = (updates(0.0), updates(1.0), updates(3e3));
    assert_eq!(none, weak);
    assert!(strong > 2 * none, "{strong} and {none} updates");
}
