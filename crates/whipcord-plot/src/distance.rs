//! Distance at each disk.

use crate::chart::{AxisSpec, Chart, Layer, Series};
use crate::error::{PlotError, finite, not_empty};
use crate::unit;

/// Distances at the disks: of a model to another one, or to a measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct DistanceSeries {
    /// Entry in the legend.
    pub label: String,
    /// Number of the disk, from 1, and distance in m.
    pub disks: Vec<(usize, f64)>,
}

/// More columns than this beside each other cannot be read.
const MOST_COLUMNS: usize = 80;

/// Distance at each disk, in the form of the paper's Fig. 3 g and h: columns side by side, or lines
/// where there are too many of them.
///
/// ```
/// use whipcord_plot::{DistanceSeries, distance_chart};
///
/// let series = DistanceSeries {
///     label: "four-bar to cosserat".into(),
///     disks: (1..=10).map(|disk| (disk, 2e-5 * (disk * disk) as f64)).collect(),
/// };
/// let svg = distance_chart("Case III", &[series])?;
/// assert!(svg.contains("distance (mm)"));
/// # Ok::<(), whipcord_plot::PlotError>(())
/// ```
///
/// # Errors
/// [`PlotError`] when there is nothing to draw or a distance is not finite.
pub fn distance_chart(title: &str, series: &[DistanceSeries]) -> Result<String, PlotError> {
    not_empty(|| "the list of distances".to_owned(), series)?;
    let mut largest = 0.0_f64;
    for one in series {
        not_empty(|| format!("the distances of `{}`", one.label), &one.disks)?;
        for (disk, distance) in &one.disks {
            finite(|| format!("the distance of `{}` at disk {disk}", one.label), *distance)?;
            largest = largest.max(distance.abs());
        }
    }
    let (name, factor) = unit::length(largest);
    let columns = series.iter().map(|s| s.disks.len()).sum::<usize>() <= MOST_COLUMNS;
    let series = series.iter().enumerate().map(|(i, one)| {
        let points: Vec<_> = one.disks.iter().map(|&(k, d)| [k as f64, factor * d]).collect();
        let layers = if columns {
            vec![Layer::Columns(points)]
        } else {
            vec![Layer::Line(points.clone()), Layer::Markers(points)]
        };
        Series::new(one.label.clone(), i, layers)
    });
    Chart {
        title: title.to_owned(),
        x: AxisSpec::counting("disk number"),
        y: AxisSpec::linear(format!("distance ({name})")).from_zero(),
        series: series.collect(),
        height: 360.0,
        ..Chart::default()
    }
    .svg()
}
