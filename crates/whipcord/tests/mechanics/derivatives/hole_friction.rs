//! Answers with friction at the holes: their derivatives against differences of all their steps.

use super::*;
use crate::common::{helix, paper_backbone, straight};
use whipcord::derivatives::Cotangent;
use whipcord::{Actuation, Disks, Loads, ModelKind, Motor, Wrench};

/// A case with several steps, and its robot.
#[derive(Clone)]
pub(super) struct Sliding {
    pub name: &'static str,
    pub robot: Robot,
    pub case: Case,
}

pub(super) fn rubbing(routing: Routing, mu: f64) -> Cable {
    Cable { friction: Some(mu), ..Cable::new(format!("{routing:?}"), routing) }
}

pub(super) fn robot(cables: Vec<Cable>) -> Robot {
    Robot::new(paper_backbone(), Disks::equally_spaced(0.18, 6, 0.008), cables).unwrap()
}

pub(super) fn tip_loads() -> Loads {
    Loads {
        tip_force: Vec3::new(0.05, -0.08, 0.02),
        tip_moment: Vec3::new(1e-3, 2e-3, 1e-3),
        ..Loads::default()
    }
}

/// Tensions, and lengths in mm where they are negative.
pub(super) fn commands(of: &[f64]) -> Vec<CableCommand> {
    let command = |&x: &f64| {
        if x >= 0.0 {
            CableCommand { tension: Some(x), shortening: None }
        } else {
            CableCommand { tension: None, shortening: Some(Shortening::Length(-1e-3 * x)) }
        }
    };
    of.iter().map(command).collect()
}

pub(super) fn in_steps(steps: &[&[f64]], loads: &Loads) -> Case {
    let steps: Vec<_> = steps.iter().map(|step| commands(step)).collect();
    let (last, before) = steps.split_last().unwrap();
    Case {
        commands: last.clone(),
        before: before.to_vec(),
        loads: loads.clone(),
        ..Case::default()
    }
}

/// Cases in which no hole comes to rest within a step.
fn whole_steps() -> Vec<Sliding> {
    let (none, loads) = (Loads::default(), tip_loads());
    let one = || robot(vec![rubbing(straight(20.0), 0.2)]);
    let pair = || robot(vec![rubbing(straight(0.0), 0.15), rubbing(straight(100.0), 0.3)]);
    let elastic = || {
        robot(vec![
            Cable { axial_stiffness: Some(800.0), ..rubbing(straight(20.0), 0.25) },
            Cable::new("smooth", straight(140.0)),
            rubbing(helix(0.0, 0.2), 0.15),
        ])
    };
    let of = |name, robot, steps: &[&[f64]], loads: &Loads| Sliding {
        name,
        robot,
        case: in_steps(steps, loads),
    };
    vec![
        of("pulled by two", pair(), &[&[2.0, 1.0]], &loads),
        of("pulled", one(), &[&[3.0]], &none),
        of("pulled under load", one(), &[&[3.0]], &loads),
        of("shortened", one(), &[&[-5.0]], &loads),
        of("released a little", one(), &[&[3.0], &[2.7]], &loads),
        of("released", one(), &[&[3.0], &[1.5]], &none),
        of("paid out", one(), &[&[-5.0], &[-4.2]], &loads),
        of("three", elastic(), &[&[2.0, 1.0, 1.5]], &loads),
        of("three, one shortened", elastic(), &[&[-3.0, 1.0, 1.0]], &loads),
        of("three released", elastic(), &[&[2.0, 1.0, 1.5], &[1.2, 0.6, 0.9]], &loads),
    ]
}

