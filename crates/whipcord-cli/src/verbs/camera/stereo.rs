//! `whipcord camera calibrate --stereo`: two cameras and their relative pose, from pairs of photographs of a board.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use whipcord::Vec3;
use whipcord_estimation::camera::{Camera, Lens, Pinhole};
use whipcord_io::{CalibratedCamera, calibrated_camera_text, load_calibrated_camera};
use whipcord_vision::boards::{
    Board, Calibration, NoStereo, SeenBoard, Stereo, Unseen, UnusedPair, stereo,
};

use super::calibrate::{CalibrateArgs, Shown, board, corners, seen, within};
use super::format_of;
use whipcord_study::failure::{Failure, message};
use whipcord_study::files;
use whipcord_study::quantity::{fixed, number};
use whipcord_study::style::Style;
use whipcord_study::table::{Align, Table};

/// One of the two cameras.
struct Side<'a> {
    shown: Shown<'a>,
    /// The file with its lens, where that is given.
    given: Option<&'a Path>,
    seen: Vec<Result<SeenBoard, Unseen>>,
    camera: Camera,
    lens: Pinhole,
    size: [u32; 2],
    /// How sure the lens is; `None` where its file does not say so.
    lens_covariance: Option<Vec<Vec<f64>>>,
    /// Where the lens is calibrated.
    calibration: Option<Calibration>,
}

/// Finds the board in each, calibrates, writes the cameras, and returns what standard output shows.
pub fn run(args: &CalibrateArgs, style: Style) -> Result<String, Failure> {
    let outputs = [args.output.as_deref(), args.stereo_output.as_deref()];
    let given = [args.camera.as_deref(), args.stereo_camera.as_deref()];
    let mut formats = [None; 2];
    for (format, path) in formats.iter_mut().zip(outputs) {
        *format = path.map(format_of).transpose()?;
        let photos = args.photos.iter().chain(&args.stereo).map(PathBuf::as_path);
        path.map(|path| files::keep(path, photos.chain(given.into_iter().flatten())))
            .transpose()?;
    }
    if outputs[0].is_some() && outputs[0] == outputs[1] {
        let text = "error: -o and --stereo-output are one file: give each camera its own";
        return Err(Failure::Input(text.to_owned()));
    }
    let [first, second] = [args.photos.len(), args.stereo.len()];
    if first != second {
        return Err(Failure::Input(format!(
            "error: {first} photographs are of the first camera, but {second} of the second: both must be in the same order, two for each \
             time\nhelp: put the photographs of the first camera before --stereo and all options, and those of the second after it"
        )));
    }
    let board = board(args)?;
    let side = |which: usize| {
        let photos = if which == 0 { &args.photos } else { &args.stereo };
        let shown = Shown { photos, output: outputs[which], board: &board };
        Side::of(shown, given[which], args)
    };
    let sides = [side(0)?, side(1)?];
    let found = stereo(
        Some(&board),
        [&sides[0].seen, &sides[1].seen],
        [&sides[0].lens, &sides[1].lens],
        [sides[0].size, sides[1].size],
    );
    let mut found = found.map_err(|error| failure(&sides, &error))?;
    let covariances = sides.each_ref().map(|side| side.lens_covariance.as_deref());
    found.calibrated = found.calibrated.with_lens_covariances(covariances);
    // The first camera keeps the pose that its file gives it.
    let pose = sides[0].camera.pose();
    let mut written = found.calibrated.cameras;
    for camera in &mut written {
        *camera = camera
            .at(pose * camera.pose())
            .map_err(|error| Failure::Solve(format!("error: {error}")))?;
    }
    let text = if args.json {
        format!("{:#}\n", object(&sides, &board, &found))
    } else {
        summary(&sides, &board, &found, style)
    };
    let sure = sides.iter().map(|side| side.lens_covariance.clone());
    for (((path, format), camera), lens_covariance) in
        outputs.into_iter().zip(formats).zip(written).zip(sure)
    {
        if let Some((path, format)) = path.zip(format) {
            let camera = CalibratedCamera { camera, lens_covariance };
            files::write(path, calibrated_camera_text(&camera, format).as_bytes())?;
        }
    }
    Ok(text)
}

impl<'a> Side<'a> {
    fn of(
        shown: Shown<'a>,
        given: Option<&'a Path>,
        args: &CalibrateArgs,
    ) -> Result<Self, Failure> {
        // Before photographs are read, which takes longer.
        let camera = given.map(load_calibrated_camera).transpose();
        let camera = camera.map_err(|error| Failure::Input(message(&error)))?;
        let seen = seen(shown.photos, shown.board)?;
        let (camera, lens_covariance, calibration) = match camera {
            Some(of) => (of.camera, of.lens_covariance, None),
            None => {
                let (camera, found) = shown.camera(&seen, args.distortion)?;
                let covariance = found.calibrated.deviations.covariance.clone();
                (camera, Some(covariance), Some(found))
            }
        };
        let Lens::Pinhole(lens) = *camera.lens() else {
            let name = given.unwrap_or(Path::new("the camera")).display();
            return Err(Failure::Input(format!(
                "error: {name}: an orthographic camera cannot be calibrated by a board: locate each by the robot with `whipcord camera locate`"
            )));
        };
        let first = seen.iter().flatten().next().map(|board| board.size);
        let size = camera.size().or(first).unwrap_or_default();
        // A file without a size gets that of the photographs.
        let camera = match camera.size() {
            None if first.is_some() => Camera::new(*camera.lens(), camera.pose(), first),
            _ => Ok(camera),
        };
        let camera = camera.map_err(|error| Failure::Input(format!("error: {error}")))?;
        Ok(Self { shown, given, seen, camera, lens, size, lens_covariance, calibration })
    }

