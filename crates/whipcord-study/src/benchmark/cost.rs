//! Solve time against number of sections.

use std::hint::black_box;

use whipcord::{Actuation, Model, ModelKind, SolveError, Statics as _, Stations};

use super::Samples;
use thiserror::Error;

use super::paper::Example;
use crate::model_benchmark::candidate::step_per_section;
use crate::resample::resample;
use crate::statistics::Line;

/// Numbers of sections: six from 5 to 320, about equally far apart on a logarithmic axis.
pub const SECTIONS: [usize; 6] = [5, 10, 20, 50, 125, 320];

/// One model on one routing with one number of sections.
#[derive(Clone, Debug)]
pub struct Cost {
    /// Which model.
    pub model: ModelKind,
    /// Which of the examples.
    pub example: usize,
    /// Number of sections, which is the Cosserat model's number of steps.
    pub sections: usize,
    /// Seconds per solve, or why there is none.
    pub samples: Result<Samples, Untimed>,
}

/// Why there is no time, in the terms of the robot as its file has it.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Untimed {
    /// The model does not solve the robot at all.
    #[error("{0}")]
    Robot(SolveError),
    /// The model does not solve the robot with this number of sections.
    #[error("{model}: not timed with every number of sections: {reason}")]
    Sections {
        /// The model.
        model: ModelKind,
        /// Why.
        reason: String,
    },
}

/// The model as the paper times it.
fn model(kind: ModelKind, sections: usize) -> Model {
    step_per_section(Model::new(kind, Stations::Disks, Actuation::Natural), sections)
}

/// Why a model does not solve an example as it is; then it is not to be cut into other sections.
pub fn refusal(kind: ModelKind, example: &Example) -> Option<SolveError> {
    let model = Model::new(kind, Stations::Disks, Actuation::Natural);
    model.solve(&example.robot, &example.case).err()
}

/// Measures one model on one example.
pub fn cost(kind: ModelKind, example: usize, examples: &[Example], sections: usize) -> Cost {
    let Example { robot, case, .. } = &examples[example];
    if let Some(error) = refusal(kind, &examples[example]) {
        return Cost { model: kind, example, sections, samples: Err(Untimed::Robot(error)) };
    }
    let untimed = |reason| Untimed::Sections { model: kind, reason };
    let samples =
        resample(robot, sections).map_err(|error| untimed(error.to_string())).and_then(|robot| {
            let words = |error: SolveError| untimed(error.to_string());
            let mut model = model(kind, sections).prepare(&robot, &case.loads).map_err(words)?;
            model.solve(case, None).map_err(words)?;
            Ok(Samples::take(|| {
                // It has just been solved, and a solve is deterministic.
                let _ = black_box(model.solve(black_box(case), None));
            }))
        });
    Cost { model: kind, example, sections, samples }
}

/// All measurements of one model with one number of sections, on one example or on all of them.
pub fn pooled(
    costs: &[Cost],
    model: ModelKind,
    example: Option<usize>,
    sections: usize,
) -> Samples {
    let times = costs
        .iter()
        .filter(|cost| cost.model == model && cost.sections == sections)
        .filter(|cost| example.is_none_or(|example| cost.example == example))
        .filter_map(|cost| cost.samples.as_ref().ok())
        .flat_map(|samples| samples.times.iter().copied())
        .collect();
    Samples { times }
}

/// The line through the mean solve time of a model at each number of sections, on one example or on
/// all of them.
pub fn fitted_line(costs: &[Cost], model: ModelKind, example: Option<usize>) -> Option<Line> {
    let points: Vec<_> = SECTIONS
        .into_iter()
        .map(|sections| (sections as f64, pooled(costs, model, example, sections)))
        .filter(|(_, samples)| !samples.times.is_empty())
        .map(|(sections, samples)| (sections, samples.mean()))
        .collect();
    Line::through(&points)
}
