//! The rod with cables from hole to hole under contact forces: one step of Newton's method on the chain at a time, in
//! which [`crate::contact`] changes the forces along with the shape. Disks stay where they are when the places of contact,
//! at which steps end, come and go.

use std::sync::Arc;

use whipcord_numerics::{Pose, Vec3};

use super::chain::Chain;
use super::contact_mesh::ContactMesh;
use super::layout::Mesh;
use super::loaded_span::Slope;
use super::model::CosseratDisks;
use super::node::Node;
use super::stability_check;
use super::unloaded::From;
use super::workspace::Workspace;
use crate::budget::{Budget, Meter};
use crate::case::Case;
use crate::contact::{ContactRod, DenseOutput, Linearised, NotedEnd, Refinement, RodHoles};
use crate::derivatives::{Derivatives, Motion, NodeChange};
use crate::error::SolveError;
use crate::parameter::Parameter;
use crate::robot::Robot;
use crate::section::Fault;
use crate::shape::Wrench;
use crate::solution::Solution;
use crate::statics::command::Command;
use crate::statics::friction::{CondensedHoles, History, Holes, Passages, Standing};
use crate::statics::grid::Grid;
use crate::statics::options::{Accuracy, Options};
use crate::statics::outcome::{Failure, Found};
use crate::statics::plastic_curvature::PlasticCurvature;
use crate::statics::plastic_steps::PlasticRod as _;
use crate::statics::refinement::Coarse;

/// No disk turns by more in one step, in rad.
const LONGEST: f64 = 0.5;

/// The rod where it stands, and its equations there.
#[derive(Clone, Debug, Default)]
pub(crate) struct ContactResponse {
    pub(super) contact_mesh: Option<Arc<ContactMesh>>,
    pub(super) chain: Chain,
    pub(super) workspace: Workspace,
    /// Its frames.
    pub(super) shape: DenseOutput,
    /// What is left of its equations.
    pub(super) gap: f64,
    pub(super) linear: Linearised,
    pub(super) refinement: Refinement,
    /// Where cables rub.
    pub(super) holes: CondensedHoles,
    /// What friction against bending holds from the steps of actuation before.
    plastic: Option<PlasticCurvature>,
}

/// What it is to be kept for, to go back to.
#[derive(Clone, Debug, Default)]
pub(crate) struct Kept {
    pub(super) contact_mesh: Option<Arc<ContactMesh>>,
    pub(super) nodes: Vec<Node>,
    pub(super) tensions: Vec<f64>,
    pub(super) shape: DenseOutput,
}

impl ContactResponse {
    /// The rod without any load or tension.
    fn start_at_rest(&mut self, contact_mesh: &ContactMesh) -> Result<(), Fault> {
        let (frame, mesh) = (contact_mesh.model.frame(), &contact_mesh.mesh);
        let cables = self.workspace.commands().len();
        let rest = vec![0.0; contact_mesh.groups.len()];
        let mut tensions = cables;
        if let Some(holes) = &contact_mesh.model.holes {
            self.holes.reset(holes);
            tensions = rest.len();
        }
        let unloaded = self.workspace.unloaded_mut();
        unloaded.sweep(frame, mesh, &rest, From::Nothing, false)?;
        self.chain.pull(&contact_mesh.groups, &vec![0.0; tensions]);
        self.chain.start(frame, mesh, &unloaded.wrenches, &unloaded.poses);
        Ok(())
    }

    /// Where an answer stood.
    fn start_near(&mut self, contact_mesh: &ContactMesh, answer: &Solution) {
        let Some(base) = answer.base_wrench else { return };
        let to_base = answer.disks.poses.first().map_or(Pose::IDENTITY, Pose::inverse);
        let disks: Vec<Pose> = answer.disks.poses.iter().map(|pose| to_base * *pose).collect();
        let tensions: Vec<f64> =
            answer.cables.iter().map(|cable| cable.tension.unwrap_or(0.0).max(0.0)).collect();
        self.chain.pull(&contact_mesh.groups, &tensions);
        self.chain.start_from(&contact_mesh.task(&self.workspace), &disks, base);
    }

