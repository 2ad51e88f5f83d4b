//! Gradients over motions in which the robot hits an obstacle, against central differences of the same steps.

use whipcord::robot::Motor;
use whipcord::{Cable, Case, Form, Loads, ModelKind, Obstacle, Pose, Robot, Twist, Vec3};
use whipcord_motion::{
    BaseMotion, CableDrive, Commands, Course, Damping, Initial, LoadCourse, Method, MotionOptions,
    Record, Seed, Simulation,
};

use super::free_contact::facing;
use super::gradient::{DT, Problem, STEPS, by_tensions, close, difference, robot, vector, weight};
use super::robots::{rod, straight};

const METHODS: [Method; 3] = [Method::Accurate, Method::Energy, Method::Robust];

/// What the robot hits.
#[derive(Clone, Copy, Debug)]
enum Hit {
    Ball,
    HalfSpace,
}

/// A robot that is let go from straight and pulled against an obstacle.
fn problem(method: Method, hit: Hit, friction: f64) -> Problem {
    with_factors(method, hit, friction, [1.0, 1.0])
}

/// The same with factors on stiffness and mass.
fn with_factors(method: Method, hit: Hit, friction: f64, [stiffness, mass]: [f64; 2]) -> Problem {
    let model = (ModelKind::Cosserat, method);
    let mut problem = by_tensions(model, 1.0, 1.0, 1.0);
    problem.options.initial = Initial::Rest;
    let pull = |k: usize, i: usize| [4.0, 0.5][i] + 0.05 * weight(3 * k + i);
    let commands = (0..STEPS).map(|k| Commands::tensions(&[pull(k, 0), pull(k, 1)]));
    problem.commands = commands.collect();
    // The obstacle stands in the way of the motion without it.
    let states = problem.simulation().record(&problem.commands, DT).unwrap().states;
    let tip = |k: usize| states[k].tip().position;
    let way = tip(4) - tip(2);
    let way = Vec3::new(way.x, way.y, 0.2 * way.z) * (1.0 / way.norm());
    let (form, pose) = match hit {
        Hit::Ball => {
            let position = tip(3) + way * 0.06;
            (Form::Sphere { radius: 0.05 }, Pose { position, ..Pose::IDENTITY })
        }
        Hit::HalfSpace => {
            let rotation = facing(way * -1.0);
            (Form::HalfSpace, Pose { position: tip(3) + way * 0.01, rotation })
        }
    };
    problem.case.obstacles = vec![obstacle(form, pose, friction)];
    let Problem { robot, options, .. } = by_tensions(model, stiffness, mass, 1.0);
    problem.robot = robot;
    problem.options.damping = options.damping;
    problem
}

/// The same robot whose cables rub in their holes: one that stretches and one that does not.
fn rubbing(method: Method, friction: f64) -> Problem {
    let rub = |robot: &Robot| {
        let cable = |(i, cable): (usize, &Cable)| Cable {
            friction: Some([0.25, 0.37][i]),
            axial_stiffness: [Some(9000.0), None][i],
            ..cable.clone()
        };
        let cables = robot.cables().iter().enumerate().map(cable).collect();
        Robot::new(robot.backbone().clone(), robot.disks().clone(), cables).unwrap()
    };
    let mut problem = problem(method, Hit::Ball, friction);
    problem.robot = rub(&problem.robot);
    problem
}

#[test]
fn gradients_through_an_impact_with_cables_that_rub_are_those_of_differences() {
    for method in [Method::Accurate, Method::Robust] {
        for friction in [0.0, 0.4] {
            let name = format!("{method:?}, {friction}");
            let base = rubbing(method, friction);
            let record = base.simulation().record(&base.commands, DT).unwrap();
            let contacts = record.states.iter().filter(|of| !of.contacts.is_empty()).count();
            assert!(divided(&record) > 0 && contacts > 1, "{name} {contacts}");
            assert!(record.one_sided().is_empty(), "{name}: {:?}", record.one_sided());
            base.check_by_commands(3e-5, &name);
        }
    }
}

/// Impacts of a motion: steps that are divided and end in contact, or end it.
fn divided(record: &Record) -> usize {
    record.states.iter().filter(|state| state.diagnostics.parts > 3).count()
}

#[test]
fn gradients_through_an_impact_are_those_of_differences() {
    for method in METHODS {
        for hit in [Hit::Ball, Hit::HalfSpace] {
            for friction in [0.0, 0.4] {
                let name = format!("{method:?}, {hit:?}, {friction}");
                let base = problem(method, hit, friction);
                let record = base.simulation().record(&base.commands, DT).unwrap();
                let contacts = record.states.iter().filter(|of| !of.contacts.is_empty()).count();
                assert!(divided(&record) > 0 && contacts > 1, "{name}");
                assert!(record.one_sided().is_empty(), "{name}: {:?}", record.one_sided());
                base.check_by_commands(1e-4, &name);
            }
        }
    }
}

