//! Measurements of robots that are known.

use crate::common::{paper_robot, straight};
use whipcord::{Case, Model, ModelKind, Pose, Robot, UnitQuaternion, Vec3};
use whipcord_estimation::camera::{Camera, Distortion, Lens, Pinhole};
use whipcord_estimation::identification::{Experiment, Quantity, Settings, Unknown};
use whipcord_estimation::{Observation, Place, Seen};

pub fn model(kind: ModelKind) -> Model {
    Model::new(kind, Default::default(), Default::default()).with_tolerance(1e-9)
}

pub fn settings() -> Settings {
    Settings::new(model(ModelKind::Cosserat))
}

pub fn quantity(path: &str) -> Quantity {
    path.parse().unwrap()
}

pub fn unknowns(paths: &[&str]) -> Vec<Unknown> {
    paths.iter().map(|path| Unknown::new(quantity(path))).collect()
}

/// The paper's robot with three straight cables.
pub fn robot() -> Robot {
    paper_robot(vec![straight(0.0), straight(120.0), straight(240.0)])
}

/// Cases that pull the cables of [`robot`] by turns, each in as many steps as there are tensions.
pub fn cases(tensions: &[f64]) -> Vec<Case> {
    (0..3)
        .map(|cable| {
            let commands = |tension: f64| {
                let mut each = [0.3; 3];
                each[cable] = tension;
                each[(cable + 1) % 3] = 0.3 * tension;
                Case::with_tensions(&each).commands
            };
            let last = tensions.len() - 1;
            Case {
                commands: commands(tensions[last]),
                before: tensions[..last].iter().map(|tension| commands(*tension)).collect(),
                ..Case::default()
            }
        })
        .collect()
}

/// Where a model has the disks but the first in every step, without noise.
pub fn positions(model: &Model, robot: &Robot, case: &Case) -> Vec<Observation> {
    let mut prepared = model.prepare(robot, &case.loads).unwrap();
    let mut seen = Vec::new();
    let mut step = 0;
    prepared
        .solve_steps(case, |solution| {
            for (disk, pose) in solution.disks.poses.iter().enumerate().skip(1) {
                seen.push(Observation {
                    step,
                    place: Place::Disk(disk),
                    offset: Vec3::ZERO,
                    seen: Seen::Position(pose.position),
                    deviation: None,
                });
            }
            step += 1;
        })
        .unwrap();
    seen
}

/// Experiments of these cases without noise.
pub fn experiments(model: &Model, robot: &Robot, cases: &[Case]) -> Vec<Experiment> {
    cases
        .iter()
        .map(|case| Experiment {
            case: case.clone(),
            observations: positions(model, robot, case),
            ..Experiment::default()
        })
        .collect()
}

/// Normally distributed numbers, the same in every run: xorshift64*, and Box and Muller's transform.
pub struct Normal(u64);

impl Normal {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    pub fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        ((self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }

    pub fn next(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (core::f64::consts::TAU * self.uniform()).cos()
    }
}

/// Adds noise of this deviation, in m and in pixels.
pub fn disturb(experiments: &mut [Experiment], normal: &mut Normal, [metres, pixels]: [f64; 2]) {
    for seen in experiments.iter_mut().flat_map(|of| &mut of.observations) {
        match &mut seen.seen {
            Seen::Position(position) => {
                for i in 0..3 {
                    position[i] += metres * normal.next();
                }
            }
            Seen::Pixel { pixel, .. } => {
                for coordinate in pixel {
                    *coordinate += pixels * normal.next();
                }
            }
            Seen::Rotation { rotation, arm } => {
                let turn = [0; 3].map(|_| metres / *arm * normal.next());
                *rotation = UnitQuaternion::exp(Vec3::from(turn)) * *rotation;
            }
        }
    }
}

/// Two cameras half a metre away that look at the robot from two sides.
pub fn cameras() -> Vec<Camera> {
    let distortion = Distortion::new(&[-0.21, 0.05, 1e-3, -5e-4, 0.01]).unwrap();
    let lens = Lens::Pinhole(Pinhole::new([900.0, 905.0], [320.0, 240.0], distortion).unwrap());
    [0.0, 1.4]
        .map(|about| {
            // The camera looks along y of the world, turned about z; its y is down.
            let turn = UnitQuaternion::exp(Vec3::new(0.0, 0.0, about));
            let upright = UnitQuaternion::exp(Vec3::new(-core::f64::consts::FRAC_PI_2, 0.0, 0.0));
            let position = turn.rotate(Vec3::new(0.0, -0.5, 0.0)) + Vec3::new(0.0, 0.0, 0.08);
            Camera::new(lens, Pose { position, rotation: turn * upright }, None).unwrap()
        })
        .to_vec()
}

/// The same experiments as the cameras see them, with an offset of every marker in its disk.
pub fn as_pixels(model: &Model, robot: &Robot, cases: &[Case], offset: Vec3) -> Vec<Experiment> {
    let cameras = cameras();
    cases
        .iter()
        .map(|case| {
            let mut prepared = model.prepare(robot, &case.loads).unwrap();
            let mut observations = Vec::new();
            let mut step = 0;
            prepared
                .solve_steps(case, |solution| {
                    for (disk, pose) in solution.disks.poses.iter().enumerate().skip(1) {
                        for (camera, each) in cameras.iter().enumerate() {
                            let point = pose.position + pose.rotation.rotate(offset);
                            let pixel = each.project(point).unwrap();
                            observations.push(Observation {
                                step,
                                place: Place::Disk(disk),
                                offset,
                                seen: Seen::Pixel { camera, pixel },
                                deviation: None,
                            });
                        }
                    }
                    step += 1;
                })
                .unwrap();
            let cameras = cameras.clone();
            Experiment { case: case.clone(), cameras, observations, ..Experiment::default() }
        })
        .collect()
}
