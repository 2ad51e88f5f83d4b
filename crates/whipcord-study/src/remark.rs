//! Warnings about all measurements of a fit or a score.

/// A warning about a fit or a score as a whole.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remark {
    /// A name that stays the same from version to version.
    pub code: &'static str,
    /// What it says.
    pub message: String,
    /// What to do about it.
    pub help: &'static str,
}
