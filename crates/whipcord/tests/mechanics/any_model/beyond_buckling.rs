//! Robots whose load path loses its stability: the answer is the stable equilibrium beside it, by every model.
//!
//! Round rods have length 1 and a bending stiffness of 1, so that Euler's load is (π/2)², and π² where locked cables hold the tip
//! upright.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use whipcord::{
    Actuation, Backbone, Cable, Case, Diagnostics, Disks, Loads, ModelKind, NoStability, Robot,
    Routing, Shortening, Solution, StabilityAnalysis, Stations, Stiffness, Vec3,
};

use crate::common::{WITH_FORCES, model_with_forces};

const EULER: f64 = FRAC_PI_2 * FRAC_PI_2;
/// With so many straight cables all round.
fn robot(cables: usize, axial: Option<f64>) -> Robot {
    let stiffness = Stiffness::Diagonal {
        shear: None,
        axial: axial.map(Into::into),
        bending: [1.0; 2].into(),
        torsion: 0.8.into(),
    };
    let backbone = Backbone {
        stiffness: Some(stiffness),
        extensible: axial.is_some(),
        shearable: false,
        ..Backbone::new(1.0)
    };
    let cable = |i: usize| {
        let angle = TAU * i as f64 / cables as f64;
        Cable::new(format!("c{i}"), Routing::Straight { angle, radius: 0.05 })
    };
    let disks = Disks::equally_spaced(1.0, 21, 0.06);
    Robot::new(backbone, disks, (0..cables).map(cable).collect()).unwrap()
}

fn under(loads: Loads, cables: usize) -> Case {
    Case { loads, ..Case::with_shortenings(&vec![Shortening::Length(0.0); cables]) }
}

fn pushed(force: f64, cables: usize) -> Case {
    under(Loads { tip_force: -force * Vec3::Z, ..Loads::default() }, cables)
}

fn solve(kind: ModelKind, robot: &Robot, case: &Case) -> Solution {
    let mut model = model_with_forces(kind, Stations::Disks, Actuation::Natural)
        .prepare(robot, &case.loads)
        .unwrap();
    let first = model.solve(case, None).unwrap();
    assert_eq!(first, model.solve(case, None).unwrap(), "{kind} is not deterministic");
    first
}

fn eigenvalue(kind: ModelKind, robot: &Robot, case: &Case) -> Result<f64, NoStability> {
    let model = model_with_forces(kind, Stations::Disks, Actuation::Natural)
        .with_stability(StabilityAnalysis::Eigenvalue);
    let solution = model.prepare(robot, &case.loads).unwrap().solve(case, None).unwrap();
    let Diagnostics { stability, stability_absent, .. } = solution.diagnostics;
    stability.ok_or_else(|| stability_absent.unwrap())
}

/// Complete elliptic integrals of the first and second kind by the arithmetic-geometric mean.
fn elliptic(k: f64) -> [f64; 2] {
    let (mut a, mut b, mut c) = (1.0, (1.0 - k * k).sqrt(), k);
    let (mut sum, mut power) = (0.5 * c * c, 0.5);
    while c.abs() > 1e-16 {
        (a, b, c) = (0.5 * (a + b), (a * b).sqrt(), 0.5 * (a - b));
        power *= 2.0;
        sum += power * c * c;
    }
    let first = FRAC_PI_2 / a;
    [first, first * (1.0 - sum)]
}

/// The tip of a buckled column under this force: how far beside the axis and along it.
fn buckled(force: f64) -> [f64; 2] {
    let (mut low, mut high) = (0.0, 1.0 - 1e-12);
    for _ in 0..200 {
        let k: f64 = 0.5 * (low + high);
        if elliptic(k)[0] < force.sqrt() { low = k } else { high = k }
    }
    let [first, second] = elliptic(low);
    [2.0 * low / first, 2.0 * second / first - 1.0]
}

