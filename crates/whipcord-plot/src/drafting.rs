//! Drawings at scale, in mm: as SVG to print and as DXF for machines.

use core::fmt::Write as _;

use crate::error::{PlotError, finite};

/// A drawing in mm, x to the right and y upwards.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drafting {
    /// What is drawn, the first at the back.
    pub items: Vec<Item>,
}

/// A line, circle or text of a drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// What it belongs to.
    pub layer: DraftLayer,
    /// Its form.
    pub form: DraftForm,
}

/// What a part of a drawing is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DraftLayer {
    /// What is cut: rims and holes.
    Cut,
    /// Holes that a cable goes through.
    Cables,
    /// Where a cable comes from or goes to.
    Courses,
    /// Texts and marks.
    Notes,
}

/// A form in mm.
#[derive(Clone, Debug, PartialEq)]
pub enum DraftForm {
    /// A circle.
    Circle {
        /// Centre.
        centre: [f64; 2],
        /// Radius.
        radius: f64,
    },
    /// A straight line.
    Line {
        /// From.
        from: [f64; 2],
        /// To.
        to: [f64; 2],
    },
    /// A text.
    Text {
        /// The middle of its left end, or of it where it is centred.
        at: [f64; 2],
        /// Height of the letters.
        height: f64,
        /// Whether its middle is at its place.
        is_centred: bool,
        /// What it says.
        text: String,
    },
}

impl DraftLayer {
    const ALL: [Self; 4] = [Self::Cut, Self::Cables, Self::Courses, Self::Notes];

    /// Name of the layer in a DXF.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cut => "CUT",
            Self::Cables => "CABLES",
            Self::Courses => "COURSES",
            Self::Notes => "NOTES",
        }
    }

    /// Lengths of the dashes and of what is between them in mm, of lines that are dashed.
    const fn dashes(self) -> Option<[f64; 2]> {
        match self {
            Self::Courses => Some([0.8, 0.5]),
            Self::Cut | Self::Cables | Self::Notes => None,
        }
    }

    /// Name of its lines in a DXF.
    const fn line_type(self) -> &'static str {
        if self.dashes().is_some() { "DASHED" } else { "CONTINUOUS" }
    }

    /// Its colour by the index of AutoCAD, and as SVG has it.
    const fn colours(self) -> (u8, &'static str) {
        match self {
            Self::Cut => (7, "#000000"),
            Self::Cables => (1, "#c8102e"),
            Self::Courses => (5, "#1f5fbf"),
            Self::Notes => (8, "#606060"),
        }
    }
}

/// About how wide letters are, as a part of their height.
pub(crate) const LETTER: f64 = 0.6;

impl Drafting {
    /// Adds a form to a layer.
    pub fn add(&mut self, layer: DraftLayer, form: DraftForm) {
        self.items.push(Item { layer, form });
    }

    /// Adds all of another drawing, moved.
    pub fn place(&mut self, other: &Self, by: [f64; 2]) {
        let moved = |[x, y]: [f64; 2]| [x + by[0], y + by[1]];
        self.items.extend(other.items.iter().map(|item| {
            let form = match &item.form {
                DraftForm::Circle { centre, radius } => {
                    DraftForm::Circle { centre: moved(*centre), radius: *radius }
                }
                DraftForm::Line { from, to } => {
                    DraftForm::Line { from: moved(*from), to: moved(*to) }
                }
                DraftForm::Text { at, height, is_centred, text } => DraftForm::Text {
                    at: moved(*at),
                    height: *height,
                    is_centred: *is_centred,
                    text: text.clone(),
                },
            };
            Item { layer: item.layer, form }
        }));
    }

    /// Least and greatest coordinates in mm; of an empty drawing one point.
    #[must_use]
    pub fn extent(&self) -> [[f64; 2]; 2] {
        let mut extent = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        let mut include = |[x, y]: [f64; 2]| {
            for (k, value) in [x, y].into_iter().enumerate() {
                extent[0][k] = extent[0][k].min(value);
                extent[1][k] = extent[1][k].max(value);
            }
        };
        for item in &self.items {
            match &item.form {
                DraftForm::Circle { centre: [x, y], radius } => {
                    include([x - radius, y - radius]);
                    include([x + radius, y + radius]);
                }
                DraftForm::Line { from, to } => {
                    include(*from);
                    include(*to);
                }
                DraftForm::Text { at: [x, y], height, is_centred, text } => {
                    let width = LETTER * height * text.chars().count() as f64;
                    let left = if *is_centred { x - 0.5 * width } else { *x };
                    include([left, y - 0.5 * height]);
                    include([left + width, y + 0.5 * height]);
                }
            }
        }
        if extent[0][0] <= extent[1][0] { extent } else { [[0.0; 2]; 2] }
    }