    /// Frames at the ends of all steps, from disk to disk, and the strains between them.
    fn place(&mut self, mesh: &Mesh) {
        let DenseOutput { ends, poses, strains } = &mut self.shape;
        *ends = mesh.grid.ends();
        poses.clear();
        poses.push(Pose::IDENTITY);
        let mut position = Vec3::ZERO;
        for (node, steps) in self.chain.nodes.iter().zip(&mesh.spans) {
            let disk = Pose { position, rotation: node.rotation };
            poses.extend(self.chain.poses[steps.clone()].iter().map(|pose| disk * *pose));
            position = poses[steps.end].position;
        }
        strains.clear();
        let samples = self.chain.samples.chunks_exact(3);
        strains.extend(samples.map(|of_step| [0, 1, 2].map(|i: usize| of_step[i].strain)));
    }

    /// How much the answer to a case would change in m if each of its steps were halved, estimated from where its spans end in such
    /// steps, and the gaps that they leave.
    fn change_on_halved_steps(&self, contact_mesh: &ContactMesh, case: &Case) -> Option<f64> {
        let ContactMesh { model, mesh, steps, halvings, groups, .. } = contact_mesh;
        let mut finer = model.frame().mesh(*steps, halvings + 1).ok()?;
        if let Some(plastic) = &self.plastic {
            model.frame().set_plastic(&mut finer, plastic);
        }
        let fine = ContactMesh { mesh: finer, ..contact_mesh.clone() };
        let mut other = Self::default();
        other.workspace.meter_mut().start(&model.options().cancel, Budget::UNLIMITED);
        model.accept(case, &fine.mesh, &mut other.workspace).ok()?;
        other.chain.nodes.clone_from(&self.chain.nodes);
        other.chain.pull(groups, &self.chain.tensions);
        let gap = other.chain.measure(&fine.task(&other.workspace)).ok()?;
        other.place(&fine.mesh);
        let mut coarse = Coarse::default();
        coarse.keep(&mesh.grid, &self.shape.poses, &self.chain.lengths);
        let moved = coarse.change(&fine.mesh.grid, &other.shape.poses, &other.chain.lengths);
        let spans = mesh.spans.len() as f64;
        Some(moved + spans * gap * model.robot().backbone().length)
    }

    fn fault(&self, contact_mesh: &ContactMesh, fault: Fault) -> SolveError {
        let failure = Failure::of_section(fault, &self.chain.tensions, 1.0);
        contact_mesh.model.explain(failure, self.workspace.commands())
    }

    pub(super) fn looked(
        &mut self,
        contact_mesh: &ContactMesh,
        is_new: bool,
        warm: Option<&Solution>,
    ) -> Result<(), SolveError> {
        if is_new {
            let started = self.start_at_rest(contact_mesh);
            started.map_err(|fault| self.fault(contact_mesh, fault))?;
        }
        if let Some(holes) = &contact_mesh.model.holes {
            return self.looked_rubbing(contact_mesh, holes);
        }
        if let Some(answer) = warm {
            self.start_near(contact_mesh, answer);
        }
        let mut tensions = self.chain.tensions.clone();
        for (tension, command) in tensions.iter_mut().zip(self.workspace.commands()) {
            if let Command::Tension(given) = command {
                *tension = *given;
            }
        }
        self.chain.pull(&contact_mesh.groups, &tensions);
        let measured = self.chain.measure(&contact_mesh.task(&self.workspace));
        self.gap = measured.map_err(|fault| self.fault(contact_mesh, fault))?;
        self.place(&contact_mesh.mesh);
        Ok(())
    }

    /// The same of a rod whose cables rub.
    fn looked_rubbing(
        &mut self,
        contact_mesh: &ContactMesh,
        holes: &Holes,
    ) -> Result<(), SolveError> {
        self.chain.slopes.resize(contact_mesh.groups.len(), Slope::default());
        self.chain.pull(&contact_mesh.groups, self.holes.tensions());
        let task = contact_mesh.task(&self.workspace);
        let measured = self.chain.measure(&task);
        if measured.is_ok() {
            let Passages { lengths, turns } = self.holes.at_mut();
            lengths.clone_from(&self.chain.lengths);
            turns.resize(lengths.len(), 0.0);
            for passages in &holes.of_cable {
                self.chain.turn(&task, passages, turns);
            }
        }
        self.chain.slopes.clear();
        let gap = measured.map_err(|fault| self.fault(contact_mesh, fault))?;
        self.gap = gap.max(self.holes.assess(holes, self.workspace.commands()));
        self.place(&contact_mesh.mesh);
        Ok(())
    }

