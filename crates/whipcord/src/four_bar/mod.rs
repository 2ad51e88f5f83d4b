//! The paper's geometric model: one four-bar section between each two disks.

use crate::case::{Case, Drive};
use crate::error::SolveError;
use crate::model::Stations;
use crate::robot::Robot;
use crate::shape::Solution;

/// What is minimised, and how lengths are shared out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// Where the shape is given.
    pub stations: Stations,
    /// Which command of each cable counts.
    pub drive: Drive,
}

/// The four-bar model of one robot.
#[derive(Clone, Debug)]
pub struct FourBar {}

/// Scratch memory of a solve.
#[derive(Clone, Debug, Default)]
pub struct Workspace {}

impl FourBar {
    /// The model of a robot.
    ///
    /// # Errors
    /// [`SolveError::Unsupported`] for what a geometric model cannot take.
    pub fn new(_robot: &Robot, _options: &Options) -> Result<Self, SolveError> {
        Ok(Self {})
    }

    /// The shape under a case.
    ///
    /// # Errors
    /// [`SolveError`] with the reason why there is no answer.
    pub fn solve(
        &self,
        _case: &Case,
        _warm_start: Option<&Solution>,
        _workspace: &mut Workspace,
    ) -> Result<Solution, SolveError> {
        unimplemented!()
    }
}
