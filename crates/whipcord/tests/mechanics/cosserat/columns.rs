//! Classic columns and strips without cables: the load at which the straight shape loses its stability,
//! and that there is an answer right beside it.
//!
//! Rods have length 1 and neither stretch nor shear, so that the loads are those of the textbooks.

use crate::common;
use core::f64::consts::PI;

use crate::common::solve_with;
use whipcord::cosserat::Options;
use whipcord::{
    Along, Backbone, Cable, Case, Disks, DistributedLoad, Loads, NoStability, PointLoad, Robot,
    Routing, Shortening, StabilityAnalysis, Stiffness, Vec3,
};

/// A rod of these bending stiffnesses about x and y, the same or given at places.
fn rod(bending: Along<[f64; 2]>, torsion: f64) -> Robot {
    let stiffness =
        Stiffness::Diagonal { shear: None, axial: None, bending, torsion: torsion.into() };
    let backbone = Backbone {
        stiffness: Some(stiffness),
        extensible: false,
        shearable: false,
        ..Backbone::new(1.0)
    };
    Robot::new(backbone, Disks::equally_spaced(1.0, 2, 0.01), vec![]).unwrap()
}

fn round(bending: f64) -> Along<[f64; 2]> {
    Along::Uniform([bending; 2])
}

fn pushed(force: f64) -> Loads {
    Loads { tip_force: -force * Vec3::Z, ..Loads::default() }
}

fn stability(robot: &Robot, loads: Loads) -> f64 {
    let lengths = vec![Shortening::Length(1e-4); robot.cables().len()];
    let case = Case { loads, ..Case::with_shortenings(&lengths) };
    let solution = solve_with(
        Options { stability: StabilityAnalysis::Eigenvalue, ..Options::default() },
        robot,
        &case,
    )
    .unwrap_or_else(|e| panic!("{e}"));
    let tip = solution.shape.tip().position;
    let left = solution.diagnostics.stability_lost_at.is_some();
    assert!(tip.is_finite() && (left || (tip - Vec3::Z).norm() < 1e-3), "{tip:?} is not straight");
    common::stability_of_path(&solution)
}

/// The value is positive below the load and negative above it, and there is one at every load around
/// it, however close.
fn loses_stability_at(critical: f64, robot: &Robot, loads: impl Fn(f64) -> Loads) {
    for below in [0.3, 1.0 - 1e-4] {
        let value = stability(robot, loads(below * critical));
        assert!(value > 0.0, "{below} of {critical}: {value}");
    }
    for above in [1.0 + 1e-4, 1.3] {
        let value = stability(robot, loads(above * critical));
        assert!(value < 0.0, "{above} of {critical}: {value}");
    }
    // What counts as neutral ends at 1e-6, on some steps a little earlier than on others.
    for beside in [-3e-6, 0.0, 6e-7, 8e-7, 9e-7, 1e-6, 1.1e-6, 1.2e-6, 3e-6] {
        let value = stability(robot, loads((1.0 + beside) * critical));
        assert!(value.abs() < 3e-5, "{beside} beside {critical}: {value}");
    }
}

/// Timoshenko and Gere, Theory of Elastic Stability, art. 2.11: P at the tip and P at half the length,
/// `tan(k₁/2) tan(k₂/2) = 2 k₁/k₂` with `k₁² = P`, `k₂² = 2P`.
#[test]
fn a_column_under_two_loads() {
    let middle =
        |force: f64| PointLoad { at: 0.5, force: -force * Vec3::Z, ..PointLoad::default() };
    let loads = |force: f64| Loads { points: vec![middle(force)], ..pushed(force) };
    loses_stability_at(2.067_232_896_738_349, &rod(round(1.0), 0.7), loads);
}

/// The same, art. 2.14: the lower half four times as stiff, `tan(k₁/2) tan(k₂/2) = k₁/k₂` with
/// `k₁² = P`, `k₂² = P/4`.
#[test]
fn a_stepped_column() {
    let bending = Along::At {
        arc_lengths: vec![0.0, 0.5, 0.5, 1.0],
        values: vec![[4.0; 2], [4.0; 2], [1.0; 2], [1.0; 2]],
    };
    loses_stability_at(6.061_044_348_559_758, &rod(bending, 1.0), pushed);
}

