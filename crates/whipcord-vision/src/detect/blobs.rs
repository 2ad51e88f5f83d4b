//! Small round spots.
//!
//! The picture is cut at many levels. What is connected, of the area of an ellipse with its second moments, and not
//! too long, is a spot; the level at which it is cleanest counts. Its centre is the centroid of how far each pixel
//! stands between what surrounds the spot and what the spot is.

use std::borrow::Cow;

use super::background::{Background, noise, standing};
use super::bars::distance;
use super::{DetectError, Mark, Mask, Search, luminance, usual_radius};
use crate::photo::{Photo, linear};
use crate::plane::Plane;

/// Levels that the picture is cut at.
const LEVELS: usize = 24;
/// Least area in pixels.
const LEAST_AREA: usize = 12;
/// Greatest radius as a part of the longer side, where no radius is given.
const GREATEST: f64 = 0.05;
/// Least ratio of the axes: a disk seen at 60° still is a spot.
const NARROWEST: f64 = 0.45;
/// Range of the ratio of the area to that of the ellipse with the same moments.
const FULLNESS: [f64; 2] = [0.93, 1.08];
/// Spots whose radius differs by more from the usual one are something else.
const RADIUS_SPREAD: f64 = 0.5;

/// Noise beside the light that is the middle one at which colours are looked at pixel by pixel.
const QUIET: f64 = 0.07;

/// Dots of one colour.
pub(super) fn dots(photo: &Photo, search: &Search<'_>) -> Result<Vec<Mark>, DetectError> {
    let (photo, spread) = calmed(photo);
    let photo = photo.as_ref();
    let colour = match search.colour {
        Some(colour) => colour,
        None => vivid(photo, search.mask)?,
    };
    let share = standing(photo, search.mask, Some(colour))?.share;
    // A blur of deviation σ leaves one independent value for each 4πσ² pixels.
    let noise = noise(&share, 5) * (2.0 * core::f64::consts::PI.sqrt() * spread).max(1.0);
    Ok(usual(spots(&share, noise, 0.3, search), search))
}

/// The photograph, blurred so far that noise leaves colours what they are: under strong noise each pixel has another. With the
/// deviation of that blur.
fn calmed(photo: &Photo) -> (Cow<'_, Photo>, f64) {
    let light = luminance(photo);
    let middle = super::median(&mut light.values.clone());
    let relative = noise(&light, 1) / f64::from(middle).max(1e-3);
    if relative < QUIET {
        return (Cow::Borrowed(photo), 0.0);
    }
    let mut calm = photo.clone();
    let spread = (relative / QUIET).clamp(1.0, 2.0);
    calm.change_channels(|plane| plane.blurred(spread));
    (Cow::Owned(calm), spread)
}

/// Spots that are darker or lighter than what is around them; which, most of them decide.
pub(super) fn circles(photo: &Photo, search: &Search<'_>) -> Result<Vec<Mark>, DetectError> {
    let mut light = match search.colour {
        Some(colour) => standing(photo, search.mask, Some(colour))?.share,
        None => luminance(photo),
    };
    if let Some(mask) = search.mask {
        // What is outside the mask is as what surrounds it: nothing begins at the mask's edge.
        let mut inside: Vec<f32> = (0..light.values.len())
            .filter(|i| mask.contains(i % light.width, i / light.width))
            .map(|i| light.values[i])
            .collect();
        let middle = super::median(&mut inside);
        for i in 0..light.values.len() {
            if !mask.contains(i % light.width, i / light.width) {
                light.values[i] = middle;
            }
        }
    }
    let noise = noise(&light, 1);
    let dark = Plane { values: light.values.iter().map(|v| 1.0 - v).collect(), ..light };
    let light = Plane { values: dark.values.iter().map(|v| 1.0 - v).collect(), ..dark };
    let found = [dark, light].map(|plane| usual(spots(&plane, noise, 0.08, search), search));
    let [dark, light] = found;
    let weight = |marks: &[Mark]| marks.iter().map(|mark| mark.confidence).sum::<f64>();
    Ok(if weight(&light) > weight(&dark) { light } else { dark })
}

