//! The score for programs: JSON and CSV, in SI units.

use serde_json::{Map, Value, json};
use whipcord::{LengthMiss, Pose};
use whipcord_io::{Cell, CsvTable, length_misses_json};

use super::{FileScore, Measures, RowScore, Score, Summary};
use crate::remark::Remark;

/// All of it; `rows` adds every row of every file.
#[must_use]
pub fn json(score: &Score<'_>, rows: bool) -> Value {
    let models = score.models.iter().enumerate().map(|(number, model)| {
        let mut object = summary(score, &score.summary(number));
        object.insert("model".to_owned(), model.name().into());
        Value::Object(object)
    });
    let files = score.subjects.iter().enumerate().map(|(file, subject)| {
        let models = score.files[file].iter().enumerate().map(|(number, of)| {
            let mut object = summary(score, &score.of_file(file, number));
            object.insert("model".to_owned(), of.model.name().into());
            object.insert("motion".to_owned(), motion(of.motion.as_ref()));
            if rows {
                let rows = of.rows.iter().map(|row| self::row(score, file, row));
                object.insert("rows_scored".to_owned(), rows.collect());
            }
            Value::Object(object)
        });
        let of = subject.file;
        json!({
            "file": of.path.display().to_string(),
            "title": of.title,
            "length": of.robot.backbone().length,
            "rows": subject.rows.len(),
            "each": if of.case.independent { "independent" } else { "in order" },
            "registration": of.measured.as_ref().map(|measured| measured.alignment.name()),
            "models": models.collect::<Vec<_>>(),
        })
    });
    let mirrored = (0..score.subjects.len()).filter_map(|file| {
        let Remark { code, message, help } = score.mirrored(file)?;
        let path = score.file(file).path.display().to_string();
        Some(json!({ "code": code, "message": message, "help": help, "file": path }))
    });
    let single = score.single_cable.iter().map(
        |Remark { code, message, help }| json!({ "code": code, "message": message, "help": help }),
    );
    let warnings: Vec<Value> = single.chain(mirrored).collect();
    json!({
        "models": models.collect::<Vec<_>>(),
        "files": files.collect::<Vec<_>>(),
        "warnings": warnings,
    })
}

fn motion(motion: Option<&Pose>) -> Value {
    motion.map_or(Value::Null, |Pose { position, rotation }| {
        json!({ "position": position.to_array(), "orientation": rotation.wxyz() })
    })
}

fn summary(score: &Score<'_>, of: &Summary) -> Map<String, Value> {
    let measures = |of: Option<Measures>| {
        of.map_or(Value::Null, |of| {
            json!({
                "rms": of.rms,
                "median": of.median,
                "percentile_95": of.percentile_95,
                "worst": of.worst,
            })
        })
    };
    let worst = of.worst.map(|worst| {
        let row = RowPlace::of(score, worst.file, worst.row);
        json!({
            "file": score.file(worst.file).path.display().to_string(),
            "row": worst.row + 1,
            "line": row.line,
            "key": row.key,
            "error": worst.error,
        })
    });
    let reasons = of.reasons.iter().map(|(reason, rows)| json!({ "reason": reason, "rows": rows }));
    let object = json!({
        "rows": of.rows,
        "compared": of.compared,
        "refused": of.refused,
        "failed": of.failed,
        "unstable": of.unstable,
        "over_determined": of.over_determined,
        "down_weighted": of.down_weighted,
        "greatest_miss": of.greatest_miss.as_ref().map(|most| json!({
            "file": score.file(most.file).path.display().to_string(),
            "row": most.row + 1,
            "cable": most.miss.cable,
            "excess": most.miss.excess,
        })),
        "markers": of.markers,
        "distance": measures(of.distances),
        "relative": measures(of.relative),
        "angle": measures(of.angles),
        "worst_row": worst,
        "reasons": reasons.collect::<Vec<_>>(),
    });
    match object {
        Value::Object(object) => object,
        _ => Map::new(),
    }
}

/// What a file says of a row.
struct RowPlace<'a> {
    line: Option<usize>,
    key: Option<&'a str>,
    group: Option<&'a str>,
    time: Option<f64>,
}

impl<'a> RowPlace<'a> {
    fn of(score: &Score<'a>, file: usize, row: usize) -> Self {
        let of_file = score.file(file);
        let of = of_file.commands.as_ref().and_then(|table| table.rows.get(row));
        Self {
            line: of.map(|of| of.line),
            key: of.and_then(|of| of.key.as_deref()),
            group: of.and_then(|of| of.group.as_deref()),
            time: of.and_then(|of| of.time),
        }
    }
}

