//! Writing SVG: a few elements, short numbers, and never a coordinate that is none.

use core::fmt::Write as _;

use crate::colour::Colour;
use crate::error::PlotError;
use crate::font;

/// A place in px, from the upper left corner, y downwards.
pub(crate) type Point = [f64; 2];

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stroke {
    pub colour: Colour,
    pub width: f64,
    pub dash: &'static str,
    /// Whether a line ends at its ends, rather than in half a circle round them.
    pub flat: bool,
}

impl Stroke {
    pub const fn new(colour: Colour, width: f64) -> Self {
        Self { colour, width, dash: "", flat: false }
    }

    pub const fn dash(self, dash: &'static str) -> Self {
        Self { dash, ..self }
    }
}

/// How an area is drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fill {
    pub colour: Colour,
    pub opacity: f64,
}

impl Fill {
    pub const fn new(colour: Colour) -> Self {
        Self { colour, opacity: 1.0 }
    }

    pub const fn opacity(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }
}

/// Which part of a text lies at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// A line of text whose middle height lies at its place.
#[derive(Clone, Debug)]
pub(crate) struct Text<'a> {
    pub content: &'a str,
    /// Raised and smaller, after the content.
    pub exponent: &'a str,
    pub size: f64,
    pub anchor: Anchor,
    pub bold: bool,
    pub colour: Colour,
    /// Read from below.
    pub upwards: bool,
}

impl<'a> Text<'a> {
    pub const fn new(content: &'a str, size: f64) -> Self {
        Self {
            content,
            exponent: "",
            size,
            anchor: Anchor::Start,
            bold: false,
            colour: Colour::INK,
            upwards: false,
        }
    }

    pub const fn anchor(self, anchor: Anchor) -> Self {
        Self { anchor, ..self }
    }
}

/// Size of an exponent relative to what it stands by.
pub(crate) const EXPONENT_SIZE: f64 = 0.72;

/// A picture being drawn.
#[derive(Debug)]
pub(crate) struct Svg {
    body: String,
    width: f64,
    height: f64,
    /// A number that could not be written.
    bad: Option<f64>,
}

impl Svg {
    pub fn new(width: f64, height: f64) -> Self {
        Self { body: String::new(), width: width.ceil(), height: height.ceil(), bad: None }
    }

