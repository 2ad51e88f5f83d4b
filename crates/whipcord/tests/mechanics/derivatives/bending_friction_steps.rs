//! Friction against bending, alone and beside friction of cables: derivatives through all steps against differences of these, at answers at which
//! some joints slide and others stick.

use super::friction_in_contact::{of, off_differences};
use super::hole_friction::{Sliding, both_ways, check, in_steps, moved, robot, rubbing, tip_loads};
use super::*;
use crate::common::{helix, straight};
use crate::contact::{sphere, wall};
use whipcord::robot::BendingFriction;
use whipcord::{Backbone, Loads, Motor, Obstacle};

for_models_of_sections!(
    steps_there_and_back,
    steps_that_rub,
    soft_drives,
    steps_at_obstacles,
    steps_that_rub_at_obstacles,
    steps_one_by_one,
    a_command_that_is_repeated
);

fn held(robot: &Robot, yield_moment: f64, yield_stiffness: Option<[f64; 2]>) -> Robot {
    let limit =
        BendingFriction { yield_moment: [yield_moment, 1.3 * yield_moment], yield_stiffness };
    let backbone = Backbone { bending_friction: Some(limit), ..robot.backbone().clone() };
    robot.with_parts(backbone, robot.disks().clone(), robot.cables().to_vec()).unwrap()
}

/// At the disks about x and y: how many slid in the last step, and how many stuck.
fn slid_and_stuck(tested: Tested, robot: &Robot, case: &Case) -> [usize; 2] {
    let options = Options { stations: Stations::Disks, ..options(tested, case) };
    let all = tested.prepare(robot, case, &options).unwrap().solve_all(case).unwrap();
    let [.., before, last] = &all[..] else { panic!("one step") };
    let pairs = before.plastic_curvature.iter().zip(&last.plastic_curvature);
    let of = |(before, last): (&[f64; 2], &[f64; 2])| [0, 1].map(|axis| before[axis] != last[axis]);
    let slid = pairs.flat_map(of).filter(|slid| *slid).count();
    [slid, 2 * last.plastic_curvature.len() - slid]
}

fn check_mixed(tested: Tested, sliding: &Sliding, tolerance: f64) -> String {
    let Sliding { name, robot, case } = sliding;
    let counts = slid_and_stuck(tested, robot, case);
    assert!(counts.iter().all(|&count| count > 0), "{name}: {counts:?}");
    both_ways(tested, sliding);
    check(tested, sliding, tolerance)
}

fn smooth() -> Vec<Cable> {
    vec![
        Cable::new("a", straight(20.0)),
        Cable::new("b", helix(140.0, 0.3)),
        Cable { axial_stiffness: Some(2e3), ..Cable::new("c", straight(260.0)) },
    ]
}

fn rough() -> Vec<Cable> {
    vec![
        rubbing(straight(20.0), 0.15),
        Cable::new("b", helix(140.0, 0.3)),
        rubbing(straight(260.0), 0.24),
    ]
}

