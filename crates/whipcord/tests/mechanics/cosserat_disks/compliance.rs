//! How the robot with discrete holes yields, against the exact derivatives of the
//! continuous model that it tends to, and against loads that are applied.

use crate::common::{helix, paper_backbone, paper_robot, straight};
use whipcord::kinematics::{DerivativeMethod, Local, Matrix6};
use whipcord::{
    Actuation, Cable, CableCommand, Case, Differentiable as _, Disks, LoadFrame, Model, ModelKind,
    PointLoad, Pose, Robot, Shortening, SolveError, Statics as _, Stations, Twist, UnitQuaternion,
    Vec3,
};

fn model(kind: ModelKind, at: f64) -> Model {
    Model::new(kind, Stations::At(vec![at]), Actuation::Natural)
}

fn local(kind: ModelKind, robot: &Robot, case: &Case, at: f64) -> Local {
    let (_, local) = model(kind, at).solve_at(robot, case, at).unwrap_or_else(|e| panic!("{e}"));
    local
}

/// Entries with lengths in terms of the robot's, so that they are alike.
fn entries(matrix: &Matrix6) -> Vec<f64> {
    let unit = |i: usize| if i < 3 { 1.0 / 0.18 } else { 1.0 };
    let rows = matrix.rows();
    (0..36).map(|k| rows[k / 6][k % 6] * unit(k / 6) * unit(k % 6)).collect()
}

fn jacobian(columns: &[Twist]) -> Vec<f64> {
    let of = |t: &Twist| [t.linear * (1.0 / 0.18), t.angular].map(Vec3::to_array).concat();
    columns.iter().flat_map(of).collect()
}

/// Largest difference relative to the largest entry.
fn off(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let size = b.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    a.iter().zip(b).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs())) / size
}

fn with_sections(sections: usize) -> Robot {
    let disks = Disks::equally_spaced(0.18, sections + 1, 0.008);
    let routings = [straight(0.0), helix(100.0, 0.3), straight(230.0)];
    let cables = routings.into_iter().enumerate();
    let cables = cables.map(|(i, r)| Cable::new(format!("{i}"), r)).collect();
    Robot::new(paper_backbone(), disks, cables).unwrap()
}

fn loaded() -> Case {
    let mut case = Case::with_tensions(&[1.5, 1.0, 0.5]);
    case.loads.tip_force = Vec3::new(0.05, -0.03, 0.02);
    case
}

#[test]
fn tends_to_the_continuous_model_with_order_two() {
    let unloaded = Case { loads: whipcord::Loads::default(), ..loaded() };
    // A cable without tension can only be pulled: its column is one-sided.
    let with_loose = Case { commands: Case::with_tensions(&[1.5, 1.0, 0.0]).commands, ..loaded() };
    for case in [loaded(), unloaded, with_loose] {
        for at in [0.18, 0.09] {
            let errors = [8, 16].map(|sections| {
                let robot = with_sections(sections);
                let exact = local(ModelKind::Cosserat, &robot, &case, at);
                let ours = local(ModelKind::CosseratDisks, &robot, &case, at);
                assert_eq!(exact.method, DerivativeMethod::Exact);
                assert_eq!(ours.method, DerivativeMethod::Exact);
                [
                    off(&jacobian(&ours.actuation_jacobian), &jacobian(&exact.actuation_jacobian)),
                    off(
                        &entries(&ours.compliances.unwrap().tensions_held.compliance),
                        &entries(&exact.compliances.unwrap().tensions_held.compliance),
                    ),
                    off(
                        &entries(&ours.compliances.unwrap().lengths_held.compliance),
                        &entries(&exact.compliances.unwrap().lengths_held.compliance),
                    ),
                ]
            });
            for (coarse, fine) in errors[0].into_iter().zip(errors[1]) {
                assert!(coarse < 0.1, "{errors:?}");
                assert!((3.3..4.7).contains(&(coarse / fine)), "{errors:?}");
            }
        }
    }
}

