//! What the colours and signs of a picture mean.

use crate::font;
use crate::load_marks::{ArrowLook, draw_arrow};
use crate::marker::{self, Marker};
use crate::svg::{Fill, Point, Stroke, Svg, Text};

const SIZE: f64 = 11.5;
const SWATCH: f64 = 24.0;
const SPACE: f64 = 7.0;
const COLUMN_GAP: f64 = 22.0;
/// Height of a row in px.
pub(crate) const ROW: f64 = 18.0;

/// A sign drawn before a label.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Swatch {
    Line(Stroke),
    Marker(Marker, Fill, Option<Stroke>),
    Area(Fill, Option<Stroke>),
    Arrow(ArrowLook),
    /// Three arrows from a line.
    Comb(ArrowLook),
}

#[derive(Clone, Debug)]
pub(crate) struct Entry {
    pub label: String,
    /// Drawn one over the other.
    pub swatches: Vec<Swatch>,
}

/// Entries in rows and columns.
#[derive(Clone, Debug)]
pub(crate) struct Legend {
    entries: Vec<Entry>,
    columns: usize,
    column_width: f64,
}

impl Legend {
    /// As many columns as fit into `width` px; what is longer than that is cut short.
    pub fn new(entries: Vec<Entry>, width: f64) -> Self {
        Self::of_height(entries, width, 0.0)
    }

    /// As many columns as fit into `width` px, but no more than it takes to be as low as `height`.
    pub fn of_height(mut entries: Vec<Entry>, width: f64, height: f64) -> Self {
        let limit = width - SWATCH - SPACE;
        for entry in &mut entries {
            entry.label = font::elide(&entry.label, SIZE, limit);
        }
        let column_width = Self::width_of(&entries);
        let fitting =
            ((width + COLUMN_GAP) / (column_width + COLUMN_GAP)).floor().max(1.0) as usize;
        // No fuller first row than the number of rows asks for: 3 + 3 rather than 5 + 1.
        let rows = entries.len().div_ceil(fitting).max((height / ROW) as usize).max(1);
        let columns = entries.len().div_ceil(rows).max(1);
        Self { entries, columns, column_width }
    }

    pub fn height(&self) -> f64 {
        self.entries.len().div_ceil(self.columns) as f64 * ROW
    }

    /// Width in px of the longest of these entries.
    pub fn width_of(entries: &[Entry]) -> f64 {
        let widths = entries.iter().map(|e| font::width(&e.label, SIZE, false));
        SWATCH + SPACE + widths.fold(0.0, f64::max)
    }

    /// Draws it with its upper left corner at `at`.
    pub fn draw(&self, svg: &mut Svg, at: Point) {
        if self.entries.is_empty() {
            return;
        }
        svg.open("legend");
        for (i, entry) in self.entries.iter().enumerate() {
            let x = at[0] + (i % self.columns) as f64 * (self.column_width + COLUMN_GAP);
            let y = at[1] + ((i / self.columns) as f64 + 0.5) * ROW;
            for swatch in &entry.swatches {
                draw_swatch(svg, [x, y], *swatch);
            }
            svg.text([x + SWATCH + SPACE, y], &Text::new(&entry.label, SIZE));
        }
        svg.close();
    }
}

fn draw_swatch(svg: &mut Svg, [x, y]: Point, swatch: Swatch) {
    match swatch {
        Swatch::Line(stroke) => svg.line([x, y], [x + SWATCH, y], stroke),
        Swatch::Marker(shape, fill, stroke) => {
            marker::draw(svg, shape, [x + 0.5 * SWATCH, y], 4.0, fill, stroke);
        }
        Swatch::Area(fill, stroke) => {
            svg.rect([x + 6.0, y - 5.0], [SWATCH - 6.0, 10.0], Some(fill), stroke);
        }
        Swatch::Arrow(look) => draw_arrow(svg, [x, y], [x + SWATCH, y], 0.0, look),
        Swatch::Comb(look) => {
            svg.line([x, y - 6.0], [x + SWATCH, y - 6.0], Stroke::new(look.colour, look.width));
            for k in 0..3 {
                let tooth = x + 0.5 * SWATCH * f64::from(k);
                draw_arrow(svg, [tooth, y - 6.0], [tooth, y + 6.0], 0.0, look);
            }
        }
    }
}
