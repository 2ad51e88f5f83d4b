//! Inverse problems of the robot of a file.

use std::sync::Arc;

use whipcord::{Actuation, Model, Pose, Stations, UnitQuaternion, Vec3};
use whipcord_inverse::{
    Actuator, CommandedBy, InverseSolver, ReachOptions, ReachStatus, Target, Tolerance,
};
use whipcord_io::CaseFile;

use crate::robot::{POSE, RobotFile, model_kind, pose_values};
use crate::status::{Failure, Status};
use crate::values::{CommandKind, ReachOutcome, ReachResult};

/// What finds the commands for targets, with the shapes that it starts from.
pub struct Reach {
    file: Arc<CaseFile>,
    solver: InverseSolver,
    options: ReachOptions,
    /// Of the last answer.
    commands: Option<Vec<f64>>,
}

impl Reach {
    pub(crate) fn new(robot: &RobotFile, model: &str) -> Result<Self, Failure> {
        let file = Arc::clone(&robot.file);
        let CaseFile { robot, case, goal, .. } = &*file;
        let length = robot.backbone().length;
        let tolerance = goal.tolerance(length).unwrap_or_else(|| Tolerance::of_length(length));
        let kind = model_kind(model)?;
        let model = Model::new(kind, Stations::Disks, Actuation::Natural)
            .with_tolerance((0.1 * tolerance.position / length).clamp(1e-12, 1e-6));
        let actuators = Actuator::of(robot, case, kind, CommandedBy::Case)?;
        let limits = goal
            .limits(robot, &actuators)
            .map_err(|mismatch| Failure::new(Status::File, mismatch.words(robot)))?;
        let solver = InverseSolver::new(&model, robot, case, &limits, CommandedBy::Case)?;
        let options = ReachOptions {
            tolerance: Some(tolerance),
            prefer: goal.preference.unwrap_or_default(),
            clearance: goal.least_clearance(),
            ..ReachOptions::default()
        };
        Ok(Self { solver, options, commands: None, file })
    }

    /// What each command is, and the number of its cable or motor.
    pub(crate) fn actuator(&self, i: usize) -> Option<(CommandKind, usize)> {
        Some(match *self.solver.actuators().get(i)? {
            Actuator::Tension(cable) => (CommandKind::Tension, cable),
            Actuator::Shortening(cable) => (CommandKind::Shortening, cable),
            Actuator::Motor(motor) => (CommandKind::Motor, motor),
        })
    }

    pub(crate) fn command_count(&self) -> usize {
        self.solver.actuators().len()
    }

    pub(crate) fn tip(&mut self, point: Vec3) -> Result<ReachResult, Failure> {
        self.target(&Target::Tip(point))
    }

    /// A pose by its seven numbers; the quaternion may have any length but zero.
    pub(crate) fn pose(&mut self, numbers: &[f64]) -> Result<ReachResult, Failure> {
        let &[x, y, z, w, a, b, c] = numbers else {
            return Err(Failure::new(
                Status::WrongLength,
                format!("a pose has {POSE} numbers: x, y, z, w, x, y, z"),
            ));
        };
        let norm = [w, a, b, c].iter().fold(0.0, |norm: f64, part| norm.hypot(*part));
        if !(norm.is_normal()) {
            return Err(Failure::new(
                Status::InvalidArgument,
                format!("the quaternion has the length {norm}: give one whose length is not zero"),
            ));
        }
        let rotation = UnitQuaternion { w: w / norm, v: Vec3::new(a / norm, b / norm, c / norm) };
        self.target(&Target::Pose(Pose { position: Vec3::new(x, y, z), rotation }))
    }

    /// The target of the file.
    pub(crate) fn target_of_file(&mut self) -> Result<ReachResult, Failure> {
        let target = self.file.goal.target.clone().ok_or_else(|| {
            Failure::new(
                Status::Unavailable,
                "the robot file has no [target]: add one, or give a tip or a pose",
            )
        })?;
        self.target(&target)
    }

    fn target(&mut self, target: &Target) -> Result<ReachResult, Failure> {
        let reached = self.solver.reach(target, &self.options)?;
        self.commands = Some(reached.commands);
        Ok(ReachResult {
            outcome: match reached.status {
                ReachStatus::Reached => ReachOutcome::Reached,
                ReachStatus::Nearest | ReachStatus::UnreachableProven => ReachOutcome::Nearest,
                ReachStatus::Undecided => ReachOutcome::Undecided,
            },
            position_miss: reached.miss.position,
            angle_miss: reached.miss.angle,
            tip: pose_values(reached.solution.disks.tip()),
            solves: reached.solves,
        })
    }

    /// The commands of the last answer.
    pub(crate) fn commands(&self) -> Result<&[f64], Failure> {
        self.commands.as_deref().ok_or_else(|| {
            Failure::new(
                Status::Unavailable,
                "there is no answer yet: give a target first, such as by whipcord_reach_tip",
            )
        })
    }
}
