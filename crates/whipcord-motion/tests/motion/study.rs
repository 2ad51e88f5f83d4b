//! Random robots with random steps of tensions, lengths and loads, at steps of 1 to 20 ms.

use core::f64::consts::{PI, TAU};

use whipcord::robot::Motor;
use whipcord::{
    Backbone, Cable, Case, Disks, Form, Loads, Material, Obstacle, Pose, Robot, Routing, Section,
    Shortening, UnitQuaternion, Vec3,
};
use whipcord_motion::{
    CableDrive, Commands, Course, Damping, LoadCourse, Method, MotionError, MotionOptions,
    Simulation,
};
use whipcord_numerics::random::SplitMix64;

const STEPS: [f64; 4] = [1e-3, 5e-3, 1e-2, 2e-2];
const DURATION: f64 = 0.4;

/// A robot in a case, how it is driven, and what acts on it.
struct Sample {
    robot: Robot,
    case: Case,
    commands: Commands,
    options: MotionOptions,
    kind: &'static str,
}

const OBSTRUCTED: Kind = Kind { is_obstructed: true, rubs: false };
const RUBBING: Kind = Kind { is_obstructed: true, rubs: true };

struct Dice(SplitMix64);

impl Dice {
    fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.0.next_part()
    }

    fn logarithmic(&mut self, from: f64, to: f64) -> f64 {
        self.between(from.ln(), to.ln()).exp()
    }

    fn one_of(&mut self, count: usize) -> usize {
        ((self.0.next_part() * count as f64) as usize).min(count - 1)
    }

    fn chance(&mut self, of: f64) -> bool {
        self.0.next_part() < of
    }

    fn direction(&mut self) -> Vec3 {
        let (z, turn) = (self.between(-1.0, 1.0), self.between(0.0, TAU));
        let r = (1.0 - z * z).sqrt();
        Vec3::new(r * turn.cos(), r * turn.sin(), z)
    }
}

/// One to three obstacles beside a straight robot of this length, whose parts are no farther than `reach` from its axis.
fn obstacles(dice: &mut Dice, length: f64, reach: f64) -> Vec<Obstacle> {
    let count = 1 + dice.one_of(3);
    let one = |dice: &mut Dice| {
        let turn = dice.between(0.0, TAU);
        let outward = Vec3::new(turn.cos(), turn.sin(), 0.0);
        let gap = dice.between(0.02, 0.4) * length;
        let size = dice.between(0.03, 0.25) * length;
        let height = dice.between(0.3, 1.1) * length;
        let rotation = UnitQuaternion::exp(dice.direction() * dice.between(0.0, PI));
        let (form, far, rotation) = match dice.one_of(4) {
            0 => {
                // The outside of the half-space is along z of its frame, which is turned towards the axis.
                let turned =
                    UnitQuaternion::exp(Vec3::new(-turn.sin(), turn.cos(), 0.0) * -(0.5 * PI));
                (Form::HalfSpace, 0.0, turned)
            }
            1 => (Form::Sphere { radius: size }, size, rotation),
            2 => (Form::Capsule { radius: 0.5 * size, length: size }, size, rotation),
            _ => (Form::Box { size: Vec3::new(1.0, 1.0, 1.0) * size }, 0.87 * size, rotation),
        };
        let position = outward * (reach + gap + far) + Vec3::Z * height;
        let friction = if dice.chance(0.5) { 0.0 } else { dice.between(0.1, 0.8) };
        let pose = Pose { position, rotation };
        Obstacle { name: "obstacle".to_owned(), form, pose, friction, movable: None }
    };
    (0..count).map(|_| one(dice)).collect()
}

/// What is special about the robots of a study.
#[derive(Clone, Copy, Default)]
struct Kind {
    /// Obstacles stand beside them.
    is_obstructed: bool,
    /// Their cables rub in their holes.
    rubs: bool,
}

