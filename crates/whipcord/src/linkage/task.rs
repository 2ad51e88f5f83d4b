//! What is asked of the chain.

use whipcord_numerics::{Mat3, Vec3};

use super::division::Division;
use super::layout::Section;
use super::loads::AppliedLoads;
use super::motion::Coordinates;
use super::place_wrench::PlaceWrench;
use crate::budget::Meter;
use crate::statics::quadratic_form::across;

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
    /// In the tangent.
    pub moments: DeadMoments,
    pub meter: &'a Meter,
}

/// What a turn of the cross-section does to a dead moment `m` on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum DeadMoments {
    /// Nothing: the tangent is not symmetric.
    Exact,
    /// That of a moment of which one half follows, so that the tangent is symmetric; and `more` times `|m||η|²` across `m` in the energy.
    Symmetric { more: f64 },
}

impl DeadMoments {
    /// `∂m/∂η` of a follower and a dead moment in the frame of the cross-section.
    pub fn by_turn(self, follower: Vec3, dead: Vec3) -> Mat3 {
        match self {
            Self::Exact => -Mat3::skew(follower),
            Self::Symmetric { .. } if dead == Vec3::ZERO => -Mat3::skew(follower),
            Self::Symmetric { more } => -Mat3::skew(follower + 0.5 * dead) - across(dead) * more,
        }
    }
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
    Push(&'a PlaceWrench),
    /// One of its own for each section.
    Given(&'a [Coordinates]),
    /// A generalised force of 1 on one coordinate of a section.
    Unit { section: usize, coordinate: usize },
}
