//! Columns of what all spans share.

/// A column of what all spans share, or the answer to what is left of the equations.
#[derive(Clone, Copy, Debug)]
pub(super) enum Column {
    Load,
    Tension(usize),
    Closing,
}