#[test]
fn gradients_through_an_impact_by_start_and_properties_are_those_of_differences() {
    for method in METHODS {
        for (hit, friction) in [(Hit::Ball, 0.4), (Hit::HalfSpace, 0.0)] {
            let name = format!("{method:?}, {hit:?}, {friction}");
            let base = problem(method, hit, friction);
            base.check_by_start(1e-4, &name);
            let factors = base.gradient().factors;
            let of = |at: &dyn Fn(f64) -> [f64; 2]| {
                let number = |by| with_factors(method, hit, friction, at(by)).number();
                difference(1e-4, number)
            };
            let stiffness = of(&|by| [1.0 + by, 1.0]);
            close(factors.stiffness, stiffness, 0.1, &format!("{name} stiffness"));
            close(factors.mass, of(&|by| [1.0, 1.0 + by]), 0.1, &format!("{name} mass"));
        }
    }
}

/// What drives a robot against an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Drive {
    Tension,
    Length,
    Motor,
    MotorWithInertia,
}

/// Commands and loads that change within the steps: how long a part of a step is changes them too.
#[test]
fn gradients_through_an_impact_by_ramps_are_those_of_differences() {
    for drive in [Drive::Tension, Drive::Length, Drive::Motor, Drive::MotorWithInertia] {
        for method in [Method::Accurate, Method::Robust] {
            let at = |command: (usize, usize, f64)| {
                let mut problem = problem(method, Hit::Ball, 0.2);
                let load = |by: f64| Loads { tip_force: vector(4) * by, ..Loads::default() };
                let factor = Course::table(vec![0.0, 1.0], vec![0.2, 3.0]).unwrap();
                problem.options.loads = vec![LoadCourse { loads: load(0.05), factor }];
                let cables = problem.robot.cables().to_vec();
                let ramp = |k: usize, i: usize, [from, to]: [f64; 2]| {
                    let by = if (k, i) == (command.0, command.1) { command.2 } else { 0.0 };
                    // A jump at the start of each step, whose rates are unknown then.
                    let by = by + 1e-2 * (to - from) * weight(3 * k + i);
                    Course::table(vec![0.0, 0.06], vec![from + by, to + by]).unwrap()
                };
                if drive == Drive::Motor || drive == Drive::MotorWithInertia {
                    let mut motor = Motor::spool("bend", [(0, 0.01), (1, -0.01)]);
                    if drive == Drive::MotorWithInertia {
                        motor.stiffness = Some(2e4);
                        motor.dynamics = Some(whipcord::robot::MotorDynamics {
                            damping: 1e-3,
                            derivative: 0.02,
                            integral: 1.0,
                            ..whipcord::robot::MotorDynamics::new(1e-5, 3.0)
                        });
                    }
                    problem.robot = robot(1.0, 1.0, cables).with_motors(vec![motor]).unwrap();
                }
                let told = |k: usize| match drive {
                    Drive::Tension => {
                        let course = |i, ends| CableDrive::Tension(ramp(k, i, ends));
                        Commands::new(vec![course(0, [3.0, 5.0]), course(1, [0.8, 0.2])])
                    }
                    Drive::Length => {
                        let course = |i, ends| CableDrive::Shortening(ramp(k, i, ends));
                        Commands::new(vec![course(0, [0.0, 0.02]), course(1, [0.0, -0.02])])
                    }
                    Drive::Motor | Drive::MotorWithInertia => {
                        let mut commands = Commands::tensions(&[0.0, 0.0]);
                        commands.motors = vec![Some(ramp(k, 0, [0.0, 2.0]))];
                        commands
                    }
                };
                problem.commands = (0..STEPS).map(told).collect();
                problem
            };
            let name = format!("{drive:?}, {method:?}");
            let base = at((STEPS, 0, 0.0));
            let record = base.simulation().record(&base.commands, DT).unwrap();
            assert!(divided(&record) > 0, "{name}");
            let gradient = base.gradient();
            let (found, unit) = match drive {
                Drive::Tension => (&gradient.cables, 1e-4),
                Drive::Length => (&gradient.cables, 1e-7),
                _ => (&gradient.motors, 1e-5),
            };
            let scale = found.iter().flatten().fold(0.0_f64, |max, x| max.max(x.abs()));
            for (k, row) in found.iter().enumerate() {
                for (i, value) in row.iter().enumerate() {
                    let expected = difference(unit, |by| at((k, i, by)).number());
                    close(*value, expected, scale, &format!("{name}: {k} {i}"));
                }
            }
        }
    }
}