#[test]
fn a_perfect_column_buckles() {
    let robot = robot(1, None);
    for kind in WITH_FORCES {
        let near: f64 = match kind {
            ModelKind::Cosserat | ModelKind::CosseratDisks => 1e-5,
            _ => 3e-2,
        };
        for factor in [1.05, 1.3, 2.0, 5.0] {
            let case =
                Case { loads: pushed(factor * EULER, 1).loads, ..Case::with_tensions(&[0.0]) };
            let solution = solve(kind, &robot, &case);
            let name = format!("{kind} at {factor} times Euler's load");
            assert_eq!(solution.diagnostics.stable, Some(true), "{name}");
            let lost_at = solution.diagnostics.stability_lost_at.unwrap();
            assert!((lost_at * factor - 1.0).abs() < near.max(1e-4), "{name}: {lost_at}");
            let tip = solution.disks.tip().position;
            let [beside, along] = buckled(factor * EULER);
            let off = [tip.x.hypot(tip.y) - beside, tip.z - along];
            assert!(off.iter().all(|x| x.abs() < near), "{name}: {tip:?}, {off:?}");
        }
        let unstable = solve(kind, &robot, &pushed(0.98 * EULER, 1));
        assert_eq!(unstable.diagnostics.stable, Some(true), "{kind} below Euler's load");
        assert_eq!(unstable.diagnostics.stability_lost_at, None, "{kind} below Euler's load");
    }
}

/// Cables that are at their length without tension hold the tip upright: some of them would have to get longer however it turns.
#[test]
fn locked_cables_carry_four_times_the_load() {
    for cables in [3, 4, 6] {
        let robot = robot(cables, None);
        for kind in WITH_FORCES {
            for factor in [1.2, 2.0, 3.9] {
                let solution = solve(kind, &robot, &pushed(factor * EULER, cables));
                let Diagnostics { stable, stability_lost_at, .. } = solution.diagnostics;
                let name = format!("{kind}, {cables} cables, {factor} times Euler's load");
                assert_eq!((stable, stability_lost_at), (Some(true), None), "{name}");
                let tip = solution.disks.tip().position;
                assert!((tip - Vec3::Z).norm() < 1e-6, "{name}: {tip:?}");
            }
            let solution = solve(kind, &robot, &pushed(1.1 * PI * PI, cables));
            let name = format!("{kind}, {cables} cables above the critical load");
            let moved = (solution.disks.tip().position - Vec3::Z).norm() > 0.1;
            // Of models with few coordinates some snap far, and no stable shape is found beside the straight one.
            let may_stay = matches!(kind, ModelKind::PseudoRigidBody | ModelKind::FourBar);
            assert!(moved || may_stay, "{name}");
            assert_eq!(solution.diagnostics.stable, Some(moved), "{name}");
        }
    }
}

/// A backbone that stretches leaves locked cables slack under compression: the robot leans until some of them pull.
#[test]
fn a_compressed_robot_leans_into_its_locked_cables() {
    for cables in [3, 4, 6] {
        let robot = robot(cables, Some(1e5));
        for kind in [ModelKind::Cosserat, ModelKind::CosseratDisks] {
            for factor in [1.2, 3.85] {
                let solution = solve(kind, &robot, &pushed(factor * EULER, cables));
                let name = format!("{kind}, {cables} cables, {factor} times Euler's load");
                assert_eq!(solution.diagnostics.stable, Some(true), "{name}");
                let pulling = solution.cables.iter().filter(|c| c.tension.unwrap() > 0.0).count();
                assert!(pulling >= 2, "{name}: {pulling} cables pull");
            }
        }
    }
}

/// A dead moment on a free tip has no potential. Where it rolls the robot up there is one equilibrium, whose stability no energy
/// tells; a small one leaves it stable whatever the moment does.
#[test]
fn dead_moments_have_no_verdict_where_they_decide() {
    let robot = robot(1, None);
    let turned = |moment: Vec3| Case {
        loads: Loads { tip_moment: moment, ..Loads::default() },
        ..Case::with_tensions(&[0.0])
    };
    for kind in WITH_FORCES {
        assert_eq!(
            eigenvalue(kind, &robot, &turned(3.0 * Vec3::Y)),
            Err(NoStability::DeadMoments),
            "{kind}"
        );
        let small = eigenvalue(kind, &robot, &turned(Vec3::new(0.2, 0.3, 0.1)));
        assert!(small.is_ok_and(|least| least > 0.0), "{kind}: {small:?}");
    }
}
