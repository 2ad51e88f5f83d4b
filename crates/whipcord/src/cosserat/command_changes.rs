//! An answer and how it changes with the commands of the cables, without its other derivatives.
//!
//! Without load the changes are those of the discrete answer, [`TensionChanges::without_load`]. Under loads eq. (5) of
//! [`super::sensitivity`] gives the motion of every node with the base moment, the followers' force at the base and each tension, to order 4;
//! what the tip bears takes the first two, `z`, from the tensions:
//!
//! ```text
//! ∂W/∂z δz + ∂W/∂τ δτ = 0,   δg = ∂g/∂z δz + ∂g/∂τ δτ,   δℓ = ∂ℓ/∂z δz + ∂ℓ/∂τ δτ
//! ```

use whipcord_numerics::{DenseLu, Twist, Vec3};

use super::prepared::{Cosserat, Workspace};
use super::scratch::Scratch;
use super::sensitivity::Sensitivity;
use super::shooting::sample;
use crate::case::Case;
use crate::derivatives::{Change, CommandedCable, Solved, TensionChanges, TipRatesMemory};
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::shape::{Solution, Wrench};
use crate::statics::grid::Grid;

impl Cosserat {
    /// [`Self::solve`], with how the answer changes with the command of each cable of the robot, at a fraction of the cost of
    /// [`Self::solve_with_derivatives`]. Without load the changes are exact; under loads their relative error is that of a
    /// method of order 4 on the steps of the answer, about 1e-3 with 12 steps: enough for an iteration that
    /// corrects itself. They have no strains.
    ///
    /// # Errors
    /// As [`Self::solve_with_derivatives`].
    pub fn solve_with_command_changes(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> Result<(Solution, Vec<Change>), SolveError> {
        let has_history = self.has_friction() || self.robot.has_bending_friction();
        if has_history || !case.obstacles.is_empty() {
            return self.with_all_derivatives(case, warm_start, workspace);
        }
        workspace.meter.start(&self.options.cancel, self.options.budget);
        let mut solution = Solution::empty(ModelKind::Cosserat);
        let solved = self.solve_keeping_grid(case, warm_start.into(), workspace, &mut solution);
        let grid = workspace.meter.checked(solved)?;
        if workspace.scratch.on_chain {
            return self.with_all_derivatives(case, Some(&solution), workspace);
        }
        let mut changes = core::mem::take(&mut workspace.tension_changes);
        let found = if workspace.scratch.applied.any() {
            self.under_loads(case, &grid, workspace, &mut changes)
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
        close(motions, grid.len() + 1, cables, changes).ok_or(SolveError::NoDerivatives)
    }
}

/// The changes with the tensions at which the tip bears what it bore. `None` where a small load changes the answer without bound.
fn close(
    of: &Sensitivity,
    nodes: usize,
    cables: usize,
    changes: &mut TensionChanges,
) -> Option<()> {
    let unknowns = of.excess.len();
    // The moment at the base, and the followers' force where there is one.
    let base = unknowns - cables;
    let component = |wrench: &Wrench, i: usize| match i {
        0..3 => wrench.moment[i],
        _ => wrench.force[i - 3],
    };
    let matrix: Vec<f64> =
        (0..base * base).map(|at| component(&of.excess[at % base], at / base)).collect();
    let mut lu = DenseLu::default();
    lu.factor(base, &matrix).ok()?;
    changes.prepare(cables, nodes);
    for cable in 0..cables {
        let column = base + cable;
        let mut at_base: Vec<f64> = (0..base).map(|i| -component(&of.excess[column], i)).collect();
        lu.solve(&mut at_base);
        let (motions, lengths, wrench) = changes.of(cable);
        for (motion, by) in motions.iter_mut().zip(of.motions.chunks_exact(unknowns)) {
            *motion = by[column];
            for (by, z) in by.iter().zip(&at_base) {
                motion.linear += *z * by.linear;
                motion.angular += *z * by.angular;
            }
        }
        for (length, by) in lengths.iter_mut().zip(of.lengths.chunks_exact(unknowns)) {
            *length = by[column] + by.iter().zip(&at_base).map(|(by, z)| z * by).sum::<f64>();
        }
        let vector = |first: usize| {
            let of = |i: usize| at_base.get(first + i).copied().unwrap_or(0.0);
            Vec3::new(of(0), of(1), of(2))
        };
        *wrench = Wrench { moment: vector(0), force: vector(3) };
    }
    Some(())
}
