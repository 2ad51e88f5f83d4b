//! Motion among obstacles, against statics, closed forms and the laws that every contact keeps.

use core::f64::consts::FRAC_PI_2;

use whipcord::{
    Case, Form, Loads, Model, Obstacle, Part, Pose, Robot, Solution, UnitQuaternion, Vec3, cosserat,
};
use whipcord_motion::{
    BaseMotion, Commands, Course, Damping, Initial, Method, MotionError, MotionOptions, Simulation,
    State,
};

use super::robots::{paper, rod, straight};

const STEPS: [f64; 4] = [1e-3, 5e-3, 1e-2, 2e-2];

/// A half-space below x = `height`.
fn floor(height: f64, friction: f64) -> Obstacle {
    let rotation = UnitQuaternion::exp(Vec3::Y * FRAC_PI_2);
    let pose = Pose { position: Vec3::X * height, rotation };
    Obstacle { name: "floor".to_owned(), form: Form::HalfSpace, pose, friction, movable: None }
}

fn ball(position: Vec3, radius: f64, friction: f64) -> Obstacle {
    let pose = Pose { position, ..Pose::IDENTITY };
    let form = Form::Sphere { radius };
    Obstacle { name: "ball".to_owned(), form, pose, friction, movable: None }
}

/// Gravity against x.
fn heavy() -> Loads {
    Loads { gravity: Some(Vec3::new(-9.81, 0.0, 0.0)), ..Loads::default() }
}

fn soft_rod() -> Robot {
    rod(0.5, 4e-3, 2e9, 0.25, 4000.0, vec![])
}

fn still(robot: &Robot, case: &Case) -> Solution {
    let model = Model::Cosserat(cosserat::Options::default());
    model.prepare(robot, &case.loads).unwrap().solve(case, None).unwrap()
}

/// The laws of contact: no overlap, forces that push, friction within its cone.
fn obey(state: &State, obstacles: &[Obstacle], length: f64) {
    for contact in &state.contacts {
        let force = contact.force.unwrap();
        assert!(force > 0.0 && contact.gap > -1e-4 * length, "{contact:?}");
        let friction = contact.friction.unwrap();
        let most = obstacles[contact.obstacle].friction * force;
        assert!(friction.norm() <= most * (1.0 + 1e-6) + 1e-12, "{contact:?}");
        assert!(friction.dot(contact.normal).abs() < 1e-9 * (force + 1.0));
    }
}

/// A rod that falls onto a floor bounces and comes to rest in the equilibrium of the statics, at every step.
#[test]
fn a_rod_that_falls_on_a_floor_comes_to_rest_there() {
    let robot = soft_rod();
    let case = Case { obstacles: vec![floor(-0.05, 0.0)], loads: heavy(), ..Case::default() };
    let expected = still(&robot, &case).contacts[0].force.unwrap();
    for dt in STEPS {
        for method in [Method::Accurate, Method::Energy, Method::Robust] {
            let options = MotionOptions {
                initial: Initial::Rest,
                damping: Damping::Time(0.01),
                method,
                ..MotionOptions::default()
            };
            let mut simulation = Simulation::new(&robot, &case, options).unwrap();
            let mut touched = 0;
            for _ in 0..(2.0 / dt).round() as usize {
                let state = simulation.step(&Commands::default(), dt).unwrap();
                obey(state, &case.obstacles, 0.5);
                touched += usize::from(!state.contacts.is_empty());
                let lowest = state.poses.iter().map(|pose| pose.position.x).fold(0.0, f64::min);
                assert!(lowest > -0.048 - 5e-6, "{lowest}");
            }
            let state = simulation.state();
            let [contact] = state.contacts.as_slice() else { panic!("{:?}", state.contacts) };
            assert!(touched > 20);
            assert!((contact.force.unwrap() / expected - 1.0).abs() < 0.02, "{dt} {contact:?}");
            assert!(contact.part == Part::Backbone && (contact.arc_length - 0.5).abs() < 1e-9);
            // An obstacle at rest gives no energy, and the integration only takes some.
            let energy = state.energy;
            let lost = -energy.gravity;
            assert!(energy.contacts < 0.0 && energy.defect() < 1e-3 * lost, "{energy:?}");
        }
    }
}

