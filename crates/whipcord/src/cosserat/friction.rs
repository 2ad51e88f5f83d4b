//! The rod whose cables have friction, as [`crate::statics::friction`] takes it: the chain of [`super::chain`] with a tension at
//! every node of [`super::tension_nodes`].

use whipcord_numerics::Vec3;

use super::chain::{Chain, Task};
use super::continuation::raise_load;
use super::loaded::Trajectory;
use super::problem::{Problem, StabilityCheck};
use super::scratch::{Scratch, Start};
use super::sensitivity::{Tensions, Unknowns};
use super::shooting::sample;
use super::state::{Node, State};
use super::statics::solve_independent;
use super::tension_nodes::{TensionNodes, TurnSlope};
use super::without_load::start_without_load;
use crate::budget::Meter;
use crate::robot::Robot;
use crate::section::Fault;
use crate::shape::Wrench;
use crate::solution::SlipState;
use crate::statics::command::Command;
use crate::statics::elimination::{Change, Size};
use crate::statics::friction::{
    Course, FrictionScratch, History, Holes, PassageResponse, Passages, Response,
};
use crate::statics::grid::Grid;
use crate::statics::outcome::Failure;
use crate::statics::plastic_curvature::PlasticCurvature;
use crate::statics::quadratic_form::Sample;
use crate::statics::scales::Scales;

/// Of the greatest tension: a bound that is nearer is met. Neighbouring nodes on a curve come to their bounds one shortly after the other: those that do so within
/// what is far below the error of a substep are one event.
const MET: f64 = 1e-7;

/// The nodes of a robot on a grid, as holes.
#[derive(Clone, Debug)]
pub(super) struct Friction {
    pub nodes: TensionNodes,
    pub holes: Holes,
}

impl Friction {
    /// Of the cables of a robot in the order of the grid, with their lengths in m at rest.
    pub fn new(robot: &Robot, grid: &Grid, order: &[usize], rest_lengths: &[f64]) -> Self {
        let cables = || order.iter().map(|&cable| &robot.cables()[cable]);
        let coefficients: Vec<f64> = cables().map(|cable| cable.friction.unwrap_or(0.0)).collect();
        let nodes = TensionNodes::new(grid, &coefficients);
        let mut lengths = vec![0.0; nodes.count()];
        nodes.add_lengths_at_rest(grid, &mut lengths);
        let mut yielding = vec![0.0; nodes.count()];
        for (cable, of) in cables().enumerate() {
            let range = nodes.of_cable(cable);
            lengths[range.start] -= grid.shooting.rest_excess[cable];
            let sum: f64 = lengths[range.clone()].iter().sum();
            debug_assert!((sum - rest_lengths[cable]).abs() <= 1e-9 * sum);
            if let Some(stiffness) = of.axial_stiffness {
                range.for_each(|node| yielding[node] = lengths[node] / stiffness);
            }
        }
        let (length, compliance) = (robot.backbone().length, compliance(robot, grid));
        let of_cable = (0..order.len()).map(|cable| nodes.of_cable(cable).collect()).collect();
        let at_rest = Vec::new();
        let outside = order.iter().map(|&cable| robot.outside_compliance(cable)).collect();
        let mut holes = Holes {
            of_cable,
            coefficients,
            yielding,
            outside,
            at_rest,
            length,
            compliance,
            met: MET,
            drives: Default::default(),
        };
        holes.at_rest = holes.beyond(&lengths, &vec![0.0; lengths.len()]);
        Self { nodes, holes }
    }
}

/// By how much a tension of 1 N shortens a cable, in m: its order of magnitude.
pub(super) fn compliance(robot: &Robot, grid: &Grid) -> f64 {
    let length = robot.backbone().length;
    let radius = robot
        .routes()
        .iter()
        .map(|route| route.at(0.0).offset.norm().max(route.at(route.end()).offset.norm()))
        .fold(1e-3 * length, f64::max);
    radius * radius / Scales::of(grid, length).moment
}

