//! Motors with inertia that pull cables with friction, and motions that go on from a state with such cables.

use core::f64::consts::PI;

use whipcord::{
    Cable, Case, Loads, Model, ModelKind, Motor, MotorDynamics, Robot, Shortening, Statics,
    Stations, Vec3,
};
use whipcord_motion::{
    CableDrive, Commands, Course, Damping, Initial, Method, MotionOptions, Simulation, Start, State,
};

use super::robots::{helix, paper, ramps, straight};

const MODELS: [ModelKind; 2] = [ModelKind::Cosserat, ModelKind::CosseratDisks];
const RADIUS: f64 = 5e-3;

/// Antagonists on one shaft and a third cable on its own motor.
fn robot(friction: f64, is_elastic: bool, dynamics: Option<MotorDynamics>) -> Robot {
    let cable = |name: &str, angle: f64| Cable {
        friction: (friction > 0.0).then_some(friction),
        axial_stiffness: is_elastic.then_some(3e3),
        ..straight(name, angle, 0.008)
    };
    let cables = vec![cable("a", 0.0), cable("b", PI), cable("c", 0.5 * PI)];
    let of = |name: &str, cables: &[(usize, f64)]| Motor {
        stiffness: is_elastic.then_some(4e3),
        pretension: if is_elastic { 0.5 } else { 0.0 },
        dynamics,
        ..Motor::spool(name, cables.iter().copied())
    };
    let motors = vec![of("bend", &[(0, RADIUS), (1, -RADIUS)]), of("side", &[(2, RADIUS)])];
    paper(cables).with_motors(motors).unwrap()
}

fn options(model: ModelKind) -> MotionOptions {
    MotionOptions {
        model,
        elements: 10,
        damping: Damping::Time(8e-2),
        initial: Initial::Rest,
        ..MotionOptions::default()
    }
}

fn told(courses: [Course; 2]) -> Commands {
    let motors = courses.into_iter().map(Some).collect();
    Commands { motors, ..Commands::tensions(&[0.0; 3]) }
}

/// A light motor with a stiff, well damped loop.
fn stiff() -> MotorDynamics {
    MotorDynamics { derivative: 5e-3, ..MotorDynamics::new(1e-6, 0.5) }
}

fn run(
    robot: &Robot,
    commands: &Commands,
    options: MotionOptions,
    (dt, steps): (f64, usize),
) -> Vec<State> {
    let case = Case::with_tensions(&[0.0; 3]);
    let mut simulation = Simulation::with_commands(robot, &case, commands, options).unwrap();
    (0..steps).map(|_| simulation.step(commands, dt).unwrap().clone()).collect()
}

/// Turned slowly, and back, the robot stands where the statics has it where the motors stand.
#[test]
fn slow_motors_lead_to_the_steps_of_the_statics() {
    let robot = robot(0.3, true, Some(stiff()));
    let ramp = 4.0;
    for model in MODELS {
        let steps = [[0.8, 0.3], [0.5, 0.4]];
        let commands = told([0, 1].map(|i| ramps(ramp, 0.5 * ramp, &steps.map(|step| step[i]))));
        let case = Case::with_tensions(&[0.0; 3]);
        let options = MotionOptions { elements: 16, ..options(model) };
        let mut simulation = Simulation::with_commands(&robot, &case, &commands, options).unwrap();
        let mut before = Vec::new();
        for (k, step) in steps.into_iter().enumerate() {
            for _ in 0..(1.5 * ramp / 0.02_f64).round() as usize {
                simulation.step(&commands, 0.02).unwrap();
            }
            let state = simulation.state();
            let positions: Vec<f64> = state.motors.iter().map(|motor| motor.position).collect();
            let wound = [RADIUS * positions[0], -RADIUS * positions[0], RADIUS * positions[1]];
            let held = Case::with_shortenings(&wound.map(Shortening::Length));
            let held = Case { before: core::mem::take(&mut before), ..held };
            let statics = Model::new(model, Stations::Disks, Default::default());
            let solution = statics.solve(&robot, &held).unwrap();
            before = held.before;
            before.push(held.commands);
            let error = (state.tip().position - solution.shape.tip().position).norm() / 0.18;
            let of_motors = |motor: usize| step[motor] - positions[motor];
            let taken = [0, 1, 2].map(|i| RADIUS * state.cables[i].tension);
            println!("{model} {k}: {error:.1e}, {:?} {positions:?}", state.cables);
            assert!(error < 1e-3, "{model} {k}: {error:e}");
            assert!((of_motors(0) - (taken[0] - taken[1]) / 0.5).abs() < 1e-6);
            assert!((of_motors(1) - taken[2] / 0.5).abs() < 1e-6);
            for (moved, still) in state.cables.iter().zip(&solution.cables) {
                let (moved, still) = (moved.tension, still.tension.unwrap());
                assert!((moved - still).abs() < 0.02 * still.max(1.0), "{moved} {still}");
            }
        }
    }
}