fn row(score: &Score<'_>, file: usize, row: &RowScore) -> Value {
    let place = RowPlace::of(score, file, row.row);
    json!({
        "row": row.row + 1,
        "line": place.line,
        "key": place.key,
        "status": status(row),
        "down_weighted": row.down_weighted,
        "reason": row.failure.as_ref().map(ToString::to_string),
        "length_misses": length_misses_json(&row.misses),
        "error": row.error,
        "angle": row.angle,
    })
}

fn status(row: &RowScore) -> &'static str {
    match row {
        RowScore { failure: Some(_), .. } => "failed",
        RowScore { unstable: true, .. } => "unstable",
        RowScore { error: None, angle: None, .. } => "not compared",
        RowScore { misses, .. } if !misses.is_empty() => "least-squares",
        _ => "solved",
    }
}

/// A line for each model over all files, and one for each model on each file.
#[must_use]
pub fn summary_csv(score: &Score<'_>) -> CsvTable {
    let mut table = CsvTable::new([
        "file",
        "model",
        "rows",
        "compared",
        "refused",
        "failed",
        "unstable",
        "over_determined",
        "down_weighted",
        "markers",
        "rms",
        "median",
        "percentile_95",
        "worst",
        "worst_row",
        "rms_relative",
        "median_relative",
        "percentile_95_relative",
        "worst_relative",
        "angle_rms",
        "angle_worst",
    ]);
    let mut add = |file: Cell, model: &str, of: &Summary| {
        let mut row: Vec<Cell> = vec![file, model.into()];
        row.extend(
            [
                of.rows,
                of.compared,
                of.refused,
                of.failed,
                of.unstable,
                of.over_determined,
                of.down_weighted,
                of.markers,
            ]
            .map(Cell::from),
        );
        let measures = |of: Option<Measures>| match of {
            Some(of) => [of.rms, of.median, of.percentile_95, of.worst].map(Cell::Number),
            None => core::array::from_fn(|_| Cell::Empty),
        };
        row.extend(measures(of.distances));
        row.push(of.worst.map_or(Cell::Empty, |worst| Cell::from(worst.row + 1)));
        row.extend(measures(of.relative));
        let [rms, _, _, worst] = measures(of.angles);
        row.extend([rms, worst]);
        table.push(row);
    };
    for (model, kind) in score.models.iter().enumerate() {
        add(Cell::Empty, kind.name(), &score.summary(model));
        for (file, subject) in
            score.subjects.iter().enumerate().filter(|_| score.subjects.len() > 1)
        {
            let path = subject.file.path.display().to_string();
            add(Cell::Text(path), kind.name(), &score.of_file(file, model));
        }
    }
    table
}

/// A line for each row of each file and each model.
#[must_use]
pub fn rows_csv(score: &Score<'_>) -> CsvTable {
    let mut table = CsvTable::new([
        "file",
        "row",
        "line",
        "key",
        "group",
        "time",
        "model",
        "status",
        "down_weighted",
        "error",
        "error_relative",
        "angle",
        "reason",
    ]);
    for (file, subject) in score.subjects.iter().enumerate() {
        let path = subject.file.path.display().to_string();
        let length = subject.file.robot.backbone().length;
        for (place, number) in subject.rows.iter().enumerate() {
            let of = RowPlace::of(score, file, *number);
            for model in &score.files[file] {
                let Some(row) = model.rows.get(place) else { continue };
                table.push([
                    Cell::Text(path.clone()),
                    Cell::from(row.row + 1),
                    of.line.map_or(Cell::Empty, Cell::from),
                    of.key.map_or(Cell::Empty, Cell::from),
                    of.group.map_or(Cell::Empty, Cell::from),
                    of.time.map_or(Cell::Empty, Cell::Number),
                    model.model.name().into(),
                    status(row).into(),
                    if row.down_weighted { "yes" } else { "no" }.into(),
                    row.error.map_or(Cell::Empty, Cell::Number),
                    row.error.map_or(Cell::Empty, |error| Cell::Number(error / length)),
                    row.angle.map_or(Cell::Empty, Cell::Number),
                    reason(model, row).map_or(Cell::Empty, Cell::Text),
                ]);
            }
        }
    }
    table
}

fn reason(model: &FileScore, row: &RowScore) -> Option<String> {
    match &row.failure {
        Some(failure) => Some(failure.to_string()),
        None if row.error.is_none() => model.incomparable.clone(),
        None if !row.misses.is_empty() => Some(format!(
            "the cable lengths contradict each other: {}",
            LengthMiss::describe(&row.misses, " is")
        )),
        None => None,
    }
}