    /// Eliminates the tensions of the passages of a rod whose cables rub where that is not done; `false` where they are singular.
    fn eliminate(&mut self) -> bool {
        let Self { linear, holes: state, workspace, contact_mesh, .. } = self;
        let holes = contact_mesh.as_ref().and_then(|at| at.model.holes.as_ref());
        let (Some(linear), Some(holes)) = (&mut linear.here, holes) else { return true };
        let at = RodHoles { state, holes, commands: workspace.commands() };
        linear.is_eliminated || linear.eliminate(&[], at).is_some()
    }

    /// Which cables are taut.
    pub(super) fn taut(&self, contact_mesh: &ContactMesh) -> Vec<bool> {
        if contact_mesh.model.has_friction() {
            return vec![true; self.workspace.commands().len()];
        }
        let frame = contact_mesh.model.frame();
        let units = [frame.scales(&contact_mesh.mesh).force, frame.rod.backbone().length];
        let (tensions, lengths) = (&self.chain.tensions, &self.chain.lengths);
        let is_taut = |(i, command): (usize, &Command)| match command.is_length() {
            true => command.is_active(i, tensions, lengths, units),
            false => tensions[i] > 0.0,
        };
        self.workspace.commands().iter().enumerate().map(is_taut).collect()
    }
}

impl ContactRod for ContactResponse {
    type Kept = Kept;

    const WORK_OF_STEP: f64 = 1.25;

    fn refinement(&mut self) -> &mut Refinement {
        &mut self.refinement
    }

    fn reset(&mut self) {
        self.contact_mesh = None;
        self.linear.forget();
    }

    fn set_plastic(&mut self, left: &PlasticCurvature) {
        self.linear.forget();
        if let Some(contact_mesh) = &mut self.contact_mesh {
            Arc::make_mut(contact_mesh).set_plastic(left);
        }
        self.plastic = Some(left.clone());
    }

    fn plastic_left(&self, robot: &Robot, case: &Case) -> Result<PlasticCurvature, SolveError> {
        self.plastic_left_there(robot, case)
    }

    fn look(
        &mut self,
        robot: &Robot,
        options: &Options,
        case: &Case,
        (stations, pushes): (&[f64], &[f64]),
        warm: Option<&Solution>,
    ) -> Result<(), SolveError> {
        self.linear.look();
        self.workspace.meter_mut().start(&options.cancel, Budget::UNLIMITED);
        let before = self.contact_mesh.take();
        let is_new = before.is_none();
        let stands = |there: &Arc<ContactMesh>| {
            there.halvings == self.refinement.halvings
                && there.pushes == pushes
                && there.stations == stations
        };
        let contact_mesh = match before.filter(stands) {
            Some(contact_mesh) => contact_mesh,
            None => {
                self.linear.forget();
                let Refinement { steps, halvings, .. } = self.refinement;
                let at = (steps, halvings);
                let plastic = self.plastic.as_ref();
                Arc::new(ContactMesh::new(robot, options, case, at, (stations, pushes), plastic)?)
            }
        };
        contact_mesh.model.accept(case, &contact_mesh.mesh, &mut self.workspace)?;
        if warm.is_some() {
            self.linear.forget();
        }
        let looked = self.looked(&contact_mesh, is_new, warm);
        self.contact_mesh = Some(contact_mesh);
        looked
    }

    fn steps(&self) -> usize {
        self.contact_mesh.as_ref().map_or(0, |contact_mesh| contact_mesh.mesh.grid.len())
    }

    fn gap(&self) -> f64 {
        self.gap
    }

    fn shape(&self) -> &DenseOutput {
        &self.shape
    }

    fn pose_before(kept: &Kept, arc_length: f64) -> Pose {
        kept.shape.pose(arc_length)
    }

    fn linearise(&mut self, robot: &Robot, case: &Case) -> Result<(), SolveError> {
        if self.linear.here.is_none()
            && let Some(contact_mesh) = self.contact_mesh.clone()
        {
            let taut = self.taut(&contact_mesh);
            let mut linear = core::mem::take(&mut self.linear);
            let reused = linear.take_reusable(&taut, |of| self.closing(of, &taut));
            self.linear = linear;
            self.linear.here = Some(match reused {
                Some(reused) => reused,
                None => self.linearised(&contact_mesh, taut, robot, case)?,
            });
        }
        Ok(())
    }

