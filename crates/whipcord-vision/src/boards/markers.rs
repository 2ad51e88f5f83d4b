//! The markers of ChArUco boards.

use calib_targets_charuco::{CharucoBoardSpec, builtins, resolve_dictionary};

use super::BoardError;

/// Names of the dictionaries, as OpenCV has them.
pub(super) const DICTIONARIES: &[&str] = builtins::BUILTIN_DICTIONARY_NAMES;

/// This build finds boards.
#[derive(Clone, Copy, Debug)]
pub(super) struct Finder;

impl Finder {
    #[expect(clippy::unnecessary_wraps, reason = "without the feature there is none")]
    pub(super) const fn built() -> Result<Self, BoardError> {
        Ok(Self)
    }
}

/// The markers of a board.
#[derive(Clone, Copy, Debug)]
pub(super) struct Markers(CharucoBoardSpec);

impl Markers {
    /// Of so many squares along and across, with sides relative to those of the squares, from the dictionary of this name.
    pub(super) fn new(
        squares: [usize; 2],
        relative_side: f64,
        dictionary: &str,
    ) -> Result<Self, BoardError> {
        let dictionary = resolve_dictionary(dictionary)
            .ok_or_else(|| BoardError::Dictionary { given: dictionary.to_owned() })?;
        let (needed, available) = (squares[0] * squares[1] / 2, dictionary.codes().len());
        if needed > available {
            return Err(BoardError::Markers { needed, available, dictionary: dictionary.name() });
        }
        let [columns, rows] = squares.map(|n| n as u32);
        Ok(Self(CharucoBoardSpec::new(rows, columns, 1.0, relative_side as f32, dictionary)))
    }

    pub(super) const fn spec(&self) -> &CharucoBoardSpec {
        &self.0
    }

    /// Squares along and across.
    pub(super) fn squares(&self) -> [usize; 2] {
        [self.0.cols, self.0.rows].map(|n| n as usize)
    }

    pub(super) fn dictionary(&self) -> &'static str {
        self.0.dictionary.name()
    }

    /// Side of a marker over that of a square.
    pub(super) fn relative_side(&self) -> f64 {
        f64::from(self.0.marker_size_rel)
    }

    /// The bits of a marker, row by row, and its cells a side without the rim.
    pub(super) fn code(&self, number: usize) -> Option<(u64, usize)> {
        let code = *self.0.dictionary.codes().get(number)?;
        Some((code, self.0.dictionary.marker_size()))
    }
}
