//! Films as animated PNG, which browsers play.

use ::png::{BitDepth, BlendOp, ColorType, Encoder, EncodingError};

use crate::error::PlotError;
use crate::png::pixels;

/// A picture of a film.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmFrame {
    /// The picture.
    pub svg: String,
    /// How long it is seen in ms.
    pub milliseconds: u16,
}

/// Bytes of a pixel.
const CHANNELS: usize = 3;

/// A film that begins again at its end, as APNG, as large as the largest of its pictures: others have white to the right and below. Of each only the
/// rectangle is stored that differs from the one before.
///
/// # Errors
/// [`PlotError`] without pictures, or where one cannot be drawn.
pub fn film(frames: &[FilmFrame]) -> Result<Vec<u8>, PlotError> {
    let failed = |error: EncodingError| PlotError::Png(error.to_string());
    let (pictures, [width, height]) = pictures(frames)?;
    let mut before = Vec::new();
    let count = u32::try_from(frames.len()).unwrap_or(u32::MAX);
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, width, height);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_animated(count, 0).map_err(failed)?;
    encoder.set_blend_op(BlendOp::Source).map_err(failed)?;
    let mut writer = encoder.write_header().map_err(failed)?;
    for (frame, picture) in frames.iter().zip(&pictures) {
        writer.set_frame_delay(frame.milliseconds, 1000).map_err(failed)?;
        let now = picture.on_white(width, height);
        if before.is_empty() {
            writer.write_image_data(&now).map_err(failed)?;
            before = now;
            continue;
        }
        let [[left, right], [top, bottom]] = changed(&before, &now, width as usize);
        let part: Vec<u8> = (top..bottom)
            .flat_map(|y| {
                let row = y * width as usize;
                now[(row + left) * CHANNELS..(row + right) * CHANNELS].iter().copied()
            })
            .collect();
        let size = |from: usize, to: usize| u32::try_from(to - from).unwrap_or(0);
        writer.reset_frame_position().map_err(failed)?;
        writer.set_frame_dimension(size(left, right), size(top, bottom)).map_err(failed)?;
        writer.set_frame_position(size(0, left), size(0, top)).map_err(failed)?;
        writer.write_image_data(&part).map_err(failed)?;
        before = now;
    }
    writer.finish().map_err(failed)?;
    Ok(bytes)
}

/// The pixels of a film: red, green and blue of each, by rows. All pictures are of one size.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FilmPixels {
    /// Width in px, which is even.
    pub width: u32,
    /// Height in px, which is even.
    pub height: u32,
    /// The pixels of each picture.
    pub pictures: Vec<Vec<u8>>,
}

/// The pixels of a film for an encoder of another format, as large as the largest of its pictures and even: others have white to the right and below.
///
/// # Errors
/// As [`film`].
pub fn film_pixels(frames: &[FilmFrame]) -> Result<FilmPixels, PlotError> {
    let (pictures, size) = pictures(frames)?;
    let [width, height] = size.map(|size| size.next_multiple_of(2));
    let pictures = pictures.iter().map(|picture| picture.on_white(width, height)).collect();
    Ok(FilmPixels { width, height, pictures })
}

/// The pictures of a film, and the size of the largest.
fn pictures(frames: &[FilmFrame]) -> Result<(Vec<Picture>, [u32; 2]), PlotError> {
    let pictures = frames.iter().map(|frame| rgb(&frame.svg));
    let pictures: Vec<Picture> = pictures.collect::<Result<_, _>>()?;
    let largest = |size: fn(&Picture) -> u32| pictures.iter().map(size).max();
    match (largest(|of| of.width), largest(|of| of.height)) {
        (Some(width), Some(height)) => Ok((pictures, [width, height])),
        _ => Err(PlotError::Empty { what: "the film".to_owned() }),
    }
}

/// The pixels of a picture without their opacity: films are of whole pictures.
struct Picture {
    width: u32,
    height: u32,
    bytes: Vec<u8>,
}

