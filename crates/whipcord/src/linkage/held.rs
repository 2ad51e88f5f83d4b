//! Cables that are held at their lengths in an equilibrium.

use crate::statics::self_stress::SelfStress;

/// A cable that is held at its length.
#[derive(Clone, Copy, Debug)]
pub(super) struct HeldCable {
    pub cable: usize,
    /// Its own, in m/N.
    pub compliance: f64,
    /// Whether it is at its length without tension.
    pub is_idle: bool,
}

impl HeldCable {
    /// A cable that pulls.
    pub const fn taut(cable: usize, compliance: f64) -> Self {
        Self { cable, compliance, is_idle: false }
    }
}

/// Memory of the search for them.
#[derive(Clone, Debug, Default)]
pub(super) struct HoldScratch {
    pub schur: Vec<f64>,
    pub self_stress: SelfStress,
}
