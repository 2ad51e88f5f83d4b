//! The fitted robot with what was measured, and what is left of the markers, drawn.

use whipcord::{Solution, Stations};
use whipcord_estimation::Seen;
use whipcord_estimation::identification::{best_measurements, worth_by_disk};
use whipcord_plot::{
    Acting, AxisSpec, Chart, FINE_STATIONS, FigureOptions, Layer, PlotError, RobotView, Series,
    label, robot_figure,
};

use super::tables::{arc_length, name};
use super::{Fit, row_name};
use crate::html::Figure;
use crate::quantity::number;

/// Most files whose robot is drawn, and most steps of each.
const MOST_FILES: usize = 8;
const MOST_STEPS: usize = 5;

/// The fitted robot of each file, with the markers that were measured in space over it.
///
/// # Errors
/// [`PlotError`] for a picture that cannot be drawn.
pub fn robots(fit: &Fit) -> Result<Vec<Figure>, PlotError> {
    let in_space = |e: usize| {
        fit.experiments[e].observations.iter().any(|of| matches!(of.seen, Seen::Position(_)))
    };
    let files: Vec<usize> = (0..fit.cases.len()).filter(|&e| in_space(e)).collect();
    let mut figures = Vec::new();
    for &e in files.iter().take(MOST_FILES) {
        let Some((steps, svg)) = robot(fit, e)? else { continue };
        let mut caption = String::from("The fitted robot");
        if fit.cases.len() > 1 {
            caption += &format!(" of {}", fit.names[e]);
        }
        if let [first, .., last] = steps.as_slice() {
            let of = fit.found.cases[e].before.len() + 1;
            caption += &format!(
                " in {} of its {of} steps, from step {} (pale) to step {}",
                steps.len(),
                first + 1,
                last + 1
            );
        }
        caption += ", and the markers that were measured (diamonds).";
        if files.len() > MOST_FILES && figures.len() + 1 == MOST_FILES {
            caption += &format!(" {} more files are not drawn.", files.len() - MOST_FILES);
        }
        figures.push(Figure { name: format!("fitted-{}", fit.names[e]).into(), caption, svg });
    }
    Ok(figures)
}

/// The steps that are drawn of a file, and their picture; `None` where the fitted robot has no answer.
fn robot(fit: &Fit, e: usize) -> Result<Option<(Vec<usize>, String)>, PlotError> {
    let (robot, case) = (&fit.found.robot, &fit.found.cases[e]);
    let smooth = fit.model.at(Stations::Equal(FINE_STATIONS));
    let solve = |model: &whipcord::Model| -> Option<Vec<Solution>> {
        model.prepare(robot, &case.loads).ok()?.solve_all(case).ok()
    };
    // Where there is no answer with more stations, the shape at the disks.
    let Some(answers) = solve(&smooth).or_else(|| solve(&fit.model)) else { return Ok(None) };
    let steps = spread(answers.len(), MOST_STEPS);
    let views: Vec<RobotView> = steps
        .iter()
        .map(|&step| {
            let model = fit.found.model.to_string();
            let name =
                if answers.len() > 1 { format!("{model}, step {}", step + 1) } else { model };
            RobotView::model(label(name, &answers[step]), &answers[step])
        })
        .collect();
    let Some(last) = answers.last() else { return Ok(None) };
    let doubted = |index: usize| {
        let own = fit.found.residuals.iter().filter(|residual| residual.experiment == e);
        own.into_iter().any(|residual| residual.observation == index && is_outlier(residual.weight))
    };
    let (mut measured, mut outliers) = (Vec::new(), Vec::new());
    let to_world = fit.found.frames[e].inverse();
    for (index, of) in fit.experiments[e].observations.iter().enumerate() {
        match of.seen {
            Seen::Position(at) if steps.contains(&of.step) && doubted(index) => {
                outliers.push(to_world.transform(at));
            }
            Seen::Position(at) if steps.contains(&of.step) => {
                measured.push(to_world.transform(at));
            }
            _ => {}
        }
    }
    let options = FigureOptions {
        title: fit.cases[e].title.clone(),
        measured,
        outliers,
        loads: Acting::on(case, &last.shape),
        obstacles: case.obstacles.clone(),
        ..FigureOptions::default()
    };
    robot_figure(robot, &views, &options).map(|svg| Some((steps, svg)))
}

