//! What stands out from the background.
//!
//! The background is a cubic surface in each channel, fitted to the medians of cells of the picture so that neither
//! the robot nor a corner of something else pulls at it: light that falls off towards the edges is followed, the
//! robot is not. What stands out is the share of each pixel that is not background, from 0 to 1.

use whipcord_numerics::DenseLu;

use super::{DetectError, Mask};
use crate::photo::Photo;
use crate::plane::Plane;

/// Cells along the longer side.
const CELLS: usize = 24;
/// Terms of a cubic in two variables.
const TERMS: usize = 10;
/// Background darker than this is treated as this dark, for ratios to it.
const DARKEST: f64 = 0.004;
/// Relative difference to the background that counts at all.
const LEAST_CONTRAST: f64 = 0.1;
/// The robot is the lesser part of the picture.
const MOST_FOREGROUND: f64 = 0.45;

/// How much of each pixel is robot, and how sure that is.
pub(super) struct Standing {
    /// About 1 on what stands out and 0 on the background, in between at edges.
    pub share: Plane,
    /// Its deviation by noise.
    pub noise: f64,
}

/// The background's light at each pixel.
pub(super) struct Background {
    width: usize,
    height: usize,
    channels: [[f64; TERMS]; 3],
}

impl Background {
    pub fn of(photo: &Photo, mask: Option<&Mask>) -> Self {
        let (width, height) = (photo.width(), photo.height());
        let cell = width.max(height).div_ceil(CELLS);
        let mut places = Vec::new();
        let mut medians: [Vec<f64>; 3] = Default::default();
        for top in (0..height).step_by(cell) {
            for left in (0..width).step_by(cell) {
                let (right, bottom) = ((left + cell).min(width), (top + cell).min(height));
                // A few hundred pixels of a cell have its median.
                let step = cell.div_ceil(24);
                let mut values: [Vec<f32>; 3] = Default::default();
                for row in (top..bottom).step_by(step) {
                    for column in (left..right).step_by(step) {
                        if mask.is_none_or(|mask| mask.contains(column, row)) {
                            let pixel = photo.pixels()[row * width + column];
                            (0..3).for_each(|c| values[c].push(pixel[c]));
                        }
                    }
                }
                if !values[0].is_empty() {
                    places.push([0.5 * (left + right) as f64, 0.5 * (top + bottom) as f64]);
                    for (median, values) in medians.iter_mut().zip(&mut values) {
                        median.push(f64::from(super::median(values)));
                    }
                }
            }
        }
        let terms: Vec<_> = places.iter().map(|&place| terms(place, width, height)).collect();
        let channels = medians.map(|values| fit(&terms, &values));
        Self { width, height, channels }
    }

    pub fn at(&self, column: usize, row: usize) -> [f64; 3] {
        let terms = terms([column as f64, row as f64], self.width, self.height);
        self.channels.map(|c| c.iter().zip(terms).map(|(c, t)| c * t).sum::<f64>().max(DARKEST))
    }
}

fn terms([u, v]: [f64; 2], width: usize, height: usize) -> [f64; TERMS] {
    let x = 2.0 * u / width as f64 - 1.0;
    let y = 2.0 * v / height as f64 - 1.0;
    [1.0, x, y, x * x, x * y, y * y, x * x * x, x * x * y, x * y * y, y * y * y]
}

/// Coefficients by which the terms give the values, but for outliers: least squares whose weights fall with the
/// residual (Geman and McClure's), from a scale that shrinks to that of the middle of the residuals.
fn fit(terms: &[[f64; TERMS]], values: &[f64]) -> [f64; TERMS] {
    let mut coefficients = [0.0; TERMS];
    coefficients[0] = super::median(&mut values.to_vec());
    let residual = |c: &[f64; TERMS], i: usize| {
        values[i] - terms[i].iter().zip(c).map(|(t, c)| t * c).sum::<f64>()
    };
    let mut lu = DenseLu::default();
    for round in 0..12 {
        let mut sizes: Vec<f64> =
            (0..values.len()).map(|i| residual(&coefficients, i).abs()).collect();
        let slack = [8.0, 4.0, 2.5][round.min(2)];
        let scale = slack * super::median(&mut sizes).max(1e-4);
        let mut matrix = [0.0; TERMS * TERMS];
        let mut right = [0.0; TERMS];
        for (i, t) in terms.iter().enumerate() {
            let relative = residual(&coefficients, i) / scale;
            let weight = (1.0 + relative * relative).powi(-2);
            for j in 0..TERMS {
                right[j] += weight * t[j] * values[i];
                for k in 0..TERMS {
                    matrix[j * TERMS + k] += weight * t[j] * t[k];
                }
            }
        }
        // What few cells do not tell stays small.
        for j in 0..TERMS {
            matrix[j * TERMS + j] += 1e-6 * terms.len() as f64;
        }
        if lu.factor(TERMS, &matrix).is_err() {
            break;
        }
        lu.solve(&mut right);
        coefficients = right;
    }
    coefficients
}

/// What stands out from the background, in whatever colour; or in this one, of linear light.
pub(super) fn standing(
    photo: &Photo,
    mask: Option<&Mask>,
    colour: Option<[f32; 3]>,
) -> Result<Standing, DetectError> {
    let background = Background::of(photo, mask);
    let share = match colour {
        Some(colour) => of_colour(photo, mask, &background, colour)?,
        None => of_any(photo, mask, &background)?,
    };
    let noise = noise(&share, 1);
    Ok(Standing { share, noise })
}

