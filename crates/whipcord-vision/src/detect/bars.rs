//! Disks from the side: bars across the backbone.
//!
//! A point is the middle of a bar when the way to the edge is as long in one direction as in the opposite one, when
//! what lies across it there is thin, and when beyond both ends there is background over a breadth. That holds for
//! a disk seen from the side and not for the backbone, which goes on. All disks of a robot are about as long, since the
//! longer axis of a circle's image does not depend on how the circle is turned.

use super::background::{Standing, standing};
use super::bar::{Bar, refined};
use super::{DetectError, Mark, Search, usual_radius};
use crate::photo::Photo;
use crate::plane::Plane;

/// Directions that are tried at each point.
const DIRECTIONS: usize = 60;
/// The search begins on a picture shrunk to at most this many pixels a side.
const COARSE: usize = 1200;
/// Least half length of a bar there, in pixels.
const SHORTEST: f64 = 4.0;
/// Greatest ratio of a bar's half thickness to its half length.
const THICKEST: f64 = 0.62;
/// Bars whose length differs by more from the usual one are something else.
const LENGTH_SPREAD: f64 = 0.22;
/// What looks less like a disk than this is none.
const LEAST_CONFIDENCE: f64 = 0.3;
/// Rough places that are refined at most; no robot has so many disks.
const MOST: usize = 600;

pub(super) fn find(photo: &Photo, search: &Search<'_>) -> Result<Vec<Mark>, DetectError> {
    let Standing { share, noise } = standing(photo, search.mask, search.colour)?;
    let factor = photo.width().max(photo.height()).div_ceil(COARSE);
    // Noise must not break an edge: five deviations of what is left of it stay below a half.
    let left = noise / factor as f64;
    let blur = if left < 0.02 { 0.0 } else { (left / 0.09).clamp(0.6, 2.5) };
    let coarse = if factor > 1 { share.shrunk(factor) } else { share.clone() };
    let coarse = if blur > 0.0 { coarse.blurred(blur) } else { coarse };
    let wanted = search.radius.map(|radius| radius / factor as f64);
    let rough = rough_bars(&coarse, wanted);

    // Middles of the coarse pixels, in fine ones.
    let scale = factor as f64;
    let fine = |x: f64| scale * x + 0.5 * (scale - 1.0);
    let mut bars: Vec<Bar> = rough
        .into_iter()
        .map(|bar| Bar {
            centre: bar.centre.map(fine),
            half_length: scale * bar.half_length,
            half_thickness: scale * bar.half_thickness,
            ..bar
        })
        .filter_map(|bar| refined(&share, noise, bar))
        .collect();
    bars.retain(|bar| bar.half_thickness < THICKEST * bar.half_length);
    let lengths: Vec<_> = bars.iter().map(|bar| (bar.half_length, 1.0)).collect();
    let Some(usual) = search.radius.or_else(|| usual_radius(&lengths)) else {
        return Ok(Vec::new());
    };
    let spread = if search.radius.is_some() { 0.34 } else { LENGTH_SPREAD };
    bars.retain(|bar| (bar.half_length / usual).ln().abs() < spread);
    bars.sort_by(|a, b| b.quality(usual).total_cmp(&a.quality(usual)));
    let mut marks: Vec<Mark> = Vec::new();
    for bar in bars {
        let near = |mark: &Mark| distance(mark.pixel, bar.centre);
        // Two bars on one disk meet at its middle; two disks are apart by what they are thick.
        let apart = (0.4 * usual).min(2.0 * bar.half_thickness).max(2.0);
        let sure = bar.quality(usual) >= LEAST_CONFIDENCE;
        if sure && marks.iter().all(|mark| near(mark) > apart) {
            marks.push(Mark {
                pixel: bar.centre,
                radius: bar.half_length,
                axis: bar.axis,
                confidence: bar.quality(usual),
            });
        }
    }
    Ok(marks)
}

pub(super) fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// What stands out, yes or no.
struct Inside {
    width: i32,
    height: i32,
    bits: Vec<bool>,
}

impl Inside {
    fn of(share: &Plane) -> Self {
        let bits = share.values.iter().map(|&value| value > 0.5).collect();
        Self { width: share.width as i32, height: share.height as i32, bits }
    }

    fn has(&self, u: f64, v: f64) -> bool {
        let (i, j) = ((u + 0.5).floor() as i32, (v + 0.5).floor() as i32);
        i >= 0
            && j >= 0
            && i < self.width
            && j < self.height
            && self.bits[(j * self.width + i) as usize]
    }

