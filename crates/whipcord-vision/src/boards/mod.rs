//! Boards that cameras are calibrated with, and their corners in photographs.
//!
//! A chessboard is known by how many of its inner corners lie along and across it, so all of it must be in the picture. A
//! ChArUco board has a marker in each of its white squares, which say where on the board they are: a part of it will do.
//!
//! Without the cargo feature `boards` every board is refused ([`BoardError::NotBuilt`]).

mod calibration;
mod error;
#[cfg(feature = "boards")]
mod find;
#[cfg(feature = "boards")]
mod markers;
#[cfg(not(feature = "boards"))]
#[path = "without_finder.rs"]
mod markers;
mod stereo;

use std::fmt;

use whipcord::Vec3;
use whipcord_estimation::camera::Sighting;

pub use calibration::{Calibration, NoCalibration, calibration};
pub use error::{BoardError, Unseen};
#[cfg(feature = "boards")]
pub use find::find;
#[cfg(not(feature = "boards"))]
pub use markers::find;
use markers::{Finder, Markers};
pub use stereo::{NoStereo, Stereo, UnusedPair, stereo};

/// A flat board of black and white squares.
#[derive(Clone, Copy, Debug)]
pub struct Board {
    /// Inner corners along and across.
    corners: [usize; 2],
    square: f64,
    markers: Option<Markers>,
    #[cfg_attr(
        feature = "boards",
        expect(dead_code, reason = "without the finder there is no board")
    )]
    finder: Finder,
}

/// A corner of a board in a photograph.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Its number on the board: row by row from 0, as OpenCV numbers them.
    pub number: usize,
    /// Where it is on the board, and in the photograph.
    pub seen: Sighting,
}

/// What a photograph shows of a board.
#[derive(Clone, Debug, PartialEq)]
pub struct SeenBoard {
    /// Columns and rows of the photograph.
    pub size: [u32; 2],
    /// The corners that were found, by number.
    pub corners: Vec<Corner>,
}

impl Board {
    /// Most squares along or across.
    pub const MOST: usize = 200;

    /// A chessboard with so many inner corners, where four squares meet, along and across, and the side of its squares
    /// in m.
    ///
    /// # Errors
    /// [`BoardError`] when there is no such board.
    pub fn chessboard(corners: [usize; 2], square: f64) -> Result<Self, BoardError> {
        if corners.iter().any(|n| !(2..Self::MOST).contains(n)) {
            return Err(BoardError::Corners { given: corners, most: Self::MOST - 1 });
        }
        let square = side("squares", square)?;
        Ok(Self { corners, square, markers: None, finder: Finder::built()? })
    }

    /// A ChArUco board with so many squares along and across, the sides in m of its squares and of the markers in
    /// them, and the name of the dictionary that these are from. Its first square is black, as OpenCV has it since
    /// version 4.6.
    ///
    /// # Errors
    /// [`BoardError`] when there is no such board.
    pub fn charuco(
        squares: [usize; 2],
        square: f64,
        marker: f64,
        dictionary: &str,
    ) -> Result<Self, BoardError> {
        if squares.iter().any(|n| !(3..=Self::MOST).contains(n)) {
            return Err(BoardError::Squares { given: squares, most: Self::MOST });
        }
        let (square, marker) = (side("squares", square)?, side("markers", marker)?);
        if marker >= square {
            return Err(BoardError::Marker { marker, square });
        }
        let finder = Finder::built()?;
        let markers = Markers::new(squares, marker / square, dictionary)?;
        Ok(Self { corners: squares.map(|n| n - 1), square, markers: Some(markers), finder })
    }

