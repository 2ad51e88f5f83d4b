//! A fit in tables, for people and as CSV.

use whipcord_estimation::identification::{Estimate, Fold, Residual, Robustness, Unknown, rows};
use whipcord_estimation::{Observation, Seen};
use whipcord_io::{CaseFile, Cell, CsvTable, loss_name};

use super::Fit;
use super::figures::is_outlier;
use super::remarks::repeats;
use crate::describe::markers;
use crate::quantity::{fixed, number, percent};
use crate::style::Style;
use crate::table::{Align, Table};

/// What standard output shows.
pub fn summary(fit: &Fit, unknowns: &[Unknown], style: Style) -> String {
    let mut text = heading(fit) + "\n\n";
    text += &estimates(fit).text(style);
    let correlations = correlations(fit);
    if unknowns.len() > 1 {
        text += "\nCorrelations\n";
        text += &correlations.text(style);
    }
    for (title, table) in more(fit) {
        if !table.is_empty() {
            text += &format!("\n{title}\n{}", table.text(style));
        }
    }
    text.push('\n');
    for note in notes(fit) {
        text += &format!("{note}\n");
    }
    text
}

/// The tables that are shown where they were asked for, with their titles.
pub fn more(fit: &Fit) -> [(&'static str, Table); 5] {
    [
        ("Models", models(fit)),
        ("Held out in turn", held_out(fit)),
        ("One parameter after the other", ladder(fit)),
        ("Profile likelihood", profiles(fit)),
        ("Not fitted", not_fitted(fit)),
    ]
}

/// The angle in rad that is left of an orientation.
fn turn(fit: &Fit, residual: &Residual) -> Option<f64> {
    let seen = &fit.experiments[residual.experiment].observations[residual.observation];
    match seen.seen {
        Seen::Rotation { arm, .. } => Some(residual.distance() / arm),
        _ => None,
    }
}

/// One line on the whole.
pub fn heading(fit: &Fit) -> String {
    let found = &fit.found;
    let files = match fit.cases.as_slice() {
        [one] => one.title.clone(),
        several => format!("{} files", several.len()),
    };
    let turns: Vec<f64> = found.residuals.iter().filter_map(|of| turn(fit, of)).collect();
    let mut parts = vec![format!("{files}: {}", markers(found.residuals.len() - turns.len()))];
    parts.extend(found.rms_distance.map(|rms| format!("RMS distance {} mm", number(rms * 1e3, 3))));
    if !turns.is_empty() {
        let sum: f64 = turns.iter().map(|turn| turn * turn).sum();
        let rms = (sum / turns.len() as f64).sqrt().to_degrees();
        parts.push(format!("{} orientations, RMS turn {}°", turns.len(), number(rms, 3)));
    }
    parts.extend(found.rms_pixels.map(|rms| format!("RMS distance {} pixels", number(rms, 3))));
    let weighed = match found.robustness {
        Robustness::Squares => String::new(),
        of => format!(" with the loss {}", loss_name(of)),
    };
    let level = found.noise.level;
    parts.push(match (found.noise.is_estimated, found.rms_distance.is_some()) {
        (true, true) => format!("noise {} mm in each coordinate", number(level * 1e3, 3)),
        (true, false) => format!("noise {} pixels in each coordinate", number(level, 3)),
        (false, _) => format!("noise {} × what the measurements say", number(level, 3)),
    });
    format!("{} fitted by {}{weighed}", parts.join(", "), found.model)
}

/// The estimates.
pub fn estimates(fit: &Fit) -> Table {
    let mut table = Table::new([
        ("parameter", Align::Left),
        ("estimate", Align::Right),
        ("±", Align::Right),
        ("95 % from", Align::Right),
        ("to", Align::Right),
        ("unit", Align::Left),
        ("derivatives", Align::Left),
    ]);
    table.group();
    for estimate in &fit.found.estimates {
        let (scale, unit) = shown(estimate.unknown.quantity.unit(&fit.found.robot));
        // Down to the second digit of the deviation, so that the ends of the interval are told apart.
        let decimals =
            estimate.deviation.map(|deviation| 1.0 - (deviation * scale).log10().floor());
        let in_unit = |value: f64| match decimals {
            Some(decimals) if (0.0..=9.0).contains(&decimals) && (value * scale).abs() < 1e6 => {
                fixed(value * scale, decimals as usize)
            }
            _ => number(value * scale, 6),
        };
        let [from, to] = match estimate.interval {
            Some(ends) => ends.map(in_unit),
            None => [String::from("–"), String::from("–")],
        };
        table.row(vec![
            name(fit, &estimate.unknown),
            in_unit(estimate.value),
            estimate.deviation.map_or_else(|| words(estimate), in_unit),
            from,
            to,
            unit.to_owned(),
            if estimate.by_differences { "differences" } else { "exact" }.to_owned(),
        ]);
    }
    table
}

fn words(estimate: &Estimate) -> String {
    if estimate.is_at_bound { "at its bound" } else { "not seen" }.to_owned()
}

/// The factor from SI to the unit that people are shown, and that unit.
pub(super) fn shown(unit: &'static str) -> (f64, &'static str) {
    match unit {
        "m" => (1e3, "mm"),
        "Pa" => (1e-9, "GPa"),
        "rad" => (180.0 / core::f64::consts::PI, "°"),
        other => (1.0, other),
    }
}

/// The path, with the file it belongs to where it is not of all.
pub(super) fn name(fit: &Fit, unknown: &Unknown) -> String {
    match unknown.experiment {
        Some(e) => format!("{} ({})", unknown.path(), fit.names[e]),
        None => unknown.path(),
    }
}

/// How the estimates go together.
pub fn correlations(fit: &Fit) -> Table {
    let found = &fit.found;
    let mut columns = vec![(String::new(), Align::Left)];
    columns.extend((1..=found.estimates.len()).map(|i| (i.to_string(), Align::Right)));
    let mut table = Table::new(columns);
    table.group();
    for (i, (estimate, row)) in found.estimates.iter().zip(&found.correlations).enumerate() {
        let mut cells = vec![format!("{} {}", i + 1, name(fit, &estimate.unknown))];
        cells.extend(row[..=i].iter().map(|cell| match cell {
            Some(value) => fixed(*value, 3),
            None => String::from("–"),
        }));
        table.row(cells);
    }
    table
}

/// The models side by side; empty where that was not asked for.
pub fn models(fit: &Fit) -> Table {
    let mut table = Table::new([
        ("model", Align::Left),
        ("RMS, mm", Align::Right),
        ("RMS, pixels", Align::Right),
        ("held out, mm", Align::Right),
        ("AIC above the best", Align::Right),
        ("BIC above the best", Align::Right),
    ]);
    for each in &fit.analyses.compared {
        let dash = || String::from("–");
        let value = |value: Option<f64>| value.map_or_else(dash, |value| fixed(value, 1));
        let found = each.fit.as_ref().ok();
        let (mm, pixels) =
            (found.and_then(|fit| fit.rms_distance), found.and_then(|fit| fit.rms_pixels));
        table.row(vec![
            each.model.to_string(),
            mm.map_or_else(dash, |rms| number(rms * 1e3, 4)),
            pixels.map_or_else(dash, |rms| number(rms, 4)),
            each.validated
                .as_ref()
                .and_then(|of| of.rms_distance)
                .map_or_else(dash, |rms| number(rms * 1e3, 4)),
            value(each.aic_above_best),
            value(each.bic_above_best),
        ]);
    }
    table
}

/// What was held out in turn; empty where that was not asked for.
pub fn held_out(fit: &Fit) -> Table {
    let mut table = Table::new([
        ("without", Align::Left),
        ("RMS of it, mm", Align::Right),
        ("RMS of it, pixels", Align::Right),
    ]);
    let Some(validated) = &fit.analyses.validated else { return table };
    let row = |what: String, mm: Option<f64>, pixels: Option<f64>| {
        let dash = || String::from("–");
        let mm = mm.map_or_else(dash, |rms| number(rms * 1e3, 4));
        vec![what, mm, pixels.map_or_else(dash, |rms| number(rms, 4))]
    };
    table.group();
    for fold in &validated.folds {
        let file = &fit.names[fold.experiment];
        let what = match (&fold.group, fold.step, fold.rows.as_slice()) {
            (Some(group), ..) if group.is_empty() => String::from("rows without a group"),
            (Some(group), ..) => format!("group {group}"),
            (None, Some(step), _) => format!("{file}, step {}", step + 1),
            (None, None, [first, .., last]) if !is_whole(fit, fold) => {
                format!("{file}, steps {} to {}", first.step + 1, last.step + 1)
            }
            _ => file.clone(),
        };
        table.row(row(what, fold.rms_distance, fold.rms_pixels));
    }
    table.group();
    table.row(row(String::from("all"), validated.rms_distance, validated.rms_pixels));
    table
}

/// Whether all rows of a file were held out.
fn is_whole(fit: &Fit, fold: &Fold) -> bool {
    let all = rows(&fit.experiments);
    let of_file = all.iter().filter(|row| row.experiment == fold.experiment);
    of_file.count() == fold.rows.len()
}

/// The first parameters alone, more and more of them; empty where that was not asked for.
pub fn ladder(fit: &Fit) -> Table {
    let mut table = Table::new([
        ("estimated", Align::Left),
        ("RMS, mm", Align::Right),
        ("held out, mm", Align::Right),
        ("RMS, pixels", Align::Right),
        ("held out, pixels", Align::Right),
    ]);
    for rung in &fit.analyses.ladder {
        let dash = || String::from("–");
        let mm = |rms: Option<f64>| rms.map_or_else(dash, |rms| number(rms * 1e3, 4));
        let pixels = |rms: Option<f64>| rms.map_or_else(dash, |rms| number(rms, 4));
        let held = rung.validated.as_ref();
        let last = rung.unknowns.checked_sub(1).and_then(|last| fit.found.estimates.get(last));
        table.row(vec![
            match last {
                None => String::from("nothing"),
                Some(estimate) if rung.unknowns == 1 => name(fit, &estimate.unknown),
                Some(estimate) => format!("and {}", name(fit, &estimate.unknown)),
            },
            mm(rung.rms_distance),
            mm(held.and_then(|of| of.rms_distance)),
            pixels(rung.rms_pixels),
            pixels(held.and_then(|of| of.rms_pixels)),
        ]);
    }
    table
}

/// Intervals by profile likelihood; empty where that was not asked for.
pub fn profiles(fit: &Fit) -> Table {
    let mut table = Table::new([
        ("parameter", Align::Left),
        ("95 % from", Align::Right),
        ("to", Align::Right),
        ("unit", Align::Left),
    ]);
    for profile in &fit.analyses.profiles {
        let unknown = &fit.found.estimates[profile.unknown].unknown;
        let (scale, unit) = shown(unknown.quantity.unit(&fit.found.robot));
        let end = |end: Option<f64>| {
            end.map_or_else(|| String::from("open"), |end| number(end * scale, 6))
        };
        let [from, to] = profile.interval;
        table.row(vec![name(fit, unknown), end(from), end(to), unit.to_owned()]);
    }
    table
}

/// How far off the fit is from what was not fitted; empty where that was not asked for.
pub fn not_fitted(fit: &Fit) -> Table {
    let mut table = Table::new([
        ("measurements", Align::Left),
        ("rows", Align::Right),
        ("RMS, mm", Align::Right),
        ("median, mm", Align::Right),
        ("RMS, pixels", Align::Right),
        ("worst row", Align::Left),
        ("mm", Align::Right),
    ]);
    let Some(test) = &fit.analyses.test else { return table };
    let dash = || String::from("–");
    let mm = |rms: Option<f64>| rms.map_or_else(dash, |rms| number(rms * 1e3, 4));
    let worst = test.rows.iter().filter_map(|(row, rms)| Some((row, (*rms)?)));
    let worst = worst.max_by(|a, b| a.1.total_cmp(&b.1));
    table.row(vec![
        fit.test_names.join(", "),
        test.rows.len().to_string(),
        mm(test.rms_distance),
        mm(test.median_distance()),
        test.rms_pixels.map_or_else(dash, |rms| number(rms, 4)),
        worst.map_or_else(dash, |(row, _)| fit.test_row(*row)),
        mm(worst.map(|(_, rms)| rms)),
    ]);
    table
}

/// What a reader must know to read the numbers rightly.
pub fn notes(fit: &Fit) -> Vec<String> {
    let warnings = fit.remarks().into_iter().map(|of| format!("! {}; {}", of.message, of.help));
    let unresolved = fit.found.unresolved.iter().map(|unresolved| format!("! {unresolved}"));
    let mut notes: Vec<String> = warnings.chain(unresolved).collect();
    notes.extend(repeats(&fit.analyses));
    let starts = fit.found.starts;
    if starts.tried > 1 {
        notes.push(format!(
            "best of {} starts: {} of them end{} at these estimates",
            starts.tried,
            starts.agree,
            if starts.agree == 1 { "s" } else { "" }
        ));
    }
    if let Some(test) = fit.analyses.test.as_ref().filter(|test| !test.skipped.is_empty()) {
        let first = &test.skipped[0];
        notes.push(format!(
            "! {} of the rows that were not fitted are left out, because the model has no answer to them; the first one, {}: {}",
            test.skipped.len(),
            fit.test_row(first.row),
            first.reason
        ));
    }
    for each in &fit.analyses.compared {
        match &each.fit {
            Err(error) => notes.push(format!("{}: {}", each.model, error.named(&fit.names))),
            Ok(found) if !found.status.is_converged() => {
                notes.push(format!("{}: the fit has not converged", each.model));
            }
            Ok(_) => {}
        }
    }
    let doubted = fit.found.residuals.iter().filter(|residual| is_outlier(residual.weight)).count();
    if doubted > 0 {
        let share = doubted as f64 / fit.found.residuals.len() as f64;
        notes.push(format!(
            "{} ({}) so far off as to count less than half",
            markers(doubted),
            percent(share)
        ));
    }
    notes
}

/// Every estimate, in SI.
pub fn estimates_csv(fit: &Fit) -> CsvTable {
    let mut csv = CsvTable::new([
        "parameter",
        "case",
        "unit",
        "value",
        "deviation",
        "least",
        "greatest",
        "derivatives",
    ]);
    for estimate in &fit.found.estimates {
        let case = estimate.unknown.experiment.map(|e| fit.names[e].as_str());
        csv.push([
            Cell::from(estimate.unknown.path().as_str()),
            case.map_or(Cell::Empty, Cell::from),
            Cell::from(estimate.unknown.quantity.unit(&fit.found.robot)),
            Cell::from(estimate.value),
            Cell::from(estimate.deviation),
            Cell::from(estimate.interval.map(|ends| ends[0])),
            Cell::from(estimate.interval.map(|ends| ends[1])),
            Cell::from(if estimate.by_differences { "differences" } else { "exact" }),
        ]);
    }
    csv
}

fn camera_name(file: &CaseFile, camera: usize) -> Cell {
    let known = file.measured.as_ref().and_then(|measured| measured.cameras.get(camera));
    known.map_or(Cell::Empty, |camera| Cell::from(camera.name.as_str()))
}

/// What is left of every marker, in m or pixels: the model less what was seen.
pub fn residuals_csv(fit: &Fit) -> CsvTable {
    let mut csv = CsvTable::new([
        "case",
        "step",
        "arc_length",
        "camera",
        "x",
        "y",
        "z",
        "u",
        "v",
        "weight",
        "rx",
        "ry",
        "rz",
    ]);
    for residual in &fit.found.residuals {
        let seen = &fit.experiments[residual.experiment].observations[residual.observation];
        let [x, y, z] = residual.difference.map(Cell::from);
        let mut row = vec![
            Cell::from(fit.names[residual.experiment].as_str()),
            Cell::from(seen.step + 1),
            Cell::from(arc_length(fit, residual.experiment, seen)),
        ];
        row.extend(match seen.seen {
            Seen::Position(_) => [Cell::Empty, x, y, z, Cell::Empty, Cell::Empty],
            Seen::Rotation { .. } => [(); 6].map(|()| Cell::Empty),
            Seen::Pixel { camera, .. } => {
                let none = || Cell::Empty;
                let name = camera_name(&fit.cases[residual.experiment], camera);
                [name, none(), none(), none(), x, y]
            }
        });
        row.push(Cell::from(residual.weight));
        row.extend(match seen.seen {
            Seen::Rotation { arm, .. } => residual.difference.map(|turn| Cell::from(turn / arm)),
            _ => [(); 3].map(|()| Cell::Empty),
        });
        csv.push(row);
    }
    csv
}

/// Where a marker sits, in m.
pub fn arc_length(fit: &Fit, experiment: usize, seen: &Observation) -> f64 {
    seen.place.arc_length(fit.cases[experiment].robot.disks())
}
