//! Error against time, drawn.

use whipcord::ModelKind;
use whipcord_plot::{Colour, Marker, ParetoSeries, PlotError, pareto_chart};

use super::Trial;
use super::contender::{Contender, Variant};
use super::results::Results;

/// The chart of all contenders that have an error somewhere; `None` where none has.
///
/// # Errors
/// [`PlotError`] when it cannot be drawn.
pub fn pareto(title: &str, results: &Results) -> Result<Option<String>, PlotError> {
    let series: Vec<ParetoSeries> = results
        .contenders
        .iter()
        .map(|&contender| {
            let of = results.trials.len();
            let cases: Vec<[f64; 2]> =
                results.trials.iter().filter_map(|trial| point(contender, trial)).collect();
            let part = cases.len();
            let label = if part < of {
                format!("{contender} ({part} of {of})")
            } else {
                contender.to_string()
            };
            let hollow = contender.variant != Variant::Usual;
            ParetoSeries { label, cases, look: look(contender.kind), hollow }
        })
        .filter(|series| !series.cases.is_empty())
        .collect();
    if series.is_empty() { Ok(None) } else { pareto_chart(title, &series).map(Some) }
}

/// Time, and error relative to the length. What is nearer to the reference than that is to the truth is drawn as
/// far off as the reference may be.
fn point(contender: Contender, trial: &Trial) -> Option<[f64; 2]> {
    let error = trial.error(contender)?;
    let sure = trial.yardstick.as_ref().ok()?.uncertainty.unwrap_or(0.0) / trial.length;
    Some([trial.answer(contender)?.solve.median, error.max(sure)])
}

/// Of every model its own, whichever take part.
fn look(kind: ModelKind) -> (Colour, Marker) {
    (Colour::of_model(kind), Marker::of_model(kind))
}
