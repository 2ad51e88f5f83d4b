//! Motors that pull cables, in every model that knows tensions.

use core::f64::consts::PI;

use whipcord::batch::{
    BatchError, BatchOptions, Driven, Gradients, Rows, Sensitivities, pull_back_batch, solve_batch,
};
use whipcord::derivatives::{Hold, Place};
use whipcord::parameter::Parameter;
use whipcord::{
    Actuation, Backbone, Cable, Case, Disks, Model, ModelKind, Motor, Problem, Robot, Solution,
    Statics as _, Stations, Vec3,
};

use crate::common::{WITH_FORCES, model_with_forces, paper_backbone, straight};

fn model(kind: ModelKind) -> Model {
    model_with_forces(kind, Stations::default(), Actuation::Natural)
}

/// Two antagonists on one spool, in a backbone that does not stretch.
fn antagonists(backbone: Backbone, motor: Motor) -> Robot {
    let cables = vec![
        Cable { axial_stiffness: Some(5e3), ..Cable::new("left", straight(0.0)) },
        Cable::new("right", straight(180.0)),
    ];
    let disks = Disks::equally_spaced(0.18, 13, 0.008);
    Robot::new(backbone, disks, cables).unwrap().with_motors(vec![motor]).unwrap()
}

fn spool() -> Motor {
    Motor {
        stiffness: Some(4e3),
        free_length: 0.3,
        pretension: 8.0,
        backlash: 0.05,
        offset: 0.1,
        drive: whipcord::Drive::Spool { gear_ratio: 2.0 },
        ..Motor::spool("bend", [(0, 0.01), (1, -0.0101)])
    }
}

fn loaded(robot: &Robot, angles: &[f64]) -> Case {
    let mut case = Case {
        commands: vec![Default::default(); 2],
        before: vec![vec![Default::default(); 2]; angles.len() - 1],
        motors: angles.iter().map(|&angle| vec![Some(angle)]).collect(),
        ..Case::default()
    };
    case.loads.tip_force = Vec3::new(0.0, 0.05, -0.02);
    case.drive(robot).unwrap();
    case
}

fn apart(a: &Solution, b: &Solution) -> f64 {
    a.disks.distances(&b.disks).fold(0.0, f64::max)
}

#[test]
fn a_spool_with_a_soft_drive_bends_an_arc_as_far_as_the_closed_form_says() {
    let backbone = Backbone { extensible: false, shearable: false, ..paper_backbone() };
    let (radius, stiffness, arm, length) = (0.01, 2e3, 0.008, 0.18);
    let motor = Motor { stiffness: Some(stiffness), ..Motor::spool("bend", [(0, radius)]) };
    let cable = Cable::new("pull", straight(0.0));
    let disks = Disks::equally_spaced(length, 40, arm);
    let robot = Robot::new(backbone, disks, vec![cable]).unwrap().with_motors(vec![motor]).unwrap();
    let bending = 1.1e9 * PI * 0.003_f64.powi(4) / 64.0;
    let angle = 0.9;
    // s = r θ − τ/k, and a straight cable without load bends an arc: s = r_c φ with φ = τ r_c L/EI.
    let tension = radius * angle / (arm * arm * length / bending + 1.0 / stiffness);
    let bend = tension * arm * length / bending;
    let case = Case::with_motors(&robot, &[angle]).unwrap();
    for kind in WITH_FORCES {
        let solution = model(kind).solve(&robot, &case).unwrap();
        let found = solution.cables[0].tension.unwrap();
        // Straight cables between disks differ from arcs by (φ/39)²/24.
        assert!((found / tension - 1.0).abs() < 8e-3, "{kind}: {found} {tension}");
        let turned = solution.disks.tip().rotation.log().norm();
        assert!((turned / bend - 1.0).abs() < 8e-3, "{kind}: {turned} {bend}");
        let torque = robot.motors()[0].effort(|cable| solution.cables[cable].tension).unwrap();
        assert!((torque - radius * found).abs() < 1e-12);
    }
}

