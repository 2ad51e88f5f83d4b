//! The shapes of a robot all over its commands: made once for a solver, kept in a file, or counted for its workspace.

use whipcord::{Case, Model, ModelKind, Stations, Vec3};

use crate::actuator::Actuator;
use crate::atlas::{Atlas, AtlasRows, Survey};
use crate::error::InverseError;
use crate::few_steps::for_atlas;
use crate::forward::Forward;
use crate::landmarks::Landmarks;
use crate::limits::{CableLimits, Limits};
use crate::solver::{InverseSolver, Ranges};

/// Rows of an atlas where the batch has vectors for them, and elsewhere.
const ROWS_OF_LANES: usize = 20_000;
const ROWS: usize = 2_000;
/// Rows of an atlas of a robot that remembers the steps before: each solve goes through them.
const ROWS_WITH_HISTORY: usize = 200;
/// Rows of a survey of the workspace where the batch has no vectors for them.
const ROWS_OF_A_SURVEY: usize = 10_000;

/// What the shapes of a robot depend on.
pub(crate) struct Surveyed<'a> {
    pub model: &'a Model,
    pub case: &'a Case,
    pub limits: &'a Limits,
    pub ranges: &'a Ranges,
    pub forward: &'a Forward,
}

impl Surveyed<'_> {
    /// The atlas, which is computed where it is not yet known.
    ///
    /// # Errors
    /// [`InverseError::Atlas`] where it cannot be computed, and [`InverseError::NoStart`].
    pub fn atlas<'a>(&self, known: &'a mut Option<Atlas>) -> Result<&'a Atlas, InverseError> {
        match known {
            Some(atlas) => Ok(atlas),
            none => Ok(none.insert(self.ask(self.rows(), Atlas::survey)?)),
        }
    }

    /// What is asked of a survey with so many rows.
    fn ask<T>(&self, rows: usize, ask: impl FnOnce(&Survey<'_>) -> T) -> T {
        let Self { model, case, limits, ranges, forward } = *self;
        let few = for_atlas(model);
        ask(&Survey {
            model: few.as_ref().unwrap_or(model),
            robot: forward.robot(),
            case,
            actuators: &forward.actuators.list,
            bounds: &ranges.unknowns,
            tensions: &sampled_tensions(limits, &ranges.unknowns, forward),
            rows,
        })
    }

    /// Rows of its atlas.
    fn rows(&self) -> usize {
        match self.model.kind() {
            _ if self.forward.robot().has_history() => ROWS_WITH_HISTORY,
            ModelKind::Cosserat if self.case.loads.is_none() => ROWS_OF_LANES,
            _ => ROWS,
        }
    }
}

impl InverseSolver {
    /// Lets [`Self::reach`] start from the nearest of the commands of the case and so many shapes all over the commands, except where the least change is preferred.
    /// They are computed with the first target of a kind with their first and second derivatives, which takes a few solves for each and one for each of its unknowns, and spare every
    /// target behind it most of its solves: worth their while for several targets for each shape. At 0 it starts from the commands of the case.
    pub fn start_from_shapes(&mut self, count: usize) {
        self.landmarks = Landmarks::default();
        self.spread = (count > 0).then(|| self.spread_over_commands(count));
    }

    /// The shapes that the iteration starts from, which are computed where they are not yet known: to be kept in a file, for a solver of another run.
    ///
    /// # Errors
    /// [`InverseError::Atlas`] where they cannot be computed, and [`InverseError::NoStart`].
    pub fn atlas(&mut self) -> Result<&AtlasRows, InverseError> {
        let Self { model, case, limits, ranges, forward, atlas, .. } = self;
        Surveyed { model, case, limits, ranges, forward }.atlas(atlas).map(Atlas::rows)
    }

    const fn surveyed(&self) -> Surveyed<'_> {
        let Self { model, case, limits, ranges, forward, .. } = self;
        Surveyed { model, case, limits, ranges, forward }
    }

    /// What its atlas depends on, as a number: the robot with its loads and base, the model, what is commanded, and the limits. It is the same in every run of one version of
    /// the library.
    #[must_use]
    pub fn atlas_identity(&self) -> u64 {
        let surveyed = self.surveyed();
        surveyed.ask(surveyed.rows(), |survey| survey.identity())
    }

    /// Takes the shapes of another run to start from.
    ///
    /// # Errors
    /// [`InverseError::ForeignAtlas`] where they are of another robot, model, load or limit.
    pub fn set_atlas(&mut self, rows: AtlasRows) -> Result<(), InverseError> {
        let is_own = rows.identity == self.atlas_identity();
        let disks = Stations::Disks.arc_lengths(self.forward.robot()).len();
        let atlas = is_own.then(|| Atlas::of_rows(rows, disks, &self.ranges.unknowns)).flatten();
        self.atlas = Some(atlas.ok_or(InverseError::ForeignAtlas)?);
        Ok(())
    }

    /// Tips and unknowns of as many shapes all over the commands.
    pub(crate) fn shapes(&self, count: usize) -> Result<Vec<(Vec3, Vec<f64>)>, InverseError> {
        let rows = match self.model.kind() {
            ModelKind::Cosserat if self.case.loads.is_none() => count,
            _ if self.forward.robot().has_history() => count.min(ROWS),
            _ => count.min(ROWS_OF_A_SURVEY),
        };
        let atlas = self.surveyed().ask(rows, Atlas::survey)?;
        Ok(atlas.each().map(|(tip, unknowns)| (tip, unknowns.to_vec())).collect())
    }

    /// Unknowns that are spread over their ranges, so many, the same each time.
    pub(crate) fn spread_over_commands(&self, count: usize) -> Vec<Vec<f64>> {
        self.surveyed().ask(count, |survey| survey.spread())
    }
}

/// Tensions of an atlas: within the limits, and no more than what bends the robot by a whole turn.
fn sampled_tensions(limits: &Limits, bounds: &[[f64; 2]], forward: &Forward) -> Vec<[f64; 2]> {
    let of = |(cable, of): (usize, &CableLimits)| {
        let [least, greatest] = of.tension;
        let number = forward.actuators.list.iter().position(|a| *a == Actuator::Tension(cable));
        match number {
            Some(number) => bounds[number],
            None if greatest.is_finite() => [least, greatest],
            None => [least, least + forward.tension_of_half_turn(cable)],
        }
    };
    limits.cables.iter().enumerate().map(of).collect()
}