/// A soft rod without disks.
fn falling() -> Robot {
    rod(0.5, 4e-3, 2e9, 0.25, 4000.0, vec![straight("a", 0.0, 0.01)])
}

/// The derivatives of where the tip is at the end of a motion that starts straight, by the velocities and strains at the start.
fn check_falling(
    case: &Case,
    options: &MotionOptions,
    (steps, impacts): (usize, usize),
    name: &str,
) {
    let robot = falling();
    let rest = MotionOptions { initial: Initial::Rest, ..options.clone() };
    let start = Simulation::new(&robot, case, rest).unwrap().state().start();
    let commands = vec![Commands::tensions(&[0.5]); steps];
    let at = |change: &dyn Fn(&mut whipcord_motion::Start)| {
        let mut start = start.clone();
        change(&mut start);
        let initial = Initial::State(Box::new(start));
        let mut simulation =
            Simulation::new(&robot, case, MotionOptions { initial, ..options.clone() }).unwrap();
        let record = simulation.record(&commands, 0.01).unwrap();
        (record.states.last().unwrap().tip().position.dot(vector(1)), record, simulation)
    };
    let (_, record, mut simulation) = at(&|_| ());
    let nodes = start.velocities.len();
    let mut seeds = vec![Seed::default(); record.states.len()];
    let mut positions = vec![Vec3::ZERO; nodes];
    positions[nodes - 1] = vector(1);
    seeds.last_mut().unwrap().positions = positions;
    let gradient = simulation.gradient(&record, &seeds).unwrap();
    let touched = record.states.iter().filter(|of| !of.contacts.is_empty()).count();
    let divided = divided(&record);
    assert!(divided >= impacts && touched > impacts, "{name}: {divided} {touched}");
    let axis = |axis: usize, by: f64| {
        let mut out = Vec3::ZERO;
        out[axis] = by;
        out
    };
    let of = |twists: &[Twist]| twists.iter().fold(0.0_f64, |max, of| max.max(of.linear.max_abs()));
    let scale = of(&gradient.velocities);
    for i in 0..3 {
        for node in [3, nodes - 1] {
            let expected =
                difference(1e-5, |by| at(&|start| start.velocities[node].linear += axis(i, by)).0);
            let found = gradient.velocities[node].linear[i];
            close(found, expected, scale, &format!("{name}: velocity {node} {i}"));
        }
        let expected =
            difference(2e-5, |by| at(&|start| start.strains[3].angular += axis(i, by)).0);
        let found = gradient.strains[3].angular[i];
        let scale = gradient.strains.iter().fold(0.0_f64, |max, of| max.max(of.angular.max_abs()));
        close(found, expected, scale, &format!("{name}: strain {i}"));
    }
}

fn soft(method: Method) -> MotionOptions {
    MotionOptions {
        damping: Damping::Time(2e-3),
        method,
        elements: 4,
        iteration_tolerance: 1e-13,
        ..MotionOptions::default()
    }
}

fn obstacle(form: Form, pose: Pose, friction: f64) -> Obstacle {
    Obstacle { name: "it".to_owned(), form, pose, friction, movable: None }
}

fn heavy(obstacle: Obstacle) -> Case {
    let loads = Loads { gravity: Some(Vec3::new(-9.81, 0.3, 0.0)), ..Loads::default() };
    Case { obstacles: vec![obstacle], loads, ..Case::with_tensions(&[0.5]) }
}

/// A rod that falls on a floor and bounces.
#[test]
fn gradients_through_several_impacts_are_those_of_differences() {
    for method in METHODS {
        for friction in [0.0, 0.3] {
            let pose = Pose { position: Vec3::X * -0.013, rotation: facing(Vec3::X) };
            let floor = obstacle(Form::HalfSpace, pose, friction);
            let options = soft(method);
            check_falling(&heavy(floor), &options, (10, 2), &format!("{method:?} {friction}"));
        }
    }
}

/// A rod that falls on a ball, between its ends.
#[test]
fn gradients_through_an_impact_of_the_backbone_are_those_of_differences() {
    for method in [Method::Accurate, Method::Robust] {
        for friction in [0.0, 0.3] {
            let pose = Pose { position: Vec3::new(-0.055, 0.0, 0.31), ..Pose::IDENTITY };
            let ball = obstacle(Form::Sphere { radius: 0.04 }, pose, friction);
            let options = soft(method);
            check_falling(&heavy(ball), &options, (10, 1), &format!("{method:?} {friction}"));
        }
    }
}

