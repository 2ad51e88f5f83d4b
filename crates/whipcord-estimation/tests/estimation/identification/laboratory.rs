//! Synthetic laboratories: a robot with motors, a table of commands, a tracker with noise.

use crate::common::{paper_backbone, straight};
use crate::identification::synthetic::{Normal, disturb, model};
use whipcord::{
    Cable, Case, Disks, Model, ModelKind, Motor, Robot, Routing, Shortening, UnitQuaternion, Vec3,
};
use whipcord_estimation::identification::{Experiment, ParameterPath, RowLabel, Settings, Unknown};
use whipcord_estimation::{Observation, Place, Seen};

/// What the real robot is, where it is not as its file says.
#[derive(Clone, Copy, Debug)]
pub struct Truth {
    pub stiffness: f64,
    pub backlash: f64,
    pub offsets: [f64; 3],
    pub angles: [f64; 3],
    pub radius: f64,
    pub turn: f64,
    /// More shortening of the cables than commanded, in m.
    pub slack: [f64; 3],
    /// Of all cables in their holes.
    pub friction: f64,
}

pub const FILE: Truth = Truth {
    stiffness: 8e3,
    backlash: 0.05,
    offsets: [0.0; 3],
    angles: [0.0; 3],
    radius: 0.008,
    turn: 0.0,
    slack: [0.0; 3],
    friction: 0.0,
};

/// Three cables, each with a spool.
pub fn robot(truth: &Truth) -> Robot {
    let cables = [0.0, 120.0, 240.0].into_iter().zip(truth.angles).map(|(degrees, off)| {
        let Routing::Straight { angle, .. } = straight(degrees) else { unreachable!() };
        let routing = Routing::Straight { angle: angle + off, radius: truth.radius };
        let friction = (truth.friction > 0.0).then_some(truth.friction);
        Cable { friction, ..Cable::new(format!("c{degrees}"), routing) }
    });
    let motors = truth.offsets.into_iter().enumerate().map(|(i, offset)| Motor {
        stiffness: Some(truth.stiffness),
        backlash: truth.backlash,
        pretension: 10.0,
        offset,
        ..Motor::spool(format!("m{i}"), [(i, 0.01)])
    });
    let disks = Disks::equally_spaced(0.18, 10, 0.009);
    let robot = Robot::new(paper_backbone(), disks, cables.collect()).unwrap();
    robot.with_motors(motors.collect()).unwrap()
}

/// Commands in all directions, a case with a step for each.
pub fn commands(robot: &Robot, rows: &[[f64; 3]]) -> Case {
    let none = vec![Default::default(); 3];
    let mut case = Case {
        commands: none.clone(),
        before: vec![none; rows.len() - 1],
        motors: rows.iter().map(|row| row.iter().map(|angle| Some(*angle)).collect()).collect(),
        ..Case::default()
    };
    case.drive(robot).unwrap();
    case
}

/// Rows that pull the robot at random.
pub fn random_rows(count: usize, random: &mut Normal) -> Vec<[f64; 3]> {
    let row = |_| {
        let (way, size) = (core::f64::consts::TAU * random.uniform(), 0.5 * random.uniform());
        [0.0, 1.0, 2.0].map(|i| size * (way - core::f64::consts::TAU * i / 3.0).cos())
    };
    (0..count).map(row).collect()
}

/// Rows that lead the robot about in small steps.
pub fn random_path(count: usize, random: &mut Normal) -> Vec<[f64; 3]> {
    let (mut way, mut size) = (0.0, 0.3);
    let row = |_| {
        way += 0.6 * (random.uniform() - 0.3);
        size = (size + 0.12 * (random.uniform() - 0.5)).clamp(0.1, 0.5);
        [0.0, 1.0, 2.0].map(|i| size * (way - core::f64::consts::TAU * i / 3.0).cos())
    };
    (0..count).map(row).collect()
}

/// What a tracker sees of the middle and the tip of a real robot.
pub fn measure(truth: &Truth, rows: &[[f64; 3]], noise: f64, random: &mut Normal) -> Experiment {
    measure_by(&rod(), truth, rows, noise, random)
}

/// The same of a robot that is as this model says.
pub fn measure_by(
    model: &Model,
    truth: &Truth,
    rows: &[[f64; 3]],
    noise: f64,
    random: &mut Normal,
) -> Experiment {
    let real = robot(truth);
    let mut case = commands(&real, rows);
    case.base.rotation = UnitQuaternion::exp(Vec3::Z * truth.turn);
    for step in case.before.iter_mut().chain([&mut case.commands]) {
        for (command, slack) in step.iter_mut().zip(truth.slack) {
            if let Some(Shortening::Length(length)) = &mut command.shortening {
                *length += slack;
            }
        }
    }
    let mut prepared = model.prepare(&real, &case.loads).unwrap();
    let (mut observations, mut step) = (Vec::new(), 0);
    prepared
        .solve_steps(&case, |solution| {
            for disk in [4, 9] {
                let position = solution.disks.poses[disk].position;
                observations.push(Observation {
                    step,
                    place: Place::Disk(disk),
                    offset: Vec3::ZERO,
                    seen: Seen::Position(position),
                    deviation: None,
                });
            }
            step += 1;
        })
        .unwrap();
    // The file has its own idea of what the motors do.
    let file = Truth { friction: truth.friction, ..FILE };
    let case = commands(&robot(&file), rows);
    let labels = vec![RowLabel::default(); rows.len()];
    let mut seen = vec![Experiment { case, observations, labels, ..Experiment::default() }];
    disturb(&mut seen, random, [noise, 0.0]);
    seen.remove(0)
}

pub fn rod() -> Model {
    model(ModelKind::Cosserat)
}

pub fn settings() -> Settings {
    Settings::new(rod())
}

pub fn unknowns(paths: &[&str]) -> Vec<Unknown> {
    unknowns_of(&robot(&FILE), paths)
}

pub fn unknowns_of(file: &Robot, paths: &[&str]) -> Vec<Unknown> {
    let of = |path: &&str| {
        let path: ParameterPath = path.parse().unwrap();
        path.unknown(file).unwrap()
    };
    paths.iter().map(of).collect()
}
