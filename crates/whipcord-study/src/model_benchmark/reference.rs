//! What errors are measured against: a model that is believed, or what the real robot did.

use core::fmt;
use core::str::FromStr;

use whipcord::{Actuation, Cancel, Model, ModelKind, Routing, Solution, SolveError, Stations};
use whipcord_estimation::observation::{Apart, distances, in_space};

use super::{Residual, Subject};
use crate::model_benchmark::candidate::fine;
use crate::statistics::root_mean_square;
use crate::steps::rms_distance;

/// What a user wants errors to be measured against.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Choice {
    /// What was measured in space; without that, by `trusted`, the first model that has an answer.
    #[default]
    Trusted,
    /// What was measured.
    Measured,
    /// A model.
    Model {
        /// Which.
        kind: ModelKind,
        /// Whether at fine resolution.
        fine: bool,
    },
}

impl FromStr for Choice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "trusted" => return Ok(Self::Trusted),
            "measured" => return Ok(Self::Measured),
            _ => {}
        }
        let (name, is_fine) = match text.split_once(':') {
            None => (text, false),
            Some((name, "fine")) => (name, true),
            Some((_, other)) => return Err(format!("`:{other}` says nothing: `:fine` does")),
        };
        let kind: ModelKind = name.parse().map_err(|error| format!("{error}, or measured"))?;
        if is_fine && fine(kind).is_none() {
            return Err(format!("{kind} has no resolution to refine: leave out `:fine`"));
        }
        Ok(Self::Model { kind, fine: is_fine })
    }
}

/// With more sections than this, a cable from hole to hole is as good as a continuous one: the two are
/// 1.7 % of the length apart at the paper's 9 sections, less by the square of their number, and so by 10⁻⁴ here.
const FEW_SECTIONS: usize = 100;

/// What is measured against.
#[derive(Clone, Debug)]
pub struct ReferenceAnswers {
    /// In words.
    pub name: String,
    /// The model; `None` for a measurement.
    pub kind: Option<ModelKind>,
    /// Its own estimate of its error in m: of the model how far its answer is from the exact one of its
    /// equations, of a measurement the standard deviation of a coordinate, where it is given.
    pub uncertainty: Option<f64>,
    /// The model's answers to all steps; none of a measurement.
    pub answers: Vec<Solution>,
}

/// Why there is nothing to measure against.
#[derive(Clone, Debug)]
pub struct NoReference(Vec<(String, Option<SolveError>)>);

impl fmt::Display for NoReference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, (name, error)) in self.0.iter().enumerate() {
            let separator = if i > 0 { "; " } else { "" };
            match error {
                Some(error) => write!(f, "{separator}{name}: {error}")?,
                None => write!(f, "{separator}{name}: there is nothing in space in the file")?,
            }
        }
        Ok(())
    }
}

impl ReferenceAnswers {
    /// What a case is measured against; the flag ends the solve.
    ///
    /// # Errors
    /// [`NoReference`] when nothing was measured, or the model has no answer.
    pub fn new(subject: &Subject, choice: Choice, cancel: &Cancel) -> Result<Self, NoReference> {
        let measured = || measured(subject);
        match choice {
            Choice::Measured => {
                measured().ok_or_else(|| NoReference(vec![("measured".into(), None)]))
            }
            Choice::Model { kind, fine } => solved(subject, kind, fine, cancel)
                .map_err(|(name, e)| NoReference(vec![(name, Some(e))])),
            Choice::Trusted => measured().map_or_else(|| trusted(subject, cancel), Ok),
        }
    }