/// A robot that flies against an obstacle, and one whose base is led against it.
#[test]
fn gradients_through_an_impact_with_a_base_that_moves_are_those_of_differences() {
    for method in [Method::Accurate, Method::Robust] {
        for (is_free, friction) in [(true, 0.0), (true, 0.3), (false, 0.0), (false, 0.3)] {
            let name = format!("{method:?}, {is_free}, {friction}");
            let mut base = problem(method, Hit::Ball, friction);
            base.options.has_free_base = is_free;
            if is_free {
                // It bends less than it falls.
                for commands in &mut base.commands {
                    for i in 0..2 {
                        let tension = commands.cables[i].course().before(0.0);
                        commands.set_tension(i, 0.05 * tension);
                    }
                }
            }
            if !is_free {
                let mut led = BaseMotion::default();
                let course = |ends: [f64; 2]| Course::table(vec![0.0, 0.05], ends.to_vec());
                led.velocity[0] = course([0.0, 0.1]).unwrap();
                led.velocity[1] = course([0.0, -0.2]).unwrap();
                led.angular_velocity[0] = course([0.0, 0.5]).unwrap();
                led.angular_velocity[2] = course([0.0, 1.0]).unwrap();
                base.options.base = Some(led);
            }
            let without = Problem {
                case: Case { obstacles: Vec::new(), ..base.case.clone() },
                robot: base.robot.clone(),
                options: base.options.clone(),
                commands: base.commands.clone(),
            };
            let states = without.simulation().record(&without.commands, DT).unwrap().states;
            let obstacle = &mut base.case.obstacles[0];
            if is_free {
                // It falls on a surface.
                let gravity = base.case.loads.gravity.unwrap();
                let down = gravity * (1.0 / gravity.norm());
                let deepest = |k: usize| {
                    let depths = states[k].poses.iter().map(|of| of.position.dot(down));
                    depths.fold(f64::NEG_INFINITY, f64::max)
                };
                let rotation = facing(down * -1.0);
                let position = down * (deepest(0).max(deepest(3)) + 0.0105);
                (obstacle.form, obstacle.pose) = (Form::HalfSpace, Pose { position, rotation });
            } else {
                // A ball in the way.
                let way = states[3].tip().position - states[0].tip().position;
                let way = Vec3::new(way.x, way.y, 0.0) * (1.0 / way.x.hypot(way.y));
                let position = states[3].tip().position + way * 0.0195;
                obstacle.form = Form::Sphere { radius: 0.01 };
                obstacle.pose = Pose { position, ..Pose::IDENTITY };
            }
            let record = base.simulation().record(&base.commands, DT).unwrap();
            let parts: Vec<_> = record.states.iter().map(|of| of.diagnostics.parts).collect();
            assert!(parts[2..].iter().any(|parts| *parts > 3), "{name}: {parts:?}");
            base.check_by_commands(1e-4, &name);
        }
    }
}

/// Gradient descent by the tensions of a motion that bounces off a ball brings the tip where it shall be at the end.
#[test]
fn a_controller_is_trained_through_an_impact() {
    let mut problem = problem(Method::Accurate, Hit::Ball, 0.2);
    // Where other tensions would bring it.
    let mut other = problem.commands.clone();
    for (k, commands) in other.iter_mut().enumerate() {
        commands.set_tension(0, 4.5 - 0.2 * k as f64);
        commands.set_tension(1, 1.0);
    }
    let goal = problem.simulation().record(&other, DT).unwrap().states[STEPS].tip().position;
    let evaluate = |problem: &Problem| {
        let mut simulation = problem.simulation();
        let record = simulation.record(&problem.commands, DT).unwrap();
        let apart = record.states[STEPS].tip().position - goal;
        let mut seeds = vec![Seed::default(); STEPS + 1];
        let mut positions = vec![Vec3::ZERO; record.states[0].poses.len()];
        *positions.last_mut().unwrap() = apart * 2.0;
        seeds[STEPS].positions = positions;
        let gradient = simulation.gradient(&record, &seeds).unwrap();
        (apart.norm_squared(), gradient.cables, divided(&record))
    };
    let (first, _, impacts) = evaluate(&problem);
    assert!(impacts > 0);
    let mut cost = first;
    for _ in 0..40 {
        let (now, gradient, impacts) = evaluate(&problem);
        assert!(impacts > 0);
        cost = now;
        // As far as the cost would be zero if it were linear, and no farther than 0.3 N.
        let size = gradient.iter().flatten().map(|of| of * of).sum::<f64>();
        let longest = gradient.iter().flatten().fold(0.0_f64, |max, of| max.max(of.abs()));
        let factor = (0.5 * now / size).min(0.3 / longest);
        for (commands, row) in problem.commands.iter_mut().zip(&gradient) {
            for (i, by) in row.iter().enumerate() {
                let tension = commands.cables[i].course().before(0.0) - factor * by;
                commands.set_tension(i, tension.max(0.05));
            }
        }
    }
    assert!(cost < 0.01 * first, "{first:e} {cost:e}");
}
