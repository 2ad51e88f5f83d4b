//! What the benchmark found, as tables and CSV.

use whipcord::ModelKind;
use whipcord_io::{Cell, CsvTable};

use super::Samples;
use super::accuracy::StepError;
use super::cost::{Cost, SECTIONS, fitted_line, pooled};
use super::paper::Example;
use crate::quantity::{fixed, number};
use crate::table::{Align, Table};
use crate::timing::duration;

/// Models that have times, in the order of [`ModelKind::ALL`].
pub fn models(costs: &[Cost]) -> Vec<ModelKind> {
    let has_times = |kind: &ModelKind| costs.iter().any(|c| c.model == *kind && c.samples.is_ok());
    ModelKind::ALL.into_iter().filter(has_times).collect()
}

/// For each model and number of sections: the mean of each routing, and mean and scatter of all of
/// them.
pub fn cost_table(examples: &[Example], costs: &[Cost]) -> Table {
    let mut columns = vec![("model", Align::Left), ("sections", Align::Right)];
    columns.extend(examples.iter().map(|example| (example.title.as_str(), Align::Right)));
    columns.extend(["mean", "scatter", "per section"].map(|name| (name, Align::Right)));
    let mut table = Table::new(columns);
    for model in models(costs) {
        table.group();
        for sections in SECTIONS {
            let all = pooled(costs, model, None, sections);
            if all.times.is_empty() {
                continue;
            }
            let mut row = vec![model.to_string(), sections.to_string()];
            row.extend((0..examples.len()).map(|example| {
                let samples = pooled(costs, model, Some(example), sections);
                if samples.times.is_empty() { "–".to_owned() } else { duration(samples.mean()) }
            }));
            row.extend([
                duration(all.mean()),
                format!("± {}", duration(all.deviation())),
                format!("{:.0} ns", all.mean() / sections as f64 * 1e9),
            ]);
            table.row(row);
        }
    }
    table
}

/// The fitted lines, one sentence for each model.
pub fn line_words(costs: &[Cost]) -> Vec<String> {
    models(costs)
        .into_iter()
        .filter_map(|model| {
            let line = fitted_line(costs, model, None)?;
            Some(format!(
                "{model}: {} + {:.0} ns for each section (R² {})",
                duration(line.intercept),
                line.slope * 1e9,
                fixed(line.r_squared, 4)
            ))
        })
        .collect()
}

/// Error, observed order and time of each routing against steps.
pub fn accuracy_table(examples: &[Example], errors: &[StepError]) -> Table {
    let mut table = Table::new([
        ("routing", Align::Left),
        ("steps", Align::Right),
        ("error / L", Align::Right),
        ("order", Align::Right),
        ("time", Align::Right),
    ]);
    for (index, example) in examples.iter().enumerate() {
        let of_example: Vec<&StepError> = errors.iter().filter(|e| e.example == index).collect();
        if of_example.is_empty() {
            continue;
        }
        table.group();
        for (i, point) in of_example.iter().enumerate() {
            let order = i.checked_sub(1).and_then(|j| order(of_example[j], point));
            table.row(vec![
                example.title.clone(),
                point.steps.to_string(),
                number(point.error, 2),
                order.map_or_else(String::new, |order| fixed(order, 1)),
                duration(point.samples.mean()),
            ]);
        }
    }
    table
}

/// The observed order of convergence, where rounding does not hide it.
fn order(coarse: &StepError, fine: &StepError) -> Option<f64> {
    let ratio = fine.steps as f64 / coarse.steps as f64;
    (fine.error > 1e-13).then(|| (coarse.error / fine.error).ln() / ratio.ln())
}

/// Every mean and scatter, in s.
pub fn cost_csv(examples: &[Example], costs: &[Cost]) -> CsvTable {
    let mut csv =
        CsvTable::new(["model", "routing", "sections", "mean", "deviation", "samples", "failure"]);
    for cost in costs {
        let samples = cost.samples.as_ref().ok();
        let failure = cost.samples.as_ref().err().map(ToString::to_string);
        csv.push([
            Cell::from(cost.model.name()),
            Cell::from(examples[cost.example].title.as_str()),
            Cell::from(cost.sections),
            Cell::from(samples.map(Samples::mean)),
            Cell::from(samples.map(Samples::deviation)),
            Cell::from(samples.map(|samples| samples.times.len())),
            Cell::from(failure),
        ]);
    }
    csv
}

/// The fitted lines, in s: of each model on each routing, and, without one, on all of them.
pub fn line_csv(examples: &[Example], costs: &[Cost]) -> CsvTable {
    let mut csv = CsvTable::new(["model", "routing", "intercept", "slope", "r_squared"]);
    for model in models(costs) {
        for example in (0..examples.len()).map(Some).chain([None]) {
            if let Some(line) = fitted_line(costs, model, example) {
                csv.push([
                    Cell::from(model.name()),
                    Cell::from(example.map(|example| examples[example].title.as_str())),
                    Cell::from(line.intercept),
                    Cell::from(line.slope),
                    Cell::from(line.r_squared),
                ]);
            }
        }
    }
    csv
}

/// Every error, relative to the backbone's length, with its time in s.
pub fn accuracy_csv(examples: &[Example], errors: &[StepError]) -> CsvTable {
    let mut csv = CsvTable::new(["routing", "steps", "error", "mean", "deviation"]);
    for point in errors {
        csv.push([
            Cell::from(examples[point.example].title.as_str()),
            Cell::from(point.steps),
            Cell::from(point.error),
            Cell::from(point.samples.mean()),
            Cell::from(point.samples.deviation()),
        ]);
    }
    csv
}

/// Why a model has no times, each reason once for each robot.
pub fn failures(examples: &[Example], costs: &[Cost]) -> Vec<String> {
    let mut failures: Vec<String> = Vec::new();
    for cost in costs {
        let Err(error) = &cost.samples else { continue };
        let failure = format!("{}: {error}", examples[cost.example].title);
        if !failures.contains(&failure) {
            failures.push(failure);
        }
    }
    failures
}
