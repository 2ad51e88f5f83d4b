//! What the rows of a table say that was seen.

use std::borrow::Cow;
use std::collections::HashMap;

use whipcord::robot::limits::{COORDINATE, LENGTH};
use whipcord::{UnitQuaternion, Vec3};
use whipcord_estimation::{Observation, Place, Seen};

use super::super::commands::CommandTable;
use super::super::table::{Cell, Grid, Row, problem};
use super::columns::{Column, HEADER, Read, columns};
use super::{Known, Marker, MeasuredRotation, extent};
use crate::error::Problems;
use crate::source::{Span, quoted};
use crate::suggest;
use crate::units::{Dimension, listed, parse_quantity};

/// Unit quaternions that were rounded to two decimals have norms that differ from 1 by less.
const ROUNDED_NORM: f64 = 0.02;
/// No image is so large.
const FARTHEST_PIXEL: f64 = 1e6;

pub(super) const PIXELS: &str =
    "u is the column and v the row in pixels, the centre of the first pixel at (0, 0)";

/// All that was seen, by step, then by place, and the orientations of tracked bodies. `None` when something was refused, which
/// has been reported.
pub(super) fn observations(
    grid: &Grid,
    known: &Known<'_>,
    problems: &mut Problems,
) -> Option<(Vec<Observation>, Vec<MeasuredRotation>)> {
    let columns = columns(grid, known, problems)?;
    let has = |column| columns.iter().any(|read| read.column == column);
    let steps = match known.rows() {
        Some(rows) if !has(Column::Step) => {
            let key = columns.iter().position(|read| read.column == Column::Key);
            Some(steps_of_rows(grid, key, rows, known, problems)?)
        }
        _ => None,
    };
    let is_tip = known.rows().is_some() && !has(Column::Disk) && !has(Column::ArcLength);
    let mut reader = Reader {
        columns,
        known,
        problems,
        refused: false,
        other_unit: false,
        marker: None,
        is_tip,
    };
    let (mut seen, mut rotations) = (Vec::new(), Vec::new());
    let mut first = HashMap::new();
    let markers: Vec<Option<usize>> = match known.markers.len() {
        0 => vec![None],
        count => (0..count).map(Some).collect(),
    };
    for (number, row) in grid.rows.iter().enumerate() {
        let step = match &steps {
            Some(steps) => steps[number],
            None => reader.step(row),
        };
        // The row is not measured, or its step is refused.
        let Some(step) = step else { continue };
        for marker in &markers {
            reader.marker = *marker;
            if let Some(rotation) = reader.rotation(row, step) {
                rotations.push(rotation);
            }
            let Some(observation) = reader.row(row, step) else { continue };
            let offset = observation.offset.to_array().map(f64::to_bits);
            let camera = match observation.seen {
                Seen::Pixel { camera, .. } => Some(camera),
                _ => None,
            };
            let key = (observation.step, order(observation.place).to_bits(), offset, camera);
            if let Some(first) = first.get(&key) {
                let related = Some((*first, "it is first given here"));
                let message = match known.rows() {
                    Some(rows) => format!(
                        "{} is given twice for {}",
                        named(observation.place, is_tip),
                        rows.label(observation.step)
                    ),
                    None => format!("{} is given twice", named(observation.place, is_tip)),
                };
                let help = match is_tip {
                    true => {
                        "give each row of commands one line; or add the column `disk` or `arc_length` where the lines are of several markers"
                    }
                    false => {
                        "give each disk one line in each step, or markers beside it their offset"
                    }
                };
                reader.problems.push_related(row.span, related, || problem(message, help));
                reader.refused = true;
            } else {
                first.insert(key, row.span);
                seen.push(observation);
            }
        }
    }
    if reader.refused {
        return None;
    }
    if seen.is_empty() {
        let message = "nothing was measured: all positions are missing";
        problems.push(grid.header, || problem(message, HEADER));
        return None;
    }
    let unit = reader.unit(Column::ArcLength);
    if let Some((message, help)) = extent::arc_lengths(&seen, unit, known) {
        let header = grid.columns.iter().zip(&reader.columns);
        let mut header = header.filter(|(_, read)| read.column == Column::ArcLength);
        let span = header.next().map_or(grid.header, |(cell, _)| cell.span);
        problems.push(span, || problem(message, help));
        return None;
    }
    seen.sort_by(|a, b| a.step.cmp(&b.step).then(order(a.place).total_cmp(&order(b.place))));
    Some((seen, rotations))
}

