//! The stable equilibrium of a chain that leaves the one on its load path, as a column does beyond its critical load.

use whipcord_numerics::{Missed, Solved, continuation};

use super::loads::AppliedLoads;
use super::motion::Coordinates;
use super::path::LinkagePath;
use super::statics::Effort;
use super::{Linkage, Workspace};
use crate::case::Case;
use crate::error::SolveError;
use crate::solution::{NoStability, Solution, Verdict};
use crate::statics::continuation::{FIRST_LOAD_STEP, SHORT_ITERATION, load_steps};
use crate::statics::lengths;
use crate::statics::path::EquilibriumPath as _;
use crate::statics::path::next_stable::next_stable;
use crate::statics::path::state::State;
use crate::statics::perturbation::{self, Perturbation, Perturbed};

/// An equilibrium and the verdict on it.
pub(super) type Judged = (Effort, Result<Verdict, NoStability>);

const fn is_unstable(verdict: &Result<Verdict, NoStability>) -> bool {
    matches!(verdict, Ok(Verdict { is_stable: false, .. }))
}

impl Linkage {
    /// The equilibrium under a checked case without obstacles, and the verdict on it; it is left in the workspace. Where it is
    /// not stable it is the stable one to which the load path branches off, if there is any and the start was not unstable.
    pub(super) fn find_stable(
        &self,
        case: &Case,
        start: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> Result<Judged, SolveError> {
        let mut effort = self.find(case, start, workspace)?;
        let verdict = self.stability(case, workspace);
        // Without load sections that buckle under their own cables stay as they are, as spans of the rod do.
        let is_final = case.loads.is_none()
            || self.friction.is_some()
            || start.is_some_and(|s| s.diagnostics.is_unstable());
        if is_final || !is_unstable(&verdict) {
            return Ok((effort, verdict));
        }
        let (q, tensions) = (workspace.scratch.chain.q.clone(), workspace.tensions.clone());
        if let Some(stable) = self.beyond_critical_load(case, &mut effort, workspace) {
            return Ok(stable);
        }
        if let Some(stable) = self.perturbed(case, effort, workspace) {
            return Ok(stable);
        }
        let Workspace { scratch, loads, tensions: own, meter, .. } = workspace;
        (scratch.chain.q, *own) = (q, tensions);
        scratch.chain.evaluate(&self.task(loads, own, meter));
        Ok((effort, verdict))
    }

    /// The next stable equilibrium on the load path or off it. The load at which stability is lost is noted in any case.
    fn beyond_critical_load(
        &self,
        case: &Case,
        effort: &mut Effort,
        workspace: &mut Workspace,
    ) -> Option<Judged> {
        workspace.tensions.fill(0.0);
        self.converge(0.0, false, workspace).ok()?;
        let mut path = LinkagePath::new(self, case, workspace);
        let from = path.state();
        let beyond = next_stable(&mut path, &from, false, effort.iterations);
        effort.iterations = beyond.iterations;
        effort.lost_at = beyond.lost_at.or(effort.lost_at);
        path.set_state(State { load: 1.0, ..beyond.stable? });
        let solved = path.newton(None, 0.0)?;
        effort.iterations += solved.iterations;
        let found = Effort { residual: solved.residual, ..*effort };
        let verdict = self.stability(case, workspace);
        (!is_unstable(&verdict)).then_some((found, verdict))
    }

    /// A stable equilibrium off the path, by dead moments on the disks.
    fn perturbed(
        &self,
        case: &Case,
        Effort { iterations, lost_at, .. }: Effort,
        workspace: &mut Workspace,
    ) -> Option<Judged> {
        let loads = workspace.loads.clone();
        let mut chain = PerturbedChain { model: self, case, loads: &loads, workspace, kept: None };
        let stable = perturbation::stable_equilibrium(&mut chain);
        workspace.loads.clone_from(&loads);
        let lengths::Effort { iterations: taken, residual } = stable?;
        let verdict = self.stability(case, workspace);
        let found = Effort { iterations: iterations + taken, residual, lost_at };
        (!is_unstable(&verdict)).then_some((found, verdict))
    }
}

/// A chain that dead moments lead off its path.
struct PerturbedChain<'a> {
    model: &'a Linkage,
    case: &'a Case,
    /// Those of the case.
    loads: &'a AppliedLoads,
    workspace: &'a mut Workspace,
    kept: Option<State<Coordinates>>,
}

impl PerturbedChain<'_> {
    fn path(&mut self) -> LinkagePath<'_> {
        LinkagePath::new(self.model, self.case, self.workspace)
    }

    /// Raises the load from the robot without load, from one stable equilibrium to the next.
    fn raise_load(&mut self) -> Option<lengths::Effort> {
        self.workspace.tensions.fill(0.0);
        self.model.converge(0.0, false, self.workspace).ok()?;
        let mut path = self.path();
        let mut here = path.state();
        let mut effort = lengths::Effort::default();
        let raised = continuation(&load_steps(FIRST_LOAD_STEP), |load| {
            path.set_state(State { load, ..here.clone() });
            let solved = path.newton(None, 0.0);
            if let Some(Solved { iterations, residual }) = solved {
                effort = lengths::Effort { iterations: effort.iterations + iterations, residual };
                if path.unstable_directions() == Some(0) {
                    here = path.state();
                    return Ok(iterations <= SHORT_ITERATION);
                }
            }
            Err(Missed { reason: (), is_last: path.has_ended() })
        });
        raised.is_ok().then_some(effort)
    }
}

impl Perturbed for PerturbedChain<'_> {
    fn perturb(&mut self, by: Perturbation) {
        let sections = &self.model.sections;
        let unit = self.model.bending_scale();
        let loads = &mut self.workspace.loads;
        loads.clone_from(self.loads);
        for (k, dead) in loads.dead.iter_mut().skip(1).enumerate() {
            dead.moment += by.moment(k, sections.len(), unit);
        }
    }

    fn raise(&mut self) -> Option<lengths::Effort> {
        self.raise_load().or_else(|| {
            self.workspace.tensions.fill(0.0);
            let effort = self.model.converge(1.0, false, self.workspace).ok()?;
            let Effort { iterations, residual, .. } = effort;
            Some(lengths::Effort { iterations, residual })
        })
    }

    fn converge(&mut self) -> Option<lengths::Effort> {
        let mut path = self.path();
        let here = path.state();
        path.set_state(State { load: 1.0, ..here });
        let Solved { iterations, residual } = path.newton(None, 0.0)?;
        Some(lengths::Effort { iterations, residual })
    }

    fn keep(&mut self) {
        self.kept = Some(self.path().state());
    }

    fn restore(&mut self) {
        if let Some(kept) = self.kept.clone() {
            self.path().set_state(kept);
        }
    }

    fn has_ended(&self) -> bool {
        self.workspace.meter.has_ended()
    }

    fn is_stable(&mut self) -> bool {
        !is_unstable(&self.model.stability(self.case, self.workspace))
    }
}