/// Steps of tensions, and of lengths in mm where they are negative, under these loads, with the yield moment about x and the friction of the
/// joints with a stiffness of its own.
type Way = (&'static str, &'static [&'static [f64]], bool, f64, Option<[f64; 2]>);

/// Pulled, and let go or pulled elsewhere.
const SMOOTH_WAYS: [Way; 6] = [
    ("by tensions", THERE_AND_BACK, false, 1e-3, None),
    ("by tensions under loads", THERE_AND_BACK, true, 1e-3, None),
    ("by tensions, given", THERE_AND_BACK, true, 1e-3, GIVEN),
    ("by lengths, given", &[&[-5.0, -0.5, -0.2], &[-3.2, -0.9, -0.5]], false, 6.1e-3, GIVEN),
    ("by both", &[&[-4.0, 0.5, 0.4], &[-2.5, 1.2, 0.8]], false, 2e-3, None),
    ("by both under loads", &[&[-4.0, 0.5, 0.4], &[-2.5, 1.2, 0.8]], true, 6.1e-3, None),
];
const THERE_AND_BACK: &[&[f64]] = &[&[2.5, 0.5, 0.3], &[0.9, 0.5, 0.3], &[1.6, 0.8, 0.3]];
const GIVEN: Option<[f64; 2]> = Some([0.03, 0.025]);

/// Of cables that rub: ways on which no hole comes to rest in a part of a step in which joints begin to slide. There answers and derivatives are
/// as good as the substeps are.
const ROUGH_WAYS: [Way; 4] = [
    ("let go", &[&[-3.0, 1.0, 1.0], &[-2.9, 0.97, 0.97]], false, 1e-3, None),
    ("let go under loads", &[&[-3.0, 1.0, 1.0], &[-2.9, 0.97, 0.97]], true, 1e-3, None),
    ("let go, held more", &[&[-3.0, 1.0, 1.0], &[-2.9, 0.97, 0.97]], true, 5e-3, None),
    ("pulled on under loads", &[&[-3.0, 1.0, 1.0], &[-3.6, 1.2, 1.2]], true, 5e-3, None),
];

fn of_ways(ways: &[Way], cables: &dyn Fn() -> Vec<Cable>) -> Vec<Sliding> {
    let of = |&(name, steps, is_loaded, yield_moment, given): &Way| {
        let loads = if is_loaded { tip_loads() } else { Loads::default() };
        let robot = held(&robot(cables()), yield_moment, given);
        Sliding { name, robot, case: in_steps(steps, &loads) }
    };
    ways.iter().map(of).collect()
}

fn steps_there_and_back(tested: Tested) {
    let all = of_ways(&SMOOTH_WAYS, &smooth);
    let failures: String = all.iter().map(|of| check_mixed(tested, of, TOLERANCE)).collect();
    assert!(failures.is_empty(), "{failures}");
}

fn steps_that_rub(tested: Tested) {
    let all = of_ways(&ROUGH_WAYS, &rough);
    let failures: String = all.iter().map(|of| check_mixed(tested, of, TOLERANCE)).collect();
    assert!(failures.is_empty(), "{failures}");
}

/// Antagonists on one drive with pretension and backlash.
fn soft_drives(tested: Tested) {
    let motor = Motor {
        stiffness: Some(4e3),
        free_length: 0.3,
        pretension: 3.0,
        backlash: 0.05,
        drive: whipcord::Drive::Spool { gear_ratio: 2.0 },
        ..Motor::spool("bend", [(0, 0.01), (1, -0.0101)])
    };
    let numbers = [
        "motors[0].stiffness",
        "motors[0].pretension",
        "motors[0].backlash",
        "motors[0].gear_ratio",
        "motors[0].spool_radius",
        "backbone.yield_moment",
        "backbone.young_modulus",
    ]
    .map(|path| path.parse::<Parameter>().unwrap());
    let mut failures = String::new();
    for mu in [0.0, 0.15] {
        let elastic = |angle| Cable { axial_stiffness: Some(5e3), ..rubbing(straight(angle), mu) };
        let robot = robot(vec![elastic(0.0), elastic(180.0)]).with_motors(vec![motor.clone()]);
        let robot = held(&robot.unwrap(), 3e-3, None);
        let mut case = Case {
            commands: vec![Default::default(); 2],
            before: vec![vec![Default::default(); 2]; 2],
            motors: [1.5, 0.9, 1.1].map(|angle| vec![Some(angle)]).to_vec(),
            loads: tip_loads(),
            ..Case::default()
        };
        case.drive(&robot).unwrap();
        let (solution, derivatives) = differentiated(tested, &robot, &case, &numbers);
        for (i, parameter) in numbers.iter().enumerate() {
            let change = derivatives.parameter(i, Hold::Commands);
            let size = parameter.value(&robot, &case).unwrap();
            let off = |step: f64| {
                let solve = |by: f64| {
                    let (robot, case) = parameter.moved(&robot, &case, by)?;
                    solve_near(tested, &robot, &case, &solution)
                };
                off_above(1e-9, &change, &differentiate(solve, step * size).unwrap(), &robot)
            };
            if let Err(all) = off_with_all([1e-3, 1e-4, 4e-3], 1e-6, off) {
                failures += &format!("{:?}, {mu}: {parameter}: {all:?}\n", solution.model);
            }
        }
    }
    assert!(failures.is_empty(), "{failures}");
}

const AT_OBSTACLES: [(Parameter, f64); 7] = [
    (Parameter::YieldMoment { axis: None }, 1e-5),
    (Parameter::YieldMoment { axis: Some(1) }, 1e-5),
    (Parameter::YoungModulus, 1e-3 * 1.1e9),
    (Parameter::HoleRadius, 1e-3 * 8e-3),
    (Parameter::RestCurvature { axis: 1 }, 1e-2),
    (Parameter::TipForce { axis: 0 }, 1e-4),
    (Parameter::TipForce { axis: 1 }, 1e-4),
];

fn check_at_obstacles(tested: Tested, sliding: &Sliding, tolerance: f64) -> String {
    let Sliding { name, robot, case } = sliding;
    let list = AT_OBSTACLES.map(|(parameter, _)| parameter);
    let (solution, derivatives) = differentiated(tested, robot, case, &list);
    assert!(!solution.contacts.is_empty(), "{:?}, {name}: nothing touches", solution.model);
    assert!(derivatives.one_sided().names().count() == 0, "{:?}, {name}", solution.model);
    let answer = (&solution, &derivatives);
    let failures = off_differences(tested, sliding, answer, &AT_OBSTACLES, tolerance);
    if failures.is_empty() { failures } else { format!("{:?}, {name}\n{failures}", solution.model) }
}

fn among(cables: Vec<Cable>, steps: &[&[f64]], obstacle: Obstacle) -> Sliding {
    let smooth = of("at an obstacle", cables, steps, obstacle);
    Sliding { robot: held(&smooth.robot, 3e-3, None), ..smooth }
}

const STICKS: &str = "sticks to a wall";

/// The same where what sticks hangs on the step before; joints there are near to their limits.
const STICKING: f64 = 2e-4;

/// At a wall that it slides along first and sticks to then.
fn sticking() -> Sliding {
    let cable = |angle| Cable { axial_stiffness: Some(300.0), ..rubbing(straight(angle), 0.02) };
    let cables = vec![cable(10.0), cable(170.0)];
    let wall = Obstacle { friction: 2.0, ..wall(0.05) };
    let mut sticking = among(cables, &[&[3.0, 0.4], &[2.7, 0.5]], wall);
    sticking.name = STICKS;
    sticking.case.loads.tip_force.y = 0.05;
    sticking
}

fn at_obstacles(mu: [f64; 2], stiffness: Option<f64>) -> [Sliding; 3] {
    let cable = |angle: f64, mu: f64| {
        let routing = straight(angle);
        let friction = (mu > 0.0).then_some(mu);
        Cable { axial_stiffness: stiffness, friction, ..Cable::new(format!("{angle}"), routing) }
    };
    let cables = || vec![cable(10.0, mu[0]), cable(170.0, mu[1])];
    let ball = sphere(Vec3::new(0.05, 0.0, 0.12), 0.03);
    [
        among(cables(), &[&[3.0, 0.4], &[2.2, 0.6]], wall(0.05)),
        among(cables(), &[&[3.0, 0.4], &[3.4, 0.4]], wall(0.05)),
        among(cables(), &[&[1.0, 0.4], &[3.0, 0.5]], ball),
    ]
}

/// Differences of whole ways leave about this much, relative to the largest change.
const WHOLE_WAY: f64 = 1e-5;

fn steps_at_obstacles(tested: Tested) {
    let all = at_obstacles([0.0; 2], None);
    let failures: String = all.iter().map(|of| check_at_obstacles(tested, of, WHOLE_WAY)).collect();
    assert!(failures.is_empty(), "{failures}");
}

fn steps_that_rub_at_obstacles(tested: Tested) {
    let all = at_obstacles([0.3, 0.2], Some(400.0));
    let failures: String = all.iter().map(|of| check_at_obstacles(tested, of, WHOLE_WAY)).collect();
    let failures = failures + &check_at_obstacles(tested, &sticking(), STICKING);
    assert!(failures.is_empty(), "{failures}");
}

/// The derivatives of a step are those of the steps up to it, whichever are asked for.
fn steps_one_by_one(tested: Tested) {
    let parameters = [Parameter::YieldMoment { axis: None }, Parameter::YoungModulus];
    let mut all = of_ways(&SMOOTH_WAYS, &smooth);
    all.extend(of_ways(&ROUGH_WAYS, &rough));
    all.extend(at_obstacles([0.3, 0.2], Some(400.0)));
    for Sliding { name, robot, case } in all {
        let count = case.before.len() + 1;
        for asked in 0..count {
            let mut found = Vec::new();
            let mut prepared = tested.prepare(&robot, &case, &options(tested, &case)).unwrap();
            prepared
                .solve_steps_with_derivatives(
                    &case,
                    &parameters,
                    |step| step == asked,
                    |solution, of| found.push((solution, of)),
                )
                .unwrap_or_else(|(n, error)| panic!("{name}, step {n}: {error}"));
            assert_eq!(found.len(), count);
            let step = case.step(asked).unwrap();
            let (alone, derivatives) =
                prepared.solve_with_derivatives(&step, None, &parameters).unwrap();
            for (n, (solution, of)) in found.iter().enumerate() {
                assert_eq!(of.is_some(), n == asked);
                let Some(of) = of else { continue };
                assert_eq!(alone.shape, solution.shape, "{name}");
                assert_eq!(alone.plastic_curvature, solution.plastic_curvature, "{name}");
                for p in 0..parameters.len() {
                    let of_tip =
                        |of: &Linearization| of.parameter(p, Hold::Commands).twist(Place::Tip);
                    assert_eq!(of_tip(of), of_tip(&derivatives), "{name}");
                }
            }
        }
    }
}

/// Where a command is repeated the joints that slid are at their limits: the derivatives by commands are those of one side, and it is said.
fn a_command_that_is_repeated(tested: Tested) {
    let robot = held(&robot(smooth()), 3e-3, None);
    let one_sided = |steps: &[&[f64]]| {
        let case = in_steps(steps, &tip_loads());
        let (_, derivatives) = differentiated(tested, &robot, &case, &[]);
        derivatives.one_sided().names().collect::<Vec<_>>()
    };
    assert_eq!(one_sided(&[&[2.5, 0.5, 0.3]]), Vec::<&str>::new());
    assert_eq!(one_sided(&[&[2.5, 0.5, 0.3], &[2.5, 0.5, 0.3]]), ["bending"]);
}

/// Of rods with both frictions: the motion of the tip, free and at a wall. Where sliding ends along the backbone moves from step to step of the
/// grid: short differences stay between two.
#[test]
fn rods_that_rub() {
    let mut failures = String::new();
    for tested in [Tested::Continuous, Tested::Disks] {
        for touches in [false, true] {
            let mut all = match touches {
                true => at_obstacles([0.15, 0.1], Some(400.0)).to_vec(),
                false => of_rods(),
            };
            all.truncate(if touches { 2 } else { 3 });
            if touches {
                all.push(sticking());
            }
            for Sliding { name, robot, case } in all {
                let options = Options { accuracy: Accuracy::Steps(24), ..options(tested, &case) };
                let list = AT_OBSTACLES.map(|(parameter, _)| parameter);
                let list = [&list[..], &[Parameter::Friction { cable: None }]].concat();
                let solve = |robot: &Robot, case: &Case, list: &[Parameter]| {
                    let found = tested.solve_with_derivatives(robot, case, &options, list);
                    found.unwrap_or_else(|error| panic!("{name}: {error}"))
                };
                let (solution, of) = solve(&robot, &case, &list);
                assert_eq!(solution.contacts.is_empty(), !touches, "{name}");
                let tip = Place::Disk(robot.disks().count() - 1);
                let length = robot.backbone().length;
                let mut compare =
                    |what: String, exact: Vec3, scale: f64, near: &dyn Fn(f64) -> (Robot, Case)| {
                        let at = |by: f64| {
                            let (robot, case) = near(by);
                            solve(&robot, &case, &[]).0.disks.tip().position
                        };
                        let off = |part: f64| {
                            let h = part * scale;
                            let difference = (at(h) - at(-h)) * (0.5 / h);
                            (difference - exact).norm() * scale / length
                        };
                        let size = exact.norm() * scale / length;
                        let share = if name == STICKS { 1e-3 } else { 1e-4 };
                        let tolerance = if touches { 1e-6 + share * size } else { 1e-6 };
                        if let Err(all) = off_with_all([1e-3, 1e-4, 1e-5], tolerance, off) {
                            failures += &format!(
                                "{:?} {touches} {name} {what}: {all:?} of {size}\n",
                                solution.model
                            );
                        }
                    };
                for cable in 0..robot.cables().len() {
                    let command = case.commands[cable];
                    let scale = command.tension.unwrap_or(1e-3);
                    let exact = of.command(cable).twist(tip).linear;
                    compare(format!("command {cable}"), exact, scale, &|by| {
                        let mut case = case.clone();
                        case.commands[cable] = moved(command, by);
                        (robot.clone(), case)
                    });
                }
                for (p, parameter) in list.iter().enumerate() {
                    let value = parameter.value(&robot, &case).unwrap();
                    let scale = if value == 0.0 { 1.0 } else { value.abs() };
                    let exact = of.parameter(p, Hold::Commands).twist(tip).linear;
                    compare(parameter.to_string(), exact, scale, &|by| {
                        parameter.moved(&robot, &case, by).unwrap()
                    });
                }
            }
        }
    }
    assert!(failures.is_empty(), "{failures}");
}

/// Steps in which no hole comes to rest on the way.
fn of_rods() -> Vec<Sliding> {
    let ways: [&[&[f64]]; 3] = [
        &[&[2.0, 1.0, 1.5], &[1.2, 0.6, 0.9]],
        &[&[1.0, 0.5, 0.7], &[2.0, 1.0, 1.4]],
        &[&[-3.0, 1.0, 1.0], &[-3.6, 1.2, 1.2]],
    ];
    let of = |steps: &&[&[f64]]| {
        let case = in_steps(steps, &tip_loads());
        Sliding { name: "there and back", robot: held(&robot(rough()), 3e-3, None), case }
    };
    ways.iter().map(of).collect()
}
