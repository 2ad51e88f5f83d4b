//! What is asked of the chain.

use super::division::Division;
use super::layout::Section;
use super::loads::AppliedLoads;
use super::motion::Coordinates;
use super::pushed::Pushed;
use crate::budget::Meter;

/// What does not change from one iteration to the next.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task<'a> {
    pub division: &'a Division,
    pub sections: &'a [Section],
    pub loads: &'a AppliedLoads,
    /// Factor on all loads.
    pub load: f64,
    /// Factor on all tensions.
    pub pull: f64,
    /// By cable in N.
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

/// A right-hand side of a linear system.
#[derive(Clone, Copy, Debug)]
pub(super) enum Right<'a> {
    /// What takes the residual away.
    Closing,
    /// The tension of a cable, in N.
    Tension(usize),
    /// A dead wrench.
    Push(&'a Pushed),
    /// One of its own for each section.
    Given(&'a [Coordinates]),
    /// A generalised force of 1 on one coordinate of a section.
    Unit { section: usize, coordinate: usize },
}
