//! An unknown that several cables or motors share.

use super::quantity::Quantity;

/// What a number is of that several cables or motors share.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shared {
    /// The path, as it was given.
    pub path: String,
    /// The quantities besides the first.
    pub others: Vec<Quantity>,
    /// Whether the number is added to what each cable or motor has by itself, as the angles of cables; else it takes the
    /// place of all of them.
    pub is_change: bool,
}