fn sample(seed: u64, Kind { is_obstructed, rubs }: Kind) -> Sample {
    let mut dice = Dice(SplitMix64::new(seed));
    let length = dice.logarithmic(0.05, 0.8);
    let diameter = length / dice.between(30.0, 150.0);
    // Sag and frequency of a real robot: Young's modulus follows from the lowest frequency, 1 to 60 Hz.
    let density = dice.logarithmic(900.0, 8000.0);
    let frequency = dice.logarithmic(1.0, 60.0);
    let radius_of_gyration = 0.25 * diameter;
    let wave = TAU * frequency * length * length / (3.516 * radius_of_gyration);
    let young = (wave * wave * density).max(1e4);
    let count = 1 + dice.one_of(4);
    let radius = diameter * dice.between(1.0, 3.0);
    let cables: Vec<Cable> = (0..count)
        .map(|i| {
            let angle = TAU * i as f64 / count as f64 + dice.between(-0.2, 0.2);
            let routing = match dice.chance(0.3) {
                true => {
                    Routing::Helix { start_angle: angle, turns: dice.between(-1.0, 1.0), radius }
                }
                false => Routing::Straight { angle, radius },
            };
            Cable::new(format!("{i}"), routing)
        })
        .collect();
    let backbone = Backbone {
        section: Some(Section::circle(diameter)),
        material: Material {
            young_modulus: Some(young),
            poisson_ratio: Some(0.3),
            density: Some(density),
            ..Material::default()
        },
        ..Backbone::new(length)
    };
    let section = PI / 4.0 * diameter * diameter;
    let disks = match dice.one_of(3) {
        0 => Disks::none(length),
        _ => Disks {
            mass: dice.between(0.0, 0.1) * density * section * length,
            outer_radius: Some(1.2 * radius),
            thickness: Some(0.2 * diameter),
            ..Disks::equally_spaced(length, 3 + dice.one_of(10), radius)
        },
    };
    let mut robot = Robot::new(backbone, disks, cables).unwrap();
    let bending = young * PI / 64.0 * diameter.powi(4);
    // Up to three rad by one cable.
    let greatest = 3.0 * bending / (radius * length);
    let gravity = dice.direction() * 9.81;
    let jumps = |dice: &mut Dice, values: [f64; 3]| {
        let first = dice.between(0.0, 0.1);
        let second = dice.between(0.15, 0.3);
        let ramp = if dice.chance(0.5) { 0.0 } else { dice.between(0.0, 0.05) };
        let times = vec![first, first + ramp, second, second + ramp];
        Course::table(times, vec![values[0], values[1], values[1], values[2]]).unwrap()
    };
    let tip = dice.direction() * (dice.between(0.0, 1.0) * bending / (length * length));
    let loads = Loads { tip_force: tip, ..Loads::default() };
    let factor = jumps(&mut dice, [0.0, 1.0, 0.0]);
    let options = MotionOptions {
        method: if dice.chance(0.7) { Method::Accurate } else { Method::Robust },
        damping: Damping::Time(if dice.chance(0.3) { 0.0 } else { dice.logarithmic(1e-4, 2e-2) }),
        loads: if dice.chance(0.5) { vec![LoadCourse { loads, factor }] } else { Vec::new() },
        ..MotionOptions::default()
    };
    let carried = Loads { gravity: Some(gravity), ..Loads::default() };
    let kind = ["tensions", "lengths", "elastic lengths", "motors"][dice.one_of(4)];
    let reach = 1.5 * radius;
    if kind == "elastic lengths" {
        let cables = robot.cables().iter().map(|cable| Cable {
            axial_stiffness: Some(length * greatest / (0.1 * reach)),
            ..cable.clone()
        });
        robot =
            Robot::new(robot.backbone().clone(), robot.disks().clone(), cables.collect()).unwrap();
    }
    if kind == "motors" {
        let motors = (0..count).map(|i| Motor {
            stiffness: Some(greatest / (0.1 * reach)),
            backlash: if dice.chance(0.5) { 0.1 } else { 0.0 },
            ..Motor::spool(format!("m{i}"), [(i, radius)])
        });
        robot = robot.clone().with_motors(motors.collect()).unwrap();
    }
    let (case, commands) = match kind {
        "tensions" => {
            let drive = |_| {
                let mut value = || dice.between(0.0, greatest / count as f64 * 1.5);
                let values = [0.2 * value(), value(), value()];
                CableDrive::Tension(jumps(&mut dice, values))
            };
            let commands = Commands::new((0..count).map(drive).collect());
            (Case { loads: carried, ..Case::with_tensions(&vec![0.0; count]) }, commands)
        }
        "motors" => {
            let still = Case::with_motors(&robot, &vec![0.0; count]).unwrap();
            let mut commands = Commands::of_case(&robot, &still);
            for motor in &mut commands.motors {
                let mut value = || dice.between(-1.0, 1.5);
                let values = [0.0, value(), value()];
                *motor = Some(jumps(&mut dice, values));
            }
            (Case { loads: carried, ..still }, commands)
        }
        _ => {
            let drive = |_| {
                let mut value = || dice.between(-reach, reach);
                let values = [0.0, value(), value()];
                let mut course = jumps(&mut dice, values);
                if kind == "lengths" {
                    // A rigid cable whose length jumps is an impact: it is ramped.
                    let (first, second) = (dice.between(0.0, 0.1), dice.between(0.2, 0.3));
                    let times = vec![first, first + 0.05, second, second + 0.05];
                    let [a, b, c] = values;
                    course = Course::table(times, vec![a, b, b, c]).unwrap();
                }
                CableDrive::Shortening(course)
            };
            let commands = Commands::new((0..count).map(drive).collect());
            let still = vec![Shortening::Length(0.0); count];
            (Case { loads: carried, ..Case::with_shortenings(&still) }, commands)
        }
    };
    let mut case: Case = case;
    if is_obstructed {
        case.obstacles = obstacles(&mut dice, length, 1.2 * radius + 0.2 * diameter);
    }
    if rubs {
        let cables = robot.cables().iter().map(|cable| Cable {
            friction: Some(if dice.chance(0.2) { 0.0 } else { dice.between(0.05, 0.4) }),
            ..cable.clone()
        });
        let rubbing = Robot::new(robot.backbone().clone(), robot.disks().clone(), cables.collect());
        robot = rubbing.unwrap().with_motors(robot.motors().to_vec()).unwrap();
    }
    Sample { robot, case, commands, options, kind }
}

