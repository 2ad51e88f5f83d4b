use thiserror::Error;

/// Why a picture cannot be drawn.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PlotError {
    /// There is nothing to draw.
    #[error("{what} is empty: a picture needs at least one")]
    Empty {
        /// Which list.
        what: String,
    },

    /// A number that has no place on an axis: not a number, infinite, or beyond 1e100.
    #[error("{what} must be a finite number of at most 1e100, but is {value}")]
    NotFinite {
        /// Which quantity.
        what: String,
        /// Its value.
        value: f64,
    },

    /// A number that has no place on a logarithmic axis: one below 1e-100.
    #[error("{what} must be positive (1e-100 or more) to have a logarithm, but is {value}")]
    NotPositive {
        /// Which quantity.
        what: String,
        /// Its value.
        value: f64,
    },

    /// Lists that belong together have different lengths, or one is too short.
    #[error("{what} has {given} entries, but needs {expected}")]
    Count {
        /// Which list.
        what: String,
        /// Entries given.
        given: usize,
        /// Entries needed.
        expected: usize,
    },

    /// Arc lengths that do not increase.
    #[error("{what} must increase from the base to the tip")]
    NotIncreasing {
        /// Which list.
        what: String,
    },

    /// A picture of no size, or of more pixels than a PNG is good for.
    #[error(
        "a picture of {width} by {height} pixels cannot be made: choose a scale that makes each side 1 to {largest} pixels"
    )]
    Size {
        /// Width in pixels.
        width: f64,
        /// Height in pixels.
        height: f64,
        /// Largest side.
        largest: u32,
    },

    /// Bytes that are no photograph.
    #[error("the photograph is neither a PNG nor a JPEG file")]
    Photograph,

    /// A camera sees nothing of what it should.
    #[error(
        "no disk of `{what}` is in the photograph: check the camera's pose, its lens and the size of the image"
    )]
    NotSeen {
        /// Which shape.
        what: String,
    },

    /// The SVG cannot be read.
    #[error("the SVG cannot be read: {0}")]
    Svg(String),

    /// The PNG cannot be written.
    #[error("the PNG cannot be written: {0}")]
    Png(String),
}

/// Largest number that is drawn. Beyond it, arithmetic with limits and steps would overflow.
const LARGEST: f64 = 1e100;

/// Refuses what is not a number, infinite or larger than any quantity is.
pub(crate) fn finite(what: impl FnOnce() -> String, value: f64) -> Result<(), PlotError> {
    if value.abs() <= LARGEST { Ok(()) } else { Err(PlotError::NotFinite { what: what(), value }) }
}

/// Refuses what has no logarithm.
pub(crate) fn positive(what: impl FnOnce() -> String, value: f64) -> Result<(), PlotError> {
    if value >= 1.0 / LARGEST {
        Ok(())
    } else {
        Err(PlotError::NotPositive { what: what(), value })
    }
}

/// Refuses an empty list.
pub(crate) fn not_empty<T>(what: impl FnOnce() -> String, list: &[T]) -> Result<(), PlotError> {
    if list.is_empty() { Err(PlotError::Empty { what: what() }) } else { Ok(()) }
}