#[test]
fn the_part_of_each_cable_inside_is_what_drive_and_pretension_leave() {
    let robot = antagonists(paper_backbone(), spool());
    let case = loaded(&robot, &[1.4]);
    // Behind the gear and half of the play.
    let output = (1.4 - 0.1) / 2.0 - 0.025;
    for kind in WITH_FORCES {
        let solution = model(kind).solve(&robot, &case).unwrap();
        for (cable, pull, compliance) in [(0, 0.01, 1.0 / 4e3 + 0.3 / 5e3), (1, -0.0101, 1.0 / 4e3)]
        {
            let state = &solution.cables[cable];
            let tension = state.tension.unwrap();
            let inside = if cable == 0 { state.initial_length / 5e3 } else { 0.0 };
            let expected = pull * output - (compliance + inside) * (tension - 8.0);
            let shortening = state.initial_length - state.length;
            assert!(
                (shortening - expected).abs() < 1e-9,
                "{kind} {cable}: {shortening} {expected}"
            );
        }
        // The same tensions bend the same robot without motors as far.
        let plain = robot.clone().with_motors(Vec::new()).unwrap();
        let tensions: Vec<f64> = solution.cables.iter().map(|c| c.tension.unwrap()).collect();
        let by_tension = Case { loads: case.loads.clone(), ..Case::with_tensions(&tensions) };
        let same = model(kind).solve(&plain, &by_tension).unwrap();
        assert!(apart(&same, &solution) < 1e-6, "{kind}: {}", apart(&same, &solution));
    }
}

#[test]
fn antagonists_at_rest_have_their_pretension() {
    let motor = Motor { offset: 0.3, ..spool() };
    let robot = antagonists(paper_backbone(), motor);
    let case = Case::with_motors(&robot, &[0.3]).unwrap();
    for kind in WITH_FORCES {
        let solution = model(kind).solve(&robot, &case).unwrap();
        for cable in &solution.cables {
            // The backbone is a little shorter under both.
            let tension = cable.tension.unwrap();
            assert!((tension - 8.0).abs() < 1.5 && tension < 8.0, "{kind}: {tension}");
        }
    }
}

#[test]
fn a_drive_with_play_follows_late_when_the_motor_turns_back() {
    let motor = Motor { backlash: 0.2, ..Motor::spool("m", [(0, 0.01)]) };
    let mut output = 0.0;
    let outputs = [0.05, 0.5, 0.4, 0.3, 0.1, 0.15, 0.6].map(|angle| {
        output = motor.output(output, angle);
        output
    });
    let expected = [0.0, 0.4, 0.4, 0.4, 0.2, 0.2, 0.5];
    for (found, expected) in outputs.into_iter().zip(expected) {
        assert!((found - expected).abs() < 1e-15, "{outputs:?}");
    }
    // A step of its own remembers how the drive was left.
    let robot = antagonists(paper_backbone(), spool());
    let case = loaded(&robot, &[1.4, 1.35]);
    let mut last = case.single_steps().nth(1).unwrap();
    let driven = last.commands.clone();
    assert_eq!(driven, case.commands);
    assert_eq!(driven, case.before[0]);
    last.drive(&robot).unwrap();
    assert_eq!(last.commands, driven);
}

