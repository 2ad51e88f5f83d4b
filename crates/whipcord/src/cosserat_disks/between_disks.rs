//! What lies between two neighbouring disks.

use core::ops::Range;

use crate::statics::passages::Passage;

/// What lies between two neighbouring disks.
#[derive(Clone, Debug)]
pub(super) struct Span {
    /// Arc length of the disk nearer the base in m.
    pub start: f64,
    pub passages: Vec<Passage>,
    /// Number of the first passage among those of all spans.
    pub first: usize,
    /// Its anchors among those of all spans.
    pub anchors: Range<usize>,
    /// Where the rows of its anchors begin, one for each pair of an anchor and a passage, among those of all spans.
    pub anchor_rows: usize,
}