pub(super) fn check(
    tested: Tested,
    Sliding { name, robot, case }: &Sliding,
    tolerance: f64,
) -> String {
    let mut failures = String::new();
    let (solution, derivatives) = differentiated(tested, robot, case, &[]);
    let near = |case: &Case| solve_near(tested, robot, case, &solution);
    for cable in 0..robot.cables().len() {
        let change = derivatives.command(cable);
        let command = case.commands[cable];
        let size = command.tension.unwrap_or(1e-3);
        let off = |step: f64| {
            let difference = differentiate(
                |by| {
                    let mut case = case.clone();
                    case.commands[cable] = moved(command, by);
                    near(&case)
                },
                step,
            );
            off_above(1e-9, &change, &difference.unwrap(), robot)
        };
        if let Err(all) = off_with_all([1e-3, 4e-3, 1e-4].map(|h| h * size), tolerance, off) {
            failures += &format!("command {cable}: {all:?}\n");
        }
    }
    check_parameters_to(tested, tolerance, robot, case, &mut failures);
    if failures.is_empty() { failures } else { format!("{:?}, {name}\n{failures}", solution.model) }
}

/// The same sum of all that changes, once by every change and once by the way back.
pub(super) fn both_ways(tested: Tested, Sliding { name, robot, case }: &Sliding) {
    let list: Vec<Parameter> =
        parameters(tested, robot, case).into_iter().map(|(parameter, _)| parameter).collect();
    let (_, derivatives) = differentiated(tested, robot, case, &list);
    let cables = robot.cables().len();
    let numbers = |count: usize, first: f64| -> Vec<f64> {
        (0..count).map(|i| (first + 0.7 * i as f64).sin()).collect()
    };
    let worth = Twist { linear: Vec3::new(3.0, -2.0, 1.0), angular: Vec3::new(0.2, 0.5, -0.4) };
    let base = Wrench { force: Vec3::new(0.3, 0.1, 0.2), moment: Vec3::new(2.0, -1.0, 4.0) };
    let cotangent = Cotangent {
        places: vec![(Place::Tip, worth), (Place::Station(2), worth)],
        lengths: numbers(cables, 1.0),
        tensions: numbers(cables, 2.0),
        base_wrench: base,
    };
    let sum = |change: &Change| -> f64 {
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let at = |place: Place| {
            let twist = change.twist(place);
            twist.linear.dot(worth.linear) + twist.angular.dot(worth.angular)
        };
        at(Place::Tip)
            + at(Place::Station(2))
            + dot(change.lengths(), &cotangent.lengths)
            + dot(change.tensions(), &cotangent.tensions)
            + change.base_wrench().force.dot(base.force)
            + change.base_wrench().moment.dot(base.moment)
    };
    for hold in [Hold::Commands, Hold::Tensions, Hold::Lengths] {
        let gradient = derivatives.pull_back(&cotangent, hold);
        let compare = |what: String, back: f64, change: Change| {
            let forward = sum(&change);
            let size = forward.abs().max(1e-9);
            let off = (back - forward).abs() / size;
            assert!(off < 1e-8, "{name}, {hold:?}, {what}: {back:e} {forward:e}");
        };
        for cable in 0..cables {
            let (back, change) = (gradient.commands[cable], derivatives.command(cable));
            compare(format!("command {cable}"), back, change);
        }
        for (i, parameter) in list.iter().enumerate() {
            let (back, change) = (gradient.parameters[i], derivatives.parameter(i, hold));
            compare(parameter.to_string(), back, change);
        }
        let wrench = gradient.wrench(Place::Station(2));
        let back = [wrench.force, wrench.moment].map(<[f64; 3]>::from).concat();
        for (component, &back) in back.iter().enumerate() {
            let change = derivatives.wrench(Place::Station(2), component, hold);
            compare(format!("wrench {component}"), back, change);
        }
    }
}

