//! The score in tables for people.

use whipcord::{LengthMiss, ModelKind};
use whipcord_estimation::registration::Alignment;

use super::{Score, Summary};
use crate::quantity::{degrees, fixed, fixed_millimetres, millimetres};
use crate::remark::Remark;
use crate::table::{Align, Table};

/// Most files that have rows of their own in tables.
const MOST_FILES: usize = 20;
/// Most rows of the table of the worst rows.
const MOST_ROWS: usize = 20;

/// A row for each model, over all files.
#[must_use]
pub fn summary(score: &Score<'_>) -> Table {
    let summaries: Vec<Summary> = (0..score.models.len()).map(|m| score.summary(m)).collect();
    let angles = summaries.iter().any(|summary| summary.angles.is_some());
    let mut columns = vec![
        ("model", Align::Left, ""),
        ("rows", Align::Right, ""),
        ("failed", Align::Right, ""),
        ("unstable", Align::Right, ""),
        ("RMS", Align::Right, "mm"),
        ("% of length", Align::Right, ""),
        ("median", Align::Right, "mm"),
        ("95 %", Align::Right, "mm"),
        ("worst", Align::Right, "mm"),
        ("% of length", Align::Right, ""),
        ("worst row", Align::Left, ""),
    ];
    if angles {
        columns.insert(10, ("angle RMS", Align::Right, "degrees"));
    }
    let units: Vec<&'static str> = columns.iter().map(|(.., unit)| *unit).collect();
    let mut table =
        Table::new(columns.into_iter().map(|(name, align, _)| (name, align))).with_units(units);
    table.group();
    for (model, summary) in summaries.iter().enumerate() {
        let mut row = vec![
            score.models[model].to_string(),
            summary.compared.to_string(),
            if summary.refused == summary.rows { dash() } else { summary.failed.to_string() },
            if summary.refused == summary.rows { dash() } else { summary.unstable.to_string() },
        ];
        row.extend(distances(summary));
        if angles {
            row.push(summary.angles.map_or_else(dash, |angles| degrees(angles.rms)));
        }
        row.push(summary.worst.map_or_else(String::new, |of| score.label(of.file, of.row)));
        table.row(row);
    }
    table
}

fn dash() -> String {
    String::from("–")
}

fn distances(summary: &Summary) -> [String; 6] {
    let (Some(of), Some(relative)) = (summary.distances, summary.relative) else {
        return core::array::from_fn(|_| dash());
    };
    [
        fixed_millimetres(of.rms, 3),
        fixed(100.0 * relative.rms, 2),
        fixed_millimetres(of.median, 3),
        fixed_millimetres(of.percentile_95, 3),
        fixed_millimetres(of.worst, 3),
        fixed(100.0 * relative.worst, 2),
    ]
}

/// The root mean square of each model on each file; `None` of one file, or of too many.
#[must_use]
pub fn files(score: &Score<'_>) -> Option<Table> {
    if !(2..=MOST_FILES).contains(&score.subjects.len()) {
        return None;
    }
    let columns =
        [("file", Align::Left), ("rows", Align::Right)].into_iter().map(|(n, a)| (n.to_owned(), a));
    let models = score.models.iter().map(|model| (model.to_string(), Align::Right));
    let units = ["", ""].into_iter().chain(score.models.iter().map(|_| "RMS in mm"));
    let mut table = Table::new(columns.chain(models)).with_units(units);
    table.group();
    for (file, name) in score.names.iter().enumerate() {
        let mut row = vec![name.clone(), score.subjects[file].rows.len().to_string()];
        for model in 0..score.models.len() {
            let of = score.of_file(file, model).distances;
            row.push(of.map_or_else(dash, |of| fixed_millimetres(of.rms, 3)));
        }
        table.row(row);
    }
    Some(table)
}

/// The rows in which the best model is farthest off, and how far the others are there.
#[must_use]
pub fn worst_rows(score: &Score<'_>) -> Option<Table> {
    let best = score.best()?;
    let mut rows: Vec<(usize, usize, f64)> = Vec::new();
    for (file, models) in score.files.iter().enumerate() {
        let own = models[best].rows.iter().enumerate();
        rows.extend(own.filter_map(|(place, row)| Some((file, place, row.error?))));
    }
    rows.sort_by(|a, b| b.2.total_cmp(&a.2));
    let models = score.models.iter().map(|model| (model.to_string(), Align::Right));
    let units = [""].into_iter().chain(score.models.iter().map(|_| "mm"));
    let first = [(String::from("row"), Align::Left)];
    let mut table = Table::new(first.into_iter().chain(models)).with_units(units);
    table.group();
    for (file, place, _) in rows.into_iter().take(MOST_ROWS) {
        let mut cells = vec![score.label(file, score.files[file][best].rows[place].row)];
        for of in &score.files[file] {
            let row = of.rows.get(place);
            let error = row.and_then(|row| row.error);
            let mark = if row.is_some_and(|row| row.unstable) { " †" } else { "" };
            cells.push(error.map_or_else(dash, |error| fixed_millimetres(error, 3) + mark));
        }
        table.row(cells);
    }
    Some(table)
}

