//! Jacobian and compliance of the models of sections, against differences of their own answers.

use crate::common::{bending_stiffness, helix, paper_robot, straight};
use whipcord::differences::differentiate;
use whipcord::kinematics::{ComplianceUnknown, DerivativeMethod, Local};
use whipcord::{
    Actuation, Cable, CableCommand, Case, Differentiable as _, DistributedLoad, Model, ModelKind,
    PointLoad, Pose, Prepared, Robot, Shortening, Solution, SolveError, Stations, Twist,
    UnitQuaternion, Vec3,
};

const KINDS: [ModelKind; 2] = [ModelKind::PiecewiseConstantCurvature, ModelKind::PseudoRigidBody];

fn model(kind: ModelKind, at: f64) -> Model {
    let mut model = Model::new(kind, Stations::At(vec![at]), Actuation::Natural);
    match &mut model {
        Model::PiecewiseConstantCurvature(options) => options.residual = 1e-14,
        Model::PseudoRigidBody(options) => options.residual = 1e-14,
        _ => panic!("no model of sections"),
    }
    model
}

fn local(kind: ModelKind, robot: &Robot, case: &Case, at: f64) -> (Solution, Local) {
    let (solution, local) = model(kind, at).solve_at(robot, case, at).unwrap();
    assert_eq!(local.method, DerivativeMethod::Exact);
    (solution, local)
}

fn robot() -> Robot {
    let bare = paper_robot(vec![straight(0.0), helix(110.0, 0.3), straight(230.0)]);
    let cables = bare
        .cables()
        .iter()
        .enumerate()
        .map(|(i, cable)| Cable { axial_stiffness: (i == 1).then_some(400.0), ..cable.clone() });
    let mut backbone = bare.backbone().clone();
    backbone.material.density = Some(1040.0);
    Robot::new(backbone, bare.disks().clone(), cables.collect()).unwrap()
}

/// Loads of every kind that the models take.
fn loaded(follower: bool) -> Case {
    let mut case = Case::with_tensions(&[1.5, 1.0, 0.6]);
    case.loads.tip_force = Vec3::new(0.04, -0.02, 0.01);
    case.loads.tip_moment = Vec3::new(0.0, 4e-4, 2e-4);
    case.loads.tip_follower = follower;
    case.loads.gravity = Some(Vec3::new(0.0, -9.81, 2.0));
    let spread = DistributedLoad::uniform(0.18, Vec3::new(0.1, 0.05, 0.0));
    case.loads.distributed = vec![DistributedLoad { follower, ..spread }];
    case.base = Pose {
        position: Vec3::new(0.1, 0.0, -0.2),
        rotation: UnitQuaternion::exp(Vec3::new(0.3, -0.8, 0.4)),
    };
    case
}

/// The case with every second cable held at the length that it has.
fn by_length(kind: ModelKind, robot: &Robot, case: &Case) -> Case {
    let solution =
        model(kind, 0.18).prepare(robot, &case.loads).unwrap().solve(case, None).unwrap();
    let mut case = case.clone();
    for (i, (command, state)) in case.commands.iter_mut().zip(&solution.cables).enumerate() {
        if i % 2 == 0 {
            let stretch = robot.cables()[i]
                .axial_stiffness
                .map_or(0.0, |k| state.initial_length * state.tension.unwrap() / k);
            let shortening = state.initial_length - state.length + stretch;
            *command =
                CableCommand { tension: None, shortening: Some(Shortening::Length(shortening)) };
        }
    }
    case
}

/// The same with all cables held.
fn locked(kind: ModelKind, robot: &Robot, case: &Case) -> Case {
    let mut solver = model(kind, 0.18).prepare(robot, &case.loads).unwrap();
    let solution = solver.solve(case, None).unwrap();
    let mut case = case.clone();
    for (i, (command, state)) in case.commands.iter_mut().zip(&solution.cables).enumerate() {
        let stiffness = robot.cables()[i].axial_stiffness;
        let stretch = stiffness.map_or(0.0, |k| state.initial_length * state.tension.unwrap() / k);
        let shortening = Shortening::Length(state.initial_length - state.length + stretch);
        *command = CableCommand { tension: None, shortening: Some(shortening) };
    }
    case
}

/// Largest difference of two motions, relative to the largest part of the second.
fn off(a: Twist, b: Twist) -> f64 {
    let size = (b.linear.norm() / 0.18).max(b.angular.norm());
    let apart = ((a.linear - b.linear).norm() / 0.18).max((a.angular - b.angular).norm());
    apart / size
}

/// How the only station moves with what `change` does to the case, in the frame of the base.
fn difference(
    solver: &mut Prepared,
    case: &Case,
    at: &Solution,
    step: f64,
    change: impl Fn(&mut Case, f64),
) -> (Twist, Vec<f64>) {
    let found = differentiate(
        |by| -> Result<Solution, SolveError> {
            let mut case = case.clone();
            change(&mut case, by);
            solver.solve(&case, Some(at))
        },
        step,
    )
    .unwrap();
    let back = case.base.rotation.conjugate();
    let Twist { linear, angular } = found.stations[0];
    (Twist { linear: back.rotate(linear), angular: back.rotate(angular) }, found.lengths)
}