/// Every step is changed by as much.
pub(super) fn offsets(
    tested: Tested,
    Sliding { name, robot, case }: &Sliding,
    tolerance: f64,
) -> String {
    let mut failures = String::new();
    let (solution, derivatives) = differentiated(tested, robot, case, &[]);
    for cable in 0..robot.cables().len() {
        let change = derivatives.offset(cable);
        let off = |step: f64| {
            let difference = differentiate(
                |by| {
                    let mut case = case.clone();
                    for commands in case.before.iter_mut().chain([&mut case.commands]) {
                        commands[cable] = moved(commands[cable], by);
                    }
                    solve_near(tested, robot, &case, &solution)
                },
                step,
            );
            off_above(1e-9, &change, &difference.unwrap(), robot)
        };
        let size = case.commands[cable].tension.unwrap_or(1e-3);
        if let Err(all) = off_with_all([1e-3, 4e-3, 1e-4].map(|h| h * size), tolerance, off) {
            failures += &format!("{:?}, {name}: offset {cable}: {all:?}\n", solution.model);
        }
    }
    failures
}

pub(super) fn moved(command: CableCommand, by: f64) -> CableCommand {
    match (command.tension, command.shortening) {
        (Some(tension), _) => CableCommand { tension: Some(tension + by), shortening: None },
        (_, Some(Shortening::Length(length))) => {
            let shortening = Some(Shortening::Length(length + by));
            CableCommand { tension: None, shortening }
        }
        _ => unreachable!(),
    }
}

fn whole(tested: Tested, is_asked: impl Fn(&Sliding) -> bool) {
    let mut failures = String::new();
    for sliding in whole_steps().into_iter().filter(is_asked) {
        let tolerance = match (tested, sliding.name) {
            // What a twist at rest does to a straight cable without load is off by 2e-6, for a reason that is not known.
            (Tested::Continuous, "pulled") => 5e-6,
            _ => TOLERANCE,
        };
        failures += &check(tested, &sliding, tolerance);
        failures += &offsets(tested, &sliding, tolerance);
        both_ways(tested, &sliding);
    }
    assert!(failures.is_empty(), "{failures}");
}

fn steps_that_are_whole(tested: Tested) {
    // Without load the rod takes so many steps that its differences take minutes.
    whole(tested, |sliding| tested != Tested::Continuous || !sliding.case.loads.is_none());
}

fn steps_without_load(tested: Tested) {
    whole(tested, |sliding| sliding.case.loads.is_none());
}

/// Antagonists that rub, on one soft drive with pretension, that turns there and back.
fn driven() -> Vec<Sliding> {
    let motor = Motor {
        stiffness: Some(4e3),
        free_length: 0.3,
        pretension: 6.0,
        backlash: 0.05,
        offset: 0.1,
        drive: whipcord::Drive::Spool { gear_ratio: 2.0 },
        ..Motor::spool("bend", [(0, 0.01), (1, -0.0101)])
    };
    let elastic = |angle| Cable { axial_stiffness: Some(5e3), ..rubbing(straight(angle), 0.15) };
    let robot = robot(vec![elastic(0.0), elastic(180.0)]).with_motors(vec![motor]).unwrap();
    let of = |name, angles: &[f64], loads: &Loads| {
        let mut case = Case {
            commands: vec![Default::default(); 2],
            before: vec![vec![Default::default(); 2]; angles.len() - 1],
            motors: angles.iter().map(|&angle| vec![Some(angle)]).collect(),
            loads: loads.clone(),
            ..Case::default()
        };
        case.drive(&robot).unwrap();
        Sliding { name, robot: robot.clone(), case }
    };
    let loads = tip_loads();
    vec![
        of("turned", &[1.2], &loads),
        of("turned back", &[1.5, 1.2], &loads),
        of("there and back", &[1.5, 0.2], &loads),
    ]
}

