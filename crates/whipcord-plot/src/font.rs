//! The font that ships with the crate: how wide text is in it, and the outlines of its letters.
//!
//! Arimo has the widths of Arial, Helvetica and Liberation Sans, so that what is laid out with it
//! also fits in a browser that has one of those.

use std::sync::LazyLock;

use ttf_parser::{Face, GlyphId, OutlineBuilder};

/// The font, and those of the same widths, for `font-family`.
pub(crate) const FAMILY: &str = "Arimo,'Liberation Sans',Arial,Helvetica,sans-serif";

static REGULAR: &[u8] = include_bytes!("../fonts/Arimo-Regular.ttf");
static BOLD: &[u8] = include_bytes!("../fonts/Arimo-Bold.ttf");

static FACES: LazyLock<[Option<Face<'static>>; 2]> =
    LazyLock::new(|| [REGULAR, BOLD].map(|data| Face::parse(data, 0).ok()));

/// Width of a letter the font does not have, in em: that of a wide one.
const UNKNOWN: f64 = 1.0;

/// The glyph of every letter that the font does not have: a box.
const MISSING: GlyphId = GlyphId(0);

/// Width of a line of text in px.
pub(crate) fn width(text: &str, size: f64, bold: bool) -> f64 {
    let face = FACES[usize::from(bold)].as_ref();
    let letter = |c| face.and_then(|face| advance(face, c)).unwrap_or(UNKNOWN);
    size * text.chars().map(letter).sum::<f64>()
}

/// Width of a letter in em.
fn advance(face: &Face<'_>, letter: char) -> Option<f64> {
    let units = face.glyph_hor_advance(face.glyph_index(letter)?)?;
    Some(f64::from(units) / f64::from(face.units_per_em()))
}

/// Draws the outline of a letter in em, with y upwards from the baseline. Nothing for white space.
pub(crate) fn outline(letter: char, bold: bool, pen: &mut dyn OutlineBuilder) {
    if let Some(face) = &FACES[usize::from(bold)] {
        let mut scaled = Scaled { pen, scale: 1.0 / f32::from(face.units_per_em()) };
        face.outline_glyph(face.glyph_index(letter).unwrap_or(MISSING), &mut scaled);
    }
}

/// Passes coordinates on in em instead of in units of the font.
struct Scaled<'a> {
    pen: &'a mut dyn OutlineBuilder,
    scale: f32,
}

impl OutlineBuilder for Scaled<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        self.pen.move_to(self.scale * x, self.scale * y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.pen.line_to(self.scale * x, self.scale * y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let k = self.scale;
        self.pen.quad_to(k * x1, k * y1, k * x, k * y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let k = self.scale;
        self.pen.curve_to(k * x1, k * y1, k * x2, k * y2, k * x, k * y);
    }

    fn close(&mut self) {
        self.pen.close();
    }
}

/// The text, or its beginning and an ellipsis where it is wider than `limit` px.
pub(crate) fn elide(text: &str, size: f64, limit: f64) -> String {
    if width(text, size, false) <= limit {
        return text.to_owned();
    }
    let mut short = String::new();
    for c in text.chars() {
        short.push(c);
        if width(&short, size, false) + width("…", size, false) > limit {
            short.pop();
            break;
        }
    }
    short.truncate(short.trim_end().len());
    short.push('…');
    short
}

/// The text in lines of at most `limit` px, broken between words where that is possible.
pub(crate) fn wrap(text: &str, size: f64, bold: bool, limit: f64) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let last = lines.len() - 1;
        let line = &mut lines[last];
        let joined = if line.is_empty() { word.to_owned() } else { format!("{line} {word}") };
        if width(&joined, size, bold) <= limit {
            *line = joined;
            continue;
        }
        if !line.is_empty() {
            lines.push(String::new());
        }
        for c in word.chars() {
            let last = lines.len() - 1;
            if !lines[last].is_empty() && width(&format!("{}{c}", lines[last]), size, bold) > limit
            {
                lines.push(String::new());
            }
            let last = lines.len() - 1;
            lines[last].push(c);
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_are_those_of_helvetica() {
        // Helvetica: digits 556, minus 584, space 278 of 1000.
        assert!((width("0123456789", 100.0, false) - 556.0).abs() < 1.0);
        assert!((width("−", 1000.0, false) - 584.0).abs() < 1.0);
        assert!((width(" ", 1000.0, true) - 278.0).abs() < 1.0);
    }

    #[test]
    fn signs_of_figures_are_there() {
        for bold in [0, 1] {
            let face = FACES[bold].as_ref().unwrap();
            for c in "µμ°−×·≤≥≈→′″…τφωδ²³–—éÅßŁжЯ".chars() {
                assert!(face.glyph_index(c).is_some(), "{c}");
            }
        }
    }

    #[test]
    fn long_text_is_elided_or_wrapped() {
        let text = "a rather long description of a robot with an unpronounceablylongname";
        let short = elide(text, 10.0, 80.0);
        assert!(short.ends_with('…') && width(&short, 10.0, false) <= 80.0);
        assert_eq!(elide("short", 10.0, 80.0), "short");
        let lines = wrap(text, 10.0, false, 80.0);
        assert!(lines.iter().all(|line| width(line, 10.0, false) <= 80.0));
        assert_eq!(lines.concat().replace(' ', ""), text.replace(' ', ""));
        assert_eq!(wrap("", 10.0, true, 80.0), [""]);
    }
}