/// At most this many of the numbers below `count`, evenly apart, the first and the last among them.
fn spread(count: usize, most: usize) -> Vec<usize> {
    if count <= most {
        return (0..count).collect();
    }
    (0..most).map(|i| i * (count - 1) / (most - 1)).collect()
}

/// Whether a marker is so far off that it counts less than half.
pub fn is_outlier(weight: f64) -> bool {
    weight < 0.5
}

/// Distances along the backbone, and the coordinates of what is left one after the other: where the model
/// is right they show no pattern.
///
/// # Errors
/// [`PlotError`] for a picture that cannot be drawn.
pub fn figures(fit: &Fit) -> Result<Vec<Figure>, PlotError> {
    let mut figures = Vec::new();
    for (pixels, unit, scale, names) in [
        (false, "mm", 1e3, ["distances", "coordinates"]),
        (true, "pixels", 1.0, ["pixel-distances", "pixel-coordinates"]),
    ] {
        let residuals: Vec<_> = fit
            .found
            .residuals
            .iter()
            .map(|residual| {
                let of = &fit.experiments[residual.experiment].observations;
                (residual, &of[residual.observation])
            })
            .filter(|(_, seen)| !seen.seen.is_rotation() && seen.seen.is_in_image() == pixels)
            .collect();
        if residuals.is_empty() {
            continue;
        }
        let doubted = residuals.iter().any(|(residual, _)| is_outlier(residual.weight));
        let hollow = if doubted { " Hollow: outliers, which count less than half." } else { "" };
        let along = (0..fit.cases.len()).map(|e| {
            let own = residuals.iter().filter(|(residual, _)| residual.experiment == e);
            let points = own.map(|(residual, seen)| {
                let at = [arc_length(fit, e, seen) * 1e3, residual.distance() * scale];
                (at, is_outlier(residual.weight))
            });
            Series::new(fit.names[e].clone(), e, signs(points))
        });
        figures.push(Figure {
            name: names[0].into(),
            caption: format!(
                "Distance of each marker from where the fitted model has it, along the backbone.{hollow}"
            ),
            svg: Chart {
                title: String::from("What is left of each marker"),
                x: AxisSpec::linear("arc length (mm)"),
                y: AxisSpec::linear(format!("distance ({unit})")).from_zero(),
                series: along.collect(),
                ..Chart::default()
            }
            .svg()?,
        });
        let axes: &[&str] = if pixels { &["column", "row"] } else { &["x", "y", "z"] };
        let coordinates = axes.iter().enumerate().map(|(axis, name)| {
            let points = residuals.iter().enumerate();
            let points = points.map(|(i, (residual, _))| {
                let at = [(i + 1) as f64, residual.difference[axis] * scale];
                (at, is_outlier(residual.weight))
            });
            Series::new(*name, axis, signs(points))
        });
        figures.push(Figure {
            name: names[1].into(),
            caption: format!("Fitted model less measurement, coordinate by coordinate, in the order of the files, steps and places: noise has no pattern.{hollow}"),
            svg: Chart {
                title: String::from("What is left of each coordinate"),
                x: AxisSpec::linear("marker"),
                y: AxisSpec::linear(format!("model less measurement ({unit})")).from_zero(),
                series: coordinates.collect(),
                ..Chart::default()
            }
            .svg()?,
        });
    }
    figures.extend(worth(fit)?);
    figures.extend(profiles(fit)?);
    Ok(figures)
}

