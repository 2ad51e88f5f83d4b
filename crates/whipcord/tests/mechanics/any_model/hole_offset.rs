//! Cables that run beside the centres of their holes.

use core::f64::consts::TAU;

use whipcord::derivatives::{Hold, Place};
use whipcord::{
    Actuation, Cable, Case, Disks, HoleOffset, Interpolation, Model, ModelKind, Parameter, Problem,
    Robot, Routing, Shortening, Solution, Stations, Vec3,
};

use crate::common::{model_with_forces, paper_backbone};

const MODELS: [ModelKind; 5] = [
    ModelKind::Cosserat,
    ModelKind::CosseratDisks,
    ModelKind::PiecewiseConstantCurvature,
    ModelKind::PseudoRigidBody,
    ModelKind::FourBar,
];
const COURSES: [Interpolation; 3] =
    [Interpolation::Spline, Interpolation::Pchip, Interpolation::Fourier];

fn robot(
    radius: f64,
    lists: [&[usize]; 2],
    interpolation: Interpolation,
    off: HoleOffset,
) -> Robot {
    let cables = lists.iter().enumerate().map(|(i, holes)| Cable {
        hole_offset: off,
        axial_stiffness: Some(3e3),
        ..Cable::new(format!("c{i}"), Routing::Holes { holes: holes.to_vec(), interpolation })
    });
    let disks = Disks::equally_spaced(0.18, 10, radius).with_holes(36);
    Robot::new(paper_backbone(), disks, cables.collect()).unwrap()
}

const ONE: [usize; 10] = [1, 2, 3, 5, 5, 5, 4, 4, 3, 2];
const OTHER: [usize; 7] = [20, 20, 19, 19, 18, 18, 18];

fn case() -> Case {
    let mut case = Case::with_shortenings(&[Shortening::Length(6e-3), Shortening::Length(1e-3)]);
    case.loads.tip_force = Vec3::new(0.05, -0.03, 0.02);
    case
}

fn solve(kind: ModelKind, robot: &Robot) -> Solution {
    let case = case();
    let model: Model = model_with_forces(kind, Stations::default(), Actuation::Natural);
    model.prepare(robot, &case.loads).unwrap().solve_to_the_end(&case).unwrap()
}

/// Against the same robot with holes on another circle, whose lists name other holes.
#[test]
fn an_offset_is_another_circle_of_holes() {
    let turned = |holes: &[usize]| holes.iter().map(|hole| (hole + 2) % 36 + 1).collect::<Vec<_>>();
    let off = HoleOffset { angle: 3.0 * TAU / 36.0, radius: -0.7e-3 };
    for kind in MODELS {
        for interpolation in COURSES {
            let moved = robot(0.008, [&ONE, &OTHER], interpolation, off);
            let (one, other) = (turned(&ONE), turned(&OTHER));
            let by_hand = robot(0.0073, [&one, &other], interpolation, HoleOffset::default());
            for s in [0.0, 0.031, 0.077, 0.12] {
                let [a, b] = [&moved, &by_hand].map(|robot| robot.routes()[0].at(s));
                assert!((a.offset - b.offset).norm() < 1e-15, "{interpolation:?} at {s}");
                assert!((a.slope - b.slope).norm() < 1e-13, "{interpolation:?} at {s}");
            }
            let [a, b] = [&moved, &by_hand].map(|robot| solve(kind, robot));
            for (a, b) in a.disks.poses.iter().zip(&b.disks.poses) {
                let off = (a.position - b.position).norm();
                assert!(off < 1e-9, "{kind}, {interpolation:?}: {off:e} m");
            }
            let straight =
                solve(kind, &robot(0.008, [&ONE, &OTHER], interpolation, HoleOffset::default()));
            assert!((straight.disks.tip().position - a.disks.tip().position).norm() > 5e-3);
        }
    }
}

/// Against answers of robots with slightly other offsets.
#[test]
fn derivatives_by_an_offset() {
    let off = HoleOffset { angle: 0.03, radius: 0.4e-3 };
    for kind in MODELS {
        for interpolation in COURSES {
            let at = |angle: f64, radius: f64| {
                let off = HoleOffset { angle: off.angle + angle, radius: off.radius + radius };
                let mut robot = robot(0.008, [&ONE, &OTHER], interpolation, off);
                // Of the first cable alone.
                let mut cables = robot.cables().to_vec();
                cables[1].hole_offset = HoleOffset::default();
                robot =
                    Robot::new(robot.backbone().clone(), robot.disks().clone(), cables).unwrap();
                robot
            };
            let parameters = [Parameter::Angle { cable: 0 }, Parameter::Radius { cable: 0 }];
            let (robot, case) = (at(0.0, 0.0), case());
            let model = model_with_forces(kind, Stations::default(), Actuation::Natural);
            let mut prepared = model.prepare(&robot, &case.loads).unwrap();
            let (_, derivatives) =
                prepared.solve_with_derivatives(&case, None, &parameters).unwrap();
            assert_eq!(parameters[0].value(&robot, &case).unwrap(), off.angle);
            assert_eq!(parameters[1].value(&robot, &case).unwrap(), off.radius);
            for (index, h) in [2e-4, 2e-6].into_iter().enumerate() {
                let tip = |by: f64| {
                    let robot = if index == 0 { at(by, 0.0) } else { at(0.0, by) };
                    solve(kind, &robot).disks.tip().position
                };
                let wide = (tip(2.0 * h) - tip(-2.0 * h)) / (4.0 * h);
                let slope = (4.0 * ((tip(h) - tip(-h)) / (2.0 * h)) - wide) / 3.0;
                let found = derivatives.parameter(index, Hold::Commands).twist(Place::Tip).linear;
                let off = (found - slope).norm() / slope.norm();
                assert!(
                    off < 2e-6,
                    "{kind}, {interpolation:?}, {index}: {found:?} {slope:?} {off:e}"
                );
            }
        }
    }
}

#[test]
fn a_cable_stays_on_its_side_of_the_axis() {
    let disks = Disks::equally_spaced(0.18, 10, 0.008).with_holes(36);
    let off = HoleOffset { angle: 0.0, radius: -8.1e-3 };
    let cable = Cable { hole_offset: off, ..Cable::new("c", Routing::holes(ONE.to_vec())) };
    let error = Robot::new(paper_backbone(), disks, vec![cable]).unwrap_err();
    assert_eq!(error.path, "cables[0].hole_radius_offset");
    assert!(matches!(error.problem, Problem::BeyondAxis { .. }));
}
