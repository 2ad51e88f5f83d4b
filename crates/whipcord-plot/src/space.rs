//! The view in space: the robot on a floor with axes and a scale.

use whipcord::Vec3;

use crate::body::Part;
use crate::colour::Colour;
use crate::projection::Projection;
use crate::robot_figure::{self, Bodies, Drawn};
use crate::scene;
use crate::svg::{Anchor, Point, Stroke, Svg, Text};
use crate::ticks;

const PAD: f64 = 6.0;
/// Height of the strip below for scale and axes.
const STRIP: f64 = 58.0;
/// Length of an axis that is not foreshortened, in px.
const AXIS: f64 = 34.0;
const SIZE: f64 = 12.0;
/// Distance of its letter from the end of an axis in px.
const LETTER: f64 = 8.0;
/// Distance of the arrow of gravity from the axes in px.
const GRAVITY: f64 = 76.0;

/// What may reach below the floor, relative to the side of a square.
const BASE: f64 = 0.2;

/// A floor of whole squares.
struct Floor {
    z: f64,
    step: f64,
    x: [f64; 2],
    y: [f64; 2],
}

impl Floor {
    /// Under all these points.
    fn under(points: &[Vec3]) -> Self {
        let range = |i: usize| robot_figure::range(points, i);
        let [x, y, z] = [range(0), range(1), range(2)];
        let largest = [x, y, z].iter().map(|[l, h]| h - l).fold(0.0, f64::max);
        let (digit, exponent) = ticks::round_up(largest / 12.0);
        let step = digit * ticks::power_of_ten(exponent);
        let whole = |[low, high]: [f64; 2]| {
            [(low / step + 1e-9).floor() * step, (high / step - 1e-9).ceil() * step]
        };
        // A base at the origin stands on the floor, unless the robot reaches below it; a robot that
        // is mounted higher has the floor not far below.
        // The lower half of the base disk does not count.
        let below = ((z[0] / step) + BASE).floor() * step;
        let z = if z[0].abs() > 0.05 * largest { below } else { 0.0 };
        Self { z, step, x: whole(x), y: whole(y) }
    }

    fn corners(&self) -> [Vec3; 4] {
        let ([x0, x1], [y0, y1], z) = (self.x, self.y, self.z);
        [Vec3::new(x0, y0, z), Vec3::new(x1, y0, z), Vec3::new(x1, y1, z), Vec3::new(x0, y1, z)]
    }

    fn draw(&self, svg: &mut Svg, view: &Projection) {
        let stroke = Stroke::new(Colour::GRID, 0.8);
        let lines = |[low, high]: [f64; 2]| {
            let count = ((high - low) / self.step).round() as usize;
            (0..=count).map(move |k| low + self.step * k as f64)
        };
        svg.open("floor");
        for x in lines(self.x) {
            let [a, b] = self.y.map(|y| view.place(Vec3::new(x, y, self.z)));
            svg.line(a, b, stroke);
        }
        for y in lines(self.y) {
            let [a, b] = self.x.map(|x| view.place(Vec3::new(x, y, self.z)));
            svg.line(a, b, stroke);
        }
        svg.close();
    }
}

/// Draws the robot into the box with this corner and size.
pub(crate) fn draw(
    svg: &mut Svg,
    drawn: &Drawn<'_>,
    view: Projection,
    (corner, size): (Point, Point),
) {
    let floor = Floor::under(&drawn.points);
    let seen = drawn.points.iter().copied().chain(floor.corners());
    let view = fitted(view, seen, corner, size);

    svg.open("space");
    floor.draw(svg, &view);
    draw_shadows(svg, &drawn.bodies, &floor, &view);
    drawn.draw(svg, &view, ("space", corner, [size[0], size[1] - STRIP]), 3.4);
    drawn.ellipsoids.draw_labels(svg, &view, (corner, [size[0], size[1] - STRIP]));
    svg.close();
    let bottom = corner[1] + size[1];
    draw_scale(svg, floor.step, &view, [corner[0], bottom]);
    let axes = draw_axes(svg, view, [corner[0] + size[0], bottom]);
    drawn.loads.draw_gravity(svg, &view, [axes[0] - GRAVITY, axes[1]]);
}

