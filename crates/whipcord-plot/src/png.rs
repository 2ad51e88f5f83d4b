//! PNG from SVG.

use resvg::usvg::{Options, Tree};
use resvg::{tiny_skia, usvg};

use crate::error::PlotError;
use crate::outlines::outlined;

/// Longest side of a PNG in pixels.
const LARGEST: u32 = 16_384;

/// An SVG of this crate as PNG, `scale` pixels to the SVG's px. Letters come from a font in this crate: the
/// picture is the same on every machine.
///
/// ```
/// use whipcord_plot::png;
///
/// let svg = r#"<svg xmlns="http://www.w3.org/2000/svg" width="20" height="10"/>"#;
/// let bytes = png(svg, 2.0)?;
/// assert_eq!(&bytes[1..4], b"PNG");
/// # Ok::<(), whipcord_plot::PlotError>(())
/// ```
///
/// # Errors
/// [`PlotError`] when the SVG cannot be read or the picture would have no pixels or too many.
pub fn png(svg: &str, scale: f64) -> Result<Vec<u8>, PlotError> {
    pixels(svg, scale)?.encode_png().map_err(|e| PlotError::Png(e.to_string()))
}

/// An SVG as pixels.
pub(crate) fn pixels(svg: &str, scale: f64) -> Result<tiny_skia::Pixmap, PlotError> {
    let tree = Tree::from_str(&outlined(svg)?, &Options::default())
        .map_err(|e| PlotError::Svg(e.to_string()))?;
    let [width, height] =
        [tree.size().width(), tree.size().height()].map(|side| (f64::from(side) * scale).round());
    let size = PlotError::Size { width, height, largest: LARGEST };
    let fits = |side: f64| (1.0..=f64::from(LARGEST)).contains(&side);
    if !fits(width) || !fits(height) {
        return Err(size);
    }
    let mut pixels = tiny_skia::Pixmap::new(width as u32, height as u32).ok_or(size)?;
    let transform = usvg::Transform::from_scale(scale as f32, scale as f32);
    resvg::render(&tree, transform, &mut pixels.as_mut());
    Ok(pixels)
}