/// Memory of the linear response.
#[derive(Clone, Debug, Default)]
pub(super) struct ResponseScratch {
    slopes: Vec<TurnSlope>,
    /// Of all steps: what lengths and turns are by the unknowns of a step.
    lengths: Vec<f64>,
    turns: Vec<TurnRow>,
    turn_entries: Vec<f64>,
}

/// What the turn at a node is by the unknowns of a step, with its entries from `first` on.
#[derive(Clone, Copy, Debug)]
struct TurnRow {
    step: usize,
    node: usize,
    first: usize,
}

/// Memory of solves with friction.
#[derive(Clone, Debug, Default)]
pub(super) struct FrictionWorkspace {
    /// By how often the steps are halved.
    pub levels: Vec<Level>,
    /// Of each step of actuation, on the grid before.
    pub courses: Vec<Course<State>>,
    pub scratch: FrictionScratch,
    pub response: ResponseScratch,
    pub at: Passages,
    /// Whether the ends of all substeps are kept, for derivatives.
    pub keeps_trail: bool,
    /// Tensions of the cables below the base on the coarser grid.
    pub coarse_tensions: Vec<f64>,
}

/// What was found on one grid.
#[derive(Clone, Debug, Default)]
pub(super) struct Level {
    pub history: History<State>,
    /// After each step of actuation.
    pub answers: Vec<Answer>,
    /// What friction against bending held after each; none without it.
    pub plastic: Vec<PlasticCurvature>,
}

/// Where a step of actuation ends.
#[derive(Clone, Debug, Default)]
pub(super) struct Answer {
    pub shape: State,
    pub slip_states: Vec<SlipState>,
    /// Tensions at all shooting nodes.
    pub varying: Vec<f64>,
    /// The profile with which it was found.
    pub profile: Vec<f64>,
}

/// The rod of a problem whose loads are gathered.
pub(super) struct FrictionRod<'a> {
    problem: &'a Problem<'a>,
    friction: &'a Friction,
    /// Of the tensions, at all shooting nodes.
    profile: &'a [f64],
    scratch: &'a mut Scratch,
    memory: &'a mut ResponseScratch,
}

impl<'a> FrictionRod<'a> {
    pub fn new(
        problem: &'a Problem<'a>,
        (friction, profile): (&'a Friction, &'a [f64]),
        scratch: &'a mut Scratch,
        memory: &'a mut ResponseScratch,
    ) -> Self {
        Self { problem, friction, profile, scratch, memory }
    }

    /// One tension for each cable: the mean of its nodes.
    fn means(&self, tensions: &[f64]) -> Vec<f64> {
        let mean = |cable: usize| {
            let of = &tensions[self.friction.nodes.of_cable(cable)];
            of.iter().sum::<f64>() / of.len() as f64
        };
        (0..self.friction.nodes.cables()).map(mean).collect()
    }

    /// Lets the cables pull with these tensions of all nodes.
    fn pull(&mut self, tensions: &[f64]) {
        let varying = &mut self.scratch.chain.varying;
        self.friction.nodes.expand(self.problem.grid, tensions, self.profile, varying);
    }

    /// The sections of the next shot start from those without load, where those of the last shot do not serve.
    fn seed(&mut self) {
        let Scratch { trajectory, unloaded, .. } = &mut *self.scratch;
        trajectory.seed(self.problem.grid, &unloaded.strains);
    }

    /// Closes the chain at its tensions.
    fn close(&mut self) -> bool {
        let Scratch { chain, trajectory, applied, trace, .. } = &mut *self.scratch;
        let task = Task { commands: &[], ..Task::of(self.problem, applied) };
        chain.newton(&task, None, trajectory, trace).is_ok()
    }

