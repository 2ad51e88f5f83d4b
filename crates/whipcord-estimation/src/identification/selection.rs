//! The same measurements fitted by several models.

use super::error::IdentifyError;
use super::experiment::{Experiment, Unknown};
use super::identify::identify;
use super::outcome::Identified;
use super::settings::Settings;
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
}

/// Fits the same measurements by each model.
pub fn compare_models(
    robot: &Robot,
    experiments: &[Experiment],
    unknowns: &[Unknown],
    models: &[Model],
    settings: &Settings,
) -> Vec<Compared> {
    let fit = |model: &Model| {
        let settings = Settings { model: model.clone(), ..settings.clone() };
        let fit = identify(robot, experiments, unknowns, &settings);
        Compared { model: model.kind(), fit, aic_above_best: None, bic_above_best: None }
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