    fn check(&self) -> Result<(), PlotError> {
        let place = || "a coordinate of the drawing".to_owned();
        for item in &self.items {
            let numbers = match &item.form {
                DraftForm::Circle { centre: [x, y], radius } => [*x, *y, *radius, 0.0],
                DraftForm::Line { from, to } => [from[0], from[1], to[0], to[1]],
                DraftForm::Text { at: [x, y], height, .. } => [*x, *y, *height, 0.0],
            };
            for number in numbers {
                finite(place, number)?;
            }
        }
        Ok(())
    }

    /// As SVG whose size is in mm, so that it prints at scale.
    ///
    /// # Errors
    /// [`PlotError`] for a coordinate that is not finite.
    pub fn svg(&self) -> Result<String, PlotError> {
        const MARGIN: f64 = 5.0;
        self.check()?;
        let [low, high] = self.extent();
        let size = [0, 1].map(|k| high[k] - low[k] + 2.0 * MARGIN);
        let x = |value: f64| short(value - low[0] + MARGIN);
        let y = |value: f64| short(high[1] - value + MARGIN);
        let (width, height) = (short(size[0]), short(size[1]));
        let mut out = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}mm\" height=\"{height}mm\" viewBox=\"0 0 {width} {height}\">\n<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n"
        );
        for layer in DraftLayer::ALL {
            let (_, colour) = layer.colours();
            let dash = match layer.dashes() {
                Some([dash, gap]) => format!(" stroke-dasharray=\"{dash} {gap}\""),
                None => String::new(),
            };
            let line = if layer == DraftLayer::Notes { 0.1 } else { 0.18 };
            let name = layer.name().to_lowercase();
            let _ = writeln!(
                out,
                "<g id=\"{name}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{line}\"{dash}>"
            );
            for item in self.items.iter().filter(|item| item.layer == layer) {
                let _ = match &item.form {
                    DraftForm::Circle { centre, radius } => writeln!(
                        out,
                        "<circle cx=\"{}\" cy=\"{}\" r=\"{}\"/>",
                        x(centre[0]),
                        y(centre[1]),
                        short(*radius)
                    ),
                    DraftForm::Line { from, to } => writeln!(
                        out,
                        "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\"/>",
                        x(from[0]),
                        y(from[1]),
                        x(to[0]),
                        y(to[1])
                    ),
                    DraftForm::Text { at, height, is_centred, text } => writeln!(
                        out,
                        "<text x=\"{}\" y=\"{}\" font-family=\"sans-serif\" font-size=\"{}\" text-anchor=\"{}\" fill=\"{colour}\" stroke=\"none\">{}</text>",
                        x(at[0]),
                        // The middle of capitals is a good third of their size above the line.
                        y(at[1] - 0.36 * height),
                        short(*height),
                        if *is_centred { "middle" } else { "start" },
                        escaped(text)
                    ),
                };
            }
            out.push_str("</g>\n");
        }
        out.push_str("</svg>\n");
        Ok(out)
    }

    /// As DXF in the release 12 of AutoCAD, which all programs for machines read; in mm, with a layer for each [`DraftLayer`].
    ///
    /// # Errors
    /// [`PlotError`] for a coordinate that is not finite.
    pub fn dxf(&self) -> Result<String, PlotError> {
        self.check()?;
        let mut out = String::new();
        let mut pair = |code: u16, value: &str| {
            let _ = write!(out, "{code:>3}\r\n{value}\r\n");
        };
        let [low, high] = self.extent();
        pair(0, "SECTION");
        pair(2, "HEADER");
        pair(9, "$ACADVER");
        pair(1, "AC1009");
        // Lengths are in mm.
        pair(9, "$INSUNITS");
        pair(70, "4");
        pair(9, "$MEASUREMENT");
        pair(70, "1");
        for (name, [x, y]) in [("$EXTMIN", low), ("$EXTMAX", high)] {
            pair(9, name);
            pair(10, &decimal(x));
            pair(20, &decimal(y));
        }
        pair(0, "ENDSEC");
        pair(0, "SECTION");
        pair(2, "TABLES");
        pair(0, "TABLE");
        pair(2, "LTYPE");
        pair(70, "2");
        let dashed = DraftLayer::ALL.into_iter().find_map(DraftLayer::dashes).unwrap_or_default();
        for (name, words, parts) in [
            ("CONTINUOUS", "Solid line", &[][..]),
            ("DASHED", "__ __ __", &[dashed[0], -dashed[1]]),
        ] {
            pair(0, "LTYPE");
            pair(2, name);
            pair(70, "0");
            pair(3, words);
            // The code of the only alignment there is.
            pair(72, "65");
            pair(73, &parts.len().to_string());
            pair(40, &decimal(parts.iter().map(|part| part.abs()).sum()));
            parts.iter().for_each(|part| pair(49, &decimal(*part)));
        }
        pair(0, "ENDTAB");
        pair(0, "TABLE");
        pair(2, "LAYER");
        pair(70, &DraftLayer::ALL.len().to_string());
        for layer in DraftLayer::ALL {
            pair(0, "LAYER");
            pair(2, layer.name());
            pair(70, "0");
            pair(62, &layer.colours().0.to_string());
            pair(6, layer.line_type());
        }
        pair(0, "ENDTAB");
        pair(0, "ENDSEC");
        pair(0, "SECTION");
        pair(2, "ENTITIES");
        for item in &self.items {
            let kind = match item.form {
                DraftForm::Circle { .. } => "CIRCLE",
                DraftForm::Line { .. } => "LINE",
                DraftForm::Text { .. } => "TEXT",
            };
            pair(0, kind);
            pair(8, item.layer.name());
            match &item.form {
                DraftForm::Circle { centre, radius } => {
                    pair(10, &decimal(centre[0]));
                    pair(20, &decimal(centre[1]));
                    pair(30, "0.0");
                    pair(40, &decimal(*radius));
                }
                DraftForm::Line { from, to } => {
                    for (first, [x, y]) in [(10, from), (11, to)] {
                        pair(first, &decimal(*x));
                        pair(first + 10, &decimal(*y));
                        pair(first + 20, "0.0");
                    }
                }
                DraftForm::Text { at, height, is_centred, text } => {
                    pair(10, &decimal(at[0]));
                    pair(20, &decimal(at[1]));
                    pair(30, "0.0");
                    pair(40, &decimal(*height));
                    pair(1, &ascii(text));
                    // The second point is that of the alignment: in the middle of the height.
                    pair(72, if *is_centred { "1" } else { "0" });
                    pair(11, &decimal(at[0]));
                    pair(21, &decimal(at[1]));
                    pair(31, "0.0");
                    pair(73, "2");
                }
            }
        }
        pair(0, "ENDSEC");
        pair(0, "EOF");
        Ok(out)
    }
}

