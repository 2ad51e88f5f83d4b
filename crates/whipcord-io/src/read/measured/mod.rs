//! `[measured]`: where the disks and markers of the real robot were.

mod columns;
mod csv;
mod extent;
mod grid;
mod parquet;
mod rows;
mod thrift;

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use whipcord::{Disks, Robot, Vec3};
use whipcord_estimation::camera::Camera;
use whipcord_estimation::registration::Alignment;
use whipcord_estimation::{Observation, Place, Seen};

use crate::check::Fields;
use crate::error::{FileError, FileProblem, Problems};
use crate::files;
use crate::node::Node;
use crate::source::{Sources, Span, quoted};
use grid::Grid;

/// What was seen of the real robot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measured {
    /// All that was seen, by step, then by place.
    pub observations: Vec<Observation>,
    /// The centres of disks whose positions were measured in the last step, in ascending order.
    pub disks: Vec<MeasuredDisk>,
    /// The cameras that saw them, in the order in which observations number them.
    pub cameras: Vec<MeasuringCamera>,
    /// How the frame of the measurement is brought to that of the robot.
    pub alignment: Alignment,
    /// Unit of the lengths in the file.
    pub unit: &'static str,
    /// Standard deviation of a coordinate in m, where the file does not give it.
    pub deviation: Option<f64>,
    /// The same of a place in an image, in pixels.
    pub pixel_deviation: Option<f64>,
    /// The file they were read from.
    pub path: PathBuf,
}

/// A camera that saw the robot.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuringCamera {
    /// What it is called.
    pub name: String,
    /// Its lens and where it was.
    pub camera: Camera,
    /// The file it was read from.
    pub path: PathBuf,
}

/// Where one disk was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredDisk {
    /// Number of the disk, from 1.
    pub disk: usize,
    /// Position of its centre in m, in the frame of the measurement.
    pub position: Vec3,
}

/// The robot that was measured, as far as what was seen refers to it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    /// Number of its disks, where that is known; 0 of a body without.
    pub disks: Option<usize>,
    /// Length of its backbone in m, where that is known.
    pub length: Option<f64>,
    /// Steps of actuation; 0 where there is one alone.
    pub steps: usize,
    /// Whether its base is at the origin of the frame of the measurement.
    pub at_origin: bool,
}

impl Extent {
    /// How many disks markers may sit on.
    pub(crate) fn disks_of(disks: &Disks) -> usize {
        if disks.are_present { disks.count() } else { 0 }
    }
}

/// Units that lengths may have in a table.
pub const LENGTH_UNITS: [&str; 5] = ["m", "cm", "mm", "um", "in"];

/// What is known beside the table.
#[derive(Clone, Copy, Debug)]
struct Known<'a> {
    robot: Extent,
    /// Name of the unit of lengths in the table.
    unit: &'static str,
    /// Standard deviation of a position in m, where a row does not give its own.
    deviation: Option<f64>,
    /// That of a place in an image in pixels.
    pixel_deviation: Option<f64>,
    /// Names of the cameras.
    cameras: &'a [&'a str],
    /// Whether the table is that of one photograph, whatever it calls its camera and step.
    one_photograph: bool,
}

/// What is wrong with a table, and what to do.
fn problem(message: impl Into<String>, help: impl Into<Cow<'static, str>>) -> FileProblem {
    FileProblem::Measured { message: message.into(), help: help.into() }
}

/// Reads the files that `[measured]`, the table at `node`, names.
pub(crate) fn read(
    fields: &Fields,
    node: &Node,
    robot: Extent,
    sources: &mut Sources,
    problems: &mut Problems,
) -> Option<Measured> {
    let cameras = cameras(fields, node, sources, problems);
    let pixel_deviation = fields.number("pixel_deviation");
    if let Some(value) = pixel_deviation.filter(|value| *value <= 0.0) {
        let message = format!("`pixel_deviation` must be above 0, but is {value}");
        let help = "give the standard deviation of a place in an image in pixels, say 0.3";
        problems.push(node.locate("pixel_deviation").span, || problem(message, help));
    }
    let named = node.locate("disks").span;
    let path = sources.resolve(named.file, fields.text("disks")?);
    let grid = table(&path, Some(named), sources, problems)?;
    let unit = fields.text("unit").unwrap_or("m");
    // A camera that could not be read has been reported; what names it is right nevertheless.
    let names: Vec<&str> =
        fields.tables("cameras").iter().filter_map(|camera| camera.text("name")).collect();
    let known = Known {
        robot,
        unit: LENGTH_UNITS.into_iter().find(|name| *name == unit)?,
        deviation: fields.number("deviation"),
        pixel_deviation,
        cameras: &names,
        one_photograph: false,
    };
    let Known { unit, deviation, .. } = known;
    let asked = fields.text("registration");
    let alignment = Alignment::ALL.into_iter().find(|way| asked == Some(way.name()));
    let alignment = alignment.unwrap_or_default();
    let at_origin = robot.at_origin && alignment == Alignment::default();
    let known = Known { robot: Extent { at_origin, ..robot }, ..known };
    let observations = rows::observations(&grid, &known, problems)?;
    if let Some(message) = extent::problem(&observations, &known) {
        let help = "say in `unit` of [measured] in which unit the lengths are: m, cm, mm, um or in";
        problems.push(grid.header, || problem(message, help));
        return None;
    }
    let last = robot.steps.saturating_sub(1);
    let disks = observations.iter().filter(|seen| seen.step == last).filter_map(centre).collect();
    let cameras = cameras?;
    Some(Measured {
        observations,
        disks,
        cameras,
        alignment,
        unit,
        deviation,
        pixel_deviation,
        path,
    })
}

