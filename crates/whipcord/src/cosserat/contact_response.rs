//! The equilibrium of the rod under contact forces, and its response to them.
//!
//! Under the wrenches of its contacts alone a robot may buckle though the contacts hold it, so an equilibrium
//! under given wrenches cannot be asked for. The chain of [`super::chain`] instead takes one step of Newton's
//! method at a time, in which [`crate::contact`] changes the wrenches along with the shape.

use std::sync::Arc;

use whipcord_numerics::{Pose, Vec3};

use super::chain::{Chain, Task};
use super::contact_grid::{ContactGrid, carried, near};
use super::friction::{Friction, ResponseScratch};
use super::loaded::Trajectory;
use super::prepared::{Cosserat, Workspace};
use super::scratch::Scratch;
use super::stability::Equilibrium;
use super::state::{Direction, State};
use super::target::Target;
use super::unloaded::SweepOptions;
use crate::budget::{Budget, Meter};
use crate::case::Case;
use crate::contact::{
    ContactRod, DenseOutput, Linearised, NotedEnd, Refinement, RodHoles, RodResponse,
};
use crate::derivatives::{Derivatives, Motion, StepGap};
use crate::error::SolveError;
use crate::parameter::Parameter;
use crate::robot::Robot;
use crate::section::{Fault, step_tolerance};
use crate::shape::Wrench;
use crate::solution::Solution;
use crate::statics::command::Command;
use crate::statics::elimination::Change;
use crate::statics::friction::{CondensedHoles, History, Standing};
use crate::statics::grid::Grid;
use crate::statics::loads::AppliedLoads;
use crate::statics::options::{Accuracy, Options};
use crate::statics::outcome::Failure;
use crate::statics::outcome::Found;
use crate::statics::plastic_curvature::PlasticCurvature;
use crate::statics::plastic_steps::PlasticRod as _;
use crate::statics::refinement::Coarse;
use crate::statics::runge_kutta::{SAMPLED_STAGES, STAGES};
use crate::statics::scales::Scales;

/// No cross-section turns by more in one step, in rad.
const LONGEST: f64 = 0.5;

/// The rod where it stands, and its equations there.
#[derive(Clone, Debug, Default)]
pub(crate) struct ContactResponse {
    pub(super) contact_grid: Option<Arc<ContactGrid>>,
    pub(super) chain: Chain,
    pub(super) trajectory: Trajectory,
    pub(super) workspace: Workspace,
    /// Its frames.
    pub(super) shape: DenseOutput,
    /// What is left of its equations.
    pub(super) gap: f64,
    pub(super) linear: Linearised,
    pub(super) refinement: Refinement,
    /// Where cables rub.
    pub(super) holes: CondensedHoles,
    pub(super) response: ResponseScratch,
    /// What friction against bending holds from the steps of actuation before.
    plastic: Option<PlasticCurvature>,
}

/// What it is to be kept for, to go back to.
#[derive(Clone, Debug, Default)]
pub(crate) struct Kept {
    pub(super) contact_grid: Option<Arc<ContactGrid>>,
    pub(super) state: State,
    pub(super) trajectory: Trajectory,
    pub(super) shape: DenseOutput,
    pub(super) holes: CondensedHoles,
}

impl ContactResponse {
    /// The state of the holes on a grid, after that on another where there was one.
    fn regrid_holes(&mut self, contact_grid: &ContactGrid, before: Option<&ContactGrid>) {
        let Some(Friction { nodes, holes }) = &contact_grid.friction else { return };
        let Some((before, old)) = before.and_then(|at| Some((at, at.friction.as_ref()?))) else {
            self.holes.reset(holes);
            return;
        };
        let (grid, from) = (&contact_grid.grid, (&old.nodes, &before.grid));
        let tensions = nodes.carried_steps(grid, from, self.holes.tensions());
        let History { beyond, slip_states, .. } = self.holes.history();
        let changed = beyond.iter().zip(&old.holes.at_rest).map(|(now, rest)| now - rest);
        let changed = nodes.carried_starts(grid, from, &changed.collect::<Vec<f64>>());
        let beyond = changed.iter().zip(&holes.at_rest).map(|(by, rest)| rest + by).collect();
        let slip_states = nodes.carried_steps(grid, from, slip_states);
        self.holes.carry(tensions, beyond, slip_states);
    }

