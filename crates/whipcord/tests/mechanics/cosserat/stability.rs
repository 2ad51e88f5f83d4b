//! Buckling loads: where the stability value changes sign.
//!
//! Rods are so slender that stretch and shear move a buckling load by less than the 1e-4 asked for.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::common::{accurate, paper_robot, round, solve_with, stability_of_path, straight};
use whipcord::cosserat::Options;
use whipcord::{
    Backbone, Cable, CableCommand, Case, Disks, Loads, Material, Robot, Routing, Shortening,
    StabilityAnalysis, Stiffness, Vec3,
};

/// Radius of the cables, for a rod of length 1.
const RADIUS: f64 = 0.01;

/// Length 1, EI = 1, `EI/(EA L²) = 6·10⁻¹²`, density such that its weight is 1 at 1 m/s².
fn slender() -> Backbone {
    let diameter = 1e-5_f64;
    let young = 64.0 / (PI * diameter.powi(4));
    let rod = round(1.0, diameter, young, 0.35 * young);
    let density = 4.0 / (PI * diameter * diameter);
    Backbone { material: Material { density: Some(density), ..rod.material }, ..rod }
}

fn robot(angles: &[f64]) -> Robot {
    let cable = |(i, &angle): (usize, &f64)| {
        Cable::new(format!("cable {i}"), Routing::Straight { angle, radius: RADIUS })
    };
    let cables = angles.iter().enumerate().map(cable).collect();
    Robot::new(slender(), Disks::equally_spaced(1.0, 11, RADIUS), cables).unwrap()
}

fn stability(robot: &Robot, case: &Case) -> f64 {
    let options = Options { stability: StabilityAnalysis::Eigenvalue, ..accurate() };
    let solution = solve_with(options, robot, case).unwrap();
    let tip = solution.disks.tip().position;
    let left = solution.diagnostics.stability_lost_at.is_some();
    assert!(left || tip.x.hypot(tip.y) < 1e-8, "the rod is to be straight: {tip:?}");
    stability_of_path(&solution)
}

fn pushed(force: f64) -> Loads {
    Loads { tip_force: Vec3::new(0.0, 0.0, -force), ..Loads::default() }
}

/// The value is positive just below the load and negative just above it.
fn changes_sign_at(critical: f64, value: impl Fn(f64) -> f64) {
    for factor in [0.5, 0.9, 1.0 - 1e-4] {
        assert!(value(factor * critical) > 0.0, "below {critical}: {}", value(factor * critical));
    }
    for factor in [1.0 + 1e-4, 1.1, 1.5] {
        assert!(value(factor * critical) < 0.0, "above {critical}: {}", value(factor * critical));
    }
}

#[test]
fn a_clamped_free_column_buckles_at_eulers_load() {
    let rod = robot(&[]);
    let at = |force| stability(&rod, &Case { loads: pushed(force), ..Case::default() });
    changes_sign_at(FRAC_PI_2 * FRAC_PI_2, at);
    // Under a dead end load the value is 1 − P/P_Euler.
    assert!((at(1.0) - (1.0 - 4.0 / (PI * PI))).abs() < 1e-6);
}

/// Greenhill, Proc. Cambridge Phil. Soc. 4 (1881) 65–73: `q L³/EI` = 7.837347438943484, from the first
/// zero of the Bessel function of order −1/3.
#[test]
fn a_column_under_its_own_weight_buckles_at_greenhills_load() {
    let rod = robot(&[]);
    let under = |gravity: f64| {
        let loads = Loads { gravity: Some(Vec3::new(0.0, 0.0, -gravity)), ..Loads::default() };
        stability(&rod, &Case { loads, ..Case::default() })
    };
    changes_sign_at(7.837_347_438_943_484, under);
}

