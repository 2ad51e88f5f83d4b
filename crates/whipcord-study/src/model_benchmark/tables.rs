//! How the candidates did, in tables for people.

use whipcord::CommandDerivatives;

use super::candidate::Preset;
use super::results::Results;
use super::standing::Standing;
use super::{Answer, CaseBenchmark, Entry, summary};
use crate::quantity::{fixed, millimetres, number};
use crate::style::Style;
use crate::table::{Align, Table};
use crate::timing::duration;

/// Nothing to show.
const NONE: &str = "–";

/// A row for each candidate over all cases.
pub fn standings(results: &Results) -> Table {
    let mut table = Table::new([
        ("model", Align::Left),
        ("answers", Align::Right),
        ("error, %", Align::Right),
        ("worst", Align::Right),
        ("within 2 %", Align::Right),
        ("time", Align::Right),
        ("iterations", Align::Right),
        ("derivatives", Align::Left),
        ("material", Align::Left),
    ])
    .with_units(["", "of cases", "median", "%", "cases", "with its unit", "median", "", ""]);
    table.group();
    for standing in results.standings() {
        table.row(row(&standing));
    }
    table
}

fn row(standing: &Standing) -> Vec<String> {
    let or_none = |text: Option<String>| text.unwrap_or_else(|| NONE.to_owned());
    let unknown = standing.answered == 0;
    vec![
        standing.candidate.to_string(),
        format!("{}/{}", standing.answered, standing.of),
        or_none(standing.median_error.map(percent)),
        or_none(standing.worst_error.map(percent)),
        if standing.judged > 0 { standing.within.to_string() } else { NONE.to_owned() },
        or_none(standing.time.map(duration)),
        or_none(standing.iterations.map(|n| number(n, 3))),
        match standing.derivatives {
            _ if unknown => NONE.to_owned(),
            CommandDerivatives::Exact => "exact".to_owned(),
            CommandDerivatives::Differences => "differences".to_owned(),
        },
        match standing.without_material {
            _ if unknown => NONE.to_owned(),
            true => "not needed".to_owned(),
            false => "needed".to_owned(),
        },
    ]
}

/// A share in %: as many digits as can be told apart by eye, and small ones by their magnitude.
pub fn percent(share: f64) -> String {
    let value = 1e2 * share;
    if value >= 0.01 || value == 0.0 { fixed(value, 2) } else { format!("{value:.0e}") }
}

/// A row for each candidate on each case.
pub fn entries(benchmarks: &[CaseBenchmark]) -> Table {
    let mut table = Table::new([
        ("case", Align::Left),
        ("model", Align::Left),
        ("driven by", Align::Left),
        ("RMS, mm", Align::Right),
        ("greatest", Align::Right),
        ("tip", Align::Right),
        ("RMS, %", Align::Right),
        ("time", Align::Right),
        ("iterations", Align::Right),
        ("steps", Align::Right),
        ("points", Align::Right),
    ])
    .with_units(["", "", "", "", "mm", "mm", "", "with its unit", "count", "count", "count"]);
    for benchmark in benchmarks {
        table.group();
        for (i, entry) in benchmark.entries.iter().enumerate() {
            let title = if i == 0 { benchmark.title.clone() } else { String::new() };
            let mut row = vec![title, entry.candidate.to_string()];
            match &entry.outcome {
                Ok(answer) => row.extend(answer_cells(benchmark, entry, answer)),
                Err(_) => row.resize(11, NONE.to_owned()),
            }
            table.row(row);
        }
    }
    table
}

fn answer_cells(benchmark: &CaseBenchmark, entry: &Entry, answer: &Answer) -> Vec<String> {
    let in_mm = |metres: f64| match 1e3 * metres {
        mm if mm >= 0.001 || mm == 0.0 => fixed(mm, 3),
        mm => format!("{mm:.0e}"),
    };
    let mut cells = vec![entry.driven_by.clone()];
    match &answer.residual {
        Ok(residual) => cells.extend([
            in_mm(residual.rms),
            in_mm(residual.greatest),
            residual.tip.map_or_else(|| NONE.to_owned(), in_mm),
            percent(residual.rms / benchmark.length),
        ]),
        Err(_) => cells.resize(5, NONE.to_owned()),
    }
    cells.extend([duration(answer.solve.median), answer.iterations.to_string()]);
    match &answer.residual {
        Ok(residual) => cells.extend([residual.steps.to_string(), residual.points.to_string()]),
        Err(_) => cells.resize(9, NONE.to_owned()),
    }
    cells
}

