//! An answer and how it changes with the commands of the cables, without its other derivatives.
//!
//! Without load the changes are those of the discrete answer, [`TensionChanges::without_load`]. Under loads eq. (5) of
//! [`super::sensitivity`] gives the motion of every node with the base moment, the followers' force at the base and each tension, to order 4;
//! what the tip bears takes the first two, `z`, from the tensions:
//!
//! ```text
//! ∂W/∂z δz + ∂W/∂τ δτ = 0,   δg = ∂g/∂z δz + ∂g/∂τ δτ,   δℓ = ∂ℓ/∂z δz + ∂ℓ/∂τ δτ
//! ```
//!
//! The same derivatives take the step that Newton's method would take next, without another integration: its residual is then the square of
//! the one that was left.

use whipcord_numerics::{DenseLu, Twist, UnitQuaternion, Vec3};

use super::prepared::{Cosserat, Workspace};
use super::scratch::Scratch;
use super::sensitivity::Sensitivity;
use super::shooting::sample;
use crate::case::Case;
use crate::derivatives::{Change, CommandedCable, Solved, TensionChanges, TipRatesMemory};
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::shape::Wrench;
use crate::solution::Solution;
use crate::statics::grid::Grid;
use crate::statics::options::{Accuracy, StabilityAnalysis};
use crate::statics::scales::Scales;

impl Cosserat {
    /// [`Self::solve`], with how the answer changes with the command of each cable of the robot, at a fraction of the cost of
    /// [`Self::solve_with_derivatives`]. Without load the changes are exact; under loads their relative error is that of a
    /// method of order 4 on the steps of the answer, about 1e-3 with 12 steps: enough for an iteration that
    /// corrects itself. They have no strains. On prescribed steps and without a check of stability the iteration under loads ends at the
    /// residual `corrected`, where that is greater than the one of the options: what it leaves is taken away by the changes, so that about its square is
    /// left, and a thousandth of it.
    ///
    /// # Errors
    /// As [`Self::solve_with_derivatives`].
    pub fn solve_with_command_changes(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        corrected: f64,
        workspace: &mut Workspace,
    ) -> Result<(Solution, Vec<Change>), SolveError> {
        let has_history = self.has_friction() || self.robot.has_bending_friction();
        if has_history || !case.obstacles.is_empty() {
            return self.with_all_derivatives(case, warm_start, workspace);
        }
        workspace.meter.start(&self.options.cancel, self.options.budget);
        let mut solution = Solution::empty(ModelKind::Cosserat);
        // On a grid of its own there is no answer on another one that it is compared with.
        let is_alone = matches!(self.options.accuracy, Accuracy::Steps(_))
            && self.options.stability == StabilityAnalysis::Off;
        // Cables that were let go are not where their commands lead.
        let corrected = if is_alone && !self.redundant_cables { corrected } else { 0.0 };
        workspace.scratch.corrected = corrected;
        let solved = self.solve_keeping_grid(case, warm_start.into(), workspace, &mut solution);
        workspace.scratch.corrected = 0.0;
        let grid = workspace.meter.checked(solved)?;
        if workspace.scratch.on_chain {
            return self.with_all_derivatives(case, Some(&solution), workspace);
        }
        let mut changes = core::mem::take(&mut workspace.tension_changes);
        let found = if workspace.scratch.applied.any() {
            self.under_loads(case, &grid, workspace, &mut changes).and_then(|()| {
                match corrected > 0.0 {
                    true => self.correct(case, &grid, workspace, &mut solution),
                    false => Ok(()),
                }
            })
        } else {
            let without_load = |solved: &Solved<'_>| changes.without_load(solved);
            self.with_answer(case, &grid, &[], workspace, without_load)
                .map_err(|fault| self.fault(fault, workspace))
        };
        let scratch = &workspace.scratch;
        let commanded: Vec<CommandedCable> = (self.layout.order.iter().zip(&workspace.commands))
            .zip(self.layout.rest_lengths.iter().zip(&scratch.tensions))
            .map(|((&cable, &command), (&rest, &tension))| CommandedCable {
                command,
                compliance: self.robot.cable_compliance(cable, rest),
                is_taut: tension > 0.0,
            })
            .collect();
        let by_commands = found.and_then(|()| {
            let by_commands = changes.by_commands(&grid, &commanded, &self.layout.order);
            by_commands.map_err(|_| SolveError::NoDerivatives)
        });
        workspace.tension_changes = changes;
        Ok((solution, by_commands?))
    }