/// A truncated cone, twice as thick at the base as at the tip: EI grows with the fourth power of the
/// distance x from its apex, and `y = x sin(√P (1 − 1/x))` solves `y″ + P y/x⁴ = 0`; that it is upright
/// at the base asks for `tan(√P/2) = −√P/2`.
#[test]
fn a_conical_column() {
    // So thin that it hardly gets shorter.
    let tip: f64 = 1e-4;
    let young = 64.0 / (PI * tip.powi(4));
    let mut backbone = common::round(1.0, tip, young, 0.4 * young);
    backbone.section = Some(whipcord::Section::Round {
        outer: Along::PerDisk(vec![2.0 * tip, tip]),
        inner: 0.0.into(),
    });
    let robot = Robot::new(backbone, Disks::equally_spaced(1.0, 2, 0.01), vec![]).unwrap();
    loses_stability_at(16.463_433_462_777_81, &robot, pushed);
}

/// Prandtl (1899) and Michell (1899): a strip that all but does not bend edgewise tips over sideways
/// under a force at its end at `4.0126 √(EI GJ)/L²`, twice the first zero of the Bessel function of order
/// −1/4, and under a load all along it at `12.854 √(EI GJ)/L³`, six times that of order −1/6.
#[test]
fn a_strip_tips_over_sideways() {
    let strip = rod(Along::Uniform([1.0, 1e8]), 0.7);
    let scale = 0.7_f64.sqrt();
    let edgewise = |force: f64| Loads { tip_force: force * Vec3::X, ..Loads::default() };
    loses_stability_at(4.012_599_343_578_901 * scale, &strip, edgewise);
    let spread = |force: f64| Loads {
        distributed: vec![DistributedLoad::uniform(1.0, force * Vec3::X)],
        ..Loads::default()
    };
    loses_stability_at(12.853_763_321_383_318 * scale, &strip, spread);
}

/// The same with a cable that is held at its length, but so soft that it holds nothing.
#[test]
fn a_strip_with_a_soft_locked_cable_tips_over_as_without_it() {
    for edge in [1e4, 1e6, 1e8] {
        let bare = rod(Along::Uniform([1.0, edge]), 0.7);
        let routing = Routing::Straight { angle: 0.4, radius: 0.01 };
        let soft = Cable { axial_stiffness: Some(1e-9), ..Cable::new("soft", routing) };
        let strip = Robot::new(bare.backbone().clone(), bare.disks().clone(), vec![soft]).unwrap();
        let edgewise = |force: f64| Loads { tip_force: force * Vec3::X, ..Loads::default() };
        let values = |factor: f64| {
            let force = factor * 4.012_599_343_578_901 * 0.7_f64.sqrt();
            [&bare, &strip].map(|robot| stability(robot, edgewise(force)))
        };
        for below in [0.01, 0.3, 0.6, 0.9] {
            let [bare, locked] = values(below);
            assert!((bare - locked).abs() < 1e-6, "{edge:e}, {below}: {bare} and {locked}");
        }
    }
}

#[test]
fn stability_that_is_left_out_is_said_to_be() {
    let column = rod(round(1.0), 0.7);
    let case = Case { loads: pushed(1.0), ..Case::default() };
    for asked in [StabilityAnalysis::Off, StabilityAnalysis::Verdict, StabilityAnalysis::Eigenvalue]
    {
        let options = Options { stability: asked, ..Options::default() };
        let diagnostics = solve_with(options, &column, &case).unwrap().diagnostics;
        let is_off = asked == StabilityAnalysis::Off;
        assert_eq!(diagnostics.stable, (!is_off).then_some(true));
        assert_eq!(diagnostics.stability.is_some(), asked == StabilityAnalysis::Eigenvalue);
        assert_eq!(diagnostics.stability_absent, is_off.then_some(NoStability::NotAsked));
    }
}

/// Beck (1952): under a force that follows its tip a column flutters at 20.05 EI/L², but the straight
/// shape stays the only equilibrium. Without energy there is no stability value.
#[test]
fn a_follower_force_has_no_buckling_load() {
    let column = rod(round(1.0), 0.7);
    for force in [10.0, 25.0, 60.0, 200.0] {
        let loads = Loads { tip_follower: true, ..pushed(force) };
        let case = Case { loads, ..Case::default() };
        let solution = solve_with(Options::default(), &column, &case).unwrap();
        assert!((solution.shape.tip().position - Vec3::Z).norm() < 1e-9, "{force}");
        assert_eq!(solution.diagnostics.stability, None);
        assert_eq!(solution.diagnostics.stability_absent, Some(NoStability::Followers));
    }
}
