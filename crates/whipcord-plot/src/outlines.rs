//! Texts of an SVG as outlines of letters, for programs that have no fonts.

use core::fmt::Write as _;

use resvg::usvg::roxmltree::{Document, Node};
use ttf_parser::OutlineBuilder;

use crate::error::PlotError;
use crate::font;
use crate::svg::escape;

/// Attributes of a text that its outlines contain.
const OF_TEXT: [&str; 7] =
    ["class", "x", "y", "font-family", "font-size", "font-weight", "text-anchor"];

/// Size of letters where none is given: the medium size of CSS.
const MEDIUM: f64 = 16.0;

/// An SVG of this crate with each text replaced by a path of the class `text`, which looks the same in every
/// program.
///
/// ```
/// let svg = r#"<svg xmlns="http://www.w3.org/2000/svg" width="20" height="10"><text y="9">z</text></svg>"#;
/// let outlined = whipcord_plot::outlined(svg)?;
/// assert!(outlined.contains("<path class=\"text\"") && !outlined.contains("<text"));
/// # Ok::<(), whipcord_plot::PlotError>(())
/// ```
///
/// # Errors
/// [`PlotError::Svg`] when the SVG cannot be read.
pub fn outlined(svg: &str) -> Result<String, PlotError> {
    let document = Document::parse(svg).map_err(|e| PlotError::Svg(e.to_string()))?;
    let mut out = String::with_capacity(2 * svg.len());
    let mut copied = 0;
    for text in document.descendants().filter(|node| node.has_tag_name("text")) {
        let range = text.range();
        out.push_str(&svg[copied..range.start]);
        write_path(&mut out, text)?;
        copied = range.end;
    }
    out.push_str(&svg[copied..]);
    Ok(out)
}

fn write_path(out: &mut String, text: Node<'_, '_>) -> Result<(), PlotError> {
    let line = Line::of(text)?;
    let width: f64 = line.letters.iter().map(|letter| line.width(letter)).sum();
    let before = match inherited(text, "text-anchor") {
        Some("middle") => 0.5 * width,
        Some("end") => width,
        _ => 0.0,
    };
    out.push_str("<path class=\"text\"");
    for attribute in text.attributes().filter(|a| !OF_TEXT.contains(&a.name())) {
        let _ = write!(out, " {}=\"{}\"", attribute.name(), escape(attribute.value()));
    }
    out.push_str(" d=\"");
    let mut x = number(text, "x")?.unwrap_or(0.0) - before;
    let baseline = number(text, "y")?.unwrap_or(0.0);
    for letter in &line.letters {
        let mut pen = Pen { out, origin: [x, baseline + letter.drop], size: letter.size };
        font::outline(letter.symbol, line.bold, &mut pen);
        x += line.width(letter);
    }
    out.push_str("\"/>");
    Ok(())
}

/// A letter, its size, and how far it stands below the baseline, in px.
struct Letter {
    symbol: char,
    size: f64,
    drop: f64,
}

/// A line of text.
struct Line {
    letters: Vec<Letter>,
    bold: bool,
}

impl Line {
    /// The letters of an element and of the spans in it. White space counts once, and not at the ends.
    fn of(text: Node<'_, '_>) -> Result<Self, PlotError> {
        let mut letters: Vec<Letter> = Vec::new();
        let mut drop = 0.0;
        for part in text.children() {
            let element = if part.is_element() { part } else { text };
            if part.is_element() {
                drop += number(part, "dy")?.unwrap_or(0.0);
            }
            let size = inherited_number(element, "font-size")?.unwrap_or(MEDIUM);
            for symbol in part.text().unwrap_or_default().chars() {
                let symbol = if symbol.is_ascii_whitespace() { ' ' } else { symbol };
                if symbol != ' ' || letters.last().is_some_and(|last| last.symbol != ' ') {
                    letters.push(Letter { symbol, size, drop });
                }
            }
        }
        if letters.last().is_some_and(|last| last.symbol == ' ') {
            letters.pop();
        }
        Ok(Self { letters, bold: inherited(text, "font-weight") == Some("bold") })
    }

    fn width(&self, letter: &Letter) -> f64 {
        font::width(letter.symbol.encode_utf8(&mut [0; 4]), letter.size, self.bold)
    }
}

/// An attribute of an element or of the nearest one around it that has it.
fn inherited<'a>(node: Node<'a, '_>, name: &str) -> Option<&'a str> {
    node.ancestors().find_map(|node| node.attribute(name))
}

fn inherited_number(node: Node<'_, '_>, name: &str) -> Result<Option<f64>, PlotError> {
    node.ancestors().find(|node| node.has_attribute(name)).map_or(Ok(None), |n| number(n, name))
}

