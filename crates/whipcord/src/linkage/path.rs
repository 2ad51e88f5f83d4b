//! The chain of sections as an equilibrium path, and its branches.

use whipcord_numerics::{Pose, Solved, Vec3};

use super::motion::{self, Coordinates, MOST};
use super::statics::{Effort, Scratch};
use super::task::{DeadMoments, Right, Task};
use super::{Linkage, Workspace};
use crate::budget::Budget;
use crate::case::Case;
use crate::error::SolveError;
use crate::refusal;
use crate::solution::Diagnostics;
use crate::statics::command::Command;
use crate::statics::outcome::Failure;
use crate::statics::path::branches::{BranchOptions, Branches, follow};
use crate::statics::path::newton::converge;
use crate::statics::path::state::{self, Part, PartChange};
use crate::statics::path::{EquilibriumPath, Step, pattern};
use crate::statics::scales::Scales;
use crate::statics::shared_unknowns::{Cables, SharedUnknowns};

type State = state::State<Coordinates>;
type Direction = state::Direction<Coordinates>;

/// A buckled robot with a round backbone is neutral about its axis: so much of the sections' own stiffness keeps the linear
/// system from being singular there.
const REGULARISATION: f64 = 1e-9;

/// The chain under the loads of a case.
pub(super) struct LinkagePath<'a> {
    model: &'a Linkage,
    workspace: &'a mut Workspace,
    commands: Vec<Command>,
    has_followers: bool,
    load: f64,
    shared: SharedUnknowns,
}

impl Part for Coordinates {
    type Change = Self;

    fn stepped(&self, fraction: f64, change: &Self) -> Self {
        self.plus(fraction, *change)
    }
}

impl PartChange for Coordinates {
    fn plus(self, f: f64, other: Self) -> Self {
        core::array::from_fn(|a| self[a] + f * other[a])
    }

    fn product(&self, other: &Self, _: &Scales) -> f64 {
        self.iter().zip(other).map(|(a, b)| a * b).sum()
    }
}

impl<'a> LinkagePath<'a> {
    /// Of a case that was accepted.
    pub fn new(model: &'a Linkage, case: &Case, workspace: &'a mut Workspace) -> Self {
        let commands = workspace.commands.clone();
        let has_followers = case.loads.has_follower();
        let shared = SharedUnknowns::default();
        Self { model, workspace, commands, has_followers, load: 0.0, shared }
    }

    /// Asks the chain at the state.
    fn ask<T>(&mut self, load: f64, ask: impl FnOnce(&mut Scratch, &Task<'_>) -> T) -> T {
        let Workspace { scratch, loads, tensions, meter, .. } = &mut *self.workspace;
        ask(scratch, &Task { load, ..self.model.task(loads, tensions, meter) })
    }

    /// What is left of equilibrium and lengths at the state; infinite where a section is folded.
    fn residual(&mut self) -> f64 {
        let left = self.ask(self.load, |scratch, task| scratch.chain.evaluate(task));
        let units = self.scales().of_cables();
        let Workspace { scratch, tensions, .. } = &*self.workspace;
        let lengths = &scratch.chain.lengths;
        let of_cable = |(i, command): (usize, &Command)| {
            command.complementarity_residual(i, tensions, lengths, units)
        };
        let worst = |worst: f64, x: f64| if x.is_nan() { f64::INFINITY } else { worst.max(x) };
        self.commands.iter().enumerate().map(of_cable).fold(left, worst)
    }

    /// Newton's method from the state.
    pub fn newton(&mut self, across: Option<&Direction>, residual: f64) -> Option<Solved> {
        let tolerance = self.model.options.residual.max(residual);
        converge(self, across, tolerance, |path| Some(path.residual()).filter(|r| r.is_finite()))
    }
}

impl EquilibriumPath for LinkagePath<'_> {
    type Part = Coordinates;

    fn commands(&self) -> &[Command] {
        &self.commands
    }

    fn set_commands(&mut self, commands: &[Command]) {
        self.commands.clear();
        self.commands.extend_from_slice(commands);
    }

    fn has_ended(&self) -> bool {
        self.workspace.meter.has_ended()
    }

    /// Coordinates are those of a section: its curvature counts, times the length of the robot, averaged along it.
    fn weight(&self, k: usize) -> f64 {
        self.model.robot.backbone().length / self.model.sections[k].length
    }