#[test]
fn derivatives_by_the_numbers_of_a_motor_are_those_of_differences() {
    let robot = antagonists(paper_backbone(), spool());
    // The second angle leaves the play of the drive on its other side.
    let case = loaded(&robot, &[1.9, 1.2]);
    let parameters = [
        "motors[0].stiffness",
        "motors[0].free_length",
        "motors[0].pretension",
        "motors[0].backlash",
        "motors[0].angle_offset",
        "motors[0].angle",
        "motors[0].gear_ratio",
        "motors[0].spool_radius",
        "motors[0].spool_radius[1]",
        "cables[0].axial_stiffness",
        "cables[0].routing.radius",
    ]
    .map(|path| path.parse::<Parameter>().unwrap());
    for kind in WITH_FORCES {
        let tight = model(kind).with_tolerance(1e-10);
        let mut prepared = tight.prepare(&robot, &case.loads).unwrap();
        let last = case.single_steps().nth(1).unwrap();
        let (_, exact) = prepared.solve_with_derivatives(&last, None, &parameters).unwrap();
        for (index, parameter) in parameters.iter().enumerate() {
            let by = 1e-3 * parameter.value(&robot, &last).unwrap();
            let tip = |by: f64| {
                let (robot, case) = parameter.moved(&robot, &last, by).unwrap();
                tight.solve(&robot, &case).unwrap().disks.tip().position
            };
            let difference =
                (tip(by) - tip(-by)) * (4.0 / 3.0) - (tip(2.0 * by) - tip(-2.0 * by)) / 6.0;
            let change =
                exact.parameter(index, Hold::Commands).twist(Place::Tip).linear * (2.0 * by);
            let error = (difference - change).norm() / difference.norm();
            assert!(error < 1e-5, "{kind} {parameter}: {error:e} {difference:?} {change:?}");
        }
    }
}

#[test]
fn rows_of_motors_are_the_cases_with_their_commands() {
    let robot = antagonists(paper_backbone(), spool());
    // The play was left on its far side; the last row is beyond what a motor may be told.
    let earlier = loaded(&robot, &[1.9, 1.2]);
    let values = [1.2, 1.87, 2.4, 1e9];
    for kind in WITH_FORCES {
        let model = model(kind).with_tolerance(1e-10);
        let rows = Rows::Motors { values: &values, case: &earlier };
        let batch = solve_batch(&model, &robot, rows, &BatchOptions::default()).unwrap();
        let stations = batch.positions().len() / (3 * values.len());
        for (i, value) in values.into_iter().enumerate() {
            let case = earlier.driven_to(&robot, &[Some(value)]).unwrap();
            let Ok(alone) = model.solve(&robot, &case) else {
                assert!(i == 3 && batch.row(i).unwrap().is_err(), "{kind} {value}");
                continue;
            };
            let tip = alone.disks.tip().position;
            let found = Vec3::from(batch.row(i).unwrap().unwrap().position(stations - 1));
            assert!((found - tip).norm() < 1e-12, "{kind} {value}: {found:?} {tip:?}");
        }
        let mut weights = vec![0.0; values.len() * stations * 3];
        let last = 3 * (stations - 1);
        for row in 0..values.len() {
            weights[3 * row * stations + last] = 1.0;
        }
        let sensitivities = Sensitivities { positions: &weights, ..Default::default() };
        let (mut commands, mut parameters) = ([0.0; 4], [0.0; 4]);
        let offset = ["motors[0].angle_offset".parse().unwrap()];
        let gradients = Gradients { commands: &mut commands, parameters: &mut parameters };
        let options = BatchOptions::default();
        let rows = Rows::Motors { values: &values, case: &earlier };
        pull_back_batch(&model, &robot, rows, &offset, &options, sensitivities, gradients).unwrap();
        // Within its play the drive does not move.
        assert_eq!(commands[1], 0.0, "{kind}");
        for row in [0, 2] {
            let x = |by: f64| {
                let case = earlier.driven_to(&robot, &[Some(values[row] + by)]).unwrap();
                model.solve(&robot, &case).unwrap().disks.tip().position.x
            };
            let difference = (x(1e-3) - x(-1e-3)) / 2e-3;
            let error = (commands[row] - difference).abs() / difference.abs();
            assert!(error < 1e-5, "{kind}: {} {difference}", commands[row]);
            assert!((commands[row] + parameters[row]).abs() < 1e-9 * difference.abs(), "{kind}");
        }
        assert_eq!(commands[3], 0.0);
    }
    let still =
        Robot::new(robot.backbone().clone(), robot.disks().clone(), robot.cables().to_vec());
    let rows = Rows::Motors { values: &values, case: &Case::default() };
    let model = model(ModelKind::Cosserat);
    let error = solve_batch(&model, &still.unwrap(), rows, &BatchOptions::default()).unwrap_err();
    assert_eq!(error, BatchError::NoCommands { driven: Driven::Motors });
}

