//! The font that ships with the crate, and how wide text is in it.
//!
//! Arimo has the widths of Arial, Helvetica and Liberation Sans, so that what is laid out with it
//! also fits in a browser that has one of those.

use std::sync::LazyLock;

use skrifa::charmap::Charmap;
use skrifa::instance::{LocationRef, Size};
use skrifa::metrics::GlyphMetrics;
use skrifa::{FontRef, MetadataProvider};

/// The font, and those of the same widths, for `font-family`.
pub(crate) const FAMILY: &str = "Arimo,'Liberation Sans',Arial,Helvetica,sans-serif";

pub(crate) static REGULAR: &[u8] = include_bytes!("../fonts/Arimo-Regular.ttf");
pub(crate) static BOLD: &[u8] = include_bytes!("../fonts/Arimo-Bold.ttf");

struct Widths {
    charmap: Charmap<'static>,
    glyphs: GlyphMetrics<'static>,
}

static WIDTHS: LazyLock<[Option<Widths>; 2]> = LazyLock::new(|| {
    [REGULAR, BOLD].map(|data| {
        let font = FontRef::new(data).ok()?;
        // Units per em is what `width` divides by.
        let glyphs = font.glyph_metrics(Size::new(1.0), LocationRef::default());
        Some(Widths { charmap: font.charmap(), glyphs })
    })
});

/// Width of a letter the font does not have, in em: that of a wide one.
const UNKNOWN: f64 = 1.0;

/// Width of a line of text in px.
pub(crate) fn width(text: &str, size: f64, bold: bool) -> f64 {
    let widths = WIDTHS[usize::from(bold)].as_ref();
    let letter = |c| {
        widths.and_then(|w| w.glyphs.advance_width(w.charmap.map(c)?)).map_or(UNKNOWN, f64::from)
    };
    size * text.chars().map(letter).sum::<f64>()
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
            let widths = WIDTHS[bold].as_ref().unwrap();
            for c in "µμ°−×·≤≥≈→′″…τφωδ²³–—éÅßŁжЯ".chars() {
                assert!(widths.charmap.map(c).is_some(), "{c}");
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