    /// Eliminates the tensions of cables that rub where that is not done; `false` where they are singular.
    fn eliminate(&mut self) -> bool {
        let Self { linear, holes: state, workspace, contact_grid, .. } = self;
        let friction = contact_grid.as_ref().and_then(|at| at.friction.as_ref());
        let (Some(linear), Some(Friction { holes, .. })) = (&mut linear.here, friction) else {
            return true;
        };
        let at = RodHoles { state, holes, commands: &workspace.commands };
        linear.is_eliminated || linear.eliminate(&[], at).is_some()
    }

    /// Lengths and angles of the passages of cables that rub where it has shot, and what the equations of the holes leave.
    fn measure_holes(&mut self, contact_grid: &ContactGrid) -> f64 {
        let Some(Friction { nodes, holes }) = &contact_grid.friction else { return 0.0 };
        let at = self.holes.at_mut();
        self.response.measure(&contact_grid.grid, nodes, &self.trajectory, at);
        self.holes.assess(holes, &self.workspace.commands)
    }

    /// How much the answer to a case would change in m if each of its steps were halved, estimated from one shot in such steps
    /// from the base: where that ends elsewhere, and what the rod gives way by under the wrench that it leaves at the tip.
    fn change_on_halved_steps(&self, contact_grid: &ContactGrid, case: &Case) -> Option<f64> {
        let ContactGrid { model, grid, steps, halvings, .. } = contact_grid;
        let mut fine = Grid::refined(&model.robot, &model.layout, *steps, halvings + 1).ok()?;
        if let Some(plastic) = &self.plastic {
            fine.set_plastic(plastic);
        }
        let mut loads = AppliedLoads::default();
        loads.gather(&fine, &case.loads, case.base.rotation);
        let base = self.chain.state.nodes.first()?;
        let target = Target {
            tensions: &self.chain.state.tensions,
            per_node: 0,
            base_moment: base.moment,
            follower_force: base.force,
            load: 1.0,
            sample: false,
            step_tolerance: step_tolerance(0.0),
        };
        let mut shot = Trajectory { steps_left: usize::MAX, ..Trajectory::default() };
        shot.shoot(&fine, &loads, &target).ok()?;
        shot.measure(&fine);
        let mut coarse = Coarse::default();
        coarse.keep(grid, &self.shape.poses, &self.trajectory.lengths);
        let length = model.robot.backbone().length;
        let scales = Scales::of(grid, length);
        let Wrench { force, moment } = shot.excess;
        let gives_way = moment.norm() / scales.moment + force.norm() / scales.force;
        Some(coarse.change(&fine, &shot.poses, &shot.lengths) + length * gives_way)
    }

    /// Which cables are taut, in the order of the grid.
    pub(super) fn taut(&self, contact_grid: &ContactGrid) -> Vec<bool> {
        let tensions = &self.chain.state.tensions;
        let length = contact_grid.model.robot.backbone().length;
        let units = Scales::of(&contact_grid.grid, length).of_cables();
        let is_taut = |(i, command): (usize, &Command)| match command.is_length() {
            true => command.is_active(i, tensions, &self.trajectory.lengths, units),
            false => tensions[i] > 0.0,
        };
        self.workspace.commands.iter().enumerate().map(is_taut).collect()
    }
}

impl ContactResponse {
    /// Newton's step where it stands while the wrenches stay as they are.
    fn closing(&self, derivatives: &Derivatives, taut: &[bool]) -> Motion {
        let tensions = &self.chain.state.tensions;
        let gaps: Vec<StepGap> = self.chain.gaps().collect();
        let commands = self.workspace.commands.iter().enumerate();
        let slackness: Vec<f64> = commands
            .map(|(i, command)| command.slackness(tensions[i], self.trajectory.lengths[i]))
            .collect();
        derivatives.closing(&gaps, &[], tensions, taut, &slackness)
    }
}

impl ContactRod for ContactResponse {
    type Kept = Kept;

    const WORK_OF_STEP: f64 = 1.0;

    fn refinement(&mut self) -> &mut Refinement {
        &mut self.refinement
    }

    fn reset(&mut self) {
        self.contact_grid = None;
        self.linear.forget();
    }

    fn set_plastic(&mut self, left: &PlasticCurvature) {
        self.linear.forget();
        if let Some(contact_grid) = &mut self.contact_grid {
            Arc::make_mut(contact_grid).set_plastic(left);
        }
        self.plastic = Some(left.clone());
    }

    fn plastic_left(&self, robot: &Robot, case: &Case) -> Result<PlasticCurvature, SolveError> {
        self.plastic_left_there(robot, case)
    }

