//! Charts: series of numbers over a horizontal axis.

use crate::axis::{Axis, Scale, TICK_SIZE};
use crate::colour::Colour;
use crate::error::{PlotError, finite, not_empty, positive};
use crate::font;
use crate::legend::{Entry, Legend, Swatch};
use crate::marker::{self, Marker};
use crate::names::{self, Area};
use crate::svg::{Anchor, Fill, Point, Stroke, Svg, Text};
use crate::title;

const LABEL_SIZE: f64 = 12.0;
const MARGIN: f64 = 14.0;
/// Width of the bars of one category relative to the distance of categories.
const GROUP: f64 = 0.78;

/// A chart: what all others are made with.
///
/// ```
/// use whipcord_plot::{AxisSpec, Chart, Layer, Series};
///
/// let chart = Chart {
///     title: "Bending under load".into(),
///     x: AxisSpec::linear("tension (N)"),
///     y: AxisSpec::linear("bend (degrees)").from_zero(),
///     series: vec![Series::new("measured", 0, vec![
///         Layer::Line(vec![[0.0, 0.0], [1.0, 12.0], [2.0, 25.0]]),
///         Layer::Markers(vec![[0.0, 0.0], [1.0, 12.0], [2.0, 25.0]]),
///     ])],
///     ..Chart::default()
/// };
/// let svg = chart.svg()?;
/// assert!(svg.starts_with("<svg"));
/// # Ok::<(), whipcord_plot::PlotError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// Above the chart; may be empty.
    pub title: String,
    /// Horizontal axis.
    pub x: AxisSpec,
    /// Vertical axis.
    pub y: AxisSpec,
    /// What is drawn, the first at the back.
    pub series: Vec<Series>,
    /// Width of the picture in px.
    pub width: f64,
    /// Height of the picture in px, without what a title or a legend of several lines add.
    pub height: f64,
}

/// What an axis shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AxisSpec {
    /// Quantity and unit.
    pub label: String,
    /// How its numbers are laid out.
    pub scale: Scale,
    /// Whether it shows zero in any case; for linear axes.
    pub from_zero: bool,
    /// Whether it counts: every whole number between the data has its place; for the horizontal axis.
    pub counts: bool,
}

/// Data that belong together: one colour, one sign, one entry in the legend.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Entry in the legend; none when empty.
    pub label: String,
    /// Colour of lines, signs and bars.
    pub colour: Colour,
    /// Sign of single data.
    pub marker: Marker,
    /// What is drawn, the first at the back.
    pub layers: Vec<Layer>,
}

/// Data in one form of drawing. Points are (x, y).
#[derive(Clone, Debug, PartialEq)]
pub enum Layer {
    /// A line through points.
    Line(Vec<[f64; 2]>),
    /// A dashed line through points.
    Dashed(Vec<[f64; 2]>),
    /// A sign at each point.
    Markers(Vec<[f64; 2]>),
    /// A hollow sign at each point.
    Rings(Vec<[f64; 2]>),
    /// A small pale sign at each point, for the many from which something is gathered.
    Dots(Vec<[f64; 2]>),
    /// A word near each point, where it lies on no sign and on no other word.
    Names(Vec<([f64; 2], String)>),
    /// (x, low, high): a bar.
    Errors(Vec<[f64; 3]>),
    /// A column from zero to each point, beside those of other series at the same x.
    Columns(Vec<[f64; 2]>),
    /// The same, of which only the outline has the full colour.
    HollowColumns(Vec<[f64; 2]>),
}

impl Default for Chart {
    fn default() -> Self {
        Self {
            title: String::new(),
            x: AxisSpec::default(),
            y: AxisSpec::default(),
            series: Vec::new(),
            width: 640.0,
            height: 420.0,
        }
    }
}

