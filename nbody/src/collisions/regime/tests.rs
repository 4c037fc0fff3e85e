//! The scaling laws against an independent evaluation of the published formulas, and their limits.

use super::Regime::*;
use super::*;

const PLANETS: Strength = Strength {
    offset: 1.9,
    coupling: 0.36,
    density: 1000.0,
};

/// Masses, radii, speed (SI), sine of the angle; regime and mass of the largest remnant by the total.
type Row = ([f64; 2], [f64; 2], f64, f64, Regime, f64);

const ROWS: [Row; 24] = [
    (
        [1.067e+24, 1.067e+23],
        [4395860.0, 2040380.0],
        19738.7,
        0.9,
        HitAndRun,
        0.909090909091,
    ),
    (
        [1.693e+23, 5.078e+21],
        [2379310.0, 739308.0],
        3551.17,
        0.0,
        PartialAccretion,
        0.996363137393,
    ),
    (
        [3.352e+24, 1.005e+23],
        [6436990.0, 2000120.0],
        14780.5,
        0.0,
        PartialAccretion,
        0.991397368687,
    ),
    (
        [2.357e+24, 7.07e+22],
        [5723920.0, 1778550.0],
        13143.2,
        0.0,
        PartialAccretion,
        0.991390868623,
    ),
    (
        [2.422e+23, 1.211e+23],
        [2681240.0, 2128100.0],
        25404.4,
        0.2,
        SuperCatastrophic,
        0.00749655081579,
    ),
    (
        [4.659e+23, 2.33e+23],
        [3334500.0, 2646600.0],
        7898.51,
        0.5,
        PartialAccretion,
        0.811326863352,
    ),
    (
        [7.676e+23, 7.676e+22],
        [3938330.0, 1828010.0],
        35368.6,
        0.9,
        HitAndRun,
        0.909090909091,
    ),
    (
        [1.053e+24, 3.16e+22],
        [4376230.0, 1359800.0],
        75364.6,
        0.2,
        Erosion,
        0.515244939213,
    ),
    (
        [1.617e+23, 4.852e+21],
        [2343440.0, 728160.0],
        40357.1,
        0.0,
        Erosion,
        0.515355057284,
    ),
    (
        [7.346e+22, 7.346e+21],
        [1801390.0, 836133.0],
        1819.98,
        0.5,
        Merging,
        1.0,
    ),
    (
        [6.426e+23, 1.928e+22],
        [3711700.0, 1153310.0],
        34091.0,
        0.5,
        Erosion,
        0.862184060312,
    ),
    (
        [1.088e+24, 3.264e+22],
        [4423830.0, 1374590.0],
        10157.9,
        0.5,
        PartialAccretion,
        0.991388251159,
    ),
    (
        [5.914e+23, 2.957e+23],
        [3610460.0, 2865630.0],
        64141.3,
        0.2,
        SuperCatastrophic,
        0.00113732009844,
    ),
    (
        [1.455e+23, 1.455e+23],
        [2262470.0, 2262470.0],
        11720.7,
        0.9,
        HitAndRun,
        0.5,
    ),
    (
        [1.511e+23, 1.511e+22],
        [2291140.0, 1063450.0],
        5143.95,
        0.2,
        PartialAccretion,
        0.94256861523,
    ),
    (
        [2.968e+24, 2.968e+23],
        [6181310.0, 2869110.0],
        27755.9,
        0.7,
        HitAndRun,
        0.909090909091,
    ),
    (
        [1.827e+24, 9.134e+23],
        [5258090.0, 4173350.0],
        6538.84,
        0.0,
        Merging,
        1.0,
    ),
    (
        [6.219e+23, 6.219e+22],
        [3671370.0, 1704100.0],
        61820.9,
        0.7,
        SuperCatastrophic,
        0.0722250260947,
    ),
    (
        [3.167e+23, 3.167e+22],
        [2931950.0, 1360890.0],
        2962.2,
        0.5,
        Merging,
        1.0,
    ),
    (
        [3.576e+23, 3.576e+23],
        [3053060.0, 3053060.0],
        5140.33,
        0.5,
        GrazeAndMerge,
        1.0,
    ),
    (
        [1.198e+23, 5.991e+22],
        [2120540.0, 1683080.0],
        3264.93,
        0.9,
        HitAndRun,
        0.666629569863,
    ),
    (
        [5.441e+24, 2.72e+24],
        [7565060.0, 6004390.0],
        35839.0,
        0.2,
        SuperCatastrophic,
        0.0599892803791,
    ),
    (
        [9.733e+23, 4.867e+23],
        [4262700.0, 3383310.0],
        10097.1,
        0.7,
        HitAndRun,
        0.666643835616,
    ),
    (
        [1.202e+23, 1.202e+22],
        [2122460.0, 985158.0],
        4765.24,
        0.5,
        PartialAccretion,
        0.95124073814,
    ),
];

fn meeting(row: &Row) -> Meeting {
    Meeting {
        g: 6.674e-11,
        m: row.0,
        radius: row.1,
        speed: row.2,
        sine: row.3,
    }
}

#[test]
fn regimes_and_largest_remnants_are_those_of_the_published_laws() {
    for row in &ROWS {
        let verdict = meeting(row).verdict(&PLANETS);
        assert_eq!(verdict.regime, row.4, "{row:?}");
        // The figures have twelve digits.
        let error = (verdict.largest / row.5 - 1.0).abs();
        assert!(error < 1e-11, "{row:?}: {error:e}");
    }
}

#[test]
fn the_largest_remnant_is_continuous_and_halves_at_the_critical_energy() {
    assert!((Severity(1.0).remnant() - 0.5).abs() < 1e-15);
    let (below, above) = (Severity(SUPER - 1e-9), Severity(SUPER + 1e-9));
    assert!((below.remnant() - above.remnant()).abs() < 2e-9);
}

#[test]
fn extreme_ratios_and_angles_have_an_outcome() {
    for ratio in [1.0, 1e-6, 1e-12] {
        for sine in [0.0, 0.5, 1.0 - 1e-15, 1.0] {
            for speed in [0.0, 1.0, 10.0, 1e3] {
                let meeting = Meeting {
                    g: 1.0,
                    m: [1.0, ratio],
                    radius: [1.0, ratio.cbrt()],
                    speed,
                    sine,
                };
                let strength = Strength {
                    density: 0.1,
                    ..PLANETS
                };
                let verdict = meeting.verdict(&strength);
                assert!(
                    verdict.largest > 0.0 && verdict.largest <= 1.0,
                    "{meeting:?} {verdict:?}"
                );
                let left = meeting.projectile_remnant(&strength);
                assert!(left > 0.0 && left <= ratio, "{meeting:?} {left}");
            }
        }
    }
}

#[test]
fn the_reverse_impact_erodes_the_projectile_with_growing_speed() {
    // Table's last but one: a grazing impact of two to one, at a hundredth to ten times its speed.
    let mut meeting = meeting(&ROWS[22]);
    let [_, own] = meeting.m;
    let speed = meeting.speed;
    let mut left = [0.01, 0.1, 1.0, 3.0, 10.0].map(|factor| {
        meeting.speed = factor * speed;
        meeting.projectile_remnant(&PLANETS) / own
    });
    assert!(left[0] == 1.0 && left[4] < 0.05, "{left:?}");
    left.reverse();
    assert!(left.is_sorted(), "{left:?}");
    // Head-on the whole projectile meets the chord through the target: area pi r^2.
    meeting.sine = 0.0;
    meeting.radius = [2.0, 1.0];
    assert!((meeting.overlap() - 2.0).abs() < 1e-15);
}
