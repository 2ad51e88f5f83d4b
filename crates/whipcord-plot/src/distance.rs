//! Distance at each disk.

use crate::chart::{AxisSpec, Chart, Layer, Series};
use crate::colour::Colour;
use crate::error::{PlotError, finite, not_empty};
use crate::marker::Marker;
use crate::unit;

/// Distances at the disks: of a model to another one, or to a measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct DistanceSeries {
    /// Entry in the legend.
    pub label: String,
    /// Number of the disk, from 1, and distance in m.
    pub disks: Vec<(usize, f64)>,
    /// Colour and sign; `None` for the next ones that stand for no model. With them, a model looks here as it
    /// does in other figures.
    pub look: Option<(Colour, Marker)>,
    /// Whether columns and signs are hollow, as for a variant of another series of the same look.
    pub hollow: bool,
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
///     look: None,
///     hollow: false,
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
        let layers = match (columns, one.hollow) {
            (true, false) => vec![Layer::Columns(points)],
            (true, true) => vec![Layer::HollowColumns(points)],
            (false, false) => vec![Layer::Line(points.clone()), Layer::Markers(points)],
            (false, true) => vec![Layer::Dashed(points.clone()), Layer::Rings(points)],
        };
        let mut series = Series::new(one.label.clone(), i, layers);
        if let Some((colour, marker)) = one.look {
            (series.colour, series.marker) = (colour, marker);
        }
        series
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
