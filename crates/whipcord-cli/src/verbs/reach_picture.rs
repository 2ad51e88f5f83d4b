//! Pictures of `whipcord reach`: the robot at its target, and a film along a path.

use std::path::Path;

use whipcord::{Model, Pose, Vec3};
use whipcord_inverse::{Followed, PathPoint, Reached, Target};
use whipcord_io::CaseFile;
use whipcord_plot::{Acting, FigureOptions, FilmFrame, RobotView, label, robot_figure};

use crate::film::{AZIMUTH, FILM_WIDTH, durations, encoded, spread};
use crate::smooth::smooth;
use whipcord_study::failure::Failure;
use whipcord_study::files;
use whipcord_study::quantity::number;

/// Shapes of a picture of a path.
const SHAPES: usize = 5;
/// Pictures of a film at most.
const MOST_PICTURES: usize = 80;

/// The robot at rest and in an answer, with the points that it was to reach.
pub fn draw(
    path: &Path,
    (file, model): (&CaseFile, &Model),
    answer: &Reached,
    targets: Vec<Vec3>,
) -> Result<Vec<u8>, Failure> {
    let options = FigureOptions { targets, ..FigureOptions::default() };
    let svg = figure(path, (file, model), &[(answer, String::new())], options)?;
    files::picture(&svg, path)
}

/// The robot at some points of a path, the last of them the end.
pub fn draw_path(
    path: &Path,
    at: (&CaseFile, &Model),
    (points, followed): (&[PathPoint], &Followed),
) -> Result<Vec<u8>, Failure> {
    let options = FigureOptions { targets: places(points), ..FigureOptions::default() };
    let shapes: Vec<(&Reached, String)> = spread(followed.answers.len(), SHAPES)
        .map(|k| (&followed.answers[k], time(&points[k])))
        .collect();
    let svg = figure(path, at, &shapes, options)?;
    files::picture(&svg, path)
}

/// A film of the robot along a path, in the time of the path.
pub fn film_path(
    path: &Path,
    at: (&CaseFile, &Model),
    (points, followed): (&[PathPoint], &Followed),
) -> Result<Vec<u8>, Failure> {
    let targets = places(points);
    let all =
        followed.answers.iter().flat_map(|answer: &Reached| answer.solution.disks.poses.iter());
    let room: Vec<Vec3> = all.map(|pose| pose.position).collect();
    let numbers: Vec<usize> = spread(points.len(), MOST_PICTURES).collect();
    let times: Vec<f64> = numbers.iter().map(|&k| points[k].time).collect();
    let mut frames = Vec::with_capacity(numbers.len());
    for (k, milliseconds) in numbers.into_iter().zip(durations(&times)) {
        let options = FigureOptions {
            targets: targets.clone(),
            room: room.clone(),
            azimuth: Some(AZIMUTH),
            width: FILM_WIDTH,
            ..FigureOptions::default()
        };
        let svg = figure(path, at, &[(&followed.answers[k], time(&points[k]))], options)?;
        frames.push(FilmFrame { svg, milliseconds });
    }
    encoded(path, &frames)
}

fn time(point: &PathPoint) -> String {
    format!("{} s", number(point.time, 3))
}

fn places(path: &[PathPoint]) -> Vec<Vec3> {
    path.iter().flat_map(|point| points(&point.target)).collect()
}

/// The robot at rest and in these shapes, with what their names say after that of the model.
fn figure(
    path: &Path,
    (file, model): (&CaseFile, &Model),
    shapes: &[(&Reached, String)],
    options: FigureOptions,
) -> Result<String, Failure> {
    let mut views = vec![RobotView::at_rest(&file.robot, file.case.base)];
    let mut options = FigureOptions { title: file.title.clone(), ..options };
    // What a smooth shape is solved for.
    let mut file = file.clone();
    for (answer, words) in shapes {
        let solution = &answer.solution;
        file.case.clone_from(&answer.case);
        let fine = smooth(model, &file, solution);
        options.loads = Acting::on(&file.case, &fine.shape);
        let name = match words.is_empty() {
            true => solution.model.to_string(),
            false => format!("{}, {words}", solution.model),
        };
        views.push(RobotView::model(label(name, solution), &fine));
    }
    let last = shapes.last().map(|(answer, _)| &answer.solution);
    let options = options.among(&file.case.obstacles, last);
    robot_figure(&file.robot, &views, &options).map_err(|error| files::plot_failure(path, &error))
}

/// The points of a target.
pub fn points(target: &Target) -> Vec<Vec3> {
    match target {
        Target::Tip(point) => vec![*point],
        Target::Pose(Pose { position, .. }) => vec![*position],
        Target::Axis { point, .. } => point.iter().copied().collect(),
        Target::Shape(points) => points.iter().map(|(_, point)| *point).collect(),
    }
}
