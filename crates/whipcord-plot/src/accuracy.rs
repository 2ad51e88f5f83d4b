//! Error against number of steps.

use crate::chart::{AxisSpec, Chart, Layer, Series};
use crate::colour::Colour;
use crate::error::{PlotError, finite, not_empty};
use crate::marker::Marker;

/// Errors of one model on one robot.
#[derive(Clone, Debug, PartialEq)]
pub struct AccuracySeries {
    /// Entry in the legend.
    pub label: String,
    /// Number of steps or sections, and the largest error of a position relative to the length of
    /// the backbone.
    pub errors: Vec<(usize, f64)>,
    /// Colour and sign; `None` for the next ones that stand for no model.
    pub look: Option<(Colour, Marker)>,
}

/// Errors below this are rounding, and are drawn here.
const ROUNDING: f64 = 1e-16;
/// How far above the largest error a guide starts.
const LIFT: f64 = 2.5;

/// Relative error against number of steps on logarithmic axes, with a dashed guide for each order
/// of convergence in `orders`. Errors below 1e-16 are drawn there: below it there is only rounding.
///
/// ```
/// use whipcord_plot::{AccuracySeries, accuracy_chart};
///
/// let errors = [4, 8, 16].map(|n: usize| (n, 0.01 / (n as f64).powi(4))).to_vec();
/// let series = AccuracySeries { label: "cosserat".into(), errors, look: None };
/// let svg = accuracy_chart("Convergence", &[series], &[4])?;
/// assert!(svg.contains("slope −4"));
/// # Ok::<(), whipcord_plot::PlotError>(())
/// ```
///
/// # Errors
/// [`PlotError`] when there is nothing to draw, an error is not finite or a number of steps is zero.
pub fn accuracy_chart(
    title: &str,
    series: &[AccuracySeries],
    orders: &[u32],
) -> Result<String, PlotError> {
    not_empty(|| "the list of errors".to_owned(), series)?;
    let mut lines = Vec::with_capacity(series.len());
    for one in series {
        not_empty(|| format!("the errors of `{}`", one.label), &one.errors)?;
        let mut points = Vec::with_capacity(one.errors.len());
        for &(n, error) in &one.errors {
            finite(|| format!("the error of `{}` with {n} steps", one.label), error)?;
            points.push([n as f64, error.abs().max(ROUNDING)]);
        }
        lines.push(points);
    }
    let guides = guides(&lines, orders);
    let mut drawn = Vec::with_capacity(series.len() + guides.len());
    for (i, (one, points)) in series.iter().zip(lines).enumerate() {
        let layers = vec![Layer::Line(points.clone()), Layer::Markers(points)];
        let mut series = Series::new(one.label.clone(), i, layers);
        if let Some((colour, marker)) = one.look {
            (series.colour, series.marker) = (colour, marker);
        }
        drawn.push(series);
    }
    drawn.extend(guides);
    Chart {
        title: title.to_owned(),
        x: AxisSpec::log("number of steps"),
        y: AxisSpec::log("error / length of the backbone"),
        series: drawn,
        ..Chart::default()
    }
    .svg()
}

/// A line of each slope, above the data, which ends where the data do.
fn guides(lines: &[Vec<[f64; 2]>], orders: &[u32]) -> Vec<Series> {
    let all = || lines.iter().flatten();
    let left = all().map(|p| p[0]).fold(f64::INFINITY, f64::min);
    let right = all().map(|p| p[0]).fold(0.0, f64::max);
    let lowest = all().map(|p| p[1]).fold(f64::INFINITY, f64::min);
    let start = all().filter(|p| p[0] == left).map(|p| p[1]).fold(0.0, f64::max) * LIFT;
    orders
        .iter()
        .filter(|&&order| order > 0)
        .map(|&order| {
            let order_f = f64::from(order);
            // Where the guide would fall below all data.
            let end = right.min(left * (start / lowest).powf(1.0 / order_f));
            let at = |x: f64| [x, start * (x / left).powf(-order_f)];
            let mut guide = Series::new(
                format!("slope −{order}"),
                0,
                vec![Layer::Dashed(vec![at(left), at(end)])],
            );
            guide.colour = Colour::GREY;
            guide
        })
        .collect()
}
