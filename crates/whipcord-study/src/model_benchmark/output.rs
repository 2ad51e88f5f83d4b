//! Every number of the benchmarks, in SI: as CSV and as JSON.

use serde_json::{Value, json};
use whipcord::CommandDerivatives;
use whipcord_io::{Cell, CsvTable, NonFinite, json_number, json_optional};

use super::recommendation::Finding;
use super::results::Results;
use super::standing::Standing;
use super::{Answer, CaseBenchmark, Commands, Entry, Tags};

impl Commands {
    /// In tables for programs.
    const fn name(self) -> &'static str {
        match self {
            Self::Case => "case",
            Self::Reference => "reference",
        }
    }
}

/// One row for each candidate on each case, those with many sections last.
pub fn csv(results: &Results) -> CsvTable {
    let mut csv = CsvTable::new([
        "case",
        "stem",
        "sections",
        "routing",
        "bending",
        "burden",
        "reference",
        "reference_uncertainty",
        "model",
        "preset",
        "commands",
        "driven_by",
        "rms",
        "greatest",
        "tip",
        "rms_over_length",
        "solve_time",
        "solve_time_repeats",
        "build_time",
        "iterations",
        "steps",
        "unstable",
        "failure",
        "stable",
        "stability_absent",
        "compared_steps",
        "compared_points",
    ]);
    for benchmark in results.benchmarks.iter().chain(&results.cut) {
        for entry in &benchmark.entries {
            let mut row = identity(benchmark).to_vec();
            row.extend([
                Cell::from(entry.candidate.kind.name()),
                Cell::from(entry.candidate.preset_name()),
                Cell::from(entry.commands.name()),
                Cell::from(entry.driven_by.as_str()),
            ]);
            row.extend(answer_cells(benchmark, entry));
            csv.push(row);
        }
    }
    csv
}

fn identity(benchmark: &CaseBenchmark) -> [Cell; 8] {
    let reference = benchmark.reference.as_ref().ok();
    let tags = benchmark.tags;
    let text = |text: Option<&str>| text.map_or(Cell::Empty, Cell::from);
    [
        Cell::from(benchmark.title.as_str()),
        Cell::from(benchmark.stem.as_str()),
        Cell::from(benchmark.sections),
        text(tags.map(|tags| tags.routing)),
        Cell::from(tags.map(|tags| tags.bending)),
        text(tags.map(|tags| tags.load_kind.name())),
        text(reference.map(|reference| reference.name.as_str())),
        Cell::from(reference.and_then(|reference| reference.uncertainty)),
    ]
}

fn answer_cells(benchmark: &CaseBenchmark, entry: &Entry) -> Vec<Cell> {
    let answer = match &entry.outcome {
        Ok(answer) => answer,
        Err(error) => {
            let mut cells = vec![Cell::Empty; 10];
            cells.push(Cell::from(error.to_string()));
            cells.resize(15, Cell::Empty);
            return cells;
        }
    };
    let residual = answer.residual.as_ref().ok();
    vec![
        Cell::from(residual.map(|residual| residual.rms)),
        Cell::from(residual.map(|residual| residual.greatest)),
        Cell::from(residual.and_then(|residual| residual.tip)),
        Cell::from(residual.map(|residual| residual.rms / benchmark.length)),
        Cell::from(answer.solve.median),
        Cell::from(answer.solve.repeats),
        Cell::from(answer.build.median),
        Cell::from(answer.iterations),
        Cell::from(answer.steps),
        Cell::from(if answer.is_unstable() { "true" } else { "false" }),
        answer.residual.as_ref().err().map_or(Cell::Empty, |why| Cell::from(why.as_str())),
        answer
            .stable
            .map_or(Cell::Empty, |stable| Cell::from(if stable { "true" } else { "false" })),
        answer.stability_absent.map_or(Cell::Empty, |why| Cell::from(why.name())),
        residual.map_or(Cell::Empty, |residual| Cell::from(residual.steps)),
        residual.map_or(Cell::Empty, |residual| Cell::from(residual.points)),
    ]
}

/// What `whipcord compare --json` prints.
///
/// # Errors
/// [`NonFinite`] with the place of a number that is not finite.
pub fn json(results: &Results) -> Result<Value, NonFinite> {
    let benchmarks = |benchmarks: &[CaseBenchmark], name: &str| -> Result<Vec<Value>, NonFinite> {
        let each = benchmarks.iter().enumerate();
        each.map(|(i, benchmark)| benchmark_json(&format!("{name}[{i}]"), benchmark)).collect()
    };
    let models = results.standings().iter().map(standing_json).collect::<Result<Vec<_>, _>>()?;
    Ok(json!({
        "version": env!("CARGO_PKG_VERSION"),
        "cases": benchmarks(&results.benchmarks, "cases")?,
        "with_many_sections": benchmarks(&results.cut, "with_many_sections")?,
        "models": models,
        "recommendation": results.recommendation().iter().map(finding_json).collect::<Vec<_>>(),
    }))
}