    /// Whole steps from a place in a direction until there is background; `None` beyond `most`.
    fn way(&self, from: [f64; 2], along: [f64; 2], most: f64) -> Option<f64> {
        let mut steps = 0.0;
        while self.has(from[0] + steps * along[0], from[1] + steps * along[1]) {
            steps += 1.0;
            if steps > most {
                return None;
            }
        }
        Some(steps)
    }
}

/// Bars to a pixel or so, the best first.
fn rough_bars(share: &Plane, wanted: Option<f64>) -> Vec<Bar> {
    let inside = Inside::of(share);
    let longest = match wanted {
        Some(length) => 1.5 * length,
        None => 0.2 * share.width.max(share.height) as f64,
    };
    let shortest = wanted.map_or(SHORTEST, |length| 0.65 * length);
    let axes: Vec<[f64; 2]> = (0..DIRECTIONS)
        .map(|k| core::f64::consts::PI * k as f64 / DIRECTIONS as f64)
        .map(|angle| [angle.cos(), angle.sin()])
        .collect();
    let mut bars: Vec<(f64, Bar)> = Vec::new();
    for row in 0..share.height {
        for column in 0..share.width {
            // Every other place is close enough to each middle.
            if (row + column) % 2 == 1 || !inside.bits[row * share.width + column] {
                continue;
            }
            let centre = [column as f64, row as f64];
            let best = axes
                .iter()
                .filter_map(|&axis| bar_at(&inside, centre, axis, [shortest, longest]))
                .max_by(|a, b| a.0.total_cmp(&b.0));
            bars.extend(best);
        }
    }
    bars.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut kept: Vec<Bar> = Vec::new();
    for (_, bar) in bars {
        let same = |other: &Bar| {
            let ratio = other.half_length / bar.half_length;
            (0.6..1.6).contains(&ratio)
                && distance(other.centre, bar.centre)
                    < (0.35 * bar.half_length).min(1.5 * bar.half_thickness + 1.0)
        };
        if kept.len() < MOST && !kept.iter().any(same) {
            kept.push(bar);
        }
    }
    kept
}

/// The bar whose middle this place is, in this direction, and how good a bar it is; if it is one.
fn bar_at(
    inside: &Inside,
    centre: [f64; 2],
    axis: [f64; 2],
    [shortest, longest]: [f64; 2],
) -> Option<(f64, Bar)> {
    let back = axis.map(|a| -a);
    let forward = inside.way(centre, axis, longest)?;
    let backward = inside.way(centre, back, longest)?;
    let half_length = 0.5 * (forward + backward) - 0.5;
    let uneven = (forward - backward).abs();
    if half_length < shortest || uneven > (0.08 * half_length).max(1.0) {
        return None;
    }
    let across = [-axis[1], axis[0]];
    let at = |u: f64, v: f64| {
        [centre[0] + u * axis[0] + v * across[0], centre[1] + u * axis[1] + v * across[1]]
    };
    // What the wings are thick, on both sides of the middle.
    let most = (THICKEST * half_length).max(2.0);
    let mut sum = 0.0;
    for u in [-0.8, -0.6, -0.45, 0.45, 0.6, 0.8] {
        let wing = at(u * half_length, 0.0);
        if !inside.has(wing[0], wing[1]) {
            return None;
        }
        let thickness =
            inside.way(wing, across, most)? + inside.way(wing, across.map(|a| -a), most)?;
        sum += (0.5 * (thickness - 1.0)).min(most);
    }
    let half_thickness = (sum / 6.0).max(0.5);
    if half_thickness > THICKEST * half_length {
        return None;
    }
    // Nothing beyond the ends, over a breadth.
    let beyond = half_length + (0.15 * half_length).max(2.0);
    let breadth = (0.25 * half_length).max(half_thickness);
    for side in [-1.0, 1.0] {
        for part in [-1.0, -0.5, 0.0, 0.5, 1.0] {
            let [u, v] = at(side * beyond, part * breadth);
            if inside.has(u, v) {
                return None;
            }
        }
    }
    let quality = half_length / (half_thickness + 0.5) / (1.0 + uneven);
    let bar = Bar { centre, axis, half_length, half_thickness, ..Bar::default() };
    Some((quality, bar))
}
