//! Benchmark of the models, as `whipcord compare` judges them. Public for the Python package, which says the same.

use std::str::FromStr;

use serde_json::Value;
use whipcord::{Cancel, Case, ModelKind, Robot, RobotError};
use whipcord_io::{Measured, NonFinite};
use whipcord_plot::PlotError;

use crate::model_benchmark::reference::Choice;
use crate::model_benchmark::results::Results;
use crate::model_benchmark::{Subject, Tags, output, picture, tables};
use crate::style::Style;
use crate::suite::{self, Suite, SuiteCase};

/// A case that models are tried on.
#[derive(Clone, Debug)]
pub struct Tried {
    /// For people.
    pub title: String,
    /// What tells it from others.
    pub name: String,
    /// The robot.
    pub robot: Robot,
    /// What is asked of it.
    pub case: Case,
    /// What the real one did.
    pub measured: Option<Measured>,
    tags: Option<Tags>,
}

/// Why models cannot be tried.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum JudgingError {
    /// What errors are to be measured against is no such thing.
    #[error("{0}")]
    Reference(String),
    /// There is no such suite.
    #[error("there is no suite `{0}`: choose routing")]
    NoSuite(String),
    /// A suite has no case of these names.
    #[error("no case of the suite has {0} in its name")]
    NoCase(String),
    /// The benchmark was ended from outside.
    #[error("the models were not tried on all cases")]
    Cancelled,
    /// A case of a suite cannot be.
    #[error(transparent)]
    Case(#[from] RobotError),
}

impl Tried {
    /// A case of one's own.
    #[must_use]
    pub fn new(title: String, robot: Robot, case: Case, measured: Option<Measured>) -> Self {
        Self { name: title.clone(), title, robot, case, measured, tags: None }
    }

    /// The cases of a suite whose names contain one of these texts; without any all of them.
    ///
    /// # Errors
    /// [`JudgingError::NoSuite`] and [`JudgingError::NoCase`].
    pub fn suite(name: &str, only: &[String]) -> Result<Vec<Self>, JudgingError> {
        let suite = Suite::named(name).ok_or_else(|| JudgingError::NoSuite(name.to_owned()))?;
        let cases = suite::only(suite.cases()?, only)
            .ok_or_else(|| JudgingError::NoCase(only.join(" or ")))?;
        let tried = |SuiteCase { stem, title, robot, case, tags }| Self {
            title,
            name: stem,
            robot,
            case,
            measured: None,
            tags: Some(tags),
        };
        Ok(cases.into_iter().map(tried).collect())
    }

    fn subject(&self) -> Subject<'_> {
        Subject {
            title: &self.title,
            stem: &self.name,
            robot: &self.robot,
            case: &self.case,
            measured: self.measured.as_ref(),
            tags: self.tags,
            known: &[],
        }
    }
}

/// How the models did.
#[derive(Clone, Debug)]
pub struct Judgement(Results);

impl Judgement {
    /// Tries these models, and those of their presets that trade accuracy for time, on all cases. `reference` is
    /// what `--reference` takes.
    ///
    /// # Errors
    /// [`JudgingError::Reference`], and [`JudgingError::Cancelled`] once the flag is set.
    pub fn new(
        cases: &[Tried],
        kinds: &[ModelKind],
        reference: &str,
        cancel: &Cancel,
    ) -> Result<Self, JudgingError> {
        let choice = Choice::from_str(reference).map_err(JudgingError::Reference)?;
        let subjects: Vec<Subject<'_>> = cases.iter().map(Tried::subject).collect();
        let results = Results::of(&subjects, kinds, choice, cancel, |_| ());
        if cancel.is_cancelled() {
            return Err(JudgingError::Cancelled);
        }
        Ok(Self(results))
    }

    /// All of it as the JSON object that `whipcord compare --json` prints.
    ///
    /// # Errors
    /// [`NonFinite`] with the place of a number that is not finite.
    pub fn json(&self) -> Result<Value, NonFinite> {
        output::json(&self.0)
    }

    /// The tables, notes and recommendation that `whipcord compare` prints.
    #[must_use]
    pub fn text(&self) -> String {
        tables::text(&self.0, false, Style::default())
    }

    /// Error against time as an SVG; `None` where no model has an error.
    ///
    /// # Errors
    /// [`PlotError`] when it cannot be drawn.
    pub fn svg(&self) -> Result<Option<String>, PlotError> {
        picture::pareto("Error against time", &self.0)
    }
}
