//! Solve time against number of sections.

use crate::axis::Scale;
use crate::chart::{AxisSpec, Chart, Layer, Series};
use crate::colour::Colour;
use crate::error::{PlotError, finite, not_empty, positive};
use crate::fit::Line;
use crate::marker::Marker;
use crate::unit;

/// Times of one model on one robot.
#[derive(Clone, Debug, PartialEq)]
pub struct TimingSeries {
    /// Entry in the legend, to which the slope of the fitted line is added.
    pub label: String,
    /// Number of sections or steps, and solve time in s; one for each run.
    pub runs: Vec<(usize, f64)>,
    /// Colour and sign; `None` for the next ones that stand for no model. With them, what belongs together
    /// can look alike: a colour for each model, say, and a sign for each robot.
    pub look: Option<(Colour, Marker)>,
}

/// Runs with the same number of sections.
struct Group {
    sections: f64,
    mean: f64,
    deviation: f64,
    least: f64,
}

/// Solve time against number of sections, in the form of the paper's Fig. 4: every run as a dot,
/// mean and standard deviation of the runs of a size (downwards to the least of them at most), and the least-squares line through the means;
/// with two logarithmic axes a power law, whose exponent is the slope.
///
/// ```
/// use whipcord_plot::{Scale, TimingSeries, timing_chart};
///
/// let runs = [5, 10, 20, 40].map(|n| (n, 3e-7 * n as f64)).to_vec();
/// let series = TimingSeries { label: "four-bar".into(), runs, look: None };
/// let svg = timing_chart("Time to solve", &[series], Scale::Linear)?;
/// assert!(svg.contains("four-bar: 0.30 µs per section"));
/// # Ok::<(), whipcord_plot::PlotError>(())
/// ```
///
/// # Errors
/// [`PlotError`] when there is nothing to draw, a time is not finite, or, with [`Scale::Log`], a
/// number is not positive.
pub fn timing_chart(
    title: &str,
    series: &[TimingSeries],
    scale: Scale,
) -> Result<String, PlotError> {
    not_empty(|| "the list of timings".to_owned(), series)?;
    let mut largest = 0.0_f64;
    for one in series {
        not_empty(|| format!("the runs of `{}`", one.label), &one.runs)?;
        for (n, time) in &one.runs {
            finite(|| format!("the time of `{}` with {n} sections", one.label), *time)?;
            if scale == Scale::Log {
                positive(|| format!("the time of `{}` with {n} sections", one.label), *time)?;
                positive(|| format!("the number of sections of `{}`", one.label), *n as f64)?;
            }
            largest = largest.max(*time);
        }
    }
    // On a logarithmic axis the middle of the range is what should read well.
    let typical = if scale == Scale::Log { 0.05 * largest } else { largest };
    let unit = unit::time(typical);
    let label = format!("solve time ({})", unit.0);
    let sections = "number of sections";
    let (x, y) = match scale {
        Scale::Linear => {
            (AxisSpec::linear(sections).from_zero(), AxisSpec::linear(label).from_zero())
        }
        Scale::Log => (AxisSpec::log(sections), AxisSpec::log(label)),
    };
    let series = series.iter().enumerate().map(|(i, one)| one_series(one, i, scale, unit));
    Chart { title: title.to_owned(), x, y, series: series.collect(), ..Chart::default() }.svg()
}

