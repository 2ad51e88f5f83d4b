//! The three orthogonal views: front, side and top in one scale, with axes in mm.

use whipcord::Vec3;

use crate::colour::Colour;
use crate::error::PlotError;
use crate::font;
use crate::legend::{Entry, Legend};
use crate::projection::Projection;
use crate::robot_figure::{self, Drawn};
use crate::svg::{Anchor, Point, Stroke, Svg, Text};
use crate::ticks;
use crate::title::Title;

const TICK_SIZE: f64 = 10.5;
const LABEL_SIZE: f64 = 11.5;
/// Left of a view, for its vertical axis without the tick labels, and below it, for its horizontal
/// one.
const LEFT: f64 = 29.0;
const BELOW: f64 = 42.0;
const GAP: f64 = 12.0;
const LEGEND_GAP: f64 = 26.0;
/// Free space between tick labels in px.
const TICK_GAP: f64 = 11.0;
/// The same where more ticks are wanted.
const LEAST_GAP: f64 = 6.0;
/// An axis with fewer ticks than this has finer ones if it can.
const FEWEST: usize = 3;
/// Most ticks on an axis.
const MOST: f64 = 15.0;
/// An axis is at least this long relative to the longest.
const SLIMMEST: f64 = 0.3;
/// Room around the robot relative to its largest extent.
const ROOM: f64 = 0.03;

/// Round a picture of three views, and its widest legend.
const MARGIN: f64 = 14.0;
const LEGEND_WIDTH: f64 = 190.0;

/// Upper left corner and size of a view in px.
pub(crate) type Frame = (Point, Point);

/// A picture of three views of these points, with a title and a legend.
///
/// # Errors
/// [`PlotError`] for what cannot be drawn.
pub(crate) fn picture(
    (title, width): (&str, f64),
    points: &[Vec3],
    entries: Vec<Entry>,
    contents: impl Fn(&mut Svg, &Projection, [usize; 2], Frame),
) -> Result<String, PlotError> {
    let words = Title::new(title, width - 2.0 * MARGIN);
    let top = MARGIN + words.height() + 4.0;
    let plan = Plan::new(
        points,
        [MARGIN, top],
        [width - 2.0 * MARGIN, 640.0],
        Legend::width_of(&entries).min(LEGEND_WIDTH),
    );
    let legend = Legend::of_height(entries, plan.legend_width(), plan.legend_height());
    let bottom = plan.bottom().max(plan.legend_place()[1] + legend.height());
    let mut svg = Svg::new(width, bottom + MARGIN);
    words.draw(&mut svg, [MARGIN, MARGIN]);
    plan.draw_views(&mut svg, contents);
    legend.draw(&mut svg, plan.legend_place());
    svg.finish(title)
}

/// Where the views lie.
pub(crate) struct Plan {
    /// Range of x, y and z in m.
    ranges: [[f64; 2]; 3],
    /// Px to the metre.
    scale: f64,
    at: Point,
    /// Room left of a view in px.
    margin: f64,
    /// Least distance of ticks in m.
    tick: f64,
    /// Right edge of all that is drawn.
    right: f64,
}

impl Plan {
    /// Views of all these points, with their upper left corner at `at`, no larger than `size`, and
    /// with room for a legend of this width below the side view.
    pub fn new(points: &[Vec3], at: Point, size: Point, legend: f64) -> Self {
        let ranges = ranges(points);
        let [x, y, z] = ranges.map(|[low, high]| high - low);
        let least_tick = x.max(y).max(z) / MOST;
        // Ticks at the least distance have labels as wide as any.
        let labels = ranges.map(|range| labels(range, least_tick));
        let widest = labels.iter().flatten().map(|(_, text)| font::width(text, TICK_SIZE, false));
        let widest = widest.fold(0.0, f64::max);
        let margin = LEFT + widest;
        let width = size[0] - 2.0 * margin - GAP;
        let height = size[1] - 2.0 * BELOW - GAP;
        let beside_legend = (size[0] - margin - LEGEND_GAP - legend).max(0.4 * width);
        let scale = (width / (x + y)).min(height / (z + y)).min(beside_legend / x);
        let tick = ((widest + TICK_GAP) / scale).max(least_tick);
        Self { ranges, scale, at, margin, tick, right: at[0] + size[0] }
    }

