//! A flag that is set ends the solves of every model.

use std::thread;
use std::time::{Duration, Instant};

use whipcord::BranchOptions;
use whipcord::batch::{BatchOptions, Progress, Rows, solve_batch};
use whipcord::cosserat::{Cosserat, Options, Workspace};
use whipcord::differences::by_parameter;
use whipcord::{
    Actuation, Backbone, Cable, Cancel, Case, Differentiable as _, Disks, Form, Loads, Material,
    Model, ModelKind, Obstacle, Parameter, Pose, Robot, Routing, Section, Shortening, SolveError,
    Statics as _, Stations, UnitQuaternion, Vec3,
};

/// A strip of steel like that of the gripping finger.
fn strip(length: f64) -> Robot {
    let material =
        Material { young_modulus: Some(2e11), poisson_ratio: Some(0.3), ..Material::default() };
    let section = Some(Section::rectangle(0.0003, 0.008));
    let backbone = Backbone { material, section, ..Backbone::new(length) };
    let disks = Disks {
        outer_radius: Some(0.008),
        thickness: Some(0.002),
        ..Disks::equally_spaced(length, 13, 0.006)
    };
    let cable = Cable::new("flexor", Routing::Straight { angle: 0.0, radius: 0.006 });
    Robot::new(backbone, disks, vec![cable]).unwrap()
}

fn ball() -> Obstacle {
    Obstacle {
        name: "ball".to_owned(),
        form: Form::Sphere { radius: 0.022 },
        pose: Pose { position: Vec3::new(0.031, 0.0, 0.030), rotation: UnitQuaternion::IDENTITY },
        friction: 0.0,
        movable: None,
    }
}

/// The robot bent, driven by what each model knows, and loaded where it can be.
fn case(kind: ModelKind) -> Case {
    if kind.natural_actuation() == Actuation::Shortening {
        return Case::with_shortenings(&[Shortening::Length(0.003)]);
    }
    let loads = Loads { tip_force: Vec3::new(0.0, 0.1, 0.0), ..Loads::default() };
    Case { loads, ..Case::with_tensions(&[2.0]) }
}

fn model(kind: ModelKind) -> Model {
    Model::new(kind, Stations::Disks, Actuation::Natural)
}

fn is_cancelled<T>(outcome: &Result<T, SolveError>) -> bool {
    matches!(outcome, Err(SolveError::Cancelled { .. }))
}

#[test]
fn a_flag_ends_each_model_and_changes_nothing_before() {
    let robot = strip(0.12);
    for kind in ModelKind::ALL {
        let (cancel, case) = (Cancel::new(), case(kind));
        let flagged = model(kind).cancelled_by(&cancel);
        assert_eq!(flagged, model(kind));
        let free = model(kind).solve(&robot, &case).unwrap();
        assert_eq!(flagged.solve(&robot, &case).as_ref(), Ok(&free), "{kind}");
        let mut prepared = flagged.prepare(&robot, &case.loads).unwrap();
        cancel.cancel();
        assert!(is_cancelled(&flagged.solve(&robot, &case)), "{kind}");
        assert!(is_cancelled(&prepared.solve(&case, None)), "{kind}");
        assert!(is_cancelled(&prepared.solve(&case, Some(&free))), "{kind}");
        assert!(is_cancelled(&prepared.solve_to_the_end(&case).map_err(|(_, error)| error)));
        let length = Parameter::YoungModulus;
        assert!(is_cancelled(&by_parameter(&flagged, &robot, &case, &length, 1e6)), "{kind}");
        if matches!(kind, ModelKind::Cosserat | ModelKind::CosseratDisks) {
            assert!(is_cancelled(&flagged.solve_at(&robot, &case, 0.12)), "{kind}");
        }
        // What was prepared takes another flag for the next case.
        prepared.set_cancel(&Cancel::new());
        assert_eq!(prepared.solve(&case, None), Ok(free), "{kind}");
    }
}