impl AxisSpec {
    /// A linear axis.
    #[must_use]
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), ..Self::default() }
    }

    /// A logarithmic axis.
    #[must_use]
    pub fn log(label: impl Into<String>) -> Self {
        Self { scale: Scale::Log, ..Self::linear(label) }
    }

    /// The same axis, showing zero.
    #[must_use]
    pub fn from_zero(self) -> Self {
        Self { from_zero: true, ..self }
    }

    /// An axis of whole numbers.
    #[must_use]
    pub fn counting(label: impl Into<String>) -> Self {
        Self { counts: true, ..Self::linear(label) }
    }

    fn limits(&self, values: impl Iterator<Item = f64>) -> [f64; 2] {
        let [mut low, mut high] =
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(v), h.max(v)]);
        if self.from_zero && self.scale == Scale::Linear {
            (low, high) = (low.min(0.0), high.max(0.0));
        }
        [low, high]
    }
}

impl Series {
    /// A series in colour and sign number `index`, from 0.
    #[must_use]
    pub fn new(label: impl Into<String>, index: usize, layers: Vec<Layer>) -> Self {
        Self { label: label.into(), colour: Colour::nth(index), marker: Marker::nth(index), layers }
    }
}

impl Layer {
    fn has_columns(&self) -> bool {
        matches!(self, Self::Columns(_) | Self::HollowColumns(_))
    }

    /// All numbers that must find a place: (x, y).
    fn extremes(&self, log: bool) -> Vec<Point> {
        match self {
            Self::Line(p) | Self::Dashed(p) | Self::Markers(p) | Self::Rings(p) | Self::Dots(p) => {
                p.clone()
            }
            Self::Names(list) => list.iter().map(|(point, _)| *point).collect(),
            Self::Columns(p) | Self::HollowColumns(p) => {
                p.iter().flat_map(|&[x, y]| [[x, y], [x, 0.0]]).collect()
            }
            // Where the logarithm ends, the bar does.
            Self::Errors(list) => list
                .iter()
                .flat_map(|&[x, low, high]| [[x, low], [x, high]])
                .filter(|p| !log || p[1] > 0.0)
                .collect(),
        }
    }

    fn check(&self, label: &str, logs: [bool; 2]) -> Result<(), PlotError> {
        let numbers: Vec<[f64; 2]> = match self {
            Self::Errors(list) => {
                for [_, low, _] in list {
                    finite(|| format!("an error of `{label}`"), *low)?;
                }
                list.iter().map(|&[x, _, high]| [x, high]).collect()
            }
            Self::Names(list) => list.iter().map(|(point, _)| *point).collect(),
            Self::Line(p)
            | Self::Dashed(p)
            | Self::Markers(p)
            | Self::Rings(p)
            | Self::Dots(p)
            | Self::Columns(p)
            | Self::HollowColumns(p) => p.clone(),
        };
        for point in numbers {
            for (i, axis) in ["x", "y"].into_iter().enumerate() {
                let what = || format!("{axis} of `{label}`");
                finite(what, point[i])?;
                if logs[i] {
                    positive(what, point[i])?;
                }
            }
        }
        Ok(())
    }
}

/// Where the data are drawn.
struct Frame {
    left: f64,
    top: f64,
    width: f64,
    height: f64,
    x: Axis,
    y: Axis,
}

impl Frame {
    fn place(&self, [x, y]: Point) -> Point {
        [
            self.left + self.width * self.x.fraction(x),
            self.top + self.height * (1.0 - self.y.fraction(y)),
        ]
    }

    fn bottom(&self) -> f64 {
        self.top + self.height
    }

    fn right(&self) -> f64 {
        self.left + self.width
    }
}

