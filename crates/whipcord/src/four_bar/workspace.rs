//! Scratch memory of a solve.

use super::joint::Joint;
use super::several::Several;
use crate::linkage;

/// Scratch memory of a solve.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    /// Prescribed length of each cable, in all and in one section.
    pub(super) targets: Vec<f64>,
    pub(super) section_targets: Vec<f64>,
    /// By cable, for one section.
    pub(super) multipliers: Vec<f64>,
    pub(super) cables: Vec<Found>,
    pub(super) joints: Vec<Joint>,
    /// Multiplier of each passage, section by section.
    pub(super) pulls: Vec<f64>,
    pub(super) several: Several,
    /// Of the chain in equilibrium with forces.
    pub(super) chain: linkage::Workspace,
}

/// What has been found of one cable.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Found {
    pub length: f64,
    /// Multiplier conjugate to the total length, rad²/m.
    pub multiplier: f64,
    /// Whether the cable is as long as prescribed in some section.
    pub binds: bool,
}

/// Excess of the prescribed length over the path above which a cable hangs loose, relative to its
/// initial length: well above the error of a length, well below what anyone can measure.
pub(super) const LOOSE: f64 = 1e-10;
