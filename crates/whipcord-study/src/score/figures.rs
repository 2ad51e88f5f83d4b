//! The score in pictures: errors against commands, along the backbone and from row to row, and the worst rows.

use whipcord::{Actuation, Case, Drive, Model, Robot, Shortening, Stations};
use whipcord_plot::{
    Acting, AxisSpec, Chart, Colour, FINE_STATIONS, FigureOptions, Layer, Marker, PlotError,
    RobotView, Series, label, robot_figure,
};

use super::{FileScore, MarkerScore, Score};
use crate::html::Figure;
use crate::statistics::root_mean_square;

/// Most points of one chart: a report of some thousand rows stays small.
const MOST_POINTS: usize = 2400;
/// Most commands that errors are drawn against.
const MOST_COMMANDS: usize = 6;
/// Most places along the backbone with a sign of their own.
const MOST_PLACES: usize = 200;
/// Rows that are drawn.
const DRAWN: usize = 3;

/// All pictures of a score.
///
/// # Errors
/// [`PlotError`] for a picture that cannot be drawn.
pub fn figures(score: &Score<'_>) -> Result<Vec<Figure>, PlotError> {
    let mut figures = against_commands(score)?;
    figures.extend(along_the_backbone(score)?);
    figures.extend(from_row_to_row(score)?);
    figures.extend(worst_rows(score)?);
    Ok(figures)
}

/// Points of each model, with those that are left out where there are too many, evenly.
fn series(score: &Score<'_>, points: Vec<Vec<[f64; 2]>>) -> (Vec<Series>, usize) {
    let all: usize = points.iter().map(Vec::len).sum();
    let every = all.div_ceil(MOST_POINTS).max(1);
    let series = score.models.iter().zip(points).filter(|(_, points)| !points.is_empty());
    let series = series.map(|(model, points)| Series {
        label: model.to_string(),
        colour: Colour::of_model(*model),
        marker: Marker::of_model(*model),
        layers: vec![Layer::Markers(points.into_iter().step_by(every).collect())],
    });
    (series.collect(), every)
}

fn left_out(every: usize) -> String {
    match every {
        1 => String::new(),
        2 => String::from(" Every second row is drawn."),
        n => format!(" Every {n}th row is drawn."),
    }
}

/// A command of a row: its name with its unit, and its number in it.
fn commands(robot: &Robot, case: &Case, row: usize) -> Vec<(String, f64)> {
    let mut found = Vec::new();
    let steps = case.before.len() + 1;
    let motors = case.motors.len().saturating_sub(steps) + row;
    let of_motors = case.motors.get(motors).map_or(&[][..], Vec::as_slice);
    for (motor, command) in robot.motors().iter().zip(of_motors) {
        let Some(command) = command else { continue };
        found.push(match motor.drive {
            Drive::Spool { .. } => (format!("{} (degrees)", motor.name), command.to_degrees()),
            Drive::Linear => (format!("{} (mm)", motor.name), 1e3 * command),
        });
    }
    let has_command = |cable: usize| {
        let driven = robot.motors().iter().zip(of_motors).filter(|(_, command)| command.is_some());
        driven.into_iter().any(|(motor, _)| motor.cables.iter().any(|of| of.cable == cable))
    };
    let of_cables = case.before.get(row).unwrap_or(&case.commands);
    for (number, (cable, command)) in robot.cables().iter().zip(of_cables).enumerate() {
        if let Some(tension) = command.tension {
            found.push((format!("{}: tension (N)", cable.name), tension));
        }
        match command.shortening.filter(|_| !has_command(number)) {
            Some(Shortening::Length(length)) => {
                found.push((format!("{}: shortening (mm)", cable.name), 1e3 * length));
            }
            Some(Shortening::Fraction(part)) => {
                found.push((format!("{}: shortening (%)", cable.name), 100.0 * part));
            }
            None => {}
        }
    }
    found
}