impl Chart {
    /// The chart as an SVG document.
    ///
    /// # Errors
    /// [`PlotError`] when there are no data, when a number is not finite, or when one has no
    /// logarithm on a logarithmic axis.
    pub fn svg(&self) -> Result<String, PlotError> {
        let points = self.check()?;
        let inner = self.width - 2.0 * MARGIN;
        let title = title::Title::new(&self.title, inner);
        let legend = Legend::new(self.series.iter().filter_map(Series::entry).collect(), inner);
        let legend_space = if legend.height() > 0.0 { legend.height() + 8.0 } else { 0.0 };
        let top = MARGIN + title.height() + legend_space + 4.0;
        // Only the first line of each is part of the height that was asked for.
        let extra = (title.height() - title::LINE).max(0.0) + (legend_space - 26.0).max(0.0);
        let total = self.height + extra;

        let bottom_space = TICK_SIZE + 11.0 + LABEL_SIZE + 16.0;
        let height = (total - top - bottom_space).max(80.0);
        let total = top + height + bottom_space;
        let [low, high] = self.y.limits(points.iter().map(|p| p[1]));
        let y = Axis::vertical(self.y.scale, low, high, height);
        let left = MARGIN + LABEL_SIZE + 12.0 + y.label_width() + 7.0;
        let width = (self.width - left - MARGIN - 6.0).max(80.0);
        let [low, high] = self.x.limits(points.iter().map(|p| p[0]));
        let x = if self.x.counts {
            Axis::counting(low.max(0.0) as usize, high.max(0.0) as usize, width)
        } else {
            Axis::horizontal(self.x.scale, low, high, width)
        };
        let frame = Frame { left, top, width, height, x, y };

        let mut svg = Svg::new(self.width, total);
        title.draw(&mut svg, [MARGIN, MARGIN]);
        legend.draw(&mut svg, [MARGIN, MARGIN + title.height()]);
        self.draw_axes(&mut svg, &frame, total);
        self.draw_data(&mut svg, &frame);
        svg.finish(&self.title)
    }

    fn check(&self) -> Result<Vec<Point>, PlotError> {
        not_empty(|| "the list of series".to_owned(), &self.series)?;
        let logs = [self.x.scale == Scale::Log, self.y.scale == Scale::Log];
        let mut points = Vec::new();
        for series in &self.series {
            for layer in &series.layers {
                layer.check(&series.label, logs)?;
                points.extend(layer.extremes(logs[1]));
            }
        }
        not_empty(|| "the list of data".to_owned(), &points)?;
        Ok(points)
    }

    fn draw_axes(&self, svg: &mut Svg, frame: &Frame, total: f64) {
        let (left, right, top, bottom) = (frame.left, frame.right(), frame.top, frame.bottom());
        let axis = Stroke::new(Colour::INK, 1.0);
        let grid = Stroke::new(Colour::GRID, 0.8);
        svg.open("axes");
        for tick in &frame.y.ticks {
            let y = frame.place([0.0, tick.value])[1];
            svg.line([left, y], [right, y], grid);
        }
        if !self.x.counts {
            for tick in &frame.x.ticks {
                let x = left + frame.width * frame.x.fraction(tick.value);
                svg.line([x, top], [x, bottom], grid);
            }
        }
        for tick in &frame.y.ticks {
            let y = frame.place([0.0, tick.value])[1];
            svg.line([left - 4.0, y], [left, y], axis);
            let text = Text {
                exponent: &tick.label.exponent,
                ..Text::new(&tick.label.text, TICK_SIZE).anchor(Anchor::End)
            };
            svg.text([left - 7.0, y], &text);
        }
        for tick in &frame.x.ticks {
            let x = left + frame.width * frame.x.fraction(tick.value);
            svg.line([x, bottom], [x, bottom + 4.0], axis);
            let text = Text {
                exponent: &tick.label.exponent,
                ..Text::new(&tick.label.text, TICK_SIZE).anchor(Anchor::Middle)
            };
            svg.text([x, bottom + 9.0 + 0.5 * TICK_SIZE], &text);
        }
        for &value in &frame.y.minor {
            let y = frame.place([0.0, value])[1];
            svg.line([left - 2.0, y], [left, y], axis);
        }
        for &value in &frame.x.minor {
            let x = left + frame.width * frame.x.fraction(value);
            svg.line([x, bottom], [x, bottom + 2.0], axis);
        }
        svg.polyline(&[[left, top], [left, bottom], [right, bottom]], axis, "");
        let label = |text, at, upwards, limit, svg: &mut Svg| {
            let text = font::elide(text, LABEL_SIZE, limit);
            let text = Text { upwards, ..Text::new(&text, LABEL_SIZE).anchor(Anchor::Middle) };
            svg.text(at, &text);
        };
        let middle = [left + 0.5 * frame.width, total - 8.0 - 0.5 * LABEL_SIZE];
        label(&self.x.label, middle, false, frame.width + 40.0, svg);
        let middle = [MARGIN + 0.5 * LABEL_SIZE, top + 0.5 * frame.height];
        label(&self.y.label, middle, true, frame.height + 40.0, svg);
        svg.close();
    }