    /// Finds the equilibrium whose cables have these tensions from end to end, into the chain.
    fn converge_evenly(&mut self, even: &[Command], means: &[f64]) -> Result<(), Failure> {
        self.scratch.chain.varying.clear();
        let problem = Problem {
            commands: even,
            asked: even,
            redundant_cables: false,
            stability: match self.problem.stability {
                StabilityCheck::Off => StabilityCheck::Off,
                _ => StabilityCheck::EveryGrid,
            },
            ..*self.problem
        };
        let scratch = &mut *self.scratch;
        scratch.tensions.clear();
        scratch.tensions.extend_from_slice(means);
        start_without_load(&problem, scratch)?;
        if !scratch.applied.any() {
            scratch.chain.state = State { load: 1.0, ..State::unloaded(&scratch.poses, means) };
            return Ok(());
        }
        solve_independent(&problem, &Start::default(), scratch)?;
        if !scratch.on_chain {
            let failed = |fault| Failure::of_section(fault, means, 1.0);
            sample(&problem, scratch).map_err(failed)?;
            scratch.chain.state = state_of_shot(&problem, scratch, means);
        }
        Ok(())
    }
}

/// The chain of an equilibrium that was shot at.
fn state_of_shot(problem: &Problem<'_>, scratch: &Scratch, tensions: &[f64]) -> State {
    let Scratch { trajectory, applied, base_wrench, poses, .. } = scratch;
    let mut force = applied.follower_share(base_wrench.force);
    let node = |k: usize| {
        let rotation = poses[k].rotation;
        if let Some(before) = k.checked_sub(1) {
            force -= rotation.rotate(applied.follower(k).force);
            if let Some(line) = applied.line(before) {
                let length = problem.grid.steps[before].length;
                force -= length * rotation.rotate(line.follower_force(0.5));
            }
        }
        match trajectory.samples.get(3 * k) {
            Some(sample) => Node { rotation, moment: sample.wrench.angular, force },
            None => Node { rotation, ..Node::default() },
        }
    };
    State { nodes: (0..poses.len()).map(node).collect(), tensions: tensions.to_vec(), load: 1.0 }
}