    fn node(&self, arc_length: f64) -> usize {
        self.contact_mesh.as_ref().map_or(0, |contact_mesh| contact_mesh.node(arc_length))
    }

    fn differentiate(
        &self,
        robot: &Robot,
        case: &Case,
        history: &[PlasticCurvature],
        parameters: &[Parameter],
    ) -> Result<Derivatives, SolveError> {
        let contact_mesh = self.contact_mesh.as_ref().ok_or(SolveError::NoDerivatives)?;
        let (taut, nodes) = (self.taut(contact_mesh), contact_mesh.asked_nodes());
        let of = (robot, case, history);
        self.derivatives(contact_mesh, of, (&taut, &nodes), parameters, None)
    }

    fn grid(&self) -> Option<&Grid> {
        self.contact_mesh.as_ref().map(|contact_mesh| &contact_mesh.mesh.grid)
    }

    fn standing(&self) -> Option<Standing> {
        let commands = self.workspace.commands();
        match &self.contact_mesh.as_ref()?.model.holes {
            Some(holes) => self.holes.standing(holes, commands),
            None => Some(Standing::of_whole_cables(commands, &self.chain.tensions)),
        }
    }

    fn here(&self) -> Kept {
        Kept {
            contact_mesh: self.contact_mesh.clone(),
            nodes: self.chain.nodes.clone(),
            tensions: self.chain.tensions.clone(),
            shape: self.shape.clone(),
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

    fn compliance(
        &mut self,
        places: impl Iterator<Item = f64>,
        compliance: &mut Vec<f64>,
        drift: &mut Vec<f64>,
    ) {
        compliance.clear();
        drift.clear();
        let (Some(contact_mesh), Some(linear)) = (&self.contact_mesh, &mut self.linear.here) else {
            return;
        };
        let nodes: Vec<usize> = places.map(|at| contact_mesh.node(at)).collect();
        if let Some(holes) = &contact_mesh.model.holes {
            let (state, commands) = (&mut self.holes, self.workspace.commands());
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
        let (Some(contact_mesh), Some(linear)) = (&self.contact_mesh, &self.linear.here) else {
            return part;
        };
        let Motion { nodes, disks, tensions } = match &contact_mesh.model.holes {
            None => linear.step(changes),
            Some(holes) => {
                let (state, commands) = (&mut self.holes, self.workspace.commands());
                linear.step_rubbing(changes, RodHoles { state, holes, commands })
            }
        };
        let most = disks.iter().map(|disk| disk.turn.norm()).fold(0.0, f64::max);
        let part = if part * most > LONGEST { LONGEST / most } else { part };
        let has_followers = self.workspace.loads().any_follower_force();
        let at = &contact_mesh.mesh.grid.disks;
        let last = self.chain.nodes.len() - 1;
        for (k, node) in self.chain.nodes.iter_mut().enumerate() {
            // The base is clamped, and nothing is left to act at the tip.
            let turn = if k == 0 { Vec3::ZERO } else { disks[k].turn };
            if k < last {
                let force = disks[k].force - linear.wrench_beyond(at[k], changes);
                let change = NodeChange { turn, force, ..disks[k] };
                *node = node.moved(part, &change, &nodes[at[k]], has_followers);
            } else {
                let change = NodeChange { turn, ..NodeChange::default() };
                *node = node.moved(part, &change, &NodeChange::default(), false);
            }
        }
        if contact_mesh.model.has_friction() {
            self.holes.advance(&tensions, part);
            self.chain.pull(&contact_mesh.groups, self.holes.tensions());
            return part;
        }
        let mut pulled = self.chain.tensions.clone();
        for (tension, change) in pulled.iter_mut().zip(&tensions) {
            *tension = (*tension + part * change).max(0.0);
        }
        self.chain.pull(&contact_mesh.groups, &pulled);
        self.linear.step(part * most);
        part
    }

    fn stands(&mut self) -> bool {
        let odd = self.has_history() && self.eliminate() && self.holes.is_odd();
        let Some(contact_mesh) = &self.contact_mesh else { return true };
        let task = contact_mesh.task(&self.workspace);
        let negative = self.chain.is_determinant_negative(&task).unwrap_or(false);
        negative == odd
    }

    fn unstable_directions(&mut self) -> Option<usize> {
        let contact_mesh = self.contact_mesh.clone()?;
        let ContactMesh { model, mesh, .. } = &*contact_mesh;
        if model.has_friction() || self.workspace.loads().any_follower() {
            return None;
        }
        let on_mesh = (model.frame(), mesh);
        stability_check::unstable_directions_of(on_mesh, &self.chain, &mut self.workspace)
    }

    fn rubbing_tensions(&self) -> usize {
        if self.has_history() { self.holes.tensions().len() } else { 0 }
    }

    fn has_history(&self) -> bool {
        self.contact_mesh.as_ref().is_some_and(|contact_mesh| contact_mesh.model.has_friction())
    }

    fn keep(&mut self, kept: &mut Kept) {
        if let Some(holes) = self.contact_mesh.as_ref().and_then(|at| at.model.holes.as_ref()) {
            self.holes.keep(holes, self.workspace.commands());
        }
        kept.contact_mesh.clone_from(&self.contact_mesh);
        kept.nodes.clone_from(&self.chain.nodes);
        kept.tensions.clone_from(&self.chain.tensions);
        kept.shape.clone_from(&self.shape);
    }

    fn go_back(&mut self, kept: &Kept) {
        self.linear.forget();
        self.contact_mesh.clone_from(&kept.contact_mesh);
        self.chain.nodes.clone_from(&kept.nodes);
        self.shape.clone_from(&kept.shape);
        self.holes.go_back();
        if let Some(contact_mesh) = &self.contact_mesh {
            self.chain.pull(&contact_mesh.groups, &kept.tensions);
        }
    }

    fn refine(&mut self, case: &Case, accuracy: Accuracy) -> Result<bool, SolveError> {
        let (Accuracy::Tolerance(tolerance), Some(contact_mesh)) = (accuracy, &self.contact_mesh)
        else {
            return Ok(false);
        };
        let ContactMesh { mesh, pushes, model, .. } = &**contact_mesh;
        let tolerance = tolerance * model.robot().backbone().length;
        if self.refinement.accept(self.change_on_halved_steps(contact_mesh, case), tolerance) {
            return Ok(false);
        }
        let answer = (&mesh.grid, &self.shape.poses[..], &self.chain.lengths[..]);
        self.refinement.refine(tolerance, answer, pushes)
    }

    fn solution(&mut self, case: &Case) -> Result<Option<Solution>, SolveError> {
        let Some(contact_mesh) = &self.contact_mesh else { return Ok(None) };
        let base = self.chain.nodes[0];
        let force = self.workspace.loads().base_force() + base.force;
        let base_wrench = Wrench { force, moment: base.moment };
        let Chain { tensions, lengths, .. } = &self.chain;
        match &contact_mesh.model.holes {
            None => self.workspace.adopt(&self.shape.poses, tensions, lengths, base_wrench),
            Some(holes) => {
                self.holes.keep(holes, self.workspace.commands());
                let mut of_cables = Vec::new();
                holes.cable_lengths(lengths, &mut of_cables);
                let History { base, tensions, slip_states, .. } = self.holes.history();
                self.workspace.adopt(&self.shape.poses, base, &of_cables, base_wrench);
                self.workspace.adopt_holes(tensions, slip_states);
            }
        }
        let found = Found { iterations: 0, residual: self.gap, lost_at: None };
        let ContactMesh { model, mesh, .. } = &**contact_mesh;
        let cases = core::slice::from_ref(case);
        Ok(Some(model.solution(mesh, cases, &mut self.workspace, found, self.refinement.error)))
    }

    fn solve_free(
        &self,
        robot: &Robot,
        options: &Options,
        (case, near): (&Case, Option<&Solution>),
        meter: &Meter,
    ) -> Result<Solution, SolveError> {
        let options = Options { budget: meter.left(), ..options.clone() };
        let mut model = CosseratDisks::new(robot, &case.loads, &options)?;
        if let Some(left) = &self.plastic {
            model.set_plastic(left.clone());
        }
        let mut workspace = Workspace::default();
        let solved = model.solve_step(case, near, &mut workspace);
        meter.charge(&workspace.meter);
        solved
    }
}