    fn scales(&self) -> Scales {
        let length = self.model.robot.backbone().length;
        let moment = self.model.bending_scale();
        Scales { moment, force: moment / length, length }
    }

    fn state(&self) -> State {
        let Workspace { scratch, tensions, .. } = &*self.workspace;
        State { nodes: scratch.chain.q.clone(), tensions: tensions.clone(), load: self.load }
    }

    fn set_state(&mut self, state: State) {
        self.workspace.scratch.chain.q = state.nodes;
        self.workspace.tensions = state.tensions;
        self.load = state.load;
    }

    fn converge(&mut self, across: Option<&Direction>, residual: f64) -> Option<usize> {
        self.newton(across, residual).map(|solved| solved.iterations)
    }

    fn direction(&mut self, step: Step<'_, Coordinates>) -> Option<Direction> {
        let scales = self.scales();
        let residuals = |scratch: &mut Scratch, task: &Task<'_>| {
            scratch.chain.evaluate(task);
            scratch.chain.residuals()
        };
        // The residual is linear in the load.
        let beyond = self.ask(self.load + 1.0, residuals);
        let here = self.ask(self.load, residuals);
        let by_load: Vec<Coordinates> =
            here.iter().zip(&beyond).map(|(here, beyond)| here.plus(-1.0, *beyond)).collect();
        let closing: Vec<Coordinates> = match step {
            Step::Close | Step::Across(_) => {
                here.iter().map(|r| Coordinates::default().plus(-1.0, *r)).collect()
            }
            Step::Along(_) => vec![Coordinates::default(); here.len()],
            Step::Probe => (0..here.len())
                .map(|k| {
                    let Vec3 { x, y, z } = scales.moment * pattern(k);
                    core::array::from_fn(|a| [z, x, y, x, y, x, y][a])
                })
                .collect(),
        };
        let mut shared = core::mem::take(&mut self.shared);
        shared.find(&self.commands);
        let load = step.frees_load().then_some(Right::Given(&by_load));
        let tensions = shared.cables.iter().map(|&cable| Right::Tension(cable));
        let rights: Vec<Right<'_>> =
            load.into_iter().chain(tensions).chain([Right::Given(&closing)]).collect();
        let columns = self.ask(self.load, |scratch, task| {
            scratch.chain.linearise(task);
            scratch
                .chain
                .eliminate_with(task, -REGULARISATION, rights.len(), |side| rights[side])?;
            let sides = 0..rights.len();
            let column = |side: usize| (0..here.len()).map(move |k| (side, k));
            shared.lengths.clear();
            let by: Vec<Vec<f64>> =
                sides.clone().map(|side| scratch.chain.lengths_by(task, side)).collect();
            for &cable in &shared.cables {
                shared.lengths.extend(by.iter().map(|lengths| lengths[cable]));
            }
            let chain = &scratch.chain;
            let response = |(side, k)| {
                let mut change = [0.0; MOST];
                let response = chain.response(task, side, k);
                change[..response.len()].copy_from_slice(response);
                change
            };
            Some(sides.map(|side| column(side).map(response).collect()).collect::<Vec<Vec<_>>>())
        });
        let columns = columns?;
        if let Step::Across(direction) | Step::Along(direction) = step {
            shared.along.clear();
            let cables = shared.cables.iter().map(|&i| direction.tensions[i]);
            let own = [direction.load]
                .into_iter()
                .chain(cables.map(|t| t / (scales.force * scales.force)))
                .chain([0.0]);
            shared.along.extend(columns.iter().zip(own).map(|(column, own)| {
                let nodes = direction.nodes.iter().zip(column).enumerate();
                own + nodes.map(|(k, (a, b))| self.weight(k) * a.product(b, &scales)).sum::<f64>()
            }));
        }
        let Workspace { scratch, tensions, .. } = &*self.workspace;
        let (commands, lengths) = (&self.commands, &scratch.chain.lengths);
        let solved = shared.solve(step, &Cables { commands, tensions, lengths }, &scales);
        let mut nodes = columns.last()?.clone();
        for (column, &theta) in columns.iter().zip(&shared.theta) {
            for (node, change) in nodes.iter_mut().zip(column) {
                *node = node.plus(theta, *change);
            }
        }
        let changes = (0..tensions.len()).map(|cable| shared.change_of(cable)).collect();
        let load = if step.frees_load() { shared.theta[0] } else { 0.0 };
        self.shared = shared;
        let finite = nodes.iter().flatten().all(|x| x.is_finite()) && load.is_finite();
        (solved && finite).then_some(Direction { nodes, tensions: changes, load })
    }

    fn unstable_directions(&mut self) -> Option<usize> {
        let Workspace { scratch, loads, tensions, meter, held, hold, .. } = &mut *self.workspace;
        let task = Task { load: self.load, ..self.model.task(loads, tensions, meter) };
        if self.has_followers {
            self.model.hold(scratch, &task, &self.commands, (hold, held))?;
            return Some(scratch.eigenvalues_below(&task, held, 0.0)? % 2);
        }
        let task = Task { moments: DeadMoments::Symmetric { more: 0.0 }, ..task };
        self.model.hold(scratch, &task, &self.commands, (hold, held))?;
        scratch.eigenvalues_below(&task, held, -Diagnostics::NEUTRAL)
    }

    fn lengths(&mut self) -> Option<&[f64]> {
        self.ask(self.load, |scratch, task| scratch.chain.evaluate(task))
            .is_finite()
            .then_some(())?;
        Some(&self.workspace.scratch.chain.lengths)
    }

    fn tip(&mut self) -> Vec3 {
        let Linkage { sections, division, .. } = self.model;
        let ends = sections.iter().zip(&self.workspace.scratch.chain.q);
        let ends = ends.map(|(section, q)| motion::pose_at(division, section.length, q, 1.0));
        ends.fold(Pose::IDENTITY, |disk, end| disk * end).position
    }
}