/// The most vivid colour that is not the background's.
fn vivid(photo: &Photo, mask: Option<&Mask>) -> Result<[f32; 3], DetectError> {
    const HUES: usize = 24;
    let background = Background::of(photo, mask);
    let width = photo.width();
    let mut weights = [0.0; HUES];
    let mut sums = [[0.0; 3]; HUES];
    for (i, pixel) in photo.pixels().iter().enumerate() {
        let (column, row) = (i % width, i / width);
        if mask.is_some_and(|mask| !mask.contains(column, row)) {
            continue;
        }
        let behind = background.at(column, row);
        let white = behind.iter().sum::<f64>() / 3.0;
        let balanced: [f64; 3] = core::array::from_fn(|c| f64::from(pixel[c]) * white / behind[c]);
        let most = balanced.iter().copied().fold(0.0, f64::max);
        let least = balanced.iter().copied().fold(f64::INFINITY, f64::min);
        // Vivid: little of the weakest channel, and bright enough to be told from noise.
        if most > 0.12 * white.max(0.05) && least < 0.5 * most {
            let [r, g, b] = balanced;
            let hue = (3.0_f64.sqrt() * (g - b)).atan2(2.0 * r - g - b);
            let turn = hue.rem_euclid(core::f64::consts::TAU) / core::f64::consts::TAU;
            let bin = ((turn * HUES as f64) as usize).min(HUES - 1);
            let weight = (most - least).powi(2);
            weights[bin] += weight;
            for (sum, value) in sums[bin].iter_mut().zip(pixel) {
                *sum += weight * f64::from(*value);
            }
        }
    }
    let three = |k: usize| [k, (k + 1) % HUES, (k + HUES - 1) % HUES];
    let mass = |k: usize| three(k).iter().map(|&i| weights[i]).sum::<f64>();
    let best = (0..HUES).max_by(|&a, &b| mass(a).total_cmp(&mass(b))).unwrap_or(0);
    // A few dozen vivid pixels make a dot.
    if mass(best) < 0.5 {
        return Err(DetectError::NoVividColour);
    }
    let colour: [f64; 3] =
        core::array::from_fn(|c| three(best).iter().map(|&i| sums[i][c]).sum::<f64>() / mass(best));
    Ok(colour.map(|c| c as f32))
}

/// Of what was found, what has the usual size.
fn usual(mut marks: Vec<Mark>, search: &Search<'_>) -> Vec<Mark> {
    let sizes: Vec<_> = marks.iter().map(|mark| (mark.radius, mark.confidence)).collect();
    let Some(usual) = search.radius.or_else(|| usual_radius(&sizes)) else { return marks };
    marks.retain_mut(|mark| {
        let off = (mark.radius / usual).ln().abs();
        mark.confidence *= (-0.5 * (off / 0.25).powi(2)).exp();
        off < RADIUS_SPREAD
    });
    marks
}

/// A connected part above a level.
struct Spot {
    centre: [f64; 2],
    /// Half axes of the ellipse with its moments, the greater first.
    radii: [f64; 2],
    axis: [f64; 2],
    fullness: f64,
}

