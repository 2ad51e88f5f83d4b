//! Gradients over motions in which the robot hits an obstacle, against central differences of the same steps.

use core::f64::consts::FRAC_PI_2;

use whipcord::{Case, Form, Loads, ModelKind, Obstacle, Pose, UnitQuaternion, Vec3};
use whipcord_motion::{Commands, Course, Damping, Initial, LoadCourse, Method, MotionOptions};

use super::gradient::{DT, Problem, STEPS, by_tensions, close, difference, gravity, weight};

const METHODS: [Method; 3] = [Method::Accurate, Method::Energy, Method::Robust];

/// What the robot hits.
#[derive(Clone, Copy, Debug)]
enum Hit {
    Ball,
    HalfSpace,
}

/// A robot that is let go from straight and pulled against an obstacle.
fn problem(method: Method, hit: Hit, friction: f64, command: (usize, usize, f64)) -> Problem {
    let mut problem = by_tensions((ModelKind::Cosserat, method), 1.0, 1.0, 1.0);
    problem.options.initial = Initial::Rest;
    let commands = |(step, cable, by): (usize, usize, f64)| -> Vec<Commands> {
        let pull = |k: usize, i: usize| {
            let more = if (k, i) == (step, cable) { by } else { 0.0 };
            [4.0, 0.5][i] + 0.05 * weight(3 * k + i) + more
        };
        (0..STEPS).map(|k| Commands::tensions(&[pull(k, 0), pull(k, 1)])).collect()
    };
    problem.commands = commands(command);
    // The obstacle stands in the way of the motion that no command of is changed.
    let mut free = problem.simulation();
    let states = free.record(&commands((STEPS, 0, 0.0)), DT).unwrap().states;
    let tip = |k: usize| states[k].tip().position;
    let way = tip(4) - tip(2);
    let way = Vec3::new(way.x, way.y, 0.2 * way.z) * (1.0 / way.norm());
    let (form, pose) = match hit {
        Hit::Ball => {
            let position = tip(3) + way * 0.06;
            (Form::Sphere { radius: 0.05 }, Pose { position, ..Pose::IDENTITY })
        }
        Hit::HalfSpace => {
            // Its normal is the axis z of its pose.
            let axis = Vec3::Z.cross(way * -1.0);
            let angle = axis.norm().atan2(-way.z);
            let rotation = UnitQuaternion::exp(axis * (angle / axis.norm()));
            (Form::HalfSpace, Pose { position: tip(3) + way * 0.01, rotation })
        }
    };
    let obstacle = Obstacle { name: "it".to_owned(), form, pose, friction, movable: None };
    problem.case.obstacles = vec![obstacle];
    problem
}

#[test]
fn gradients_through_an_impact_are_those_of_differences() {
    for method in METHODS {
        for hit in [Hit::Ball, Hit::HalfSpace] {
            for friction in [0.0, 0.4] {
                let name = format!("{method:?}, {hit:?}, {friction}");
                let at = |command| problem(method, hit, friction, command);
                let base = at((STEPS, 0, 0.0));
                let record = base.simulation().record(&base.commands, DT).unwrap();
                let touched = record.states.iter().map(|of| of.contacts.len()).collect::<Vec<_>>();
                let parts = record.states.iter().map(|of| of.diagnostics.parts).collect::<Vec<_>>();
                println!("{name} {touched:?} {parts:?} {:?}", record.one_sided());
                assert!(parts.iter().any(|parts| *parts > 3), "{name}");
                base.check_by_commands(1e-4, at, &name);
            }
        }
    }
}
