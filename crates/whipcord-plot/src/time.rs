//! Quantities over time.

use crate::chart::{AxisSpec, Chart, Layer, Series};
use crate::colour::CABLES;
use crate::error::{PlotError, finite, not_empty};
use crate::unit;

/// What is drawn over time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OverTime {
    /// Coordinates in m.
    Position,
    /// Tensions in N.
    Tension,
    /// Energies in J.
    Energy,
    /// Forces of contacts in N.
    ContactForce,
}

/// One line of a chart over time.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeSeries {
    /// Entry in the legend.
    pub label: String,
    /// Time in s and value.
    pub rows: Vec<[f64; 2]>,
}

/// Quantities over time, as lines.
///
/// ```
/// use whipcord_plot::{OverTime, TimeSeries, time_chart};
///
/// let rows = (0..50).map(|k| [0.01 * k as f64, 0.02 * (0.3 * k as f64).cos()]).collect();
/// let svg = time_chart("Let go", OverTime::Position, &[TimeSeries { label: "x".into(), rows }])?;
/// assert!(svg.contains("time (ms)") && svg.contains("position of the tip (mm)"));
/// # Ok::<(), whipcord_plot::PlotError>(())
/// ```
///
/// # Errors
/// [`PlotError`] when there is nothing to draw or a number is not finite.
pub fn time_chart(title: &str, what: OverTime, series: &[TimeSeries]) -> Result<String, PlotError> {
    not_empty(|| "the list of lines".to_owned(), series)?;
    let (mut largest, mut end) = (0.0_f64, 0.0_f64);
    for one in series {
        not_empty(|| format!("the rows of `{}`", one.label), &one.rows)?;
        for [time, value] in &one.rows {
            finite(|| format!("a time of `{}`", one.label), *time)?;
            finite(|| format!("`{}` at {time} s", one.label), *value)?;
            (largest, end) = (largest.max(value.abs()), end.max(*time));
        }
    }
    let (name, factor) = match what {
        OverTime::Position => unit::length(largest),
        OverTime::Tension | OverTime::ContactForce => ("N", 1.0),
        OverTime::Energy if largest < 0.1 => ("mJ", 1e3),
        OverTime::Energy => ("J", 1.0),
    };
    let (unit_of_time, shown) = if end < 1.0 { ("ms", 1e3) } else { ("s", 1.0) };
    let label = match what {
        OverTime::Position => "position of the tip",
        OverTime::Tension => "tension",
        OverTime::Energy => "energy",
        OverTime::ContactForce => "contact force",
    };
    let series = series.iter().enumerate().map(|(i, one)| {
        let rows = one.rows.iter().map(|[time, value]| [shown * time, factor * value]).collect();
        // Colours begin anew behind the last one.
        let line = if i < CABLES.len() { Layer::Line(rows) } else { Layer::Dashed(rows) };
        Series::new(one.label.clone(), i, vec![line])
    });
    Chart {
        title: title.to_owned(),
        x: AxisSpec::linear(format!("time ({unit_of_time})")),
        y: AxisSpec::linear(format!("{label} ({name})")),
        series: series.collect(),
        height: 360.0,
        ..Chart::default()
    }
    .svg()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_suit_the_numbers() {
        let drawn = |what, end: f64, value: f64| {
            let rows = vec![[0.0, 0.0], [end, value]];
            time_chart("", what, &[TimeSeries { label: "a".to_owned(), rows }]).unwrap()
        };
        assert!(drawn(OverTime::Energy, 2.0, 0.01).contains("energy (mJ)"));
        assert!(drawn(OverTime::Energy, 2.0, 3.0).contains("energy (J)"));
        assert!(drawn(OverTime::Tension, 0.5, 3.0).contains("time (ms)"));
        assert!(drawn(OverTime::Tension, 2.0, 3.0).contains("time (s)"));
    }

    /// Of two lines of one colour the second is dashed.
    #[test]
    fn no_two_lines_look_the_same() {
        let one = |k: usize| TimeSeries {
            label: format!("{k}"),
            rows: vec![[0.0, 0.0], [1.0, 1.0 + k as f64]],
        };
        let drawn = |count: usize| {
            let series: Vec<TimeSeries> = (0..count).map(one).collect();
            time_chart("", OverTime::ContactForce, &series).unwrap()
        };
        assert!(drawn(1).contains("contact force (N)"));
        assert!(!drawn(CABLES.len()).contains("dashed"));
        assert!(drawn(CABLES.len() + 1).contains("dashed"));
    }

    #[test]
    fn nothing_and_nan_are_refused() {
        assert!(time_chart("", OverTime::Energy, &[]).is_err());
        let rows = vec![[0.0, f64::NAN]];
        let series = [TimeSeries { label: "a".to_owned(), rows }];
        assert!(time_chart("", OverTime::Energy, &series).is_err());
    }
}
