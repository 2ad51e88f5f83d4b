//! `whipcord overlay`: the models over a photograph of the robot.

use std::path::PathBuf;

use clap::Args;
use whipcord::{Actuation, Case, Model, ModelKind, SolveError, Stations};
use whipcord_estimation::observation::{self, InImage, in_image};
use whipcord_io::{AnswerOf, CaseFile, load_markers};
use whipcord_plot::{
    Colour, DistanceSeries, FINE_STATIONS, Marker as Sign, OverlayOptions, Photograph as Stored,
    RobotView, distance_chart, overlay_figure,
};

use crate::deadline;
use crate::inputs::{Settings, read_one};
use crate::model_arguments::model_parser;
use crate::photographs::Photograph;
use crate::superposition::seen;
use crate::superposition::{Run, tables};
use crate::warnings::Warnings;
use whipcord_study::describe::{REVERSED_HELP, reversed};
use whipcord_study::failure::Failure;
use whipcord_study::failure::message;
use whipcord_study::files::{self, Folder};
use whipcord_study::quantity::millimetres;
use whipcord_study::style::Style;

/// Draw the models over a photograph of the robot
///
/// Draws the backbone, the disks and the cables of each model in the view of the camera. If
/// --markers or [measured] gives the pixels of disks or markers, prints the distance of each model
/// from them, in pixels and in mm from the line of sight, and the RMS over all disks except the
/// base disk, in mm and in % of the length. Writes the picture and a chart of the distances as SVG
/// and PNG, and the numbers as CSV.
#[derive(Debug, Args)]
pub struct OverlayArgs {
    /// Photograph, PNG or JPEG
    photograph: PathBuf,
    /// Robot file
    file: PathBuf,
    #[command(flatten)]
    settings: Settings,
    /// Camera of the photograph: a name from [[measured.cameras]], or a camera file; by default the
    /// only camera in the robot file
    #[arg(long, value_name = "NAME")]
    camera: Option<String>,
    /// CSV file with the pixels of disks or markers, as `whipcord measure` writes it; by default
    /// the table of [measured]
    #[arg(long, value_name = "CSV")]
    markers: Option<PathBuf>,
    /// ActuationArgument step that the photograph shows, from 1; by default the last
    #[arg(long, value_name = "K")]
    step: Option<usize>,
    /// Model; may be given several times; by default all models that accept the case
    #[arg(long, value_name = "NAME", value_parser = model_parser())]
    model: Vec<ModelKind>,
    /// Folder for the pictures and the CSV file
    #[arg(long, value_name = "DIR", default_value = "whipcord-overlay")]
    out: PathBuf,
    #[command(flatten)]
    warnings: Warnings,
}

