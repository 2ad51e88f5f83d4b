//! Solve time against number of sections.

use std::hint::black_box;

use whipcord::cosserat::{self, Accuracy};
use whipcord::{Model, ModelKind, SolveError, four_bar};

use super::Samples;
use super::paper::Example;
use super::resample::resample;
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
    pub samples: Result<Samples, SolveError>,
}

/// The model as the paper times it: one integration step for each section of the Cosserat rod, and
/// nothing computed that the shape does not need.
fn model(kind: ModelKind, sections: usize) -> Model {
    match kind {
        ModelKind::Cosserat => Model::Cosserat(cosserat::Options {
            accuracy: Accuracy::Steps(sections),
            stability: false,
            ..Default::default()
        }),
        ModelKind::FourBar => Model::FourBar(four_bar::Options::default()),
    }
}

/// Measures one model on one example.
pub fn cost(kind: ModelKind, example: usize, examples: &[Example], sections: usize) -> Cost {
    let Example { robot, case, .. } = &examples[example];
    let samples = resample(robot, sections).map_err(SolveError::from).and_then(|robot| {
        let mut model = model(kind, sections).prepare(&robot, &case.loads)?;
        model.solve(case, None)?;
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
