//! The distances between models and photograph as tables.

use whipcord_estimation::observation::{InImage, Rms};
use whipcord_io::{Cell, CsvTable};

use super::Run;
use super::seen::name;
use whipcord_study::quantity::{fixed, fixed_millimetres};
use whipcord_study::table::{Align, Table};

/// For people: each marker, then the root mean square.
pub fn table(runs: &[Run], markers: &[InImage], length: f64) -> Table {
    let answered = || runs.iter().filter_map(|run| Some((run, run.outcome.as_ref().ok()?)));
    let mut columns = vec![(String::from("disk"), Align::Right)];
    for (run, _) in answered() {
        columns.push((format!("{}, px", run.model), Align::Right));
        columns.push((String::from("mm"), Align::Right));
        columns.push((String::from("% of length"), Align::Right));
    }
    let mut table = Table::new(columns);
    let cells = |pixels: f64, distance: f64| {
        [fixed(pixels, 1), fixed_millimetres(distance, 2), fixed(1e2 * distance / length, 2)]
    };
    let unseen = || [const { String::new() }; 3];
    table.group();
    for (i, marker) in markers.iter().enumerate() {
        let mut row = vec![name(marker)];
        for (_, superposed) in answered() {
            let miss = superposed.residuals[i];
            row.extend(miss.map_or_else(unseen, |miss| cells(miss.pixels, miss.distance)));
        }
        table.row(row);
    }
    table.group();
    let mut row = vec![String::from("RMS")];
    for (_, superposed) in answered() {
        let rms = superposed.rms(markers);
        row.extend(rms.map_or_else(unseen, |Rms { pixels, distance }| cells(pixels, distance)));
    }
    table.row(row);
    table
}

/// For programs: a line for each model and marker, in SI and pixels.
pub fn csv(runs: &[Run], markers: &[InImage]) -> CsvTable {
    let mut csv = CsvTable::new(vec![
        "model",
        "disk",
        "arc_length",
        "offset_x",
        "offset_y",
        "offset_z",
        "u_measured",
        "v_measured",
        "u",
        "v",
        "distance_in_image",
        "distance",
    ]);
    for run in runs {
        let Ok(superposed) = &run.outcome else { continue };
        for (marker, miss) in markers.iter().zip(&superposed.residuals) {
            let mut row = vec![
                Cell::from(run.model.name()),
                Cell::from(marker.disk().map(|disk| disk as f64)),
                Cell::from(marker.arc_length),
            ];
            row.extend(marker.seen.offset.to_array().map(Cell::from));
            row.extend(marker.pixel.map(Cell::from));
            match miss {
                Some(miss) => {
                    row.extend(miss.pixel.map(Cell::from));
                    row.extend([miss.pixels, miss.distance].map(Cell::from));
                }
                None => row.resize(12, Cell::Empty),
            }
            csv.push(row);
        }
    }
    csv
}