    fn photo(&self, number: usize) -> String {
        self.shown.photos[number].display().to_string()
    }

    /// Its lens for programs.
    fn object(&self) -> Value {
        match (&self.calibration, self.given) {
            (Some(found), _) => self.shown.object(found, &corners(&self.seen)),
            (None, given) => json!({
                "camera": self.shown.output.map(|path| path.display().to_string()),
                "lens": given.map(|path| path.display().to_string()),
            }),
        }
    }
}

fn failure(sides: &[Side<'_>; 2], error: &NoStereo) -> Failure {
    Failure::Solve(format!("error: {error}{}", refused(sides, &error.refused)))
}

fn refused(sides: &[Side<'_>; 2], refused: &[(usize, UnusedPair)]) -> String {
    let line = |(number, why): &(usize, UnusedPair)| {
        let [first, second] = sides.each_ref().map(|side| side.photo(*number));
        format!("\n  {}  {first}, {second}: {why}", number + 1)
    };
    refused.iter().map(line).collect()
}

fn object(sides: &[Side<'_>; 2], board: &Board, found: &Stereo) -> Value {
    let stereo = &found.calibrated;
    let pose = stereo.cameras[1].pose();
    let names = |number: usize| sides.each_ref().map(|side| side.photo(number));
    let pairs: Vec<Value> = stereo
        .pairs
        .iter()
        .map(|pair| {
            json!({
                "photographs": names(pair.number),
                "common_corners": pair.common,
                "rms": pair.rms,
                "epipolar": pair.epipolar,
                "renumbered": pair.renumbered,
            })
        })
        .collect();
    let refused: Vec<Value> = found
        .refused
        .iter()
        .map(|(number, why)| json!({"photographs": names(*number), "reason": why.to_string()}))
        .collect();
    json!({
        "board": board.to_string(),
        "cameras": sides.each_ref().map(Side::object),
        "position": pose.position.to_array(),
        "position_deviation": stereo.position_deviation().to_array(),
        "rotation": pose.rotation.log().to_array(),
        "rotation_deviation": stereo.rotation_deviation().to_array(),
        "covariance": stereo.covariance,
        "baseline": stereo.baseline[0],
        "baseline_deviation": stereo.baseline[1],
        "rms": stereo.rms,
        "epipolar": stereo.epipolar,
        "pixel_deviation": stereo.pixel,
        "pairs": pairs,
        "refused": refused,
    })
}

fn summary(sides: &[Side<'_>; 2], board: &Board, found: &Stereo, style: Style) -> String {
    let mut text = String::new();
    for (name, side) in ["first camera", "second camera"].into_iter().zip(sides) {
        if let Some(found) = &side.calibration {
            let lens = side.shown.summary(found, &corners(&side.seen), style);
            text += &format!("{name}: {lens}\n");
        }
    }
    let stereo = &found.calibrated;
    let pose = stereo.cameras[1].pose();
    let triple = |values: Vec3, deviations: Vec3, unit: f64| {
        [0, 1, 2].map(|i| within(values[i] * unit, deviations[i] * unit)).join(", ")
    };
    let degrees = 1f64.to_degrees();
    let position = triple(pose.position, stereo.position_deviation(), 1e3);
    let rotation = triple(pose.rotation.log(), stereo.rotation_deviation(), degrees);
    let [baseline, deviation] = stereo.baseline.map(|x| 1e3 * x);
    let mut lines = vec![
        ("position", format!("({position}) mm, in the frame of the first camera")),
        ("rotation", format!("({rotation})°, rotation vector from the first camera")),
        ("distance", format!("{} mm", within(baseline, deviation))),
        ("error", format!("{} pixels RMS", number(stereo.rms, 3))),
    ];
    if let Some(epipolar) = stereo.epipolar {
        lines.push(("epipolar", format!("{} pixels RMS", number(epipolar, 3))));
    }
    let written: Vec<String> =
        sides.iter().filter_map(|side| Some(side.shown.output?.display().to_string())).collect();
    if !written.is_empty() {
        lines.push(("written", written.join(", ")));
    }
    let [used, all] = [stereo.pairs.len(), sides[0].seen.len()];
    let title = format!("second camera, from {used} of {all} pairs of photographs of a {board}");
    text += &format!("{}\n", style.heading(title));
    for (name, value) in lines {
        let padding = " ".repeat("position".len() - name.len());
        text += &format!("  {}{padding}  {value}\n", style.faint(name.to_owned()));
    }
    let columns = [
        ("", Align::Right),
        ("first", Align::Left),
        ("second", Align::Left),
        ("common", Align::Right),
        ("RMS", Align::Right),
        ("RMS", Align::Right),
        ("epipolar", Align::Right),
    ];
    let mut table = Table::new(columns);
    for pair in &stereo.pairs {
        let [first, second] = sides.each_ref().map(|side| side.photo(pair.number));
        table.row(vec![
            (pair.number + 1).to_string(),
            first,
            second,
            pair.common.to_string(),
            fixed(pair.rms[0], 3),
            fixed(pair.rms[1], 3),
            pair.epipolar.map_or_else(String::new, |distance| fixed(distance, 3)),
        ]);
    }
    text += &format!("\n{}", table.text(style));
    if !found.refused.is_empty() {
        text += &format!("\nnot used{}\n", refused(sides, &found.refused));
    }
    text
}
