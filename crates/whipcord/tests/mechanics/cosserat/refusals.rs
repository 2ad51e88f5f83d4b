//! What the Cosserat model says when it gives no answer.

use crate::common::{
    Wildness, config, helix, paper_backbone, paper_disks, paper_robot, robot, solve_with, straight,
};
use proptest::prelude::*;
use whipcord::cosserat::{Accuracy, Cosserat, Options, Workspace};
use whipcord::{
    Actuation, Backbone, Cable, CableCommand, Case, Loads, Material, ModelKind, PointLoad, Robot,
    RobotError, Routing, Shortening, Solution, SolveError, Vec3,
};

fn refusal(robot: &Robot, case: &Case, options: Options) -> SolveError {
    match solve_with(options, robot, case) {
        Ok(_) => panic!("this case must be refused: {case:?}"),
        Err(error) => error,
    }
}

fn robot_on(backbone: Backbone) -> Robot {
    Robot::new(backbone, paper_disks(), vec![Cable::new("pull", straight(0.0))]).unwrap()
}

/// The path that a refusal for want of something names.
fn missing(error: SolveError) -> String {
    match error {
        SolveError::Missing { model: ModelKind::Cosserat, path, advice } => {
            assert!(!advice.is_empty());
            path
        }
        other => panic!("{other:?}"),
    }
}

fn invalid(error: SolveError) -> String {
    match error {
        SolveError::Invalid(RobotError { path, .. }) => path,
        other => panic!("{other:?}"),
    }
}

fn one_newton() -> Case {
    Case::with_tensions(&[1.0])
}

#[test]
fn the_rods_stiffness_must_be_given() {
    let material = paper_backbone().material;
    let with = |material| Backbone { material, ..paper_backbone() };
    let without = [
        (Backbone { section: None, ..paper_backbone() }, "backbone.diameter"),
        (with(Material { young_modulus: None, ..material }), "backbone.young_modulus"),
        (with(Material { poisson_ratio: None, ..material }), "backbone.poisson_ratio"),
    ];
    for (backbone, path) in without {
        let error = refusal(&robot_on(backbone), &one_newton(), Options::default());
        assert_eq!(missing(error), path);
    }
}

#[test]
fn gravity_needs_a_density() {
    let mut case = one_newton();
    case.loads.gravity = Some(Vec3::new(0.0, 0.0, -9.81));
    let error = refusal(&robot_on(paper_backbone()), &case, Options::default());
    assert_eq!(missing(error), "backbone.density");

    case.loads.gravity = Some(Vec3::ZERO);
    assert!(solve_with(Options::default(), &robot_on(paper_backbone()), &case).is_ok());
}

#[test]
fn every_cable_needs_what_drives_it() {
    let robot = paper_robot(vec![straight(0.0), straight(120.0)]);
    let tension = CableCommand { tension: Some(1.0), shortening: None };
    let length = CableCommand { tension: None, shortening: Some(Shortening::Fraction(0.01)) };
    let refused = |commands: [CableCommand; 2], actuation| {
        let case = Case { commands: commands.to_vec(), ..Case::default() };
        missing(refusal(&robot, &case, Options { actuation, ..Options::default() }))
    };
    let nothing = CableCommand::default();
    assert_eq!(refused([tension, nothing], Actuation::Natural), "cables[1].tension");
    assert_eq!(refused([length, tension], Actuation::Tension), "cables[0].tension");
    assert_eq!(refused([length, tension], Actuation::Shortening), "cables[1].shortening");
}

#[test]
fn cases_that_do_not_fit_the_robot_are_refused_by_path() {
    let robot = robot_on(paper_backbone());
    let refused = |case: &Case| invalid(refusal(&robot, case, Options::default()));
    assert_eq!(refused(&Case::with_tensions(&[1.0, 2.0])), "cables");
    assert_eq!(refused(&Case::with_tensions(&[-1.0])), "cables[0].tension");
    assert_eq!(refused(&Case::with_tensions(&[f64::NAN])), "cables[0].tension");
    assert_eq!(refused(&Case::with_tensions(&[f64::INFINITY])), "cables[0].tension");
    let more_than_all = Case::with_shortenings(&[Shortening::Fraction(1.1)]);
    assert_eq!(refused(&more_than_all), "cables[0].shortening");

    let loaded = |loads| Case { loads, ..one_newton() };
    let nan = Vec3::new(0.0, f64::NAN, 0.0);
    assert_eq!(
        refused(&loaded(Loads { tip_force: nan, ..Loads::default() })),
        "loads.tip_force[1]"
    );
    let beyond = PointLoad { at: 0.2, ..PointLoad::default() };
    let points = Loads { points: vec![beyond], ..Loads::default() };
    assert_eq!(refused(&loaded(points)), "loads.point[0].at");
}

#[test]
fn a_model_built_for_other_load_places_refuses_the_case() {
    let robot = robot_on(paper_backbone());
    let at = |at| Loads {
        points: vec![PointLoad { at, force: Vec3::X, ..PointLoad::default() }],
        ..Loads::default()
    };
    let model = Cosserat::new(&robot, &at(0.05), &Options::default()).unwrap();
    let mut workspace = Workspace::default();
    let case = Case { loads: at(0.06), ..one_newton() };
    let error = model.solve(&case, None, &mut workspace).unwrap_err();
    assert_eq!(invalid(error), "loads");
}

