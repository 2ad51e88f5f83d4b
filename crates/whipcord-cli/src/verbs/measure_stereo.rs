//! `whipcord measure --stereo`: where disks or markers are in space, from two photographs.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use whipcord::Pose;
use whipcord_estimation::camera::{Camera, MatchError};
use whipcord_io::{SpacePoint, load_camera, points_csv};
use whipcord_vision::detect::{Base, Mark};
use whipcord_vision::{NoPoints, PointInSpace, PointsInSpace, annotated};

use super::measure::{MeasureArgs, View};
use crate::inputs::{Settings, read_one};
use crate::photographs::Photograph;
use whipcord_study::failure::{Failure, message};
use whipcord_study::files::{self, no_result, write};
use whipcord_study::quantity::fixed;
use whipcord_study::style::Style;
use whipcord_study::table::{Align, Table};

/// Largest epipolar distance, and standard deviation of a column or row, in pixels, where they are not given.
const EPIPOLAR: f64 = 3.0;
const DEVIATION: f64 = 0.3;

/// Finds, triangulates, writes the files, and returns what standard output shows.
pub fn run(args: &MeasureArgs, second: &Path, style: Style) -> Result<String, Failure> {
    refuse_outputs(args, second)?;
    let given = [args.camera.as_deref(), args.stereo_camera.as_deref()];
    let [Some(first_camera), Some(second_camera)] = given else {
        let text = "error: --stereo needs --camera and --stereo-camera, the files of both cameras";
        return Err(Failure::Input(text.to_owned()));
    };
    let paths = [first_camera, second_camera];
    let load = |path| load_camera(path).map_err(|error| Failure::Input(message(&error)));
    let cameras = [load(paths[0])?, load(paths[1])?];
    let robot =
        args.robot.as_deref().map(|path| read_one(path, &Settings::default())).transpose()?;
    // Of cameras that are not located the first is at the origin of the world, not the robot.
    let is_located = cameras[0].pose() != Pose::IDENTITY;
    let side = |base: Base| (!matches!(base, Base::Near(_))).then_some(base);
    let views = [
        View {
            photo: &args.photo,
            camera: Some((paths[0], &cameras[0])),
            hidden: &args.hidden,
            mask: args.mask.as_deref(),
            base: args.base,
            is_base_seen: is_located,
        },
        View {
            photo: second,
            camera: Some((paths[1], &cameras[1])),
            hidden: &args.stereo_hidden,
            mask: args.stereo_mask.as_deref(),
            base: args.stereo_base.or(args.base.and_then(side)),
            is_base_seen: is_located,
        },
    ];
    let photos = views.each_ref().map(|view| view.photo);
    let [(first, first_marks), (second, second_marks)] =
        [views[0].find(args, robot.as_ref())?, views[1].find(args, robot.as_ref())?];
    let (photographs, marks) = ([first, second], [first_marks, second_marks]);
    let has_numbers =
        args.count.is_some() || robot.as_ref().is_some_and(|file| file.robot.disks().are_present);
    let points = matched(args, photos, [&cameras[0], &cameras[1]], &marks, has_numbers)?;
    let text = if args.json {
        format!("{:#}\n", object(args, photos, paths, &points))
    } else {
        summary(args, photos, &points, style)
    };
    let rows = points.used.iter().map(|point| SpacePoint {
        disk: point.disk,
        position: point.found.point,
        deviations: point.found.deviations(),
        epipolar: point.found.epipolar,
    });
    let csv = points_csv(args.step.map(|step| step as usize), rows).to_csv();
    let csv = csv.map_err(|error| no_result(&error))?;
    let pictures = [&args.annotated, &args.stereo_annotated];
    for ((path, photograph), marks) in pictures.into_iter().zip(&photographs).zip(&marks) {
        if let Some(path) = path {
            write(path, &picture(args, path, photograph, marks)?)?;
        }
    }
    if let Some(path) = &args.output {
        write(path, csv.as_bytes())?;
    }
    Ok(text)
}

/// Refuses outputs that are inputs, or one another.
fn refuse_outputs(args: &MeasureArgs, second: &Path) -> Result<(), Failure> {
    let outputs: Vec<&PathBuf> =
        [&args.output, &args.annotated, &args.stereo_annotated].into_iter().flatten().collect();
    let inputs = [&args.mask, &args.stereo_mask, &args.robot, &args.camera, &args.stereo_camera];
    for (i, out) in outputs.iter().enumerate() {
        let read = inputs.into_iter().flatten().map(PathBuf::as_path);
        files::keep(out, read.chain([args.photo.as_path(), second]))?;
        if outputs[..i].contains(out) {
            let text = "error: the CSV file and the pictures have one name: give each its own";
            return Err(Failure::Input(text.to_owned()));
        }
    }
    Ok(())
}

fn picture(
    args: &MeasureArgs,
    path: &Path,
    photograph: &Photograph,
    marks: &[(usize, Mark)],
) -> Result<Vec<u8>, Failure> {
    annotated(&photograph.photo, args.kind, marks)
        .to_png()
        .map_err(|error| Failure::Input(format!("error: cannot draw {}: {error}", path.display())))
}