    fn length(&self, axis: usize) -> f64 {
        let [low, high] = self.ranges[axis];
        self.scale * (high - low)
    }

    /// Lower edge of all that is drawn.
    pub fn bottom(&self) -> f64 {
        self.second_row() + self.length(1) + BELOW
    }

    fn second_row(&self) -> f64 {
        self.at[1] + self.length(2) + BELOW + GAP
    }

    fn second_column(&self) -> f64 {
        self.at[0] + self.margin + self.length(0) + GAP + self.margin
    }

    /// Upper left corner of the legend.
    pub fn legend_place(&self) -> Point {
        [self.at[0] + self.margin + self.length(0) + LEGEND_GAP, self.second_row()]
    }

    /// Width that is free for the legend.
    pub fn legend_width(&self) -> f64 {
        self.right - self.legend_place()[0]
    }

    /// Height that is free for the legend anyway.
    pub fn legend_height(&self) -> f64 {
        self.bottom() - self.second_row()
    }

    /// Draws the views of a robot.
    pub fn draw(&self, svg: &mut Svg, drawn: &Drawn<'_>) {
        self.draw_views(svg, |svg, view, axes, frame| {
            let name = axes.map(|a| ["x", "y", "z"][a]).concat();
            drawn.draw(svg, view, (&name, frame.0, frame.1), 3.0);
            drawn.loads.draw_gravity_in(svg, view, frame, &drawn.points);
        });
    }

    /// Draws the axes of the views, and in each what `contents` draws: it gets the projection, the numbers of the axes to the right and
    /// upwards, and the frame of the view.
    pub fn draw_views(
        &self,
        svg: &mut Svg,
        contents: impl Fn(&mut Svg, &Projection, [usize; 2], Frame),
    ) {
        let first = [self.at[0] + self.margin, self.at[1]];
        let side = [self.second_column(), self.at[1]];
        let top = [self.at[0] + self.margin, self.second_row()];
        // Seen from −y, from +x, and from +z: each right-handed.
        for (corner, axes) in [(first, [0, 2]), (side, [1, 2]), (top, [0, 1])] {
            self.draw_view(svg, corner, axes, &contents);
        }
    }

    fn draw_view(
        &self,
        svg: &mut Svg,
        [left, top]: Point,
        axes: [usize; 2],
        contents: &impl Fn(&mut Svg, &Projection, [usize; 2], Frame),
    ) {
        let unit = [Vec3::X, Vec3::Y, Vec3::Z];
        let [[x0, _], [y0, _]] = axes.map(|a| self.ranges[a]);
        let [width, height] = axes.map(|a| self.length(a));
        let origin = [left - self.scale * x0, top + height + self.scale * y0];
        let view = Projection::new(unit[axes[0]], unit[axes[1]]).placed(self.scale, origin);
        svg.open("view");
        let frame = ([left, top], [width, height]);
        self.draw_axes(svg, frame, axes, origin);
        contents(svg, &view, axes, frame);
        svg.close();
    }