/// The row of commands, from 0, that each line belongs to; none for one that is not measured.
fn steps_of_rows(
    grid: &Grid,
    key: Option<usize>,
    rows: &CommandTable,
    known: &Known<'_>,
    problems: &mut Problems,
) -> Option<Vec<Option<usize>>> {
    let measured = |row: &usize| rows.rows[*row].is_measured;
    if known.same_file {
        return Some((0..rows.rows.len()).map(|row| Some(row).filter(measured)).collect());
    }
    if let Some(key) = key {
        let by_key: HashMap<&str, usize> = rows
            .rows
            .iter()
            .enumerate()
            .filter_map(|(number, row)| Some((row.key.as_deref()?, number)))
            .collect();
        let mut refused = false;
        let mut steps = Vec::with_capacity(grid.rows.len());
        for row in &grid.rows {
            let cell = &row.cells[key];
            let step = cell.value.text().and_then(|text| by_key.get(text).copied());
            if step.is_none() && !problems.is_full() {
                refused = true;
                match cell.value.text() {
                    None => problems.push(row.span, || {
                        problem("this line has no key", "give the key of its row of commands")
                    }),
                    Some(text) => {
                        let keys = rows.rows.iter().filter_map(|row| row.key.as_deref());
                        let near = suggest::nearest(text, keys);
                        let near = near.map(|near| format!("did you mean `{near}`? "));
                        let message = format!(
                            "no row of `{}` has the key `{}`",
                            rows.path.display(),
                            quoted(text)
                        );
                        let help = format!(
                            "{}leave out lines without commands, or add the row there",
                            near.unwrap_or_default()
                        );
                        problems.push(cell.span, || problem(message, help));
                    }
                }
            }
            steps.push(step.filter(measured));
        }
        return (!refused).then_some(steps);
    }
    if let Some(key) = known.key.filter(|_| rows.key.is_some()) {
        let message = format!("there is no column `{}`, by which rows are found", quoted(key));
        let help = "add it; or name the column of the keys in `key` of [measured]";
        problems.push(grid.header, || problem(message, help));
        return None;
    }
    let all: Vec<Option<usize>> = (0..rows.rows.len()).filter(measured).map(Some).collect();
    if all.len() != grid.rows.len() {
        let message = format!(
            "the table has {} lines, but {} rows of `{}` are measured",
            grid.rows.len(),
            all.len(),
            rows.path.display()
        );
        let help = "give each of these rows one line, with empty cells where nothing was seen; or find rows by a column that `key` of [commands] names, or by a column `step` with the number of the row";
        problems.push(grid.header, || problem(message, help));
        return None;
    }
    Some(all)
}

/// Disks by their number, then arc lengths.
fn order(place: Place) -> f64 {
    match place {
        Place::Disk(disk) => disk as f64,
        Place::ArcLength(arc_length) => 1e9 + arc_length,
    }
}

/// A place in the words of the table: where no column says places it is that of the tip.
fn named(place: Place, is_tip: bool) -> String {
    match place {
        _ if is_tip => "the tip".to_owned(),
        Place::Disk(disk) => format!("disk {}", disk + 1),
        Place::ArcLength(arc_length) => format!("the marker at arc length {arc_length} m"),
    }
}

struct Reader<'a> {
    columns: Vec<Read>,
    known: &'a Known<'a>,
    problems: &'a mut Problems,
    refused: bool,
    /// Whether arc lengths in another unit than the file says have been reported.
    other_unit: bool,
    /// The marker of [[measured.markers]] that is read.
    marker: Option<usize>,
    /// Whether lines are of the tip, as no column says where markers are.
    is_tip: bool,
}