/// What the columns mean, and how rows follow one another.
#[must_use]
pub fn measures_notes(score: &Score<'_>) -> Vec<String> {
    let mut notes = vec![String::from(
        "Lengths in mm. RMS over all markers that are not on the base; median, 95 % and worst over the rows, of which each counts with the RMS of its markers. 95 %: the error that 95 % of the rows do not exceed.",
    )];
    let independent = score.subjects.iter().filter(|of| of.file.case.independent);
    let (independent, all) = (independent.count(), score.subjects.len());
    if score.subjects.iter().any(|of| !of.file.case.before.is_empty()) {
        notes.push(match independent {
            0 => String::from(
                "Rows are steps in order: each starts from where the one before left the robot.",
            ),
            n if n == all => {
                String::from("Rows are independent: each starts from the robot at rest.")
            }
            n => format!(
                "Rows are independent in {n} of {all} files, and steps in order in the others."
            ),
        });
    }
    notes
}

/// What the columns mean, how measurements were moved, and why rows are not compared.
#[must_use]
pub fn notes(score: &Score<'_>) -> Vec<String> {
    let mut notes = measures_notes(score);
    let all = score.subjects.len();
    for (file, models) in score.files.iter().enumerate() {
        let of_file = score.file(file);
        let name = if all > 1 { format!("{}: ", score.names[file]) } else { String::new() };
        let Some(measured) = &of_file.measured else { continue };
        if file >= MOST_FILES {
            notes.push(String::from("Notes on further files are left out."));
            break;
        }
        if let Some(table) = &of_file.commands {
            let left = table.rows.iter().filter(|row| !row.is_measured).count();
            if left > 0 {
                let use_of_them = match of_file.case.independent {
                    true => "left out",
                    false => "used only as history",
                };
                notes.push(format!("{name}rows that are not measured, {use_of_them}: {left}."));
            }
            let measured_rows = table.rows.len() - left;
            let seen = score.subjects[file].rows.len();
            if seen < measured_rows {
                notes.push(format!(
                    "{name}rows without a measured position: {} of {measured_rows}.",
                    measured_rows - seen
                ));
            }
        }
        if measured.alignment != Alignment::None {
            let moved = models.iter().filter_map(|of| {
                let motion = of.motion?;
                Some(format!(
                    "{} by {} and {}",
                    of.model,
                    millimetres(motion.position.norm()),
                    degrees(motion.rotation.log().norm())
                ))
            });
            let moved: Vec<String> = moved.collect();
            if !moved.is_empty() {
                notes.push(format!(
                    "{name}one rigid motion for all rows brings the measurement onto each model ({}): {}.",
                    measured.alignment.name(),
                    moved.join(", ")
                ));
            }
        }
        let down = models.iter().filter_map(|of| {
            let rows: Vec<usize> =
                of.rows.iter().filter(|row| row.down_weighted).map(|row| row.row).collect();
            let first = rows.first().copied()?;
            let (count, label) = (rows.len(), score.label(file, first));
            Some(match count {
                1 => format!("{} 1 ({label})", of.model),
                _ => format!("{} {count} ({label}, …)", of.model),
            })
        });
        let down: Vec<String> = down.collect();
        if !down.is_empty() {
            notes.push(format!(
                "{name}rows that count less in this motion, because they are far off like jumps of a tracker (`down_weighted` in rows.csv): {}.",
                down.join(", ")
            ));
        }
        if let Some(Remark { message, help, .. }) = score.mirrored(file) {
            notes.push(format!("! {name}{message}; {help}."));
        }
        if models.iter().any(|of| of.body_is_estimated) {
            notes.push(format!(
                "{name}the rotation of the tracked body on the robot was estimated from all rows."
            ));
        }
        if of_file.robot.has_history()
            && models.iter().any(|of| of.rows.iter().any(|row| row.failure.is_some()))
        {
            notes.push(format!(
                "{name}rows without an answer are left out of the history of those after them."
            ));
        }
    }
    if score.models.iter().enumerate().any(|(model, _)| score.summary(model).unstable > 0) {
        notes.push(String::from(
            "Unstable rows have an answer that the robot leaves; they count in the errors.",
        ));
    }
    for (model, kind) in score.models.iter().enumerate() {
        let summary = score.summary(model);
        if let Some(most) = &summary.greatest_miss {
            let rows = match summary.over_determined {
                1 => String::from("1 row whose cable lengths contradict each other is"),
                count => format!("{count} rows whose cable lengths contradict each other are"),
            };
            let LengthMiss { cable, excess } = &most.miss;
            notes.push(format!(
                "{kind}: {rows} solved in the least-squares sense (status `least-squares` in rows.csv); at most cable `{cable}` is {} longer than commanded, in {}.",
                millimetres(*excess),
                score.label(most.file, most.row)
            ));
        }
    }
    if let (Some(Remark { message, help, .. }), Some(best)) = (&score.single_cable, score.best()) {
        let model = score.models[best];
        notes.push(format!(
            "{model}, with one stiffness fitted to some of the rows: {message}; {help}."
        ));
    }
    for (model, kind) in score.models.iter().enumerate() {
        notes.extend(reasons(*kind, &score.summary(model)));
    }
    notes
}

/// Why rows of a model have no answer.
fn reasons(model: ModelKind, summary: &Summary) -> Vec<String> {
    const MOST: usize = 5;
    let rows = |count: usize| if count == 1 { "1 row".to_owned() } else { format!("{count} rows") };
    let mut notes: Vec<String> = summary
        .reasons
        .iter()
        .take(MOST)
        .map(|(reason, count)| format!("{model}, {}: {reason}", rows(*count)))
        .collect();
    if summary.reasons.len() > MOST {
        let left: usize = summary.reasons[MOST..].iter().map(|(_, count)| count).sum();
        notes.push(format!("{model}, {}: other reasons, in rows.csv", rows(left)));
    }
    notes
}
