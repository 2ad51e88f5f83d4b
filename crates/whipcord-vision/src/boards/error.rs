use thiserror::Error;

use super::Board;

/// Why there is no such board.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum BoardError {
    /// This program was built without the cargo feature `boards`.
    #[error(
        "this build finds no boards: build the command with `cargo install --path crates/whipcord-cli --features boards`, or take that of the Python package or of a release"
    )]
    NotBuilt,
    /// A description that says nothing.
    #[error(
        "{given:?} is no board: give chessboard:9x6 with the number of inner corners, where four squares meet, or charuco:8x6 with that of squares"
    )]
    Layout {
        /// What was given.
        given: String,
    },
    /// A chessboard with markers.
    #[error("a chessboard has no markers: leave out their side and dictionary, or give charuco:…")]
    NoMarkers,
    /// A ChArUco board without markers.
    #[error(
        "a ChArUco board needs the side of its markers and their dictionary, as it was printed with"
    )]
    MarkersMissing,
    /// Inner corners of a chessboard.
    #[error(
        "a chessboard has 2 to {most} inner corners along and across, where four squares meet; {}×{} were given",
        given[0], given[1]
    )]
    Corners {
        /// Along and across.
        given: [usize; 2],
        /// Most of either.
        most: usize,
    },
    /// Squares of a ChArUco board.
    #[error(
        "a ChArUco board has 3 to {most} squares along and across; {}×{} were given",
        given[0], given[1]
    )]
    Squares {
        /// Along and across.
        given: [usize; 2],
        /// Most of either.
        most: usize,
    },
    /// A side out of range.
    #[error("the side of the {what} must be from 0.01 mm to 10 m, but is {value} m")]
    Side {
        /// Of what.
        what: &'static str,
        /// What was given, in m.
        value: f64,
    },
    /// Markers that do not fit into the squares.
    #[error("markers of {:.3} mm do not fit into squares of {:.3} mm", 1e3 * marker, 1e3 * square)]
    Marker {
        /// Side of the markers in m.
        marker: f64,
        /// Side of the squares in m.
        square: f64,
    },
    /// Markers that are from nowhere.
    #[error("there is no dictionary {given:?}: there are {}", Board::dictionaries().join(", "))]
    Dictionary {
        /// What was given.
        given: String,
    },
    /// A dictionary that is too small.
    #[error("the board has {needed} markers, but {dictionary} only {available}")]
    Markers {
        /// White squares.
        needed: usize,
        /// Markers that there are.
        available: usize,
        /// Name of the dictionary.
        dictionary: &'static str,
    },
}

/// Why a photograph shows nothing of a board that could be used.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum Unseen {
    /// Nothing like it.
    #[error("no board is seen")]
    NoBoard,
    /// A board whose markers are not those of this one.
    #[error(
        "a board is seen, but its markers are not those of this one: check its size and its dictionary"
    )]
    OtherMarkers,
    /// A part of a chessboard.
    #[error(
        "{}×{} of the board's {}×{} inner corners are seen: it is cut off or partly hidden, and a chessboard must be seen whole",
        seen[0], seen[1], expected[0], expected[1]
    )]
    CutOff {
        /// Corners along and across that are seen.
        seen: [usize; 2],
        /// Those of the board.
        expected: [usize; 2],
    },
    /// A larger chessboard.
    #[error(
        "a board with {}×{} inner corners is seen where there must be {}×{}",
        seen[0], seen[1], expected[0], expected[1]
    )]
    OtherBoard {
        /// Corners along and across that are seen.
        seen: [usize; 2],
        /// Those of the board.
        expected: [usize; 2],
    },
    /// Too little of it.
    #[error(
        "only {found} of the board's {of} inner corners are seen, or all on one line: {least} or more are needed"
    )]
    TooFew {
        /// Corners that were found.
        found: usize,
        /// Those of the board.
        of: usize,
        /// Fewest that do.
        least: usize,
    },
    /// A photograph of another size.
    #[error(
        "it has {}×{} pixels, others {}×{}: all must be of one camera at one setting",
        size[0], size[1], others[0], others[1]
    )]
    Size {
        /// Columns and rows.
        size: [u32; 2],
        /// Those of the others.
        others: [u32; 2],
    },
}