/// To a tenth of a micrometre, without trailing zeros.
fn short(value: f64) -> String {
    let text = format!("{value:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// A number as DXF has it: always with a point.
fn decimal(value: f64) -> String {
    let text = short(value);
    if text.contains('.') { text } else { format!("{text}.0") }
}

/// Release 12 has texts in ASCII; other characters by their code.
fn ascii(text: &str) -> String {
    text.chars()
        .map(|c| match c {
            '°' => "%%d".to_owned(),
            c if c.is_ascii() && !c.is_ascii_control() => c.to_string(),
            c => format!("\\U+{:04X}", u32::from(c)),
        })
        .collect()
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawing() -> Drafting {
        let mut drawing = Drafting::default();
        drawing.add(DraftLayer::Cut, DraftForm::Circle { centre: [0.0, 0.0], radius: 10.0 });
        drawing.add(DraftLayer::Courses, DraftForm::Line { from: [0.0, 1.0], to: [-5.0, 2.5] });
        let text = "disk 1 <a> 90°".to_owned();
        let form = DraftForm::Text { at: [0.0, 12.0], height: 3.0, is_centred: true, text };
        drawing.add(DraftLayer::Notes, form);
        drawing
    }

    #[test]
    fn an_svg_is_as_large_in_mm_as_what_it_shows() {
        let mut drawing = drawing();
        drawing.items.truncate(2);
        let svg = drawing.svg().unwrap();
        assert!(svg.contains("width=\"30mm\" height=\"30mm\" viewBox=\"0 0 30 30\""), "{svg}");
        assert!(svg.contains("<circle cx=\"15\" cy=\"15\" r=\"10\"/>"));
        // y upwards.
        assert!(svg.contains("x1=\"15\" y1=\"14\" x2=\"10\" y2=\"12.5\""));
        let mut wrong = drawing;
        wrong.add(DraftLayer::Cut, DraftForm::Circle { centre: [f64::NAN, 0.0], radius: 1.0 });
        assert!(wrong.svg().is_err() && wrong.dxf().is_err());
    }

    #[test]
    fn a_dxf_is_pairs_of_codes_and_values() {
        let dxf = drawing().dxf().unwrap();
        let lines: Vec<&str> = dxf.split("\r\n").collect();
        assert_eq!(lines.len() % 2, 1);
        let pairs: Vec<(u16, &str)> =
            lines.chunks_exact(2).map(|pair| (pair[0].trim().parse().unwrap(), pair[1])).collect();
        assert_eq!(pairs[0], (0, "SECTION"));
        assert_eq!(pairs.last(), Some(&(0, "EOF")));
        let circle = pairs.iter().position(|pair| *pair == (0, "CIRCLE")).unwrap();
        assert_eq!(
            pairs[circle + 1..circle + 6],
            [(8, "CUT"), (10, "0.0"), (20, "0.0"), (30, "0.0"), (40, "10.0")]
        );
        assert!(pairs.contains(&(1, "disk 1 <a> 90%%d")) && pairs.contains(&(70, "4")));
        assert!(dxf.is_ascii());
    }

    #[test]
    fn a_drawing_within_another_is_moved() {
        let mut sheet = Drafting::default();
        sheet.place(&drawing(), [100.0, 0.0]);
        let [low, high] = sheet.extent();
        assert_eq!((low[0], high[0]), (87.4_f64.min(90.0), 112.6_f64.max(110.0)));
    }
}