fn against_commands(score: &Score<'_>) -> Result<Vec<Figure>, PlotError> {
    // Of each command that any row has, in the order in which they are met: the points of each model.
    let mut charts: Vec<(String, Vec<Vec<[f64; 2]>>)> = Vec::new();
    for (file, models) in score.files.iter().enumerate() {
        let of = score.file(file);
        for (place, row) in score.subjects[file].rows.iter().enumerate() {
            for (name, value) in commands(&of.robot, &of.case, *row) {
                let known = charts.iter().position(|(known, _)| *known == name);
                let chart = known.unwrap_or_else(|| {
                    charts.push((name, vec![Vec::new(); score.models.len()]));
                    charts.len() - 1
                });
                for (points, model) in charts[chart].1.iter_mut().zip(models) {
                    if let Some(error) = model.rows.get(place).and_then(|row| row.error) {
                        points.push([value, 1e3 * error]);
                    }
                }
            }
        }
    }
    // What never changes explains no error.
    charts.retain(|(_, models)| {
        let mut values = models.iter().flatten().map(|[value, _]| *value);
        values.next().is_some_and(|first| values.any(|value| value != first))
    });
    let left = charts.len().saturating_sub(MOST_COMMANDS);
    let mut figures = Vec::new();
    for (number, (name, points)) in charts.into_iter().take(MOST_COMMANDS).enumerate() {
        let (series, every) = series(score, points);
        let mut caption =
            format!("Error of each row against the command of {name}.{}", left_out(every));
        if number + 1 == MOST_COMMANDS && left > 0 {
            caption += &format!(" {left} more commands are not drawn.");
        }
        let svg = Chart {
            title: String::from("Error against command"),
            x: AxisSpec::linear(name),
            y: AxisSpec::linear("error (mm)").from_zero(),
            series,
            ..Chart::default()
        };
        let name = format!("command-{}", number + 1).into();
        figures.push(Figure { name, caption, svg: svg.svg()? });
    }
    Ok(figures)
}

fn along_the_backbone(score: &Score<'_>) -> Result<Option<Figure>, PlotError> {
    let mut series = Vec::new();
    let mut most = 0;
    for (number, model) in score.models.iter().enumerate() {
        let of_files = score.files.iter().flat_map(|models| &models[number].markers);
        let mut markers: Vec<&MarkerScore> = of_files.filter(|marker| !marker.at_base).collect();
        markers.sort_by(|a, b| a.arc_length.total_cmp(&b.arc_length));
        let places = markers.chunk_by(|a, b| a.arc_length == b.arc_length);
        let points: Vec<[f64; 2]> = places
            .filter_map(|place| {
                let rms = root_mean_square(place.iter().map(|marker| marker.distance()))?;
                Some([1e3 * place.first()?.arc_length, 1e3 * rms])
            })
            .collect();
        most = most.max(points.len());
        if !points.is_empty() {
            let every = points.len().div_ceil(MOST_PLACES).max(1);
            let points: Vec<[f64; 2]> = points.into_iter().step_by(every).collect();
            series.push(Series {
                label: model.to_string(),
                colour: Colour::of_model(*model),
                marker: Marker::of_model(*model),
                layers: vec![Layer::Line(points.clone()), Layer::Markers(points)],
            });
        }
    }
    // One place alone is what the table gives.
    if most < 2 {
        return Ok(None);
    }
    let svg = Chart {
        title: String::from("Error along the backbone"),
        x: AxisSpec::linear("arc length (mm)"),
        y: AxisSpec::linear("RMS error (mm)").from_zero(),
        series,
        ..Chart::default()
    };
    Ok(Some(Figure {
        name: "arc".into(),
        caption: String::from(
            "Root mean square error of the markers at each arc length, over all rows.",
        ),
        svg: svg.svg()?,
    }))
}

fn from_row_to_row(score: &Score<'_>) -> Result<Option<Figure>, PlotError> {
    let count: usize = score.subjects.iter().map(|subject| subject.rows.len()).sum();
    if count < 2 {
        return Ok(None);
    }
    let mut points = vec![Vec::new(); score.models.len()];
    let mut before = 0;
    for models in &score.files {
        for (points, model) in points.iter_mut().zip(models) {
            let errors = model.rows.iter().enumerate();
            points.extend(
                errors.filter_map(|(place, row)| {
                    Some([(before + place + 1) as f64, 1e3 * row.error?])
                }),
            );
        }
        before += models.first().map_or(0, |model| model.rows.len());
    }
    let (series, every) = series(score, points);
    if series.is_empty() {
        return Ok(None);
    }
    let svg = Chart {
        title: String::from("Error of each row"),
        x: AxisSpec::linear("measured row, in the order of the files"),
        y: AxisSpec::linear("error (mm)").from_zero(),
        series,
        ..Chart::default()
    };
    let caption = format!(
        "Error of each row in the order of the files: a slope or a jump is drift of the robot or of the measurement.{}",
        left_out(every)
    );
    Ok(Some(Figure { name: "rows".into(), caption, svg: svg.svg()? }))
}