/// What is the same in both photographs, in space.
fn matched(
    args: &MeasureArgs,
    photos: [&Path; 2],
    cameras: [&Camera; 2],
    marks: &[Vec<(usize, Mark)>; 2],
    has_numbers: bool,
) -> Result<PointsInSpace, Failure> {
    let limit = args.epipolar.unwrap_or(EPIPOLAR);
    let deviation = args.pixel_deviation.unwrap_or(DEVIATION);
    let found = PointsInSpace::of(cameras, [&marks[0], &marks[1]], has_numbers, limit, deviation);
    found.map_err(|error| {
        let help = match error {
            NoPoints::Match(MatchError::Cameras(_)) => CAMERAS,
            NoPoints::Match(MatchError::NoCommon { .. }) | NoPoints::MostLeftOut { .. } => WRONG,
            NoPoints::Match(MatchError::Ambiguous { .. }) => {
                "--robot or --count, with --hidden and --stereo-hidden; --epipolar with a smaller distance"
            }
            NoPoints::NoCommon => "fewer numbers in --hidden and --stereo-hidden",
        };
        let [first, second] = photos.map(Path::display);
        Failure::Solve(format!("error: {first}, {second}: {error}\nhelp: {help}"))
    })
}

const CAMERAS: &str =
    "cameras with their poses, as `whipcord camera calibrate --stereo` writes them";
const WRONG: &str = "--camera and --stereo-camera in the order of the photographs, --base and --stereo-base at the same end of the robot, and photographs of one moment; or a larger --epipolar";

fn object(
    args: &MeasureArgs,
    photos: [&Path; 2],
    cameras: [&Path; 2],
    points: &PointsInSpace,
) -> Value {
    let used: Vec<Value> = points
        .used
        .iter()
        .map(|PointInSpace { disk, marks, found }| {
            json!({
                "disk": disk,
                "position": found.point.to_array(),
                "deviation": found.deviations().to_array(),
                "covariance": found.covariance.rows.map(|row| row.to_array()),
                "epipolar": found.epipolar,
                "angle": found.angle,
                "pixels": marks.map(|mark| mark.pixel),
                "residuals": found.residuals,
                "confidence": marks.map(|mark| mark.confidence),
            })
        })
        .collect();
    let left_out: Vec<Value> = points
        .left_out
        .iter()
        .map(|out| json!({"disks": out.disks, "epipolar": out.epipolar, "reason": out.why}))
        .collect();
    json!({
        "photos": photos.map(|path| path.display().to_string()),
        "cameras": cameras.map(|path| path.display().to_string()),
        "kind": args.kind.name(),
        "step": args.step,
        "pixel_deviation": args.pixel_deviation.unwrap_or(DEVIATION),
        "epipolar_limit": args.epipolar.unwrap_or(EPIPOLAR),
        "epipolar": points.epipolar(),
        "points": used,
        "left_out": left_out,
        "in_one_photo": points.single,
    })
}

fn summary(args: &MeasureArgs, photos: [&Path; 2], points: &PointsInSpace, style: Style) -> String {
    let name = format!("{}, {}", photos[0].display(), photos[1].display());
    let mut text = format!("{}\n", style.heading(name));
    let (count, kind) = (points.used.len(), args.kind.name());
    text += &format!("{count} {kind} in space, in mm, from base to tip\n\n");
    let columns = ["disk", "x", "y", "z", "±x", "±y", "±z", "epipolar"];
    let mut table = Table::new(columns.map(|name| (name, Align::Right)));
    for PointInSpace { disk, found, .. } in &points.used {
        let mut row = vec![disk.to_string()];
        row.extend(found.point.to_array().map(|x| fixed(1e3 * x, 3)));
        row.extend(found.deviations().to_array().map(|x| fixed(1e3 * x, 3)));
        row.push(fixed(found.epipolar, 2));
        table.row(row);
    }
    text += &table.text(style);
    if let Some(rms) = points.epipolar() {
        text += &format!("\nepipolar distance: {} pixels RMS\n", fixed(rms, 2));
    }
    for out in &points.left_out {
        let [first, second] = out.disks;
        let which = if first == second {
            first.to_string()
        } else {
            format!("{first} of the first photograph and {second} of the second")
        };
        text += &format!("\nleft out: {which}: {}\n", out.why);
    }
    for (name, single) in ["first", "second"].into_iter().zip(&points.single) {
        if !single.is_empty() {
            let numbers: Vec<String> = single.iter().map(ToString::to_string).collect();
            text += &format!("\nseen in the {name} photograph alone: {}\n", numbers.join(", "));
        }
    }
    let files = [
        ("measured", &args.output),
        ("picture", &args.annotated),
        ("picture", &args.stereo_annotated),
    ];
    for (what, path) in files {
        if let Some(path) = path {
            text += &format!("\n{what}: {}\n", path.display());
        }
    }
    text
}