/// What became of samples.
#[derive(Default)]
struct Tally {
    runs: usize,
    /// Without an equilibrium to start from.
    unstarted: usize,
    failed: Vec<(u64, f64, &'static str, String)>,
    divided: usize,
    /// The greatest gain of energy by the integration, as a part of all energy that was given, and of which run.
    gain: (f64, u64, f64),
    steps: usize,
    /// The deepest that a node was in an obstacle, as a part of the length, and of which run.
    depth: (f64, u64, f64),
    /// Steps that ended in contact.
    touching: usize,
    /// Parts of steps in which contacts slid without friction.
    frictionless: usize,
}

fn run(seed: u64, kind: Kind, tally: &mut Tally) {
    let sample = sample(seed, kind);
    for dt in STEPS {
        let Sample { robot, case, commands, options, kind } = &sample;
        tally.runs += 1;
        let mut simulation = match Simulation::with_commands(robot, case, commands, options.clone())
        {
            Ok(simulation) => simulation,
            Err(MotionError::NoEquilibrium(_) | MotionError::Unbalanced { .. }) => {
                tally.unstarted += 1;
                return;
            }
            Err(error) => {
                tally.failed.push((seed, dt, kind, error.to_string()));
                return;
            }
        };
        let (mut given, mut before) = (0.0, simulation.state().energy);
        let mut parts = 0;
        for _ in 0..(DURATION / dt).round() as usize {
            match simulation.step(commands, dt) {
                Ok(state) => {
                    tally.steps += 1;
                    parts += state.diagnostics.parts - 1;
                    tally.frictionless += state.diagnostics.frictionless_parts;
                    let energy = state.energy;
                    given +=
                        (energy.cables - before.cables).abs() + (energy.loads - before.loads).abs();
                    before = energy;
                    tally.touching += usize::from(!state.contacts.is_empty());
                    let length = robot.backbone().length;
                    for obstacle in &case.obstacles {
                        for pose in &state.poses[1..] {
                            let radius = robot.backbone().outer_radius_at(robot.disks(), 0.0);
                            let gap = obstacle.surface(pose.position).distance - radius;
                            if -gap / length > tally.depth.0 {
                                tally.depth = (-gap / length, seed, dt);
                            }
                        }
                    }
                    assert!(energy.total().is_finite());
                }
                Err(error) => {
                    tally.failed.push((seed, dt, kind, error.to_string()));
                    break;
                }
            }
        }
        tally.divided += usize::from(parts > 8);
        let gain = before.defect() / given.max(1e-12);
        if gain > tally.gain.0 {
            tally.gain = (gain, seed, dt);
        }
    }
}

#[allow(clippy::print_stdout, reason = "the study is read")]
fn report(count: u64, first: u64, kind: Kind) -> Tally {
    let mut tally = Tally::default();
    for seed in first..first + count {
        run(seed, kind, &mut tally);
    }
    println!(
        "{} runs, {} steps: {} robots without equilibrium, {} failed, {} with more than 8 divided steps; greatest gain {:.1e} of the work (robot {}, {} s)",
        tally.runs,
        tally.steps,
        tally.unstarted,
        tally.failed.len(),
        tally.divided,
        tally.gain.0,
        tally.gain.1,
        tally.gain.2
    );
    println!(
        "{} steps in contact, {} parts without friction; deepest overlap {:.1e} of the length (robot {}, {} s)",
        tally.touching, tally.frictionless, tally.depth.0, tally.depth.1, tally.depth.2
    );
    for (seed, dt, kind, error) in tally.failed.iter().take(30) {
        println!("robot {seed}, {dt} s, {kind}: {error}");
    }
    tally
}

#[test]
fn random_robots_move_at_every_step() {
    let tally = report(24, 1, Kind::default());
    assert!(tally.failed.is_empty());
    assert!(tally.gain.0 < 0.3);
}

/// `COUNT=1000 cargo test --release -p whipcord-motion --test motion -- --ignored --nocapture study_of_random_robots`
#[test]
#[ignore = "takes minutes"]
fn study_of_random_robots() {
    let count = std::env::var("COUNT").ok().and_then(|count| count.parse().ok()).unwrap_or(1000);
    report(count, 1000, Kind::default());
}

#[test]
fn random_robots_move_among_obstacles() {
    let tally = report(16, 1, OBSTRUCTED);
    assert!(tally.failed.is_empty());
    assert!(tally.touching > 100 && tally.depth.0 < 1e-3 && tally.gain.0 < 0.3);
}

/// Robots of the study whose contacts have no answer with friction in some part of a step: it is taken without friction there, and no step fails.
#[test]
fn jammed_contacts_slide_for_a_moment() {
    let mut tally = Tally::default();
    for seed in [1246, 1666, 1749] {
        run(seed, OBSTRUCTED, &mut tally);
    }
    println!("{} parts without friction", tally.frictionless);
    assert!(tally.failed.is_empty(), "{:?}", tally.failed);
}

/// `COUNT=1000 cargo test --release -p whipcord-motion --test motion -- --ignored --nocapture study_among_obstacles`
#[test]
#[ignore = "takes minutes"]
fn study_among_obstacles() {
    let count = std::env::var("COUNT").ok().and_then(|count| count.parse().ok()).unwrap_or(1000);
    report(count, 1000, OBSTRUCTED);
}

#[test]
fn random_robots_with_friction_move_among_obstacles() {
    let tally = report(10, 1, RUBBING);
    assert!(tally.failed.is_empty());
    assert!(tally.touching > 60 && tally.depth.0 < 1e-3 && tally.gain.0 < 0.3);
}

/// `COUNT=1000 cargo test --release -p whipcord-motion --test motion -- --ignored --nocapture study_with_friction`
#[test]
#[ignore = "takes minutes"]
fn study_with_friction() {
    let count = std::env::var("COUNT").ok().and_then(|count| count.parse().ok()).unwrap_or(1000);
    report(count, 1000, RUBBING);
}