/// Deviation of what varies between places this many pixels apart: on the background that is noise.
pub(super) fn noise(plane: &Plane, apart: usize) -> f64 {
    let mut differences: Vec<f32> = (0..plane.values.len().saturating_sub(apart))
        .step_by(7)
        .map(|i| [plane.values[i], plane.values[i + apart]])
        // Zeros are outside the mask.
        .filter(|pair| !pair.contains(&0.0))
        .map(|[a, b]| (b - a).abs())
        .collect();
    // The median of |a − b| is 0.954 deviations of either.
    f64::from(super::median(&mut differences)) / 0.954
}

/// Relative differences to the background along the one that most of what stands out has.
fn of_any(
    photo: &Photo,
    mask: Option<&Mask>,
    background: &Background,
) -> Result<Plane, DetectError> {
    let (width, height) = (photo.width(), photo.height());
    let ratios: Vec<[f32; 3]> = (0..width * height)
        .map(|i| {
            let behind = background.at(i % width, i / width);
            let pixel = photo.pixels()[i];
            core::array::from_fn(|c| pixel[c] / behind[c] as f32 - 1.0)
        })
        .collect();
    let seen = |i: usize| mask.is_none_or(|mask| mask.contains(i % width, i / width));
    let visible = (0..ratios.len()).filter(|&i| seen(i)).count();
    let mean = |ratio: &[f32; 3]| f64::from(ratio.iter().sum::<f32>()) / 3.0;
    let mut sample: Vec<f64> = (0..ratios.len())
        .filter(|&i| seen(i))
        .step_by(11)
        .map(|i| mean(&ratios[i]).abs())
        .collect();
    if sample.is_empty() {
        return Err(DetectError::NothingStandsOut);
    }
    // Six deviations of the background's noise, of which the median of the magnitude is 0.67.
    let least = (6.0 / 0.67 * super::median(&mut sample)).clamp(LEAST_CONTRAST, 0.6);
    let beyond = |sign: f64| -> Vec<usize> {
        (0..ratios.len()).filter(|&i| seen(i) && sign * mean(&ratios[i]) > least).collect()
    };
    // Dark before light or light before dark: what is more.
    let (darker, lighter) = (beyond(-1.0), beyond(1.0));
    let mut members = if darker.len() >= lighter.len() { darker } else { lighter };
    let mut typical = [0.0_f32; 3];
    let mut share = Plane::new(width, height);
    for _ in 0..3 {
        if members.len() < 20 {
            return Err(DetectError::NothingStandsOut);
        }
        for (c, value) in typical.iter_mut().enumerate() {
            let mut values: Vec<f32> = members.iter().map(|&i| ratios[i][c]).collect();
            *value = super::median(&mut values);
        }
        let square: f32 = typical.iter().map(|t| t * t).sum();
        for (i, value) in share.values.iter_mut().enumerate() {
            let along: f32 = ratios[i].iter().zip(typical).map(|(r, t)| r * t).sum();
            *value = if seen(i) { (along / square).clamp(-1.0, 1.5) } else { 0.0 };
        }
        members = (0..ratios.len()).filter(|&i| share.values[i] > 0.5).collect();
    }
    let part = members.len() as f64 / visible as f64;
    if part > MOST_FOREGROUND {
        return Err(DetectError::NoEvenBackground { share: part });
    }
    Ok(share)
}

/// How much of a colour is in each pixel, mixed with any amount of black and of the background.
fn of_colour(
    photo: &Photo,
    mask: Option<&Mask>,
    background: &Background,
    colour: [f32; 3],
) -> Result<Plane, DetectError> {
    let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let length = |a: [f64; 3]| dot(a, a).sqrt();
    let wanted = colour.map(f64::from);
    let (width, height) = (photo.width(), photo.height());
    let middle = background.at(width / 2, height / 2);
    let cosine = dot(wanted, middle) / (length(wanted) * length(middle)).max(1e-12);
    // Within 8° of the background's direction, light and shade of it look the same.
    if cosine.is_nan() || cosine > 0.99 || length(wanted) < 1e-3 {
        return Err(DetectError::ColourLikeBackground);
    }
    let mut plane = Plane::new(width, height);
    for (i, value) in plane.values.iter_mut().enumerate() {
        let (column, row) = (i % width, i / width);
        if mask.is_some_and(|mask| !mask.contains(column, row)) {
            continue;
        }
        let behind = background.at(column, row);
        let pixel = photo.pixels()[i].map(f64::from);
        // Least squares for the two amounts.
        let (cc, cb, bb) = (dot(wanted, wanted), dot(wanted, behind), dot(behind, behind));
        let (pc, pb) = (dot(pixel, wanted), dot(pixel, behind));
        let determinant = cc * bb - cb * cb;
        let amount = (pc * bb - pb * cb) / determinant;
        let rest = (cc * pb - cb * pc) / determinant;
        let left = core::array::from_fn(|c| pixel[c] - amount * wanted[c] - rest * behind[c]);
        // What neither explains is another colour.
        *value = (amount - 1.5 * length(left) / length(wanted)).clamp(-1.0, 4.0) as f32;
    }
    // How brightly the colour is lit is not known: its typical amount counts as all of it.
    let smooth = plane.blurred(1.0);
    let least = (5.0 * noise(&smooth, 9)).max(0.15) as f32;
    let mut strong: Vec<f32> = smooth.values.into_iter().filter(|&a| a > least).collect();
    if strong.len() < 12 {
        return Err(DetectError::NothingStandsOut);
    }
    let typical = super::quantile(&mut strong, 0.7);
    plane.values.iter_mut().for_each(|value| *value = (*value / typical).clamp(-1.0, 1.5));
    Ok(plane)
}