    fn draw_data(&self, svg: &mut Svg, frame: &Frame) {
        let with_columns: Vec<usize> = (0..self.series.len())
            .filter(|&i| self.series[i].layers.iter().any(Layer::has_columns))
            .collect();
        for (index, series) in self.series.iter().enumerate() {
            svg.open("series");
            for layer in &series.layers {
                let slot = with_columns.iter().position(|&i| i == index).unwrap_or(0);
                series.draw(svg, frame, layer, (slot, with_columns.len()));
            }
            svg.close();
        }
        self.draw_names(svg, frame);
    }

    /// Last, as they keep clear of every sign.
    fn draw_names(&self, svg: &mut Svg, frame: &Frame) {
        let layers = || self.series.iter().flat_map(|one| one.layers.iter().map(move |l| (one, l)));
        let names: Vec<(&Series, Point, &str)> = layers()
            .filter_map(|(one, layer)| match layer {
                Layer::Names(list) => Some(list.iter().map(move |(p, name)| (one, *p, name))),
                _ => None,
            })
            .flatten()
            .map(|(one, point, name)| (one, frame.place(point), name.as_str()))
            .collect();
        if names.is_empty() {
            return;
        }
        let signs: Vec<Area> = layers()
            .filter_map(|(_, layer)| match layer {
                Layer::Markers(p) | Layer::Rings(p) => Some(p),
                _ => None,
            })
            .flatten()
            .map(|&point| Area::around(frame.place(point), 1.6 * SIGN))
            .collect();
        let height = 1.25 * LABEL_SIZE;
        let words: Vec<(Point, [f64; 2])> = names
            .iter()
            .map(|&(_, at, name)| (at, [font::width(name, LABEL_SIZE, false), height]))
            .collect();
        let (left, top) = (frame.left, frame.top);
        let inside = Area { left, top, right: frame.right(), bottom: frame.bottom() };
        svg.open("names");
        let placed = names::place(&words, &signs, inside);
        for (placed, _) in placed.iter().zip(&names) {
            if let Some([from, to]) = placed.leader {
                svg.line(from, to, Stroke::new(Colour::GREY, 0.7));
            }
        }
        // What lies below shines through, and no more.
        let veil = Some(Fill::new(Colour::WHITE).opacity(0.75));
        for (placed, (_, size)) in placed.iter().zip(&words) {
            let [left, middle] = placed.at;
            svg.rect([left, middle - 0.5 * size[1]], *size, veil, None);
        }
        for (placed, (_, _, name)) in placed.iter().zip(&names) {
            svg.text(placed.at, &Text::new(name, LABEL_SIZE));
        }
        svg.close();
    }
}

/// Size of signs in px.
const SIGN: f64 = 3.6;
const LINE: f64 = 1.6;
const DASH: &str = "5 4";
/// How much of its colour a hollow column is filled with.
const HOLLOW: f64 = 0.15;

