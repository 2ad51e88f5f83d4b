//! What goes on from one substep to the next.

/// How the state that the holes remember changes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Carried {
    /// `Dᵢ` of every passage.
    pub beyond: Vec<f64>,
    /// Tension below the base disk, by cable.
    pub base: Vec<f64>,
    /// What the drive of each cable leaves for the part beyond the hole in the base.
    pub at_drive: Vec<f64>,
    /// Among obstacles: how the cross-sections move that touch with friction at the end of the next substep, six numbers for each.
    pub places: Vec<f64>,
}
