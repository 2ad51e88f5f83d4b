//! A controller on simulated robots that are not its model: wrong stiffness, an unknown load, noise, another model with friction.

use std::f64::consts::TAU;
use std::time::Instant;

use whipcord::{
    Actuation, Cable, CableCommand, Case, Model, ModelKind, Prepared, Robot, Solution, Vec3,
};
use whipcord_inverse::{
    CableLimits, CommandedBy, ControlOptions, Controller, InverseError, InverseSolver, Limits,
    ReachOptions, Target,
};

use crate::planted::Random;
use crate::robots;

const PERIOD: f64 = 0.01;

/// The robot that is controlled.
struct Plant {
    prepared: Prepared,
    case: Case,
    remembers: bool,
    last: Option<Solution>,
}

impl Plant {
    fn new(kind: ModelKind, robot: &Robot, force: Vec3) -> Self {
        let model = Model::new(kind, Default::default(), Actuation::Natural);
        let mut case = Case::with_tensions(&vec![0.0; robot.cables().len()]);
        case.loads.tip_force = force;
        let prepared = model.prepare(robot, &case.loads).unwrap();
        Self { prepared, case, remembers: robot.has_history(), last: None }
    }

    fn tip(&mut self, tensions: &[f64]) -> Vec3 {
        if self.remembers && self.last.is_some() {
            let commands = self.case.commands.clone();
            self.case.before.push(commands);
        }
        self.case.commands = tensions
            .iter()
            .map(|&tension| CableCommand { tension: Some(tension), shortening: None })
            .collect();
        let from = if self.remembers { None } else { self.last.as_ref() };
        let solution = self.prepared.solve(&self.case, from).unwrap();
        let tip = solution.disks.poses.last().unwrap().position;
        self.last = Some(solution);
        tip
    }
}

fn target(time: f64) -> Vec3 {
    let (sin, cos) = (TAU * time / 2.0).sin_cos();
    Vec3::new(0.04 * cos, 0.04 * sin, 0.173)
}

fn limits(robot: &Robot) -> Limits {
    let of = CableLimits { tension: [0.05, 10.0], rate: Some(50.0), ..CableLimits::default() };
    Limits::uniform(robot.cables().len(), of)
}

/// Root of the mean square of the distance in the second half, with the commands of the model alone and with measurements.
fn tracking(
    plant: (ModelKind, &Robot, Vec3),
    nominal: &Robot,
    noise: f64,
    cycles: usize,
) -> (f64, f64) {
    let (kind, robot, force) = plant;
    let model = Model::new(ModelKind::Cosserat, Default::default(), Actuation::Natural);
    let limits = limits(nominal);
    let mut solver =
        InverseSolver::new(&model, nominal, &Case::default(), &limits, CommandedBy::Tensions)
            .unwrap();
    let start = solver.reach(&Target::Tip(target(0.0)), &ReachOptions::default()).unwrap();
    let mut results = [0.0; 2];
    for (result, is_measured) in results.iter_mut().zip([false, true]) {
        let mut options = ControlOptions::new(PERIOD, robots::LENGTH);
        options.gain = 20.0;
        let mut controller =
            Controller::new(&model, nominal, &start.case, &limits, CommandedBy::Tensions, options)
                .unwrap();
        let mut plant = Plant::new(kind, robot, force);
        let mut random = Random(4);
        let mut tip = plant.tip(&start.commands);
        let mut last = start.commands.clone();
        let (mut squares, mut count) = (0.0, 0.0);
        for cycle in 1..cycles {
            let now = target(PERIOD * cycle as f64);
            let mut part = || noise * (random.next() + random.next() + random.next() - 1.5) * 2.0;
            let seen = tip + Vec3::new(part(), part(), part());
            let measured = is_measured.then_some(Target::Tip(seen));
            let answer = controller.cycle(&Target::Tip(now), measured.as_ref()).unwrap();
            for (command, before) in answer.commands.iter().zip(&last) {
                assert!((0.05..=10.0).contains(command));
                assert!((command - before).abs() <= 50.0 * PERIOD + 1e-12);
            }
            last.clone_from(&answer.commands);
            tip = plant.tip(&answer.commands);
            if 2 * cycle > cycles {
                squares += (tip - now).norm_squared();
                count += 1.0;
            }
        }
        *result = (squares / count).sqrt();
    }
    (results[0], results[1])
}

#[test]
fn measurements_make_up_for_a_wrong_stiffness_and_an_unknown_load() {
    let nominal = robots::two_segments();
    let mut backbone = robots::backbone(0.003);
    backbone.material.young_modulus = Some(0.85e9);
    let robot = Robot::new(backbone, robots::disks(), nominal.cables().to_vec()).unwrap();
    let plant = (ModelKind::Cosserat, &robot, Vec3::new(0.05, 0.03, -0.02));
    let (without, with) = tracking(plant, &nominal, 1e-4, 300);
    assert!(without > 5e-3, "{without}");
    assert!(with < 0.1 * without, "{with} {without}");
    assert!(with < 6e-4, "{with}");
}

#[test]
fn measurements_make_up_for_friction_in_another_model() {
    let nominal = robots::three_straight();
    let cables =
        nominal.cables().iter().map(|cable| Cable { friction: Some(0.08), ..cable.clone() });
    let robot = robots::robot(cables.collect());
    let plant = (ModelKind::PiecewiseConstantCurvature, &robot, Vec3::default());
    let (without, with) = tracking(plant, &nominal, 1e-4, 40);
    assert!(with < 0.5 * without, "{with} {without}");
}

