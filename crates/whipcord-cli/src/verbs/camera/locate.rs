//! `whipcord camera locate`: where a camera is.

use std::path::PathBuf;

use clap::Args;
use whipcord::{Pose, Robot, Shape, Stations, Vec3, at_rest};
use whipcord_estimation::camera::{self, Camera, Lens, Located, Sighting};
use whipcord_estimation::{Observation, Place, Seen};
use whipcord_io::{CaseFile, camera_text, load_camera, load_markers};

use super::format_of;
use crate::inputs::{Settings, read_one};
use whipcord_study::failure::Failure;
use whipcord_study::files;
use whipcord_study::quantity::{number, vector};
use whipcord_study::style::Style;

/// Find the pose of a camera from a photograph of the robot before actuation
///
/// With --stereo it is the pose of a pair of cameras that are fastened to one another, as `camera calibrate --stereo` gives it:
/// both are moved together, so that few markers in each photograph are enough.
///
/// The photograph must show the robot of the file without actuation and loads, with its disks or
/// with markers on its backbone. Writes the camera with its pose in the format of OpenCV, for
/// [[measured.cameras]].
#[derive(Debug, Args)]
pub struct LocateArgs {
    /// Robot file
    file: PathBuf,
    /// CSV file with the pixels of the markers: columns disk or arc_length, u, v, and for markers
    /// beside the axis offset_x, offset_y, offset_z in m
    #[arg(long, value_name = "CSV")]
    markers: PathBuf,
    /// Camera file with the lens, as calibrated by OpenCV; by default the camera is scaled
    /// orthographic, and its scale is estimated as well
    #[arg(long, value_name = "CAMERA")]
    lens: Option<PathBuf>,
    /// Viewing direction x,y,z of the camera in the world; needed if all markers lie on one line
    #[arg(long, value_name = "X,Y,Z", value_parser = direction, allow_hyphen_values = true)]
    view: Option<Vec3>,
    /// Camera file to write, .yml or .json
    #[arg(short, long, value_name = "CAMERA")]
    output: Option<PathBuf>,
    /// Camera file of the second camera, with its pose in the frame of the first, as `camera calibrate --stereo` writes it; --lens is
    /// the file of the first
    #[arg(long, value_name = "CAMERA", requires = "lens", requires = "stereo_markers")]
    stereo: Option<PathBuf>,
    /// CSV file with the pixels of the markers in the photograph of the second camera
    #[arg(long, value_name = "CSV", requires = "stereo")]
    stereo_markers: Option<PathBuf>,
    /// Camera file to write for the second camera, .yml or .json
    #[arg(long, value_name = "CAMERA", requires = "stereo", requires = "output")]
    stereo_output: Option<PathBuf>,
}

fn direction(text: &str) -> Result<Vec3, String> {
    let parts: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    match parts.as_deref() {
        Ok(&[x, y, z]) => Ok(Vec3::new(x, y, z)),
        _ => Err(String::from("give three numbers, such as -1,0,0")),
    }
}

/// What was done, in words.
pub fn run(args: &LocateArgs, style: Style) -> Result<String, Failure> {
    let format = args.output.as_deref().map(format_of).transpose()?;
    let file = read_one(&args.file, &Settings::default())?;
    let unusable = |error| Failure::Input(whipcord_study::failure::message(&error));
    let lens = args.lens.as_deref().map(load_camera).transpose().map_err(unusable)?;
    let markers = load_markers(&args.markers, &file.robot).map_err(unusable)?;
    if let (Some(first), Some(second), Some(path)) = (&lens, &args.stereo, &args.stereo_markers) {
        let second = load_camera(second).map_err(unusable)?;
        let others = load_markers(path, &file.robot).map_err(unusable)?;
        return of_both(args, &file, [first, &second], [&markers, &others], style);
    }
    let seen = sightings(&file.robot, file.case.base, &markers);
    let size = lens.as_ref().and_then(Camera::size);
    let found = match lens.as_ref().map(Camera::lens) {
        Some(Lens::Pinhole(lens)) => camera::locate(lens, size, &seen, args.view),
        _ => camera::locate_orthographic(size, &seen, args.view),
    };
    let found = found.map_err(|error| {
        Failure::Input(format!("error: {}: {error}{}", args.markers.display(), hint(&error)))
    })?;
    if let Some((path, format)) = args.output.as_deref().zip(format) {
        files::write(path, camera_text(&found.camera, format).as_bytes())?;
    }
    Ok(words(args, &found, &markers, style))
}