/// Reads a table of markers of a robot as one camera saw them, with the columns of a table that `[measured]`
/// names: `disk` or `arc_length`, `offset_x`, `offset_y` and `offset_z` in m, `u` and `v` in pixels. All of it is
/// of one photograph: whatever it calls the camera and the step, they are given as the first ones.
///
/// # Errors
/// [`FileError`] with the place of each mistake.
pub fn load_markers(path: impl AsRef<Path>, robot: &Robot) -> Result<Vec<Observation>, FileError> {
    let path = path.as_ref();
    let (mut sources, mut problems) = (Sources::default(), Problems::default());
    let known = Known {
        robot: Extent {
            disks: Some(Extent::disks_of(robot.disks())),
            length: Some(robot.backbone().length),
            steps: 0,
            at_origin: false,
        },
        unit: LENGTH_UNITS[0],
        deviation: None,
        pixel_deviation: None,
        cameras: &["camera"],
        one_photograph: true,
    };
    let markers = table(path, None, &mut sources, &mut problems).and_then(|grid| {
        let markers = rows::observations(&grid, &known, &mut problems)?;
        let in_image = markers.iter().all(|marker| marker.seen.is_in_image());
        if !in_image {
            problems.push(grid.header, || {
                problem("markers in a photograph have the columns `u` and `v`", rows::PIXELS)
            });
        }
        Some(markers)
    });
    markers.filter(|_| problems.is_empty()).ok_or_else(|| problems.into_error(sources))
}

/// The table in a file, comma-separated values or Parquet, which another file may name at `named`.
fn table(
    path: &Path,
    named: Option<Span>,
    sources: &mut Sources,
    problems: &mut Problems,
) -> Option<Grid> {
    let bytes = files::read_content(path, files::LARGEST_TABLE, named, sources, problems)?;
    if !parquet::is_parquet(&bytes) {
        let (file, text) = files::as_text(path, bytes, named, sources, problems)?;
        return csv::grid(&text, file, problems);
    }
    let file = sources.files().len();
    let read = parquet::grid(bytes, file);
    let (grid, text) = match read {
        Ok((grid, text)) => (Some(grid), Some(text)),
        Err((message, help)) => {
            problems.push(Span::new(file, 0, 0), || problem(message, help));
            (None, None)
        }
    };
    sources.add(path, text);
    grid
}

/// `[[measured.cameras]]`; `None` when one is refused.
fn cameras(
    fields: &Fields,
    node: &Node,
    sources: &mut Sources,
    problems: &mut Problems,
) -> Option<Vec<MeasuringCamera>> {
    let mut cameras: Vec<Option<MeasuringCamera>> = Vec::new();
    for (k, table) in fields.tables("cameras").iter().enumerate() {
        let (Some(name), Some(file)) = (table.text("name"), table.text("file")) else {
            cameras.push(None);
            continue;
        };
        let span = |key: &str| node.locate(&format!("cameras[{k}].{key}")).span;
        let same = |other: &Fields| other.text("name") == Some(name);
        if let Some(first) = fields.tables("cameras")[..k].iter().position(same) {
            let first = node.locate(&format!("cameras[{first}].name")).span;
            let related = Some((first, "it is first given here"));
            let message = format!("there are two cameras `{}`", quoted(name));
            problems.push_related(span("name"), related, || {
                problem(message, "give each camera a name of its own")
            });
        }
        let named = span("file");
        let path = sources.resolve(named.file, file);
        let camera = crate::camera::read_named(&path, named, sources, problems);
        cameras.push(camera.map(|camera| MeasuringCamera { name: name.to_owned(), camera, path }));
    }
    cameras.into_iter().collect()
}

/// The centre of a disk, where that is what was seen.
fn centre(observation: &Observation) -> Option<MeasuredDisk> {
    match (observation.place, observation.seen) {
        (Place::Disk(disk), Seen::Position(position)) if observation.offset == Vec3::ZERO => {
            Some(MeasuredDisk { disk: disk + 1, position })
        }
        _ => None,
    }
}
