use serde_json::{Value, json};
use whipcord_estimation::identification::{Analyses, Identified, Robustness, Status, Validated};

use super::NonFinite;
use super::fit_analyses::{over_determined_json, rows_json, said};
use super::json::{number, numbers, optional};

/// What was identified, as the JSON object that `whipcord fit --json` prints; SI, and pixels. `names` are
/// those of the experiments, `test_names` those of the ones that were not fitted, `warnings` what a reader should know besides.
///
/// # Errors
/// [`NonFinite`] with the place of a number that is not finite.
pub fn fit_json(
    found: &Identified,
    names: &[String],
    analyses: &Analyses,
    test_names: &[String],
    warnings: Vec<Value>,
) -> Result<Value, NonFinite> {
    let estimates = found.estimates.iter().enumerate().map(|(i, estimate)| {
        let path = |name: &str| format!("estimates[{i}].{name}");
        let interval =
            estimate.interval.map(|ends| numbers(&path("interval"), &ends)).transpose()?;
        Ok(json!({
            "parameter": estimate.unknown.path(),
            "case": estimate.unknown.experiment.and_then(|e| names.get(e)),
            "unit": estimate.unknown.quantity.unit(&found.robot),
            "value": number(|| path("value"), estimate.value)?,
            "deviation": optional(|| path("deviation"), estimate.deviation)?,
            "interval": interval,
            "at_bound": estimate.is_at_bound,
            "derivatives": if estimate.by_differences { "differences" } else { "exact" },
        }))
    });
    let correlations = found.correlations.iter().enumerate().map(|(i, row)| {
        let cell = |(j, value): (usize, &Option<f64>)| {
            optional(|| format!("correlations[{i}][{j}]"), *value)
        };
        row.iter().enumerate().map(cell).collect::<Result<Vec<_>, _>>()
    });
    let residuals = found.residuals.iter().enumerate().map(|(i, residual)| {
        let path = |name: &str| format!("residuals[{i}].{name}");
        Ok(json!({
            "case": names.get(residual.experiment),
            "observation": residual.observation + 1,
            "difference": numbers(&path("difference"), &residual.difference)?,
            "weight": number(|| path("weight"), residual.weight)?,
        }))
    });
    let unresolved = found.unresolved.iter().enumerate().map(|(i, unresolved)| {
        let path = format!("unresolved[{i}].collinearity");
        Ok(json!({
            "what": unresolved.to_string(),
            "parameters": unresolved.shares.iter().map(|share| &share.name).collect::<Vec<_>>(),
            "collinearity": optional(|| path, unresolved.collinearity)?,
        }))
    });
    let unstable = found.unstable.iter().enumerate().map(|(i, unstable)| {
        Ok(json!({
            "case": names.get(unstable.experiment),
            "step": unstable.step + 1,
            "stability": number(|| format!("unstable[{i}].stability"), unstable.stability)?,
        }))
    });
    let folds = |validated: &Validated| -> Result<Value, NonFinite> {
        let all = validated.folds.iter().enumerate().map(|(i, fold)| {
            let path = |name: &str| format!("cross_validation.held_out[{i}].{name}");
            Ok(json!({
                "case": names.get(fold.experiment).filter(|_| fold.group.is_none()),
                "step": fold.step.map(|step| step + 1),
                "group": fold.group,
                "rows": fold.rows.len(),
                "values": numbers(&path("values"), &fold.values)?,
                "rms_distance": optional(|| path("rms_distance"), fold.rms_distance)?,
                "rms_pixels": optional(|| path("rms_pixels"), fold.rms_pixels)?,
            }))
        });
        let path = |name: &str| format!("cross_validation.{name}");
        Ok(json!({
            "held_out": all.collect::<Result<Vec<_>, NonFinite>>()?,
            "rms_distance": optional(|| path("rms_distance"), validated.rms_distance)?,
            "rms_pixels": optional(|| path("rms_pixels"), validated.rms_pixels)?,
        }))
    };
    let models = analyses.compared.iter().enumerate().map(|(i, each)| {
        let path = |name: &str| format!("models[{i}].{name}");
        let fit = each.fit.as_ref();
        Ok(json!({
            "model": each.model.name(),
            "error": fit.err().map(|error| error.named(names)),
            "rms_distance": optional(|| path("rms_distance"), fit.ok().and_then(|fit| fit.rms_distance))?,
            "rms_pixels": optional(|| path("rms_pixels"), fit.ok().and_then(|fit| fit.rms_pixels))?,
            "aic_above_best": optional(|| path("aic_above_best"), each.aic_above_best)?,
            "bic_above_best": optional(|| path("bic_above_best"), each.bic_above_best)?,
            "held_out_rms_distance": optional(
                || path("held_out_rms_distance"),
                each.validated.as_ref().and_then(|of| of.rms_distance),
            )?,
        }))
    });
    let mut all = json!({
        "model": found.model.name(),
        "loss": loss_name(found.robustness),
        "status": status_words(found.status),
        "iterations": found.iterations,
        "evaluations": found.evaluations,
        "starts": { "tried": found.starts.tried, "agree": found.starts.agree },
        "estimates": estimates.collect::<Result<Vec<_>, NonFinite>>()?,
        "correlations": correlations.collect::<Result<Vec<_>, NonFinite>>()?,
        "noise": {
            "level": number(|| "noise.level".to_owned(), found.noise.level)?,
            "estimated": found.noise.is_estimated,
            "degrees_of_freedom": found.noise.freedom,
        },
        "rms_distance": optional(|| "rms_distance".to_owned(), found.rms_distance)?,
        "rms_pixels": optional(|| "rms_pixels".to_owned(), found.rms_pixels)?,
        "aic": optional(|| "aic".to_owned(), found.aic)?,
        "bic": optional(|| "bic".to_owned(), found.bic)?,
        "unresolved": unresolved.collect::<Result<Vec<_>, NonFinite>>()?,
        "residuals": residuals.collect::<Result<Vec<_>, NonFinite>>()?,
        "answers": found.answers,
        "unstable": unstable.collect::<Result<Vec<_>, NonFinite>>()?,
        "skipped": rows_json(&found.skipped, names),
        "over_determined": over_determined_json(&found.over_determined, names),
        "cross_validation": analyses.validated.as_ref().map(folds).transpose()?,
        "models": models.collect::<Result<Vec<_>, NonFinite>>()?,
        "warnings": warnings,
        "version": env!("CARGO_PKG_VERSION"),
    });
    if let (Some(all), Value::Object(more)) =
        (all.as_object_mut(), said(found, analyses, names, test_names)?)
    {
        all.extend(more);
    }
    Ok(all)
}

/// The name of a loss, as the command line has it.
#[must_use]
pub const fn loss_name(robustness: Robustness) -> &'static str {
    match robustness {
        Robustness::Squares => "squares",
        Robustness::Huber => "huber",
        Robustness::SoftL1 => "soft-l1",
        Robustness::Cauchy => "cauchy",
    }
}

/// How a search ended, as JSON and messages say it.
#[must_use]
pub const fn status_words(status: Status) -> &'static str {
    match status {
        Status::Gradient | Status::Step | Status::Cost => "converged",
        Status::Stalled => "stalled",
        Status::Refused => "refused",
        Status::IterationLimit => "iteration limit",
    }
}
