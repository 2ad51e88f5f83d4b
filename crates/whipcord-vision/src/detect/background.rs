//! What stands out from the background.
//!
//! The background is a cubic surface in each channel, fitted to the medians of cells of the picture so that neither
//! the robot nor a corner of something else pulls at it: light that falls off towards the edges is followed, the
//! robot is not. What stands out is the share of each pixel that is not background, from 0 to 1.

use whipcord_numerics::DenseLu;

use super::{DetectError, Mask, median, median_of, quantile_of};
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
                    for (all, values) in medians.iter_mut().zip(&mut values) {
                        all.push(f64::from(median(values)));
                    }
                }
            }
        }
        let terms: Vec<_> = places.iter().map(|&place| terms(place, width, height)).collect();
        let channels = medians.map(|values| fit(&terms, &values));
        Self { width, height, channels }
    }

    pub fn at(&self, column: usize, row: usize) -> [f64; 3] {
        self.along(row)(column)
    }

    /// The same at each column of a row, where it is a cubic in one variable.
    pub fn along(&self, row: usize) -> impl Fn(usize) -> [f64; 3] + use<> {
        let y = scaled(row as f64, self.height);
        let width = self.width;
        let cubics = self.channels.map(|c| {
            [
                ((c[9] * y + c[5]) * y + c[2]) * y + c[0],
                (c[8] * y + c[4]) * y + c[1],
                c[7] * y + c[3],
                c[6],
            ]
        });
        move |column| {
            let x = scaled(column as f64, width);
            cubics.map(|c| (((c[3] * x + c[2]) * x + c[1]) * x + c[0]).max(DARKEST))
        }
    }
}

/// From −1 at one end of the picture to 1 at the other.
fn scaled(at: f64, length: usize) -> f64 {
    2.0 * at / length as f64 - 1.0
}

fn terms([u, v]: [f64; 2], width: usize, height: usize) -> [f64; TERMS] {
    let (x, y) = (scaled(u, width), scaled(v, height));
    [1.0, x, y, x * x, x * y, y * y, x * x * x, x * x * y, x * y * y, y * y * y]
}

/// Coefficients by which the terms give the values, but for outliers: least squares whose weights fall with the
/// residual (Geman and McClure's), from a scale that shrinks to that of the middle of the residuals.
fn fit(terms: &[[f64; TERMS]], values: &[f64]) -> [f64; TERMS] {
    let mut coefficients = [0.0; TERMS];
    coefficients[0] = median(&mut values.to_vec());
    let residual = |c: &[f64; TERMS], i: usize| {
        values[i] - terms[i].iter().zip(c).map(|(t, c)| t * c).sum::<f64>()
    };
    let mut lu = DenseLu::default();
    for round in 0..12 {
        let mut sizes: Vec<f64> =
            (0..values.len()).map(|i| residual(&coefficients, i).abs()).collect();
        let slack = [8.0, 4.0, 2.5][round.min(2)];
        let scale = slack * median(&mut sizes).max(1e-4);
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
    let differences = || {
        (0..plane.values.len().saturating_sub(apart))
            .step_by(7)
            .map(|i| [plane.values[i], plane.values[i + apart]])
            // Zeros are outside the mask.
            .filter(|pair| !pair.contains(&0.0))
            .map(|[a, b]| (b - a).abs())
    };
    // The median of |a − b| is 0.954 deviations of either.
    f64::from(median_of(differences)) / 0.954
}

/// Relative differences to the background, in each channel. They are computed where they are needed, each time anew: all
/// of them take as much memory as the photograph.
struct Ratios<'a> {
    photo: &'a Photo,
    mask: Option<&'a Mask>,
    background: &'a Background,
}

