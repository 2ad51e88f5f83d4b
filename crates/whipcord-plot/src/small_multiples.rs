//! Many cases at a glance: a small picture of each, all of one scale.

use whipcord::Vec3;

use crate::colour::Colour;
use crate::distance::DistanceSeries;
use crate::error::{PlotError, finite, not_empty};
use crate::marker;
use crate::robot_figure::{RobotView, ViewStyle};
use crate::svg::{Anchor, Fill, Point, Stroke, Svg, Text};
use crate::ticks;
use crate::unit;

/// A case as a small picture shows it.
#[derive(Clone, Copy, Debug)]
pub struct SmallMultiple<'a> {
    /// What it is of.
    pub title: &'a str,
    /// The shapes, of which the backbones are drawn.
    pub views: &'a [RobotView],
    /// Distances at the disks; none where there is nothing to compare with.
    pub distances: &'a [DistanceSeries],
}

/// Of a picture, and of each of its two halves, in px.
const SIZE: Point = [320.0, 190.0];
const HALF: Point = [150.0, 150.0];
const TOP: f64 = 12.0;
const SMALL: f64 = 11.0;
/// Between the rim of a half and what is in it.
const INSET: f64 = 8.0;

/// A small picture of each case, as SVG: on the left the backbones of all models from the side on which they bend most, on the right
/// their distances at the disks. Lengths have one scale in all pictures, and so have distances.
///
/// # Errors
/// [`PlotError`] for a case without a shape, and for numbers that are not finite.
pub fn small_multiples(cases: &[SmallMultiple<'_>]) -> Result<Vec<String>, PlotError> {
    let sides: Vec<Side> = cases.iter().map(Side::of).collect::<Result<_, _>>()?;
    let largest = sides.iter().map(Side::extent).fold(0.0, f64::max);
    let farthest = cases
        .iter()
        .flat_map(|case| case.distances)
        .flat_map(|series| &series.disks)
        .map(|&(_, distance)| distance)
        .fold(0.0, f64::max);
    finite(|| "a distance at a disk".to_owned(), farthest)?;
    let scale = (HALF[0] - 2.0 * INSET) / largest.max(f64::MIN_POSITIVE);
    cases.iter().zip(&sides).map(|(case, side)| picture(case, side, scale, farthest)).collect()
}

/// The backbones of a case, seen from the side on which they bend most: to the right and up, in m.
struct Side {
    lines: Vec<Vec<Point>>,
    low: Point,
    high: Point,
}

impl Side {
    fn of(case: &SmallMultiple<'_>) -> Result<Self, PlotError> {
        not_empty(|| format!("the list of shapes of `{}`", case.title), case.views)?;
        let base = case.views[0].shape.poses.first().map_or(Vec3::ZERO, |pose| pose.position);
        let points = case.views.iter().flat_map(|view| view.shape.positions());
        let farthest = points
            .map(|p| p - base)
            .fold(Vec3::ZERO, |far, p| if p.x.hypot(p.y) > far.x.hypot(far.y) { p } else { far });
        let reach = farthest.x.hypot(farthest.y);
        let right =
            if reach > 0.0 { Vec3::new(farthest.x, farthest.y, 0.0) / reach } else { Vec3::X };
        let line = |view: &RobotView| -> Vec<Point> {
            view.shape.positions().map(|p| [right.dot(p - base), p.z - base.z]).collect()
        };
        let lines: Vec<_> = case.views.iter().map(line).collect();
        let (mut low, mut high) = ([0.0_f64; 2], [0.0_f64; 2]);
        for point in lines.iter().flatten() {
            for k in 0..2 {
                finite(|| format!("a position in `{}`", case.title), point[k])?;
                low[k] = low[k].min(point[k]);
                high[k] = high[k].max(point[k]);
            }
        }
        Ok(Self { lines, low, high })
    }

    /// The longer edge of the box around it.
    fn extent(&self) -> f64 {
        (self.high[0] - self.low[0]).max(self.high[1] - self.low[1])
    }
}

fn picture(
    case: &SmallMultiple<'_>,
    side: &Side,
    scale: f64,
    farthest: f64,
) -> Result<String, PlotError> {
    let mut svg = Svg::new(SIZE[0], SIZE[1]);
    shapes(&mut svg, case, side, scale);
    if farthest > 0.0 && !case.distances.is_empty() {
        distances(&mut svg, case.distances, farthest);
    }
    svg.finish(case.title)
}

fn colour(view: &RobotView) -> Colour {
    match view.style {
        ViewStyle::Before => Colour::GREY,
        ViewStyle::Model(model) => Colour::of_model(model),
    }
}

fn shapes(svg: &mut Svg, case: &SmallMultiple<'_>, side: &Side, scale: f64) {
    let middle = [0, 1].map(|k| 0.5 * (side.low[k] + side.high[k]));
    let place = |p: &Point| {
        [
            INSET + 0.5 * HALF[0] + scale * (p[0] - middle[0]),
            TOP + 0.5 * HALF[1] - scale * (p[1] - middle[1]),
        ]
    };
    // The first model is drawn last, thinnest, so that those below it are seen where they agree.
    let lines: Vec<_> = case.views.iter().zip(&side.lines).collect();
    let (before, models): (Vec<_>, Vec<_>) =
        lines.into_iter().partition(|(view, _)| view.style == ViewStyle::Before);
    for (view, line) in before {
        let points: Vec<Point> = line.iter().map(place).collect();
        svg.polyline(&points, Stroke::new(colour(view), 1.0).dash("3 3"), "");
    }
    let count = models.len();
    for (k, (view, line)) in models.into_iter().enumerate().rev() {
        let points: Vec<Point> = line.iter().map(place).collect();
        let width = if count > 1 { 1.5 + 2.5 * k as f64 / (count - 1) as f64 } else { 2.5 };
        svg.polyline(&points, Stroke::new(colour(view), width), "");
    }
    let root = place(&[0.0, 0.0]);
    svg.circle(root, 2.5, Some(Fill::new(Colour::INK)), None);
    // A round length of about a third of the half.
    let (digit, exponent) = ticks::round_up(0.3 * HALF[0] / scale);
    let length = digit * ticks::power_of_ten(exponent);
    let (name, factor) = unit::length(length);
    let y = SIZE[1] - 16.0;
    let (left, right) = (INSET, INSET + scale * length);
    svg.line([left, y], [right, y], Stroke::new(Colour::INK, 1.5));
    let words = format!("{} {name}", factor * length);
    svg.text([right + 5.0, y], &Text::new(&words, SMALL));
}

fn distances(svg: &mut Svg, all: &[DistanceSeries], farthest: f64) {
    let (left, right) = (SIZE[0] - HALF[0] + 6.0, SIZE[0] - INSET);
    let (top, bottom) = (TOP + 6.0, TOP + HALF[1]);
    let (name, factor) = unit::length(farthest);
    let ticks = ticks::linear(0.0, factor * farthest, 5);
    let most = ticks.values.last().copied().unwrap_or(factor * farthest);
    let up = |value: f64| bottom - (bottom - top) * value / most;
    for (k, &value) in ticks.values.iter().enumerate() {
        svg.line([left, up(value)], [right, up(value)], Stroke::new(Colour::GRID, 1.0));
        let words = format!("{value:.*}", ticks.decimals);
        let is_last = k + 1 == ticks.values.len();
        let words = if is_last { format!("{words} {name}") } else { words };
        // Beside the line that it names, within the half.
        let text = Text::new(&words, SMALL).anchor(Anchor::End);
        svg.text([left - 4.0, up(value)], &text);
    }
    let last =
        all.iter().flat_map(|series| &series.disks).map(|&(disk, _)| disk).max().unwrap_or(1);
    let along = |disk: usize| {
        let share = if last > 1 { (disk as f64 - 1.0) / (last as f64 - 1.0) } else { 0.5 };
        left + 6.0 + (right - left - 12.0) * share
    };
    for (k, series) in all.iter().enumerate() {
        let (colour, sign) =
            series.look.unwrap_or_else(|| (Colour::nth(k), marker::Marker::nth(k)));
        let points: Vec<Point> =
            series.disks.iter().map(|&(disk, d)| [along(disk), up(factor * d)]).collect();
        let stroke = Stroke::new(colour, 1.5);
        svg.polyline(&points, if series.hollow { stroke.dash("3 3") } else { stroke }, "");
        for &point in &points {
            marker::draw(svg, sign, point, 2.2, Fill::new(colour), None);
        }
    }
    let words = format!("distance at disks 1 to {last}");
    svg.text([right, SIZE[1] - 16.0], &Text::new(&words, SMALL).anchor(Anchor::End));
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

    use whipcord::{ModelKind, Shape};

    use super::*;
    use crate::robot_figure::CableCourse;

    fn straight(length: f64) -> RobotView {
        let shape = Shape::straight(&[0.0, length]);
        RobotView {
            label: String::new(),
            disks: shape.clone(),
            shape,
            cables: CableCourse::Smooth,
            style: ViewStyle::Model(ModelKind::Cosserat),
        }
    }

    /// Height in px of the first model's line.
    fn height(svg: &str) -> f64 {
        let line = svg.split("d=\"M").nth(1).unwrap().split('"').next().unwrap();
        let numbers: Vec<f64> =
            line.split([' ', 'L', 'V', 'H', ',']).filter_map(|word| word.parse().ok()).collect();
        (numbers[1] - numbers[numbers.len() - 1]).abs()
    }

    #[test]
    fn all_pictures_have_one_scale() {
        let (long, short) = ([straight(0.4)], [straight(0.1)]);
        let case = |views| SmallMultiple { title: "a < b", views, distances: &[] };
        let all = small_multiples(&[case(&long), case(&short)]).unwrap();
        let ratio = height(&all[0]) / height(&all[1]);
        assert!((ratio - 4.0).abs() < 0.01, "{ratio}");
        assert!(all[0].contains("a &lt; b"));
    }

    #[test]
    fn distances_have_one_scale() {
        let views = [straight(0.4)];
        let series = |d: f64| DistanceSeries {
            label: String::new(),
            disks: vec![(1, d), (2, 2.0 * d)],
            look: None,
            hollow: false,
        };
        let (near, far) = ([series(1e-3)], [series(2e-3)]);
        let case = |distances| SmallMultiple { title: "", views: &views, distances };
        let all = small_multiples(&[case(&near), case(&far)]).unwrap();
        // Both have the ticks of the farther one.
        assert!(all.iter().all(|svg| svg.contains(">4 mm<")), "{}", all[0]);
    }

    #[test]
    fn a_case_without_shapes_is_refused() {
        let case = SmallMultiple { title: "empty", views: &[], distances: &[] };
        assert!(matches!(small_multiples(&[case]), Err(PlotError::Empty { .. })));
    }
}