#[test]
fn what_no_motor_can_do_is_refused_by_name() {
    let robot = antagonists(paper_backbone(), spool());
    let with =
        |motors: Vec<Motor>| robot.clone().with_motors(motors).map_err(|error| error.to_string());
    let told = |motors: Vec<Motor>| with(motors).unwrap_err();
    assert_eq!(
        told(vec![Motor::spool("a", [(0, 0.01)]), Motor::spool("b", [(1, 0.01), (0, 0.01)])]),
        "`cables` of motor 2: is `left`, which motor `a` pulls already: a cable belongs to one motor at most"
    );
    assert_eq!(
        told(vec![Motor::spool("a", [(2, 0.01)])]),
        "`cables` of motor 1: is cable 3, but the robot has 2 cables"
    );
    assert_eq!(
        told(vec![Motor { pretension: 1.0, ..Motor::spool("a", [(1, 0.01)]) }]),
        "`pretension` of motor 1: needs cables that stretch: give the motor a `stiffness`, or its cables an `axial_stiffness`"
    );
    let limits = whipcord::MotorLimits { range: Some([-1.0, 1.0]), ..Default::default() };
    let limited = with(vec![Motor { limits, ..Motor::spool("a", [(1, 0.01)]) }]).unwrap();
    let beyond = Case::with_motors(&limited, &[1.5]).unwrap_err();
    assert!(matches!(beyond.problem, Problem::BeyondMotorLimit { greatest: 1.0, .. }), "{beyond}");
    assert_eq!(
        beyond.to_string(),
        "`angle` of motor 1: must be from -1 rad to 1 rad, the limits of this motor, but is 1.5 rad"
    );
    // What is no number is refused in the steps before as well.
    let mut unknown = Case::with_motors(&limited, &[0.5]).unwrap();
    unknown.motors.insert(0, vec![Some(f64::NAN)]);
    let refused = unknown.drive(&limited).unwrap_err();
    assert!(matches!(refused.problem, Problem::NotFinite { .. }), "{refused}");
    let many = Case::with_motors(&limited, &[0.5, 0.5]).unwrap_err();
    assert_eq!(many.problem, Problem::MotorCount { given: 2, motors: 1 });
}

#[test]
fn a_soft_drive_gives_under_the_tension_below_the_base_where_the_cable_rubs() {
    let stiffness = 3e3;
    let motor = Motor { stiffness: Some(stiffness), ..Motor::spool("m", [(0, 0.01)]) };
    let cable = Cable { friction: Some(0.2), ..Cable::new("pull", straight(0.0)) };
    let disks = Disks::equally_spaced(0.18, 10, 0.008);
    let plain = Robot::new(paper_backbone(), disks, vec![cable]).unwrap();
    let robot = plain.clone().with_motors(vec![motor]).unwrap();
    let case = Case::with_motors(&robot, &[0.9]).unwrap();
    for kind in WITH_FORCES {
        let solution = model(kind).solve(&robot, &case).unwrap();
        let state = &solution.cables[0];
        let tension = state.tension.unwrap();
        // What the hole in the base takes off the tension is left out.
        let beyond = match kind {
            ModelKind::Cosserat => tension,
            _ => state.span_tensions[0],
        };
        let expected = 0.01 * 0.9 - beyond / stiffness;
        let shortening = state.initial_length - state.length;
        // The rod whose cables rub along curves has the error of its grid.
        assert!((shortening - expected).abs() < 1e-5 * 0.18, "{kind}: {shortening} {expected}");
        // Pulled up to the same tension the robot without a motor is bent as far.
        let same = model(kind).solve(&plain, &Case::with_tensions(&[tension])).unwrap();
        let apart = apart(&same, &solution);
        assert!(apart < 1e-4 * 0.18, "{kind}: {apart:e}");
    }
}

