//! The same measurements fitted by several models.

use super::error::IdentifyError;
use super::experiment::{Experiment, Unknown};
use super::identify::identify;
use super::outcome::Identified;
use super::settings::Settings;
use super::validation::{Validated, cross_validate, hold_out};
use whipcord::kind::ModelKind;
use whipcord::model::Model;
use whipcord::robot::Robot;

/// A model's fit among others.
#[derive(Clone, Debug)]
pub struct Compared {
    /// The model.
    pub model: ModelKind,
    /// Its fit, or why it has none.
    pub fit: Result<Identified, IdentifyError>,
    /// By how much Akaike's criterion is above that of the best.
    pub aic_above_best: Option<f64>,
    /// By how much the Bayesian criterion is above that of the best.
    pub bic_above_best: Option<f64>,
    /// How far off it is where it was held out, where that was asked for and possible.
    pub validated: Option<Validated>,
}

/// The first unknowns of a list, fitted without those after them.
#[derive(Clone, Debug)]
pub struct Rung {
    /// How many unknowns there are: none on the first rung, where robot and case are as they were given.
    pub unknowns: usize,
    /// Root mean square distance in m of the fit.
    pub rms_distance: Option<f64>,
    /// The same in pixels.
    pub rms_pixels: Option<f64>,
    /// Cross-validation; none on the first rung, whose distance is that of what it has not seen.
    pub validated: Option<Validated>,
}

/// The ladder of models with more and more unknowns, in their order, each with its error of what it has not seen.
///
/// # Errors
/// As [`cross_validate`].
pub fn ladder(
    robot: &Robot,
    experiments: &[Experiment],
    unknowns: &[Unknown],
    settings: &Settings,
) -> Result<Vec<Rung>, IdentifyError> {
    let plain = hold_out(robot, experiments, &[], settings, &[])?;
    let mut rungs = vec![Rung {
        unknowns: 0,
        rms_distance: plain.rms_distance,
        rms_pixels: plain.rms_pixels,
        validated: None,
    }];
    // The frames of measurements are no rungs: every one has them.
    let (frames, rungs_of): (Vec<Unknown>, Vec<Unknown>) =
        unknowns.iter().cloned().partition(|unknown| unknown.quantity.is_of_frame());
    for count in 1..=rungs_of.len() {
        let own: Vec<Unknown> = rungs_of[..count].iter().chain(&frames).cloned().collect();
        let own = &own[..];
        let found = identify(robot, experiments, own, settings)?;
        rungs.push(Rung {
            unknowns: count,
            rms_distance: found.rms_distance,
            rms_pixels: found.rms_pixels,
            validated: Some(cross_validate(robot, experiments, own, settings)?),
        });
    }
    Ok(rungs)
}

/// Fits the same measurements by each model, and holds out parts of them where that is asked for.
pub fn compare_models(
    robot: &Robot,
    experiments: &[Experiment],
    unknowns: &[Unknown],
    models: &[Model],
    settings: &Settings,
    validates: bool,
) -> Vec<Compared> {
    let fit = |model: &Model| {
        let settings = Settings { model: model.clone(), ..settings.clone() };
        let fit = identify(robot, experiments, unknowns, &settings);
        let is_fitted = fit.as_ref().is_ok_and(|fit| fit.status.is_converged());
        let validated = (validates && is_fitted)
            .then(|| cross_validate(robot, experiments, unknowns, &settings).ok())
            .flatten();
        let (aic_above_best, bic_above_best) = (None, None);
        Compared { model: model.kind(), fit, aic_above_best, bic_above_best, validated }
    };
    let mut all: Vec<Compared> = models.iter().map(fit).collect();
    let least = |of: fn(&Identified) -> Option<f64>| {
        all.iter().filter_map(|each| of(each.fit.as_ref().ok()?)).min_by(f64::total_cmp)
    };
    let (aic, bic) = (least(|fit| fit.aic), least(|fit| fit.bic));
    for each in &mut all {
        if let Ok(fit) = &each.fit {
            each.aic_above_best = fit.aic.zip(aic).map(|(own, best)| own - best);
            each.bic_above_best = fit.bic.zip(bic).map(|(own, best)| own - best);
        }
    }
    all
}