impl PassageResponse for FrictionRod<'_> {
    type Shape = State;

    fn shape(&self) -> State {
        self.scratch.chain.state.clone()
    }

    fn set_shape(&mut self, shape: &State) {
        self.scratch.chain.state.copy_from(shape);
        self.seed();
    }

    fn converge(&mut self, tensions: &[f64]) -> Result<(), Failure> {
        let means = self.means(tensions);
        let even: Vec<Command> = means.iter().map(|&t| Command::Tension(t)).collect();
        let evenly = self.converge_evenly(&even, &means);
        self.pull(tensions);
        if evenly.is_ok() {
            self.seed();
            if self.close() {
                return Ok(());
            }
        }
        if !self.scratch.applied.any() {
            return evenly;
        }
        let problem = Problem { commands: &even, asked: &even, ..*self.problem };
        let problem = Problem { stability: StabilityCheck::Off, ..problem };
        match raise_load(&problem, self.scratch, 0) {
            Ok(_) => Ok(()),
            Err(ended) => Err(ended.failure),
        }
    }

    fn measure(&mut self, tensions: &[f64], at: &mut Passages) -> Result<f64, Fault> {
        self.pull(tensions);
        let Problem { grid, .. } = *self.problem;
        let Friction { nodes, .. } = self.friction;
        let Scratch { chain, trajectory, applied, .. } = &mut *self.scratch;
        let task = Task { commands: &[], ..Task::of(self.problem, applied) };
        let gap = match chain.shoot(&task, trajectory) {
            Ok(gap) => gap,
            Err(fault) => {
                self.seed();
                return Err(fault);
            }
        };
        self.memory.measure(grid, nodes, trajectory, at);
        Ok(gap)
    }

    fn respond(&mut self, _tensions: &[f64], response: &mut Response) -> bool {
        let Self { problem, friction: Friction { nodes, .. }, profile, scratch, memory } = self;
        let grid = problem.grid;
        let Scratch { chain, trajectory, applied, .. } = &mut **scratch;
        let task = Task { commands: &[], ..Task::of(problem, applied) };
        if !memory.eliminate(&task, (nodes, profile), chain, &trajectory.samples) {
            return false;
        }
        let (n, wide) = (nodes.count(), nodes.count() + 1);
        problem.meter.respond(grid.len(), n);
        for rows in [&mut response.lengths, &mut response.turns] {
            rows.clear();
            rows.resize(n * wide, 0.0);
        }
        let start = if applied.any_follower_force() { 9 } else { 6 };
        let ResponseScratch { lengths, turns, turn_entries, .. } = &**memory;
        let (mut first, mut turn) = (0, 0);
        for (k, step) in grid.steps.iter().enumerate() {
            let unknowns = start + step.active;
            let add = |row: &[f64], into: &mut [f64]| {
                let mut worth = [0.0; 9];
                worth[..start].copy_from_slice(&row[..start]);
                chain.elimination.add_worth(k, &worth, into);
                for (local, by) in row[start..].iter().enumerate() {
                    into[nodes.at(local, k)] += by;
                }
            };
            for cable in 0..step.active {
                let node = nodes.at(cable, k);
                add(
                    &lengths[first..first + unknowns],
                    &mut response.lengths[node * wide..(node + 1) * wide],
                );
                first += unknowns;
            }
            while let Some(row) = turns.get(turn).filter(|row| row.step == k) {
                add(
                    &turn_entries[row.first..row.first + unknowns],
                    &mut response.turns[row.node * wide..(row.node + 1) * wide],
                );
                turn += 1;
            }
        }
        true
    }

    fn prepare(&mut self, changes: &[f64]) -> Option<f64> {
        let Chain { state, kept, step, elimination, .. } = &mut self.scratch.chain;
        kept.copy_from(state);
        step.nodes.clear();
        for k in 0..state.nodes.len() {
            step.nodes.push(elimination.follow(k, changes));
        }
        let last = step.nodes.len() - 1;
        // The base is clamped, and nothing is left to act at the tip.
        step.nodes[0].turn = Vec3::ZERO;
        (step.nodes[last].moment, step.nodes[last].force) = (Vec3::ZERO, Vec3::ZERO);
        step.load = 0.0;
        step.tensions.clear();
        step.tensions.resize(state.tensions.len(), 0.0);
        step.nodes.iter().all(Change::is_finite).then_some(1.0)
    }

    fn go(&mut self, fraction: f64) {
        let Chain { state, kept, step, .. } = &mut self.scratch.chain;
        state.step_from(kept, fraction, step);
    }

    fn tolerance(&self) -> f64 {
        self.problem.tolerance
    }

    fn meter(&self) -> &Meter {
        self.problem.meter
    }

    fn note(&mut self, iteration: usize, residual: f64, fraction: f64, tensions: &[f64]) {
        let nodes = &self.friction.nodes;
        let trace = &mut self.scratch.trace;
        if trace.is_on {
            let at_base = |cable: usize| tensions[nodes.of_cable(cable).start];
            let tensions: Vec<f64> = (0..nodes.cables()).map(at_base).collect();
            trace.iteration(iteration, 1.0, residual, fraction, &tensions);
        }
    }

    fn failure(&self, fault: Fault, tensions: &[f64]) -> Failure {
        let greatest = |cable: usize| {
            let of = &tensions[self.friction.nodes.of_cable(cable)];
            of.iter().copied().fold(0.0, f64::max)
        };
        let greatest: Vec<f64> = (0..self.friction.nodes.cables()).map(greatest).collect();
        Failure::of_section(fault, &greatest, 0.0)
    }
}