impl Picture {
    /// The pixels in the upper left corner of a white picture that is no smaller.
    fn on_white(&self, width: u32, height: u32) -> Vec<u8> {
        let row = |width: u32| width as usize * CHANNELS;
        let mut bytes = vec![u8::MAX; row(width) * height as usize];
        let own = self.bytes.chunks_exact(row(self.width));
        for (to, from) in bytes.chunks_exact_mut(row(width)).zip(own) {
            to[..from.len()].copy_from_slice(from);
        }
        bytes
    }
}

fn rgb(svg: &str) -> Result<Picture, PlotError> {
    let map = pixels(svg, 1.0)?;
    let all = map.pixels().iter().map(|pixel| pixel.demultiply());
    let bytes = all.flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]).collect();
    Ok(Picture { width: map.width(), height: map.height(), bytes })
}

/// Columns and rows between which two pictures differ; one pixel where they are the same.
fn changed(before: &[u8], now: &[u8], width: usize) -> [[usize; 2]; 2] {
    let (mut columns, mut rows) = ([usize::MAX, 0], [usize::MAX, 0]);
    let pixels = before.chunks_exact(CHANNELS).zip(now.chunks_exact(CHANNELS)).enumerate();
    for (number, _) in pixels.filter(|(_, (a, b))| a != b) {
        let (x, y) = (number % width, number / width);
        columns = [columns[0].min(x), columns[1].max(x + 1)];
        rows = [rows[0].min(y), rows[1].max(y + 1)];
    }
    if columns[1] == 0 { [[0, 1], [0, 1]] } else { [columns, rows] }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    fn frame(x: u32, milliseconds: u16) -> FilmFrame {
        let svg = format!(
            r##"<svg xmlns="http://www.w3.org/2000/svg" width="40" height="20"><rect width="40" height="20" fill="#ffffff"/><rect x="{x}" y="5" width="4" height="6" fill="#ff0000"/></svg>"##
        );
        FilmFrame { svg, milliseconds }
    }

    /// Of each picture its column, row, width, height and milliseconds, from the chunks `fcTL`.
    fn pictures(bytes: &[u8]) -> Vec<[u32; 5]> {
        let number = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
        let (mut at, mut found) = (8, Vec::new());
        while at < bytes.len() {
            let data = at + 8;
            if &bytes[at + 4..data] == b"fcTL" {
                let [width, height, x, y, delay] = [4, 8, 12, 16, 20].map(|k| number(data + k));
                assert_eq!(delay & 0xffff, 1000);
                found.push([x, y, width, height, delay >> 16]);
            }
            at = data + number(at) as usize + 4;
        }
        found
    }

    #[test]
    fn a_film_has_what_changes_and_its_times() {
        let bytes = film(&[frame(2, 100), frame(9, 250), frame(9, 40)]).unwrap();
        let expected = [[0, 0, 40, 20, 100], [2, 5, 11, 6, 250], [0, 0, 1, 1, 40]];
        assert_eq!(pictures(&bytes), expected);
        assert!(film(&[]).is_err() && film_pixels(&[]).is_err());
        let pixels = film_pixels(&[frame(2, 100), frame(9, 250)]).unwrap();
        assert_eq!((pixels.width, pixels.height, pixels.pictures.len()), (40, 20, 2));
        // Red in the second picture where the rectangle has moved, white in the first.
        let at = 3 * (40 * 7 + 11);
        assert_eq!([0, 1].map(|k: usize| pixels.pictures[k][at + 1]), [255, 0]);
        let svg = frame(2, 1).svg.replace("width=\"40\"", "width=\"41\"");
        let other = FilmFrame { svg, milliseconds: 1 };
        // Every picture has the size of the largest.
        let wider = pictures(&film(&[frame(2, 1), other]).unwrap());
        assert_eq!((wider[0], wider[1][2..4].to_vec()), ([0, 0, 41, 20, 1], vec![1, 1]));
    }
}
