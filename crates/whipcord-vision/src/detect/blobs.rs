//! Small round spots.
//!
//! The picture is cut at many levels. What is connected, of the area of an ellipse with its second moments, and not
//! too long, is a spot; the level at which it is cleanest counts. Its centre is the centroid of how far each pixel
//! stands between what surrounds the spot and what the spot is.

use std::borrow::Cow;

use super::background::{Background, noise, standing};
use super::bars::distance;
use super::components::{Component, components};
use super::{
    DetectError, Mark, Mask, Search, luminance, median, median_of, quantile_of, usual_radius,
};
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
    let (share, spread) = {
        // The calm copy of the photograph takes as much memory as all that follows.
        let (photo, spread) = calmed(photo);
        let colour = match search.colour {
            Some(colour) => colour,
            None => vivid(&photo, search.mask)?,
        };
        (standing(&photo, search.mask, Some(colour))?.share, spread)
    };
    // A blur of deviation σ leaves one independent value for each 4πσ² pixels.
    let noise = noise(&share, 5) * (2.0 * core::f64::consts::PI.sqrt() * spread).max(1.0);
    Ok(usual(spots(&share, noise, 0.3, search), search))
}

/// The photograph, blurred so far that noise leaves colours what they are: under strong noise each pixel has another. With the
/// deviation of that blur.
fn calmed(photo: &Photo) -> (Cow<'_, Photo>, f64) {
    let relative = {
        let light = luminance(photo);
        let middle = median_of(|| light.values.iter().copied());
        noise(&light, 1) / f64::from(middle).max(1e-3)
    };
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
        let is_inside = |i: usize| mask.contains(i % light.width, i / light.width);
        let all = || light.values.iter().copied().enumerate();
        let middle = median_of(|| all().filter(|&(i, _)| is_inside(i)).map(|(_, value)| value));
        let (width, values) = (light.width, light.values.iter_mut().enumerate());
        for (_, value) in values.filter(|(i, _)| !mask.contains(i % width, i / width)) {
            *value = middle;
        }
    }
    let noise = noise(&light, 1);
    // The dark ones as light ones of the negative, and then the others.
    let [dark, light] = core::array::from_fn(|_| {
        light.values.iter_mut().for_each(|value| *value = 1.0 - *value);
        usual(spots(&light, noise, 0.08, search), search)
    });
    let weight = |marks: &[Mark]| marks.iter().map(|mark| mark.confidence).sum::<f64>();
    Ok(if weight(&light) > weight(&dark) { light } else { dark })
}

/// The most vivid colour that is not the background's.
fn vivid(photo: &Photo, mask: Option<&Mask>) -> Result<[f32; 3], DetectError> {
    const HUES: usize = 24;
    let background = Background::of(photo, mask);
    let mut weights = [0.0; HUES];
    let mut sums = [[0.0; 3]; HUES];
    let rows = photo.pixels().chunks_exact(photo.width()).enumerate();
    let pixels = rows.flat_map(|(row, pixels)| {
        let behind = background.along(row);
        let seen =
            move |&(column, _): &(usize, _)| mask.is_none_or(|mask| mask.contains(column, row));
        let pixels = pixels.iter().enumerate().filter(seen);
        pixels.map(move |(column, pixel)| (pixel, behind(column)))
    });
    for (pixel, behind) in pixels {
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

/// A component above a level, as the ellipse that it fills.
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
    let smooth = plane.clone().blurred(blur);
    let [low, high] =
        [0.001, 0.9999].map(|share| quantile_of(|| smooth.values.iter().copied(), share));
    let most_area = (4.0 * greatest * greatest) as u64;
    let is_candidate =
        |part: &Component| !part.at_edge && (LEAST_AREA as u64..=most_area).contains(&part.area);
    let mut best: Vec<(Spot, f64, usize)> = Vec::new();
    for level in 0..LEVELS {
        let cut = low + (high - low) * (level as f32 + 0.5) / LEVELS as f32;
        let spots =
            components(&smooth, cut, is_candidate).into_iter().filter_map(|part| spot(&part));
        for spot in spots.filter(|spot| spot.radii[0] <= greatest) {
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

/// The ellipse of a component, if it fills it.
fn spot(part: &Component) -> Option<Spot> {
    let area = part.area as f64;
    let centre = part.centre();
    let [mut xx, xy, mut yy] = part.moments();
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
    let around = |from: f64, to: f64, centre: [f64; 2]| {
        let reach = to * spot.radii[0] + 3.0;
        let range = move |c: f64, n: usize| {
            (c - reach).max(0.0).ceil() as usize
                ..=((c + reach).floor().max(0.0) as usize).min(n - 1)
        };
        let columns = range(centre[0], plane.width);
        let rows = range(centre[1], plane.height);
        let places = rows.flat_map(move |row| columns.clone().map(move |column| (column, row)));
        places.filter_map(move |(column, row)| {
            let place = [column as f64, row as f64];
            // In radii of the ellipse, with two pixels for its blurred edge.
            let (x, y) = (place[0] - centre[0], place[1] - centre[1]);
            let along = x * spot.axis[0] + y * spot.axis[1];
            let across = y * spot.axis[0] - x * spot.axis[1];
            let away = (along / spot.radii[0]).hypot(across / spot.radii[1]);
            (away >= from && away < to).then(|| (place, plane.get(column, row)))
        })
    };
    let mut inner: Vec<f32> = around(0.0, 0.6, spot.centre).map(|(_, value)| value).collect();
    let edge = 1.0 + 2.0 / spot.radii[1].max(1.0);
    let mut outer: Vec<f32> =
        around(edge, edge + 0.5, spot.centre).map(|(_, value)| value).collect();
    if inner.is_empty() || outer.is_empty() {
        return None;
    }
    let (top, bottom) = (f64::from(median(&mut inner)), f64::from(median(&mut outer)));
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
