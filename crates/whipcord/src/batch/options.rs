//! How a batch is worked off.

use core::num::NonZeroUsize;

use whipcord_numerics::lanes::Width;

/// Called with the number of rows that are done so far and of all rows, from any of the threads;
/// `false` stops the batch.
pub type Progress<'a> = &'a (dyn Fn(usize, usize) -> bool + Sync);

/// How a batch is worked off.
#[derive(Clone, Copy, Default)]
pub struct BatchOptions<'a> {
    /// How many threads share the rows. `None`: the pool of rayon that the caller is in, by default
    /// as many as there are processors. Without the cargo feature `parallel` there is one.
    pub threads: Option<NonZeroUsize>,
    /// Whether the rows follow a path, so that each may start from the answer before it. Pieces of
    /// [`PATH_ROWS`] rows start cold, and so does a row after one without an answer.
    pub warm_path: bool,
    /// Solve row by row without vectors, with the same answers; under loads the same to the residual.
    pub no_lanes: bool,
    /// How many rows at a time the vectors carry, with the same answers.
    pub width: Width,
    /// Called after every row that is solved by itself, and after every piece that is solved in vectors.
    pub progress: Option<Progress<'a>>,
}

/// Rows of a path that one thread solves in order, the first of them cold.
pub const PATH_ROWS: usize = 64;