impl ResponseScratch {
    /// Lengths and angles of all passages where a shot with samples has gone.
    pub fn measure(
        &mut self,
        grid: &Grid,
        nodes: &TensionNodes,
        trajectory: &Trajectory,
        at: &mut Passages,
    ) {
        at.lengths.clear();
        at.lengths.resize(nodes.count(), 0.0);
        at.turns.clear();
        at.turns.resize(nodes.count(), 0.0);
        self.slopes.clear();
        self.slopes.resize(nodes.count(), TurnSlope::default());
        for (cable, excess) in grid.shooting.rest_excess.iter().enumerate() {
            at.lengths[nodes.of_cable(cable).start] -= excess;
        }
        nodes.add_lengths(grid, trajectory.strains(), &mut at.lengths);
        nodes.turns(grid, trajectory, &mut at.turns, &mut self.slopes);
    }

    /// How the turns change with the directions of the cables, where they were measured last.
    pub fn slopes(&self) -> &[TurnSlope] {
        &self.slopes
    }

    /// Eliminates the chain that was shot last, with all tensions for what its steps share, and keeps what lengths and turns are
    /// by the unknowns of each step; `false` where it is singular.
    pub fn eliminate(
        &mut self,
        task: &Task<'_>,
        (nodes, profile): (&TensionNodes, &[f64]),
        chain: &mut Chain,
        samples: &[Sample],
    ) -> bool {
        let Task { grid, loads, length, .. } = *task;
        let scales = Scales::of(grid, length);
        let follower_force = loads.any_follower_force();
        let cut = if follower_force { 6 } else { 3 };
        let size = Size { cut, shared: nodes.count() };
        let Chain { elimination, sensitivity, gaps, state, .. } = chain;
        elimination.start(size, scales.moment, scales.force);
        self.lengths.clear();
        self.turns.clear();
        self.turn_entries.clear();
        let at_step = profile.len() / grid.len();
        for (k, step) in grid.steps.iter().enumerate() {
            let active = step.active;
            let tensions = Tensions::Varying(active, &profile[k * at_step..(k + 1) * at_step]);
            let by = Unknowns { follower_force, load: false, tensions };
            let (sampled, end) = (&samples[3 * k..3 * k + 3], gaps[k].end.rotation);
            sensitivity.transition(grid, loads, state.load, k, sampled, end, by);
            let (start, own) = sensitivity.columns.split_at(3 + cut);
            let own = own.iter().enumerate();
            let own = own.map(|(cable, &column)| (nodes.at(cable, k), column));
            if !elimination.push_few(start, own, &gaps[k].change) {
                return false;
            }
            self.lengths.extend_from_slice(&sensitivity.lengths);
            let unknowns = by.count();
            for cable in (0..active).filter(|&cable| nodes.steps(cable) > 0) {
                let node = nodes.at(cable, k);
                let mut add = |node: usize, slopes: [Vec3; 2]| {
                    let first = self.turn_entries.len();
                    self.turns.push(TurnRow { step: k, node, first });
                    self.turn_entries.resize(first + unknowns, 0.0);
                    for (q, slope) in slopes.into_iter().enumerate() {
                        let row = (q * active + cable) * unknowns;
                        let directions = &sensitivity.directions[row..row + unknowns];
                        for (entry, by) in self.turn_entries[first..].iter_mut().zip(directions) {
                            *entry += slope.dot(*by);
                        }
                    }
                };
                let TurnSlope { start, middle, .. } = self.slopes[node];
                add(node, [start, middle]);
                if k + 1 < nodes.steps(cable) {
                    add(node + 1, [Vec3::ZERO, self.slopes[node + 1].before]);
                }
            }
        }
        elimination.answer();
        true
    }
}

/// What the base bears, of the chain as it stands.
pub(super) fn base_wrench(scratch: &Scratch) -> Wrench {
    let base = scratch.chain.state.nodes[0];
    Wrench { force: scratch.applied.base_force() + base.force, moment: base.moment }
}
