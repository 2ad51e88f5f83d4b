//! Why a section has no equilibrium.

/// Why a section has no equilibrium in the regular range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum SectionFault {
    /// The stretch `‖p′‖` of this cable has gone to zero: the section has folded.
    Folded { cable: usize },
    /// The wrench is not finite, or beyond what Newton's method can resolve.
    Diverged,
}

/// A fault and where it lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fault {
    pub kind: SectionFault,
    /// Arc length in m.
    pub arc_length: f64,
}

/// Below this stretch, from 1 at rest, a cable counts as folded.
pub(crate) const FOLDED: f64 = 1e-4;
