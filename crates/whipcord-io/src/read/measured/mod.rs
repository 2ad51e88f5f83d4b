//! `[measured]`: where the disks and markers of the real robot were.

mod columns;
mod extent;
mod rows;

use std::path::{Path, PathBuf};

use whipcord::robot::limits::LENGTH;
use whipcord::{Disks, Problem, Robot, UnitQuaternion, Vec3};
use whipcord_estimation::camera::Camera;
use whipcord_estimation::registration::Alignment;
use whipcord_estimation::{Observation, Place, Seen};

use super::commands::CommandTable;
use super::table::{self, problem, same_file};
use super::vec3;
use crate::check::{Data, Fields};
use crate::error::{FileError, FileProblem, Problems};
use crate::node::Node;
use crate::source::{Sources, quoted};
use columns::HEADER;
pub(in crate::read) use columns::{MARKER_SEPARATORS, is_measured};

/// What was seen of the real robot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measured {
    /// All that was seen, by step, then by place.
    pub observations: Vec<Observation>,
    /// The orientations of tracked bodies, by step.
    pub rotations: Vec<MeasuredRotation>,
    /// Rotation from the frame of the tracked body to that of its place on the robot, where the file gives it.
    pub body: Option<UnitQuaternion>,
    /// Distance in m that counts as much as a turn of 1 rad in a fit; orientations are not fitted where it is `None`.
    pub orientation_arm: Option<f64>,
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
    /// Whether its lines are of the rows of a table of commands, without which they say nothing.
    pub is_of_commands: bool,
}

impl Measured {
    /// What a fit compares: positions and pixels, and with [`Self::orientation_arm`] orientations. Those have the deviation of what else was
    /// seen at their place.
    #[must_use]
    pub fn fitted(&self) -> Vec<Observation> {
        let mut all = self.observations.clone();
        let Some(arm) = self.orientation_arm else { return all };
        all.extend(self.rotations.iter().map(|of| {
            let beside = self.observations.partition_point(|seen| seen.step < of.step);
            let beside = self.observations[beside..].iter().take_while(|seen| seen.step == of.step);
            let there =
                beside.clone().find(|seen| seen.place == of.place).or(beside.clone().next());
            Observation {
                step: of.step,
                place: of.place,
                offset: Vec3::ZERO,
                seen: Seen::Rotation { rotation: of.rotation, arm },
                deviation: there.map_or(self.deviation, |seen| seen.deviation),
            }
        }));
        all
    }
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

/// How a tracked body was turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredRotation {
    /// Step of actuation, from 0.
    pub step: usize,
    /// Where on the backbone it is mounted.
    pub place: Place,
    /// Rotation from the frame of the body to that of the measurement.
    pub rotation: UnitQuaternion,
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
pub(crate) struct Extent<'a> {
    /// Number of its disks, where that is known; 0 of a body without.
    pub disks: Option<usize>,
    /// Length of its backbone in m, where that is known.
    pub length: Option<f64>,
    /// Steps of actuation; 0 where there is one alone.
    pub steps: usize,
    /// Whether its base is at the origin of the frame of the measurement.
    pub at_origin: bool,
    /// The table whose rows are the steps.
    pub rows: Option<&'a CommandTable>,
}

impl Extent<'_> {
    /// The tip, where it is known.
    fn tip(&self) -> Option<Place> {
        match self.disks? {
            0 => self.length.map(Place::ArcLength),
            disks => Some(Place::Disk(disks - 1)),
        }
    }

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
    robot: Extent<'a>,
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
    /// Where markers are in the frames of their disks or cross-sections, in m.
    offset: Vec3,
    /// `[[measured.markers]]`.
    markers: &'a [Marker<'a>],
    /// Columns that are not read.
    ignored: &'a [&'a str],
    /// The column by which rows of commands are found.
    key: Option<&'a str>,
    /// Whether the table is that of the commands.
    same_file: bool,
}

/// An entry of `[[measured.markers]]`.
#[derive(Clone, Copy, Debug)]
struct Marker<'a> {
    name: Option<&'a str>,
    place: Place,
    offset: Vec3,
}

impl<'a> Known<'a> {
    fn rows(&self) -> Option<&'a CommandTable> {
        self.robot.rows
    }
}

