//! The figures of a case.

use whipcord_plot::{
    Acting, CableCourse, Colour, DistanceSeries, FigureOptions, Marker, PlotError, RobotView,
    SmallMultiple, ViewStyle, distance_chart, label, robot_figure, small_multiples,
};

use super::study::{Commands, Study};
use crate::failure::Failure;
use crate::files::plot_failure;
use crate::html::Figure;

/// The robot with the shapes of all models, and their distances at the disks; none of a case
/// without an answer.
///
/// # Errors
/// [`Failure::Input`] when one cannot be drawn.
pub fn figures(study: &Study) -> Result<Vec<Figure>, Failure> {
    let mut figures = Vec::new();
    let Some((_, reference)) = study.reference() else { return Ok(figures) };
    let fail = |error: PlotError| plot_failure(&study.file.path, &error);
    let views = views(study);
    // Moved, where that was asked for, onto the first model.
    let last = study.file.case.before.len();
    let measured = reference.compared().into_iter().flat_map(|distances| &distances.markers);
    let measured = measured.filter(|marker| marker.step == last);
    let options = FigureOptions {
        title: study.file.title.clone(),
        measured: measured.map(|marker| marker.measured).collect(),
        loads: Acting::on(&study.file.case, &reference.fine),
        ..FigureOptions::default()
    }
    .among(&study.file.case.obstacles, Some(&reference.solution));
    figures.push(Figure {
        name: "robot".into(),
        caption: String::from(
            "The robot before actuation (grey) and as each model bends it: in space, and in three orthogonal views of one scale.",
        ),
        svg: robot_figure(&study.file.robot, &views, &options).map_err(fail)?,
    });
    let distances = distances(study);
    if !distances.is_empty() {
        let title = format!("Distance at each disk: {}", study.file.title);
        figures.push(Figure {
            name: "distances".into(),
            caption: String::from(
                "Distance at each disk: between models, and to the measurement where there is one; of a case in steps the root mean square over all steps.",
            ),
            svg: distance_chart(&title, &distances).map_err(fail)?,
        });
    }
    Ok(figures)
}

/// The robot before actuation, and as each model has it.
fn views(study: &Study) -> Vec<RobotView> {
    let mut views = vec![RobotView::at_rest(&study.file.robot, study.file.case.base)];
    views.extend(study.solved().map(|(run, solved)| RobotView {
        label: label(run.label(), &solved.solution),
        shape: solved.fine.clone(),
        disks: solved.solution.disks.clone(),
        cables: CableCourse::of(solved.solution.model),
        style: ViewStyle::Model(solved.solution.model),
    }));
    views
}

/// A small picture of each case, of one scale; none of a case without an answer.
///
/// # Errors
/// [`Failure::Input`] when one cannot be drawn.
pub fn multiples(studies: &[Study]) -> Result<Vec<Option<String>>, Failure> {
    let drawn: Vec<_> = studies
        .iter()
        .filter(|study| study.reference().is_some())
        .map(|study| (study, views(study), distances(study)))
        .collect();
    let cases: Vec<_> = drawn
        .iter()
        .map(|(study, views, distances)| SmallMultiple {
            title: &study.file.title,
            views,
            distances,
        })
        .collect();
    let Some((first, ..)) = drawn.first() else { return Ok(vec![None; studies.len()]) };
    let pictures =
        small_multiples(&cases).map_err(|error| plot_failure(&first.file.path, &error))?;
    let mut pictures = pictures.into_iter();
    Ok(studies.iter().map(|study| study.reference().and_then(|_| pictures.next())).collect())
}

fn distances(study: &Study) -> Vec<DistanceSeries> {
    let mut series = Vec::new();
    let Some((first, reference)) = study.reference() else { return series };
    for (run, solved) in study.solved() {
        // Paler where the colour is taken by the distance to the measurement.
        let (colour, marker) = (Colour::of_model(run.model), Marker::of_model(run.model));
        let hollow = run.commands != Commands::File;
        let pale = if solved.measured.is_some() { colour.tint(0.5) } else { colour };
        if study.distance_to_reference(run, solved).is_some() {
            series.push(DistanceSeries {
                label: format!("{} to {}", run.label(), first.label()),
                disks: (1..).zip(solved.distances(reference)).collect(),
                look: Some((pale, marker)),
                hollow,
            });
        }
        let to_measured: Vec<(usize, f64)> = (1..=study.file.robot.disks().count())
            .filter_map(|disk| Some((disk, solved.compared()?.rms_of_disk(disk)?)))
            .collect();
        if !to_measured.is_empty() {
            let label = format!("{} to measured", run.label());
            let look = Some((colour, marker));
            series.push(DistanceSeries { label, disks: to_measured, look, hollow });
        }
    }
    series
}
