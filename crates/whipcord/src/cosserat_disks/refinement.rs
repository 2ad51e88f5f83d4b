//! Answers to a tolerance: the steps are halved until the answer changes no more; and the meshes for it.

use std::borrow::Cow;
use std::sync::OnceLock;

use super::layout::Mesh;
use super::levels::MAX_REFINEMENTS;
use super::levels::Refined;
use super::levels::STABILITY_LEVEL;
use super::model::CosseratDisks;
use super::problem::Sampled;
use super::problem::Start;
use super::statics;
use super::workspace::{StepHistory, Workspace};
use crate::case::Case;
use crate::derivatives::plastic_left;
use crate::error::SolveError;
use crate::statics::friction::{Course, History};
use crate::statics::options::{Accuracy, StabilityAnalysis};
use crate::statics::outcome::Found;
use crate::statics::refinement::ERROR_RATIO;
use crate::statics::strength::Strength;

/// A failure to converge is believed only with steps halved this often.
const GIVE_UP_LEVEL: usize = 4;
/// On so many meshes, one finer than the other, the answer is first looked for with little effort: steps that are too coarse for strong bends, or
/// for cables that are held at their lengths, cost a long search in vain.
const ATTEMPTS: usize = 3;
/// What such an attempt may spend on the robot without load, in shapes of the whole robot.
const SHAPES_WITHOUT_LOAD: usize = 300;
/// What an unstable equilibrium could be left for is looked for with steps halved this often.
const LEAVE_LEVEL: usize = 3;

impl CosseratDisks {
    /// Halves the steps until the answer changes no more.
    pub(super) fn solve_to(
        &self,
        tolerance: f64,
        cases: &[Case],
        mut start: Start<'_>,
        workspace: &mut Workspace,
    ) -> Result<Refined, SolveError> {
        let length = self.robot.backbone().length;
        let tolerance = tolerance * length;
        let (mut error, mut steps, mut iterations) = (f64::INFINITY, 0, 0);
        let mut lost_at = None;
        let mut coarser = false;
        let first = self.first_level(cases, workspace);
        // What holes remember is found step by step of actuation, for which there is no telling what it takes.
        let mut attempts = if self.holes.is_none() { ATTEMPTS } else { 0 };
        // Where the robot under loads was found without them: with all effort nothing coarser is tried.
        let mut without_load = None;
        let mut next = first;
        while next <= MAX_REFINEMENTS {
            let level = next;
            next += 1;
            let mesh = self.mesh(level)?;
            workspace.progress.level = level;
            let is_attempt = attempts > 0 && !coarser;
            if is_attempt {
                workspace.meter.attempt(SHAPES_WITHOUT_LOAD * mesh.grid.len());
            }
            let found = self.solve_on(level, &mesh, cases, start, workspace);
            workspace.meter.end_attempt();
            if is_attempt && workspace.scratch.found_without_load {
                without_load = without_load.or(Some(level));
            }
            let is_left =
                workspace.scratch.unstable && self.options.stability != StabilityAnalysis::Off;
            // Little effort proves nothing.
            let is_open = match &found {
                Ok(_) => is_left,
                Err(
                    SolveError::NotConverged { .. }
                    | SolveError::TensionsNotFound
                    | SolveError::SectionFolds { .. }
                    | SolveError::UnreachableLength { .. }
                    | SolveError::ContradictoryLengths { .. }
                    | SolveError::Buckled { .. },
                ) => !workspace.meter.has_ended(),
                Err(_) => false,
            };
            if is_attempt && is_open {
                attempts -= 1;
                next = match attempts {
                    // What it is left for on coarser steps counts for nothing.
                    0 if found.is_ok() => level.max(LEAVE_LEVEL),
                    0 => without_load.unwrap_or(first),
                    _ => next,
                };
                workspace.scratch.open = None;
                continue;
            }
            let found = match found {
                // Steps that are too coarse for a strong bend can keep Newton's method away.
                Err(
                    SolveError::NotConverged { .. }
                    | SolveError::TensionsNotFound
                    | SolveError::SectionFolds { .. }
                    | SolveError::UnreachableLength { .. },
                ) if !coarser && level < GIVE_UP_LEVEL && !workspace.meter.has_ended() => {
                    continue;
                }
                other => other?,
            };
            iterations += found.iterations;
            // A stable branch may not be there on coarse steps, or in another place.
            if is_left && level < LEAVE_LEVEL {
                continue;
            }
            lost_at = lost_at.or(found.lost_at);
            if coarser {
                error = workspace.change(&mesh, length) / ERROR_RATIO;
                if error <= tolerance {
                    let found = Found { iterations, lost_at, ..found };
                    return Ok(Refined { found, level, error: Some(error) });
                }
            }
            workspace.keep(&mesh);
            workspace.progress.coarser = Some(Found { iterations, lost_at, ..found });
            start = Start::Coarser;
            (steps, coarser) = (mesh.grid.len(), true);
        }
        Err(SolveError::StepsTooCoarse { error, tolerance, steps })
    }