/// The rows that were solved when the flag is set stay, and the others say that they were cancelled.
#[test]
fn a_batch_keeps_the_rows_that_were_solved() {
    let robot = strip(0.12);
    let values: Vec<f64> = (0..4000).map(|row| 0.0005 * f64::from(row)).collect();
    let case = case(ModelKind::Cosserat);
    let rows = Rows::Tensions { values: &values, case: &case };
    let cancel = Cancel::new();
    let rod = model(ModelKind::Cosserat).cancelled_by(&cancel);
    let progress: Progress<'_> = &|done, _| {
        if done >= 100 {
            cancel.cancel();
        }
        true
    };
    let options = BatchOptions { progress: Some(progress), ..BatchOptions::default() };
    let batch = solve_batch(&rod, &robot, rows, &options).unwrap();
    let whole = solve_batch(&model(ModelKind::Cosserat), &robot, rows, &Default::default());
    let whole = whole.unwrap();
    let mut solved = 0;
    for row in 0..values.len() {
        match batch.row(row).unwrap() {
            Ok(answer) => {
                solved += 1;
                assert_eq!(answer.position(12), whole.row(row).unwrap().unwrap().position(12));
            }
            Err(error) => assert!(matches!(error, SolveError::Cancelled { .. }), "{row}"),
        }
    }
    assert!((100..4000).contains(&solved), "{solved}");
}

#[test]
fn lengths_contacts_branches_batches_and_fits_end() {
    let robot = strip(0.12);
    let cancel = Cancel::new();
    cancel.cancel();
    let short = Case::with_shortenings(&[Shortening::Length(0.003)]);
    for kind in [
        ModelKind::Cosserat,
        ModelKind::CosseratDisks,
        ModelKind::PiecewiseConstantCurvature,
        ModelKind::PseudoRigidBody,
        ModelKind::ConstantCurvature,
    ] {
        let model = Model::new(kind, Stations::Disks, Actuation::Shortening).cancelled_by(&cancel);
        assert!(is_cancelled(&model.solve(&robot, &short)), "{kind}");
    }
    let free = four_bar_free().cancelled_by(&cancel);
    assert!(is_cancelled(&free.solve(&robot, &short)));
    let touching = Case { obstacles: vec![ball()], ..short.clone() };
    assert!(is_cancelled(&free.solve(&robot, &touching)));
    let rod = model(ModelKind::Cosserat).cancelled_by(&cancel);
    let touching = Case { obstacles: vec![ball()], ..Case::with_tensions(&[24.0]) };
    for kind in [
        ModelKind::Cosserat,
        ModelKind::CosseratDisks,
        ModelKind::PiecewiseConstantCurvature,
        ModelKind::PseudoRigidBody,
    ] {
        let model = model(kind).cancelled_by(&cancel);
        assert!(is_cancelled(&model.solve(&robot, &touching)), "{kind}");
    }

    let options = Options { cancel: cancel.clone(), ..Options::default() };
    let pushed = case(ModelKind::Cosserat);
    let cosserat = Cosserat::new(&robot, &pushed.loads, &options).unwrap();
    let mut workspace = Workspace::default();
    let branches = cosserat.branches(&pushed, &BranchOptions::default(), &mut workspace);
    assert!(is_cancelled(&branches));
    let derivatives = cosserat.solve_with_derivatives(&pushed, None, &[], &mut workspace);
    assert!(is_cancelled(&derivatives));

    for loads in [Loads::default(), pushed.loads.clone()] {
        let case = Case { loads, ..Case::default() };
        let rows = Rows::Tensions { values: &[0.5; 40], case: &case };
        let batch = solve_batch(&rod, &robot, rows, &BatchOptions::default()).unwrap();
        let is_cancelled = |row| matches!(batch.row(row), Some(Err(SolveError::Cancelled { .. })));
        assert!((0..40).all(is_cancelled));
    }
}

fn four_bar_free() -> Model {
    Model::FourBar(whipcord::four_bar::Options {
        objective: whipcord::four_bar::Objective::StrainEnergy,
        lengths: whipcord::four_bar::LengthRule::Free,
        ..Default::default()
    })
}

/// A robot that curls up against a ball keeps a processor busy for many seconds; another thread ends it.
#[test]
fn another_thread_ends_a_long_solve() {
    let robot = strip(2.0);
    let case = Case { obstacles: vec![ball()], ..Case::with_tensions(&[24.0]) };
    let cancel = Cancel::new();
    let model = model(ModelKind::Cosserat).cancelled_by(&cancel);
    let outcome = thread::scope(|scope| {
        let solve = scope.spawn(|| model.solve(&robot, &case));
        thread::sleep(Duration::from_millis(300));
        let begun = Instant::now();
        cancel.cancel();
        let outcome = solve.join().unwrap();
        assert!(begun.elapsed() < Duration::from_secs(5), "{:?}", begun.elapsed());
        outcome
    });
    let error = outcome.unwrap_err();
    assert!(matches!(error, SolveError::Cancelled { .. }), "{error}");
    assert!(error.to_string().starts_with("the solve was cancelled; "), "{error}");
}