    /// A board as people say it: `chessboard:9x6` with the number of inner corners, or `charuco:8x6` with the number of squares
    /// and with the side of the markers and the name of their dictionary; sides in m.
    ///
    /// # Errors
    /// [`BoardError`] when there is no such board.
    pub fn described(
        layout: &str,
        square: f64,
        marker: Option<f64>,
        dictionary: Option<&str>,
    ) -> Result<Self, BoardError> {
        let parsed = || {
            let (kind, numbers) = layout.split_once(':')?;
            let (along, across) = numbers.split_once(['x', '×'])?;
            Some((kind, [along.trim().parse().ok()?, across.trim().parse().ok()?]))
        };
        match (parsed(), marker, dictionary) {
            (Some(("chessboard", corners)), None, None) => Self::chessboard(corners, square),
            (Some(("chessboard", _)), ..) => Err(BoardError::NoMarkers),
            (Some(("charuco", squares)), Some(marker), Some(name)) => {
                Self::charuco(squares, square, marker, name)
            }
            (Some(("charuco", _)), ..) => Err(BoardError::MarkersMissing),
            _ => Err(BoardError::Layout { given: layout.to_owned() }),
        }
    }

    /// Names of the dictionaries of markers, as OpenCV has them.
    #[must_use]
    pub fn dictionaries() -> &'static [&'static str] {
        markers::DICTIONARIES
    }

    /// Inner corners along and across.
    #[must_use]
    pub const fn corners(&self) -> [usize; 2] {
        self.corners
    }

    /// All inner corners.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.corners[0] * self.corners[1]
    }

    /// Side of its squares in m.
    #[must_use]
    pub const fn square(&self) -> f64 {
        self.square
    }

    /// Where an inner corner is on the board, in m: x along and y across it, z into it, as OpenCV has it. The origin is the
    /// first inner corner of a chessboard, and the corner of the sheet of squares of a ChArUco board.
    #[must_use]
    pub fn point(&self, number: usize) -> Vec3 {
        let from = usize::from(self.markers.is_some());
        let [i, j] = [number % self.corners[0] + from, number / self.corners[0] + from];
        self.square * Vec3::new(i as f64, j as f64, 0.0)
    }

    /// The marker in a square of a ChArUco board: its side, and whether each of its cells, row by row with the black rim
    /// around the code, is black.
    pub(crate) fn marker(&self, square: [usize; 2]) -> Option<Marker> {
        let markers = self.markers.as_ref()?;
        let columns = markers.squares()[0];
        if (square[0] + square[1]).is_multiple_of(2) {
            return None;
        }
        // White squares row by row; odd columns of even rows, even columns of odd rows.
        let number =
            (0..square[1]).map(|row| (columns + row % 2) / 2).sum::<usize>() + square[0] / 2;
        let (code, inner) = markers.code(number)?;
        let cells = inner + 2;
        let black = (0..cells * cells)
            .map(|k| {
                let within = |i: usize| (1..=inner).contains(&i).then(|| i - 1);
                match (within(k % cells), within(k / cells)) {
                    (Some(i), Some(j)) => code >> (j * inner + i) & 1 == 1,
                    _ => true,
                }
            })
            .collect();
        Some(Marker { side: self.square * markers.relative_side(), cells, black })
    }
}

/// A marker in a white square.
pub(crate) struct Marker {
    /// In m.
    pub side: f64,
    /// Cells a side.
    pub cells: usize,
    /// Row by row.
    pub black: Vec<bool>,
}

impl fmt::Display for Board {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [along, across] = self.corners;
        match &self.markers {
            None => write!(f, "chessboard of {along}×{across} inner corners"),
            Some(markers) => {
                let ([columns, rows], name) = (markers.squares(), markers.dictionary());
                write!(f, "ChArUco board of {columns}×{rows} squares with {name}")
            }
        }
    }
}

impl SeenBoard {
    /// The points of the board, and where they are seen.
    #[must_use]
    pub fn sightings(&self) -> Vec<Sighting> {
        self.corners.iter().map(|corner| corner.seen).collect()
    }
}

fn side(what: &'static str, value: f64) -> Result<f64, BoardError> {
    if (1e-5..=10.0).contains(&value) { Ok(value) } else { Err(BoardError::Side { what, value }) }
}