    /// The motion of the tip, base frame, with the command of each cable of the robot at an answer to a case without friction and obstacles: to the bits of
    /// [`crate::derivatives::Derivatives::actuation_jacobian`] of [`Self::solve_with_derivatives`] from that answer, but in
    /// memory that the workspace keeps, so that it allocates nothing once it has that.
    ///
    /// # Errors
    /// As [`Self::solve_with_derivatives`].
    pub(crate) fn tip_by_commands(
        &self,
        case: &Case,
        solution: &Solution,
        workspace: &mut Workspace,
        out: &mut Vec<Twist>,
    ) -> Result<(), SolveError> {
        workspace.meter.start(&self.options.cancel, self.options.budget);
        let mut memory = core::mem::take(&mut workspace.tip_rates);
        let TipRatesMemory { rates, answer, lists, .. } = &mut memory;
        let answer = answer.get_or_insert_with(|| Solution::empty(ModelKind::Cosserat));
        let solved = self.solve_keeping_grid(case, Some(solution).into(), workspace, answer);
        let found = workspace.meter.checked(solved).and_then(|grid| {
            let by_commands = |solved: &Solved<'_>| rates.by_commands(&solved.driven(), None, out);
            let found =
                self.with_lists_of_answer(case, &grid, &[], (&*workspace, lists), by_commands);
            found.map_err(|none| self.no_derivatives(none, workspace))
        });
        workspace.tip_rates = memory;
        found
    }

