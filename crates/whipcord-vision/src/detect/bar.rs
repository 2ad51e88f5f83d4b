//! One disk to a fraction of a pixel.
//!
//! Both coordinates come from edges on both sides, so that blur, which moves opposite edges alike, cancels. Along the
//! bar they are its two ends. Across it they are the two rims of each wing, at many places left and right of the
//! backbone; a line through their middles, fitted so that a cable that crosses a wing counts for little, gives place and
//! direction.

use crate::plane::Plane;

/// A disk seen from the side.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Bar {
    /// Its centre in pixels.
    pub centre: [f64; 2],
    /// Unit vector along it.
    pub axis: [f64; 2],
    /// Half of its length in pixels.
    pub half_length: f64,
    /// Half of the wings' thickness in pixels.
    pub half_thickness: f64,
    /// Share of the wings on which both rims were found near the line.
    pub filled: f64,
    /// Deviation of the wings' middles from the line in pixels.
    pub scatter: f64,
    /// How far beside the centre the backbone crosses, in pixels; `None` where none is seen.
    pub aside: Option<f64>,
}

/// Wings begin and end at these parts of the half length: beyond the backbone and before the round ends.
const WING: [f64; 2] = [0.3, 0.88];
/// Distance of places on a wing, and of samples, in pixels.
const STEP: f64 = 0.5;
/// Least share of the wings' places that must be on the line.
const LEAST_FILLED: f64 = 0.6;
/// Rounds in which place, direction and length settle.
const ROUNDS: usize = 5;

impl Bar {
    /// From 0 to 1, where the usual half length is this.
    pub fn quality(&self, usual: f64) -> f64 {
        let length = ((self.half_length / usual).ln() / 0.12).powi(2);
        let scatter = (self.scatter / (0.25 + 0.2 * self.half_thickness)).powi(2);
        // A disk without a backbone on either side may be something else.
        let aside = self.aside.map_or(1.0, |aside| aside / self.aside_allowed());
        self.filled * (-0.5 * (length + scatter + aside * aside)).exp()
    }

    /// How far beside the centre a backbone may seem to cross by noise and bending.
    fn aside_allowed(&self) -> f64 {
        0.03 * self.half_length + 0.4
    }

    fn at(&self, u: f64, v: f64) -> [f64; 2] {
        let [a, b] = self.axis;
        [self.centre[0] + u * a - v * b, self.centre[1] + u * b + v * a]
    }
}

/// The bar nearby, refined; `None` where there is none.
pub(super) fn refined(share: &Plane, noise: f64, mut bar: Bar) -> Option<Bar> {
    for _ in 0..ROUNDS {
        let start = bar;
        let wings = wings(share, noise, &bar);
        let line = line(&wings)?;
        bar.filled = line.filled;
        bar.scatter = line.scatter;
        bar.half_thickness = line.half_thickness.max(0.5);
        if bar.filled < LEAST_FILLED {
            return None;
        }
        // Onto the line, and along it.
        bar.centre = bar.at(0.0, line.offset);
        let turn = line.slope.atan();
        let (sin, cos) = turn.sin_cos();
        let [a, b] = bar.axis;
        bar.axis = [cos * a - sin * b, sin * a + cos * b];
        let forward = end(share, noise, &bar, 1.0)?;
        let backward = end(share, noise, &bar, -1.0)?;
        bar.centre = bar.at(0.5 * (forward - backward), 0.0);
        bar.half_length = 0.5 * (forward + backward);
        let moved = (bar.centre[0] - start.centre[0]).hypot(bar.centre[1] - start.centre[1]);
        if bar.half_length < 2.0 || moved > start.half_length {
            return None;
        }
        if moved < 1e-4 && turn.abs() < 1e-6 {
            break;
        }
    }
    bar.aside = backbone(share, &bar);
    // Where an end is hidden, the middle between the ends is not that of the disk, and not on the backbone.
    bar.aside.is_none_or(|aside| aside < 2.0 * bar.aside_allowed()).then_some(bar)
}

/// How far beside the bar's centre the backbone leaves it, on the side where that is less.
fn backbone(share: &Plane, bar: &Bar) -> Option<f64> {
    let most = 0.6 * bar.half_length;
    let inside = |u: f64, v: f64| share.at(bar.at(u, v)) > 0.5;
    // The image of a round disk is thicker at its middle than its wings are.
    let off = 1.5 * bar.half_thickness + 3.0;
    let run = |v: f64, side: f64| {
        let mut u = 0.0;
        while inside(side * u, v) {
            u += STEP;
            if u > most {
                return None;
            }
        }
        Some(u)
    };
    let crossing = |v: f64| {
        if inside(0.0, v) { Some(0.5 * (run(v, 1.0)? - run(v, -1.0)?).abs()) } else { None }
    };
    let sides = [crossing(off), crossing(-off)];
    sides.into_iter().flatten().min_by(f64::total_cmp)
}

/// A place on a wing: how far it is along the bar, where the middle between its rims is, and half of what it is
/// thick.
struct WingPlace {
    along: f64,
    middle: f64,
    half_thickness: f64,
}

