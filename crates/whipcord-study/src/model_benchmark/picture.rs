//! Error against time, drawn.

use whipcord::ModelKind;
use whipcord_plot::{Colour, Marker, ParetoSeries, PlotError, pareto_chart};

use super::CaseBenchmark;
use super::candidate::{Candidate, Variant};
use super::results::Results;

/// The chart of all candidates that have an error somewhere; `None` where none has.
///
/// # Errors
/// [`PlotError`] when it cannot be drawn.
pub fn pareto(title: &str, results: &Results) -> Result<Option<String>, PlotError> {
    let series: Vec<ParetoSeries> = results
        .candidates
        .iter()
        .map(|&candidate| {
            let of = results.trials.len();
            let cases: Vec<[f64; 2]> =
                results.trials.iter().filter_map(|trial| point(candidate, trial)).collect();
            let part = cases.len();
            let label = if part < of {
                format!("{candidate} ({part} of {of})")
            } else {
                candidate.to_string()
            };
            let hollow = candidate.variant != Variant::Usual;
            ParetoSeries { label, cases, look: look(candidate.kind), hollow }
        })
        .filter(|series| !series.cases.is_empty())
        .collect();
    if series.is_empty() { Ok(None) } else { pareto_chart(title, &series).map(Some) }
}

/// Time, and error relative to the length. What is nearer to the reference than that is to the truth is drawn as
/// far off as the reference may be.
fn point(candidate: Candidate, trial: &CaseBenchmark) -> Option<[f64; 2]> {
    let error = trial.error(candidate)?;
    let sure = trial.reference.as_ref().ok()?.uncertainty.unwrap_or(0.0) / trial.length;
    Some([trial.answer(candidate)?.solve.median, error.max(sure)])
}

/// Of every model its own, whichever take part.
fn look(kind: ModelKind) -> (Colour, Marker) {
    (Colour::of_model(kind), Marker::of_model(kind))
}
