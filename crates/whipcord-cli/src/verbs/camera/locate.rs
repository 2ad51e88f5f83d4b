//! `whipcord camera locate`: where a camera is.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};
use whipcord::{Pose, Robot, Shape, Stations, Vec3, at_rest};
use whipcord_estimation::camera::{
    self, Alternative, Camera, Lens, Located, LocatedRig, PoseCovariance, Sighting, pose_deviations,
};
use whipcord_estimation::{Observation, Place, Seen};
use whipcord_io::{
    CalibratedCamera, CaseFile, calibrated_camera_text, load_calibrated_camera, load_markers,
};

use super::format_of;
use crate::inputs::{Settings, read_one};
use whipcord_study::failure::Failure;
use whipcord_study::files;
use whipcord_study::quantity::{number, vector};
use whipcord_study::style::Style;

/// Find the pose of a camera from a photograph of the robot before actuation
///
/// Prints the pose with its standard deviations: by the errors of the pixels, as the residuals tell them or --pixel-deviation gives them,
/// and by those of the lens, whose covariance `camera calibrate` writes into the camera file.
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
    /// Standard deviation of the pixels in the CSV file, in columns and rows; by default as the residuals tell
    #[arg(long, value_name = "PIXELS", value_parser = deviation)]
    pixel_deviation: Option<f64>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

fn deviation(text: &str) -> Result<f64, String> {
    match text.trim().parse() {
        Ok(value) if value > 0.0 && f64::is_finite(value) => Ok(value),
        _ => Err(String::from("give a positive number of pixels, such as 0.3")),
    }
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
    let lens = args.lens.as_deref().map(load_calibrated_camera).transpose().map_err(unusable)?;
    let markers = load_markers(&args.markers, &file.robot).map_err(unusable)?;
    if let (Some(first), Some(second), Some(path)) = (&lens, &args.stereo, &args.stereo_markers) {
        let second = load_calibrated_camera(second).map_err(unusable)?;
        let others = load_markers(path, &file.robot).map_err(unusable)?;
        return of_both(args, &file, [first, &second], [&markers, &others], style);
    }
    let seen = sightings(&file.robot, file.case.base, &markers);
    let camera = lens.as_ref().map(|lens| &lens.camera);
    let size = camera.and_then(Camera::size);
    let found = match camera.map(Camera::lens) {
        Some(Lens::Pinhole(lens)) => camera::locate(lens, size, &seen, args.view),
        _ => camera::locate_orthographic(size, &seen, args.view),
    };
    let found = found.map_err(|error| {
        Failure::Input(format!("error: {}: {error}{}", args.markers.display(), hint(&error)))
    })?;
    if let Some((path, format)) = args.output.as_deref().zip(format) {
        let written = CalibratedCamera {
            camera: found.camera,
            lens_covariance: lens.as_ref().and_then(|lens| lens.lens_covariance.clone()),
        };
        files::write(path, calibrated_camera_text(&written, format).as_bytes())?;
    }
    let lens_covariance = lens.and_then(|lens| lens.lens_covariance);
    let sure = Sure {
        covariance: found.uncertainty.covariance(args.pixel_deviation, lens_covariance.as_deref()),
        pixel: args.pixel_deviation.or(found.uncertainty.pixel),
        scale: found.uncertainty.relative_scale_deviation(args.pixel_deviation),
        lens: match lens_covariance {
            Some(_) => "pixels and lens",
            None => "pixels alone",
        },
    };
    match args.json {
        true => Ok(format!("{:#}\n", object(args, &found, &markers, &sure))),
        false => Ok(words(args, &found, &markers, &sure, style)),
    }
}

/// How sure a place is.
struct Sure {
    /// Of position (m) and rotation (rad).
    covariance: Option<PoseCovariance>,
    pixel: Option<f64>,
    /// Of an orthographic camera, relative to it.
    scale: Option<f64>,
    /// By which errors.
    lens: &'static str,
}

impl Sure {
    /// In mm and degrees.
    fn words(&self, camera: &Camera) -> String {
        let (Some(covariance), Some(pixel)) = (&self.covariance, self.pixel) else {
            return String::from(
                "not known: there are no more pixels than unknowns; give --pixel-deviation, or more markers",
            );
        };
        let [position, rotation] = pose_deviations(covariance);
        let three = |v: Vec3| {
            let [x, y, z] = v.to_array().map(|c| number(c, 2));
            format!("({x}, {y}, {z})")
        };
        let turns = format!("{}° about x, y and z", three(rotation * 1f64.to_degrees()));
        let by = format!("by {}, {} a column or row", self.lens, pixels(pixel));
        match camera.lens() {
            Lens::Pinhole(_) => format!("± {} mm, {turns}; {by}", three(position * 1e3)),
            Lens::Orthographic(_) => format!("± {turns}; {by}"),
        }
    }