    /// How far the answers to all steps are from it.
    ///
    /// # Errors
    /// Why the two cannot be compared, in words.
    pub fn residual(&self, subject: &Subject, answers: &[Solution]) -> Result<Residual, String> {
        if !self.answers.is_empty() {
            let pairs = || answers.iter().zip(&self.answers);
            let distances =
                pairs().flat_map(|(answer, truth)| answer.disks.distances(&truth.disks));
            let tips =
                pairs().filter_map(|(answer, truth)| answer.disks.distances(&truth.disks).last());
            let steps = pairs().count();
            return Ok(Residual {
                rms: rms_distance(answers, &self.answers),
                greatest: distances.fold(0.0, f64::max),
                tip: root_mean_square(tips),
                steps,
                points: steps * subject.sections(),
            });
        }
        let nothing = || "nothing was measured in space".to_owned();
        let measured = subject.measured.ok_or_else(nothing)?;
        let (robot, case) = (subject.robot, subject.case);
        let (seen, alignment) = (&measured.observations, measured.alignment);
        let answers: Vec<&Solution> = answers.iter().collect();
        let kind = answers.first().ok_or_else(nothing)?.model;
        let apart = distances(kind, robot, case, &answers, seen, alignment)
            .map_err(|error| error.to_string())?
            .ok_or_else(nothing)?;
        let rms = apart.rms().ok_or_else(|| "only the base was measured".to_owned())?;
        Ok(Residual {
            rms,
            greatest: apart.moving().map(Apart::distance).fold(0.0, f64::max),
            tip: apart.rms_of_disk(robot.disks().count()),
            steps: apart.steps(),
            points: apart.moving().count(),
        })
    }
}

fn measured(subject: &Subject) -> Option<ReferenceAnswers> {
    let measured = subject.measured?;
    in_space(&measured.observations).next().is_some().then(|| ReferenceAnswers {
        name: "what was measured".to_owned(),
        kind: None,
        uncertainty: measured.deviation,
        answers: Vec::new(),
    })
}

/// The rod whose cables run as the real ones do: straight from hole to hole, where the file gives the holes
/// and there are few enough sections for it to matter; else the rod with continuous cables. At fine
/// resolution; where that gives no answer, as it is; and then the other rod.
fn trusted(subject: &Subject, cancel: &Cancel) -> Result<ReferenceAnswers, NoReference> {
    let robot = subject.robot;
    // Robots of a suite are like real ones, whose files list their holes.
    let through_holes = subject.tags.is_some()
        || robot.cables().iter().any(|cable| matches!(cable.routing, Routing::Holes { .. }));
    let kinds = if through_holes && subject.sections() <= FEW_SECTIONS {
        [ModelKind::CosseratDisks, ModelKind::Cosserat]
    } else {
        [ModelKind::Cosserat, ModelKind::CosseratDisks]
    };
    let mut refusals = Vec::new();
    for kind in kinds {
        for fine in [true, false] {
            match solved(subject, kind, fine, cancel) {
                Ok(reference) => return Ok(reference),
                // The same refusal twice says nothing more.
                Err((name, error)) if !fine => refusals.push((name, Some(error))),
                Err(_) => {}
            }
        }
    }
    Err(NoReference(refusals))
}

fn solved(
    subject: &Subject,
    kind: ModelKind,
    is_fine: bool,
    cancel: &Cancel,
) -> Result<ReferenceAnswers, (String, SolveError)> {
    let name = if is_fine { format!("{kind} at fine resolution") } else { kind.to_string() };
    let model = fine(kind)
        .filter(|_| is_fine)
        .unwrap_or_else(|| Model::new(kind, Stations::Disks, Actuation::Natural))
        .cancelled_by(cancel);
    let solved = model
        .prepare(subject.robot, &subject.case.loads)
        .and_then(|mut model| model.solve_all(subject.case).map_err(|(_, error)| error));
    match solved {
        Err(error) => Err((name, error)),
        Ok(answers) => {
            let length = subject.robot.backbone().length;
            let of = |Solution { diagnostics, .. }: &Solution| {
                diagnostics.discretization_error.unwrap_or(0.0) + diagnostics.residual * length
            };
            let uncertainty = Some(answers.iter().map(of).fold(0.0, f64::max));
            Ok(ReferenceAnswers { name, kind: Some(kind), uncertainty, answers })
        }
    }
}