/// The rows in which the best model is farthest off, drawn.
fn worst_rows(score: &Score<'_>) -> Result<Vec<Figure>, PlotError> {
    let Some(best) = score.best() else { return Ok(Vec::new()) };
    let mut rows: Vec<(usize, usize, f64)> = Vec::new();
    for (file, models) in score.files.iter().enumerate() {
        let own = &models[best].rows;
        rows.extend(own.iter().filter_map(|row| Some((file, row.row, row.error?))));
    }
    rows.sort_by(|a, b| b.2.total_cmp(&a.2));
    rows.truncate(DRAWN);
    let mut views = views(score, best, &rows);
    let mut figures = Vec::new();
    for (number, (file, row, error)) in rows.into_iter().enumerate() {
        let of = score.file(file);
        let model = &score.files[file][best];
        let Some(case) = case_of(&of.case, row) else { continue };
        let Some(view) = views[number].take() else { continue };
        let measured = markers(model, row).map(|marker| marker.measured).collect();
        let options = FigureOptions {
            title: score.label(file, row),
            measured,
            loads: Acting::on(&case, &view.shape),
            obstacles: case.obstacles.clone(),
            ..FigureOptions::default()
        };
        let commands = commands(&of.robot, &of.case, row);
        let commands: Vec<String> = commands
            .iter()
            .map(|(name, value)| format!("{name} {}", crate::quantity::number(*value, 4)))
            .collect();
        figures.push(Figure {
            name: format!("worst-{}", number + 1).into(),
            caption: format!(
                "{}: {} is {} mm from the measured markers (diamonds). Commands: {}.",
                score.label(file, row),
                model.model,
                crate::quantity::fixed_millimetres(error, 3),
                commands.join(", ")
            ),
            svg: robot_figure(
                &of.robot,
                &[RobotView::at_rest(&of.robot, case.base), view],
                &options,
            )?,
        });
    }
    Ok(figures)
}

/// The case of a row, with the rows that lead to it.
fn case_of(case: &Case, row: usize) -> Option<Case> {
    match case.before.len() {
        0 => Some(case.clone()),
        _ if case.independent => case.independent_step(row),
        _ => case.step(row),
    }
}

/// The answers of a model to these rows, each of a file: drawn at many stations, or at the disks where the way to the rows has to
/// be gone again, once for all of them.
fn views(score: &Score<'_>, best: usize, rows: &[(usize, usize, f64)]) -> Vec<Option<RobotView>> {
    let mut views: Vec<Option<RobotView>> = vec![None; rows.len()];
    for (number, &(file, row, _)) in rows.iter().enumerate() {
        if views[number].is_some() {
            continue;
        }
        let of = score.file(file);
        let kind = score.files[file][best].model;
        let prepare = |stations| {
            Model::new(kind, stations, Actuation::Natural).prepare(&of.robot, &of.case.loads).ok()
        };
        if !of.robot.has_history() || of.case.independent || of.case.before.is_empty() {
            let Some(case) = case_of(&of.case, row) else { continue };
            let solve = |stations| prepare(stations)?.solve_to_the_end(&case).ok();
            let solution = solve(Stations::Equal(FINE_STATIONS)).or_else(|| solve(Stations::Disks));
            views[number] =
                solution.map(|solution| RobotView::model(label(kind, &solution), &solution));
            continue;
        }
        let wanted: Vec<(usize, usize)> = rows
            .iter()
            .enumerate()
            .filter(|(_, (of, ..))| *of == file)
            .map(|(number, (_, row, _))| (number, *row))
            .collect();
        let last = wanted.iter().map(|(_, row)| *row).max().unwrap_or(row);
        let (Some(mut prepared), Some(case)) = (prepare(Stations::Disks), of.case.step(last))
        else {
            continue;
        };
        let mut step = 0;
        // Up to a step without an answer, those before it are drawn.
        let _ = prepared.solve_steps(&case, |solution| {
            for (number, _) in wanted.iter().filter(|(_, row)| *row == step) {
                views[*number] = Some(RobotView::model(label(kind, &solution), &solution));
            }
            step += 1;
        });
    }
    views
}

fn markers(model: &FileScore, row: usize) -> impl Iterator<Item = &MarkerScore> {
    model.markers.iter().filter(move |marker| marker.row == row)
}