    fn object(&self) -> Value {
        let deviations = self.covariance.as_ref().map(pose_deviations);
        json!({
            "position_deviation": deviations.map(|[position, _]| position.to_array()),
            "rotation_deviation": deviations.map(|[_, rotation]| rotation.to_array()),
            "covariance": self.covariance,
            "relative_scale_deviation": self.scale,
            "pixel_deviation": self.pixel,
        })
    }
}

/// A camera in its place for programs.
fn camera_object(camera: &Camera) -> Value {
    let Pose { position, rotation } = camera.pose();
    let scale = match camera.lens() {
        Lens::Orthographic(lens) => Some(lens.scale()),
        Lens::Pinhole(_) => None,
    };
    json!({ "position": position.to_array(), "orientation": rotation.wxyz(), "scale": scale })
}

/// A camera in its place, with what it saw, for programs.
fn located_object(
    camera: &Camera,
    output: Option<&PathBuf>,
    markers: &[Observation],
    (rms, residuals): (f64, &[[f64; 2]]),
) -> Value {
    let mut object = camera_object(camera);
    object["camera"] = json!(output.map(|path| path.display().to_string()));
    object["markers"] = json!(markers.len());
    object["rms"] = json!(rms);
    object["residuals"] = json!(residuals);
    object
}

/// What one camera or two have in common: how sure the place is, and the next best one.
fn add_place(object: &mut Value, sure: &Sure, other: Option<&Alternative>, is_ambiguous: bool) {
    if let (Value::Object(all), Value::Object(sure)) = (&mut *object, sure.object()) {
        all.extend(sure);
    }
    object["other"] = other.map_or(Value::Null, |other| {
        let mut object = camera_object(&other.camera);
        object["rms"] = json!(other.rms);
        object
    });
    object["ambiguous"] = json!(is_ambiguous);
}

fn object(args: &LocateArgs, found: &Located, markers: &[Observation], sure: &Sure) -> Value {
    let seen = (found.rms, &found.residuals[..]);
    let mut object = located_object(&found.camera, args.output.as_ref(), markers, seen);
    add_place(&mut object, sure, found.other.as_ref(), found.is_ambiguous());
    object
}

/// The pose of two cameras, from what each has seen.
fn of_both(
    args: &LocateArgs,
    file: &CaseFile,
    lenses: [&CalibratedCamera; 2],
    markers: [&[Observation]; 2],
    style: Style,
) -> Result<String, Failure> {
    let cameras = lenses.map(|lens| &lens.camera);
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
    for ((camera, output), lens) in found.cameras.into_iter().zip(outputs).zip(lenses) {
        if let Some((path, format)) = output {
            let camera = CalibratedCamera { camera, ..lens.clone() };
            files::write(path, calibrated_camera_text(&camera, format).as_bytes())?;
        }
    }
    let sure = Sure {
        covariance: found.uncertainty.covariance(args.pixel_deviation, None),
        pixel: args.pixel_deviation.or(found.uncertainty.pixel),
        scale: None,
        lens: "pixels alone",
    };
    if args.json {
        return Ok(format!("{:#}\n", object_of_both(args, &found, markers, &sure)));
    }
    let mut lines = Vec::new();
    for (i, name) in ["first", "second"].into_iter().enumerate() {
        let place = in_place(&found.cameras[i]);
        let error = pixels(found.rms[i]);
        lines.push((name, format!("{place}; {} markers, {error} RMS", markers[i].len())));
        if i == 0 {
            lines.push(("deviation", sure.words(&found.cameras[i])));
        }
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

fn object_of_both(
    args: &LocateArgs,
    found: &LocatedRig,
    markers: [&[Observation]; 2],
    sure: &Sure,
) -> Value {
    let outputs = [&args.output, &args.stereo_output];
    let cameras = [0, 1].map(|i| {
        let seen = (found.rms[i], &found.residuals[i][..]);
        located_object(&found.cameras[i], outputs[i].as_ref(), markers[i], seen)
    });
    let mut object = json!({ "cameras": cameras });
    add_place(&mut object, sure, found.other.as_ref(), found.is_ambiguous());
    object
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

fn words(
    args: &LocateArgs,
    found: &Located,
    markers: &[Observation],
    sure: &Sure,
    style: Style,
) -> String {
    let mut lines =
        vec![("place", in_place(&found.camera)), ("deviation", sure.words(&found.camera))];
    if let Lens::Orthographic(lens) = found.camera.lens() {
        let within = sure.scale.map(|of| format!(" ± {} %", number(1e2 * of, 2)));
        let within = within.unwrap_or_default();
        lines.push(("scale", format!("{} pixels/mm{within}", number(1e-3 * lens.scale(), 6))));
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