    /// Looks at a case in which wrenches on the places `pushes` are among the loads. Where it is, its steps do
    /// not meet; it stays there. It starts from `warm`, or the robot without any load or tension.
    fn look(
        &mut self,
        robot: &Robot,
        options: &Options,
        case: &Case,
        (stations, pushes): (&[f64], &[f64]),
        warm: Option<&Solution>,
    ) -> Result<(), SolveError> {
        self.linear.look();
        let Refinement { steps: least, halvings, .. } = self.refinement;
        let stands = |contact_grid: &ContactGrid| {
            contact_grid.halvings == halvings
                && contact_grid.pushes == pushes
                && contact_grid.stations == stations
        };
        let before = match self.contact_grid.take() {
            Some(contact_grid) if stands(&contact_grid) => {
                self.contact_grid = Some(contact_grid);
                None
            }
            before => {
                self.contact_grid = Some(Arc::new(ContactGrid::new(
                    robot,
                    options,
                    case,
                    (least, halvings),
                    (stations, pushes),
                    self.plastic.as_ref(),
                )?));
                Some(before)
            }
        };
        if before.is_some() || warm.is_some() {
            self.linear.forget();
        }
        let Some(contact_grid) = self.contact_grid.clone() else { return Ok(()) };
        let contact_grid = &*contact_grid;
        let rubs = contact_grid.friction.is_some();
        if let Some(before) = &before {
            self.regrid_holes(contact_grid, before.as_deref());
        }
        contact_grid.model.accept(case, &mut self.workspace)?;
        self.workspace.meter.start(&options.cancel, Budget::UNLIMITED);
        let Workspace { scratch, commands, meter, .. } = &mut self.workspace;
        let grid = &contact_grid.grid;
        scratch.applied.gather(grid, &case.loads, case.base.rotation);
        let fault = |tensions: &[f64], fault: Fault| {
            contact_grid.model.explain(Failure::of_section(fault, tensions, 1.0), commands)
        };
        // Nodes that it had no state at.
        let mut is_new: Vec<bool> = Vec::new();
        match before {
            None => {}
            Some(Some(before)) => {
                let (arcs, ends) = (before.grid.ends(), contact_grid.grid.ends());
                self.chain.state = carried(&self.chain.state, &arcs, &ends);
                let is_known = |s: &f64| arcs.binary_search_by(|at| at.total_cmp(s)).is_ok();
                is_new.extend(ends.iter().map(|s| !is_known(s)));
                let behind = |k: usize| {
                    let middle = grid.steps[k].start + 0.5 * grid.steps[k].length;
                    arcs.partition_point(|&s| s <= middle).clamp(1, before.grid.len()) - 1
                };
                self.trajectory.regrid((0..grid.len()).map(behind));
            }
            Some(None) => {
                let rest = vec![0.0; commands.len()];
                let unloaded = &mut scratch.unloaded;
                unloaded.sweep(grid, &rest, SweepOptions::EXACT).map_err(|f| fault(&rest, f))?;
                unloaded.integrate(grid, &mut self.shape.poses);
                let poses = &self.shape.poses;
                self.chain.state = State { load: 1.0, ..State::unloaded(poses, &rest) };
                self.trajectory.seed(grid, &unloaded.strains);
            }
        }
        self.trajectory.steps_left = usize::MAX;
        if let Some(answer) = warm.filter(|_| !rubs) {
            match near(answer, contact_grid, &scratch.applied, &mut self.trajectory) {
                Some(state) => {
                    self.chain.state = state;
                    is_new.clear();
                }
                // A shot that fails leaves no strains to start the sections from.
                None => self.trajectory.seed(grid, &scratch.unloaded.strains),
            }
        }
        let task = Task {
            grid,
            loads: &scratch.applied,
            commands: if rubs { &[] } else { commands },
            length: robot.backbone().length,
            tolerance: options.greatest_residual(),
            meter,
        };
        for (tension, command) in self.chain.state.tensions.iter_mut().zip(&*commands) {
            if let Command::Tension(given) = command {
                *tension = *given;
            }
        }
        if let Some(Friction { nodes, .. }) = &contact_grid.friction {
            self.chain.state.tensions.clone_from_slice(self.holes.at_base());
            let (tensions, varying) = (self.holes.tensions(), &mut self.chain.varying);
            nodes.expand(grid, tensions, &contact_grid.profile, varying);
        }
        let is_free = |node: usize| is_new.get(node).is_some_and(|is_new| *is_new);
        let in_lanes = match is_new.contains(&true) || rubs {
            true => None,
            false => self.chain.shoot_in_lanes(&task, &mut self.trajectory),
        };
        let looked = match in_lanes {
            Some(gap) => Ok(gap),
            None => self.chain.shoot_through(&task, &mut self.trajectory, rubs, is_free),
        };
        self.gap = looked.map_err(|f| fault(&self.chain.state.tensions, f))?;
        self.trajectory.measure(grid);
        if rubs {
            self.gap = self.gap.max(self.measure_holes(contact_grid));
        }
        self.shape.ends = grid.ends();
        self.chain.poses(&mut self.shape.poses);
        self.shape.strains.clear();
        let strains = self.trajectory.strains().chunks_exact(STAGES);
        self.shape.strains.extend(strains.map(|of_step| SAMPLED_STAGES.map(|i| of_step[i])));
        Ok(())
    }

