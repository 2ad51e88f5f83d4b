//! The title of a picture, in as many lines as it takes.

use crate::font;
use crate::svg::{Point, Svg, Text};

const SIZE: f64 = 14.0;
/// Height of a line in px, the space under it included.
pub(crate) const LINE: f64 = 22.0;

pub(crate) struct Title(Vec<String>);

impl Title {
    pub fn new(text: &str, width: f64) -> Self {
        let lines = font::wrap(text, SIZE, true, width);
        Self(lines.into_iter().filter(|line| !line.is_empty()).collect())
    }

    pub fn height(&self) -> f64 {
        LINE * self.0.len() as f64
    }

    pub fn draw(&self, svg: &mut Svg, at: Point) {
        for (i, line) in self.0.iter().enumerate() {
            let text = Text { bold: true, ..Text::new(line, SIZE) };
            svg.text([at[0], at[1] + LINE * i as f64 + 0.5 * SIZE], &text);
        }
    }
}