/// What one more measurement of each disk would be worth on average.
fn worth(fit: &Fit) -> Result<Option<Figure>, PlotError> {
    let by_disk = worth_by_disk(&fit.analyses.worths);
    if by_disk.is_empty() {
        return Ok(None);
    }
    let estimates = fit.found.estimates.iter().enumerate();
    let determined = estimates.filter(|(_, estimate)| estimate.deviation.is_some());
    let series = determined.take(MOST_SERIES).enumerate().map(|(k, (j, estimate))| {
        let points: Vec<[f64; 2]> =
            by_disk.iter().map(|of| [of.arc_length * 1e3, 100.0 * of.variances[j]]).collect();
        let layers = vec![Layer::Line(points.clone()), Layer::Markers(points)];
        Series::new(name(fit, &estimate.unknown), k, layers)
    });
    let best: Vec<String> = best_measurements(&fit.analyses.worths)
        .iter()
        .map(|of| format!("disk {} in {}", of.disk + 1, row_name(&fit.names, &fit.cases, of.row)))
        .collect();
    Ok(Some(Figure {
        name: "sensitivity".into(),
        caption: format!(
            "By how much the variance of each estimate would fall if one disk were measured once more, as exactly as the others, on \
             average over the rows. All estimates together would gain most from {}.",
            best.join(", ")
        ),
        svg: Chart {
            title: String::from("Which measurement would help most"),
            x: AxisSpec::linear("arc length of the disk (mm)"),
            y: AxisSpec::linear("variance less by (%)").from_zero(),
            series: series.collect(),
            ..Chart::default()
        }
        .svg()?,
    }))
}

/// Most lines of one chart: as many as there are signs to tell them apart.
const MOST_SERIES: usize = 6;

/// The profile likelihoods, each over the interval of its standard deviation.
fn profiles(fit: &Fit) -> Result<Option<Figure>, PlotError> {
    let all = &fit.analyses.profiles;
    let Some(limit) = all.first().map(|profile| profile.limit) else { return Ok(None) };
    let series = all.iter().take(MOST_SERIES).enumerate().map(|(k, profile)| {
        let estimate = &fit.found.estimates[profile.unknown];
        let inside = profile.points.iter().filter(|[_, rise]| *rise <= 2.0 * limit);
        let inside: Vec<[f64; 2]> = inside.copied().collect();
        let size = match (inside.first(), inside.last()) {
            (Some(first), Some(last)) if last[0] > first[0] => 0.5 * (last[0] - first[0]),
            _ => 1.0,
        };
        let points: Vec<[f64; 2]> = inside
            .iter()
            .map(|[value, rise]| [(value - estimate.value) / size, rise.sqrt()])
            .collect();
        let layers = vec![Layer::Line(points.clone()), Layer::Markers(points)];
        Series::new(name(fit, &estimate.unknown), k, layers)
    });
    Ok(Some(Figure {
        name: "profiles".into(),
        caption: format!(
            "Profile likelihoods: the root of the rise of the sum of squares, in units of the noise, when one parameter is held at \
             another value and all others are fitted anew, against its distance from the estimate as a part of what is drawn. Below \
             {} are the values that agree with the measurements; a parabola gives straight lines.",
            number(limit.sqrt(), 3)
        ),
        svg: Chart {
            title: String::from("Profile likelihood"),
            x: AxisSpec::linear("distance from the estimate (relative)"),
            y: AxisSpec::linear("root of the rise of the sum of squares").from_zero(),
            series: series.collect(),
            ..Chart::default()
        }
        .svg()?,
    }))
}

/// A sign for each point, hollow for an outlier.
fn signs(points: impl Iterator<Item = ([f64; 2], bool)>) -> Vec<Layer> {
    let (outliers, others): (Vec<_>, Vec<_>) = points.partition(|(_, outlier)| *outlier);
    let places = |of: Vec<([f64; 2], bool)>| of.into_iter().map(|(at, _)| at).collect();
    // The legend shows the sign of the layer that is drawn last.
    let mut layers = Vec::new();
    if !outliers.is_empty() {
        layers.push(Layer::Rings(places(outliers)));
    }
    layers.push(Layer::Markers(places(others)));
    layers
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_spread_from_the_first_to_the_last() {
        assert_eq!(spread(3, 5), [0, 1, 2]);
        assert_eq!(spread(9, 5), [0, 2, 4, 6, 8]);
        assert_eq!(spread(100, 5), [0, 24, 49, 74, 99]);
    }
}