impl Linkage {
    /// All equilibria under the load of a case that lie on the path from no load, past its limit
    /// points, and on the branches off it. Cables keep their commands on the way.
    ///
    /// # Errors
    /// As [`Self::solve`] where there is no shape without load to start from; [`SolveError::Unsupported`] among obstacles.
    pub fn branches(
        &self,
        case: &Case,
        options: &BranchOptions,
        workspace: &mut Workspace,
    ) -> Result<Branches, SolveError> {
        refusal::branches_among_obstacles(self.kind, case)?;
        refusal::friction_with_branches(self.kind, &self.robot)?;
        refusal::bending_friction_with_branches(self.kind, &self.robot)?;
        let found = self.follow_branches(case, options, workspace);
        self.options.cancel.checked(found)
    }

    fn follow_branches(
        &self,
        case: &Case,
        options: &BranchOptions,
        workspace: &mut Workspace,
    ) -> Result<Branches, SolveError> {
        // What has no shape without load, or folds, is told with its reason.
        let answer = match self.solve(case, None, workspace) {
            Err(SolveError::NotConverged { .. }) => None,
            other => Some(other?),
        };
        if case.loads.is_none() {
            return Ok(Branches::only(answer));
        }
        self.accept(case, workspace)?;
        // The options say how far to go.
        workspace.meter.start(&self.options.cancel, Budget::UNLIMITED);
        workspace.tensions.clear();
        workspace.tensions.resize(workspace.commands.len(), 0.0);
        let start = self.converge(0.0, false, workspace);
        start.map_err(|failure| self.explain(failure, &workspace.commands))?;
        let mut unloaded = LinkagePath::new(self, case, workspace);
        let from = unloaded.state();
        let followed = follow(&mut unloaded, from, case.base, options);
        followed.solutions(answer, case.loads.has_follower(), |state| {
            let mut at_load = LinkagePath::new(self, case, workspace);
            at_load.set_state(State { load: 1.0, ..state });
            let Some(Solved { iterations, residual }) = at_load.newton(None, 0.0) else {
                let advice = "an equilibrium on a branch was lost: give a greater residual";
                let (iterations, residual, last_load) = (0, 1.0, 1.0);
                let lost = Failure::NotConverged { iterations, residual, last_load, advice };
                return Err(self.explain(lost, &workspace.commands));
            };
            let effort = Effort { iterations, residual, lost_at: None };
            let verdict = self.stability(case, workspace);
            Ok(self.solution(case, effort, verdict, workspace))
        })
    }
}