fn soft_drives(tested: Tested) {
    let numbers = [
        "motors[0].stiffness",
        "motors[0].free_length",
        "motors[0].pretension",
        "motors[0].backlash",
        "motors[0].angle_offset",
        "motors[0].gear_ratio",
        "motors[0].spool_radius",
        "motors[0].spool_radius[1]",
        "cables[0].axial_stiffness",
        "cables[1].friction",
        "cables[0].routing.radius",
    ]
    .map(|path| path.parse::<Parameter>().unwrap());
    let mut failures = String::new();
    for Sliding { name, robot, case } in driven() {
        let (solution, derivatives) = differentiated(tested, &robot, &case, &numbers);
        for (i, parameter) in numbers.iter().enumerate() {
            let change = derivatives.parameter(i, Hold::Commands);
            let size = parameter.value(&robot, &case).unwrap();
            let off = |step: f64| {
                let difference = differentiate(
                    |by| {
                        let (robot, case) = parameter.moved(&robot, &case, by)?;
                        solve_near(tested, &robot, &case, &solution)
                    },
                    step * size,
                );
                off_above(1e-9, &change, &difference.unwrap(), &robot)
            };
            // Turned back a little, some holes come to rest within the step.
            let tolerance = if name == "turned back" { 5e-3 } else { 1e-6 };
            if let Err(all) = off_with_all([1e-3, 1e-4, 4e-3], tolerance, off) {
                failures += &format!("{:?}, {name}: {parameter}: {all:?}\n", solution.model);
            }
        }
    }
    assert!(failures.is_empty(), "{failures}");
}

/// Some cables and steps of random commands. Where no hole comes to rest within a step the derivatives are exact; elsewhere so good as
/// the substeps are.
fn random_steps(tested: Tested, count: usize) {
    let mut state = 7_u64;
    let mut random = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut all = Vec::new();
    for number in 0..count {
        let cables = 1 + (3.0 * random()) as usize;
        let steps = 1 + (3.0 * random()) as usize;
        let by_length = random() < 0.3;
        let robot = robot(
            (0..cables)
                .map(|_| {
                    let routing = if random() < 0.7 {
                        straight(360.0 * random())
                    } else {
                        helix(360.0 * random(), 0.3 * random())
                    };
                    rubbing(routing, 0.05 + 0.3 * random())
                })
                .collect(),
        );
        let steps: Vec<Vec<f64>> = (0..steps)
            .map(|_| {
                (0..cables)
                    .map(|c| {
                        if by_length && c == 0 {
                            -1.0 - 4.0 * random()
                        } else {
                            0.2 + 2.5 * random()
                        }
                    })
                    .collect()
            })
            .collect();
        let loads = if random() < 0.5 { tip_loads() } else { Loads::default() };
        let case = in_steps(&steps.iter().map(|s| &s[..]).collect::<Vec<_>>(), &loads);
        let list = [
            Parameter::YoungModulus,
            Parameter::TipForce { axis: 0 },
            Parameter::Friction { cable: None },
            Parameter::Radius { cable: 0 },
        ];
        let options = Options { accuracy: Accuracy::Steps(8), ..options(tested, &case) };
        let solved = tested.solve_with_derivatives(&robot, &case, &options, &list);
        let (solution, derivatives) = match solved {
            Ok(found) => found,
            Err(error) => {
                println!("{number}: {error}");
                continue;
            }
        };
        let compare = |change: &Change,
                       what: String,
                       step: f64,
                       at: &dyn Fn(f64) -> Result<Solution, SolveError>| {
            let off = [1.0, 0.1, 4.0].map(|f| {
                differentiate(at, f * step)
                    .map_or(f64::NAN, |d| off_above(1e-9, change, &d, &robot))
            });
            let least = off.into_iter().fold(f64::INFINITY, f64::min);
            if least > 1e-6 {
                println!(
                    "{number} {:?} {what}: {off:?} {}",
                    solution.model,
                    derivatives.is_hole_about_to_change()
                );
            }
            least
        };
        for cable in 0..cables {
            let size = case.commands[cable].tension.unwrap_or(1e-3) * 1e-3;
            let solve = |case: &Case| tested.solve(&robot, case, &options, None);
            let of_last = |by: f64| {
                let mut case = case.clone();
                case.commands[cable] = moved(case.commands[cable], by);
                solve(&case)
            };
            all.push(compare(
                &derivatives.command(cable),
                format!("command {cable}"),
                size,
                &of_last,
            ));
            let of_all = |by: f64| {
                let mut case = case.clone();
                for commands in case.before.iter_mut().chain([&mut case.commands]) {
                    commands[cable] = moved(commands[cable], by);
                }
                solve(&case)
            };
            all.push(compare(&derivatives.offset(cable), format!("offset {cable}"), size, &of_all));
        }
        for (i, parameter) in list.iter().enumerate() {
            let size = match parameter {
                Parameter::TipForce { .. } => 1e-4,
                _ => 1e-3 * parameter.value(&robot, &case).unwrap_or(0.1),
            };
            let at = |by: f64| {
                let (robot, case) = parameter.moved(&robot, &case, by)?;
                tested.solve(&robot, &case, &options, None)
            };
            all.push(compare(
                &derivatives.parameter(i, Hold::Commands),
                format!("{parameter}"),
                size,
                &at,
            ));
        }
        println!(
            "{number}: {cables} cables, {steps:?}, {}",
            if by_length { "length" } else { "tension" }
        );
    }
    all.sort_by(f64::total_cmp);
    let at = |part: f64| all[((all.len() - 1) as f64 * part) as usize];
    let at = [0.5, 0.7, 0.8, 0.9, 0.95, 1.0].map(at);
    println!("{} derivatives are off by {at:?}", all.len());
    assert!(at[0] < 1e-8 && at[2] < 2e-4 && at[4] < 2e-3, "{at:?}");
}