/// All spots that are higher than what is around them by `least`.
fn spots(plane: &Plane, noise: f64, least: f64, search: &Search<'_>) -> Vec<Mark> {
    let greatest = match search.radius {
        Some(radius) => 1.6 * radius,
        None => GREATEST * plane.width.max(plane.height) as f64,
    };
    let blur = if noise < 0.01 { 0.7 } else { 1.0 };
    let smooth = plane.blurred(blur);
    let mut values = smooth.values.clone();
    let (low, high) = (super::quantile(&mut values, 0.001), super::quantile(&mut values, 0.9999));
    let mut best: Vec<(Spot, f64, usize)> = Vec::new();
    let mut seen = vec![usize::MAX; smooth.values.len()];
    for level in 0..LEVELS {
        let cut = low + (high - low) * (level as f32 + 0.5) / LEVELS as f32;
        for spot in components(&smooth, cut, level, &mut seen, greatest) {
            let clean = cleanness(&spot);
            let near = best
                .iter_mut()
                .find(|(other, ..)| distance(other.centre, spot.centre) < other.radii[0]);
            match near {
                Some((other, before, times)) => {
                    *times += 1;
                    if clean > *before {
                        (*other, *before) = (spot, clean);
                    }
                }
                None => best.push((spot, clean, 1)),
            }
        }
    }
    best.retain(|(_, _, times)| *times >= 2);
    let mut marks: Vec<Mark> = Vec::new();
    for (spot, clean, _) in best {
        let Some(mark) = refined(plane, noise, least, &spot, clean) else { continue };
        if marks.iter().all(|other| distance(other.pixel, mark.pixel) > 0.8 * mark.radius) {
            marks.push(mark);
        }
    }
    marks
}

/// 1 for a full circle.
fn cleanness(spot: &Spot) -> f64 {
    let full = (-0.5 * ((spot.fullness - 1.0) / 0.04).powi(2)).exp();
    full * (spot.radii[1] / spot.radii[0]).sqrt()
}

/// Round parts above the level. `seen` remembers at which level a pixel was last looked at.
fn components(
    plane: &Plane,
    cut: f32,
    level: usize,
    seen: &mut [usize],
    greatest: f64,
) -> Vec<Spot> {
    let (width, height) = (plane.width, plane.height);
    let most_area = (4.0 * greatest * greatest) as usize;
    let mut spots = Vec::new();
    let mut members: Vec<usize> = Vec::new();
    for start in 0..plane.values.len() {
        if plane.values[start] <= cut || seen[start] == level {
            continue;
        }
        members.clear();
        members.push(start);
        seen[start] = level;
        let mut next = 0;
        let mut at_edge = false;
        while next < members.len() {
            let (i, j) = (members[next] % width, members[next] / width);
            next += 1;
            at_edge |= i == 0 || j == 0 || i + 1 == width || j + 1 == height;
            let mut visit = |index: usize| {
                if plane.values[index] > cut && seen[index] != level {
                    seen[index] = level;
                    members.push(index);
                }
            };
            if i > 0 {
                visit(j * width + i - 1);
            }
            if i + 1 < width {
                visit(j * width + i + 1);
            }
            if j > 0 {
                visit((j - 1) * width + i);
            }
            if j + 1 < height {
                visit((j + 1) * width + i);
            }
        }
        if !at_edge && (LEAST_AREA..=most_area).contains(&members.len()) {
            spots.extend(spot(&members, width).filter(|spot| spot.radii[0] <= greatest));
        }
    }
    spots
}

/// The ellipse of these pixels, if they fill it.
fn spot(members: &[usize], width: usize) -> Option<Spot> {
    let area = members.len() as f64;
    let places = || members.iter().map(|&i| [(i % width) as f64, (i / width) as f64]);
    let mut centre = [0.0; 2];
    places().for_each(|p| (0..2).for_each(|k| centre[k] += p[k] / area));
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for [u, v] in places() {
        let (x, y) = (u - centre[0], v - centre[1]);
        xx += x * x / area;
        xy += x * y / area;
        yy += y * y / area;
    }
    // Each pixel is a square of second moment 1/12.
    (xx, yy) = (xx + 1.0 / 12.0, yy + 1.0 / 12.0);
    let (mean, difference) = (0.5 * (xx + yy), 0.5 * (xx - yy));
    let root = difference.hypot(xy);
    // The half axes of a full ellipse are twice the deviations.
    let radii = [2.0 * (mean + root).sqrt(), 2.0 * (mean - root).max(0.0).sqrt()];
    let angle = 0.5 * xy.atan2(difference);
    let fullness = area / (core::f64::consts::PI * radii[0] * radii[1]).max(1e-9);
    let round = radii[1] >= NARROWEST * radii[0];
    let full = (FULLNESS[0]..=FULLNESS[1]).contains(&fullness);
    (round && full).then(|| Spot { centre, radii, axis: [angle.cos(), angle.sin()], fullness })
}