    /// How many steps it has from base to tip.
    fn gap(&self) -> f64 {
        self.gap
    }

    fn pose_before(kept: &Kept, arc_length: f64) -> Pose {
        kept.shape.pose(arc_length)
    }

    fn solve_free(
        &self,
        robot: &Robot,
        options: &Options,
        (case, near): (&Case, Option<&Solution>),
        meter: &Meter,
    ) -> Result<Solution, SolveError> {
        let options = Options { budget: meter.left(), ..options.clone() };
        let mut model = Cosserat::new(robot, &case.loads, &options)?;
        if let Some(left) = &self.plastic {
            model.set_plastic(left.clone());
        }
        let mut workspace = Workspace::default();
        let solved = model.solve_step(case, near, &mut workspace);
        meter.charge(&workspace.meter);
        solved
    }

    fn steps(&self) -> usize {
        self.contact_grid.as_ref().map_or(0, |contact_grid| contact_grid.grid.len())
    }

    fn shape(&self) -> &DenseOutput {
        &self.shape
    }

    /// Linearises the equations where it stands.
    fn linearise(&mut self, robot: &Robot, case: &Case) -> Result<(), SolveError> {
        if self.linear.here.is_some() {
            return Ok(());
        }
        let Some(contact_grid) = self.contact_grid.clone() else { return Ok(()) };
        let contact_grid = &*contact_grid;
        let taut = self.taut(contact_grid);
        let mut linear = core::mem::take(&mut self.linear);
        let reused = linear.take_reusable(&taut, |of| self.closing(of, &taut));
        self.linear = linear;
        if reused.is_some() {
            self.linear.here = reused;
            return Ok(());
        }
        let derivatives = self.derivatives(contact_grid, (robot, case, &[]), &taut, &[], None)?;
        if contact_grid.friction.is_some() {
            let gaps: Vec<StepGap> = self.chain.gaps().collect();
            let closing = derivatives.open_closing(&gaps, &[]);
            self.linear.here = Some(RodResponse::rubbing(derivatives, closing));
            return Ok(());
        }
        let closing = self.closing(&derivatives, &taut);
        self.linear.here = Some(RodResponse::new(derivatives, taut, closing));
        Ok(())
    }

    fn node(&self, arc_length: f64) -> usize {
        self.contact_grid.as_ref().map_or(0, |contact_grid| contact_grid.node(arc_length))
    }

    fn differentiate(
        &self,
        robot: &Robot,
        case: &Case,
        history: &[PlasticCurvature],
        parameters: &[Parameter],
    ) -> Result<Derivatives, SolveError> {
        let contact_grid = self.contact_grid.as_ref().ok_or(SolveError::NoDerivatives)?;
        let taut = self.taut(contact_grid);
        self.derivatives(contact_grid, (robot, case, history), &taut, parameters, None)
    }

    fn grid(&self) -> Option<&Grid> {
        self.contact_grid.as_ref().map(|contact_grid| &contact_grid.grid)
    }

    fn standing(&self) -> Option<Standing> {
        let commands = &self.workspace.commands;
        match &self.contact_grid.as_ref()?.friction {
            Some(Friction { holes, .. }) => self.holes.standing(holes, commands),
            None => Some(Standing::of_whole_cables(commands, &self.chain.state.tensions)),
        }
    }

    fn here(&self) -> Kept {
        Kept {
            contact_grid: self.contact_grid.clone(),
            state: self.chain.state.clone(),
            trajectory: self.trajectory.clone(),
            shape: self.shape.clone(),
            holes: self.holes.clone(),
        }
    }

