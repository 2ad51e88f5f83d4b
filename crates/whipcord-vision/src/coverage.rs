//! How much of each pixel a polygon covers, exactly.

use crate::photo::Photo;

/// Draws polygons with exact coverage, so that what is drawn lies where its corners say to a small part of
/// a pixel.
///
/// An edge crosses pixels. Of its height `h` inside one, all pixels to the right gain `h`, signed by whether it goes
/// up or down, and the pixel itself the share of it that lies right of the edge. Sums along a row are the covered
/// areas.
#[derive(Debug, Default)]
pub(crate) struct Coverage {
    left: usize,
    top: usize,
    width: usize,
    height: usize,
    gains: Vec<f64>,
}

impl Coverage {
    /// Draws the closed polygon in a colour of linear light.
    pub fn paint(&mut self, photo: &mut Photo, corners: &[[f64; 2]], colour: [f32; 3]) {
        let (width, height) = (photo.width(), photo.height());
        let pixels = photo.pixels_mut();
        self.fill(corners, width, height, |i, covered| {
            for (channel, new) in pixels[i].iter_mut().zip(colour) {
                *channel += (new - *channel) * covered as f32;
            }
        });
    }

    /// Calls `paint` with the index of each pixel of a `width`×`height` picture that the closed polygon touches,
    /// and with how much of it is covered. Corners are in pixels, the centre of the first one at (0, 0).
    fn fill(
        &mut self,
        corners: &[[f64; 2]],
        width: usize,
        height: usize,
        mut paint: impl FnMut(usize, f64),
    ) {
        if !self.frame(corners, width, height) {
            return;
        }
        let (x0, y0) = (self.left as f64 - 0.5, self.top as f64 - 0.5);
        let local = |p: [f64; 2]| [p[0] - x0, p[1] - y0];
        for (i, &from) in corners.iter().enumerate() {
            self.edge(local(from), local(corners[(i + 1) % corners.len()]));
        }
        for row in 0..self.height {
            let mut sum = 0.0;
            for column in 0..self.width {
                sum += self.gains[row * (self.width + 1) + column];
                // The sense of the corners decides the sign; what is left of it beyond the polygon is rounding.
                let covered = f64::abs(sum).min(1.0);
                if covered > 1e-9 {
                    paint((self.top + row) * width + self.left + column, covered);
                }
            }
        }
    }

    /// Makes room for the part of the picture that the corners span; `false` where there is none.
    fn frame(&mut self, corners: &[[f64; 2]], width: usize, height: usize) -> bool {
        let span = |axis: usize, size: usize| {
            let values = || corners.iter().map(|p| p[axis] + 0.5);
            let first = values().fold(f64::INFINITY, f64::min).floor().clamp(0.0, size as f64);
            let last = values().fold(f64::NEG_INFINITY, f64::max).ceil().clamp(0.0, size as f64);
            (first as usize, (last as usize).saturating_sub(first as usize))
        };
        (self.left, self.width) = span(0, width);
        (self.top, self.height) = span(1, height);
        self.gains.clear();
        self.gains.resize((self.width + 1) * self.height, 0.0);
        self.width > 0 && self.height > 0
    }

    fn edge(&mut self, from: [f64; 2], to: [f64; 2]) {
        let (sign, upper, lower) =
            if from[1] <= to[1] { (1.0, from, to) } else { (-1.0, to, from) };
        let slope = (lower[0] - upper[0]) / (lower[1] - upper[1]);
        if !slope.is_finite() {
            return;
        }
        let top = upper[1].max(0.0);
        let bottom = lower[1].min(self.height as f64);
        let mut y = top;
        while y < bottom {
            let row = y as usize;
            let end = bottom.min((row + 1) as f64);
            let x = |y: f64| upper[0] + slope * (y - upper[1]);
            self.across(row, sign * (end - y), x(y), x(end));
            y = end;
        }
    }