/// Without noise, measured poses tell the load that acts.
#[test]
fn the_force_on_the_tip_is_found() {
    let robot = robots::two_segments();
    let force = Vec3::new(0.03, -0.02, 0.01);
    let model = Model::new(ModelKind::Cosserat, Default::default(), Actuation::Natural);
    let mut options = ControlOptions::new(PERIOD, robots::LENGTH);
    if let Some(estimator) = &mut options.estimator {
        estimator.bias = 1e-6;
        estimator.position = 1e-5;
        estimator.angle = 1e-4;
    }
    let case = Case::with_tensions(&[1.0, 0.5, 0.2, 0.4, 0.8, 0.3]);
    let mut controller =
        Controller::new(&model, &robot, &case, &limits(&robot), CommandedBy::Tensions, options)
            .unwrap();
    let mut plant = Plant::new(ModelKind::Cosserat, &robot, force);
    let tensions: Vec<f64> = case.commands.iter().map(|c| c.tension.unwrap()).collect();
    let hold = Target::Tip(plant.tip(&tensions));
    // A position alone says little of the force along the backbone.
    let pose = |plant: &Plant| *plant.last.as_ref().unwrap().disks.poses.last().unwrap();
    let mut found = Vec3::default();
    for _ in 0..60 {
        let answer = controller.cycle(&hold, Some(&Target::Pose(pose(&plant)))).unwrap();
        plant.tip(&answer.commands);
        let [x, y, z] = answer.force.map(|of| of.value);
        found = Vec3::new(x, y, z);
    }
    assert!((found - force).norm() < 2e-3, "{found:?}");
}

#[test]
fn options_and_models_that_cannot_be_are_refused() {
    let robot = robots::three_straight();
    let new = |kind: ModelKind, period: f64| {
        let model = Model::new(kind, Default::default(), Actuation::Natural);
        let options = ControlOptions::new(period, robots::LENGTH);
        let limits = limits(&robot);
        Controller::new(&model, &robot, &Case::default(), &limits, CommandedBy::Case, options).err()
    };
    assert_eq!(new(ModelKind::Cosserat, 0.0), Some(InverseError::ControlOptions));
    assert_eq!(new(ModelKind::Cosserat, f64::NAN), Some(InverseError::ControlOptions));
    assert_eq!(new(ModelKind::ConstantCurvature, 1e-3), Some(InverseError::NoDerivatives));
    assert_eq!(new(ModelKind::Cosserat, 1e-3), None);
}

/// Times of the cycles of a controller at 1 kHz, with measurements of the tip and an estimate of the load, along tips of tensions that go up and down; each the least of two rounds, so
/// that interruptions by other programs drop out.
#[test]
#[ignore = "a minute"]
#[allow(clippy::print_stdout, reason = "a study prints its results")]
fn study_of_cycles() {
    let cycles = std::env::var("COUNT").ok().and_then(|n| n.parse().ok()).unwrap_or(10_000);
    let period = 1e-3;
    println!("| robot | median, µs | of 99.9 %, µs | worst, µs |");
    println!("|---|---|---|---|");
    for (name, robot, greatest) in robots::all() {
        if !robot.motors().is_empty() {
            continue;
        }
        let model = Model::new(ModelKind::Cosserat, Default::default(), Actuation::Natural);
        let of = CableLimits { tension: [0.05, greatest], ..CableLimits::default() };
        let limits = Limits::uniform(robot.cables().len(), of);
        let tensions = |cycle: usize| -> Vec<f64> {
            let turn = TAU * period * cycle as f64 / 2.0;
            let of = |k: usize| greatest * (0.4 + 0.3 * (turn + 1.7 * k as f64).sin());
            (0..robot.cables().len()).map(of).collect()
        };
        let start = Case::with_tensions(&tensions(0));
        let mut seconds = vec![f64::INFINITY; cycles];
        for _ in 0..2 {
            let options = ControlOptions::new(period, robots::LENGTH);
            let by = CommandedBy::Tensions;
            let mut controller =
                Controller::new(&model, &robot, &start, &limits, by, options).unwrap();
            let mut aim = Plant::new(ModelKind::Cosserat, &robot, Vec3::default());
            let mut plant = Plant::new(ModelKind::Cosserat, &robot, Vec3::new(0.01, 0.01, 0.0));
            let mut random = Random(4);
            let mut tip = plant.tip(&tensions(0));
            for (cycle, least) in seconds.iter_mut().enumerate() {
                let now = Target::Tip(aim.tip(&tensions(cycle)));
                let mut part = || 1e-4 * (random.next() - 0.5);
                let seen = Target::Tip(tip + Vec3::new(part(), part(), part()));
                let clock = Instant::now();
                let answer = controller.cycle(&now, Some(&seen)).unwrap();
                *least = least.min(clock.elapsed().as_secs_f64());
                tip = plant.tip(&answer.commands);
            }
        }
        seconds.sort_by(f64::total_cmp);
        let at = |part: f64| 1e6 * seconds[(part * (cycles - 1) as f64) as usize];
        println!("| {name} | {:.0} | {:.0} | {:.0} |", at(0.5), at(0.999), at(1.0));
    }
}
