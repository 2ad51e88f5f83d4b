//! The pixels of a PNG or JPEG file, as they are stored.

use std::io::Cursor;

use png::Transformations;
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use crate::photo::PhotoError;

/// Memory in bytes that a decoder of PNG may take for what a file holds beside its pixels: a few bytes can say that a
/// colour profile of gigabytes follows.
const MOST_BESIDE_PIXELS: usize = 1 << 26;

/// What makes the stored picture upright, in the order of the numbers of Exif (2.32, table 6).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Orientation {
    NoTransforms,
    FlipHorizontal,
    Rotate180,
    FlipVertical,
    Rotate90FlipH,
    Rotate90,
    Rotate270FlipH,
    Rotate270,
}

impl Orientation {
    /// Of the number in Exif data, from 1 to 8.
    const fn of_exif(number: u32) -> Option<Self> {
        match number {
            1 => Some(Self::NoTransforms),
            2 => Some(Self::FlipHorizontal),
            3 => Some(Self::Rotate180),
            4 => Some(Self::FlipVertical),
            5 => Some(Self::Rotate90FlipH),
            6 => Some(Self::Rotate90),
            7 => Some(Self::Rotate270FlipH),
            8 => Some(Self::Rotate270),
            _ => None,
        }
    }
}

/// Pixels row by row, each of some channels, each of one byte or of two with the higher first.
#[derive(Debug)]
pub(crate) struct Raster {
    stored: [usize; 2],
    channels: usize,
    wide: bool,
    bytes: Vec<u8>,
    orientation: Orientation,
}

impl Raster {
    /// A PNG or JPEG file, of a size that the check allows.
    pub fn decode(
        bytes: &[u8],
        check: impl Fn(u32, u32) -> Result<(), PhotoError>,
    ) -> Result<Self, PhotoError> {
        if bytes.starts_with(b"\x89PNG\r\n\x1a\n") {
            Self::of_png(bytes, check)
        } else if !bytes.starts_with(&[0xff, 0xd8, 0xff]) {
            Err(PhotoError::NotAnImage)
        } else if is_whole_jpeg(bytes) {
            Self::of_jpeg(bytes, check)
        } else {
            // The decoder takes what is missing at the end of a file for grey.
            Err(broken("the file ends too early"))
        }
    }

    fn of_png(
        bytes: &[u8],
        check: impl Fn(u32, u32) -> Result<(), PhotoError>,
    ) -> Result<Self, PhotoError> {
        let limits = png::Limits { bytes: MOST_BESIDE_PIXELS };
        let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), limits);
        let info = decoder.read_header_info().map_err(broken)?;
        let (width, height) = (info.width, info.height);
        check(width, height)?;
        // Palettes become colours, and fewer than eight bits eight.
        decoder.set_transformations(Transformations::EXPAND);
        let mut reader = decoder.read_info().map_err(broken)?;
        let size = reader.output_buffer_size().ok_or_else(|| broken("it is too large"))?;
        let (colour, depth) = reader.output_color_type();
        let mut pixels = vec![0; size];
        reader.next_frame(&mut pixels).map_err(broken)?;
        Ok(Self {
            stored: [width as usize, height as usize],
            channels: colour.samples(),
            wide: depth == png::BitDepth::Sixteen,
            bytes: pixels,
            orientation: orientation(reader.info().exif_metadata.as_deref()),
        })
    }

    fn of_jpeg(
        bytes: &[u8],
        check: impl Fn(u32, u32) -> Result<(), PhotoError>,
    ) -> Result<Self, PhotoError> {
        // The size is checked here, where the message can name it.
        let options = DecoderOptions::default()
            .set_strict_mode(false)
            .set_max_width(usize::MAX)
            .set_max_height(usize::MAX);
        let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
        decoder.decode_headers().map_err(broken)?;
        let (width, height) = decoder.dimensions().ok_or_else(|| broken("it has no size"))?;
        let side = |length: usize| u32::try_from(length).unwrap_or(u32::MAX);
        check(side(width), side(height))?;
        let colour = match decoder.input_colorspace() {
            Some(ColorSpace::Luma) => ColorSpace::Luma,
            _ => ColorSpace::RGB,
        };
        decoder.set_options(options.jpeg_set_out_colorspace(colour));
        let channels = colour.num_components();
        let mut pixels = vec![0; width * height * channels];
        decoder.decode_into(&mut pixels).map_err(broken)?;
        let orientation = orientation(decoder.exif().map(Vec::as_slice));
        Ok(Self { stored: [width, height], channels, wide: false, bytes: pixels, orientation })
    }

    /// Columns and rows of the upright picture.
    pub fn size(&self) -> [usize; 2] {
        let [width, height] = self.stored;
        match self.orientation {
            Orientation::NoTransforms
            | Orientation::Rotate180
            | Orientation::FlipHorizontal
            | Orientation::FlipVertical => [width, height],
            Orientation::Rotate90
            | Orientation::Rotate270
            | Orientation::Rotate90FlipH
            | Orientation::Rotate270FlipH => [height, width],
        }
    }

    /// Whether the stored picture has to be turned.
    pub fn is_turned(&self) -> bool {
        self.orientation != Orientation::NoTransforms
    }

    /// Red, green and blue from 0 to 1 at a place of the upright picture.
    pub fn colour(&self, x: usize, y: usize) -> [f32; 3] {
        let [width, height] = self.stored;
        let (x, y) = match self.orientation {
            Orientation::NoTransforms => (x, y),
            Orientation::Rotate180 => (width - 1 - x, height - 1 - y),
            Orientation::FlipHorizontal => (width - 1 - x, y),
            Orientation::FlipVertical => (x, height - 1 - y),
            Orientation::Rotate90 => (y, height - 1 - x),
            Orientation::Rotate270 => (width - 1 - y, x),
            Orientation::Rotate90FlipH => (y, x),
            Orientation::Rotate270FlipH => (width - 1 - y, height - 1 - x),
        };
        let first = (y * width + x) * self.channels;
        // Grey has one channel, or two with its transparency.
        let step = usize::from(self.channels > 2);
        [0, 1, 2].map(|channel| {
            let at = first + step * channel;
            match self.wide {
                false => f32::from(self.bytes[at]) / 255.0,
                true => {
                    let level = u16::from_be_bytes([self.bytes[2 * at], self.bytes[2 * at + 1]]);
                    f32::from(level) / 65_535.0
                }
            }
        })
    }
}

