//! Error against time: which model is worth its time.

use crate::chart::{AxisSpec, Chart, Layer, Series};
use crate::colour::Colour;
use crate::error::{PlotError, finite, not_empty, positive};
use crate::marker::Marker;
use crate::unit;

/// A model on some cases.
#[derive(Clone, Debug, PartialEq)]
pub struct ParetoSeries {
    /// The model's name, which stands beside its sign.
    pub label: String,
    /// For each case the time of a solve in s, and the error relative to the length of the backbone.
    pub cases: Vec<[f64; 2]>,
    /// Colour and sign.
    pub look: (Colour, Marker),
    /// Whether the sign is hollow, as for a variant of another series of the same look.
    pub hollow: bool,
}

/// Errors below this are rounding, and are drawn here.
const ROUNDING: f64 = 1e-16;
/// Strength of colours of what another model betters in both time and error.
const PALE: f64 = 0.45;

/// Relative error against time to solve on logarithmic axes: every case as a dot, and the medians of a model's
/// times and errors as its sign, with its name. A model is pale when another one of no fewer cases is both faster and
/// nearer by its medians, or one of these and as good in the other; of the others those that are nearer than all faster ones
/// are joined by a dashed line. Errors below 1e-16 are drawn there.
///
/// ```
/// use whipcord_plot::{Colour, Marker, ParetoSeries, pareto_chart};
///
/// let series = |label: &str, index, cases| ParetoSeries {
///     label: label.into(),
///     cases,
///     look: (Colour::nth(index), Marker::nth(index)),
///     hollow: false,
/// };
/// let models = [
///     series("cosserat", 0, vec![[9e-6, 2e-3], [11e-6, 8e-3]]),
///     series("four-bar", 1, vec![[2e-6, 8e-3], [4e-6, 16e-3]]),
/// ];
/// let svg = pareto_chart("Case I and II", &models)?;
/// assert!(svg.contains("cosserat") && svg.contains("solve time (µs)"));
/// # Ok::<(), whipcord_plot::PlotError>(())
/// ```
///
/// # Errors
/// [`PlotError`] when there is nothing to draw, a time is not positive or an error not finite.
pub fn pareto_chart(title: &str, series: &[ParetoSeries]) -> Result<String, PlotError> {
    not_empty(|| "the list of models".to_owned(), series)?;
    let (mut least, mut largest) = (f64::INFINITY, 0.0_f64);
    for one in series {
        not_empty(|| format!("the cases of `{}`", one.label), &one.cases)?;
        for [time, error] in &one.cases {
            finite(|| format!("a time of `{}`", one.label), *time)?;
            positive(|| format!("a time of `{}`", one.label), *time)?;
            finite(|| format!("an error of `{}`", one.label), *error)?;
            (least, largest) = (least.min(*time), largest.max(*time));
        }
    }
    // On a logarithmic axis the middle of the range is what should read well.
    let (name, factor) = unit::time((least * largest).sqrt());
    let drawn = |[time, error]: &[f64; 2]| [factor * time, error.abs().max(ROUNDING)];
    let cases: Vec<Vec<[f64; 2]>> =
        series.iter().map(|one| one.cases.iter().map(drawn).collect()).collect();
    let medians: Vec<[f64; 2]> = cases.iter().map(|cases| median(cases)).collect();
    let placed: Vec<(usize, [f64; 2])> =
        cases.iter().zip(&medians).map(|(cases, median)| (cases.len(), *median)).collect();
    let pale: Vec<bool> = placed.iter().map(|one| is_bettered(*one, &placed)).collect();

    let mut front: Vec<[f64; 2]> =
        medians.iter().zip(&pale).filter(|(_, pale)| !**pale).map(|(median, _)| *median).collect();
    front.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut nearest = f64::INFINITY;
    front.retain(|[_, error]| {
        let nearer = *error < nearest;
        nearest = nearest.min(*error);
        nearer
    });
    let mut all = Vec::with_capacity(series.len() + 1);
    if front.len() > 1 {
        let line = Series::new("", 0, vec![Layer::Dashed(front)]);
        all.push(Series { colour: Colour::GREY, ..line });
    }
    for (((one, cases), median), pale) in series.iter().zip(cases).zip(medians).zip(pale) {
        let mut layers = Vec::new();
        if cases.len() > 1 {
            layers.push(Layer::Dots(cases));
        }
        let sign = vec![median];
        layers.push(if one.hollow { Layer::Rings(sign) } else { Layer::Markers(sign) });
        layers.push(Layer::Names(vec![(median, one.label.clone())]));
        let (colour, marker) = one.look;
        let colour = if pale { colour.tint(PALE) } else { colour };
        all.push(Series { label: String::new(), colour, marker, layers });
    }
    Chart {
        title: title.to_owned(),
        x: AxisSpec::log(format!("solve time ({name})")),
        y: AxisSpec::log("error / length of the backbone"),
        series: all,
        height: 460.0,
        ..Chart::default()
    }
    .svg()
}

/// Of both coordinates.
fn median(points: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|i| {
        let mut values: Vec<f64> = points.iter().map(|point| point[i]).collect();
        values.sort_by(f64::total_cmp);
        let n = values.len();
        // The middle of two on a logarithmic axis.
        if n % 2 == 1 { values[n / 2] } else { (values[n / 2 - 1] * values[n / 2]).sqrt() }
    })
}

/// Whether another of no fewer cases is no worse in both coordinates and better in one.
fn is_bettered((cases, one): (usize, [f64; 2]), all: &[(usize, [f64; 2])]) -> bool {
    all.iter().any(|&(others, other)| {
        others >= cases && other[0] <= one[0] && other[1] <= one[1] && other != one
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_slower_and_farther_is_bettered() {
        let all = [[1.0, 1e-2], [2.0, 1e-3], [3.0, 1e-2], [2.0, 1e-2], [1.0, 1e-2]];
        let all = all.map(|one| (4, one));
        let bettered = all.map(|one| is_bettered(one, &all));
        // Two that are equal better each other not.
        assert_eq!(bettered, [false, false, true, true, false]);
        // What answers few cases says nothing of those who answer more.
        assert!(!is_bettered((4, [2.0, 1e-2]), &[(3, [1.0, 1e-3])]));
    }

    #[test]
    fn medians_are_of_each_coordinate() {
        assert_eq!(median(&[[1.0, 5.0], [3.0, 1.0], [2.0, 9.0]]), [2.0, 5.0]);
        let [x, y] = median(&[[1.0, 4.0], [4.0, 1.0]]);
        assert!((x - 2.0).abs() < 1e-15 && (y - 2.0).abs() < 1e-15);
    }
}
