use thiserror::Error;

use super::Kind;

/// Why no disks or markers are given.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum DetectError {
    /// Too few pixels to see anything in.
    #[error("the picture has only {}×{} pixels", size[0], size[1])]
    TooSmall {
        /// Columns and rows.
        size: [usize; 2],
    },
    /// The mask is not that of the photograph.
    #[error(
        "the mask has {}×{} pixels, the photograph {}×{}",
        mask[0], mask[1], photo[0], photo[1]
    )]
    MaskSize {
        /// Columns and rows of the mask.
        mask: [usize; 2],
        /// Those of the photograph.
        photo: [usize; 2],
    },
    /// The mask leaves nothing.
    #[error("the mask is black: nothing is left to look at")]
    EmptyMask,
    /// Disks are said to be hidden, but not of how many.
    #[error("which disks are hidden says nothing without how many there are in all")]
    HiddenOfHowMany,
    /// A disk that is said to be hidden is none.
    #[error("{number}: there are disks 1 to {count}")]
    NoSuchHidden {
        /// Its number.
        number: usize,
        /// How many there are.
        count: usize,
    },
    /// All is background.
    #[error("nothing stands out from the background")]
    NothingStandsOut,
    /// There is no background to stand out from.
    #[error(
        "{:.0} % of the picture stand out from what would be its background: give a mask or a colour",
        100.0 * share
    )]
    NoEvenBackground {
        /// Share of the picture that stands out.
        share: f64,
    },
    /// The colour is a shade of the background.
    #[error(
        "the colour is only a shade of the background, or black: leave it out, to look for contrast"
    )]
    ColourLikeBackground,
    /// Nothing in the picture is vivid.
    #[error("no vivid colour stands out: give the colour of the dots, or look for circles")]
    NoVividColour,
    /// Something stands out, but nothing of this kind.
    #[error("no {} were found", kind.name())]
    NoneFound {
        /// What was looked for.
        kind: Kind,
    },
    /// Not as many as there must be.
    #[error("{}", TooFew { found, expected: *expected, gaps })]
    TooFew {
        /// Column and row of each, from the base on as far as that could be told.
        found: Vec<[f64; 2]>,
        /// How many there must be.
        expected: usize,
        /// After which of them, from 1, one or more seem to be missing.
        gaps: Vec<usize>,
    },
    /// More than there can be.
    #[error(
        "{} were found where there must be {expected}: at {}; the least sure are at {}",
        found.len(), places(found), places(least_sure)
    )]
    TooMany {
        /// Column and row of each.
        found: Vec<[f64; 2]>,
        /// How many there must be.
        expected: usize,
        /// Those with the least confidence, as many as are too many.
        least_sure: Vec<[f64; 2]>,
    },
    /// A gap in the row, and no count that would settle it.
    #[error(
        "{} were found, at {}, with a gap after number {} that others would fit in: give the count",
        found.len(), places(found), gaps[0]
    )]
    Gap {
        /// Column and row of each from base to tip.
        found: Vec<[f64; 2]>,
        /// After which of them, from 1.
        gaps: Vec<usize>,
    },
    /// What was found does not lie in a row.
    #[error(
        "the {} that were found, at {}, are no row: it branches at ({:.0}, {:.0})",
        found.len(), places(found), at[0], at[1]
    )]
    NoRow {
        /// Column and row of each.
        found: Vec<[f64; 2]>,
        /// Where more than two neighbours meet.
        at: [f64; 2],
    },
    /// Which end is the base cannot be told.
    #[error(
        "which end is the base cannot be told: the ends are at {} and {}; say which by a pixel near it",
        place(ends[0]), place(ends[1])
    )]
    AmbiguousBase {
        /// Both ends of the row.
        ends: [[f64; 2]; 2],
    },
    /// The distances between the disks fit the robot from the other end.
    #[error(
        "the order is mirrored: counted from the other end the distances fit the robot to {:.0} %, counted from this base, at {}, to {:.0} %",
        100.0 * reversed, place(*base), 100.0 * forward
    )]
    Mirrored {
        /// Where the base was said to be.
        base: [f64; 2],
        /// Relative deviation of the distances from the robot's, counted from there.
        forward: f64,
        /// Counted from the other end.
        reversed: f64,
    },
}

struct TooFew<'a> {
    found: &'a [[f64; 2]],
    expected: usize,
    gaps: &'a [usize],
}

impl core::fmt::Display for TooFew<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let verb = if self.found.len() == 1 { "was" } else { "were" };
        let (count, expected) = (self.found.len(), self.expected);
        write!(
            f,
            "{count} {verb} found where there must be {expected}: at {}",
            places(self.found)
        )?;
        for &gap in self.gaps {
            let (a, b) = (self.found[gap - 1], self.found[gap]);
            write!(f, "; one seems to be missing between {} and {}", place(a), place(b))?;
        }
        Ok(())
    }
}

fn place([u, v]: [f64; 2]) -> String {
    format!("({u:.0}, {v:.0})")
}

fn places(found: &[[f64; 2]]) -> String {
    const MOST: usize = 40;
    let mut text: Vec<String> = found.iter().take(MOST).map(|&p| place(p)).collect();
    if found.len() > MOST {
        text.push(format!("and {} more", found.len() - MOST));
    }
    text.join(", ")
}
