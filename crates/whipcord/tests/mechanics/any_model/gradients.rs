//! Gradients of batches: those of single answers, in the frame of the shapes.

use crate::common::{helix, model_with_forces, paper_robot, straight};
use whipcord::batch::{BatchError, BatchOptions, Gradients, Rows, Sensitivities, pull_back_batch};
use whipcord::cosserat::Options;
use whipcord::{
    Actuation, Case, Loads, Model, ModelKind, Parameter, Pose, Robot, Statics, Stations,
    UnitQuaternion, Vec3,
};

/// On a base that is turned, under a load.
fn case() -> Case {
    let base = Pose {
        position: Vec3::new(0.3, -1.2, 0.7),
        rotation: UnitQuaternion::exp(Vec3::new(0.4, 2.1, -0.8)),
    };
    let loads = Loads { tip_force: Vec3::new(0.05, 0.02, -0.03), ..Loads::default() };
    Case { base, loads, ..Case::default() }
}

/// A weight for every number of the positions, tensions and lengths.
fn weight(i: usize) -> f64 {
    (1.0 + i as f64 * 0.7).sin()
}

/// The scalar that is differentiated.
fn scalar(model: &Model, robot: &Robot, tensions: &[f64]) -> f64 {
    let case = Case { commands: Case::with_tensions(tensions).commands, ..case() };
    let solution = model.solve(robot, &case).unwrap();
    let places = solution.shape.positions().flat_map(|p| p.to_array()).enumerate();
    let places: f64 = places.map(|(i, x)| weight(i) * x).sum();
    let lengths = solution.cables.iter().enumerate();
    places + lengths.map(|(i, cable)| weight(i + 5) * cable.length).sum::<f64>()
}

#[test]
fn they_are_those_of_differences() {
    for kind in [
        ModelKind::Cosserat,
        ModelKind::CosseratDisks,
        ModelKind::PiecewiseConstantCurvature,
        ModelKind::PseudoRigidBody,
        ModelKind::FourBar,
    ] {
        let model = model_with_forces(kind, Stations::default(), Actuation::Natural);
        check_gradients(&model.with_tolerance(1e-9));
    }
}

fn check_gradients(model: &Model) {
    let robot = paper_robot(vec![straight(0.0), helix(90.0, 0.4)]);
    // The sections of the four-bar model bear any tension, and no number that is none.
    let too_much = if model.kind() == ModelKind::FourBar { f64::NAN } else { 1e6 };
    let values = [2.0, 1.0, too_much, 0.0, 0.5, 1.5];
    let stations = robot.disks().count();
    let positions: Vec<f64> = (0..3).flat_map(|_| (0..3 * stations).map(weight)).collect();
    let lengths: Vec<f64> = (0..3).flat_map(|_| (0..2).map(|i| weight(i + 5))).collect();
    let (mut commands, mut parameters) = ([f64::NAN; 6], [f64::NAN; 3]);
    let outcomes = pull_back_batch(
        model,
        &robot,
        Rows::Tensions { values: &values, case: &case() },
        &[Parameter::YoungModulus],
        &BatchOptions::default(),
        Sensitivities { positions: &positions, lengths: &lengths, ..Sensitivities::default() },
        Gradients { commands: &mut commands, parameters: &mut parameters },
    )
    .unwrap();
    assert!(outcomes[1].is_err(), "{:?}", model.kind());
    assert_eq!((&commands[2..4], parameters[1]), (&[0.0; 2][..], 0.0));
    for row in [0, 2] {
        assert_eq!(outcomes[row], Ok(()));
        let given = [values[2 * row], values[2 * row + 1]];
        for cable in 0..2 {
            let at = |by: f64| {
                let mut moved = given;
                moved[cable] += by;
                scalar(model, &robot, &moved)
            };
            let expected = (at(1e-4) - at(-1e-4)) / 2e-4;
            let got = commands[2 * row + cable];
            assert!((got - expected).abs() < 1e-6 * expected.abs().max(1e-3), "{got} {expected}");
        }
        let at = |by: f64| {
            let moved = Parameter::YoungModulus.moved(&robot, &Case::with_tensions(&given), by);
            scalar(model, &moved.unwrap().0, &given)
        };
        let expected = (at(1e5) - at(-1e5)) / 2e5;
        let got = parameters[row];
        assert!((got - expected).abs() < 1e-5 * expected.abs(), "{got} {expected}");
    }
}

/// What becomes of a batch of tensions on a robot with one straight cable, without parameters.
fn outcome(
    tensions: &[f64],
    options: &BatchOptions,
    sensitivities: Sensitivities,
) -> Result<(), BatchError> {
    pull_back_batch(
        &Model::Cosserat(Options::default()),
        &paper_robot(vec![straight(0.0)]),
        Rows::Tensions { values: tensions, case: &case() },
        &[],
        options,
        sensitivities,
        Gradients { commands: &mut vec![0.0; tensions.len()], parameters: &mut [] },
    )
    .map(drop)
}

#[test]
fn arrays_of_another_size_are_refused() {
    let sensitivities = Sensitivities { positions: &[1.0; 3], ..Sensitivities::default() };
    let refused = outcome(&[1.0, 2.0], &BatchOptions::default(), sensitivities);
    let expected = BatchError::Size { name: "positions", given: 3, needed: 60 };
    assert_eq!(refused, Err(expected));
}

#[test]
fn no_row_begins_after_the_batch_is_stopped() {
    let stop = |_: usize, _: usize| false;
    let one = core::num::NonZeroUsize::new(1);
    let options = BatchOptions { threads: one, progress: Some(&stop), ..BatchOptions::default() };
    let stopped = outcome(&[1.0; 8], &options, Sensitivities::default());
    assert_eq!(stopped, Err(BatchError::Stopped { done: 1, rows: 8 }));
}

#[test]
fn sensitivities_that_are_no_numbers_are_refused() {
    let sensitivities =
        Sensitivities { tensions: &[1.0, f64::INFINITY], ..Sensitivities::default() };
    let refused = outcome(&[1.0, 2.0], &BatchOptions::default(), sensitivities);
    let expected = BatchError::NotFinite { name: "tensions", row: 1, value: f64::INFINITY };
    assert_eq!(refused, Err(expected));
}

#[test]
fn a_parameter_is_set_to_the_very_value() {
    let (robot, case) = (paper_robot(vec![straight(0.0)]), Case::with_tensions(&[1.0]));
    // 1.1e9 + (1.1 - 1.1e9) is 1.10000002….
    let (soft, case) = Parameter::YoungModulus.changed_to(&robot, &case, 1.1).unwrap();
    assert_eq!(Parameter::YoungModulus.value(&soft, &case), Ok(1.1));
    // Of several numbers the first is set, and the others keep their distance from it.
    let mut disks = robot.disks().clone();
    disks.hole_circle_radii[1] += 0.001;
    let uneven = Robot::new(robot.backbone().clone(), disks, robot.cables().to_vec()).unwrap();
    let (moved, _) = Parameter::HoleRadius.changed_to(&uneven, &case, 0.007).unwrap();
    let radii = &moved.disks().hole_circle_radii;
    assert_eq!((radii[0], radii[2]), (0.007, 0.007));
    assert!((radii[1] - 0.008).abs() < 1e-12, "{}", radii[1]);
}
