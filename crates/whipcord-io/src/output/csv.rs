use core::fmt::Write as _;

use whipcord::{Contact, Obstacle, Shape, Solution, Vec3};

use super::NonFinite;

/// A table to be written as CSV (RFC 4180, lines ended by a line feed).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CsvTable {
    columns: Vec<String>,
    rows: Vec<Vec<Cell>>,
}

/// One value of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// A number, written so that reading gives it back exactly.
    Number(f64),
    /// A whole number.
    Integer(i64),
    /// A text.
    Text(String),
    /// Nothing.
    Empty,
}

impl CsvTable {
    /// An empty table with these columns.
    #[must_use]
    pub fn new<S: Into<String>>(columns: impl IntoIterator<Item = S>) -> Self {
        Self { columns: columns.into_iter().map(Into::into).collect(), rows: Vec::new() }
    }

    /// Adds a row; one shorter than the columns is filled up with nothing.
    pub fn push<C: Into<Cell>>(&mut self, row: impl IntoIterator<Item = C>) {
        let mut row: Vec<Cell> = row.into_iter().map(Into::into).collect();
        row.resize(self.columns.len(), Cell::Empty);
        self.rows.push(row);
    }

    /// The names of the columns.
    pub(super) fn columns(&self) -> &[String] {
        &self.columns
    }

    pub(super) fn rows(&self) -> &[Vec<Cell>] {
        &self.rows
    }

    /// The table as text.
    ///
    /// # Errors
    /// [`NonFinite`] with row (from 1) and column of a number that is not finite.
    pub fn to_csv(&self) -> Result<String, NonFinite> {
        let mut out = String::new();
        let header: Vec<String> = self.columns.iter().map(|name| quoted(name)).collect();
        out.push_str(&header.join(","));
        out.push('\n');
        for (i, row) in self.rows.iter().enumerate() {
            for (j, cell) in row.iter().enumerate() {
                if j > 0 {
                    out.push(',');
                }
                match cell {
                    Cell::Number(value) if !value.is_finite() => {
                        let path = format!("row {}, column {}", i + 1, self.columns[j]);
                        return Err(NonFinite { path, value: *value });
                    }
                    // Debug chooses the exponent for the very small and the very large.
                    Cell::Number(value) => _ = write!(out, "{value:?}"),
                    Cell::Integer(value) => _ = write!(out, "{value}"),
                    Cell::Text(text) => out.push_str(&quoted(text)),
                    Cell::Empty => {}
                }
            }
            out.push('\n');
        }
        Ok(out)
    }
}

/// Markers that were found in a photograph, as a table that `[measured]` takes: for each the number of its
/// disk, from 1, column and row, and how sure it is; beside it the step of actuation, from 1, and the camera
/// where they are given.
pub fn marks_csv(
    step: Option<usize>,
    camera: Option<&str>,
    marks: impl IntoIterator<Item = (usize, [f64; 2], f64)>,
) -> CsvTable {
    let columns = ["step"].into_iter().filter(|_| step.is_some()).chain(["disk"]);
    let columns = columns.chain(["camera"].into_iter().filter(|_| camera.is_some()));
    let mut table = CsvTable::new(columns.chain(["u", "v", "confidence"]));
    for (disk, [u, v], confidence) in marks {
        let mut row: Vec<Cell> = step.map(Cell::from).into_iter().collect();
        row.push(Cell::from(disk));
        row.extend(camera.map(Cell::from));
        row.extend([u, v, confidence].map(Cell::from));
        table.push(row);
    }
    table
}

/// A disk or marker in space, from two photographs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpacePoint {
    /// Number of its disk, from 1.
    pub disk: usize,
    /// Where it is, in m.
    pub position: Vec3,
    /// Standard deviations of its coordinates in m.
    pub deviations: Vec3,
    /// Distance of its pixels from the epipolar constraint, in pixels.
    pub epipolar: f64,
}

/// Disks or markers that two cameras have seen, as a table that `[measured]` takes: for each the number of its disk, from 1,
/// its position in m, one standard deviation for all three coordinates (the root of the mean of their variances), that of each
/// coordinate, and its epipolar distance in pixels; before them the step of actuation, from 1, where it is given.
pub fn points_csv(step: Option<usize>, points: impl IntoIterator<Item = SpacePoint>) -> CsvTable {
    const COLUMNS: [&str; 9] = [
        "disk",
        "x",
        "y",
        "z",
        "deviation",
        "deviation_x",
        "deviation_y",
        "deviation_z",
        "epipolar",
    ];
    let columns = ["step"].into_iter().filter(|_| step.is_some()).chain(COLUMNS);
    let mut table = CsvTable::new(columns);
    for SpacePoint { disk, position, deviations, epipolar } in points {
        let mut row: Vec<Cell> = step.map(Cell::from).into_iter().collect();
        row.push(Cell::from(disk));
        row.extend(position.to_array().map(Cell::from));
        row.push(Cell::from(deviations.norm() / 3.0_f64.sqrt()));
        row.extend(deviations.to_array().map(Cell::from));
        row.push(Cell::from(epipolar));
        table.push(row);
    }
    table
}

