//! A photograph: linear light in three channels.

use jpeg_encoder::SamplingFactor;
use thiserror::Error;

use crate::plane::Plane;
use crate::raster::Raster;

/// Of 100, the usual one for photographs.
const JPEG_QUALITY: u8 = 75;

/// A photograph. Each pixel is linear light in red, green and blue, 0 black and 1 white.
#[derive(Clone, Debug, PartialEq)]
pub struct Photo {
    width: usize,
    height: usize,
    pixels: Vec<[f32; 3]>,
}

/// Why bytes are no photograph.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum PhotoError {
    /// There are no bytes.
    #[error("the file is empty")]
    Empty,
    /// They are in none of the formats that are read.
    #[error("this is not a picture that can be read: it is neither PNG nor JPEG")]
    NotAnImage,
    /// They begin as a picture does, but cannot be decoded.
    #[error("the picture is broken: {reason}")]
    Broken {
        /// What the decoder says.
        reason: String,
    },
    /// More pixels than are worked on.
    #[error(
        "the picture has {width}×{height} pixels; at most {side} a side and {most} in all are read: scale it down or cut \
         out the robot"
    )]
    TooLarge {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// Greatest number of columns and of rows.
        side: u32,
        /// Greatest number of pixels.
        most: u64,
    },
    /// It could not be written.
    #[error("the picture cannot be encoded: {reason}")]
    Encoding {
        /// What the encoder says.
        reason: String,
    },
}

impl Photo {
    /// Greatest number of columns and of rows.
    pub const LARGEST_SIDE: u32 = 12_000;
    /// Greatest number of pixels: those of the largest full-frame cameras. For each, decoding takes at most 20 bytes of
    /// memory, and finding something, the photograph itself included, at most 36.
    pub const MOST_PIXELS: u64 = 64_000_000;

    /// A photograph of one colour.
    #[must_use]
    pub fn uniform(width: usize, height: usize, colour: [f32; 3]) -> Self {
        Self { width, height, pixels: vec![colour; width * height] }
    }

    /// Columns.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// All pixels, row by row.
    #[must_use]
    pub fn pixels(&self) -> &[[f32; 3]] {
        &self.pixels
    }

    /// All pixels, row by row.
    pub fn pixels_mut(&mut self) -> &mut [[f32; 3]] {
        &mut self.pixels
    }

    /// Luminance (ITU-R BT.709), encoded as sRGB in steps that need not be whole, from 0 to 255.
    #[cfg(feature = "boards")]
    pub(crate) fn grey(&self) -> Plane {
        let luminance = |[r, g, b]: [f32; 3]| 0.2126 * r + 0.7152 * g + 0.0722 * b;
        let values = self.pixels.iter().map(|&pixel| 255.0 * encoded(luminance(pixel)));
        Plane { width: self.width, height: self.height, values: values.collect() }
    }

    /// Changes each channel by itself.
    pub(crate) fn change_channels(&mut self, change: impl Fn(Plane) -> Plane) {
        for channel in 0..3 {
            let values = self.pixels.iter().map(|pixel| pixel[channel]).collect();
            let plane = change(Plane { width: self.width, height: self.height, values });
            for (pixel, value) in self.pixels.iter_mut().zip(plane.values) {
                pixel[channel] = value;
            }
        }
    }

    /// The photograph in these bytes, a PNG or JPEG file, turned upright as its Exif data ask for.
    ///
    /// # Errors
    /// [`PhotoError`] when they are none.
    pub fn decode(bytes: &[u8]) -> Result<Self, PhotoError> {
        Ok(Self::decode_turned(bytes)?.0)
    }

    /// The same, and the bytes of a file that stores it upright: these, unless they ask to be turned, which not
    /// everything that shows them does.
    ///
    /// # Errors
    /// [`PhotoError`] when they are none.
    pub fn decode_upright(bytes: Vec<u8>) -> Result<(Self, Vec<u8>), PhotoError> {
        let (photo, turned) = Self::decode_turned(&bytes)?;
        let stored = if turned { photo.to_jpeg()? } else { bytes };
        Ok((photo, stored))
    }