    fn with_all_derivatives(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> Result<(Solution, Vec<Change>), SolveError> {
        let (solution, derivatives) =
            self.solve_with_derivatives(case, warm_start, &[], workspace)?;
        Ok((solution, derivatives.commands()))
    }

    /// The changes with the tensions of an answer of single shooting.
    fn under_loads(
        &self,
        case: &Case,
        grid: &Grid,
        workspace: &mut Workspace,
        changes: &mut TensionChanges,
    ) -> Result<(), SolveError> {
        let Workspace { scratch, commands, meter, .. } = &mut *workspace;
        let sampled = sample(&self.problem(grid, case, (commands, meter)), scratch);
        sampled.map_err(|fault| self.fault(fault, workspace))?;
        let Workspace { scratch, motions, .. } = workspace;
        let Scratch { applied, trajectory, poses, tensions, .. } = scratch;
        let cables = tensions.len();
        motions.follows_motions = true;
        motions.compute(grid, applied, 1.0, &trajectory.samples, poses, cables);
        let base = motions.excess.len() - cables;
        let lu = at_base(motions, base).ok_or(SolveError::NoDerivatives)?;
        close(motions, (&lu, base), grid.len() + 1, cables, changes);
        Ok(())
    }

    /// Takes away what the answer of [`Self::under_loads`] has left of the residual, by one step of Newton's method without another integration.
    fn correct(
        &self,
        case: &Case,
        grid: &Grid,
        workspace: &mut Workspace,
        solution: &mut Solution,
    ) -> Result<(), SolveError> {
        let Workspace { scratch, motions, commands, .. } = &mut *workspace;
        let Scratch { applied, trajectory, poses, tensions, lengths, base_wrench, newton, .. } =
            scratch;
        let cables = tensions.len();
        let base = motions.excess.len() - cables;
        let scales = Scales::of(grid, self.robot.backbone().length);
        core::mem::swap(&mut newton.sensitivity, motions);
        newton.point.base_moment = base_wrench.moment;
        newton.point.follower_force = applied.follower_share(base_wrench.force);
        newton.point.tensions.clone_from(tensions);
        trajectory.lengths.clone_from(lengths);
        let is_solved = newton.solve_step(commands, trajectory, &scales);
        core::mem::swap(&mut newton.sensitivity, motions);
        if !is_solved {
            return Err(SolveError::NoDerivatives);
        }
        newton.set_trial(1.0);
        let (from, to) = (&newton.point, &newton.trial);
        let moment = to.base_moment - from.base_moment;
        let force = to.follower_force - from.follower_force;
        let step = |column: usize| match column.checked_sub(base) {
            Some(cable) => to.tensions[cable] - from.tensions[cable],
            None if column < 3 => moment[column],
            None => force[column - 3],
        };
        let unknowns = base + cables;
        for (pose, by) in poses.iter_mut().zip(motions.motions.chunks_exact(unknowns)) {
            let mut moved = Twist::default();
            for (column, by) in by.iter().enumerate() {
                moved.linear += step(column) * by.linear;
                moved.angular += step(column) * by.angular;
            }
            pose.position += moved.linear;
            pose.rotation = UnitQuaternion::exp(moved.angular) * pose.rotation;
        }
        for (length, by) in lengths.iter_mut().zip(motions.lengths.chunks_exact(unknowns)) {
            *length += by.iter().enumerate().map(|(column, by)| step(column) * by).sum::<f64>();
        }
        base_wrench.moment += moment;
        base_wrench.force += force;
        tensions.clone_from(&to.tensions);
        self.write_shape(grid, case, workspace, solution);
        Ok(())
    }
}

/// A number of what the base or the tip bears: the moment, and the followers' force where there is one.
fn component(wrench: &Wrench, i: usize) -> f64 {
    if i < 3 { wrench.moment[i] } else { wrench.force[i - 3] }
}

/// The wrench of such numbers.
fn wrench_of(numbers: &[f64]) -> Wrench {
    let vector = |first: usize| {
        let of = |i: usize| numbers.get(first + i).copied().unwrap_or(0.0);
        Vec3::new(of(0), of(1), of(2))
    };
    Wrench { moment: vector(0), force: vector(3) }
}

/// How what the tip bears changes with what the base does, factored. `None` where a small load changes the answer without bound.
fn at_base(of: &Sensitivity, base: usize) -> Option<DenseLu> {
    let mut matrix = [0.0; 36];
    for (at, entry) in matrix[..base * base].iter_mut().enumerate() {
        *entry = component(&of.excess[at % base], at / base);
    }
    let mut lu = DenseLu::default();
    lu.factor(base, &matrix[..base * base]).ok()?;
    Some(lu)
}

/// The changes with the tensions at which the tip bears what it bore.
fn close(
    of: &Sensitivity,
    (lu, base): (&DenseLu, usize),
    nodes: usize,
    cables: usize,
    changes: &mut TensionChanges,
) {
    let unknowns = base + cables;
    changes.prepare(cables, nodes);
    for cable in 0..cables {
        let column = base + cable;
        let mut numbers = [0.0; 6];
        (0..base).for_each(|i| numbers[i] = -component(&of.excess[column], i));
        let at_base = &mut numbers[..base];
        lu.solve(at_base);
        let (motions, lengths, wrench) = changes.of(cable);
        for (motion, by) in motions.iter_mut().zip(of.motions.chunks_exact(unknowns)) {
            *motion = by[column];
            for (by, z) in by.iter().zip(&*at_base) {
                motion.linear += *z * by.linear;
                motion.angular += *z * by.angular;
            }
        }
        for (length, by) in lengths.iter_mut().zip(of.lengths.chunks_exact(unknowns)) {
            *length = by[column] + by.iter().zip(&*at_base).map(|(by, z)| z * by).sum::<f64>();
        }
        *wrench = wrench_of(at_base);
    }
}