/// The frames of a shape, one line for each station: arc length, position and orientation.
///
/// # Errors
/// [`NonFinite`] for a number that is not finite.
pub fn shape_csv(shape: &Shape) -> Result<String, NonFinite> {
    let mut table = CsvTable::new(FRAME);
    for frame in frames(shape) {
        table.push(frame);
    }
    table.to_csv()
}

/// The frames of several shapes one after the other, with the number of the shape, from 1, in the
/// column `step` before the columns of [`shape_csv`].
///
/// # Errors
/// [`NonFinite`] for a number that is not finite.
pub fn steps_csv<'a>(shapes: impl IntoIterator<Item = &'a Shape>) -> Result<String, NonFinite> {
    let mut table = CsvTable::new(["step"].into_iter().chain(FRAME));
    for (number, shape) in (1..).zip(shapes) {
        for frame in frames(shape) {
            table.push([Cell::Integer(number)].into_iter().chain(frame.map(Cell::Number)));
        }
    }
    table.to_csv()
}

/// Columns of a place where a robot touches an obstacle.
pub(super) const CONTACT_COLUMNS: [&str; 17] = [
    "obstacle",
    "name",
    "part",
    "disk",
    "arc_length",
    "x",
    "y",
    "z",
    "nx",
    "ny",
    "nz",
    "force",
    "fx",
    "fy",
    "fz",
    "sticks",
    "gap",
];

/// The cells of such a place; disks and obstacles count from 1.
pub(super) fn contact_cells(touch: &Contact, obstacles: &[Obstacle]) -> Vec<Cell> {
    let name = obstacles.get(touch.obstacle).map(|obstacle| obstacle.name.as_str());
    let mut row = vec![
        Cell::from(touch.obstacle + 1),
        Cell::from(name),
        Cell::from(touch.part.name()),
        Cell::from(touch.part.disk().map(|disk| disk + 1)),
        Cell::from(touch.arc_length),
    ];
    row.extend(touch.point.to_array().map(Cell::from));
    row.extend(touch.normal.to_array().map(Cell::from));
    row.push(Cell::from(touch.force));
    let friction = touch.friction.map(|friction| friction.to_array());
    row.extend((0..3).map(|i| Cell::from(friction.map(|friction| friction[i]))));
    row.extend([Cell::from(if touch.sticks { "yes" } else { "no" }), Cell::from(touch.gap)]);
    row
}

/// Where a robot touches obstacles, one line for each place; disks and obstacles count from 1.
#[must_use]
pub fn contacts_csv(solution: &Solution, obstacles: &[Obstacle]) -> CsvTable {
    let mut table = CsvTable::new(CONTACT_COLUMNS);
    for touch in &solution.contacts {
        table.push(contact_cells(touch, obstacles));
    }
    table
}

const FRAME: [&str; 8] = ["arc_length", "x", "y", "z", "qw", "qx", "qy", "qz"];

fn frames(shape: &Shape) -> impl Iterator<Item = [f64; 8]> + '_ {
    shape.arc_length.iter().zip(&shape.poses).map(|(&arc_length, pose)| {
        let [x, y, z] = pose.position.to_array();
        let [qw, qx, qy, qz] = pose.rotation.wxyz();
        [arc_length, x, y, z, qw, qx, qy, qz]
    })
}

fn quoted(text: &str) -> String {
    if text.contains(['"', ',', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

impl From<f64> for Cell {
    fn from(value: f64) -> Self {
        Self::Number(value)
    }
}

impl From<usize> for Cell {
    fn from(value: usize) -> Self {
        i64::try_from(value).map_or(Self::Number(value as f64), Self::Integer)
    }
}

impl From<&str> for Cell {
    fn from(value: &str) -> Self {
        Self::Text(value.to_owned())
    }
}

impl From<String> for Cell {
    fn from(value: String) -> Self {
        Self::Text(value)
    }
}

impl<T: Into<Self>> From<Option<T>> for Cell {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Empty, Into::into)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use whipcord::Pose;

    #[test]
    fn cells_are_quoted_where_they_must_be() {
        let mut table = CsvTable::new(["case", "error, mean"]);
        table.push([Cell::from("a \"b\""), Cell::from(1.5e-9)]);
        table.push([Cell::from("c"), Cell::from(None::<f64>)]);
        table.push([Cell::from(3_usize)]);
        assert_eq!(
            table.to_csv().unwrap(),
            "case,\"error, mean\"\n\"a \"\"b\"\"\",1.5e-9\nc,\n3,\n"
        );
    }

    #[test]
    fn a_shape_is_one_line_a_station() {
        let shape = Shape { arc_length: vec![0.0], poses: vec![Pose::default()] };
        let text = shape_csv(&shape).unwrap();
        assert_eq!(text, "arc_length,x,y,z,qw,qx,qy,qz\n0.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0\n");
        let bad = Shape { arc_length: vec![f64::NAN], ..shape };
        assert_eq!(shape_csv(&bad).unwrap_err().path, "row 1, column arc_length");
    }

    proptest! {
        #[test]
        fn numbers_are_read_back_exactly(x in proptest::num::f64::NORMAL) {
            let mut table = CsvTable::new(["x"]);
            table.push([x]);
            let text = table.to_csv().unwrap();
            prop_assert_eq!(text.lines().nth(1).unwrap().parse::<f64>().unwrap(), x);
        }
    }
}
