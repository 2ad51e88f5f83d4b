//! Commands that lead a robot along a path of targets.

use whipcord::{Solution, SolveError};

use crate::error::{InverseError, TargetProblem};
use crate::foresight::Passed;
use crate::options::{Preference, ReachOptions, ReachStatus};
use crate::reach::Reached;
use crate::search::Candidate;
use crate::solver::{InverseSolver, Ranges};
use crate::target::Target;

/// A target that is to be reached at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct PathPoint {
    /// Time in s.
    pub time: f64,
    /// What is to be reached.
    pub target: Target,
}

/// A robot that follows a path.
#[derive(Clone, Debug)]
pub struct Followed {
    /// The answer at each point.
    pub answers: Vec<Reached>,
    /// Where the robot does not move smoothly from the point before.
    pub jumps: Vec<Jump>,
}

/// A place of a path where the robot does not move smoothly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jump {
    /// The point that it leads to, from 0.
    pub point: usize,
    /// Its kind.
    pub kind: JumpKind,
    /// By how much the disk that moves most is elsewhere than the derivatives at the point before foretell, in m.
    pub distance: f64,
}

/// Why a robot does not move smoothly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JumpKind {
    /// The target is reached by commands that are not near to those before.
    Commands,
    /// The robot snaps into another shape under commands that are near to those before.
    Shape,
}

impl JumpKind {
    /// As in JSON.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Commands => "commands",
            Self::Shape => "shape",
        }
    }
}

impl Followed {
    /// How many points are reached.
    #[must_use]
    pub fn reached(&self) -> usize {
        self.answers.iter().filter(|answer| answer.status == ReachStatus::Reached).count()
    }
}

/// A motion is a jump where it differs from what is foretold by this part of itself, and by this part of the length.
const UNFORETOLD: f64 = 0.5;
const LEAST_JUMP: f64 = 0.02;

impl InverseSolver {
    /// Commands for each point of a path: each from the commands and the shape of the point before, within the limits of
    /// the rates. The first point is reached from the commands of the case, without a limit of rates, and by the preferred commands. At the points after it
    /// [`Preference::LeastTension`] and [`Preference::MostClearance`] lead along the null space as far as the rates let them;
    /// the other preferences keep near to the point before.
    ///
    /// A point that is not reached has the nearest commands that were found, and the next one starts from there.
    ///
    /// # Errors
    /// As [`Self::reach`], and [`InverseError::Target`] where times do not ascend.
    pub fn follow(
        &mut self,
        path: &[PathPoint],
        options: &ReachOptions,
    ) -> Result<Followed, InverseError> {
        if path.is_empty() {
            return Err(InverseError::Target(TargetProblem::NoPoints));
        }
        for (number, pair) in path.windows(2).enumerate() {
            let step = pair[1].time - pair[0].time;
            if !step.is_finite() || step <= 0.0 {
                return Err(InverseError::Target(TargetProblem::Times { point: number + 2 }));
            }
        }
        let standing = self.forward().standing();
        let followed = self.go_along(path, options);
        self.forward_mut().return_to(standing);
        followed
    }

    fn go_along(
        &mut self,
        path: &[PathPoint],
        options: &ReachOptions,
    ) -> Result<Followed, InverseError> {
        let later = match options.prefer {
            Preference::LeastChange => Preference::First,
            other => other,
        };
        let mut followed = Followed { answers: Vec::with_capacity(path.len()), jumps: Vec::new() };
        let mut last: Option<Passed> = None;
        let start = self.commanded();
        let all = self.ranges().clone();
        for (number, point) in path.iter().enumerate() {
            let (answer, passed) = match &last {
                None => self.reach_from(&start, None, &all, &point.target, options)?,
                Some(passed) => {
                    let seconds = point.time - path[number - 1].time;
                    let Candidate { unknowns, evaluation, .. } = &passed.at;
                    let ranges = self.ranges_after(unknowns, &evaluation.solution, seconds);
                    let options = ReachOptions { prefer: later, ..*options };
                    self.reach_from(unknowns, Some(passed), &ranges, &point.target, &options)?
                }
            };
            let unknowns = &passed.at.unknowns;
            if let Some(Passed { at: before, .. }) = &last {
                let shape = &before.evaluation.solution;
                let before = &before.unknowns;
                let distance = self.unforetold(before, shape, unknowns, &answer.solution)?;
                if let Some(distance) = distance {
                    let is_near = answer.starts == 1;
                    let kind = if is_near { JumpKind::Shape } else { JumpKind::Commands };
                    followed.jumps.push(Jump { point: number, kind, distance });
                }
            }
            self.forward_mut().move_on(unknowns, &answer.solution);
            last = Some(passed);
            followed.answers.push(answer);
        }
        Ok(followed)
    }

    /// What may be so many seconds after an answer.
    fn ranges_after(&self, unknowns: &[f64], solution: &Solution, seconds: f64) -> Ranges {
        let forward = self.forward();
        let robot = forward.robot();
        let mut ranges = self.ranges().clone();
        let values = forward.values(unknowns, solution);
        for ((actuator, [least, greatest]), x) in
            self.actuators().iter().zip(&mut ranges.values).zip(values)
        {
            if let Some(rate) = actuator.rate_limit(robot, self.limits()) {
                *least = least.max(x - rate * seconds);
                *greatest = greatest.min(x + rate * seconds);
            }
        }
        if forward.actuators.are_direct() {
            ranges.unknowns.clone_from(&ranges.values);
        }
        ranges
    }

    /// By how much the disk that is farthest from where the derivatives foretell it is from there, where that is a jump.
    fn unforetold(
        &mut self,
        before: &[f64],
        shape: &Solution,
        after: &[f64],
        solution: &Solution,
    ) -> Result<Option<f64>, InverseError> {
        let length = self.forward().robot().backbone().length;
        let places: Vec<_> =
            (0..shape.disks.poses.len()).map(whipcord::derivatives::Place::Disk).collect();
        let moved =
            |disk: usize| solution.disks.poses[disk].position - shape.disks.poses[disk].position;
        let largest = (0..places.len()).map(|disk| moved(disk).norm()).fold(0.0, f64::max);
        if largest < LEAST_JUMP * length {
            return Ok(None);
        }
        let evaluation = match self.forward_mut().evaluate(before, &places, Some(shape)) {
            Ok(evaluation) => evaluation,
            Err(error @ SolveError::Cancelled { .. }) => return Err(error.into()),
            Err(_) => return Ok(None),
        };
        let mut off = 0.0_f64;
        for disk in 0..places.len() {
            let mut difference = moved(disk);
            for (motions, (x, y)) in evaluation.rates.motions.iter().zip(after.iter().zip(before)) {
                difference -= motions[disk].linear * (x - y);
            }
            off = off.max(difference.norm());
        }
        Ok(Some(off).filter(|off| *off > UNFORETOLD * largest && *off > LEAST_JUMP * length))
    }
}