/// The equilibrium to start from is that of the statics, with its contacts, and the robot stays there.
#[test]
fn a_motion_starts_in_contact() {
    let robot = paper(vec![straight("a", 0.0, 0.008)]);
    for friction in [0.0, 0.4] {
        let case = Case {
            obstacles: vec![ball(Vec3::new(0.075, 0.0, 0.11), 0.03, friction)],
            ..Case::with_tensions(&[6.0])
        };
        let expected = still(&robot, &case);
        let options = MotionOptions {
            damping: Damping::Time(3.5e-3),
            elements: 20,
            ..MotionOptions::default()
        };
        let mut simulation = Simulation::new(&robot, &case, options).unwrap();
        let start = simulation.state().tip().position;
        assert!((start - expected.shape.poses.last().unwrap().position).norm() < 2e-4);
        let total = |contacts: &[whipcord::Contact]| {
            let force = |c: &whipcord::Contact| c.normal * c.force.unwrap() + c.friction.unwrap();
            contacts.iter().map(force).fold(Vec3::ZERO, |a, b| a + b)
        };
        let commands = Commands::of_case(&robot, &case);
        for _ in 0..50 {
            let state = simulation.step(&commands, 0.01).unwrap();
            assert!((state.tip().position - start).norm() < 2e-5);
            let (found, known) = (total(&state.contacts), total(&expected.contacts));
            assert!((found - known).norm() < 0.03 * known.norm(), "{found:?} {known:?}");
        }
        // At rest the base holds what obstacle and cable exert; the cable leaves through the base.
        let wrench = simulation.base_wrench();
        let pushed = total(&simulation.state().contacts);
        assert!((wrench.force + pushed).norm() < 1e-3 * pushed.norm(), "{wrench:?} {pushed:?}");
    }
}

/// A rod whose base drives along a floor is held back by μ times its normal force, against the motion of what touches.
#[test]
fn friction_of_a_rod_that_is_dragged() {
    let robot = soft_rod();
    let friction = 0.3;
    let case = Case { obstacles: vec![floor(-0.03, friction)], loads: heavy(), ..Case::default() };
    let constant = Course::constant;
    for (direction, sign) in [(1, 1.0), (1, -1.0)] {
        let mut base = BaseMotion::default();
        base.velocity[direction] = Course::table(vec![0.0, 0.2], vec![0.0, 0.1 * sign]).unwrap();
        base.angular_velocity = [0.0; 3].map(constant);
        let options = MotionOptions {
            base: Some(base),
            damping: Damping::Time(0.02),
            ..MotionOptions::default()
        };
        let mut simulation = Simulation::new(&robot, &case, options).unwrap();
        for _ in 0..150 {
            let state = simulation.step(&Commands::default(), 0.01).unwrap();
            obey(state, &case.obstacles, 0.5);
        }
        let state = simulation.state();
        let normal: f64 = state.contacts.iter().map(|c| c.force.unwrap()).sum();
        let held: f64 = state.contacts.iter().map(|c| c.friction.unwrap().y).sum();
        assert!(state.contacts.iter().all(|contact| !contact.sticks));
        assert!((held / (friction * normal) + sign).abs() < 0.02, "{held} {normal}");
        assert!(state.energy.contacts < 0.0 && state.energy.base > 0.0);
    }
}

/// A slope below the angle of friction holds what lies on it, a steeper one does not: a heavy rod whose base stands still and whose tip lies on a floor
/// that is pulled sideways by gravity.
#[test]
fn friction_sticks_up_to_its_angle() {
    let robot = rod(0.5, 4e-3, 2e7, 0.25, 4000.0, vec![]);
    let case_of = |angle: f64| {
        let gravity = Vec3::new(-angle.cos(), angle.sin(), 0.0) * 9.81;
        let loads = Loads { gravity: Some(gravity), ..Loads::default() };
        Case { obstacles: vec![floor(-0.02, 0.5)], loads, ..Case::default() }
    };
    let drift = |angle: f64| {
        let options = MotionOptions {
            initial: Initial::Rest,
            damping: Damping::Time(0.02),
            ..MotionOptions::default()
        };
        let flat = case_of(0.0);
        let mut simulation = Simulation::new(&robot, &flat, options.clone()).unwrap();
        for _ in 0..200 {
            simulation.step(&Commands::default(), 0.01).unwrap();
        }
        let start = simulation.state().start();
        let tilted = MotionOptions { initial: Initial::State(Box::new(start)), ..options };
        let mut simulation = Simulation::new(&robot, &case_of(angle), tilted).unwrap();
        let before = simulation.state().tip().position.y;
        for _ in 0..100 {
            simulation.step(&Commands::default(), 0.01).unwrap();
        }
        (simulation.state().tip().position.y - before).abs()
    };
    let (below, above) = (drift(0.2), drift(0.9));
    assert!(below < 1e-3 && above > 1e-2, "{below} {above}");
}