/// A cable that runs along the axis goes with the rod wherever it bends: its tension does no work on
/// a buckle, and the column under an end load buckles when it would without it.
#[test]
fn a_central_cable_never_buckles_a_rod() {
    let cable = Cable::new("central", Routing::Straight { angle: 0.0, radius: 0.0 });
    let disks = Disks::equally_spaced(1.0, 11, RADIUS);
    let rod = Robot::new(slender(), disks, vec![cable]).unwrap();
    for tension in [1.0, 10.0, 1000.0, 1e6] {
        let pulled = Case::with_tensions(&[tension]);
        assert!((stability(&rod, &pulled) - 1.0).abs() < 1e-3, "{tension} N");
        let loaded = |force| Case { loads: pushed(force), ..pulled.clone() };
        changes_sign_at(FRAC_PI_2 * FRAC_PI_2, |force| stability(&rod, &loaded(force)));
    }
}

/// Beside the axis a cable bends the rod, and that is all: up to where the section folds there is
/// but one shape, and it is stable.
#[test]
fn a_straight_cable_beside_the_axis_never_buckles_a_rod() {
    let rod = paper_robot(vec![straight(30.0)]);
    let stiffness = 1.1e9 * PI * 0.003_f64.powi(4) / 64.0;
    let folds =
        1.0 / (1.0 / (1.1e9 * PI * 0.003_f64.powi(2) / 4.0) + 0.008_f64.powi(2) / stiffness);
    for fraction in [0.01, 0.3, 0.6, 0.9, 0.99] {
        let case = Case::with_tensions(&[fraction * folds]);
        let solution = solve_with(Options::default(), &rod, &case).unwrap();
        assert!(solution.diagnostics.stable == Some(true), "{fraction}");
    }
}

/// Cables around the rod, all shortened alike so that they stay taut.
fn locked(cables: usize, force: f64, axial_stiffness: Option<f64>) -> f64 {
    let angles: Vec<f64> = (0..cables).map(|i| TAU * i as f64 / cables as f64).collect();
    let free = robot(&angles);
    let with = |cable: &Cable| Cable { axial_stiffness, ..cable.clone() };
    let elastic = free.cables().iter().map(with).collect();
    let rod = Robot::new(slender(), free.disks().clone(), elastic).unwrap();
    // Of a stretch that takes about 100 N of tension from each of them.
    let area = PI * 1e-10 / 4.0;
    let young = 64.0 / (PI * 1e-20);
    let shortening =
        100.0 * (cables as f64 / (young * area) + axial_stiffness.map_or(0.0, |k| 1.0 / k));
    let command = CableCommand { tension: None, shortening: Some(Shortening::Length(shortening)) };
    stability(
        &rod,
        &Case { commands: vec![command; cables], loads: pushed(force), ..Case::default() },
    )
}

/// Locked cables on both sides keep the tip from turning: the column is then clamped at one end and
/// guided at the other.
#[test]
fn locked_cables_hold_the_tip_upright() {
    for cables in [3, 4, 6] {
        changes_sign_at(PI * PI, |force| locked(cables, force, None));
    }
    // Two of them do so in their own plane only.
    changes_sign_at(FRAC_PI_2 * FRAC_PI_2, |force| locked(2, force, None));
}