fn benchmark_json(path: &str, benchmark: &CaseBenchmark) -> Result<Value, NonFinite> {
    let reference = match &benchmark.reference {
        Ok(reference) => json!({
            "name": reference.name,
            "model": reference.kind.map(whipcord::ModelKind::name),
            "uncertainty": json_optional(|| format!("{path}.reference.uncertainty"), reference.uncertainty)?,
        }),
        Err(_) => Value::Null,
    };
    let runs = benchmark.entries.iter().enumerate();
    let runs = runs.map(|(i, entry)| run_json(&format!("{path}.runs[{i}]"), benchmark, entry));
    Ok(json!({
        "title": benchmark.title,
        "stem": benchmark.stem,
        "sections": benchmark.sections,
        "length": json_number(|| format!("{path}.length"), benchmark.length)?,
        "tags": benchmark.tags.map(|Tags { routing, bending, load_kind }| {
            json!({ "routing": routing, "bending": bending, "burden": load_kind.name() })
        }),
        "reference": reference,
        "no_reference": benchmark.reference.as_ref().err().map(ToString::to_string),
        "runs": runs.collect::<Result<Vec<_>, _>>()?,
    }))
}

fn run_json(path: &str, benchmark: &CaseBenchmark, entry: &Entry) -> Result<Value, NonFinite> {
    let mut run = json!({
        "model": entry.candidate.kind.name(),
        "preset": entry.candidate.preset_name(),
        "commands": entry.commands.name(),
        "driven_by": entry.driven_by,
    });
    let answer = match &entry.outcome {
        Ok(answer) => answer,
        Err(error) => {
            run["failure"] = json!(error.to_string());
            return Ok(run);
        }
    };
    let Answer { residual, solve, build, iterations, steps, stable, stability_absent } = answer;
    match residual {
        Ok(residual) => {
            run["error"] = json!({
                "rms": json_number(|| format!("{path}.error.rms"), residual.rms)?,
                "greatest": json_number(|| format!("{path}.error.greatest"), residual.greatest)?,
                "tip": json_optional(|| format!("{path}.error.tip"), residual.tip)?,
                "rms_over_length":
                    json_number(|| format!("{path}.error.rms_over_length"), residual.rms / benchmark.length)?,
                "steps": residual.steps,
                "points": residual.points,
            });
        }
        Err(why) => run["not_compared"] = json!(why),
    }
    run["solve_time"] = json_number(|| format!("{path}.solve_time"), solve.median)?;
    run["solve_time_repeats"] = json!(solve.repeats);
    run["build_time"] = json_number(|| format!("{path}.build_time"), build.median)?;
    run["iterations"] = json!(iterations);
    run["steps"] = json!(steps);
    run["unstable"] = json!(answer.is_unstable());
    run["stable"] = json!(stable);
    if let Some(reason) = stability_absent.filter(|_| stable.is_none()) {
        run["stability_absent"] = json!(reason.name());
    }
    Ok(run)
}

fn standing_json(standing: &Standing) -> Result<Value, NonFinite> {
    let (kind, preset) = (standing.candidate.kind.name(), standing.candidate.preset_name());
    let number = |name: &str, value| json_optional(|| format!("models.{kind}.{name}"), value);
    Ok(json!({
        "model": kind,
        "preset": preset,
        "cases": standing.of,
        "answered": standing.answered,
        "unstable": standing.unstable,
        "within_tolerance": standing.within,
        "median_error": number("median_error", standing.median_error)?,
        "worst_error": number("worst_error", standing.worst_error)?,
        "worst_case": standing.worst_case,
        "solve_time": number("solve_time", standing.time)?,
        "iterations": number("iterations", standing.iterations)?,
        "derivatives": match standing.derivatives {
            CommandDerivatives::Exact => "exact",
            CommandDerivatives::Differences => "differences",
        },
        "without_material": standing.without_material,
    }))
}

fn finding_json(finding: &Finding) -> Value {
    json!({
        "topic": finding.topic.name(),
        "model": finding.choice.map(|choice| choice.kind.name()),
        "preset": finding.choice.map(super::candidate::Candidate::preset_name),
        "confirmed": finding.confirmed,
        "text": finding.text,
    })
}
