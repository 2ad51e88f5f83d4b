//! Light, blur and noise: from what is there to what the camera records.

use whipcord_numerics::random::SplitMix64;

use crate::photo::Photo;
use crate::plane::Plane;

/// How evenly the scene is lit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Light {
    /// Relative gain of light from the left to the right edge, and from the top to the bottom.
    pub gradient: [f64; 2],
    /// Relative loss of light from the middle to the corners, growing with the square of the distance.
    pub vignette: f64,
}

/// How sharp the photograph is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Blur {
    /// Standard deviation of the lens's blur in pixels.
    pub deviation: f64,
    /// How far the picture moves while it is exposed, in pixels.
    pub motion: [f64; 2],
}

/// What the sensor adds: noise of deviation `√(dark² + bright²·light)` where white is light 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Noise {
    /// Deviation in the dark.
    pub dark: f64,
    /// Deviation that light itself adds, at white.
    pub bright: f64,
    /// Which noise of this kind.
    pub seed: u64,
}

impl Noise {
    /// Noise whose deviation at white is `deviation`, a third of it in the dark.
    #[must_use]
    pub fn of(deviation: f64, seed: u64) -> Self {
        let dark = deviation / 3.0;
        Self { dark, bright: (deviation * deviation - dark * dark).sqrt(), seed }
    }
}

pub(super) fn expose(photo: &mut Photo, light: Light, blur: Blur, noise: Noise) {
    illuminate(photo, light);
    if blur != Blur::default() {
        photo.change_channels(|plane| {
            let sharp = blur.deviation <= 0.0;
            moved(if sharp { plane } else { plane.blurred(blur.deviation) }, blur.motion)
        });
    }
    let mut random = SplitMix64::new(noise.seed);
    let (dark, bright) = (noise.dark * noise.dark, noise.bright * noise.bright);
    if dark + bright > 0.0 {
        for value in photo.pixels_mut().iter_mut().flatten() {
            let deviation = (dark + bright * f64::from(value.max(0.0))).sqrt();
            *value = (*value + (deviation * normal(&mut random)) as f32).clamp(0.0, 1.0);
        }
    }
}

fn illuminate(photo: &mut Photo, light: Light) {
    let (width, height) = (photo.width(), photo.height());
    let centred = |i: usize, n: usize| (i as f64 + 0.5) / n as f64 - 0.5;
    for (i, pixel) in photo.pixels_mut().iter_mut().enumerate() {
        let (x, y) = (centred(i % width, width), centred(i / width, height));
        let even = 1.0 + light.gradient[0] * x + light.gradient[1] * y;
        let gain = even * (1.0 - light.vignette * 2.0 * (x * x + y * y));
        *pixel = pixel.map(|value| value * gain.max(0.0) as f32);
    }
}

/// The mean over a straight way, as long before its middle as after it.
fn moved(plane: Plane, way: [f64; 2]) -> Plane {
    let length = way[0].hypot(way[1]);
    if length == 0.0 {
        return plane;
    }
    let samples = (4.0 * length).ceil().max(2.0) as usize;
    let mut out = Plane::new(plane.width, plane.height);
    for row in 0..plane.height {
        for column in 0..plane.width {
            let sum: f32 = (0..samples)
                .map(|k| (k as f64 + 0.5) / samples as f64 - 0.5)
                .map(|t| plane.at([column as f64 + t * way[0], row as f64 + t * way[1]]))
                .sum();
            out.values[row * plane.width + column] = sum / samples as f32;
        }
    }
    out
}

/// Of mean 0 and deviation 1: the sum of twelve uniform numbers, less its mean. It needs no function that
/// machines compute differently.
fn normal(random: &mut SplitMix64) -> f64 {
    let quarters = |z: u64| (0..4).map(|k| (z >> (16 * k)) & 0xffff).sum::<u64>();
    let mut next = || quarters(random.next_u64());
    let sum = next() + next() + next();
    // Each of the twelve has the mean 65535/2.
    (sum as f64 - 6.0 * 65_535.0) / 65_536.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_has_the_deviation_it_is_given() {
        let mut photo = Photo::uniform(200, 200, [0.5; 3]);
        expose(&mut photo, Light::default(), Blur::default(), Noise::of(0.02, 7));
        let values: Vec<f64> =
            photo.pixels().iter().flatten().map(|&value| f64::from(value)).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64;
        // At half of white: a ninth of the variance from the dark, half of the rest from light.
        let expected = 4e-4 * (1.0 / 9.0 + 0.5 * 8.0 / 9.0);
        assert!((mean - 0.5).abs() < 3e-4, "{mean}");
        assert!((variance / expected - 1.0).abs() < 0.02, "{variance} {expected}");
    }

    #[test]
    fn blur_keeps_light_and_place() {
        let mut photo = Photo::uniform(41, 41, [0.0; 3]);
        photo.pixels_mut()[20 * 41 + 20] = [1.0; 3];
        let blur = Blur { deviation: 1.5, motion: [6.0, 2.0] };
        expose(&mut photo, Light::default(), blur, Noise::default());
        let moment = |f: fn(f64, f64) -> f64| -> f64 {
            let values = photo.pixels().iter().enumerate();
            values.map(|(i, p)| f((i % 41) as f64, (i / 41) as f64) * f64::from(p[0])).sum()
        };
        assert!((moment(|_, _| 1.0) - 1.0).abs() < 1e-4);
        assert!((moment(|x, _| x) - 20.0).abs() < 1e-3);
        assert!((moment(|_, y| y) - 20.0).abs() < 1e-3);
        // Variances add: that of the Gaussian, of the way (its square over twelve), and of drawing
        // between pixels.
        let along = moment(|x, _| (x - 20.0).powi(2));
        assert!((along - (2.25 + 3.0)).abs() < 0.25, "{along}");
    }
}