    /// The whole document.
    pub fn finish(self, title: &str) -> Result<String, PlotError> {
        if let Some(value) = self.bad {
            return Err(PlotError::NotFinite { what: "a coordinate".to_owned(), value });
        }
        let (w, h) = (self.width, self.height);
        let title = if title.is_empty() {
            String::new()
        } else {
            format!("<title>{}</title>\n", escape(title))
        };
        Ok(format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" font-family=\"{family}\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n{title}<rect width=\"{w}\" height=\"{h}\" fill=\"#fff\"/>\n{body}</svg>\n",
            family = font::FAMILY,
            body = self.body,
        ))
    }

    /// Starts a group of this class.
    pub fn open(&mut self, class: &str) {
        let _ = writeln!(self.body, "<g class=\"{}\">", escape(class));
    }

    /// Starts a group of this class of which nothing is seen outside a box.
    pub fn open_within(&mut self, class: &str, at: Point, size: Point) {
        let class = escape(class);
        let _ = write!(self.body, "<clipPath id=\"{class}-box\">");
        self.rect(at, size, None, None);
        let _ = writeln!(self.body, "</clipPath>");
        let _ = writeln!(self.body, "<g class=\"{class}\" clip-path=\"url(#{class}-box)\">");
    }

    /// A picture, by its address, stretched to this size.
    pub fn image(&mut self, at: Point, size: Point, address: &str) {
        self.body.push_str("<image preserveAspectRatio=\"none\"");
        self.attribute("x", at[0]);
        self.attribute("y", at[1]);
        self.attribute("width", size[0]);
        self.attribute("height", size[1]);
        let _ = write!(self.body, " href=\"{}\"", escape(address));
        self.end();
    }

    /// Ends the group.
    pub fn close(&mut self) {
        self.body.push_str("</g>\n");
    }

    pub fn line(&mut self, a: Point, b: Point, stroke: Stroke) {
        self.body.push_str("<path d=\"");
        self.path_data(&[a, b], false);
        self.body.push('"');
        self.stroke(stroke);
        self.end();
    }

    /// A line through points.
    pub fn polyline(&mut self, points: &[Point], stroke: Stroke, class: &str) {
        self.body.push_str("<path");
        self.class(class);
        self.body.push_str(" d=\"");
        self.path_data(points, false);
        self.body.push_str("\" fill=\"none\"");
        self.stroke(stroke);
        self.end();
    }

    pub fn polygon(&mut self, points: &[Point], fill: Option<Fill>, stroke: Option<Stroke>) {
        self.body.push_str("<path d=\"");
        self.path_data(points, true);
        self.body.push('"');
        self.paint(fill, stroke);
        self.end();
    }

    pub fn rect(&mut self, at: Point, size: Point, fill: Option<Fill>, stroke: Option<Stroke>) {
        self.body.push_str("<rect");
        self.attribute("x", at[0]);
        self.attribute("y", at[1]);
        self.attribute("width", size[0]);
        self.attribute("height", size[1]);
        self.paint(fill, stroke);
        self.end();
    }

    pub fn circle(&mut self, at: Point, radius: f64, fill: Option<Fill>, stroke: Option<Stroke>) {
        self.body.push_str("<circle");
        self.attribute("cx", at[0]);
        self.attribute("cy", at[1]);
        self.attribute("r", radius);
        self.paint(fill, stroke);
        self.end();
    }

    /// An ellipse out of which others are cut; their rims are thinner than its own.
    pub fn plate(&mut self, rim: Ellipse, holes: &[Ellipse], fill: Fill, stroke: Stroke) {
        self.body.push_str("<path class=\"disk\" d=\"");
        self.ellipse_data(rim);
        if !holes.is_empty() {
            for &hole in holes {
                self.ellipse_data(hole);
            }
            self.body.push_str("\" fill-rule=\"evenodd");
        }
        let thin = Stroke { width: 0.4 * stroke.width, ..stroke };
        self.body.push('"');
        self.paint(Some(fill), Some(if holes.is_empty() { stroke } else { thin }));
        self.end();
        if !holes.is_empty() {
            self.body.push_str("<path d=\"");
            self.ellipse_data(rim);
            self.body.push('"');
            self.paint(None, Some(stroke));
            self.end();
        }
    }

    /// The side of a disk: what lies between the rims of its near and its far face.
    pub fn wall(&mut self, near: Ellipse, far: Ellipse, fill: Fill, stroke: Stroke) {
        let end = |of: Ellipse, sign: f64| {
            let (dx, dy) = (of.radii[0] * of.angle.cos(), of.radii[0] * of.angle.sin());
            [of.centre[0] + sign * dx, of.centre[1] + sign * dy]
        };
        // On which side of the long axis the far face lies.
        let [dx, dy] = [0, 1].map(|i| far.centre[i] - near.centre[i]);
        let beyond = dy * near.angle.cos() - dx * near.angle.sin() >= 0.0;
        let (there, back) = if beyond { (1, 0) } else { (0, 1) };
        self.body.push_str("<path d=\"");
        self.path_data(&[end(near, 1.0), end(far, 1.0)], false);
        self.arc_data(far, there, end(far, -1.0));
        let [x, y] = end(near, -1.0).map(|v| self.number(v));
        let _ = write!(self.body, "L{x} {y}");
        self.arc_data(near, back, end(near, 1.0));
        self.body.push_str("Z\"");
        self.paint(Some(fill), Some(stroke));
        self.end();
    }

    /// Half of an ellipse, to the other end of its long axis.
    fn arc_data(&mut self, ellipse: Ellipse, sweep: u8, to: Point) {
        let [a, b, turn, x, y] =
            [ellipse.radii[0], ellipse.radii[1], ellipse.angle.to_degrees(), to[0], to[1]]
                .map(|v| self.number(v));
        let _ = write!(self.body, "A{a} {b} {turn} 0 {sweep} {x} {y}");
    }

    /// A stretch of a round body: its outline, and the ellipses that close it.
    pub fn tube(&mut self, outline: &[Point], ends: &[Ellipse], colour: Colour) {
        // As the ellipses turn, so that what both cover is filled.
        let area: f64 = (0..outline.len())
            .map(|i| {
                let ([x0, y0], [x1, y1]) = (outline[i], outline[(i + 1) % outline.len()]);
                x0 * y1 - x1 * y0
            })
            .sum();
        let mut outline = outline.to_vec();
        if area > 0.0 {
            outline.reverse();
        }
        self.body.push_str("<path class=\"backbone\" d=\"");
        self.path_data(&outline, true);
        for &end in ends {
            self.ellipse_data(end);
        }
        self.body.push('"');
        // The rim closes the seams between stretches.
        self.paint(Some(Fill::new(colour)), Some(Stroke::new(colour, 0.4)));
        self.end();
    }

    pub fn text(&mut self, at: Point, text: &Text<'_>) {
        // Middle height of the capitals, which are 0.72 em high, on the place.
        let drop = 0.36 * text.size;
        self.body.push_str("<text");
        if text.upwards {
            let (x, y) = (self.number(at[0] + drop), self.number(at[1]));
            let _ = write!(self.body, " transform=\"translate({x} {y})rotate(-90)\"");
        } else {
            self.attribute("x", at[0]);
            self.attribute("y", at[1] + drop);
        }
        self.attribute("font-size", text.size);
        if text.bold {
            self.body.push_str(" font-weight=\"bold\"");
        }
        match text.anchor {
            Anchor::Start => {}
            Anchor::Middle => self.body.push_str(" text-anchor=\"middle\""),
            Anchor::End => self.body.push_str(" text-anchor=\"end\""),
        }
        let _ = write!(self.body, " fill=\"{}\"", text.colour);
        let _ = write!(self.body, ">{}", escape(text.content));
        if !text.exponent.is_empty() {
            let (dy, size) =
                (self.number(-0.38 * text.size), self.number(EXPONENT_SIZE * text.size));
            let _ = write!(
                self.body,
                "<tspan dy=\"{dy}\" font-size=\"{size}\">{}</tspan>",
                escape(text.exponent)
            );
        }
        self.body.push_str("</text>\n");
    }

    fn end(&mut self) {
        self.body.push_str("/>\n");
    }

    fn class(&mut self, class: &str) {
        if !class.is_empty() {
            let _ = write!(self.body, " class=\"{class}\"");
        }
    }

    fn paint(&mut self, fill: Option<Fill>, stroke: Option<Stroke>) {
        match fill {
            None => self.body.push_str(" fill=\"none\""),
            Some(Fill { colour, opacity }) => {
                let _ = write!(self.body, " fill=\"{colour}\"");
                if opacity < 1.0 {
                    self.attribute("fill-opacity", opacity);
                }
            }
        }
        if let Some(stroke) = stroke {
            self.stroke(stroke);
        }
    }

    fn stroke(&mut self, stroke: Stroke) {
        let _ = write!(self.body, " stroke=\"{}\"", stroke.colour);
        self.attribute("stroke-width", stroke.width);
        if stroke.flat {
            self.body.push_str(" stroke-linecap=\"butt\"");
        }
        if !stroke.dash.is_empty() {
            let _ = write!(self.body, " stroke-dasharray=\"{}\"", stroke.dash);
        }
    }

    fn attribute(&mut self, name: &str, value: f64) {
        let value = self.number(value);
        let _ = write!(self.body, " {name}=\"{value}\"");
    }

    fn path_data(&mut self, points: &[Point], closed: bool) {
        for (i, &[x, y]) in points.iter().enumerate() {
            let (x, y) = (self.number(x), self.number(y));
            let letter = match i {
                0 => "M",
                1 => "L",
                _ => " ",
            };
            let _ = write!(self.body, "{letter}{x} {y}");
        }
        if closed {
            self.body.push('Z');
        }
    }

    /// Two half turns from one end of the long axis to the other and back.
    fn ellipse_data(&mut self, ellipse: Ellipse) {
        let Ellipse { centre, radii: [a, b], angle } = ellipse;
        let (dx, dy) = (a * angle.cos(), a * angle.sin());
        let values = [centre[0] - dx, centre[1] - dy, a, b, angle.to_degrees()];
        let [x, y, a, b, turn] = values.map(|v| self.number(v));
        let [dx, dy, back_x, back_y] =
            [2.0 * dx, 2.0 * dy, -2.0 * dx, -2.0 * dy].map(|v| self.number(v));
        let _ = write!(
            self.body,
            "M{x} {y}a{a} {b} {turn} 1 0 {dx} {dy} {a} {b} {turn} 1 0 {back_x} {back_y}"
        );
    }

    /// A number to a hundredth, as short as it can be written.
    fn number(&mut self, value: f64) -> String {
        if !value.is_finite() {
            self.bad = Some(value);
            return String::new();
        }
        let rounded = (value * 100.0).round() / 100.0;
        // There is no −0 in a picture.
        let mut text = format!("{:.2}", rounded + 0.0);
        text.truncate(text.trim_end_matches('0').trim_end_matches('.').len());
        text
    }
}