fn one_series(one: &TimingSeries, index: usize, scale: Scale, unit: unit::Unit) -> Series {
    let runs: Vec<[f64; 2]> = one.runs.iter().map(|&(n, t)| [n as f64, unit.1 * t]).collect();
    let groups = grouped(&runs);
    let means: Vec<[f64; 2]> = groups.iter().map(|g| [g.sections, g.mean]).collect();
    let mut label = one.label.clone();
    let mut layers = vec![Layer::Dots(runs)];
    if let Some((slope, line)) = fitted(&means, scale) {
        label += &match scale {
            Scale::Linear => format!(": {} {} per section", significant(slope), unit.0),
            Scale::Log => format!(": slope {slope:.2}").replace('-', "−"),
        };
        layers.push(Layer::Line(line));
    }
    let errors = groups.iter().filter(|g| g.deviation > 0.0);
    // With few outlying runs the deviation may exceed the mean, but no time is negative.
    let bar = |g: &Group| [g.sections, (g.mean - g.deviation).max(g.least), g.mean + g.deviation];
    layers.push(Layer::Errors(errors.map(bar).collect()));
    layers.push(Layer::Markers(means));
    let mut series = Series::new(label, index, layers);
    if let Some((colour, marker)) = one.look {
        (series.colour, series.marker) = (colour, marker);
    }
    series
}

fn grouped(runs: &[[f64; 2]]) -> Vec<Group> {
    let mut runs = runs.to_vec();
    runs.sort_by(|a, b| a[0].total_cmp(&b[0]));
    runs.chunk_by(|a, b| a[0] == b[0])
        .map(|group| {
            let n = group.len() as f64;
            let mean = group.iter().map(|r| r[1]).sum::<f64>() / n;
            let squares = group.iter().map(|r| (r[1] - mean).powi(2)).sum::<f64>();
            let deviation = if n > 1.0 { (squares / (n - 1.0)).sqrt() } else { 0.0 };
            let least = group.iter().map(|r| r[1]).fold(f64::INFINITY, f64::min);
            Group { sections: group[0][0], mean, deviation, least }
        })
        .collect()
}

/// Slope and ends of the line through the means, as far as it is positive.
fn fitted(means: &[[f64; 2]], scale: Scale) -> Option<(f64, Vec<[f64; 2]>)> {
    let (first, last) = (means.first()?[0], means.last()?[0]);
    match scale {
        Scale::Linear => {
            let line = Line::through(means)?;
            // Below zero there is no time.
            let start = if line.at(first) < 0.0 { -line.intercept / line.slope } else { first };
            let end = if line.at(last) < 0.0 { -line.intercept / line.slope } else { last };
            Some((line.slope, [start, end].map(|x| [x, line.at(x).max(0.0)]).to_vec()))
        }
        Scale::Log => {
            let logs: Vec<_> = means.iter().map(|p| p.map(f64::ln)).collect();
            let line = Line::through(&logs)?;
            Some((line.slope, [first, last].map(|x| [x, line.at(x.ln()).exp()]).to_vec()))
        }
    }
}

/// A number with two significant digits, or all of its whole ones.
fn significant(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let decimals = (1 - value.abs().log10().floor() as i32).clamp(0, 9);
    format!("{value:.*}", usize::try_from(decimals).unwrap_or(0)).replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_a_size_are_gathered() {
        let groups = grouped(&[[5.0, 1.0], [10.0, 4.0], [5.0, 3.0]]);
        assert_eq!(groups.len(), 2);
        assert_eq!((groups[0].sections, groups[0].mean), (5.0, 2.0));
        assert!((groups[0].deviation - f64::sqrt(2.0)).abs() < 1e-15);
        assert_eq!(groups[1].deviation, 0.0);
    }

    #[test]
    fn slopes_are_rounded_for_reading() {
        for (value, text) in
            [(0.3, "0.30"), (0.0123, "0.012"), (123.4, "123"), (-1.96, "−2.0"), (0.0, "0")]
        {
            assert_eq!(significant(value), text);
        }
    }

    #[test]
    fn a_power_law_has_its_exponent_as_slope() {
        let means: Vec<_> = [5.0, 10.0, 20.0].map(|n: f64| [n, 2.0 * n.powf(1.5)]).to_vec();
        let (slope, line) = fitted(&means, Scale::Log).unwrap();
        assert!((slope - 1.5).abs() < 1e-12);
        assert!((line[1][1] / means[2][1] - 1.0).abs() < 1e-12);
    }
}
