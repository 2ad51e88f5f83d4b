//! `whipcord camera calibrate`: a lens, from photographs of a board.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use whipcord::Pose;
use whipcord_estimation::camera::CalibrateError;
use whipcord_estimation::camera::{Camera, FreeParameters, Lens};
use whipcord_io::{CalibratedCamera, Dimension, calibrated_camera_text, parse_quantity};
use whipcord_vision::boards::{
    Board, Calibration, NoCalibration, SeenBoard, Unseen, calibration, find,
};

use super::format_of;
use crate::photographs::Photograph;
use whipcord_study::failure::Failure;
use whipcord_study::files;
use whipcord_study::quantity::{degrees, fixed, number};
use whipcord_study::style::Style;
use whipcord_study::table::{Align, Table};

/// Calibrate the lens of a camera from photographs of a chessboard or a ChArUco board
///
/// Use about ten sharp photographs at fixed zoom and focus, with the board tilted by about 30° in
/// different directions and reaching all edges of the picture. Prints the reprojection error of
/// each photograph, the parameters with their uncertainty, and the photographs that cannot be used
/// with the reason. Writes the lens and its covariance in the format of OpenCV, for `camera locate`.
///
/// With --stereo, two cameras photograph the board at the same times: calibrates both lenses, and the
/// pose of the second camera relative to the first. Prints its uncertainty, and for each pair the
/// reprojection error and the distance of the corners from the epipolar constraint. Writes both
/// cameras, for `measure --stereo` and [[measured.cameras]]; the first is at the origin of the world.
#[derive(Debug, Args)]
pub struct CalibrateArgs {
    /// Photographs of the board, PNG or JPEG
    #[arg(required = true)]
    pub(super) photos: Vec<PathBuf>,
    /// Photographs of the second camera, in the same order and number as those of the first
    #[arg(long, value_name = "PHOTO", num_args = 1..)]
    pub(super) stereo: Vec<PathBuf>,
    /// Camera file with the lens of the first camera, which is then not calibrated; if it has a pose,
    /// the first camera keeps it
    #[arg(long, value_name = "CAMERA", requires = "stereo")]
    pub(super) camera: Option<PathBuf>,
    /// Camera file with the lens of the second camera, which is then not calibrated
    #[arg(long, value_name = "CAMERA", requires = "stereo")]
    pub(super) stereo_camera: Option<PathBuf>,
    /// Camera file to write for the second camera, .yml or .json
    #[arg(long, value_name = "CAMERA", requires = "stereo")]
    pub(super) stereo_output: Option<PathBuf>,
    /// Board: chessboard:9x6 with the number of inner corners along and across, or charuco:8x6 with
    /// the number of squares
    #[arg(long, value_name = "BOARD")]
    pub(super) board: String,
    /// Side of a square, as "25 mm"
    #[arg(long, value_name = "LENGTH", value_parser = length)]
    pub(super) square: f64,
    /// Side of the markers of a ChArUco board, as "18 mm"
    #[arg(long, value_name = "LENGTH", value_parser = length)]
    pub(super) marker: Option<f64>,
    /// Name in OpenCV of the marker dictionary of a ChArUco board, as DICT_4X4_50
    #[arg(long, value_name = "NAME")]
    pub(super) dictionary: Option<String>,
    /// Distortion coefficients to estimate, in the order of OpenCV; the others are zero
    #[arg(long, value_name = "WHICH", value_enum, default_value_t)]
    pub(super) distortion: Distortion,
    /// Camera file to write, .yml or .json
    #[arg(short, long, value_name = "CAMERA")]
    pub(super) output: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    pub(super) json: bool,
}

#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub(super) enum Distortion {
    /// No distortion
    None,
    /// k1 and k2
    K1k2,
    /// k1, k2, p1 and p2
    #[value(name = "4")]
    Four,
    /// k1, k2, p1, p2 and k3
    #[default]
    #[value(name = "5")]
    Five,
    /// The five and k4, k5, k6
    #[value(name = "8")]
    Eight,
    /// The eight and s1, s2, s3, s4
    #[value(name = "12")]
    Twelve,
}