    fn differentiate_noted(
        &mut self,
        robot: &Robot,
        end: &NotedEnd<'_, Kept>,
        parameters: &[Parameter],
    ) -> Result<Derivatives, SolveError> {
        self.differentiate_there(robot, end, parameters)
    }

    /// How the places of pushes move with each component of each of them, by rows, and how with the step that is
    /// left, linearised.
    fn compliance(
        &mut self,
        places: impl Iterator<Item = f64>,
        compliance: &mut Vec<f64>,
        drift: &mut Vec<f64>,
    ) {
        compliance.clear();
        drift.clear();
        let (Some(contact_grid), Some(linear)) = (&self.contact_grid, &mut self.linear.here) else {
            return;
        };
        let nodes: Vec<usize> = places.map(|at| contact_grid.node(at)).collect();
        if let Some(Friction { holes, .. }) = &contact_grid.friction {
            let (state, commands) = (&mut self.holes, &self.workspace.commands[..]);
            if linear.eliminate(&nodes, RodHoles { state, holes, commands }).is_none() {
                // Nothing finite comes of it.
                return drift.push(f64::NAN);
            }
        }
        linear.compliance(&nodes, compliance, drift);
    }

    fn advance(&mut self, changes: &[[f64; 6]], part: f64) -> f64 {
        if !self.eliminate() {
            return 0.0;
        }
        let (Some(contact_grid), Some(linear)) = (&self.contact_grid, &self.linear.here) else {
            return part;
        };
        let mut motion = match &contact_grid.friction {
            None => linear.step(changes),
            Some(Friction { holes, .. }) => {
                let (state, commands) = (&mut self.holes, &self.workspace.commands[..]);
                linear.step_rubbing(changes, RodHoles { state, holes, commands })
            }
        };
        let most = motion.nodes.iter().map(|node| node.turn.norm()).fold(0.0, f64::max);
        let part = if part * most > LONGEST { LONGEST / most } else { part };
        let state = &self.chain.state;
        if contact_grid.friction.is_some() {
            self.holes.advance(&motion.tensions, part);
            motion.tensions = vec![0.0; state.tensions.len()];
        }
        let has_followers = self.workspace.scratch.applied.any_follower_force();
        let nodes = state.nodes.iter().zip(&motion.nodes).enumerate();
        let nodes = nodes.map(|(k, (node, change))| {
            let to_body = node.rotation.conjugate();
            let moment = node.rotation.rotate(node.moment);
            Change {
                turn: to_body.rotate(change.turn),
                // In the frame that turns with the cross-section.
                moment: to_body.rotate(change.moment - change.turn.cross(moment)),
                force: match has_followers {
                    true => change.force - linear.wrench_beyond(k, changes),
                    false => Vec3::ZERO,
                },
            }
        });
        let mut step = Direction { nodes: nodes.collect(), tensions: motion.tensions, load: 0.0 };
        // The base is clamped, and nothing is left to act at the tip.
        if let [first, .., last] = &mut step.nodes[..] {
            first.turn = Vec3::ZERO;
            (last.moment, last.force) = (Vec3::ZERO, Vec3::ZERO);
        }
        let from = state.clone();
        self.chain.state.step_from(&from, part, &step);
        self.linear.step(part * most);
        part
    }

    /// Whether an even number of directions, mostly none, is unstable while the loads stay as they are.
    fn stands(&mut self) -> bool {
        let odd = self.has_history() && self.eliminate() && self.holes.is_odd();
        let Some(contact_grid) = &self.contact_grid else { return true };
        let Workspace { scratch, commands, .. } = &self.workspace;
        let task = Task {
            grid: &contact_grid.grid,
            loads: &scratch.applied,
            commands,
            length: contact_grid.model.robot.backbone().length,
            tolerance: contact_grid.model.options.greatest_residual(),
            meter: &self.workspace.meter,
        };
        if let Some(Friction { nodes, .. }) = &contact_grid.friction {
            let at = (nodes, &contact_grid.profile[..]);
            let task = Task { commands: &[], ..task };
            let samples = &self.trajectory.samples;
            let is_known = self.response.eliminate(&task, at, &mut self.chain, samples);
            return !is_known || self.chain.elimination.is_negative() == odd;
        }
        let negative = self.chain.is_determinant_negative(&task, &mut self.trajectory);
        !negative.unwrap_or(false)
    }

