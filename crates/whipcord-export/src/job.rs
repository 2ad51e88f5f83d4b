//! What is exported.

use whipcord::{Case, Model, Robot, Stations};
use whipcord_motion::Damping;

use crate::answers::Answers;
use crate::error::ExportError;
use crate::places::places;

/// What is exported: a robot under a case, in the shape that a model gives it.
#[derive(Clone, Copy, Debug)]
pub struct Job<'a> {
    /// What it is called.
    pub title: &'a str,
    /// The robot.
    pub robot: &'a Robot,
    /// Commands, loads and obstacles.
    pub case: &'a Case,
    /// The model whose shape is exported. Where its cables run also decides where those of the export are guided.
    pub model: &'a Model,
    /// Damping of the backbone.
    pub damping: &'a Damping,
    /// Bodies or pieces of curves for each span between two disks; the format's own number where it is not given.
    pub per_span: Option<usize>,
}

/// Bodies for each span where no number is given: `MuJoCo` then has eleven of the twelve robots of `docs/export.md` within 0.5 % of their length.
const BODIES: usize = 4;
/// Pieces of curves for each span where no number is given.
const PIECES: usize = 8;
/// Most points along a backbone.
const MOST_PLACES: usize = 100_000;

impl Job<'_> {
    /// Places of the bodies of a chain.
    ///
    /// # Errors
    /// [`ExportError::TooManyBodies`] for more of them than `most`.
    pub(crate) fn body_places(
        &self,
        format: &'static str,
        most: usize,
    ) -> Result<Vec<f64>, ExportError> {
        self.places(format, self.per_span.unwrap_or(BODIES), most)
    }

    /// Places of the points of curves.
    ///
    /// # Errors
    /// [`ExportError::TooManyBodies`] for more of them than anybody draws.
    pub(crate) fn curve_places(&self, format: &'static str) -> Result<Vec<f64>, ExportError> {
        self.places(format, self.per_span.unwrap_or(PIECES), MOST_PLACES)
    }

    fn places(
        &self,
        format: &'static str,
        per_span: usize,
        most: usize,
    ) -> Result<Vec<f64>, ExportError> {
        let too_many = |given| ExportError::TooManyBodies { format, given, most, per_span };
        let least = self.robot.disks().count().saturating_sub(1).saturating_mul(per_span);
        if least > most {
            return Err(too_many(least));
        }
        let places = places(self.robot, self.case, per_span.max(1));
        if places.len() > most { Err(too_many(places.len())) } else { Ok(places) }
    }

    /// The answers to all steps of the case with their shapes at these arc lengths in m.
    ///
    /// # Errors
    /// [`ExportError::Solve`] for the first step without an answer.
    pub(crate) fn solve(&self, places: &[f64]) -> Result<Answers, ExportError> {
        let failed = |step, error| ExportError::Solve { step, error };
        let model = self.model.at(Stations::At(places.to_vec()));
        let mut prepared =
            model.prepare(self.robot, &self.case.loads).map_err(|error| failed(0, error))?;
        let mut steps = Vec::new();
        prepared
            .solve_steps(self.case, |solution| steps.push(solution))
            .map_err(|(step, error)| failed(step, error))?;
        Ok(Answers { steps, cases: self.case.single_steps().collect() })
    }
}
