//! Steps that are separate experiments, in every model that knows tensions.

use whipcord::{
    Actuation, Backbone, Cable, Case, Disks, Model, ModelKind, Motor, Robot, Solution,
    Statics as _, Stations,
};

use whipcord::robot::BendingFriction;

use crate::common::{WITH_FORCES, model_with_forces, paper_backbone, straight};

/// A cable with friction in its holes, and one on a spool with backlash.
fn robot() -> Robot {
    let cables = vec![
        Cable { friction: Some(0.3), ..Cable::new("rubs", straight(0.0)) },
        Cable { axial_stiffness: Some(3e3), ..Cable::new("winds", straight(90.0)) },
    ];
    let motor = Motor { backlash: 0.1, ..Motor::spool("spool", [(1, 0.01)]) };
    let disks = Disks::equally_spaced(0.18, 7, 0.008);
    Robot::new(paper_backbone(), disks, cables).unwrap().with_motors(vec![motor]).unwrap()
}

/// Pulls and lets go, so that the last step hangs on those before it where they are steps in order.
fn case(robot: &Robot, independent: bool) -> Case {
    let step = |tension| {
        let mut commands = Case::with_tensions(&[tension, 0.0]).commands;
        commands[1].tension = None;
        commands
    };
    let mut case = Case {
        before: vec![step(1.0), step(3.0)],
        motors: vec![vec![Some(0.2)], vec![Some(0.5)], vec![Some(0.42)]],
        independent,
        commands: step(2.0),
        ..Case::default()
    };
    case.drive(robot).unwrap();
    case
}

/// The same step for a robot that was never pulled before.
fn alone(robot: &Robot, case: &Case, step: usize) -> Case {
    let mut alone = Case {
        commands: case.before.get(step).unwrap_or(&case.commands).clone(),
        motors: vec![case.motors[step].clone()],
        ..Case::default()
    };
    alone.drive(robot).unwrap();
    alone
}

#[test]
fn independent_steps_know_nothing_of_one_another() {
    let robot = robot();
    let (independent, in_order) = (case(&robot, true), case(&robot, false));
    for kind in WITH_FORCES {
        let model = model_with_forces(kind, Stations::default(), Actuation::Natural);
        let solve = |case: &Case| -> Vec<Solution> {
            model.prepare(&robot, &case.loads).unwrap().solve_all(case).unwrap()
        };
        let steps = solve(&independent);
        for (number, step) in steps.iter().enumerate() {
            let own = model.solve(&robot, &alone(&robot, &independent, number)).unwrap();
            assert_eq!(own.shape, step.shape, "{kind}, step {number}");
            let single = independent.independent_step(number).unwrap();
            assert_eq!(model.solve(&robot, &single).unwrap().shape, step.shape, "{kind}");
        }
        // The case is its last step, however it is asked.
        let last = steps.last().unwrap();
        let solved = model.solve(&robot, &independent).unwrap();
        let to_the_end = model
            .prepare(&robot, &independent.loads)
            .unwrap()
            .solve_to_the_end(&independent)
            .unwrap();
        assert_eq!((&solved.shape, &to_the_end.shape), (&last.shape, &last.shape), "{kind}");
        // In order the cable with friction is still as tight inside as the step before left it, and the spool hangs in its play.
        let remembers = solve(&in_order).pop().unwrap();
        let apart = remembers.disks.distances(&last.disks).fold(0.0, f64::max);
        assert!(apart > 5e-4, "{kind}: {apart}");
    }
    assert!(ModelKind::ALL.len() > WITH_FORCES.len());
}

#[test]
fn independent_steps_forget_the_friction_of_the_backbone() {
    let friction = BendingFriction { yield_moment: [5e-3; 2], yield_stiffness: None };
    let backbone = Backbone { bending_friction: Some(friction), ..paper_backbone() };
    let disks = Disks::equally_spaced(0.18, 7, 0.008);
    let robot = Robot::new(backbone, disks, vec![Cable::new("pull", straight(0.0))]).unwrap();
    let commands = |tension: f64| Case::with_tensions(&[tension]).commands;
    let case = |independent| Case {
        before: vec![commands(1.0), commands(3.0)],
        independent,
        ..Case::with_tensions(&[2.0])
    };
    for kind in [ModelKind::Cosserat, ModelKind::CosseratDisks] {
        let model = Model::new(kind, Stations::default(), Actuation::Natural);
        let mut prepared = model.prepare(&robot, &Default::default()).unwrap();
        let steps = prepared.solve_all(&case(true)).unwrap();
        let of_order = prepared.solve_all(&case(false)).unwrap();
        for (step, tension) in steps.iter().zip([1.0, 3.0, 2.0]) {
            let alone = model.solve(&robot, &Case::with_tensions(&[tension])).unwrap();
            assert_eq!(alone.shape, step.shape, "{kind}, {tension} N");
        }
        assert_eq!(model.solve(&robot, &case(true)).unwrap().shape, steps[2].shape, "{kind}");
        let mut derived = Vec::new();
        prepared
            .solve_steps_with_derivatives(
                &case(true),
                &[],
                |step| step > 0,
                |solution, of| {
                    derived.push((solution.shape, of.is_some()));
                },
            )
            .unwrap();
        let expected: Vec<_> =
            steps.iter().enumerate().map(|(n, step)| (step.shape.clone(), n > 0)).collect();
        assert_eq!(derived, expected, "{kind}");
        let apart = of_order[2].disks.distances(&steps[2].disks).fold(0.0, f64::max);
        assert!(apart > 1e-3, "{kind}: {apart}");
    }
}

/// Each step has its own loads, whether the steps are independent or in order.
#[test]
fn loads_may_differ_from_step_to_step() {
    let cables = vec![Cable::new("pull", straight(0.0))];
    let disks = Disks::equally_spaced(0.18, 7, 0.008);
    let robot = Robot::new(paper_backbone(), disks, cables).unwrap();
    let loads = |force: [f64; 3]| whipcord::Loads { tip_force: force.into(), ..Default::default() };
    let forces = [[0.0, 0.05, 0.0], [0.0, 0.0, -0.1], [0.02, -0.05, 0.0]];
    let tensions = [1.0, 2.0, 1.5];
    for independent in [true, false] {
        let case = Case {
            before: tensions[..2].iter().map(|t| Case::with_tensions(&[*t]).commands).collect(),
            loads_before: forces[..2].iter().map(|force| loads(*force)).collect(),
            loads: loads(forces[2]),
            independent,
            ..Case::with_tensions(&[tensions[2]])
        };
        for kind in WITH_FORCES {
            let model = model_with_forces(kind, Stations::default(), Actuation::Natural);
            let solved = model.prepare(&robot, &case.loads).unwrap().solve_all(&case).unwrap();
            for (step, solution) in solved.iter().enumerate() {
                let alone =
                    Case { loads: loads(forces[step]), ..Case::with_tensions(&[tensions[step]]) };
                let alone = model.solve(&robot, &alone).unwrap();
                let apart = alone.disks.distances(&solution.disks).fold(0.0, f64::max);
                assert!(apart < 1e-6, "{kind}, step {step}: {apart:e}");
                let single = case.step(step).unwrap();
                assert_eq!(single.loads, loads(forces[step]));
                assert_eq!(single.loads_before.len(), step);
            }
        }
    }
}
