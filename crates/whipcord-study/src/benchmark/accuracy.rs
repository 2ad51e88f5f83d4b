//! Error of the Cosserat model against the number of its integration steps.

use std::hint::black_box;

use whipcord::cosserat::{self, Accuracy};
use whipcord::{Model, SolveError, StabilityAnalysis, Statics};

use super::Samples;
use super::paper::Example;

/// Integration steps in each section of the robot. Beyond these there is nothing but rounding.
const STEPS_PER_SECTION: [usize; 4] = [1, 2, 4, 8];

/// Steps per section of the solution that the others are compared with.
const REFERENCE_STEPS: usize = 64;

/// One example with one number of steps.
#[derive(Clone, Debug)]
pub struct StepError {
    /// Which of the examples.
    pub example: usize,
    /// Steps from base to tip.
    pub steps: usize,
    /// Greatest distance of a disk from where it is in the converged solution, relative to the
    /// backbone's length.
    pub error: f64,
    /// Seconds per solve.
    pub samples: Samples,
}

/// Errors and times of one example for each of `STEPS_PER_SECTION`.
///
/// # Errors
/// [`SolveError`] when the Cosserat model has no answer.
pub fn step_errors(example: usize, examples: &[Example]) -> Result<Vec<StepError>, SolveError> {
    let Example { robot, case, .. } = &examples[example];
    let sections = robot.disks().count() - 1;
    let model = |steps_per_section: usize| {
        Model::Cosserat(cosserat::Options {
            accuracy: Accuracy::Steps(steps_per_section * sections),
            stability: StabilityAnalysis::Off,
            ..Default::default()
        })
    };
    let reference = model(REFERENCE_STEPS).solve(robot, case)?;
    STEPS_PER_SECTION
        .into_iter()
        .map(|steps_per_section| {
            let mut model = model(steps_per_section).prepare(robot, &case.loads)?;
            let solution = model.solve(case, None)?;
            let distance = solution.disks.distances(&reference.disks).fold(0.0, f64::max);
            let samples = Samples::take(|| {
                // It has just been solved, and a solve is deterministic.
                let _ = black_box(model.solve(black_box(case), None));
            });
            let error = distance / robot.backbone().length;
            Ok(StepError { example, steps: solution.diagnostics.steps, error, samples })
        })
        .collect()
}