/// A motor that hardly turns holds its cables as one without inertia does.
#[test]
fn a_heavy_motor_holds() {
    let heavy = MotorDynamics::new(1e6, 0.5);
    for model in MODELS {
        let loads = Loads { tip_force: Vec3::new(0.1, 0.05, 0.0), ..Loads::default() };
        let case = Case { loads, ..Case::with_tensions(&[0.0; 3]) };
        let tips = [Some(heavy), None].map(|dynamics| {
            let robot = robot(0.3, false, dynamics);
            let commands = told([0.0, 0.0].map(Course::constant));
            let options = MotionOptions { damping: Damping::Time(4e-3), ..options(model) };
            let mut simulation =
                Simulation::with_commands(&robot, &case, &commands, options).unwrap();
            (0..60).map(|_| simulation.step(&commands, 5e-3).unwrap().tip().position).collect()
        });
        let [moved, held]: [Vec<Vec3>; 2] = tips;
        let apart = moved.iter().zip(&held).map(|(a, b)| (*a - *b).norm()).fold(0.0, f64::max);
        let way = held.iter().map(|tip| tip.x).fold(0.0, f64::max);
        println!("{model}: {apart:e} of {way:e}");
        assert!(apart < 1e-6 * way.max(1e-3), "{apart:e}");
    }
}

/// Friction that is hardly there changes nothing.
#[test]
fn hardly_any_friction_is_none() {
    let dynamics =
        MotorDynamics { derivative: 5e-3, integral: 3.0, ..MotorDynamics::new(2e-5, 0.5) };
    for model in MODELS {
        let commands = told([ramps(0.1, 0.05, &[0.8, -0.2]), ramps(0.1, 0.05, &[0.3, 0.5])]);
        let tips = [0.0, 1e-14].map(|friction| {
            let options = MotionOptions {
                damping: Damping::Time(5e-3),
                iteration_tolerance: 1e-12,
                method: Method::Robust,
                ..options(model)
            };
            run(&robot(friction, false, Some(dynamics)), &commands, options, (5e-3, 60))
        });
        for (a, b) in tips[0].iter().zip(&tips[1]) {
            let apart = (a.tip().position - b.tip().position).norm() / 0.18;
            let turned = (a.motors[0].position - b.motors[0].position).abs();
            assert!(apart < 1e-9 && turned < 1e-8, "{model}: {apart:e} {turned:e}");
        }
    }
}