fn number(node: Node<'_, '_>, name: &str) -> Result<Option<f64>, PlotError> {
    let read = |value: &str| {
        let read = value.parse().ok().filter(|number: &f64| number.is_finite());
        read.ok_or_else(|| PlotError::Svg(format!("{name}=\"{value}\" is not a number")))
    };
    node.attribute(name).map(read).transpose()
}

/// Writes path data, at a place on the baseline in px.
struct Pen<'a> {
    out: &'a mut String,
    origin: [f64; 2],
    size: f64,
}

impl Pen<'_> {
    fn write(&mut self, command: char, points: &[[f32; 2]]) {
        self.out.push(command);
        for (i, &[x, y]) in points.iter().enumerate() {
            let x = self.origin[0] + self.size * f64::from(x);
            let y = self.origin[1] - self.size * f64::from(y);
            let separator = if i == 0 { "" } else { " " };
            let _ = write!(self.out, "{separator}{x:.4} {y:.4}");
        }
    }
}

impl OutlineBuilder for Pen<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        self.write('M', &[[x, y]]);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.write('L', &[[x, y]]);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.write('Q', &[[x1, y1], [x, y]]);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.write('C', &[[x1, y1], [x2, y2], [x, y]]);
    }

    fn close(&mut self) {
        self.write('Z', &[]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn in_svg(body: &str) -> String {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"99\" height=\"99\" font-size=\"10\">{body}</svg>"
        )
    }

    /// Coordinates of a path, every second one an x.
    fn extent(outlined: &str) -> [f64; 4] {
        let start = outlined.find(" d=\"").unwrap() + 4;
        let data = outlined[start..].split('"').next().unwrap();
        let numbers = data.split(|c: char| c.is_ascii_uppercase() || c == ' ');
        let numbers = numbers.filter(|n| !n.is_empty()).map(|n| n.parse::<f64>().unwrap());
        let mut extent = [f64::MAX, f64::MIN, f64::MAX, f64::MIN];
        for (i, value) in numbers.enumerate() {
            let axis = 2 * (i % 2);
            extent[axis] = extent[axis].min(value);
            extent[axis + 1] = extent[axis + 1].max(value);
        }
        extent
    }

    #[test]
    fn letters_stand_at_their_anchor() {
        let of = |anchor: &str| {
            let text = format!("<text x=\"50\" y=\"20\"{anchor}>HH</text>");
            extent(&outlined(&in_svg(&text)).unwrap())
        };
        let width = font::width("HH", 10.0, false);
        let (start, middle, end) =
            (of(""), of(" text-anchor=\"middle\""), of(" text-anchor=\"end\""));
        // An H has as much space on its left as on its right.
        assert!((0.5 * (middle[0] + middle[1]) - 50.0).abs() < 0.05, "{middle:?}");
        assert!((start[0] - middle[0] - 0.5 * width).abs() < 1e-3);
        assert!((end[0] - middle[0] + 0.5 * width).abs() < 1e-3);
        // On the baseline, as high as capitals of Arimo.
        assert!(
            (start[3] - 20.0).abs() < 1e-3 && (start[2] - 20.0 + 6.88).abs() < 0.05,
            "{start:?}"
        );
    }

    #[test]
    fn exponents_are_raised_and_smaller() {
        let text = "<text x=\"0\" y=\"20\">H<tspan dy=\"-4\" font-size=\"5\">H</tspan></text>";
        let [_, right, top, _] = extent(&outlined(&in_svg(text)).unwrap());
        let width = font::width("H", 10.0, false) + font::width("H", 5.0, false);
        assert!(right < width && right > width - 0.6, "{right} {width}");
        assert!((top - (16.0 - 3.44)).abs() < 0.4, "{top}");
    }

    #[test]
    fn white_space_counts_once() {
        let of = |text: &str| outlined(&in_svg(&format!("<text>{text}</text>"))).unwrap();
        assert_eq!(of("  a \n b "), of("a b"));
        assert_ne!(of("a b"), of("ab"));
    }

    #[test]
    fn everything_else_stays() {
        let svg = in_svg(
            "<g class=\"a\"><text fill=\"#123\" transform=\"rotate(-90)\">é&lt;</text><rect/></g>",
        );
        let outlined = outlined(&svg).unwrap();
        assert!(outlined.contains(
            "<g class=\"a\"><path class=\"text\" fill=\"#123\" transform=\"rotate(-90)\""
        ));
        assert!(outlined.ends_with("/><rect/></g></svg>"));
        assert!(matches!(super::outlined("<svg"), Err(PlotError::Svg(_))));
        assert!(matches!(super::outlined(&in_svg("<text x=\"a\"/>")), Err(PlotError::Svg(_))));
    }
}