/// A straight cable has no length left at τ (1/EA + r²/EI) = 1, everywhere at once.
#[test]
fn a_tension_that_uses_up_a_cable_folds_the_section() {
    let robot = robot_on(paper_backbone());
    let (area, inertia) =
        (core::f64::consts::PI / 4.0 * 9e-6, core::f64::consts::PI / 64.0 * 81e-12);
    let limit = 1.0 / (1.0 / (1.1e9 * area) + 64e-6 / (1.1e9 * inertia));
    let at = |tension| solve_with(Options::default(), &robot, &Case::with_tensions(&[tension]));
    let short = at(0.99 * limit).unwrap().cables[0].length;
    assert!((short - 0.01 * 0.18).abs() < 1e-9);
    let Err(SolveError::SectionFolds { cable, arc_length, tension, last_load }) = at(1.25 * limit)
    else {
        panic!("{:?}", at(1.25 * limit));
    };
    assert_eq!(cable, "pull");
    assert!((0.0..=0.18).contains(&arc_length));
    assert_eq!(tension, 1.25 * limit);
    assert!((last_load - 0.8).abs() < 1e-3, "{last_load}");
}

/// Where only one of several cables folds the section, the error names it and a place on its way.
#[test]
fn the_folding_cable_is_named() {
    let mut short = Cable::new("short", straight(90.0));
    short.ends_at = Some(0.06);
    let cables = vec![Cable::new("long", helix(0.0, 0.5)), short];
    let robot = Robot::new(paper_backbone(), paper_disks(), cables).unwrap();
    let error = refusal(&robot, &Case::with_tensions(&[0.5, 200.0]), Options::default());
    let SolveError::SectionFolds { cable, arc_length, .. } = error else { panic!("{error:?}") };
    assert_eq!(cable, "short");
    assert!(arc_length <= 0.06);
}

/// However often the steps are halved, rounding keeps a cable that winds round the backbone five
/// hundred times from settling to 1e-15.
#[test]
fn a_tolerance_that_cannot_be_met_is_an_error_and_not_an_answer() {
    let robot = paper_robot(vec![Routing::Helix { start_angle: 0.0, turns: 500.0, radius: 0.008 }]);
    let options = Options { accuracy: Accuracy::Tolerance(1e-15), ..Options::default() };
    let error = refusal(&robot, &Case::with_tensions(&[2.0]), options);
    let SolveError::StepsTooCoarse { error, tolerance, .. } = error else { panic!("{error:?}") };
    assert!(error > tolerance);
}

fn is_finite(solution: &Solution) -> bool {
    let poses = solution.shape.poses.iter().chain(&solution.disks.poses);
    let wrench = solution.base_wrench.unwrap();
    let diagnostics = &solution.diagnostics;
    poses.map(|p| (p.position, p.rotation.wxyz())).all(|(position, rotation)| {
        position.is_finite() && (rotation.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-9
    }) && solution.cables.iter().all(|c| c.length.is_finite() && c.tension.unwrap() >= 0.0)
        && wrench.force.is_finite()
        && wrench.moment.is_finite()
        && diagnostics.residual.is_finite()
        && diagnostics.stability.is_none_or(f64::is_finite)
        && diagnostics.discretization_error.is_none_or(f64::is_finite)
}

/// Powers of ten by which tensions and loads are out of proportion.
fn out_of_proportion() -> impl Strategy<Value = [f64; 9]> {
    let power = || prop_oneof![4 => -2.0..4.0_f64, 1 => -300.0..9.0_f64];
    [power(), power(), power(), power(), power(), power(), power(), power(), power()]
}

proptest! {
    #![proptest_config(config(if cfg!(debug_assertions) { 4 } else { 96 }))]

    #[test]
    fn whatever_is_asked_the_answer_is_finite_or_a_reason(
        (robot, case) in robot(Wildness::LOADED),
        powers in out_of_proportion(),
        by_length in proptest::bool::weighted(0.3),
    ) {
        let factor = powers.map(|p| 10.0_f64.powf(p));
        let mut case = case;
        for (i, command) in case.commands.iter_mut().enumerate() {
            command.tension = command.tension.map(|t| t * factor[i]);
            if by_length {
                let shortening = Shortening::Fraction((powers[i] / 4.0).min(1.0));
                *command = CableCommand { tension: None, shortening: Some(shortening) };
            }
        }
        case.loads.tip_force *= factor[6];
        case.loads.tip_moment *= factor[7];
        case.loads.gravity = case.loads.gravity.map(|g| g * factor[8]);
        match solve_with(Options::default(), &robot, &case) {
            Ok(solution) => prop_assert!(is_finite(&solution)),
            Err(error) => {
                let message = error.to_string();
                prop_assert!(!message.contains("NaN"), "{message}");
                let expected = matches!(
                    error,
                    SolveError::SectionFolds { .. }
                        | SolveError::NotConverged { .. }
                        | SolveError::Buckled { .. }
                        | SolveError::UnreachableLength { .. }
                        | SolveError::ContradictoryLengths { .. }
                        | SolveError::StepsTooCoarse { .. }
                );
                prop_assert!(expected, "{message}");
            }
        }
    }
}
