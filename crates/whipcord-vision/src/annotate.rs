//! A photograph with what was found drawn into it.

use crate::coverage::Coverage;
use crate::detect::{Kind, Mark};
use crate::photo::Photo;

/// Colours in linear light: the row of marks, their numbers, and the edge that sets both off.
const LINE: [f32; 3] = [0.02, 0.33, 0.85];
const CROSS: [f32; 3] = [0.85, 0.08, 0.02];
const INK: [f32; 3] = [0.02, 0.02, 0.02];
const HALO: [f32; 3] = [1.0, 1.0, 1.0];

/// The photograph with each mark, its number, and the row from the first to the last.
#[must_use]
pub fn annotated(photo: &Photo, kind: Kind, marks: &[(usize, Mark)]) -> Photo {
    let mut pen = Pen { photo: photo.clone(), coverage: Coverage::default() };
    // As large as suits the picture, so that numbers can be read and marks are not hidden.
    let unit = (photo.width().max(photo.height()) as f64 / 1100.0).clamp(0.5, 4.0);
    for pair in marks.windows(2) {
        pen.line(pair[0].1.pixel, pair[1].1.pixel, 1.2 * unit, LINE);
    }
    for (_, mark) in marks {
        let [a, b] = mark.axis;
        let at = |u: f64, v: f64| [mark.pixel[0] + u * a - v * b, mark.pixel[1] + u * b + v * a];
        let r = mark.radius;
        if kind == Kind::Disks {
            pen.line(at(-r, 0.0), at(r, 0.0), 1.2 * unit, CROSS);
            for end in [-r, r] {
                pen.line(at(end, -4.0 * unit), at(end, 4.0 * unit), 1.2 * unit, CROSS);
            }
        } else {
            let steps = 48;
            let point = |i: usize| {
                let angle = core::f64::consts::TAU * i as f64 / f64::from(steps);
                [
                    mark.pixel[0] + (r + 2.0 * unit) * angle.cos(),
                    mark.pixel[1] + (r + 2.0 * unit) * angle.sin(),
                ]
            };
            (0..48).for_each(|i| pen.line(point(i), point(i + 1), 1.2 * unit, CROSS));
        }
        let arm = 3.5 * unit;
        pen.line(at(-arm, 0.0), at(arm, 0.0), 0.8 * unit, HALO);
        pen.line(at(0.0, -arm), at(0.0, arm), 0.8 * unit, HALO);
    }
    for (i, (number, mark)) in marks.iter().enumerate() {
        // Beside the mark, where the row does not run: along a disk, across the row else.
        let before = marks[i.saturating_sub(1)].1.pixel;
        let after = marks[(i + 1).min(marks.len() - 1)].1.pixel;
        let (x, y) = (after[0] - before[0], after[1] - before[1]);
        let length = x.hypot(y);
        let mut aside = if length > 0.0 { [y / length, -x / length] } else { [0.0, -1.0] };
        if kind == Kind::Disks {
            let same = aside[0] * mark.axis[0] + aside[1] * mark.axis[1];
            aside = if same < 0.0 { mark.axis.map(|a| -a) } else { mark.axis };
        }
        let away = mark.radius + 17.0 * unit;
        let centre = [0, 1].map(|k| mark.pixel[k] + away * aside[k]);
        pen.number(*number, centre, 15.0 * unit);
    }
    pen.photo
}

struct Pen {
    photo: Photo,
    coverage: Coverage,
}

impl Pen {
    /// A straight line, half of its thickness longer at both ends.
    fn line(&mut self, from: [f64; 2], to: [f64; 2], thickness: f64, colour: [f32; 3]) {
        let (x, y) = (to[0] - from[0], to[1] - from[1]);
        let length = x.hypot(y);
        if length == 0.0 {
            return;
        }
        let half = 0.5 * thickness / length;
        let (a, b) = (x * half, y * half);
        let corners = [
            [from[0] - a - b, from[1] - b + a],
            [to[0] + a - b, to[1] + b + a],
            [to[0] + a + b, to[1] + b - a],
            [from[0] - a + b, from[1] - b - a],
        ];
        self.coverage.paint(&mut self.photo, &corners, colour);
    }

    /// A number of this height about a centre.
    fn number(&mut self, number: usize, centre: [f64; 2], height: f64) {
        let text = number.to_string();
        let (width, gap) = (0.55 * height, 0.25 * height);
        let whole = text.len() as f64 * (width + gap) - gap;
        for (thickness, colour) in [(0.34 * height, HALO), (0.13 * height, INK)] {
            let mut left = centre[0] - 0.5 * whole;
            for digit in text.chars().filter_map(|c| c.to_digit(10)) {
                let place = |[x, y]: [f64; 2]| [left + x * width, centre[1] + (y - 0.5) * height];
                for stroke in STROKES[digit as usize] {
                    for pair in stroke.windows(2) {
                        self.line(place(pair[0]), place(pair[1]), thickness, colour);
                    }
                }
                left += width + gap;
            }
        }
    }
}

/// The strokes of the digits in a unit square, y down.
const STROKES: [&[&[[f64; 2]]]; 10] = [
    &[&[
        [0.3, 0.0],
        [0.7, 0.0],
        [1.0, 0.25],
        [1.0, 0.75],
        [0.7, 1.0],
        [0.3, 1.0],
        [0.0, 0.75],
        [0.0, 0.25],
        [0.3, 0.0],
    ]],
    &[&[[0.15, 0.22], [0.55, 0.0], [0.55, 1.0]]],
    &[&[[0.0, 0.2], [0.3, 0.0], [0.7, 0.0], [1.0, 0.22], [0.95, 0.45], [0.0, 1.0], [1.0, 1.0]]],
    &[&[
        [0.0, 0.12],
        [0.35, 0.0],
        [0.75, 0.0],
        [1.0, 0.22],
        [0.75, 0.46],
        [0.4, 0.46],
        [0.75, 0.46],
        [1.0, 0.72],
        [0.75, 1.0],
        [0.35, 1.0],
        [0.0, 0.88],
    ]],
    &[&[[0.75, 1.0], [0.75, 0.0], [0.0, 0.7], [1.0, 0.7]]],
    &[&[
        [0.95, 0.0],
        [0.1, 0.0],
        [0.05, 0.45],
        [0.6, 0.4],
        [1.0, 0.68],
        [0.7, 1.0],
        [0.3, 1.0],
        [0.0, 0.88],
    ]],
    &[&[
        [0.85, 0.05],
        [0.5, 0.0],
        [0.15, 0.25],
        [0.0, 0.65],
        [0.3, 1.0],
        [0.7, 1.0],
        [1.0, 0.7],
        [0.7, 0.43],
        [0.3, 0.43],
        [0.0, 0.65],
    ]],
    &[&[[0.0, 0.0], [1.0, 0.0], [0.35, 1.0]]],
    &[&[
        [0.3, 0.46],
        [0.05, 0.22],
        [0.3, 0.0],
        [0.7, 0.0],
        [0.95, 0.22],
        [0.7, 0.46],
        [0.3, 0.46],
        [0.0, 0.72],
        [0.3, 1.0],
        [0.7, 1.0],
        [1.0, 0.72],
        [0.7, 0.46],
    ]],
    &[&[
        [1.0, 0.35],
        [0.7, 0.57],
        [0.3, 0.57],
        [0.0, 0.3],
        [0.3, 0.0],
        [0.7, 0.0],
        [1.0, 0.35],
        [0.85, 0.75],
        [0.5, 1.0],
        [0.15, 0.95],
    ]],
];
