//! How a place yields and moves, drawn as ellipsoids: half axes along the principal directions, as long as
//! what goes with them is large.

use whipcord::{Vec3, kinematics::PrincipalAxes};

use crate::colour::Colour;
use crate::error::{PlotError, finite};
use crate::font;
use crate::legend::{Entry, Swatch};
use crate::projection::Projection;
use crate::svg::{Anchor, Ellipse, Fill, Point, Stroke, Svg, Text};
use crate::ticks;
use crate::unit;

/// How a place answers to forces or to its cables, along its principal directions.
#[derive(Clone, Debug, PartialEq)]
pub struct Ellipsoid {
    /// Entry in the legend.
    pub label: String,
    /// The place in m, in the frame of the shapes.
    pub at: Vec3,
    /// Values in SI and unit vectors in that frame.
    pub axes: PrincipalAxes,
    /// What the values are.
    pub quantity: Quantity,
}

/// What an ellipsoid shows. Those of the same quantity are drawn to one scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Motion under a force, in m/N.
    Compliance,
    /// Motion with a tension, in m/N.
    ByTension,
    /// Motion with a shortening, in m/m.
    ByShortening,
}

/// Length of the longest half axis relative to the extent of the robot.
const LONGEST: f64 = 0.2;
/// About this length of the robot, in m, has its value in the legend.
const LEGEND_LENGTH: f64 = 0.01;
/// Size of the labels, and their distance from the ends of the axes in px.
const SIZE: f64 = 10.5;
const GAP: f64 = 5.0;
/// Labels are at least this far apart in px.
const APART: f64 = 3.0;
/// An axis that is shorter than this in px has its label in the legend alone.
const SHORTEST: f64 = 9.0;

impl Quantity {
    /// A value in a unit that suits the largest.
    fn unit(self, largest: f64) -> (String, f64) {
        match self {
            Self::Compliance | Self::ByTension => {
                let (name, factor) = unit::length(largest);
                (format!("{name}/N"), factor)
            }
            Self::ByShortening => ("mm/mm".to_owned(), 1.0),
        }
    }
}

impl Quantity {
    /// What the value of a round length of the robot is at this scale, in m to the unit of the value.
    fn scale_in_words(self, scale: f64) -> Option<String> {
        if scale <= 0.0 {
            return None;
        }
        let (digit, exponent) = ticks::round_up(LEGEND_LENGTH / scale);
        let value = digit * ticks::power_of_ten(exponent);
        let (name, factor) = self.unit(value);
        let length = unit::digits(1e3 * value * scale);
        Some(format!("scale: {} {name} drawn {length} mm long", unit::digits(value * factor)))
    }
}

impl Ellipsoid {
    pub(crate) fn check(&self) -> Result<(), PlotError> {
        let vectors = self.axes.directions.iter().chain([&self.at]);
        for value in vectors.flat_map(|v| v.to_array()).chain(self.axes.values) {
            finite(|| "an ellipsoid".to_owned(), value)?;
        }
        Ok(())
    }

    /// Half axes in SI, the longest first; what rounding leaves of one that is nothing is nothing.
    fn values(&self) -> [(f64, Vec3); 3] {
        let mut axes = [0, 1, 2].map(|i| (self.axes.values[i].abs(), self.axes.directions[i]));
        axes.sort_by(|a, b| b.0.total_cmp(&a.0));
        let largest = axes[0].0;
        axes.map(|(value, d)| if value <= 1e-9 * largest { (0.0, d) } else { (value, d) })
    }

    /// The values, the greatest first, with their unit.
    fn in_words(&self) -> String {
        let values = self.values();
        let (name, factor) = self.quantity.unit(values[0].0);
        let texts = values.map(|(value, _)| unit::digits(value * factor));
        format!("{} {name}", texts.join(", "))
    }

    /// What force a motion takes along each axis.
    fn stiffness_in_words(&self) -> Option<String> {
        let values = self.values();
        if self.quantity != Quantity::Compliance || values[2].0 == 0.0 {
            return None;
        }
        let texts = values.map(|(value, _)| unit::digits(1e-3 / value));
        Some(format!("{} N/mm", texts.join(", ")))
    }
}

/// Ellipsoids in the size and colours in which they are drawn.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ellipsoids(Vec<Drawn>);

#[derive(Clone, Debug)]
struct Drawn {
    at: Vec3,
    /// Half axes in m of the picture, the longest first.
    axes: [Vec3; 3],
    /// What a length of the picture stands for, in words.
    scale: Option<String>,
    labels: [String; 3],
    colour: Colour,
}

impl Ellipsoids {
    /// For a robot of this extent in m; colours from number `first` of the palette.
    pub fn new(given: &[Ellipsoid], extent: f64, first: usize) -> Self {
        let drawn = given.iter().enumerate().map(|(i, ellipsoid)| {
            let alike = given.iter().filter(|other| other.quantity == ellipsoid.quantity);
            let largest = alike.map(|other| other.values()[0].0).fold(0.0, f64::max);
            let scale = if largest > 0.0 { LONGEST * extent / largest } else { 0.0 };
            let values = ellipsoid.values();
            let (name, factor) = ellipsoid.quantity.unit(values[0].0);
            Drawn {
                at: ellipsoid.at,
                axes: values.map(|(value, direction)| direction * (value * scale)),
                scale: ellipsoid.quantity.scale_in_words(scale),
                labels: values.map(|(value, _)| format!("{} {name}", unit::digits(value * factor))),
                colour: Colour::nth(first + i),
            }
        });
        Self(drawn.collect())
    }

