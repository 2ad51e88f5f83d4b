//! Answers to a tolerance: the steps are halved until the answer changes no more.

use std::borrow::Cow;
use std::sync::OnceLock;

use super::prepared::{
    COARSE_STEPS, COARSER_RESIDUAL, Cosserat, FOLD_LEVEL, FOLLOW_LEVEL, GIVE_UP_LEVEL,
    MAX_REFINEMENTS, Refined, Workspace,
};
use super::problem::{self, StabilityCheck};
use super::scratch::{Scratch, Start};
use super::solve;
use super::verdict;
use crate::case::Case;
use crate::error::SolveError;
use crate::solution::Solution;
use crate::statics::command::Command;
use crate::statics::grid::Grid;
use crate::statics::options::StabilityAnalysis;
use crate::statics::outcome::{Failure, Found};
use crate::statics::refinement::ERROR_RATIO;
use crate::statics::strength::{GAVE_UP, Strength};

/// Residual of a shape that is only looked at.
const COARSE_RESIDUAL: f64 = 1e-6;
/// Where lengths are given they do not change with the steps; the tensions do. The steps are those
/// that suffice for the tensions found, so that the lengths of an answer return its tensions and not
/// those of another grid. The positions may be off by this much more than the tolerance, where they
/// hang more on the lengths than on the tensions.
const LENGTHS_SLACK: f64 = 100.0;

/// How an answer on one grid is looked for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Attempt {
    /// How often the steps of the first grid are halved.
    pub level: usize,
    pub check: StabilityCheck,
    /// Whether it may be the answer, or only what a finer grid starts from.
    pub is_final: bool,
}

impl Workspace {
    /// Keeps what the answer on a coarse grid is compared by.
    pub(super) fn keep_coarse(&mut self, grid: &Grid) {
        self.coarse.keep(grid, &self.scratch.poses, &self.scratch.lengths);
    }

    /// Estimated error in m of positions and cables' lengths: as much of their largest change since then
    /// as the order of the method leaves.
    pub(super) fn error(&self, grid: &Grid) -> f64 {
        let Scratch { poses, lengths, .. } = &self.scratch;
        self.coarse.change(grid, poses, lengths) / ERROR_RATIO
    }
}

