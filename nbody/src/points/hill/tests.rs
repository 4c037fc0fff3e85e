//! Hill's frame against the solution for guiding centre and epicycle.

use super::*;

const KEPLER: Hill = Hill {
    rate: 0.7,
    shear: 1.5,
    middle: 2.0,
};

fn state() -> (Vec3, Vec3) {
    (Vec3::new(2.3, 0.4, 0.1), Vec3::new(0.05, -0.3, 0.02))
}

/// The free motion after `t`, from the solution for guiding centre and epicycle.
fn free(hill: &Hill, (x, v): (Vec3, Vec3), t: f64) -> (Vec3, Vec3) {
    let (omega, q) = (hill.rate, hill.shear);
    let kappa = (2.0 * (2.0 - q)).sqrt() * omega;
    let w = hill.relative(x, v);
    let centre = x.x + 2.0 * omega * w.y / (kappa * kappa);
    let (a, b) = (x.x - centre, w.x / kappa);
    let (s, c) = (kappa * t).sin_cos();
    let place = centre + a * c + b * s;
    let speed = kappa * (b * c - a * s);
    let y = x.y
        - q * omega * (centre - hill.middle) * t
        - 2.0 * omega / kappa * (a * s + b * (1.0 - c));
    let across = -q * omega * (centre - hill.middle) - 2.0 * omega * (a * c + b * s);
    (
        Vec3::new(place, y, x.z + v.z * t),
        Vec3::new(speed, across, v.z),
    )
}

#[test]
fn steps_of_any_length_end_where_the_free_motion_does() {
    for shear in [0.0, 1.0, 1.5, 1.9] {
        let hill = Hill { shear, ..KEPLER };
        for step in [1e-6, 0.1, 0.5, 2.0, -0.3] {
            let (x, v) = state();
            let mean = hill.opened(x, v, step);
            let end = x + step * mean;
            let whole = Phase {
                step,
                elapsed: step,
            };
            let seen = hill.seen(end, mean, whole);
            let (exact_x, exact_v) = free(&hill, (x, v), step);
            let error = (end - exact_x).norm().max((seen - exact_v).norm());
            assert!(error < 8e-15, "q {shear}, step {step}: {error:e}");
            let (at_once, fast) = hill.free(step).of(x, v);
            let error = (at_once - exact_x).norm().max((fast - exact_v).norm());
            assert!(error < 8e-15, "q {shear}, at once {step}: {error:e}");
        }
    }
}

#[test]
fn the_frame_accelerates_as_the_equations_say() {
    let (x, v) = state();
    let [omega, q] = [KEPLER.rate, KEPLER.shear];
    let a = KEPLER.acceleration(x, v);
    let tide = 2.0 * q * omega * omega * (x.x - KEPLER.middle);
    let expected = Vec3::new(2.0 * omega * v.y + tide, -2.0 * omega * v.x, 0.0);
    assert!((a - expected).norm() < 1e-15);
    // And so does the free motion that the steps are judged by.
    let later = free(&KEPLER, (x, v), 1e-5).1;
    assert!(((later - v) / 1e-5 - expected).norm() < 1e-5);
    let w = KEPLER.relative(x, v);
    let change = a + Vec3::new(0.0, q * omega * v.x, 0.0);
    assert!((KEPLER.turning(w) - change).norm() < 1e-15);
}

#[test]
fn an_impulse_in_mid_step_changes_what_is_seen_by_itself() {
    let (x, v) = state();
    let dv = Vec3::new(0.03, -0.02, 0.01);
    for elapsed in [0.0, 0.1, 0.3, 0.4] {
        let phase = Phase { step: 0.4, elapsed };
        let mean = KEPLER.opened(x, v, 0.4);
        let now = x + elapsed * mean;
        let before = KEPLER.seen(now, mean, phase);
        let pushed = mean + KEPLER.pushed(dv, phase);
        let error = (KEPLER.seen(now, pushed, phase) - before - dv).norm();
        assert!(error < 1e-15, "{elapsed}: {error:e}");
        // What comes later keeps the canonical momentum that it has then.
        let canonical = |x: Vec3, v: Vec3| v.y + 2.0 * KEPLER.rate * (x.x - KEPLER.middle);
        let end = now + (0.4 - elapsed) * pushed;
        let whole = Phase {
            step: 0.4,
            elapsed: 0.4,
        };
        let last = canonical(end, KEPLER.seen(end, pushed, whole));
        assert!((last - canonical(now, before + dv)).abs() < 1e-15);
    }
}
