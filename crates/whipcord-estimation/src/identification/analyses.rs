//! What is said of a fit besides its estimates, all at once.

use super::drift::{Drift, drift};
use super::error::IdentifyError;
use super::experiment::{Experiment, Unknown};
use super::linear::values;
use super::outcome::Identified;
use super::profile::{Profile, profile};
use super::repeatability::{Repeatability, repeatability};
use super::selection::{Compared, Rung, compare_models, ladder};
use super::sensitivity::{Worth, sensitivity};
use super::settings::Settings;
use super::suspects::{Suspect, suspects};
use super::validation::{HeldOut, Validated, cross_validate, hold_out};
use crate::registration::Alignment;
use whipcord::model::Model;
use whipcord::robot::Robot;

/// What is asked about a fit besides what one more evaluation tells.
#[derive(Clone, Debug, Default)]
pub struct Asked {
    /// Cross-validation, of the other models too.
    pub cross_validates: bool,
    /// Models that the same measurements are fitted by.
    pub models: Vec<Model>,
    /// The ladder of models with more and more unknowns.
    pub climbs: bool,
    /// The profile likelihood of each unknown.
    pub profiles: bool,
    /// Measurements that were not fitted, of the same robot; and whether they are other steps of the experiments that were, so
    /// that the unknowns of single experiments hold for them.
    pub test: Option<(Vec<Experiment>, bool)>,
}

/// What is said of a fit.
#[derive(Clone, Debug, Default)]
pub struct Analyses {
    /// How far off it is where parts were held out in turn.
    pub validated: Option<Validated>,
    /// The fits of other models.
    pub compared: Vec<Compared>,
    /// The ladder.
    pub ladder: Vec<Rung>,
    /// Profile likelihoods.
    pub profiles: Vec<Profile>,
    /// How far off it is from the measurements that were not fitted.
    pub test: Option<HeldOut>,
    /// The zeros and angles of single cables, the one that would take most away first.
    pub suspects: Vec<Suspect>,
    /// How far the robot is from itself.
    pub repeatability: Option<Repeatability>,
    /// How what is left changes with time.
    pub drift: Option<Drift>,
    /// What one more measurement would be worth.
    pub worths: Vec<Worth>,
}

/// Measurements that are not fitted, in the frame of those that are where all have one: its turn is counted from where the fit found
/// it at the start.
fn in_frame_of(
    experiments: &[Experiment],
    test: &[Experiment],
    unknowns: &[Unknown],
) -> Vec<Experiment> {
    let mut test = test.to_vec();
    let shared = unknowns.iter().any(|unknown| unknown.quantity.is_of_frame());
    let known = experiments.iter().find(|of| of.alignment != Alignment::None).filter(|_| shared);
    if let Some(known) = known {
        test.iter_mut().for_each(|of| of.frame = known.frame);
    }
    test
}

/// Answers all of it. Only what is asked for is fitted again, and a cable that stands out.
///
/// # Errors
/// As [`cross_validate`], [`ladder`], [`profile`] and [`hold_out`].
pub fn analyse(
    robot: &Robot,
    experiments: &[Experiment],
    unknowns: &[Unknown],
    settings: &Settings,
    found: &Identified,
    asked: &Asked,
) -> Result<Analyses, IdentifyError> {
    let settings = &Settings { starts: 1, ..settings.clone() };
    // What leaves out a part ends near the estimate of the whole.
    let near =
        |(unknown, value): (&Unknown, f64)| Unknown { start: Some(value), ..unknown.clone() };
    let started: Vec<Unknown> = unknowns.iter().zip(values(found)).map(near).collect();
    let validated = match asked.cross_validates {
        true => Some(cross_validate(robot, experiments, &started, settings)?),
        false => None,
    };
    let compared = match asked.models.is_empty() {
        true => Vec::new(),
        false => {
            let validates = asked.cross_validates;
            compare_models(robot, experiments, unknowns, &asked.models, settings, validates)
        }
    };
    let ladder = match asked.climbs {
        true => ladder(robot, experiments, &started, settings)?,
        false => Vec::new(),
    };
    let mut profiles = Vec::new();
    for unknown in (0..unknowns.len()).filter(|_| asked.profiles) {
        profiles.push(profile(robot, experiments, unknowns, settings, found, unknown)?);
    }
    let test = match &asked.test {
        Some((test, is_part)) => {
            let values = values(found);
            let known = unknowns.iter().zip(values);
            let known = known.filter(|(unknown, _)| *is_part || unknown.experiment.is_none());
            let (unknowns, values): (Vec<Unknown>, Vec<f64>) =
                known.map(|(unknown, value)| (unknown.clone(), value)).unzip();
            let test = match is_part {
                true => test.clone(),
                false => in_frame_of(experiments, test, &unknowns),
            };
            Some(hold_out(robot, &test, &unknowns, settings, &values)?)
        }
        None => None,
    };
    // What cannot be had without an answer is left out.
    let or_cancelled = |error: IdentifyError| match error {
        IdentifyError::Cancelled => Err(error),
        _ => Ok(()),
    };
    let suspects = match suspects(robot, experiments, unknowns, settings, found) {
        Ok(suspects) => suspects,
        Err(error) => or_cancelled(error).map(|()| Vec::new())?,
    };
    let is_exact = found.estimates.iter().all(|estimate| !estimate.by_differences);
    let worths = match is_exact {
        true => sensitivity(robot, experiments, unknowns, settings, found),
        // Differences of many answers would take longer than the fit.
        false => Ok(Vec::new()),
    };
    let worths = match worths {
        Ok(worths) => worths,
        Err(error) => or_cancelled(error).map(|()| Vec::new())?,
    };
    if settings.model.cancel().is_cancelled() {
        return Err(IdentifyError::Cancelled);
    }
    Ok(Analyses {
        validated,
        compared,
        ladder,
        profiles,
        test,
        suspects,
        repeatability: repeatability(experiments, found),
        drift: drift(experiments, found),
        worths,
    })
}
