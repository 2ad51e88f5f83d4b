//! A fit in tables, for people and as CSV.

use whipcord_estimation::identification::{Estimate, Unknown};
use whipcord_estimation::{Observation, Seen};
use whipcord_io::{CaseFile, Cell, CsvTable};

use super::Fit;
use super::figures::is_outlier;
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
    for (title, table) in [("Models", models(fit)), ("Held out in turn", held_out(fit))] {
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

/// One line on the whole.
pub fn heading(fit: &Fit) -> String {
    let found = &fit.found;
    let files = match fit.cases.as_slice() {
        [one] => one.title.clone(),
        several => format!("{} files", several.len()),
    };
    let mut parts = vec![format!("{files}: {}", markers(found.residuals.len()))];
    parts.extend(found.rms_distance.map(|rms| format!("RMS distance {} mm", number(rms * 1e3, 3))));
    parts.extend(found.rms_pixels.map(|rms| format!("RMS distance {} pixels", number(rms, 3))));
    let level = found.noise.level;
    parts.push(match (found.noise.is_estimated, found.rms_distance.is_some()) {
        (true, true) => format!("noise {} mm in each coordinate", number(level * 1e3, 3)),
        (true, false) => format!("noise {} pixels in each coordinate", number(level, 3)),
        (false, _) => format!("noise {} × what the measurements say", number(level, 3)),
    });
    format!("{} fitted by {}", parts.join(", "), found.model)
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
        let (scale, unit) = shown(estimate.unknown.quantity.unit());
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
fn shown(unit: &'static str) -> (f64, &'static str) {
    match unit {
        "m" => (1e3, "mm"),
        "Pa" => (1e-9, "GPa"),
        "rad" => (180.0 / core::f64::consts::PI, "°"),
        other => (1.0, other),
    }
}

/// The path, with the file it belongs to where it is not of all.
fn name(fit: &Fit, unknown: &Unknown) -> String {
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
        ("AIC above the best", Align::Right),
        ("BIC above the best", Align::Right),
    ]);
    for each in &fit.compared {
        let dash = || String::from("–");
        let value = |value: Option<f64>| value.map_or_else(dash, |value| fixed(value, 1));
        let found = each.fit.as_ref().ok();
        let (mm, pixels) =
            (found.and_then(|fit| fit.rms_distance), found.and_then(|fit| fit.rms_pixels));
        table.row(vec![
            each.model.to_string(),
            mm.map_or_else(dash, |rms| number(rms * 1e3, 4)),
            pixels.map_or_else(dash, |rms| number(rms, 4)),
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
    let Some(validated) = &fit.validated else { return table };
    let row = |what: String, mm: Option<f64>, pixels: Option<f64>| {
        let dash = || String::from("–");
        let mm = mm.map_or_else(dash, |rms| number(rms * 1e3, 4));
        vec![what, mm, pixels.map_or_else(dash, |rms| number(rms, 4))]
    };
    table.group();
    for fold in &validated.folds {
        let file = &fit.names[fold.experiment];
        let what = match fold.step {
            Some(step) => format!("{file}, step {}", step + 1),
            None => file.clone(),
        };
        table.row(row(what, fold.rms_distance, fold.rms_pixels));
    }
    table.group();
    table.row(row(String::from("all"), validated.rms_distance, validated.rms_pixels));
    table
}

/// What a reader must know to read the numbers rightly.
pub fn notes(fit: &Fit) -> Vec<String> {
    let warnings = fit.remarks().into_iter().map(|of| format!("! {}; {}", of.message, of.help));
    let unresolved = fit.found.unresolved.iter().map(|unresolved| format!("! {unresolved}"));
    let mut notes: Vec<String> = warnings.chain(unresolved).collect();
    for each in &fit.compared {
        match &each.fit {
            Err(error) => notes.push(format!("{}: {error}", each.model)),
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
            Cell::from(estimate.unknown.quantity.unit()),
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
    let mut csv =
        CsvTable::new(["case", "step", "arc_length", "camera", "x", "y", "z", "u", "v", "weight"]);
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
            Seen::Pixel { camera, .. } => {
                let none = || Cell::Empty;
                let name = camera_name(&fit.cases[residual.experiment], camera);
                [name, none(), none(), none(), x, y]
            }
        });
        row.push(Cell::from(residual.weight));
        csv.push(row);
    }
    csv
}

/// Where a marker sits, in m.
pub fn arc_length(fit: &Fit, experiment: usize, seen: &Observation) -> f64 {
    seen.place.arc_length(fit.cases[experiment].robot.disks())
}