    /// With whether it had to be turned.
    fn decode_turned(bytes: &[u8]) -> Result<(Self, bool), PhotoError> {
        if bytes.is_empty() {
            return Err(PhotoError::Empty);
        }
        let raster = Raster::decode(bytes, check_size)?;
        let [width, height] = raster.size();
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let mut pixels = Vec::with_capacity(width * height);
        pixels.extend(places.map(|(x, y)| raster.colour(x, y).map(linear)));
        Ok((Self { width, height, pixels }, raster.is_turned()))
    }

    /// The photograph as a PNG file of eight bits a channel.
    ///
    /// # Errors
    /// [`PhotoError::Encoding`] when there is nothing to encode.
    pub fn to_png(&self) -> Result<Vec<u8>, PhotoError> {
        encode_png(self).map_err(encoding)
    }

    /// The photograph as a JPEG file.
    ///
    /// # Errors
    /// [`PhotoError::Encoding`] when there is nothing to encode, or more than 65535 columns or rows, which the format
    /// does not have.
    pub fn to_jpeg(&self) -> Result<Vec<u8>, PhotoError> {
        let [width, height] = [u16::try_from(self.width), u16::try_from(self.height)];
        let (width, height) = (width.map_err(encoding)?, height.map_err(encoding)?);
        let mut out = Vec::new();
        let mut encoder = jpeg_encoder::Encoder::new(&mut out, JPEG_QUALITY);
        encoder.set_sampling_factor(SamplingFactor::R_4_4_4);
        encoder
            .encode(&self.to_rgb8(), width, height, jpeg_encoder::ColorType::Rgb)
            .map_err(encoding)?;
        Ok(out)
    }

    /// The photograph whose pixels, row by row, are these bytes of red, green and blue.
    ///
    /// ```
    /// use whipcord_vision::Photo;
    ///
    /// let bytes = [0, 0, 0, 255, 255, 255];
    /// let photo = Photo::of_rgb8(2, 1, &bytes)?;
    /// assert_eq!(photo.to_rgb8(), bytes);
    /// # Ok::<(), whipcord_vision::PhotoError>(())
    /// ```
    ///
    /// # Errors
    /// [`PhotoError`] when there are too many or none, or not as many bytes as pixels have.
    pub fn of_rgb8(width: usize, height: usize, bytes: &[u8]) -> Result<Self, PhotoError> {
        let broken = |reason: &str| PhotoError::Broken { reason: reason.to_owned() };
        let side = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        check_size(side(width), side(height))?;
        if bytes.len() != 3 * width * height {
            return Err(broken("it has more or fewer bytes than pixels"));
        }
        let level = |byte: &u8| linear(f32::from(*byte) / 255.0);
        let pixels =
            bytes.chunks_exact(3).map(|rgb| [level(&rgb[0]), level(&rgb[1]), level(&rgb[2])]);
        Ok(Self { width, height, pixels: pixels.collect() })
    }

    /// All pixels, row by row, as bytes of red, green and blue.
    #[must_use]
    pub fn to_rgb8(&self) -> Vec<u8> {
        self.pixels.iter().flat_map(|pixel| pixel.map(quantised)).collect()
    }
}

/// Refuses what has no pixels, or more than are worked on.
fn check_size(width: u32, height: u32) -> Result<(), PhotoError> {
    let (side, most) = (Photo::LARGEST_SIDE, Photo::MOST_PIXELS);
    if width.max(height) > side || u64::from(width) * u64::from(height) > most {
        Err(PhotoError::TooLarge { width, height, side, most })
    } else if width == 0 || height == 0 {
        Err(PhotoError::Broken { reason: "it has no pixels".to_owned() })
    } else {
        Ok(())
    }
}

fn encode_png(photo: &Photo) -> Result<Vec<u8>, png::EncodingError> {
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, photo.width as u32, photo.height as u32);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&photo.to_rgb8())?;
    writer.finish()?;
    Ok(out)
}

fn encoding(reason: impl core::fmt::Display) -> PhotoError {
    PhotoError::Encoding { reason: reason.to_string() }
}

/// Linear light of an sRGB value from 0 to 1 (IEC 61966-2-1).
#[must_use]
pub fn linear(encoded: f32) -> f32 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// The inverse of [`linear`], of light from 0 to 1.
fn encoded(light: f32) -> f32 {
    let light = light.clamp(0.0, 1.0);
    if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 }
}

fn quantised(light: f32) -> u8 {
    (255.0 * encoded(light)).round() as u8
}