/// In OpenCV's order.
const COEFFICIENTS: [&str; 12] =
    ["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4"];

impl From<Distortion> for FreeParameters {
    fn from(distortion: Distortion) -> Self {
        match distortion {
            Distortion::None => Self::None,
            Distortion::K1k2 => Self::Radial,
            Distortion::Four => Self::Four,
            Distortion::Five => Self::Five,
            Distortion::Eight => Self::Eight,
            Distortion::Twelve => Self::Twelve,
        }
    }
}

fn length(text: &str) -> Result<f64, String> {
    let length = parse_quantity(text, &[Dimension::Length]);
    length
        .map(|(metres, _)| metres)
        .map_err(|error| format!("{error}; give a length such as \"25 mm\""))
}

/// Finds the board in each, calibrates, writes the camera, and returns what standard output shows.
pub fn run(args: &CalibrateArgs, style: Style) -> Result<String, Failure> {
    let format = args.output.as_deref().map(format_of).transpose()?;
    let board = board(args)?;
    let seen = seen(&args.photos, &board)?;
    let shown = Shown { photos: &args.photos, output: args.output.as_deref(), board: &board };
    let (camera, found) = shown.camera(&seen, args.distortion)?;
    let corners = corners(&seen);
    let text = if args.json {
        format!("{:#}\n", shown.object(&found, &corners))
    } else {
        shown.summary(&found, &corners, style)
    };
    if let Some((path, format)) = args.output.as_deref().zip(format) {
        let lens_covariance = Some(found.calibrated.deviations.covariance.clone());
        let written = CalibratedCamera { camera, lens_covariance };
        files::write(path, calibrated_camera_text(&written, format).as_bytes())?;
    }
    Ok(text)
}

pub(super) fn board(args: &CalibrateArgs) -> Result<Board, Failure> {
    let board = Board::described(&args.board, args.square, args.marker, args.dictionary.as_deref());
    board.map_err(|error| Failure::Input(format!("error: --board: {error}")))
}

/// What each photograph shows of the board.
pub(super) fn seen(
    photos: &[PathBuf],
    board: &Board,
) -> Result<Vec<Result<SeenBoard, Unseen>>, Failure> {
    // One at a time: photographs are large.
    photos.iter().map(|path| Ok(find(&Photograph::read(path)?.photo, board))).collect()
}

/// How many corners each shows.
pub(super) fn corners(seen: &[Result<SeenBoard, Unseen>]) -> Vec<usize> {
    seen.iter().map(|seen| seen.as_ref().map_or(0, |seen| seen.corners.len())).collect()
}

/// The photographs of one camera, and where it is written.
pub(super) struct Shown<'a> {
    pub(super) photos: &'a [PathBuf],
    pub(super) output: Option<&'a Path>,
    pub(super) board: &'a Board,
}