    /// What they mean, with all their values, and how long a value is drawn.
    pub fn legend(&self, given: &[Ellipsoid]) -> Vec<Entry> {
        let mut entries = Vec::new();
        for (ellipsoid, drawn) in given.iter().zip(&self.0) {
            let colour = drawn.colour;
            let area = Swatch::Area(fill(colour), Some(Stroke::new(colour, 1.2)));
            entries.push(Entry { label: ellipsoid.label.clone(), swatches: vec![area] });
            let beneath = |label: String| Entry { label, swatches: vec![] };
            entries.push(beneath(ellipsoid.in_words()));
            entries.extend(ellipsoid.stiffness_in_words().map(beneath));
            entries.extend(drawn.scale.clone().map(beneath));
        }
        entries
    }

    /// Points that span them.
    pub fn outline(&self) -> impl Iterator<Item = Vec3> + '_ {
        let ends = |e: &Drawn| e.axes.map(|axis| [e.at + axis, e.at - axis]);
        self.0.iter().flat_map(move |e| ends(e).into_iter().flatten())
    }

    /// Draws their outlines and axes over the robot.
    pub fn draw(&self, svg: &mut Svg, view: &Projection) {
        if self.0.is_empty() {
            return;
        }
        svg.open("ellipsoids");
        for ellipsoid in &self.0 {
            let stroke = Stroke::new(ellipsoid.colour, 1.2);
            svg.plate(ellipsoid.silhouette(view).visible(), &[], fill(ellipsoid.colour), stroke);
            for axis in ellipsoid.axes {
                let ends = [ellipsoid.at - axis, ellipsoid.at + axis].map(|p| view.place(p));
                svg.line(ends[0], ends[1], Stroke::new(ellipsoid.colour, 0.9));
            }
        }
        svg.close();
    }

    /// Writes the values at the ends of the axes, where they fit into the box and meet no other.
    pub fn draw_labels(&self, svg: &mut Svg, view: &Projection, (corner, size): (Point, Point)) {
        if self.0.is_empty() {
            return;
        }
        svg.open("values");
        let mut taken: Vec<(Point, Point)> = Vec::new();
        for ellipsoid in &self.0 {
            for (axis, label) in ellipsoid.axes.iter().zip(&ellipsoid.labels) {
                let width = font::width(label, SIZE, false);
                let free = [1.0, -1.0].into_iter().find_map(|side| {
                    let at = ellipsoid.beside(view, *axis * side, width)?;
                    let box_of = (at, [width, SIZE + 2.0]);
                    let inside = at[0] >= corner[0]
                        && at[1] >= corner[1]
                        && at[0] + width <= corner[0] + size[0]
                        && at[1] + SIZE + 2.0 <= corner[1] + size[1];
                    (inside && !taken.iter().any(|other| meet(other, &box_of))).then_some(box_of)
                });
                let Some(place) = free else { continue };
                let back = Fill::new(Colour::WHITE).opacity(0.75);
                svg.rect(place.0, place.1, Some(back), None);
                let middle = [place.0[0], place.0[1] + 0.5 * place.1[1]];
                let text = Text::new(label, SIZE).anchor(Anchor::Start);
                svg.text(middle, &Text { colour: ellipsoid.colour, ..text });
                taken.push(place);
            }
        }
        svg.close();
    }
}

impl Drawn {
    /// The outline: the ellipse of the sum of squares of the projected half axes.
    fn silhouette(&self, view: &Projection) -> Ellipse {
        let centre = view.place(self.at);
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for axis in self.axes {
            let end = view.place(self.at + axis);
            let [x, y] = [end[0] - centre[0], end[1] - centre[1]];
            (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
        }
        let (middle, reach) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
        let radius = |squared: f64| squared.max(0.0).sqrt();
        let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
        Ellipse { centre, radii: [radius(middle + reach), radius(middle - reach)], angle }
    }

    /// Upper left corner of a label of this width beyond the end of a half axis; none where that is
    /// too short.
    fn beside(&self, view: &Projection, axis: Vec3, width: f64) -> Option<Point> {
        let (centre, end) = (view.place(self.at), view.place(self.at + axis));
        let (dx, dy) = (end[0] - centre[0], end[1] - centre[1]);
        let length = dx.hypot(dy);
        if length < SHORTEST {
            return None;
        }
        let [x, y] = [end[0] + GAP * dx / length, end[1] + GAP * dy / length];
        // The label begins or ends beside the axis; above or below, it has its middle there.
        let share = 0.5 - 0.5 * (1.5 * dx / length).clamp(-1.0, 1.0);
        Some([x - share * width, y - 0.5 * (SIZE + 2.0) * (1.0 - dy / length)])
    }
}

fn fill(colour: Colour) -> Fill {
    Fill::new(colour.tint(0.35)).opacity(0.3)
}

fn meet((a, a_size): &(Point, Point), (b, b_size): &(Point, Point)) -> bool {
    (0..2).all(|i| a[i] < b[i] + b_size[i] + APART && b[i] < a[i] + a_size[i] + APART)
}