/// Solves, writes the files, and returns the table.
pub fn run(args: &OverlayArgs, style: Style) -> Result<String, Failure> {
    let file = read_one(&args.file, &args.settings)?;
    let photograph = Photograph::read(&args.photograph)?;
    let (camera, number) = seen::camera(&file, args.camera.as_deref())?;
    let called = args.camera.as_deref().unwrap_or("the camera");
    photograph.check_camera(&called, &camera)?;
    let (step, case) = step(&file, args.step)?;
    let markers = match (&args.markers, &file.measured, number) {
        (Some(path), ..) => {
            let found = load_markers(path, &file.robot);
            let found = found.map_err(|error| Failure::Input(message(&error)))?;
            in_image(&file.robot, &found, 0, 0)
        }
        (None, Some(measured), Some(camera)) => {
            in_image(&file.robot, &measured.observations, camera, step)
        }
        _ => Vec::new(),
    };
    let kinds = if args.model.is_empty() { ModelKind::ALL.to_vec() } else { args.model.clone() };
    let overlay = |kind| {
        let model =
            Model::new(kind, Stations::Disks, Actuation::Natural).cancelled_by(&deadline::cancel());
        observation::overlay(&model, &file.robot, &case, &camera, &markers, FINE_STATIONS)
    };
    let runs: Vec<Run> =
        kinds.into_iter().map(|model| Run { model, outcome: overlay(model) }).collect();
    refuse_unsolved(&file, &runs, !args.model.is_empty())?;

    let length = file.robot.backbone().length;
    let answered = || runs.iter().filter_map(|run| Some((run, run.outcome.as_ref().ok()?)));
    let views: Vec<RobotView> = answered()
        .map(|(_, superposed)| RobotView::overlaid(superposed, &markers, length))
        .collect();
    let options = OverlayOptions {
        title: file.title.clone(),
        measured: markers.iter().map(|marker| marker.pixel).collect(),
        ..OverlayOptions::default()
    };
    let stored = Stored { bytes: &photograph.bytes, size: photograph.size() };
    let draw = |error| files::plot_failure(&args.photograph, &error);
    let picture = overlay_figure(&file.robot, &camera, stored, &views, &options).map_err(draw)?;
    let chart = chart(&file, &runs, &markers).transpose().map_err(draw)?;

    let mut warnings = file.warnings();
    warnings.extend(file.answer_warnings(answered().map(|(run, overlaid)| {
        (Some(AnswerOf { model: Some(run.model), step: None }), &overlaid.solution)
    })));
    args.warnings.tell(&file, &warnings)?;
    let folder = Folder::create(&args.out)?;
    let stem = args.photograph.file_stem().unwrap_or_default().to_string_lossy();
    folder.write_figure(&format!("{stem}-overlay"), &picture)?;
    let mut text = String::new();
    if let Some(chart) = chart {
        folder.write_figure(&format!("{stem}-distances"), &chart)?;
    }
    if markers.is_empty() {
        text += &format!(
            "{} does not say where this camera saw the robot in step {}: nothing to measure the models by (--markers)\n",
            file.path.display(),
            step + 1
        );
    } else {
        folder.write_table(&format!("{stem}-distances.csv"), &tables::csv(&runs, &markers))?;
        text += &tables::table(&runs, &markers, length).text(style);
        text += &format!(
            "\nDistance in the image, and of the model's disk from the line of sight; RMS without the base disk, \
             length {}.\n",
            millimetres(length)
        );
    }
    if answered().any(|(_, superposed)| superposed.is_reversed(&markers)) {
        text += &format!("! {}; {REVERSED_HELP}\n", reversed(&file));
    }
    for (run, error) in runs.iter().filter_map(|run| Some((run, run.outcome.as_ref().err()?))) {
        text += &format!("{}: {error}\n", run.model);
    }
    text += &format!("\npictures and numbers: {}\n", folder.path().display());
    Ok(text)
}

/// The step that is asked for, from 0, and its case.
fn step(file: &CaseFile, asked: Option<usize>) -> Result<(usize, Case), Failure> {
    let count = file.case.before.len() + 1;
    let step = asked.unwrap_or(count);
    let case = step.checked_sub(1).and_then(|step| Some((step, file.case.step(step)?)));
    case.ok_or_else(|| {
        Failure::Input(format!(
            "error: there is no step {step}: {} has steps 1 to {count}",
            file.path.display()
        ))
    })
}

/// A model that was asked for by name must have an answer, and else at least one.
fn refuse_unsolved(file: &CaseFile, runs: &[Run], named: bool) -> Result<(), Failure> {
    let failed: Vec<&SolveError> =
        runs.iter().filter_map(|run| run.outcome.as_ref().err()).collect();
    match failed.first() {
        Some(first) if named || failed.len() == runs.len() => Err(Failure::from_solve(file, first)),
        _ => Ok(()),
    }
}

/// Distance at each disk; `None` where none was seen.
fn chart(
    file: &CaseFile,
    runs: &[Run],
    markers: &[InImage],
) -> Option<Result<String, whipcord_plot::PlotError>> {
    let mut series = Vec::new();
    for run in runs {
        let Ok(superposed) = &run.outcome else { continue };
        let disks: Vec<(usize, f64)> = markers
            .iter()
            .zip(&superposed.residuals)
            .filter_map(|(marker, miss)| Some((marker.disk()?, (*miss)?.distance)))
            .collect();
        if !disks.is_empty() {
            let look = Some((Colour::of_model(run.model), Sign::of_model(run.model)));
            let label = run.model.to_string();
            series.push(DistanceSeries { label, disks, look, hollow: false });
        }
    }
    (!series.is_empty()).then(|| distance_chart(&file.title, &series))
}