/// The case with every cable held where it is, elastic ones with their stretch.
fn locked(robot: &Robot, case: &Case) -> Case {
    let solution = model(ModelKind::CosseratDisks, 0.18).solve(robot, case).unwrap();
    let mut case = case.clone();
    for (i, (command, state)) in case.commands.iter_mut().zip(&solution.cables).enumerate() {
        let stretch = robot.cables()[i]
            .axial_stiffness
            .map_or(0.0, |k| state.initial_length * state.tension.unwrap() / k);
        let shortening = state.initial_length - state.length + stretch;
        *command = CableCommand { tension: None, shortening: Some(Shortening::Length(shortening)) };
    }
    case
}

#[test]
fn locked_cables_yield_as_solutions_of_given_lengths_do() {
    let mut cables = with_sections(6).cables().to_vec();
    cables[1].axial_stiffness = Some(400.0);
    let robot = Robot::new(paper_backbone(), with_sections(6).disks().clone(), cables).unwrap();
    let case = locked(&robot, &loaded());
    // The place is midway between two disks.
    let at = 0.105;
    let compliance = local(ModelKind::CosseratDisks, &robot, &case, at)
        .compliances
        .unwrap()
        .lengths_held
        .compliance;
    let options = whipcord::cosserat_disks::Options {
        stations: Stations::At(vec![at]),
        accuracy: whipcord::cosserat::Accuracy::Steps(14),
        ..Default::default()
    };
    for component in [0, 2, 4] {
        let axis = [Vec3::X, Vec3::Y, Vec3::Z][component % 3];
        let difference = whipcord::differences::differentiate(
            |by| {
                let mut case = case.clone();
                let (force, moment) =
                    if component < 3 { (by * axis, Vec3::ZERO) } else { (Vec3::ZERO, by * axis) };
                case.loads.points.push(PointLoad { at, force, moment, follower: false });
                Model::CosseratDisks(options.clone()).solve(&robot, &case)
            },
            if component < 3 { 2e-3 } else { 2e-4 },
        )
        .unwrap();
        let column: Vec<f64> = (0..6).map(|row| compliance.at(row, component)).collect();
        let Twist { linear, angular } = difference.stations[0];
        let expected = [linear, angular].map(Vec3::to_array).concat();
        let size =
            |rows: core::ops::Range<usize>| rows.map(|i| expected[i].abs()).fold(0.0, f64::max);
        for row in 0..6 {
            let size = if row < 3 { size(0..3) } else { size(3..6) };
            let off = (column[row] - expected[row]).abs();
            assert!(off < 1e-4 * size, "{component} {row}: {column:?} {expected:?}");
        }
    }
}

#[test]
fn numbers_are_in_the_frame_of_the_base() {
    let robot = with_sections(6);
    let mut case = loaded();
    let still = local(ModelKind::CosseratDisks, &robot, &case, 0.18);
    case.base = Pose {
        rotation: UnitQuaternion::exp(Vec3::new(0.4, 1.0, -0.3)),
        position: Vec3::new(0.1, 0.2, 0.3),
    };
    case.loads.frame = LoadFrame::World;
    case.loads.tip_force = case.base.rotation.rotate(case.loads.tip_force);
    let turned = local(ModelKind::CosseratDisks, &robot, &case, 0.18);
    let compliances = [&turned, &still]
        .map(|local| entries(&local.compliances.unwrap().tensions_held.compliance));
    assert!(off(&compliances[0], &compliances[1]) < 1e-6);
    let jacobians = [&turned, &still].map(|local| jacobian(&local.actuation_jacobian));
    assert!(off(&jacobians[0], &jacobians[1]) < 1e-6);
}

#[test]
fn a_place_beyond_the_robot_is_refused() {
    let robot = paper_robot(vec![straight(0.0)]);
    let error =
        model(ModelKind::CosseratDisks, 0.18).solve_at(&robot, &Case::with_tensions(&[2.0]), 0.2);
    assert!(matches!(error, Err(SolveError::Invalid(_))), "{error:?}");
}