/// Holes of three cables come to rest at many places within a step. Its division into substeps stays as it is while a command changes a little: the
/// derivatives are those of the answer, but for where the division changes, or a hole begins to slide at the end of the step.
#[test]
fn derivatives_are_exact_where_holes_come_to_rest_within_a_step() {
    const COUNT: usize = 60;
    let cables = vec![
        rubbing(helix(0.0, 0.2), 0.2),
        rubbing(straight(120.0), 0.25),
        rubbing(straight(240.0), 0.1),
    ];
    let robot = robot(cables);
    let model =
        Model::new(ModelKind::PiecewiseConstantCurvature, Stations::Disks, Actuation::Natural);
    let at = |tension: f64| {
        let case = in_steps(&[&[2.0, 0.5, 1.0], &[0.5, tension, 1.5]], &tip_loads());
        let mut prepared = model.prepare(&robot, &case.loads).unwrap();
        let mut found = None;
        prepared
            .solve_steps_with_derivatives(
                &case,
                &[],
                |_| true,
                |solution, of| {
                    let change = of.unwrap().command(1).twist(Place::Tip).linear;
                    found = Some((solution.disks.tip().position, change));
                },
            )
            .unwrap();
        found.unwrap()
    };
    let off = |k: usize| {
        let (tension, by) = (1.54 + 5e-4 * k as f64, 1e-5);
        let [before, after] = [tension - by, tension + by].map(|tension| at(tension).0);
        let difference = (after - before) * (0.5 / by);
        (at(tension).1 - difference).norm() / difference.norm()
    };
    let mut off: Vec<f64> = (0..COUNT).map(off).collect();
    off.sort_by(f64::total_cmp);
    let [median, most] = [COUNT / 2, 4 * COUNT / 5].map(|n| off[n]);
    assert!(median < 1e-6 && most < 1e-4, "{median:e} {most:e}");
}