/// The projection that shows all points in the box, as large as it can be.
fn fitted(
    view: Projection,
    points: impl Iterator<Item = Vec3>,
    corner: Point,
    size: Point,
) -> Projection {
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    for point in points {
        let p = view.plane(point);
        for i in 0..2 {
            (low[i], high[i]) = (low[i].min(p[i]), high[i].max(p[i]));
        }
    }
    let inner = [size[0] - 2.0 * PAD, size[1] - 2.0 * PAD - STRIP];
    let scale = (inner[0] / (high[0] - low[0])).min(inner[1] / (high[1] - low[1]));
    let middle = [0, 1].map(|i| 0.5 * (low[i] + high[i]));
    let origin = [
        corner[0] + 0.5 * size[0] - scale * middle[0],
        corner[1] + PAD + 0.5 * inner[1] + scale * middle[1],
    ];
    view.placed(scale, origin)
}

/// The backbones' shadows on the floor, which show where in depth they are.
fn draw_shadows(svg: &mut Svg, bodies: &Bodies, floor: &Floor, view: &Projection) {
    for (body, look) in bodies.iter().filter(|(_, look)| !look.pale) {
        let points: Vec<Point> = body
            .pieces
            .iter()
            .filter(|piece| piece.part == Part::Backbone)
            .flat_map(|piece| &piece.points)
            .map(|p| view.place(Vec3::new(p.x, p.y, floor.z)))
            .collect();
        let stroke = Stroke::new(look.colour.tint(0.3), 2.0);
        svg.polyline(&scene::simplified(&points, 0.05), stroke, "shadow");
    }
}

/// The directions of x, y and z, with their lower right corner here; returns where they meet.
fn draw_axes(svg: &mut Svg, view: Projection, [right, bottom]: Point) -> Point {
    let axes = [(Vec3::X, "x"), (Vec3::Y, "y"), (Vec3::Z, "z")];
    let view = view.placed(AXIS, [0.0; 2]);
    let lowest = axes.iter().map(|(axis, _)| view.place(*axis)[1]).fold(0.0, f64::max);
    let at = [
        right - AXIS - LETTER - SIZE,
        bottom - lowest - if lowest > 0.0 { LETTER + SIZE } else { 0.0 },
    ];
    let view = view.placed(AXIS, at);
    let stroke = Stroke::new(Colour::INK, 1.0);
    svg.open("directions");
    for (axis, name) in axes {
        let end = view.place(axis);
        let (dx, dy) = (end[0] - at[0], end[1] - at[1]);
        let length = dx.hypot(dy);
        // Seen from its end, an axis has no direction.
        if length < 4.0 {
            continue;
        }
        let (ux, uy) = (dx / length, dy / length);
        svg.line(at, end, stroke);
        let barb =
            |side: f64| [end[0] - 5.0 * ux - side * 2.2 * uy, end[1] - 5.0 * uy + side * 2.2 * ux];
        svg.polyline(&[barb(1.0), end, barb(-1.0)], stroke, "");
        let text = Text::new(name, SIZE).anchor(Anchor::Middle);
        svg.text([end[0] + LETTER * ux, end[1] + LETTER * uy], &text);
    }
    svg.close();
    at
}

/// A bar as long as a square of the floor is wide, or two, and its length.
fn draw_scale(svg: &mut Svg, step: f64, view: &Projection, [left, bottom]: Point) {
    let length = step * view.scale();
    let stroke = Stroke::new(Colour::INK, 1.4);
    let (x, y) = (left + 8.0, bottom - 8.0);
    svg.line([x, y], [x + length, y], stroke);
    for end in [x, x + length] {
        svg.line([end, y - 3.0], [end, y + 3.0], stroke);
    }
    let mm = 1e3 * step;
    let decimals = (-mm.log10().floor()).max(0.0) as usize;
    let label = format!("{mm:.decimals$} mm");
    svg.text([x + length + 8.0, y], &Text::new(&label, 11.0));
}