fn broken(reason: impl core::fmt::Display) -> PhotoError {
    PhotoError::Broken { reason: reason.to_string() }
}

/// How the stored picture is turned, as its Exif data say: upright where they do not.
fn orientation(data: Option<&[u8]>) -> Orientation {
    let read = |data: &[u8]| {
        let mut reader = exif::Reader::new();
        let read = reader.continue_on_error(true).read_raw(data.to_vec());
        let exif = read.or_else(|error| error.distill_partial_result(|_| {})).ok()?;
        let field = exif.get_field(exif::Tag::Orientation, exif::In::PRIMARY)?;
        Orientation::of_exif(field.value.get_uint(0)?)
    };
    data.and_then(read).unwrap_or(Orientation::NoTransforms)
}

/// Whether the scan of a JPEG file has an end (ITU-T T.81, annex B): segments with their lengths up to the start of
/// scan, and after that, where no byte FF stands before anything else but a zero or a restart, the end of image.
fn is_whole_jpeg(bytes: &[u8]) -> bool {
    const START_OF_SCAN: u8 = 0xda;
    const END_OF_IMAGE: [u8; 2] = [0xff, 0xd9];
    let mut at = 2;
    while let Some(&[0xff, marker, high, low]) = bytes.get(at..at + 4) {
        // Bytes FF may fill up before a marker.
        if marker == 0xff {
            at += 1;
            continue;
        }
        at += 2 + usize::from(u16::from_be_bytes([high, low]));
        if marker == START_OF_SCAN {
            let scan = bytes.get(at..).unwrap_or_default();
            return scan.windows(2).any(|pair| pair == END_OF_IMAGE);
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use image::DynamicImage;

    use super::*;

    /// Two rows of three pixels, each of another level of grey.
    fn raster(orientation: Orientation) -> Raster {
        let bytes = (0..6).map(|i| 40 * i).collect();
        Raster { stored: [3, 2], channels: 1, wide: false, bytes, orientation }
    }

    #[test]
    fn pixels_are_turned_as_exif_says() {
        for number in 1..=8 {
            let orientation = Orientation::of_exif(number).unwrap();
            let raster = raster(orientation);
            let grey = image::GrayImage::from_raw(3, 2, raster.bytes.clone()).unwrap();
            let mut expected = DynamicImage::ImageLuma8(grey);
            expected
                .apply_orientation(image::metadata::Orientation::from_exif(number as u8).unwrap());
            let [width, height] = raster.size();
            assert_eq!([expected.width() as usize, expected.height() as usize], [width, height]);
            assert_eq!(raster.is_turned(), number != 1);
            for (i, pixel) in expected.to_rgb32f().pixels().enumerate() {
                let [level, ..] = raster.colour(i % width, i / width);
                assert!((pixel.0[0] - level).abs() < 1e-6, "{orientation:?} {i}");
            }
        }
    }
}
