//! The Cosserat rod with continuous cables.

use crate::case::{Case, Drive, Loads};
use crate::error::SolveError;
use crate::model::Stations;
use crate::robot::Robot;
use crate::shape::Solution;

/// How the model is discretised and driven.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Where the shape is given.
    pub stations: Stations,
    /// Which command of each cable counts.
    pub drive: Drive,
    /// How finely it integrates.
    pub accuracy: Accuracy,
    /// Whether the stability of the answer is computed.
    pub stability: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            stations: Stations::default(),
            drive: Drive::default(),
            accuracy: Accuracy::default(),
            stability: true,
        }
    }
}

/// How finely the rod is integrated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Accuracy {
    /// Steps are halved until the estimated error of every position is below this fraction of the
    /// length.
    Tolerance(f64),
    /// This many steps between each two neighbouring breakpoints (disks, stations, cable ends).
    Steps(usize),
}

impl Default for Accuracy {
    fn default() -> Self {
        Self::Tolerance(1e-8)
    }
}

/// The Cosserat model of one robot.
#[derive(Clone, Debug)]
pub struct Cosserat {}

/// Scratch memory of a solve.
#[derive(Clone, Debug, Default)]
pub struct Workspace {}

impl Cosserat {
    /// The model of a robot that may carry loads at the places of `loads`.
    ///
    /// # Errors
    /// [`SolveError::Missing`] and [`SolveError::Unsupported`] for what the model needs or cannot
    /// take.
    pub fn new(_robot: &Robot, _loads: &Loads, _options: &Options) -> Result<Self, SolveError> {
        Ok(Self {})
    }

    /// The shape under a case, starting from the solution of a neighbouring one when given.
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