/// What the loops give is in motion, strains and stretch, or was taken by damping and friction: the nearer, the shorter the steps.
#[test]
fn the_energy_of_motors_and_friction_is_in_the_balance() {
    let dynamics =
        MotorDynamics { damping: 1e-3, derivative: 5e-3, ..MotorDynamics::new(2e-5, 0.5) };
    for model in MODELS {
        let commands = told([ramps(0.2, 0.1, &[0.8, 0.0]), ramps(0.2, 0.1, &[0.3, 0.4])]);
        let defects = [2e-2, 5e-3, 1e-3].map(|dt| {
            let options = MotionOptions {
                damping: Damping::Time(5e-3),
                initial: Initial::Equilibrium,
                ..options(model)
            };
            let of = (dt, (0.6_f64 / dt).round() as usize);
            let states = run(&robot(0.3, true, Some(dynamics)), &commands, options, of);
            let mut lost = 0.0;
            for state in &states {
                assert!(state.energy.dissipated >= lost);
                lost = state.energy.dissipated;
            }
            let energy = states.last().unwrap().energy;
            assert!(energy.cables == 0.0 && energy.control > 0.0 && lost > 0.0, "{energy:?}");
            energy.defect() / states.iter().map(|of| of.energy.control).fold(0.0, f64::max)
        });
        println!("{model}: {defects:?}");
        assert!(
            defects[2].abs() < 5e-3 && defects[2].abs() < 0.3 * defects[0].abs(),
            "{defects:?}"
        );
    }
}

/// From the equilibrium in which soft loops hold the cables a motion starts at rest.
#[test]
fn motions_start_in_equilibrium() {
    for (model, gain) in MODELS.into_iter().flat_map(|of| [(of, 0.5), (of, 0.02)]) {
        let soft = MotorDynamics { derivative: 2e-3, ..MotorDynamics::new(1e-5, gain) };
        let robot = robot(0.3, true, Some(soft));
        let commands = told([0.9, 0.4].map(Course::constant));
        let case = Case::with_tensions(&[0.0; 3]);
        let options =
            MotionOptions { initial: Initial::Equilibrium, elements: 16, ..options(model) };
        let mut simulation = Simulation::with_commands(&robot, &case, &commands, options).unwrap();
        let start = simulation.state().clone();
        let effort = RADIUS * (start.cables[0].tension - start.cables[1].tension);
        assert!((start.motors[0].effort - effort).abs() < 1e-9);
        assert!((0.9 - start.motors[0].position - effort / gain).abs() < 1e-8);
        for _ in 0..100 {
            simulation.step(&commands, 0.01).unwrap();
        }
        let state = simulation.state();
        let moved = (state.tip().position - start.tip().position).norm() / 0.18;
        let turned = (state.motors[0].position - start.motors[0].position).abs();
        println!("{model} {gain}: moved {moved:.1e}, turned {turned:.1e}");
        assert!(moved < 2e-3 && turned < 2e-3, "{model} {gain}: {moved:e} {turned:e}");
    }
}

/// Where the cables stick, motors that stay where they are hold them like motors without inertia: vibrations are the same, and what drives do below the base changes nothing.
#[test]
fn vibrations_about_cables_that_stick() {
    for model in MODELS {
        let of = |dynamics: Option<MotorDynamics>| {
            let motors = robot(0.4, true, dynamics).motors().to_vec();
            let cables = [helix(), straight("b", 3.0, 0.008), straight("c", 2.0, 0.008)];
            let rubs =
                |cable: Cable| Cable { friction: Some(0.4), axial_stiffness: Some(300.0), ..cable };
            let robot = paper(cables.map(rubs).to_vec()).with_motors(motors).unwrap();
            let gravity = Some(Vec3::new(9.81, 0.0, 0.0));
            let loads = Loads { gravity, ..Loads::default() };
            let case = Case { loads, ..Case::with_tensions(&[0.0; 3]) };
            // Let off a little, so that the cables are within their grip in the holes of the base, too.
            let turned = |angle: f64| {
                let times = vec![0.0, 2.0, 2.2];
                Course::table(times, vec![angle, angle, angle - 0.03]).unwrap()
            };
            let commands = told([2.0, 1.0].map(turned));
            let options = MotionOptions { damping: Damping::Time(4e-3), ..options(model) };
            let mut simulation =
                Simulation::with_commands(&robot, &case, &commands, options).unwrap();
            for _ in 0..400 {
                simulation.step(&commands, 1e-2).unwrap();
            }
            let modes = simulation.modes(&commands, 1).unwrap();
            (modes[0].angular_frequency().unwrap(), simulation)
        };
        let ((moving, mut simulation), (held, _)) = (of(Some(stiff())), of(None));
        println!("{model}: {moving} {held}");
        assert!((moving / held - 1.0).abs() < 2e-3, "{model}: {moving} {held}");
        let linear = simulation.linearize().unwrap();
        let greatest = linear.a.iter().fold(0.0_f64, |most, of| most.max(of.abs()));
        let cables = simulation.state().cables.clone();
        let of_taut = (0..linear.b.len()).filter(|k| cables[k % 3].tension > 0.0);
        let by_drive = of_taut.map(|k| linear.b[k].abs()).fold(0.0_f64, f64::max);
        assert!(greatest.is_finite() && by_drive < 1e-6, "{greatest:e} {by_drive:e}");
    }
}