    /// The part of an edge inside one row: `height` of it, from column `a` to column `b`.
    fn across(&mut self, row: usize, height: f64, a: f64, b: f64) {
        let most = self.width as f64;
        let (a, b) = (a.min(b), a.max(b));
        let start = row * (self.width + 1);
        let gains = &mut self.gains[start..=start + self.width];
        // Left of the frame an edge counts for the whole row, right of it for nothing.
        let share = |x: f64| if b > a { (x - a) / (b - a) } else { 1.0 };
        if a < 0.0 {
            gains[0] += height * share(b.min(0.0));
        }
        let (mut x, end) = (a.max(0.0), b.min(most));
        if x == end && x < most {
            let column = x as usize;
            let right = 1.0 - (x - column as f64);
            gains[column] += height * right;
            gains[column + 1] += height * (1.0 - right);
            return;
        }
        while x < end {
            let column = x as usize;
            let next = end.min((column + 1) as f64);
            let part = height * (next - x) / (b - a);
            let right = 1.0 - (0.5 * (x + next) - column as f64);
            gains[column] += part * right;
            gains[column + 1] += part * (1.0 - right);
            x = next;
        }
    }
}

/// The convex hull of points, as corners in order (Andrew's monotone chain).
pub(crate) fn convex_hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let turns_left = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0.0
    };
    let mut hull: Vec<[f64; 2]> = Vec::new();
    let half = |hull: &mut Vec<[f64; 2]>, from: usize, point: [f64; 2]| {
        while hull.len() >= from + 2
            && !turns_left(hull[hull.len() - 2], hull[hull.len() - 1], point)
        {
            hull.pop();
        }
        hull.push(point);
    };
    for &point in &points {
        half(&mut hull, 0, point);
    }
    let lower = hull.len().saturating_sub(1);
    for &point in points.iter().rev() {
        half(&mut hull, lower, point);
    }
    hull.pop();
    hull
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(corners: &[[f64; 2]], width: usize, height: usize) -> Vec<f64> {
        let mut out = vec![0.0; width * height];
        Coverage::default().fill(corners, width, height, |i, covered| out[i] += covered);
        out
    }

    #[test]
    fn a_rectangle_covers_its_part_of_each_pixel() {
        // From a quarter of the first pixel to half of the third, over 0.8 of the second row.
        let (l, r, t, b) = (-0.25, 2.0, 0.6, 1.4);
        let covered = drawn(&[[l, t], [r, t], [r, b], [l, b]], 4, 3);
        let expected = [0.0, 0.0, 0.0, 0.0, 0.6, 0.8, 0.4, 0.0, 0.0, 0.0, 0.0, 0.0];
        for (got, want) in covered.iter().zip(expected) {
            assert!((got - want).abs() < 1e-12, "{covered:?}");
        }
    }

    /// Area and first moments of a polygon, by the shoelace formulas.
    #[test]
    fn area_and_centroid_are_those_of_the_polygon() {
        let corners: Vec<[f64; 2]> = (0..24)
            .map(|i| f64::from(i) * core::f64::consts::TAU / 24.0)
            .map(|a| [20.3 + 7.7 * a.cos() - 3.0 * a.sin(), 15.6 + 2.9 * a.sin()])
            .collect();
        let covered = drawn(&corners, 48, 32);
        let area: f64 = covered.iter().sum();
        let column: f64 = covered.iter().enumerate().map(|(i, c)| c * (i % 48) as f64).sum();
        let row: f64 = covered.iter().enumerate().map(|(i, c)| c * (i / 48) as f64).sum();
        let mut expected = 0.0;
        for (i, a) in corners.iter().enumerate() {
            let b = corners[(i + 1) % corners.len()];
            expected += 0.5 * (a[0] * b[1] - a[1] * b[0]);
        }
        assert!((area - expected).abs() < 1e-9, "{area} {expected}");
        // Each pixel counts at its own centre, so that moments are true to a small part of a pixel.
        assert!((column / area - 20.3).abs() < 0.01, "{}", column / area);
        assert!((row / area - 15.6).abs() < 0.01, "{}", row / area);
    }

    #[test]
    fn what_lies_outside_is_cut_off() {
        let corners = [[-10.0, -10.0], [30.0, -10.0], [30.0, 30.0], [-10.0, 30.0]];
        assert!(drawn(&corners, 5, 4).iter().all(|c| (c - 1.0).abs() < 1e-12));
        let beyond = [[8.0, 1.0], [9.0, 1.0], [9.0, 2.0]];
        assert!(drawn(&beyond, 5, 4).iter().all(|&c| c == 0.0));
    }
}
