//! Error against time, drawn.

use whipcord::ModelKind;
use whipcord_plot::{Colour, Marker, ParetoSeries, PlotError, pareto_chart};

use super::CaseBenchmark;
use super::candidate::{Candidate, Preset};
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
            let of = results.benchmarks.len();
            let cases: Vec<[f64; 2]> = results
                .benchmarks
                .iter()
                .filter_map(|benchmark| point(candidate, benchmark))
                .collect();
            let part = cases.len();
            let label = if part < of {
                format!("{candidate} ({part} of {of})")
            } else {
                candidate.to_string()
            };
            let hollow = candidate.preset != Preset::Usual;
            ParetoSeries { label, cases, look: look(candidate.kind), hollow }
        })
        .filter(|series| !series.cases.is_empty())
        .collect();
    if series.is_empty() { Ok(None) } else { pareto_chart(title, &series).map(Some) }
}

/// Time, and error relative to the length. What is nearer to the reference than that is to the truth is drawn as
/// far off as the reference may be.
fn point(candidate: Candidate, benchmark: &CaseBenchmark) -> Option<[f64; 2]> {
    let error = benchmark.error(candidate)?;
    let sure = benchmark.reference.as_ref().ok()?.uncertainty.unwrap_or(0.0) / benchmark.length;
    Some([benchmark.answer(candidate)?.solve.median, error.max(sure)])
}

/// Of every model its own, whichever take part.
fn look(kind: ModelKind) -> (Colour, Marker) {
    (Colour::of_model(kind), Marker::of_model(kind))
}