impl Cosserat {
    /// The grid whose steps are halved so often; where the steps are prescribed, the only one.
    pub(super) fn grid(&self, level: usize) -> Result<Cow<'_, Grid>, SolveError> {
        let Some(place) = level.checked_sub(1) else { return Ok(Cow::Borrowed(&self.grid)) };
        let slot = self.finer.get(place);
        if let Some(grid) = slot.and_then(OnceLock::get) {
            return Ok(Cow::Borrowed(grid));
        }
        let mut grid = Grid::refined(&self.robot, &self.layout, COARSE_STEPS, level)?;
        if let Some(plastic) = &self.plastic {
            grid.set_plastic(plastic);
        }
        Ok(match slot {
            Some(slot) => Cow::Borrowed(slot.get_or_init(|| grid)),
            None => Cow::Owned(grid),
        })
    }

    /// An answer whose stability is checked once, at the end. Where it is not stable, or where an equilibrium that was
    /// not checked led to none, it is looked for again with a check on each grid.
    pub(super) fn solve_checked<'a>(
        &'a self,
        case: &Case,
        workspace: &mut Workspace,
        solution: &mut Solution,
        attempt: impl Fn(StabilityCheck, &mut Workspace) -> Result<Refined<'a>, SolveError>,
    ) -> Result<Cow<'a, Grid>, SolveError> {
        let mut check = match self.options.stability {
            StabilityAnalysis::Off => StabilityCheck::Off,
            _ => StabilityCheck::AtAnswer,
        };
        loop {
            workspace.scratch.unverified = false;
            let refined = attempt(check, workspace);
            let is_open = check == StabilityCheck::AtAnswer && workspace.scratch.unverified;
            if !is_open || workspace.meter.has_ended() {
                let Refined { found, grid, error } = refined?;
                self.write(&grid, case, workspace, (found, error), solution)?;
                return Ok(grid);
            }
            if let Ok(Refined { found, grid, error }) = refined {
                self.write(&grid, case, workspace, (found, error), solution)?;
                if !solution.diagnostics.is_unstable() && self.is_kept(&grid, case, workspace) {
                    return Ok(grid);
                }
            }
            check = StabilityCheck::EveryGrid;
        }
    }

    /// Whether the answer, which is not known to be unstable, is kept: under dead moments, whose verdict may be open, where
    /// the symmetric part of the tangent has no negative direction.
    fn is_kept(&self, grid: &Grid, case: &Case, workspace: &mut Workspace) -> bool {
        let problem = self.problem(grid, case, (&workspace.commands, &workspace.meter));
        let scratch = &mut workspace.scratch;
        !scratch.applied.any_dead_moment() || verdict::is_stable(&problem, scratch)
    }

    /// The answer on the first grid on which it changes by no more than the tolerance, and its estimated error in m.
    pub(super) fn halve_steps(
        &self,
        tolerance: f64,
        case: &Case,
        start: &Start,
        check: StabilityCheck,
        workspace: &mut Workspace,
    ) -> Result<Refined<'_>, SolveError> {
        let tolerance = tolerance * self.robot.backbone().length;
        let mut coarser: Option<(Found, Cow<'_, Grid>)> = None;
        let (mut error, mut steps) = (f64::INFINITY, 0);
        let strength = self.strength(case, workspace);
        let first = self.first_level(case, workspace);
        workspace.scratch.trajectory.steps_left = strength.allowance(self.grid(first)?.as_ref());
        for level in first..=MAX_REFINEMENTS {
            if workspace.meter.has_ended() {
                return Err(workspace.meter.end());
            }
            let grid = self.grid(level)?;
            workspace.progress.level = level;
            let from_coarser = core::mem::take(&mut workspace.from_coarser);
            let from = if coarser.is_some() { &from_coarser } else { start };
            let kind = Attempt { level, check, is_final: coarser.is_some() };
            let solved = self.solve_on(&grid, case, from, kind, workspace);
            workspace.from_coarser = from_coarser;
            let mut found = match solved {
                // Steps that are too coarse for a strong bend can keep Newton's method away, and near a
                // buckling load one grid may lose the stability that a coarser one still had.
                Err(SolveError::NotConverged { .. } | SolveError::Buckled { .. })
                    if level < GIVE_UP_LEVEL
                        && workspace.scratch.trajectory.steps_left > 0
                        && !workspace.meter.has_ended() =>
                {
                    coarser = None;
                    workspace.progress.coarser = None;
                    continue;
                }
                // A section folds between the nodes of a coarse grid before it does at them: only
                // with fine steps is it known how far a cable goes.
                Err(SolveError::UnreachableLength { .. })
                    if level < FOLD_LEVEL && !workspace.meter.has_ended() =>
                {
                    coarser = None;
                    workspace.progress.coarser = None;
                    continue;
                }
                other => other?,
            };
            if let Some((earlier, coarse)) = &coarser {
                found = found.after(earlier);
                error = workspace.error(&grid);
                let given_lengths =
                    workspace.commands.iter().any(|c| matches!(c, Command::Length { .. }));
                let mut met = error <= tolerance;
                if given_lengths
                    && error <= LENGTHS_SLACK * tolerance
                    && let Some(other) = self.change_at_tensions(coarse, &grid, case, workspace)
                {
                    met = other <= tolerance;
                    error = error.max(other);
                }
                if met {
                    return Ok(Refined { found, grid, error: Some(error) });
                }
            }
            workspace.keep_coarse(&grid);
            workspace.scratch.keep_start(&mut workspace.from_coarser);
            workspace.scratch.trajectory.steps_left = strength.allowance(&grid);
            steps = grid.len();
            workspace.progress.coarser = Some(found);
            coarser = Some((found, grid));
        }
        Err(SolveError::StepsTooCoarse { error, tolerance, steps })
    }

    /// The equilibrium on the coarsest grid, to [`COARSE_RESIDUAL`] and whether it is stable or not: the workspace holds it.
    pub(super) fn solve_coarsely(
        &self,
        case: &Case,
        workspace: &mut Workspace,
    ) -> Result<(), SolveError> {
        self.accept(case, workspace)?;
        let grid = &self.grid;
        let allowance = self.strength(case, workspace).allowance(grid);
        let problem = problem::Problem {
            stability: StabilityCheck::Off,
            follow: false,
            bracket: false,
            tolerance: COARSE_RESIDUAL,
            ..self.problem(grid, case, (&workspace.commands, &workspace.meter))
        };
        workspace.scratch.trajectory.steps_left = allowance;
        let found = solve::solve(&problem, &Start::default(), &mut workspace.scratch);
        found.map(|_| ()).map_err(|failure| self.explain(failure, &workspace.commands))
    }

    /// How often the steps are halved on the first grid that a case is tried on.
    pub(super) fn first_level(&self, case: &Case, workspace: &mut Workspace) -> usize {
        let twist_level = if case.loads.is_none() { 0 } else { self.twist_level };
        self.strength(case, workspace).first_level().max(twist_level)
    }

    /// How strong the loads of a case are.
    pub(super) fn strength(&self, case: &Case, workspace: &mut Workspace) -> Strength {
        if case.loads.is_none() {
            return Strength::default();
        }
        let grid = &self.grid;
        let loads = &mut workspace.scratch.applied;
        loads.gather(grid, &case.loads, case.base.rotation);
        Strength::of(loads, grid, self.robot.backbone().length)
    }

    /// The estimated error that the answer in the workspace would have if its tensions had been
    /// given instead of lengths; `None` where they fold the coarse grid.
    fn change_at_tensions(
        &self,
        coarse: &Grid,
        grid: &Grid,
        case: &Case,
        workspace: &mut Workspace,
    ) -> Option<f64> {
        workspace.tensions.clear();
        workspace.tensions.extend(workspace.scratch.tensions.iter().map(|&t| Command::Tension(t)));
        let problem = problem::Problem {
            // What is stable at given lengths need not be so at given tensions.
            stability: StabilityCheck::Off,
            ..self.problem(coarse, case, (&workspace.tensions, &workspace.meter))
        };
        let problem =
            problem::Problem { tolerance: COARSER_RESIDUAL * problem.tolerance, ..problem };
        workspace.scratch.keep_start(&mut workspace.from_coarser);
        (workspace.from_coarser.remembered, workspace.from_coarser.side_by_side) = (false, false);
        workspace.at_tensions.trajectory.steps_left = workspace.scratch.trajectory.steps_left;
        solve::solve(&problem, &workspace.from_coarser, &mut workspace.at_tensions).ok()?;
        let Workspace { at_tensions, coarse: kept, .. } = &mut *workspace;
        kept.keep(coarse, &at_tensions.poses, &at_tensions.lengths);
        Some(workspace.error(grid))
    }

    pub(super) fn solve_on(
        &self,
        grid: &Grid,
        case: &Case,
        start: &Start,
        attempt: Attempt,
        workspace: &mut Workspace,
    ) -> Result<Found, SolveError> {
        let Attempt { level, check, is_final } = attempt;
        let whole = self.problem(grid, case, (&workspace.commands, &workspace.meter));
        let problem = problem::Problem {
            follow: level >= FOLLOW_LEVEL,
            bracket: level >= FOLD_LEVEL,
            stability: check,
            is_final,
            tolerance: whole.tolerance * if is_final { 1.0 } else { COARSER_RESIDUAL },
            ..whole
        };
        solve::solve(&problem, start, &mut workspace.scratch).map_err(|failure| {
            let Scratch { trajectory, applied, .. } = &workspace.scratch;
            let strength = Strength::of(applied, grid, self.robot.backbone().length);
            let failure = match failure {
                Failure::NotConverged { iterations, residual, last_load, .. }
                    if trajectory.steps_left == 0 && strength.is_out_of_proportion() =>
                {
                    Failure::NotConverged { iterations, residual, last_load, advice: GAVE_UP }
                }
                other => other,
            };
            self.explain(failure, &workspace.commands)
        })
    }
}
