//! What is to be solved on one grid.

use whipcord_numerics::UnitQuaternion;

use super::stability::Equilibrium;
use super::unloaded::SweepOptions;
use crate::budget::Meter;
use crate::case::Loads;
use crate::section::step_tolerance;
use crate::solution::Diagnostics;
use crate::statics::command::Command;
use crate::statics::convexity;
use crate::statics::grid::Grid;
use crate::statics::loads::AppliedLoads;
use crate::statics::quadratic_form::Sample;

/// When the stability of an equilibrium decides whether it is the answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StabilityCheck {
    /// Never.
    Off,
    /// Newton's method is trusted on each grid ([`Scratch::unverified`]), and the answer is checked once by who asks
    /// for it.
    AtAnswer,
    /// On each grid.
    EveryGrid,
}

/// What is to be solved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Problem<'a> {
    pub grid: &'a Grid,
    /// Length of the backbone in m.
    pub length: f64,
    /// In the order of the grid.
    pub commands: &'a [Command],
    /// The commands of the case: cables that were let go for the solution are held for its stability.
    pub asked: &'a [Command],
    pub loads: &'a Loads,
    /// How the base is turned in the frame that loads may be given in.
    pub base: UnitQuaternion,
    pub stability: StabilityCheck,
    /// Whether the path is followed past the point where the load cannot be raised.
    pub follow: bool,
    /// Whether it is found out how far cables go that do not go as far as they should.
    pub bracket: bool,
    /// Whether the robot has cables that pull against one another to no effect, see
    /// [`super::redundant_cables`].
    pub redundant_cables: bool,
    /// Whether the answer may be that of the case: its stability is then asked for.
    pub is_final: bool,
    /// Whether its least eigenvalue is asked for, too.
    pub has_eigenvalue: bool,
    /// Residual of eq. (7), relative to the scales of moment and length, at which it is met.
    pub tolerance: f64,
    pub meter: &'a Meter,
}

impl<'a> Problem<'a> {
    /// Whether there is one equilibrium at most: no force acts, so that the strains of a section follow
    /// from its rotation, and the shape from its base.
    pub fn is_only(&self, applied: &AppliedLoads) -> bool {
        applied.only_dead_moments() && !self.commands.iter().any(Command::is_length)
    }

    /// Whether the tangents at an answer with tensions like these are asked for at once, for its stability.
    pub fn is_checked(&self, applied: &AppliedLoads, tensions: &[f64]) -> bool {
        let is_due = match self.stability {
            StabilityCheck::Off => false,
            StabilityCheck::AtAnswer => self.is_final,
            StabilityCheck::EveryGrid => true,
        };
        is_due
            && !applied.any_follower()
            && (self.has_eigenvalue || !self.is_clearly_stable(applied, tensions))
    }

    /// Whether the loads are so weak that an equilibrium with these tensions is stable and not near critical.
    pub fn is_clearly_stable(&self, applied: &AppliedLoads, tensions: &[f64]) -> bool {
        convexity::is_shown(self.grid, applied, tensions, Diagnostics::NEAR_CRITICAL)
    }

    /// How the sections of the rod without load are solved: so far that they leave as little as those of a shot.
    pub fn sweep_options(&self) -> SweepOptions {
        SweepOptions::to(step_tolerance(self.tolerance))
    }

    /// An equilibrium of it whose stability is asked for.
    pub fn equilibrium(
        &self,
        samples: &'a [Sample],
        tensions: &'a [f64],
        lengths: &'a [f64],
        applied: &'a AppliedLoads,
        load: f64,
    ) -> Equilibrium<'a> {
        let Self { grid, asked: commands, .. } = *self;
        Equilibrium { grid, samples, commands, tensions, lengths, applied, load }
    }
}