impl Shown<'_> {
    /// The camera at the origin of the world, and how sure its lens is.
    pub(super) fn camera(
        &self,
        seen: &[Result<SeenBoard, Unseen>],
        distortion: Distortion,
    ) -> Result<(Camera, Calibration), Failure> {
        let found = calibration(seen, distortion.into()).map_err(|error| self.failure(&error))?;
        let lens = Lens::Pinhole(found.calibrated.lens);
        let camera = Camera::new(lens, Pose::IDENTITY, Some(found.size)).map_err(|error| {
            self.failure(&NoCalibration {
                error: CalibrateError::Camera(error),
                used: found.used.clone(),
                refused: found.refused.clone(),
            })
        })?;
        Ok((camera, found))
    }

    fn failure(&self, error: &NoCalibration) -> Failure {
        let mut text = format!("error: {error}");
        for (number, why) in &error.refused {
            text += &format!("\n  {}: {why}", self.photos[*number].display());
        }
        Failure::Solve(text)
    }

    pub(super) fn object(&self, found: &Calibration, corners: &[usize]) -> Value {
        let (lens, sure) = (&found.calibrated.lens, &found.calibrated.deviations);
        let name = |number: usize| self.photos[number].display().to_string();
        let photographs: Vec<Value> = found
            .used
            .iter()
            .zip(&found.calibrated.view_rms)
            .map(
                |(&number, rms)| json!({"photo": name(number), "corners": corners[number], "rms": rms}),
            )
            .collect();
        let refused: Vec<Value> = found
            .refused
            .iter()
            .map(|(number, why)| json!({"photo": name(*number), "reason": why.to_string()}))
            .collect();
        let warnings: Vec<String> = found.warnings.iter().map(ToString::to_string).collect();
        json!({
            "camera": self.output.map(|path| path.display().to_string()),
            "board": self.board.to_string(),
            "width": found.size[0],
            "height": found.size[1],
            "focal": lens.focal(),
            "focal_deviation": sure.focal,
            "centre": lens.centre(),
            "centre_deviation": sure.centre,
            "distortion": lens.distortion().coefficients(),
            "distortion_deviation": sure.distortion,
            "covariance": sure.covariance,
            "rms": found.calibrated.rms,
            "pixel_deviation": sure.pixel,
            "tilt": found.calibrated.tilt,
            "photographs": photographs,
            "refused": refused,
            "warnings": warnings,
        })
    }

    pub(super) fn summary(&self, found: &Calibration, corners: &[usize], style: Style) -> String {
        let (lens, sure) = (&found.calibrated.lens, &found.calibrated.deviations);
        let pair = |values: [f64; 2], deviations: [f64; 2]| {
            let [x, y] = [0, 1].map(|i| within(values[i], deviations[i]));
            format!("{x}, {y} pixels")
        };
        let [width, height] = found.size;
        let mut lines = vec![
            ("size", format!("{width}×{height} pixels")),
            ("focal", pair(lens.focal(), sure.focal)),
            ("centre", pair(lens.centre(), sure.centre)),
        ];
        let coefficients = lens.distortion().coefficients().iter().zip(&sure.distortion);
        for (name, (&value, deviation)) in COEFFICIENTS.into_iter().zip(coefficients) {
            lines.push((
                name,
                match *deviation {
                    Some(0.0) => number(value, 6),
                    Some(deviation) => within(value, deviation),
                    None => format!("{}, which the photographs do not tell", number(value, 6)),
                },
            ));
        }
        lines.push(("error", format!("{} pixels RMS", number(found.calibrated.rms, 3))));
        lines
            .push(("tilt", format!("up to {} between the boards", degrees(found.calibrated.tilt))));
        if let Some(path) = self.output {
            lines.push(("written", path.display().to_string()));
        }
        let (used, all) = (found.used.len(), self.photos.len());
        let title = format!("lens, from {used} of {all} photographs of a {}", self.board);
        let mut text = format!("{}\n", style.heading(title));
        for (name, value) in lines {
            let padding = " ".repeat("written".len() - name.len());
            text += &format!("  {}{padding}  {value}\n", style.faint(name.to_owned()));
        }
        let columns = [
            ("", Align::Right),
            ("photograph", Align::Left),
            ("corners", Align::Right),
            ("RMS", Align::Right),
        ];
        let mut table = Table::new(columns);
        for (&photo, &rms) in found.used.iter().zip(&found.calibrated.view_rms) {
            table.row(vec![
                (photo + 1).to_string(),
                self.photos[photo].display().to_string(),
                corners[photo].to_string(),
                fixed(rms, 3),
            ]);
        }
        text += &format!("\n{}", table.text(style));
        if !found.refused.is_empty() {
            text += "\nnot used\n";
        }
        for (photo, why) in &found.refused {
            text += &format!("  {}  {}: {why}\n", photo + 1, self.photos[*photo].display());
        }
        if !found.warnings.is_empty() {
            text += "\n";
        }
        for warning in &found.warnings {
            text += &format!("note: {warning}\n");
        }
        text
    }
}

/// `812.51 ± 0.23`: two digits of the deviation, and the value as far as these go.
pub(super) fn within(value: f64, deviation: f64) -> String {
    let decimals = (1.0 - deviation.max(1e-12).log10().floor()).clamp(0.0, 12.0) as usize;
    format!("{} ± {}", fixed(value, decimals), fixed(deviation, decimals))
}
