//! What is asked of the chain.

use super::division::Division;
use super::layout::Section;
use super::loads::AppliedLoads;
use crate::budget::Meter;

/// What does not change from one iteration to the next.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task<'a> {
    pub division: &'a Division,
    pub sections: &'a [Section],
    pub loads: &'a AppliedLoads,
    /// Fraction of loads and tensions that acts.
    pub fraction: f64,
    /// By cable in N, at fraction 1.
    pub tensions: &'a [f64],
    pub meter: &'a Meter,
}

/// How a linear system is taken apart.
#[derive(Clone, Copy, Debug)]
pub(super) struct Elimination {
    /// So much of the sections' own stiffness is taken off the tangent.
    pub shift: f64,
    /// What for.
    pub asked: Asked,
}

/// What is asked of a linear system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Asked {
    /// The signs of its eigenvalues.
    Signs,
    /// The Newton step.
    Step,
    /// The step, and the response to each cable's tension.
    Responses,
}