/// What errors are measured against, how sure that is, and who has no answer and why; each once.
pub fn notes(results: &Results) -> Vec<String> {
    let mut notes = vec![String::from(
        "error: root mean square over the disks, without the base, in % of the backbone's length: median and greatest over the cases. A geometric model is given the cable lengths of the reference, from hole to hole.",
    )];
    for (preset, meaning) in [
        (
            Preset::StepPerSection,
            "\"step a section\": one integration step for each section, and nothing computed that the shape does not need, as the paper times the Cosserat rod.",
        ),
        (
            Preset::Sliding,
            "\"sliding\": four-bar with the length rule free, for cables that slide freely; \"strain energy\": the same with the objective strain-energy, as its authors extended the model. Else every section loses the same fraction, as in the paper.",
        ),
    ] {
        if results.candidates.iter().any(|one| one.preset == preset) {
            notes.push(meaning.to_owned());
        }
    }
    let mut references: Vec<(&str, usize, Option<f64>)> = Vec::new();
    for benchmark in &results.benchmarks {
        let Ok(reference) = &benchmark.reference else { continue };
        let known = references.iter_mut().find(|(name, ..)| *name == reference.name);
        match known {
            Some((_, count, uncertainty)) => {
                *count += 1;
                *uncertainty = (*uncertainty).zip(reference.uncertainty).map(|(a, b)| a.max(b));
            }
            None => references.push((&reference.name, 1, reference.uncertainty)),
        }
    }
    for (name, count, uncertainty) in references {
        let cases = if count == 1 { "1 case" } else { &format!("{count} cases") };
        let sure = match uncertainty {
            Some(uncertainty) => format!(
                "by its own estimate within {} of its exact answer",
                millimetres(rounded(uncertainty))
            ),
            None => "no estimate of its own error".to_owned(),
        };
        notes.push(format!("reference: {name} ({cases}), {sure}."));
    }
    let residuals = results.benchmarks.iter().flat_map(|benchmark| &benchmark.entries);
    let mut residuals =
        residuals.filter_map(|entry| entry.outcome.as_ref().ok()?.residual.as_ref().ok());
    if residuals.any(|residual| residual.steps > 1) {
        notes.push(String::from(
            "A case in steps is compared in all steps: \"steps\" and \"points\" of each are in accuracy.csv and, with --rows, in the table.",
        ));
    }
    let untold = |benchmark: &&CaseBenchmark| {
        benchmark.entries.iter().any(|entry| {
            entry
                .outcome
                .as_ref()
                .is_ok_and(|answer| answer.residual.as_ref().is_ok_and(|m| m.tip.is_none()))
        })
    };
    for benchmark in results.benchmarks.iter().filter(untold) {
        notes.push(format!(
            "{}: no distance of the tip: the centre of the last disk was not measured.",
            benchmark.title
        ));
    }
    for benchmark in &results.benchmarks {
        if let Err(why) = &benchmark.reference {
            notes.push(format!("{}: no reference: {why}", benchmark.title));
        }
    }
    notes.extend(failures(&results.benchmarks));
    notes
}

/// To one digit.
fn rounded(value: f64) -> f64 {
    format!("{value:.0e}").parse().unwrap_or(value)
}

/// Who has no answer, or one that cannot be compared, and why: each reason once with the number of cases.
fn failures(benchmarks: &[CaseBenchmark]) -> Vec<String> {
    let mut reasons: Vec<Reason> = Vec::new();
    for benchmark in benchmarks {
        for entry in &benchmark.entries {
            let why = match &entry.outcome {
                Err(error) => error.to_string(),
                Ok(Answer { residual: Err(why), .. }) if benchmark.reference.is_ok() => why.clone(),
                Ok(_) => continue,
            };
            let index = reasons.iter().position(|known| known.why == why).unwrap_or_else(|| {
                reasons.push(Reason { why, candidates: Vec::new(), titles: Vec::new() });
                reasons.len() - 1
            });
            let reason = &mut reasons[index];
            let name = entry.candidate.to_string();
            if !reason.candidates.contains(&name) {
                reason.candidates.push(name);
            }
            if reason.titles.last() != Some(&benchmark.title.as_str()) {
                reason.titles.push(&benchmark.title);
            }
        }
    }
    reasons.iter().map(Reason::words).collect()
}

/// Why some have no answer.
struct Reason<'a> {
    why: String,
    candidates: Vec<String>,
    titles: Vec<&'a str>,
}

impl Reason<'_> {
    fn words(&self) -> String {
        let more = match self.titles.len() {
            0 | 1 => String::new(),
            n => format!(" and {} more", n - 1),
        };
        let first = self.titles.first().unwrap_or(&"");
        format!("{first}{more}: {}: {}", self.candidates.join("; "), self.why)
    }
}

/// How the candidates did, what must not be read into it, and the recommendation; with `rows` also on each case.
pub fn text(results: &Results, rows: bool, style: Style) -> String {
    let mut text = standings(results).text(style) + "\n";
    for (heading, table) in summary::tables(&results.benchmarks, &results.candidates) {
        text += &format!("{}\n\n{}\n", style.heading(heading), table.text(style));
    }
    if rows {
        text += &(entries(&results.benchmarks).text(style) + "\n");
        if !results.cut.is_empty() {
            let heading = style.heading("The same robots cut into many sections");
            text += &format!("{heading}\n\n{}\n", entries(&results.cut).text(style));
        }
    }
    for note in notes(results) {
        text += &format!("{note}\n");
    }
    let recommendation = results.recommendation();
    if !recommendation.is_empty() {
        text += &format!("\n{}\n\n", style.heading("Which model for what"));
    }
    for finding in recommendation {
        text += &format!("{}: {}\n", finding.topic.words(), finding.text);
    }
    text
}