/// The spot's centre to a fraction of a pixel; `None` when it does not stand out enough.
fn refined(plane: &Plane, noise: f64, least: f64, spot: &Spot, clean: f64) -> Option<Mark> {
    let around = |from: f64, to: f64, centre: [f64; 2]| -> Vec<([f64; 2], f32)> {
        let reach = to * spot.radii[0] + 3.0;
        let first = |c: f64| (c - reach).max(0.0).ceil() as usize;
        let last = |c: f64, n: usize| ((c + reach).floor().max(0.0) as usize).min(n - 1);
        let mut out = Vec::new();
        for row in first(centre[1])..=last(centre[1], plane.height) {
            for column in first(centre[0])..=last(centre[0], plane.width) {
                let place = [column as f64, row as f64];
                // In radii of the ellipse, with two pixels for its blurred edge.
                let (x, y) = (place[0] - centre[0], place[1] - centre[1]);
                let along = x * spot.axis[0] + y * spot.axis[1];
                let across = y * spot.axis[0] - x * spot.axis[1];
                let away = (along / spot.radii[0]).hypot(across / spot.radii[1]);
                if away >= from && away < to {
                    out.push((place, plane.get(column, row)));
                }
            }
        }
        out
    };
    let mut inner: Vec<f32> = around(0.0, 0.6, spot.centre).into_iter().map(|(_, v)| v).collect();
    let edge = 1.0 + 2.0 / spot.radii[1].max(1.0);
    let mut outer: Vec<f32> =
        around(edge, edge + 0.5, spot.centre).into_iter().map(|(_, v)| v).collect();
    if inner.is_empty() || outer.is_empty() {
        return None;
    }
    let (top, bottom) =
        (f64::from(super::median(&mut inner)), f64::from(super::median(&mut outer)));
    let contrast = top - bottom;
    // Nine deviations of the mean over the middle: of all places in pure noise some have five.
    let sure = 9.0 * noise / (inner.len() as f64).sqrt();
    if contrast < least.max(2.0 * noise).max(sure) {
        return None;
    }
    let mut centre = spot.centre;
    let mut area = 0.0;
    for _ in 0..4 {
        let (mut mass, mut sums) = (0.0, [0.0; 2]);
        for (place, value) in around(0.0, edge, centre) {
            let share = (f64::from(value) - bottom) / contrast;
            // Steep, so that what is around the spot may vary by a third of its contrast.
            let weight = ((share - 0.35) / 0.3).clamp(0.0, 1.0);
            mass += weight;
            (0..2).for_each(|k| sums[k] += weight * (place[k] - centre[k]));
        }
        if mass < 0.3 * LEAST_AREA as f64 {
            return None;
        }
        (0..2).for_each(|k| centre[k] += sums[k] / mass);
        area = mass;
    }
    if distance(centre, spot.centre) > 0.5 * spot.radii[0] + 1.0 {
        return None;
    }
    // A spot that runs into something as bright is no whole one.
    let joined = outer.iter().filter(|&&v| f64::from(v) > bottom + 0.5 * contrast).count();
    let alone = 1.0 - 2.5 * joined as f64 / outer.len() as f64;
    if alone <= 0.0 {
        return None;
    }
    let strong = 1.0 - (-0.5 * (contrast / (5.0 * noise.max(1e-3)) - 1.0).max(0.0)).exp();
    // The level that a spot was cleanest at says little of its size; the area at half of its contrast does.
    let radius = (area / core::f64::consts::PI * spot.radii[0] / spot.radii[1]).sqrt();
    Some(Mark { pixel: centre, radius, axis: spot.axis, confidence: clean * strong * alone })
}

/// Linear light of a colour of eight bits a channel, as on the web.
#[must_use]
pub fn colour(rgb: [u8; 3]) -> [f32; 3] {
    rgb.map(|value| linear(f32::from(value) / 255.0))
}