/// The pose of two cameras, from what each has seen.
fn of_both(
    args: &LocateArgs,
    file: &CaseFile,
    cameras: [&Camera; 2],
    markers: [&[Observation]; 2],
    style: Style,
) -> Result<String, Failure> {
    if cameras.iter().any(|camera| !matches!(camera.lens(), Lens::Pinhole(_))) {
        return Err(Failure::Input(String::from(
            "error: --stereo needs two cameras with lenses, as `whipcord camera calibrate --stereo` writes them",
        )));
    }
    let format = args.stereo_output.as_deref().map(format_of).transpose()?;
    if args.stereo_output.is_some() && args.stereo_output == args.output {
        return Err(Failure::Input(String::from(
            "error: --output and --stereo-output have one name: give each camera its own file",
        )));
    }
    let seen = markers.map(|markers| sightings(&file.robot, file.case.base, markers));
    let found = camera::locate_rig(cameras, [&seen[0], &seen[1]], args.view).map_err(|error| {
        let paths = [Some(&args.markers), args.stereo_markers.as_ref()];
        let paths: Vec<String> =
            paths.into_iter().flatten().map(|path| path.display().to_string()).collect();
        Failure::Input(format!("error: {}: {error}{}", paths.join(", "), hint(&error)))
    })?;
    let own = args.output.as_deref().map(format_of).transpose()?;
    let outputs = [args.output.as_deref().zip(own), args.stereo_output.as_deref().zip(format)];
    for (camera, output) in found.cameras.iter().zip(outputs) {
        if let Some((path, format)) = output {
            files::write(path, camera_text(camera, format).as_bytes())?;
        }
    }
    let mut lines = Vec::new();
    for (i, name) in ["first", "second"].into_iter().enumerate() {
        let place = in_place(&found.cameras[i]);
        let error = pixels(found.rms[i]);
        lines.push((name, format!("{place}; {} markers, {error} RMS", markers[i].len())));
        let farthest = found.residuals[i].iter().map(|[u, v]| u.hypot(*v)).zip(markers[i]);
        if let Some((distance, marker)) = farthest.max_by(|a, b| a.0.total_cmp(&b.0)) {
            lines.push(("farthest", format!("{}, {}", named(marker), pixels(distance))));
        }
    }
    if let Some(other) = &found.other {
        let told = told_apart(found.is_ambiguous());
        let (place, rms) = (in_place(&other.camera), pixels(other.rms));
        lines.push(("next best", format!("first {place}: {rms} RMS; {told}")));
    }
    for path in [&args.output, &args.stereo_output].into_iter().flatten() {
        lines.push(("written", path.display().to_string()));
    }
    Ok(listed(&format!("two cameras of {}", args.file.display()), lines, style))
}

fn hint(error: &camera::LocateError) -> &'static str {
    match error {
        camera::LocateError::FreeTurn { .. } => " (--view)",
        _ => "",
    }
}

/// Where the markers are on the robot at rest, and where they were seen.
fn sightings(robot: &Robot, base: Pose, markers: &[Observation]) -> Vec<Sighting> {
    let arc_length = |place: Place| place.arc_length(robot.disks());
    let mut stations: Vec<f64> = markers.iter().map(|seen| arc_length(seen.place)).collect();
    stations.sort_by(f64::total_cmp);
    stations.dedup();
    let rest = at_rest(robot, base, &Stations::At(stations.clone()))
        .map_or_else(|| Shape::straight(&stations).moved(base), |solution| solution.shape);
    let sighting = |marker: &Observation| {
        let Seen::Pixel { pixel, .. } = marker.seen else { return None };
        let at = stations.binary_search_by(|s| s.total_cmp(&arc_length(marker.place))).ok()?;
        Some(Sighting { point: rest.poses[at].transform(marker.offset), pixel })
    };
    markers.iter().filter_map(sighting).collect()
}

fn words(args: &LocateArgs, found: &Located, markers: &[Observation], style: Style) -> String {
    let mut lines = vec![("place", in_place(&found.camera))];
    if let Lens::Orthographic(lens) = found.camera.lens() {
        lines.push(("scale", format!("{} pixels/mm", number(1e-3 * lens.scale(), 6))));
    }
    lines.push(("error", format!("{} RMS", pixels(found.rms))));
    let farthest = found
        .residuals
        .iter()
        .map(|[u, v]| u.hypot(*v))
        .zip(markers)
        .max_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((distance, marker)) = farthest {
        lines.push(("farthest", format!("{}, {}", named(marker), pixels(distance))));
    }
    if let Some(other) = &found.other {
        let recommendation = told_apart(found.is_ambiguous());
        let place = in_place(&other.camera);
        lines.push(("next best", format!("{place}: {} RMS; {recommendation}", pixels(other.rms))));
    }
    if let Some(path) = &args.output {
        lines.push(("written", path.display().to_string()));
    }
    let title = format!("camera of {}, from {} markers", args.file.display(), markers.len());
    listed(&title, lines, style)
}

const fn told_apart(is_ambiguous: bool) -> &'static str {
    match is_ambiguous {
        true => "the markers do not tell the two apart: check which one it is",
        false => "the markers tell it apart",
    }
}

fn listed(title: &str, lines: Vec<(&str, String)>, style: Style) -> String {
    let mut text = format!("{}\n", style.heading(title));
    for (name, value) in lines {
        let padding = " ".repeat("next best".len() - name.len());
        text += &format!("  {}{padding}  {value}\n", style.faint(name.to_owned()));
    }
    text
}

/// `at (700, 0, 90) mm, looking along (-1, 0, 0)`; where an orthographic camera is says nothing.
fn in_place(camera: &Camera) -> String {
    let pose = camera.pose();
    // Nothing finer is known of a camera.
    let rounded = |v: Vec3, unit: f64| {
        let [x, y, z] = v.to_array().map(|c| (c * unit).round() / unit + 0.0);
        vector(Vec3::new(x, y, z))
    };
    let along = rounded(pose.rotation.rotate(Vec3::Z), 1e4);
    match camera.lens() {
        Lens::Pinhole(_) => {
            format!("at {} mm, looking along {along}", rounded(pose.position * 1e3, 1e2))
        }
        Lens::Orthographic(_) => format!("looking along {along}"),
    }
}

/// No finer than a thousandth of a pixel.
fn pixels(distance: f64) -> String {
    format!("{} pixels", number((distance * 1e3).round() / 1e3, 4))
}

fn named(marker: &Observation) -> String {
    match marker.place {
        Place::Disk(disk) => format!("disk {}", disk + 1),
        Place::ArcLength(arc_length) => {
            format!("the marker at {}", whipcord_study::quantity::millimetres(arc_length))
        }
    }
}