    /// Ticks with a step that is the same on all axes, but for a short axis on which there would be
    /// too few: it has a finer one where its labels fit. Of labels that touch some are left out.
    fn labels_of(&self, axis: usize, vertical: bool) -> Vec<(f64, String)> {
        let range = self.ranges[axis];
        let fit = |of: &[(f64, String)]| {
            let widths = of.iter().map(|(_, text)| font::width(text, TICK_SIZE, false));
            let widest = widths.fold(0.0, f64::max);
            let size = if vertical { TICK_SIZE } else { widest };
            // Finer ticks may have a decimal or a sign more than the margin has room for.
            let in_margin = !vertical || widest <= self.margin - LEFT;
            let apart = |w: &[(f64, String)]| self.scale * (w[1].0 - w[0].0);
            in_margin && of.windows(2).all(|w| apart(w) >= size + LEAST_GAP)
        };
        let common = labels(range, self.tick);
        if common.len() >= FEWEST && fit(&common) {
            return common;
        }
        let finer = [0.2, 0.5].map(|share| labels(range, share * self.tick));
        if common.len() < FEWEST
            && let Some(finer) = finer.into_iter().find(|finer| fit(finer))
        {
            return finer;
        }
        // Those that are left are as far apart as before from zero, or from the first.
        let zero = common.iter().position(|(value, _)| *value == 0.0).unwrap_or(0);
        let every = |n: usize| {
            let kept = common.iter().enumerate().filter(|(i, _)| i.abs_diff(zero) % n == 0);
            kept.map(|(_, label)| label.clone()).collect::<Vec<_>>()
        };
        let thinned = (1..common.len()).map(every);
        thinned.into_iter().find(|of| of.len() > 1 && fit(of)).unwrap_or(common.clone())
    }

    fn draw_axes(
        &self,
        svg: &mut Svg,
        ([left, top], [width, height]): (Point, Point),
        axes: [usize; 2],
        origin: Point,
    ) {
        let (right, bottom) = (left + width, top + height);
        let grid = Stroke::new(Colour::GRID, 0.7);
        let ink = Stroke::new(Colour::INK, 0.9);
        let name = |axis: usize| format!("{} (mm)", ["x", "y", "z"][axis]);
        let places = |i: usize| {
            let sign = if i == 0 { self.scale } else { -self.scale };
            let labels = self.labels_of(axes[i], i == 1).into_iter();
            labels.map(move |(value, text)| (origin[i] + sign * value, text))
        };
        for (x, _) in places(0) {
            svg.line([x, top], [x, bottom], grid);
        }
        for (y, _) in places(1) {
            svg.line([left, y], [right, y], grid);
        }
        for (x, label) in places(0) {
            svg.line([x, bottom], [x, bottom + 3.0], ink);
            let text = Text::new(&label, TICK_SIZE).anchor(Anchor::Middle);
            svg.text([x, bottom + 7.5 + 0.5 * TICK_SIZE], &text);
        }
        for (y, label) in places(1) {
            svg.line([left - 3.0, y], [left, y], ink);
            let text = Text::new(&label, TICK_SIZE).anchor(Anchor::End);
            svg.text([left - 5.0, y], &text);
        }
        svg.rect([left, top], [width, height], None, Some(ink));
        let label = name(axes[0]);
        let text = Text::new(&label, LABEL_SIZE).anchor(Anchor::Middle);
        svg.text([left + 0.5 * width, bottom + 28.0], &text);
        let label = name(axes[1]);
        let text = Text { upwards: true, ..Text::new(&label, LABEL_SIZE).anchor(Anchor::Middle) };
        svg.text([left - self.margin + 12.0, top + 0.5 * height], &text);
    }
}

/// Where in a range (m) there are ticks, at least so far apart, and their labels in mm.
fn labels([low, high]: [f64; 2], least: f64) -> Vec<(f64, String)> {
    let ticks::Linear { values, decimals } = ticks::inside(1e3 * low, 1e3 * high, 1e3 * least);
    let label = |mm: f64| (1e-3 * mm, format!("{mm:.decimals$}").replace('-', "−"));
    values.into_iter().map(label).collect()
}

fn ranges(points: &[Vec3]) -> [[f64; 2]; 3] {
    let mut ranges = [0, 1, 2].map(|i| robot_figure::range(points, i));
    let largest = ranges.iter().map(|[l, h]| h - l).fold(0.0, f64::max);
    for range in &mut ranges {
        let [low, high] = *range;
        let room = (ROOM * largest).max(0.5 * (SLIMMEST * largest - (high - low)));
        *range = [low - room, high + room];
    }
    ranges
}