/// A motion that goes on from a state of another one is the rest of that motion, to the last bit: by tensions, lengths and motors, where holes stick and slide.
#[test]
fn a_motion_with_friction_goes_on_from_a_state() {
    // So that times are exact.
    const DT: f64 = 1.0 / 128.0;
    let motors = robot(0.4, true, Some(stiff()));
    let cables = [helix(), straight("b", 3.0, 0.008), straight("c", 2.0, 0.008)];
    let alone = paper(cables.map(|cable| Cable { friction: Some(0.3), ..cable }).to_vec());
    for (model, kind) in MODELS.into_iter().flat_map(|model| [0, 1, 2].map(|kind| (model, kind))) {
        let told_at = |step: usize| {
            let size = if step < 20 { 1.0 } else { 0.7 };
            match kind {
                0 => Commands::tensions(&[3.0 * size, 1.0, 0.5]),
                1 => {
                    let of = |length: f64| CableDrive::Shortening(Course::constant(length * size));
                    Commands::new([3e-3, -1e-3, 1e-3].map(of).to_vec())
                }
                _ => told([0.8, 0.4].map(|angle| Course::constant(angle * size))),
            }
        };
        let robot = if kind == 2 { &motors } else { &alone };
        let case = Case::with_tensions(&[0.0; 3]);
        let options = MotionOptions { damping: Damping::Time(5e-3), ..options(model) };
        let mut whole =
            Simulation::with_commands(robot, &case, &told_at(0), options.clone()).unwrap();
        for step in 0..25 {
            whole.step(&told_at(step), DT).unwrap();
        }
        let start = whole.state().start();
        assert!(start.rates.is_some() && start.passage_tensions[0].len() > 5);
        let slips = &whole.state().holes.slip_states;
        println!("{model} {kind}: {slips:?}");
        let initial = Initial::State(Box::new(start.clone()));
        let options = MotionOptions { initial, ..options };
        let mut rest =
            Simulation::with_commands(robot, &case, &told_at(25), options.clone()).unwrap();
        assert_eq!(rest.state().start(), start);
        for step in 25..50 {
            whole.step(&told_at(step), DT).unwrap();
            rest.step(&told_at(step), DT).unwrap();
        }
        assert_eq!(rest.state().start(), whole.state().start(), "{model} {kind}");
        assert_eq!(rest.state().poses, whole.state().poses);
        // Without its rates it is nearly so.
        let slow = Initial::State(Box::new(Start { rates: None, ..start }));
        let slow = MotionOptions { initial: slow, ..options };
        let mut rest = Simulation::with_commands(robot, &case, &told_at(25), slow).unwrap();
        (25..50).for_each(|step| _ = rest.step(&told_at(step), DT).unwrap());
        let apart = (rest.state().tip().position - whole.state().tip().position).norm();
        assert!(apart < 2e-3, "{apart:e}");
    }
}
