//! How lengths are distributed.

use crate::chart::{AxisSpec, Chart, Layer, Series};
use crate::error::{PlotError, finite, not_empty};
use crate::unit;

/// Classes of a histogram.
const CLASSES: usize = 40;

/// How often lengths in m occur, by series: stairs over equal classes from zero to the greatest, which all series share.
///
/// ```
/// use whipcord_plot::histogram_chart;
///
/// let shifts = (0..100).map(|k| 1e-5 * f64::from(k)).collect();
/// let svg = histogram_chart("Tolerances", "distance", &[("shift of the tip".to_owned(), shifts)])?;
/// assert!(svg.contains("distance (mm)"));
/// # Ok::<(), whipcord_plot::PlotError>(())
/// ```
///
/// # Errors
/// [`PlotError`] when there is nothing to draw or a length is negative or not finite.
pub fn histogram_chart(
    title: &str,
    quantity: &str,
    series: &[(String, Vec<f64>)],
) -> Result<String, PlotError> {
    not_empty(|| "the list of distributions".to_owned(), series)?;
    let mut largest = 0.0_f64;
    for (label, lengths) in series {
        not_empty(|| format!("the lengths of `{label}`"), lengths)?;
        for length in lengths {
            finite(|| format!("a length of `{label}`"), *length)?;
            largest = largest.max(length.abs());
        }
    }
    let (name, factor) = unit::length(largest);
    // All alike are in the first class.
    let width = if largest > 0.0 { largest / CLASSES as f64 } else { 1.0 };
    let stairs = |lengths: &[f64]| {
        let mut counts = [0_u32; CLASSES];
        for length in lengths {
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a class")]
            let class = (length.abs() / width) as usize;
            counts[class.min(CLASSES - 1)] += 1;
        }
        let share = 100.0 / lengths.len() as f64;
        let at = |edge: usize| factor * width * edge as f64;
        let steps = counts.iter().enumerate().flat_map(|(class, count)| {
            let height = share * f64::from(*count);
            [[at(class), height], [at(class + 1), height]]
        });
        [[0.0, 0.0]].into_iter().chain(steps).chain([[at(CLASSES), 0.0]]).collect::<Vec<_>>()
    };
    let series = series.iter().enumerate().map(|(number, (label, lengths))| {
        Series::new(label.clone(), number, vec![Layer::Line(stairs(lengths))])
    });
    Chart {
        title: title.to_owned(),
        x: AxisSpec::linear(format!("{quantity} ({name})")).from_zero(),
        y: AxisSpec::linear("share (%)").from_zero(),
        series: series.collect(),
        height: 360.0,
        ..Chart::default()
    }
    .svg()
}
