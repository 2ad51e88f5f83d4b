//! What is left of the markers, drawn.

use whipcord_plot::{AxisSpec, Chart, Layer, PlotError, Series};

use super::Fit;
use super::tables::arc_length;
use crate::html::Figure;

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
            .filter(|(_, seen)| seen.seen.is_in_image() == pixels)
            .collect();
        if residuals.is_empty() {
            continue;
        }
        let along = (0..fit.cases.len()).map(|e| {
            let own = residuals.iter().filter(|(residual, _)| residual.experiment == e);
            let points = own.map(|(residual, seen)| {
                [arc_length(fit, e, seen) * 1e3, residual.distance() * scale]
            });
            Series::new(fit.names[e].clone(), e, vec![Layer::Markers(points.collect())])
        });
        figures.push(Figure {
            name: names[0],
            caption: String::from(
                "Distance of each marker from where the fitted model has it, along the backbone.",
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
            let points = points
                .map(|(i, (residual, _))| [(i + 1) as f64, residual.difference[axis] * scale]);
            Series::new(*name, axis, vec![Layer::Markers(points.collect())])
        });
        figures.push(Figure {
            name: names[1],
            caption: String::from("Fitted model less measurement, coordinate by coordinate, in the order of the files, steps and places: noise has no pattern."),
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
    Ok(figures)
}