/// What is thin is not passed through, however long a step is.
#[test]
fn a_thin_wall_stops_a_fast_robot() {
    let robot = paper(vec![straight("a", 0.0, 0.008)]);
    let wall = Obstacle {
        form: Form::Box { size: Vec3::new(1e-3, 0.2, 0.2) },
        ..ball(Vec3::new(0.04, 0.0, 0.15), 1.0, 0.2)
    };
    let case = Case { obstacles: vec![wall], ..Case::with_tensions(&[0.0]) };
    for dt in STEPS {
        let options = MotionOptions { damping: Damping::Time(2e-3), ..MotionOptions::default() };
        let mut simulation = Simulation::new(&robot, &case, options).unwrap();
        for _ in 0..(0.5 / dt) as usize {
            let state = simulation.step(&Commands::tensions(&[10.0]), dt).unwrap();
            obey(state, &case.obstacles, 0.18);
            // The wall begins 39.5 mm from the axis; disks of 10 mm reach the farthest.
            assert!(state.tip().position.x < 0.0395, "{dt} {:?}", state.tip());
        }
        assert!(!simulation.state().contacts.is_empty());
    }
}

/// Cables by length among obstacles: the equilibrium in which the motion ends is that of the statics.
#[test]
fn lengths_among_obstacles_end_in_the_statics() {
    let robot = paper(vec![straight("a", 0.0, 0.008), straight("b", 2.1, 0.008)]);
    let by = [whipcord::Shortening::Length(8e-3), whipcord::Shortening::Length(-3e-3)];
    let case = Case {
        obstacles: vec![ball(Vec3::new(0.07, 0.0, 0.12), 0.03, 0.0)],
        ..Case::with_shortenings(&by)
    };
    let expected = still(&robot, &case);
    assert!(!expected.contacts.is_empty());
    let start = Case {
        ..Case::with_shortenings(&[by[0], by[1]].map(|_| whipcord::Shortening::Length(0.0)))
    };
    let start = Case { obstacles: case.obstacles.clone(), ..start };
    let options =
        MotionOptions { damping: Damping::Time(5e-3), elements: 20, ..MotionOptions::default() };
    let mut simulation = Simulation::new(&robot, &start, options).unwrap();
    let ramp = |to: f64| {
        whipcord_motion::CableDrive::Shortening(
            Course::table(vec![0.0, 0.3], vec![0.0, to]).unwrap(),
        )
    };
    let commands = Commands::new(vec![ramp(8e-3), ramp(-3e-3)]);
    for _ in 0..600 {
        obey(simulation.step(&commands, 0.01).unwrap(), &case.obstacles, 0.18);
    }
    let state = simulation.state();
    let tip = expected.shape.poses.last().unwrap().position;
    let options = MotionOptions { elements: 20, ..MotionOptions::default() };
    let direct = Simulation::new(&robot, &case, options).unwrap();
    assert!((direct.state().tip().position - tip).norm() < 3e-4);
    assert!((state.tip().position - tip).norm() < 3e-4, "{:?} {tip:?}", state.tip());
    for (cable, known) in state.cables.iter().zip(&expected.cables) {
        assert!((cable.tension - known.tension.unwrap()).abs() < 0.03 * (1.0 + cable.tension));
    }
}

/// Kept states go on in contact, to the last bit.
#[test]
fn a_state_in_contact_goes_on() {
    let robot = soft_rod();
    let case = Case { obstacles: vec![floor(-0.05, 0.3)], loads: heavy(), ..Case::default() };
    let options = MotionOptions { initial: Initial::Rest, ..MotionOptions::default() };
    let mut simulation = Simulation::new(&robot, &case, options).unwrap();
    let step = |simulation: &mut Simulation| {
        simulation.step(&Commands::default(), 0.01).unwrap();
    };
    (0..13).for_each(|_| step(&mut simulation));
    let kept = simulation.state().clone();
    (0..20).for_each(|_| step(&mut simulation));
    let first = simulation.state().clone();
    simulation.set_state(&kept).unwrap();
    (0..20).for_each(|_| step(&mut simulation));
    assert_eq!(*simulation.state(), first);
}

/// The place is refused before an explosion.
#[test]
fn what_starts_inside_an_obstacle_is_refused() {
    let robot = soft_rod();
    let inside = ball(Vec3::new(0.0, 0.0, 0.3), 0.05, 0.0);
    let case = Case { obstacles: vec![inside], ..Case::default() };
    let options = MotionOptions { initial: Initial::Rest, ..MotionOptions::default() };
    let error = Simulation::new(&robot, &case, options).unwrap_err();
    assert!(matches!(error, MotionError::Overlap { obstacle: 0, .. }), "{error}");
}