    fn unstable_directions(&mut self) -> Option<usize> {
        let contact_grid = self.contact_grid.clone()?;
        let Workspace { scratch, commands, meter, .. } = &mut self.workspace;
        let Scratch { stability, applied, .. } = scratch;
        if contact_grid.friction.is_some() || applied.any_follower() {
            return None;
        }
        let grid = &contact_grid.grid;
        let task = Task {
            grid,
            loads: applied,
            commands,
            length: contact_grid.model.robot.backbone().length,
            tolerance: contact_grid.model.options.greatest_residual(),
            meter,
        };
        self.chain.shoot(&task, &mut self.trajectory).ok()?;
        let Trajectory { samples, lengths, .. } = &self.trajectory;
        let tensions = &self.chain.state.tensions;
        let at = Equilibrium { grid, samples, commands, tensions, lengths, applied, load: 1.0 };
        Some(stability.unstable_directions(&at))
    }

    fn rubbing_tensions(&self) -> usize {
        if self.has_history() { self.holes.tensions().len() } else { 0 }
    }

    fn has_history(&self) -> bool {
        self.contact_grid.as_ref().is_some_and(|contact_grid| contact_grid.friction.is_some())
    }

    fn keep(&mut self, kept: &mut Kept) {
        if let Some(Friction { holes, .. }) =
            self.contact_grid.as_ref().and_then(|at| at.friction.as_ref())
        {
            self.holes.keep(holes, &self.workspace.commands);
            kept.holes.clone_from(&self.holes);
        }
        kept.contact_grid.clone_from(&self.contact_grid);
        kept.state.clone_from(&self.chain.state);
        kept.trajectory.clone_from(&self.trajectory);
        kept.shape.clone_from(&self.shape);
    }

    fn go_back(&mut self, kept: &Kept) {
        self.linear.forget();
        self.contact_grid.clone_from(&kept.contact_grid);
        if self.has_history() {
            self.holes.clone_from(&kept.holes);
            self.holes.go_back();
        }
        self.chain.state.clone_from(&kept.state);
        self.trajectory.clone_from(&kept.trajectory);
        self.shape.clone_from(&kept.shape);
    }

    /// Halves the steps if the answer is not yet known to the tolerance; `false` if it is, or if the steps
    /// are given.
    fn refine(&mut self, case: &Case, accuracy: Accuracy) -> Result<bool, SolveError> {
        if self.has_history() {
            // What the holes remember belongs to these steps.
            return Ok(false);
        }
        let (Accuracy::Tolerance(tolerance), Some(contact_grid)) = (accuracy, &self.contact_grid)
        else {
            return Ok(false);
        };
        let ContactGrid { grid, pushes, model, .. } = &**contact_grid;
        let tolerance = tolerance * model.robot.backbone().length;
        if self.refinement.accept(self.change_on_halved_steps(contact_grid, case), tolerance) {
            return Ok(false);
        }
        let answer = (grid, &self.shape.poses[..], &self.trajectory.lengths[..]);
        self.refinement.refine(tolerance, answer, pushes)
    }

    /// The answer at stations of the model, where it stands.
    fn solution(&mut self, case: &Case) -> Result<Option<Solution>, SolveError> {
        let Some(contact_grid) = &self.contact_grid else { return Ok(None) };
        let ContactGrid { model, grid, friction, .. } = &**contact_grid;
        let Workspace { scratch, commands, .. } = &mut self.workspace;
        scratch.poses.clone_from(&self.shape.poses);
        scratch.lengths.clone_from(&self.trajectory.lengths);
        scratch.tensions.clone_from(&self.chain.state.tensions);
        let base = self.chain.state.nodes[0];
        scratch.base_wrench =
            Wrench { force: scratch.applied.base_force() + base.force, moment: base.moment };
        let found = Found { iterations: 0, residual: self.gap, lost_at: None };
        if let Some(Friction { holes, .. }) = friction {
            self.holes.keep(holes, commands);
            scratch.tensions.clone_from(&self.holes.history().base);
        }
        let error = self.refinement.error;
        let mut solution = model.solution(grid, case, &mut self.workspace, found, error)?;
        // Its nodes bear the contacts, too.
        solution.internal.clear();
        if let Some(friction) = friction {
            let History { tensions, slip_states, .. } = self.holes.history();
            model.write_friction(grid, friction, (tensions, slip_states), &mut solution);
        }
        Ok(Some(solution))
    }
}