    /// The mesh whose steps are halved so often; where the steps are prescribed, the only one.
    pub(super) fn mesh(&self, level: usize) -> Result<Cow<'_, Mesh>, SolveError> {
        if let Some(mesh) = self.kept_mesh(level)? {
            return Ok(Cow::Borrowed(mesh));
        }
        Ok(Cow::Owned(self.made_mesh(1, level)?))
    }

    /// A mesh of its own, with the plastic curvature that earlier steps of actuation left.
    fn made_mesh(&self, steps: usize, halvings: usize) -> Result<Mesh, SolveError> {
        let mut mesh = self.frame.mesh(steps, halvings)?;
        if let Some(plastic) = &self.plastic {
            self.frame.set_plastic(&mut mesh, plastic);
        }
        Ok(mesh)
    }

    /// The same, made and kept; `None` for one that is too fine to be kept.
    fn kept_mesh(&self, level: usize) -> Result<Option<&Mesh>, SolveError> {
        let Some(place) = level.checked_sub(1) else { return Ok(Some(&self.mesh)) };
        let Some(slot) = self.finer.get(place) else { return Ok(None) };
        made(slot, || self.made_mesh(1, level)).map(Some)
    }

    /// The meshes on which stability is computed: for the usual case the first of the sequence with steps enough.
    pub(super) fn sampled(&self) -> Result<Sampled<'_>, SolveError> {
        let is_sequence = matches!(self.options.accuracy, Accuracy::Tolerance(_));
        let finest = if is_sequence { STABILITY_LEVEL } else { 0 };
        let has_enough = |level: &usize| self.mesh.grid.len() << level >= self.stability_steps;
        let of_sequence = |level| self.kept_mesh(level).map(|mesh| mesh.unwrap_or(&self.mesh));
        let fine = if is_sequence && has_enough(&finest) {
            of_sequence(finest)?
        } else {
            made(&self.fine, || self.made_mesh(self.stability_steps.div_ceil(4), 2))?
        };
        let usual = (0..=finest).find(has_enough).map(of_sequence).transpose()?;
        Ok(Sampled { usual: usual.unwrap_or(fine), fine })
    }

    /// How often the steps of the first mesh are halved before anything is tried: until they see the layer in which
    /// the greatest force of the cases bends the rod.
    pub(super) fn first_level(&self, cases: &[Case], workspace: &mut Workspace) -> usize {
        let of_case = |case: &Case| self.strength(case, workspace).first_level();
        let first = cases.iter().filter(|case| !case.loads.is_none()).map(of_case).max();
        first.map_or(0, |level| level.min(GIVE_UP_LEVEL))
    }

    /// How strong the loads of a case are.
    pub(super) fn strength(&self, case: &Case, workspace: &mut Workspace) -> Strength {
        if case.loads.is_none() {
            return Strength::default();
        }
        let grid = &self.mesh.grid;
        let applied = &mut workspace.scratch.applied;
        applied.gather(grid, &case.loads, case.base.rotation);
        Strength::of(applied, grid, self.robot.backbone().length)
    }

    /// The answer to the last step on one mesh. What holes remember depends on the mesh: the whole way
    /// is gone on each.
    pub(super) fn solve_on(
        &self,
        level: usize,
        mesh: &Mesh,
        cases: &[Case],
        start: Start<'_>,
        workspace: &mut Workspace,
    ) -> Result<Found, SolveError> {
        let Workspace { scratch, histories, courses, keeps_trail, .. } = &mut *workspace;
        courses.resize(cases.len().max(courses.len()), Course::default());
        if histories.len() <= level {
            histories.resize(level + 1, StepHistory::default());
        }
        // Where a step fails the way starts anew.
        let StepHistory { taken, history, mut plastic } = core::mem::take(&mut histories[level]);
        let taken = if self.holes.is_some() { taken } else { 0 };
        let keeps_plastic = self.holes.is_some() && self.robot.has_bending_friction();
        if taken == 0 {
            plastic.clear();
        }
        let mut mesh = Cow::Borrowed(mesh);
        scratch.history = match taken {
            0 if *keeps_trail => History::with_trail(),
            0 => History::default(),
            _ => history,
        };
        let mut found = Found::default();
        for (n, case) in cases.iter().enumerate().skip(taken) {
            if let Some(left) = plastic.last() {
                self.frame.set_plastic(mesh.to_mut(), left);
            }
            let Workspace { scratch, commands, courses, meter, .. } = &mut *workspace;
            scratch.applied.gather(&mesh.grid, &case.loads, case.base.rotation);
            self.commands(case, commands)?;
            let problem = self.problem(&mesh, (commands, meter), case)?;
            // What a coarser mesh found is that of the last step.
            let start = if n + 1 == cases.len() { start } else { Start::Cold };
            scratch.course = core::mem::take(&mut courses[n]);
            found = statics::solve(&problem, start, scratch)
                .map_err(|failure| self.explain(failure, commands))?;
            courses[n] = core::mem::take(&mut scratch.course);
            if keeps_plastic {
                let leaves = self.with_answer(case, &mesh, (None, &[]), workspace, plastic_left);
                // The sections of a rod without cables have no equilibrium to miss.
                plastic.push(leaves.map_err(|_| SolveError::NoDerivatives)?);
            }
        }
        let history = workspace.scratch.history.clone();
        workspace.histories[level] = StepHistory { taken: cases.len(), history, plastic };
        Ok(found)
    }
}

/// What a slot holds, made where it is empty.
fn made(
    slot: &OnceLock<Mesh>,
    make: impl FnOnce() -> Result<Mesh, SolveError>,
) -> Result<&Mesh, SolveError> {
    if let Some(mesh) = slot.get() {
        return Ok(mesh);
    }
    let mesh = make()?;
    Ok(slot.get_or_init(|| mesh))
}