impl Ratios<'_> {
    fn is_seen(&self, column: usize, row: usize) -> bool {
        self.mask.is_none_or(|mask| mask.contains(column, row))
    }

    /// Those in a row.
    fn along(&self, row: usize) -> impl Fn(usize) -> [f32; 3] {
        let behind = self.background.along(row);
        let pixels = &self.photo.pixels()[row * self.photo.width()..][..self.photo.width()];
        move |column| {
            let (pixel, behind) = (pixels[column], behind(column));
            core::array::from_fn(|c| pixel[c] / behind[c] as f32 - 1.0)
        }
    }

    /// Writes what comes of them to a plane; 0 outside the mask.
    fn write(&self, plane: &mut Plane, of: impl Fn([f32; 3]) -> f32) {
        for (row, values) in plane.values.chunks_exact_mut(plane.width).enumerate() {
            let ratio = self.along(row);
            for (column, value) in values.iter_mut().enumerate() {
                *value = if self.is_seen(column, row) { of(ratio(column)) } else { 0.0 };
            }
        }
    }

    /// Their median in each channel where the plane's values are chosen.
    fn medians(&self, plane: &Plane, is_chosen: impl Fn(f32) -> bool + Copy) -> [f32; 3] {
        core::array::from_fn(|c| {
            median_of(|| {
                plane.values.chunks_exact(plane.width).enumerate().flat_map(move |(row, values)| {
                    let ratio = self.along(row);
                    let chosen =
                        values.iter().enumerate().filter(move |(_, value)| is_chosen(**value));
                    chosen.map(move |(column, _)| ratio(column)[c])
                })
            })
        })
    }
}

/// Relative differences to the background along the one that most of what stands out has.
fn of_any(
    photo: &Photo,
    mask: Option<&Mask>,
    background: &Background,
) -> Result<Plane, DetectError> {
    let (width, height) = (photo.width(), photo.height());
    let ratios = Ratios { photo, mask, background };
    let mut share = Plane::new(width, height);
    // First of all three times the means over the channels.
    ratios.write(&mut share, |ratio| ratio.iter().sum());
    let mean = |sum: f32| f64::from(sum) / 3.0;
    let seen = || {
        let is_seen = |&(i, _): &(usize, &f32)| ratios.is_seen(i % width, i / width);
        share.values.iter().enumerate().filter(is_seen).map(|(_, &sum)| sum)
    };
    let visible = seen().count();
    if visible == 0 {
        return Err(DetectError::NothingStandsOut);
    }
    // Six deviations of the background's noise, of which the median of the magnitude is 0.67.
    let middle = mean(median_of(|| seen().step_by(11).map(f32::abs)));
    let least = (6.0 / 0.67 * middle).clamp(LEAST_CONTRAST, 0.6);
    // Dark before light or light before dark: what is more.
    let beyond = |sign: f64| share.values.iter().filter(|&&sum| sign * mean(sum) > least).count();
    let (darker, lighter) = (beyond(-1.0), beyond(1.0));
    let (sign, mut members) = if darker >= lighter { (-1.0, darker) } else { (1.0, lighter) };
    for round in 0..3 {
        if members < 20 {
            return Err(DetectError::NothingStandsOut);
        }
        let typical = match round {
            0 => ratios.medians(&share, |sum| sign * mean(sum) > least),
            _ => ratios.medians(&share, stands_out),
        };
        let square: f32 = typical.iter().map(|t| t * t).sum();
        ratios.write(&mut share, |ratio| {
            let along: f32 = ratio.iter().zip(typical).map(|(r, t)| r * t).sum();
            (along / square).clamp(-1.0, 1.5)
        });
        members = share.values.iter().filter(|&&value| stands_out(value)).count();
    }
    let part = members as f64 / visible as f64;
    if part > MOST_FOREGROUND {
        return Err(DetectError::NoEvenBackground { share: part });
    }
    Ok(share)
}

fn stands_out(share: f32) -> bool {
    share > 0.5
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
    let pixels = photo.pixels().chunks_exact(width);
    for (row, (values, pixels)) in plane.values.chunks_exact_mut(width).zip(pixels).enumerate() {
        let behind = background.along(row);
        for (column, (value, pixel)) in values.iter_mut().zip(pixels).enumerate() {
            if mask.is_some_and(|mask| !mask.contains(column, row)) {
                continue;
            }
            let (pixel, behind) = (pixel.map(f64::from), behind(column));
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
    }
    // How brightly the colour is lit is not known: its typical amount counts as all of it.
    let smooth = plane.clone().blurred(1.0);
    let least = (5.0 * noise(&smooth, 9)).max(0.15) as f32;
    let strong = || smooth.values.iter().copied().filter(|&amount| amount > least);
    if strong().count() < 12 {
        return Err(DetectError::NothingStandsOut);
    }
    let typical = quantile_of(strong, 0.7);
    plane.values.iter_mut().for_each(|value| *value = (*value / typical).clamp(-1.0, 1.5));
    Ok(plane)
}