impl Reader<'_> {
    /// What a row says that was seen in a step; `None` when the marker was not seen, or the row is refused.
    fn row(&mut self, row: &Row, step: usize) -> Option<Observation> {
        let before = self.refused;
        self.refused = false;
        let place = self.place(row);
        let usual = self.declared().map_or(self.known.offset, |marker| marker.offset);
        let usual = usual.to_array();
        let offset = self.lengths(row, Column::Offset);
        let seen = self.seen(row);
        let deviation = self.deviation(row, seen);
        let refused = core::mem::replace(&mut self.refused, before);
        self.refused |= refused;
        let (offset, place, seen) = (offset?, place?, seen?);
        let [x, y, z] = [0, 1, 2].map(|axis| offset[axis].unwrap_or(usual[axis]));
        let offset = Vec3::new(x, y, z);
        (!refused).then_some(Observation { step, place, offset, seen, deviation })
    }

    /// The marker of [[measured.markers]] that is read.
    fn declared(&self) -> Option<&Marker<'_>> {
        self.known.markers.get(self.marker?)
    }

    /// The orientation of the tracked body in a row; `None` where it was not seen, or is refused.
    fn rotation(&mut self, row: &Row, step: usize) -> Option<MeasuredRotation> {
        const HELP: &str =
            "give qw, qx, qy and qz, or leave all four empty where the body was not seen";
        self.columns.iter().find(|read| matches!(read.column, Column::Orientation(_)))?;
        let parts = [0, 1, 2, 3].map(|part| self.number(row, Column::Orientation(part), HELP));
        match parts {
            [Some(w), Some(x), Some(y), Some(z)] => {
                let norm = (w * w + x * x + y * y + z * z).sqrt();
                if norm > 0.0 && (norm - 1.0).abs() > ROUNDED_NORM {
                    let message =
                        format!("the quaternion has the norm {norm:.4}, but rotations have 1");
                    let help = "give the unit quaternion (qw, qx, qy, qz) with three decimals or more; angles or rotation vectors are no quaternion";
                    self.refuse(row.span, message, help);
                    return None;
                }
                let Some(rotation) = UnitQuaternion::from_wxyz([w, x, y, z]) else {
                    self.refuse(row.span, "the quaternion is zero".to_owned(), HELP);
                    return None;
                };
                Some(MeasuredRotation { step, place: self.place(row)?, rotation })
            }
            [None, None, None, None] => None,
            _ if self.refused => None,
            _ => {
                self.refuse(row.span, "a part of the orientation is missing".to_owned(), HELP);
                None
            }
        }
    }

    /// Standard deviation in m or pixels.
    fn deviation(&mut self, row: &Row, seen: Option<Seen>) -> Option<f64> {
        let (given, usual, unit) = match seen? {
            Seen::Position(_) | Seen::Rotation { .. } => {
                (self.length(row, Column::Deviation), self.known.deviation, "m")
            }
            Seen::Pixel { .. } => {
                let given = self.number(row, Column::Deviation, PIXELS);
                (given, self.known.pixel_deviation, "pixels")
            }
        };
        if let Some(value) = given.filter(|value| *value <= 0.0) {
            let span = self.cell(row, Column::Deviation).map_or(row.span, |cell| cell.span);
            let message = format!("a standard deviation must be above 0, but is {value} {unit}");
            self.refuse(span, message, "leave it empty where it is not known");
        }
        given.or(usual)
    }

    /// The position or the place in an image; `None` when the marker was not seen, or is refused.
    fn seen(&mut self, row: &Row) -> Option<Seen> {
        let (position, pixel) = (self.position(row), self.pixel(row));
        match (position, pixel) {
            (Some(_), Some(_)) => {
                let message = "this line has both a position and a place in an image".to_owned();
                self.refuse(row.span, message, "write them on two lines");
                None
            }
            (position, pixel) => position.map(Seen::Position).or(pixel),
        }
    }

    fn pixel(&mut self, row: &Row) -> Option<Seen> {
        let pixel = [0, 1].map(|axis| self.number(row, Column::Pixel(axis), PIXELS));
        let pixel = match pixel {
            [Some(u), Some(v)] => [u, v],
            [None, None] => return None,
            _ if self.refused => return None,
            _ => {
                let message = "a part of the place in the image is missing".to_owned();
                self.refuse(
                    row.span,
                    message,
                    "give u and v, or leave both empty where the marker was not seen",
                );
                return None;
            }
        };
        let most = FARTHEST_PIXEL;
        if let Some(value) = pixel.into_iter().find(|value| value.abs() > most) {
            self.refuse(
                row.span,
                format!("a pixel must be at most {most}, but is {value:?}"),
                PIXELS,
            );
            return None;
        }
        Some(Seen::Pixel { camera: self.camera(row)?, pixel })
    }

    /// Number of the camera that is named.
    fn camera(&mut self, row: &Row) -> Option<usize> {
        let cell = self.cell(row, Column::Camera);
        let named = cell.and_then(|cell| Some((cell.value.text()?, cell.span)));
        let cameras = self.known.cameras;
        if self.known.one_photograph {
            return Some(0);
        }
        let Some((name, span)) = named else {
            if cameras.len() > 1 {
                let message = "this line does not say which camera saw the marker".to_owned();
                self.refuse(row.span, message, "give the camera's name");
                return None;
            }
            return Some(0);
        };
        let found = cameras.iter().position(|camera| *camera == name);
        if found.is_none() {
            let known = listed(cameras.iter().copied(), "and");
            let message = format!("there is no camera `{}`: the file has {known}", quoted(name));
            self.refuse(
                span,
                message,
                "cameras have the names that [[measured.cameras]] gives them",
            );
        }
        found
    }

    fn cell<'r>(&self, row: &'r Row, column: Column) -> Option<&'r Cell> {
        let marker = self.marker.filter(|_| column.is_of_marker());
        let found = |read: &Read| (read.column, read.marker) == (column, marker);
        self.columns.iter().position(found).and_then(|i| row.cells.get(i))
    }

    /// A column of the marker that is read.
    fn read(&self, column: Column) -> Option<&Read> {
        let marker = self.marker.filter(|_| column.is_of_marker());
        self.columns.iter().find(|read| (read.column, read.marker) == (column, marker))
    }

    /// Unit of the lengths in a column.
    fn unit(&self, column: Column) -> &'static str {
        self.read(column).map_or(self.known.unit, |read| read.unit)
    }

    /// How the lengths of a column are written.
    fn how(&self, column: Column) -> String {
        let unit = self.unit(column);
        let whence = match self.read(column).is_some_and(|read| read.names_unit) {
            true => ", which the name of the column says",
            false => {
                ", or in another unit that the column names, as `x [mm]`, or `unit` of [measured]"
            }
        };
        format!("write lengths as plain numbers with a decimal point, in {unit}{whence}")
    }

    fn refuse(&mut self, span: Span, message: String, help: impl Into<Cow<'static, str>>) {
        self.problems.push(span, || problem(message, help));
        self.refused = true;
    }

    /// A number; `None` when it is missing or refused.
    fn number(
        &mut self,
        row: &Row,
        column: Column,
        help: impl Into<Cow<'static, str>>,
    ) -> Option<f64> {
        let cell = self.cell(row, column)?;
        let text = cell.value.text()?;
        let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
        if number.is_none() {
            self.refuse(cell.span, format!("`{}` is not a finite number", quoted(text)), help);
        }
        number
    }

    /// A length in m.
    fn length(&mut self, row: &Row, column: Column) -> Option<f64> {
        let how = self.how(column);
        self.number(row, column, how.clone())?;
        let cell = self.cell(row, column)?;
        // The decimal digits are shifted, so that 0.3 mm is the very number that 0.0003 m is.
        let text = format!("{} {}", cell.value.text()?, self.unit(column));
        let (value, _) = parse_quantity(&text, &[Dimension::Length]).ok()?;
        if let Some(problem) = COORDINATE.problem(value) {
            self.refuse(cell.span, format!("a length {problem}"), how);
            return None;
        }
        Some(value)
    }

    /// Three lengths in m, each of which may be missing; `None` when one is refused.
    fn lengths(&mut self, row: &Row, column: fn(usize) -> Column) -> Option<[Option<f64>; 3]> {
        let before = core::mem::replace(&mut self.refused, false);
        let values = [0, 1, 2].map(|axis| self.length(row, column(axis)));
        let refused = core::mem::replace(&mut self.refused, before);
        self.refused |= refused;
        (!refused).then_some(values)
    }

    fn position(&mut self, row: &Row) -> Option<Vec3> {
        match self.lengths(row, Column::Position)? {
            [Some(x), Some(y), Some(z)] => Some(Vec3::new(x, y, z)),
            [None, None, None] => None,
            _ => {
                let message = "a part of the position is missing".to_owned();
                let help =
                    "give x, y and z, or leave all three empty where the marker was not seen";
                self.refuse(row.span, message, help);
                None
            }
        }
    }

    fn step(&mut self, row: &Row) -> Option<usize> {
        const HELP: &str = "steps are numbered from 1, in the order of [[steps]]";
        let most = self.known.robot.steps.max(1);
        if self.known.one_photograph {
            return Some(0);
        }
        let Some(cell) = self.cell(row, Column::Step) else { return Some(most - 1) };
        let Some(step) = self.number(row, Column::Step, HELP) else {
            if cell.value.text().is_none() {
                self.refuse(row.span, "this line has no step".to_owned(), HELP);
            }
            return None;
        };
        if step.fract() != 0.0 || step < 1.0 || step > most as f64 {
            let message = format!("there is no step {step}: the file has steps 1 to {most}");
            self.refuse(cell.span, message, HELP);
            return None;
        }
        Some(step as usize - 1)
    }

    fn place(&mut self, row: &Row) -> Option<Place> {
        const HELP: &str = "disks are numbered from 1, the base disk";
        const NO_DISKS: &str =
            "give the column `arc_length` instead of `disk`, or add [disks] to the robot file";
        if let Some(marker) = self.declared() {
            return Some(marker.place);
        }
        if self.is_tip {
            return self.known.robot.tip();
        }
        let given = |reader: &Self, column| {
            reader.cell(row, column).filter(|cell| cell.value.text().is_some())
        };
        match (given(self, Column::Disk), given(self, Column::ArcLength)) {
            (Some(cell), None) => {
                let disk = self.number(row, Column::Disk, HELP)?;
                let most = self.known.robot.disks.unwrap_or(usize::MAX);
                if disk.fract() != 0.0 || disk < 1.0 || disk > most as f64 {
                    let message = match self.known.robot.disks {
                        Some(0) => {
                            self.refuse(cell.span, "the robot has no disks".to_owned(), NO_DISKS);
                            return None;
                        }
                        Some(count) => {
                            format!("there is no disk {disk}: the robot has disks 1 to {count}")
                        }
                        None => format!("there is no disk {disk}"),
                    };
                    self.refuse(cell.span, message, HELP);
                    return None;
                }
                Some(Place::Disk(disk as usize - 1))
            }
            (None, Some(cell)) => {
                let arc_length = self.length(row, Column::ArcLength)?;
                let most = self.known.robot.length.unwrap_or(LENGTH.greatest);
                // Rounding by whoever wrote the table puts no marker beyond the tip.
                if arc_length < 0.0 || arc_length > most * (1.0 + 1e-6) {
                    let message = format!(
                        "there is no arc length {arc_length} m: the backbone goes from 0 to {most} m"
                    );
                    let unit = self.unit(Column::ArcLength);
                    match extent::smaller_unit(arc_length, unit, most) {
                        // One mistake, and not one for each line.
                        Some(_) if self.other_unit => self.refused = true,
                        Some(smaller) => {
                            self.other_unit = true;
                            let help = format!(
                                "the arc lengths are read in {unit}: if they are in {smaller}, name the column `arc_length [{smaller}]`, or write `unit = \"{smaller}\"` under [measured] where all lengths of the file are"
                            );
                            self.refuse(cell.span, message, help);
                        }
                        None => self.refuse(
                            cell.span,
                            message,
                            "arc lengths are those of the straight backbone, from its base",
                        ),
                    }
                    return None;
                }
                Some(Place::ArcLength(arc_length.min(most)))
            }
            (disk, _) => {
                let message = if disk.is_some() {
                    "this line has both a disk and an arc length"
                } else {
                    "this line does not say where on the robot the marker is"
                };
                self.refuse(row.span, message.to_owned(), "give its `disk` or its `arc_length`");
                None
            }
        }
    }
}