fn wings(share: &Plane, noise: f64, bar: &Bar) -> Vec<Option<WingPlace>> {
    let most = 2.2 * bar.half_thickness + 4.0;
    let count = ((WING[1] - WING[0]) * bar.half_length / STEP).ceil().max(3.0);
    let mut places = Vec::new();
    for side in [-1.0, 1.0] {
        for k in 0..count as usize {
            let part = WING[0] + (WING[1] - WING[0]) * (k as f64 + 0.5) / count;
            let along = side * part * bar.half_length;
            places.push(wing(share, noise, bar, along, most));
        }
    }
    places
}

fn wing(share: &Plane, noise: f64, bar: &Bar, along: f64, most: f64) -> Option<WingPlace> {
    // The rim is where the way from the middle line to the background is spent.
    let way = |side: f64| edge(most, noise, |t| share.at(bar.at(along, side * t)));
    let (up, down) = (way(1.0)?, way(-1.0)?);
    (up + down > 0.5).then_some(WingPlace {
        along,
        middle: 0.5 * (up - down),
        half_thickness: 0.5 * (up + down),
    })
}

/// How far what begins here reaches: to where its share falls to half of what it is before, that is, the
/// integral of a share that goes from one to nothing between three quarters and a quarter of that, where noise does not
/// reach from either side. `None` when it does not end before `most`.
fn edge(most: f64, noise: f64, value: impl Fn(f64) -> f32) -> Option<f64> {
    // Under strong noise a single sample below the threshold is no end.
    let wanted = if noise > 0.08 { 4 } else { 2 };
    let reach = |level: f64| {
        let mut reach = 0.0;
        let mut clear = 0;
        let mut t = 0.5 * STEP;
        while clear < wanted {
            if t > most {
                return None;
            }
            let certain = (2.0 * f64::from(value(t)) / level - 0.5).clamp(0.0, 1.0);
            reach += certain * STEP;
            clear = if certain < 0.05 { clear + 1 } else { 0 };
            t += STEP;
        }
        Some(reach)
    };
    let rough = reach(1.0)?;
    // The face of a disk and its rim are not equally light: each edge has its own half, of what is just before it
    // and out of reach of the blur.
    let (near, far) = ((rough - 4.0).max(0.0), (rough - 2.0).max(0.4 * rough));
    let samples = 5;
    let before = (0..samples).map(|k| near + (far - near) * (k as f64 + 0.5) / samples as f64);
    let level = before.map(|t| f64::from(value(t))).sum::<f64>() / samples as f64;
    reach(level.clamp(0.5, 1.5))
}

/// Where the bar ends on one side, from its centre.
fn end(share: &Plane, noise: f64, bar: &Bar, side: f64) -> Option<f64> {
    let start = 0.5 * bar.half_length;
    let most = 0.9 * bar.half_length + 6.0;
    // The middle part of the thickness: the mean over it has less noise.
    let breadth = 0.6 * bar.half_thickness;
    let samples = (2.0 * breadth / STEP).ceil().max(1.0) as usize;
    let mean = |t: f64| {
        let sum: f32 = (0..samples)
            .map(|k| breadth * ((2 * k + 1) as f64 / samples as f64 - 1.0))
            .map(|v| share.at(bar.at(side * (start + t), v)))
            .sum();
        sum / samples as f32
    };
    edge(most, noise, mean).map(|reach| start + reach)
}

struct Line {
    offset: f64,
    slope: f64,
    half_thickness: f64,
    filled: f64,
    scatter: f64,
}

/// A line through the middles, by weights that fall with the distance from it.
fn line(places: &[Option<WingPlace>]) -> Option<Line> {
    let found: Vec<&WingPlace> = places.iter().flatten().collect();
    let both_sides = found.iter().any(|p| p.along < 0.0) && found.iter().any(|p| p.along > 0.0);
    if found.len() < 4 || !both_sides {
        return None;
    }
    let mut middles: Vec<f64> = found.iter().map(|p| p.middle).collect();
    let mut thicknesses: Vec<f64> = found.iter().map(|p| p.half_thickness).collect();
    let half_thickness = super::median(&mut thicknesses);
    let (mut offset, mut slope) = (super::median(&mut middles), 0.0);
    let mut scatter = 0.0;
    let distance = |p: &WingPlace, offset: f64, slope: f64| p.middle - offset - slope * p.along;
    for _ in 0..10 {
        let mut sizes: Vec<f64> = found.iter().map(|p| distance(p, offset, slope).abs()).collect();
        scatter = super::median(&mut sizes) / 0.6745;
        let scale = (2.0 * scatter).max(0.05);
        let mut sums = [0.0; 5];
        for place in &found {
            let weight = 1.0 / (1.0 + (distance(place, offset, slope) / scale).powi(2)).powi(2);
            let (x, y) = (place.along, place.middle);
            for (sum, term) in sums.iter_mut().zip([1.0, x, x * x, y, x * y]) {
                *sum += weight * term;
            }
        }
        let [n, x, xx, y, xy] = sums;
        let determinant = n * xx - x * x;
        if determinant <= 1e-9 * n * xx {
            return None;
        }
        offset = (xx * y - x * xy) / determinant;
        slope = (n * xy - x * y) / determinant;
    }
    let near = (3.0 * scatter).max(0.35 * half_thickness).max(0.5);
    let on_line = found.iter().filter(|p| distance(p, offset, slope).abs() < near).count();
    let filled = on_line as f64 / places.len() as f64;
    Some(Line { offset, slope, half_thickness, filled, scatter })
}