/// Reads the files that `[measured]`, the table at `node`, names.
pub(crate) fn read(
    fields: &Fields,
    node: &Node,
    robot: Extent<'_>,
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
    let name = if fields.text("disks").is_some() { "disks" } else { "table" };
    let named = node.locate(name).span;
    let path = sources.resolve(named.file, fields.text(name)?);
    let offset = vec3(fields, "offset").unwrap_or(Vec3::ZERO);
    let markers = markers(fields, node, &robot, offset, problems)?;
    let ignored = fields.list("ignore").unwrap_or_default();
    let ignored: Vec<&str> = ignored.iter().filter_map(Data::as_text).collect();
    let body = body(fields, node, problems);
    let key = fields.text("key").or_else(|| robot.rows.and_then(|rows| rows.key.as_deref()));
    if let Some(key) =
        fields.text("key").filter(|_| robot.rows.is_none_or(|rows| rows.key.is_none()))
    {
        let message = format!("rows cannot be found by the column `{}`", quoted(key));
        let help =
            "name the column of the keys in the table of commands in `key` of [commands] too";
        problems.push(node.locate("key").span, || problem(message, help));
    }
    let grid = table::read(&path, Some(named), HEADER, sources, problems)?;
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
        offset,
        markers: &markers,
        ignored: &ignored,
        key,
        same_file: robot.rows.is_some_and(|rows| same_file(&rows.path, &path)),
    };
    let Known { unit, deviation, .. } = known;
    let orientation_arm = fields.number("orientation_arm");
    if let Some(arm) = orientation_arm
        && let Some(found) = LENGTH.problem(arm)
    {
        let path = "measured.orientation_arm".to_owned();
        let span = node.locate("orientation_arm").span;
        problems.push(span, || FileProblem::Physical { path, problem: found });
        return None;
    }
    let asked = fields.text("registration");
    let alignment = Alignment::ALL.into_iter().find(|way| asked == Some(way.name()));
    let alignment = alignment.unwrap_or_default();
    let at_origin = robot.at_origin && alignment == Alignment::default();
    let known = Known { robot: Extent { at_origin, ..robot }, ..known };
    let (observations, rotations) = rows::observations(&grid, &known, problems)?;
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
        rotations,
        body,
        orientation_arm,
        disks,
        cameras,
        alignment,
        unit,
        deviation,
        pixel_deviation,
        path,
        is_of_commands: robot.rows.is_some(),
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
            rows: None,
        },
        unit: LENGTH_UNITS[0],
        deviation: None,
        pixel_deviation: None,
        cameras: &["camera"],
        one_photograph: true,
        offset: Vec3::ZERO,
        markers: &[],
        ignored: &[],
        key: None,
        same_file: false,
    };
    let markers = table::read(path, None, HEADER, &mut sources, &mut problems).and_then(|grid| {
        let (markers, _) = rows::observations(&grid, &known, &mut problems)?;
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

/// The rotation of the tracked body in the frame of its place, where the file gives it.
fn body(fields: &Fields, node: &Node, problems: &mut Problems) -> Option<UnitQuaternion> {
    if fields.data("orientation").is_none() && fields.data("rotation").is_none() {
        return None;
    }
    match super::pose::pose(fields) {
        Ok(pose) => Some(pose.rotation),
        Err(key) => {
            let (path, problem) = (format!("measured.{key}"), Problem::NoDirection);
            problems.push(node.locate(key).span, || FileProblem::Physical { path, problem });
            None
        }
    }
}

/// `[[measured.markers]]`; `None` when one is refused.
fn markers<'a>(
    fields: &'a Fields,
    node: &Node,
    robot: &Extent<'_>,
    usual: Vec3,
    problems: &mut Problems,
) -> Option<Vec<Marker<'a>>> {
    let mut markers: Vec<Marker<'a>> = Vec::new();
    for (k, table) in fields.tables("markers").iter().enumerate() {
        let span = |key: &str| node.locate(&format!("markers[{k}].{key}")).span;
        let name = table.text("name");
        if let Some(first) = markers.iter().position(|marker| marker.name == name) {
            let related =
                Some((node.locate(&format!("markers[{first}]")).span, "the other one is here"));
            problems.push_related(span("name"), related, || {
                problem(
                    "two markers have the same name",
                    "give each marker a name of its own, which its columns begin with",
                )
            });
            return None;
        }
        let (disks, length) = (robot.disks?, robot.length?);
        let place = match (table.count("disk"), table.number("arc_length")) {
            (Some(disk), _) if disk > disks => {
                let message = match disks {
                    0 => "the robot has no disks".to_owned(),
                    _ => format!("there is no disk {disk}: the robot has disks 1 to {disks}"),
                };
                problems.push(span("disk"), || {
                    problem(
                        message,
                        "disks are numbered from 1, the base disk; or give `arc_length`",
                    )
                });
                return None;
            }
            (Some(disk), _) => Place::Disk(disk - 1),
            (None, Some(arc_length)) if arc_length > length * (1.0 + 1e-6) => {
                let message = format!(
                    "there is no arc length {arc_length} m: the backbone goes from 0 to {length} m"
                );
                problems.push(span("arc_length"), || {
                    problem(
                        message,
                        "arc lengths are those of the straight backbone, from its base",
                    )
                });
                return None;
            }
            (None, Some(arc_length)) => Place::ArcLength(arc_length.min(length)),
            (None, None) => robot.tip()?,
        };
        markers.push(Marker { name, place, offset: vec3(table, "offset").unwrap_or(usual) });
    }
    Some(markers)
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
