//! What all models have in common, and the choice between them.

use core::fmt;
use core::str::FromStr;

use crate::case::{Case, Drive, Loads};
use crate::error::SolveError;
use crate::robot::Robot;
use crate::shape::Solution;
use crate::{cosserat, four_bar};

/// The models, by the names they have in files and on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ModelKind {
    /// Cosserat rod with continuous cables.
    Cosserat,
    /// Four-bar sections, the paper's optimisation-based model.
    FourBar,
}

impl ModelKind {
    /// All models.
    pub const ALL: [Self; 2] = [Self::Cosserat, Self::FourBar];

    /// The name in files and on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cosserat => "cosserat",
            Self::FourBar => "four-bar",
        }
    }
}

impl fmt::Display for ModelKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// No model has this name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no model `{0}`: choose cosserat or four-bar")]
pub struct UnknownModel(pub String);

impl FromStr for ModelKind {
    type Err = UnknownModel;

    fn from_str(name: &str) -> Result<Self, UnknownModel> {
        Self::ALL
            .into_iter()
            .find(|kind| kind.name() == name)
            .ok_or_else(|| UnknownModel(name.to_owned()))
    }
}

/// At which arc lengths a solution gives the shape.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Stations {
    /// At the disks.
    #[default]
    Disks,
    /// At this many equally spaced places, both ends included; at least 2.
    Equal(usize),
}

impl Stations {
    /// The arc lengths in m for a robot.
    #[must_use]
    pub fn arc_lengths(&self, robot: &Robot) -> Vec<f64> {
        match *self {
            Self::Disks => robot.disks().arc_lengths.clone(),
            Self::Equal(count) => {
                let (length, last) = (robot.backbone().length, count.max(2) - 1);
                (0..=last)
                    .map(|i| if i == last { length } else { length * i as f64 / last as f64 })
                    .collect()
            }
        }
    }
}

/// A model with its options: what solves a case of any robot.
#[derive(Clone, Debug, PartialEq)]
pub enum Model {
    /// Cosserat rod with continuous cables.
    Cosserat(cosserat::Options),
    /// Four-bar sections.
    FourBar(four_bar::Options),
}

impl Model {
    /// A model with its default options, giving the shape at these stations.
    #[must_use]
    pub fn new(kind: ModelKind, stations: Stations, drive: Drive) -> Self {
        match kind {
            ModelKind::Cosserat => {
                Self::Cosserat(cosserat::Options { stations, drive, ..Default::default() })
            }
            ModelKind::FourBar => {
                Self::FourBar(four_bar::Options { stations, drive, ..Default::default() })
            }
        }
    }

    /// Which model it is.
    #[must_use]
    pub const fn kind(&self) -> ModelKind {
        match self {
            Self::Cosserat(_) => ModelKind::Cosserat,
            Self::FourBar(_) => ModelKind::FourBar,
        }
    }
}

/// A model built for one robot, with the scratch memory of its solves: what many cases of a robot
/// are solved with.
#[derive(Clone, Debug)]
pub enum Prepared {
    /// Cosserat rod with continuous cables.
    Cosserat(Box<cosserat::Cosserat>, Box<cosserat::Workspace>),
    /// Four-bar sections.
    FourBar(Box<four_bar::FourBar>, Box<four_bar::Workspace>),
}

impl Model {
    /// The model of a robot whose cases have loads at the places of `loads`.
    ///
    /// # Errors
    /// [`SolveError`] when the model cannot take the robot.
    pub fn prepare(&self, robot: &Robot, loads: &Loads) -> Result<Prepared, SolveError> {
        Ok(match self {
            Self::Cosserat(options) => {
                let model = cosserat::Cosserat::new(robot, loads, options)?;
                Prepared::Cosserat(Box::new(model), Box::default())
            }
            Self::FourBar(options) => {
                let model = four_bar::FourBar::new(robot, options)?;
                Prepared::FourBar(Box::new(model), Box::default())
            }
        })
    }
}

impl Prepared {
    /// The shape under a case, starting from the solution of a neighbouring one when given.
    ///
    /// # Errors
    /// [`SolveError`] when the model cannot take the case or finds no answer.
    pub fn solve(
        &mut self,
        case: &Case,
        warm_start: Option<&Solution>,
    ) -> Result<Solution, SolveError> {
        match self {
            Self::Cosserat(model, workspace) => model.solve(case, warm_start, workspace),
            Self::FourBar(model, workspace) => model.solve(case, warm_start, workspace),
        }
    }
}

/// Solves one case of one robot from cold. To solve many cases of a robot, build the model once
/// ([`Model::prepare`]).
pub trait Statics {
    /// The shape the robot takes.
    ///
    /// # Errors
    /// [`SolveError`] when the model cannot take the robot or the case, or finds no answer.
    fn solve(&self, robot: &Robot, case: &Case) -> Result<Solution, SolveError>;
}

impl Statics for Model {
    fn solve(&self, robot: &Robot, case: &Case) -> Result<Solution, SolveError> {
        self.prepare(robot, &case.loads)?.solve(case, None)
    }
}