/// An ellipse: centre, half axes with the longer one first, and the angle of that from x in rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ellipse {
    pub centre: Point,
    pub radii: [f64; 2],
    pub angle: f64,
}

impl Ellipse {
    /// The image of the unit circle under the linear map that takes its axes to `u` and `v`.
    pub fn image(centre: Point, u: Point, v: Point) -> Self {
        let [a, b] = u;
        let [c, d] = v;
        // Half axes are the singular values of the matrix with columns u and v.
        let (p, q) = (0.5 * (a + d), 0.5 * (a - d));
        let (r, s) = (0.5 * (b + c), 0.5 * (b - c));
        let (sum, difference) = (p.hypot(s), q.hypot(r));
        let angle = 0.5 * (s.atan2(p) + r.atan2(q));
        Self { centre, radii: [sum + difference, (sum - difference).abs()], angle }
    }

    /// The same, as much thicker as it takes for a renderer not to leave it out.
    pub fn visible(self) -> Self {
        let [a, b] = self.radii;
        Self { radii: [a.max(0.05), b.max(0.05)], ..self }
    }
}

/// Text as XML takes it.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\n' | '\t' | '\r' => out.push(' '),
            // XML 1.0 has no place for these, however they are written.
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let mut svg = Svg::new(1.0, 1.0);
        for (value, text) in
            [(1.0, "1"), (0.125, "0.13"), (-0.001, "0"), (100.0, "100"), (-2.5, "-2.5")]
        {
            assert_eq!(svg.number(value), text);
        }
        assert!(svg.finish("").is_ok());
    }

    #[test]
    fn what_is_no_number_is_no_picture() {
        let mut svg = Svg::new(1.0, 1.0);
        svg.line([0.0, f64::NAN], [1.0, 1.0], Stroke::new(Colour::INK, 1.0));
        assert!(matches!(svg.finish(""), Err(PlotError::NotFinite { .. })));
    }

    #[test]
    fn text_is_escaped() {
        assert_eq!(escape("a<b & \"c\"\u{1}"), "a&lt;b &amp; &quot;c&quot;\u{fffd}");
    }

    #[test]
    fn circles_become_ellipses() {
        for k in 0..24 {
            let (sin, cos) = (0.3 * f64::from(k)).sin_cos();
            let (u, v) = ([2.0 * cos, 0.7 * sin], [-2.0 * sin, 0.7 * cos]);
            let ellipse = Ellipse::image([0.0, 0.0], u, v);
            assert!((ellipse.radii[0] - 2.0).abs() < 1e-12, "{ellipse:?}");
            assert!((ellipse.radii[1] - 0.7).abs() < 1e-12, "{ellipse:?}");
            assert!(ellipse.angle.sin().abs() < 1e-12, "{ellipse:?}");
        }
    }
}
