//! Disks and markers in photographs, to a fraction of a pixel, in order from base to tip.
//!
//! [`find`] finds what looks like a disk, a coloured dot or a small circle; [`in_order`] numbers that from base to tip
//! or says why it cannot; [`find_row`] does both. None of them guesses: a count that does not fit is an error that says what was found and where.

mod background;
mod bar;
mod bars;
mod blobs;
mod chain;
mod components;
mod error;
mod numbered;
mod quantile;

use core::str::FromStr;

use crate::photo::Photo;
use crate::plane::Plane;
pub use blobs::colour;
pub use chain::{Base, Expected, in_order};
pub use error::DetectError;
pub use numbered::{Row, find_row};
use quantile::{median, median_of, quantile_of};

/// What is looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Disks seen from the side: bars across the backbone, or narrow ellipses.
    Disks,
    /// Dots of one colour.
    Dots,
    /// Small round spots, darker or lighter than what is around them.
    Circles,
}

/// What is looked for, and where.
#[derive(Clone, Copy, Debug)]
pub struct Search<'a> {
    /// What it is.
    pub kind: Kind,
    /// Its colour in linear light. Disks and circles are found without, by contrast; dots take the most
    /// vivid colour of the picture.
    pub colour: Option<[f32; 3]>,
    /// Radius of a disk or marker in pixels, to a third; where not given, what most have.
    pub radius: Option<f64>,
    /// Where to look; everywhere without.
    pub mask: Option<&'a Mask>,
}

/// Something that was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// Column and row of its centre.
    pub pixel: [f64; 2],
    /// Half of its greater extent in pixels.
    pub radius: f64,
    /// Direction of its greater extent, a unit vector: along the rim of a disk.
    pub axis: [f64; 2],
    /// From 0 to 1, by how much it looks like what was looked for. No probability.
    pub confidence: f64,
}

/// Part of a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mask {
    width: usize,
    inside: Vec<bool>,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 3] = [Self::Disks, Self::Dots, Self::Circles];

    /// As on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Disks => "disks",
            Self::Dots => "dots",
            Self::Circles => "circles",
        }
    }
}

impl FromStr for Kind {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|kind| kind.name() == name);
        found.ok_or_else(|| format!("there is no kind `{name}`: disks, dots or circles"))
    }
}

impl Mask {
    /// What is lighter than middle grey in a picture of the same size.
    #[must_use]
    pub fn light_of(photo: &Photo) -> Self {
        let light = |pixel: &[f32; 3]| pixel.iter().sum::<f32>() > 3.0 * 0.214;
        Self { width: photo.width(), inside: photo.pixels().iter().map(light).collect() }
    }

    /// Whether a pixel is in it.
    #[must_use]
    pub fn contains(&self, column: usize, row: usize) -> bool {
        self.inside[row * self.width + column]
    }

    fn check(&self, photo: &Photo) -> Result<(), DetectError> {
        let height = self.inside.len() / self.width.max(1);
        if (self.width, height) != (photo.width(), photo.height()) {
            return Err(DetectError::MaskSize {
                mask: [self.width, height],
                photo: [photo.width(), photo.height()],
            });
        }
        if self.inside.contains(&true) { Ok(()) } else { Err(DetectError::EmptyMask) }
    }
}

/// All that looks like what is looked for, in no order.
///
/// # Errors
/// [`DetectError`] when nothing does, and why.
pub fn find(photo: &Photo, search: &Search<'_>) -> Result<Vec<Mark>, DetectError> {
    if let Some(mask) = search.mask {
        mask.check(photo)?;
    }
    if photo.width() < 16 || photo.height() < 16 {
        return Err(DetectError::TooSmall { size: [photo.width(), photo.height()] });
    }
    let marks = match search.kind {
        Kind::Disks => bars::find(photo, search)?,
        Kind::Dots => blobs::dots(photo, search)?,
        Kind::Circles => blobs::circles(photo, search)?,
    };
    if marks.is_empty() { Err(DetectError::NoneFound { kind: search.kind }) } else { Ok(marks) }
}

/// Middle size among marks, each with a weight: that which most have within a sixth.
fn usual_radius(sizes: &[(f64, f64)]) -> Option<f64> {
    let alike = |r: f64| sizes.iter().filter(move |(other, _)| (other / r).ln().abs() < 0.16);
    let weight = |r: f64| alike(r).map(|(_, weight)| weight).sum::<f64>();
    let order = |a: f64, b: f64| weight(a).total_cmp(&weight(b)).then(a.total_cmp(&b));
    let best = sizes.iter().map(|&(radius, _)| radius).max_by(|&a, &b| order(a, b))?;
    let mut members: Vec<f64> = alike(best).map(|&(radius, _)| radius).collect();
    Some(median(&mut members))
}

/// Luminance of linear light (ITU-R BT.709).
fn luminance(photo: &Photo) -> Plane {
    let of = |p: &[f32; 3]| 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
    let values = photo.pixels().iter().map(of).collect();
    Plane { width: photo.width(), height: photo.height(), values }
}