impl Series {
    fn draw(&self, svg: &mut Svg, frame: &Frame, layer: &Layer, (slot, slots): (usize, usize)) {
        let at =
            |points: &[Point]| -> Vec<Point> { points.iter().map(|&p| frame.place(p)).collect() };
        match layer {
            Layer::Line(p) => svg.polyline(&at(p), Stroke::new(self.colour, LINE), "line"),
            Layer::Dashed(p) => {
                svg.polyline(&at(p), Stroke::new(self.colour, 1.2).dash(DASH), "dashed");
            }
            Layer::Markers(p) => {
                for at in at(p) {
                    let rim = Some(Stroke::new(Colour::WHITE, 0.8));
                    marker::draw(svg, self.marker, at, SIGN, Fill::new(self.colour), rim);
                }
            }
            Layer::Rings(p) => {
                for at in at(p) {
                    let rim = Some(Stroke::new(self.colour, LINE));
                    marker::draw(svg, self.marker, at, SIGN, Fill::new(Colour::WHITE), rim);
                }
            }
            // Drawn when all else is.
            Layer::Names(_) => {}
            Layer::Dots(p) => {
                for at in at(p) {
                    svg.circle(at, 1.7, Some(Fill::new(self.colour).opacity(0.35)), None);
                }
            }
            Layer::Errors(list) => {
                let [least, _] = frame.y.limits();
                let stroke = Stroke::new(self.colour, 1.1);
                for &[x, low, high] in list {
                    let [px, high] = frame.place([x, high]);
                    let [_, low] = frame.place([x, low.max(least)]);
                    svg.line([px, low], [px, high], stroke);
                    for end in [low, high] {
                        svg.line([px - 3.0, end], [px + 3.0, end], stroke);
                    }
                }
            }
            Layer::Columns(p) | Layer::HollowColumns(p) => {
                let (fill, rim) = self.column(matches!(layer, Layer::HollowColumns(_)));
                let width = GROUP / slots.max(1) as f64;
                for &[x, y] in p {
                    let start = x - 0.5 * GROUP + slot as f64 * width;
                    let [x0, y0] = frame.place([start + 0.04 * width, y.max(0.0)]);
                    let [x1, y1] = frame.place([start + 0.96 * width, y.min(0.0)]);
                    svg.rect([x0, y0], [x1 - x0, y1 - y0], Some(fill), rim);
                }
            }
        }
    }

    /// How columns are drawn.
    fn column(&self, hollow: bool) -> (Fill, Option<Stroke>) {
        if hollow {
            (Fill::new(self.colour.tint(HOLLOW)), Some(Stroke::new(self.colour, 1.0)))
        } else {
            (Fill::new(self.colour), None)
        }
    }

    fn entry(&self) -> Option<Entry> {
        if self.label.is_empty() {
            return None;
        }
        let mut swatches = Vec::new();
        for layer in &self.layers {
            let rim = Some(Stroke::new(Colour::WHITE, 0.8));
            swatches.push(match layer {
                Layer::Line(_) => Swatch::Line(Stroke::new(self.colour, LINE)),
                Layer::Dashed(_) => Swatch::Line(Stroke::new(self.colour, 1.2).dash(DASH)),
                Layer::Markers(_) => Swatch::Marker(self.marker, Fill::new(self.colour), rim),
                Layer::Rings(_) => {
                    let rim = Some(Stroke::new(self.colour, LINE));
                    Swatch::Marker(self.marker, Fill::new(Colour::WHITE), rim)
                }
                Layer::Columns(_) | Layer::HollowColumns(_) => {
                    let (fill, rim) = self.column(matches!(layer, Layer::HollowColumns(_)));
                    Swatch::Area(fill, rim)
                }
                Layer::Dots(_) | Layer::Errors(_) | Layer::Names(_) => continue,
            });
        }
        Some(Entry { label: self.label.clone(), swatches })
    }
}