#[test]
fn commands_move_a_place_as_differences_say() {
    let robot = robot();
    for kind in KINDS {
        for (at, follower) in [(0.18, false), (0.18, true), (0.087, true), (0.06, false)] {
            let pulled = loaded(follower);
            for case in [pulled.clone(), by_length(kind, &robot, &pulled)] {
                let (solution, local) = local(kind, &robot, &case, at);
                let mut solver = model(kind, at).prepare(&robot, &case.loads).unwrap();
                for (cable, column) in local.actuation_jacobian.iter().enumerate() {
                    let step = if case.commands[cable].tension.is_some() { 2e-3 } else { 2e-6 };
                    let (moved, lengths) =
                        difference(&mut solver, &case, &solution, step, |case, by| match &mut case
                            .commands[cable]
                        {
                            CableCommand { tension: Some(tension), .. } => *tension += by,
                            CableCommand {
                                shortening: Some(Shortening::Length(length)), ..
                            } => *length += by,
                            _ => panic!("a cable without a command"),
                        });
                    let apart = off(*column, moved);
                    assert!(apart < 1e-7, "{kind} {at} {follower}, cable {cable}: {apart:.1e}");
                    for (i, length) in lengths.iter().enumerate() {
                        let exact = local.length_jacobian[i][cable];
                        let size = lengths.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
                        assert!((exact - length).abs() < 1e-6 * size, "{exact} {length}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_place_yields_as_differences_say() {
    let robot = robot();
    for kind in KINDS {
        for (at, follower) in [(0.18, false), (0.1, true), (0.087, false)] {
            let mut case = loaded(follower);
            case.loads.points.push(PointLoad { at, ..PointLoad::default() });
            let (solution, local) = local(kind, &robot, &case, at);
            let held = locked(kind, &robot, &case);
            let compliances = local.compliances.unwrap();
            for (case, compliance) in [
                (&case, &compliances.tensions_held.compliance),
                (&held, &compliances.lengths_held.compliance),
            ] {
                let mut solver = model(kind, at).prepare(&robot, &case.loads).unwrap();
                for component in 0..6 {
                    // Loads are in the frame of the base.
                    let axis = [Vec3::X, Vec3::Y, Vec3::Z][component % 3];
                    let step = if component < 3 { 1e-3 } else { 1e-4 };
                    let (moved, _) = difference(&mut solver, case, &solution, step, |case, by| {
                        let point = case.loads.points.last_mut().unwrap();
                        if component < 3 {
                            point.force += by * axis
                        } else {
                            point.moment += by * axis
                        }
                    });
                    let column = |row: usize| compliance.at(row, component);
                    let exact = Twist {
                        linear: Vec3::new(column(0), column(1), column(2)),
                        angular: Vec3::new(column(3), column(4), column(5)),
                    };
                    let apart = off(exact, moved);
                    assert!(apart < 1e-6, "{kind} {at} {component}: {apart:.1e}");
                }
            }
        }
    }
}

/// One arc bent by a moment m has the angle mL/EI, and its tip yields across by mL²/2EI for small m: the compliance of a
/// cantilever, L³/3EI, is approached by many sections.
#[test]
fn a_straight_robot_of_many_sections_yields_as_a_cantilever() {
    let bare = paper_robot(vec![]);
    let disks = whipcord::Disks::equally_spaced(0.18, 41, 0.008);
    let robot = Robot::new(bare.backbone().clone(), disks, vec![]).unwrap();
    let stiffness = bending_stiffness(&robot);
    for kind in KINDS {
        let (_, local) = local(kind, &robot, &Case::default(), 0.18);
        let compliance = local.compliances.unwrap().tensions_held.compliance;
        let expected = 0.18_f64.powi(3) / (3.0 * stiffness);
        let ratio = compliance.at(0, 0) / expected;
        assert!((ratio - 1.0).abs() < 0.02, "{kind}: {ratio}");
        let ratio = compliance.at(4, 0) * 2.0 * stiffness / 0.18_f64.powi(2);
        assert!((ratio - 1.0).abs() < 0.02, "{kind}: {ratio}");
        assert!(compliance.asymmetry(0.18) < 1e-10, "{kind}");
    }
}

/// One arc, by its commands of both kinds, as differences say; how it yields is unknown, because it takes no loads.
#[test]
fn an_arc_moves_as_differences_say() {
    let cables = [0.0, 120.0, 240.0].map(straight).to_vec();
    let robot = paper_robot(cables);
    let base = Pose {
        position: Vec3::new(0.1, 0.0, -0.2),
        rotation: UnitQuaternion::exp(Vec3::new(0.3, -0.8, 0.4)),
    };
    let pulled = Case { base, ..Case::with_tensions(&[2.5, 0.4, 1.0]) };
    let kind = ModelKind::ConstantCurvature;
    for at in [0.18, 0.05] {
        let model = Model::new(kind, Stations::At(vec![at]), Actuation::Natural);
        let mut solver = model.prepare(&robot, &pulled.loads).unwrap();
        let answer = solver.solve(&pulled, None).unwrap();
        let mut held = pulled.clone();
        for (command, state) in held.commands.iter_mut().zip(&answer.cables).take(2) {
            let shortening = Shortening::Length(state.initial_length - state.length);
            *command = CableCommand { tension: None, shortening: Some(shortening) };
        }
        for case in [&pulled, &held] {
            let (solution, local) = model.solve_at(&robot, case, at).unwrap();
            assert_eq!(local.method, DerivativeMethod::Exact);
            assert_eq!(local.compliances, Err(ComplianceUnknown::NoLoads));
            for (cable, column) in local.actuation_jacobian.iter().enumerate() {
                let step = if case.commands[cable].tension.is_some() { 2e-3 } else { 2e-6 };
                let (moved, _) = difference(&mut solver, case, &solution, step, |case, by| {
                    match &mut case.commands[cable] {
                        CableCommand { tension: Some(tension), .. } => *tension += by,
                        CableCommand { shortening: Some(Shortening::Length(length)), .. } => {
                            *length += by;
                        }
                        _ => panic!("a cable without a command"),
                    }
                });
                assert!(off(*column, moved) < 1e-7, "{at} {cable}: {column:?} {moved:?}");
            }
        }
    }
}