/// Three drives lead the robot about. In some of the steps holes come to rest where they would slide as well: the state there is that of the
/// cases before, and the way goes on with its derivatives.
#[test]
fn a_long_path_keeps_its_derivatives() {
    const STEPS: usize = 40;
    let cables = [0.0, 120.0, 240.0].map(|angle| rubbing(straight(angle), 0.15));
    let motors = (0..3).map(|i| Motor {
        stiffness: Some(5e3),
        backlash: 0.05,
        pretension: 10.0,
        offset: [0.02, -0.03, 0.0][i],
        ..Motor::spool(format!("m{i}"), [(i, 0.01)])
    });
    let disks = Disks::equally_spaced(0.18, 10, 0.009);
    let robot = Robot::new(paper_backbone(), disks, cables.to_vec()).unwrap();
    let robot = robot.with_motors(motors.collect()).unwrap();
    let mut state = 12345_u64;
    let mut random = move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let (mut way, mut size) = (0.0_f64, 0.3_f64);
    let third = core::f64::consts::TAU / 3.0;
    let mut row = |_| {
        way += 0.6 * (random() - 0.3);
        size = (size + 0.12 * (random() - 0.5)).clamp(0.1, 0.5);
        (0..3).map(|i| Some(size * (way - third * f64::from(i)).cos())).collect()
    };
    let none = vec![CableCommand::default(); 3];
    let mut case = Case {
        commands: none.clone(),
        before: vec![none; STEPS - 1],
        motors: (0..STEPS).map(&mut row).collect(),
        ..Case::default()
    };
    case.drive(&robot).unwrap();
    let parameters: Vec<Parameter> =
        ["cables[0].friction", "motors[1].stiffness", "motors[0].angle_offset"]
            .map(|path| path.parse().unwrap())
            .to_vec();
    let model =
        Model::new(ModelKind::PiecewiseConstantCurvature, Stations::Disks, Actuation::Natural);
    let tips = |robot: &Robot, case: &Case| -> Vec<Vec3> {
        let mut tips = Vec::new();
        let mut prepared = model.prepare(robot, &case.loads).unwrap();
        prepared.solve_steps(case, |of| tips.push(of.disks.tip().position)).unwrap();
        tips
    };
    let mut changes = Vec::new();
    let mut prepared = model.prepare(&robot, &case.loads).unwrap();
    prepared
        .solve_steps_with_derivatives(
            &case,
            &parameters,
            |_| true,
            |_, of| changes.push(of.unwrap()),
        )
        .unwrap();
    let mut off = Vec::new();
    for (i, parameter) in parameters.iter().enumerate() {
        let size = 1e-4 * parameter.value(&robot, &case).unwrap().abs();
        let at = |by: f64| {
            let (robot, case) = parameter.moved(&robot, &case, by).unwrap();
            tips(&robot, &case)
        };
        let (before, after) = (at(-size), at(size));
        for (step, of) in changes.iter().enumerate() {
            let exact = of.parameter(i, Hold::Commands).twist(Place::Tip).linear;
            let difference = (after[step] - before[step]) / (2.0 * size);
            off.push((exact - difference).norm() / difference.norm().max(1e-9));
        }
    }
    off.sort_by(f64::total_cmp);
    // Where holes come to rest within a step derivatives and differences are as good as the substeps.
    let at = [0.5, 0.9, 1.0].map(|part: f64| off[((off.len() - 1) as f64 * part) as usize]);
    assert!(at[0] < 1e-2 && at[1] < 0.1, "{at:?}");
}

/// Tests of each model, under its name.
macro_rules! of_models {
    ($($model:ident: $tested:ident),*) => {
        $(mod $model {
            #[test]
            fn steps_that_are_whole() {
                super::steps_that_are_whole(super::Tested::$tested);
            }

            #[test]
            fn soft_drives() {
                super::soft_drives(super::Tested::$tested);
            }

            #[test]
            fn random_steps() {
                let tested = super::Tested::$tested;
                super::random_steps(tested, if tested == super::Tested::Continuous { 3 } else { 7 });
            }

            #[test]
            #[ignore = "of the rod some minutes"]
            fn steps_without_load() {
                super::steps_without_load(super::Tested::$tested);
            }

            #[test]
            #[ignore = "a study: minutes"]
            fn many_random_steps() {
                super::random_steps(super::Tested::$tested, 60);
            }
        })*
    };
}

of_models!(continuous_cables: Continuous, from_hole_to_hole: Disks, arcs: Arcs, rigid_bodies: RigidBodies, four_bar_sections: FourBar);
