//! Gravity that changes over time, against gravity that does not and against differences.

use whipcord::{Case, Loads, ModelKind, Vec3};
use whipcord_motion::{Course, LoadCourse, Method, MotionOptions, Simulation};

use super::gradient::{DT, Problem, by_tensions, close, difference, options, robot};
use super::robots::{helix, straight};

const GRAVITY: Vec3 = Vec3 { x: 4.0, y: -7.0, z: 3.0 };

fn over_time(factor: Course) -> LoadCourse {
    let loads = Loads { gravity: Some(GRAVITY), ..Loads::default() };
    LoadCourse { loads, factor }
}

/// Gravity with a constant factor over time, part of it in the case, moves the robot as gravity in the case does, from its equilibrium on.
#[test]
fn constant_gravity_over_time_is_that_of_the_case() {
    for method in [Method::Accurate, Method::Energy, Method::Robust] {
        let problem = by_tensions((ModelKind::Cosserat, method), 1.0, 1.0, 1.0);
        let run = |in_case: f64| {
            let loads = Loads { gravity: Some(GRAVITY * in_case), ..Loads::default() };
            let case = Case { loads, ..problem.case.clone() };
            let mut options = problem.options.clone();
            options.loads.push(over_time(Course::constant(1.0 - in_case)));
            let mut simulation = Simulation::new(&problem.robot, &case, options).unwrap();
            for commands in &problem.commands {
                simulation.step(commands, DT).unwrap();
            }
            let energy = simulation.state().energy;
            // Of a constant gravity the work is what its potential loses.
            let given = energy.loads - (energy.gravity - energy.initial);
            (simulation.state().tip().position, simulation.base_wrench(), given, energy.defect())
        };
        let (expected, other) = (run(1.0), run(0.25));
        let apart = (expected.0 - other.0).norm();
        assert!(apart < 1e-9, "{method:?} {apart:e}");
        assert!((expected.1.force - other.1.force).norm() < 1e-8, "{method:?}");
        assert!((expected.1.moment - other.1.moment).norm() < 1e-9, "{method:?}");
        assert!(
            (expected.3 - other.3).abs() < 1e-3 * expected.2.abs(),
            "{method:?} {expected:?} {other:?}"
        );
    }
}

/// The derivative by a factor on all masses has the weight over time.
#[test]
fn gradients_with_gravity_over_time_are_those_of_differences() {
    for method in [Method::Accurate, Method::Energy, Method::Robust] {
        let at = |mass: f64| {
            let factor = Course::table(vec![0.0, 0.03], vec![0.2, 2.0]).unwrap();
            Problem {
                robot: robot(1.0, mass, vec![helix(), straight("b", 2.0, 0.008)]),
                options: MotionOptions { method, loads: vec![over_time(factor)], ..options() },
                ..by_tensions((ModelKind::Cosserat, method), 1.0, 1.0, 1.0)
            }
        };
        let found = at(1.0).gradient().factors.mass;
        let expected = difference(1e-3, |by| at(1.0 + by).number());
        close(found, expected, 0.1, &format!("{method:?}"));
    }
}