/// Steps of motors in which a cable pays out and hardly pulls: its tension, which is rounding, needs no accuracy of its own.
#[test]
fn motors_that_pay_a_rubbing_cable_out_are_solved_within_the_budget() {
    let cables = [0.0, 120.0, 240.0].map(|angle| Cable {
        friction: Some(0.15),
        ..Cable::new(format!("c{angle}"), straight(angle))
    });
    let disks = Disks::equally_spaced(0.18, 11, 0.008);
    let motors = (0..3).map(|i| Motor {
        stiffness: Some(5e3),
        pretension: 2.0,
        ..Motor::spool(format!("m{i}"), [(i, 0.01)])
    });
    let robot = Robot::new(paper_backbone(), disks, cables.to_vec()).unwrap();
    let robot = robot.with_motors(motors.collect()).unwrap();
    let angles = [[0.34, 0.16, -0.5], [0.01, -0.14, 0.13], [-0.27, 0.14, 0.13]];
    let mut case = Case {
        commands: vec![Default::default(); 3],
        before: vec![vec![Default::default(); 3]; 2],
        motors: angles.iter().map(|step| step.map(Some).to_vec()).collect(),
        ..Case::default()
    };
    case.drive(&robot).unwrap();
    let tips = WITH_FORCES.map(|kind| {
        let mut prepared = model(kind).prepare(&robot, &case.loads).unwrap();
        let solution = prepared.solve_to_the_end(&case).map_err(|(_, error)| error).unwrap();
        solution.disks.tip().position
    });
    for (kind, tip) in WITH_FORCES.iter().zip(tips) {
        assert!((tip - tips[0]).norm() < 2e-3, "{kind}: {tip:?} {:?}", tips[0]);
    }
}

/// A cable that is about to get slack has a tension that is a small difference of great ones: the discretisation error of the answer
/// does not count it by its own size. All steps at once are those one by one.
#[test]
fn rows_in_which_an_antagonist_gets_slack_have_answers() {
    let cables = [0.0, 90.0, 180.0, 270.0].map(|angle| Cable {
        friction: Some(0.05),
        ..Cable::new(format!("c{angle}"), straight(angle))
    });
    let backbone = Backbone {
        section: Some(whipcord::Section::circle(0.0016)),
        material: whipcord::Material {
            young_modulus: Some(58e9),
            poisson_ratio: Some(0.3),
            ..Default::default()
        },
        ..Backbone::new(0.2)
    };
    let motor = |name, [pulled, paid_out]: [usize; 2]| Motor {
        stiffness: Some(4e4),
        pretension: 6.0,
        ..Motor::spool(name, [(pulled, 0.01), (paid_out, -0.01)])
    };
    let robot = Robot::new(backbone, Disks::equally_spaced(0.2, 11, 0.008), cables.to_vec());
    let motors = vec![motor("pan", [0, 2]), motor("tilt", [1, 3])];
    let robot = robot.unwrap().with_motors(motors).unwrap();
    let degrees: [[f64; 2]; 5] =
        [[-45.0, -21.8], [14.3, -37.0], [15.1, -43.6], [25.0, -45.0], [25.0, -45.0]];
    let mut case = Case {
        commands: vec![Default::default(); 4],
        before: vec![vec![Default::default(); 4]; 4],
        motors: degrees.map(|row| row.map(|angle| Some(angle.to_radians())).to_vec()).to_vec(),
        ..Case::default()
    };
    case.drive(&robot).unwrap();
    let kinds = [
        ModelKind::CosseratDisks,
        ModelKind::PiecewiseConstantCurvature,
        ModelKind::PseudoRigidBody,
    ];
    for kind in kinds {
        let mut prepared = model(kind).prepare(&robot, &case.loads).unwrap();
        let mut all = Vec::new();
        prepared.solve_steps(&case, |solution| all.push(solution)).unwrap();
        assert_eq!(all.len(), 5);
        for (step, solution) in case.steps().zip(&all) {
            let alone = prepared.solve(&step, None).unwrap();
            let apart = apart(&alone, solution);
            assert!(apart < 1e-6, "{kind}: {apart:e}");
        }
        // Equal commands one after the other change nothing.
        assert!(apart(&all[3], &all[4]) < 1e-6, "{kind}");
    }
}