/// Elastic cables hold the tip like a spring of `k = ½ n EA r²/L` against its turning; with
/// `EI = L = 1` the buckling load solves `k sin √P + √P cos √P = 0`.
#[test]
fn elastic_locked_cables_hold_it_like_a_spring() {
    for stiffness in [1e3, 1e4, 1e5] {
        let spring = 0.5 * 3.0 * stiffness * RADIUS * RADIUS;
        let (mut low, mut high) = (FRAC_PI_2, PI);
        for _ in 0..60 {
            let middle: f64 = 0.5 * (low + high);
            // Positive below the root: the tip would turn back.
            if spring * middle.sin() + middle * middle.cos() > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        changes_sign_at(low * low, |force| locked(3, force, Some(stiffness)));
    }
}

/// Four locked straight cables have three independent lengths: what one of them does the others do,
/// too, and nothing counts twice.
#[test]
fn a_locked_cable_too_many_changes_nothing() {
    let (three, four) = (locked(3, 5.0, None), locked(4, 5.0, None));
    assert!((three - four).abs() < 1e-5, "{three} {four}");
}

/// Straight cables, then cables that run from the same holes to the middle of the tip; three of each that is
/// asked for, around a column of length 1, EI = 1 and EA = 1e8 that does not shear. They are shortened so that
/// each pulls with 20 N without load.
fn held(
    straight: bool,
    converging: bool,
    axial_stiffness: Option<f64>,
    torsion: f64,
) -> (Robot, Case) {
    const AXIAL: f64 = 1e8;
    let stiffness = Stiffness::Diagonal {
        shear: None,
        axial: Some(AXIAL.into()),
        bending: [1.0; 2].into(),
        torsion: torsion.into(),
    };
    let backbone = Backbone { stiffness: Some(stiffness), shearable: false, ..Backbone::new(1.0) };
    let mut cables = Vec::new();
    for i in 0..3 {
        let angle = TAU * f64::from(i) / 3.0;
        let start = [RADIUS * angle.cos(), RADIUS * angle.sin()];
        let mut add = |routing| {
            let name = format!("cable {}", cables.len());
            cables.push(Cable { axial_stiffness, ..Cable::new(name, routing) });
        };
        if straight {
            add(Routing::Straight { angle, radius: RADIUS });
        }
        if converging {
            add(Routing::Linear { start, end: [0.0; 2] });
        }
    }
    let pulls = 20.0 * cables.len() as f64 / AXIAL;
    let shortening = pulls + axial_stiffness.map_or(0.0, |k| 20.0 / k);
    let command = CableCommand { tension: None, shortening: Some(Shortening::Length(shortening)) };
    let case = Case { commands: vec![command; cables.len()], ..Case::default() };
    (Robot::new(backbone, Disks::equally_spaced(1.0, 11, RADIUS), cables).unwrap(), case)
}

/// Timoshenko and Gere, Theory of Elastic Stability, arts. 2.1–2.4: where cables hold the tip, the load at which
/// the stability value changes its sign is the column's. Locked straight cables keep `∫ κ ds`, the turn of the
/// tip, at 0: a clamped and guided column, `π²`. Cables whose distance from the axis falls to 0 at the tip
/// keep `∫ (1 − s) κ ds`, how far the tip is aside, at 0: clamped and pinned, `tan √P = √P`. Both together
/// clamp both ends: `4π²`.
#[test]
fn locked_cables_make_the_columns_of_the_textbooks() {
    // As both sets of cables are of one length, they are elastic there: by 1e-6 of what the column gives.
    for (straight, converging, stiffness, exact) in [
        (false, false, None, FRAC_PI_2 * FRAC_PI_2),
        (true, false, None, PI * PI),
        (false, true, None, 20.190_728_556_426_63),
        (true, true, Some(1e11), 4.0 * PI * PI),
    ] {
        let (robot, case) = held(straight, converging, stiffness, 0.7);
        let value = |force| stability(&robot, &Case { loads: pushed(force), ..case.clone() });
        let (below, above) = (value((1.0 - 1e-5) * exact), value((1.0 + 1e-5) * exact));
        assert!(below > 0.0 && above < 0.0, "{exact}: {below} {above}");
    }
}

/// Love, Theory of Elasticity, art. 272 and Greenhill (1883): under an axial moment a rod that is clamped at both
/// ends buckles at the root 8.986818915818128 of `tan (M/2) = M/2`. It is stiff against torsion, so that the
/// cables stay straight.
#[test]
fn a_twisted_rod_with_a_held_tip_buckles_at_greenhills_moment() {
    let (robot, case) = held(true, true, Some(1e11), 1e7);
    let value = |moment: f64| {
        let loads = Loads { tip_moment: moment * Vec3::Z, ..Loads::default() };
        stability(&robot, &Case { loads, ..case.clone() })
    };
    let exact = 8.986_818_915_818_128;
    let (below, above) = (value((1.0 - 1e-4) * exact), value((1.0 + 1e-4) * exact));
    assert!(below > 0.0 && above < 0.0, "{below} {above}");
}
