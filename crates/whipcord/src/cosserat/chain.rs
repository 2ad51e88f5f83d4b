//! Multiple shooting, for any loads and commands.
//!
//! A single shot from the base magnifies the error of the base moment by about `exp(L √(F/EI))`:
//! under strong loads none hits the tip. Here every step is shot from its own start, and Newton's
//! method closes the gaps between them, eq. (10) of [`crate::statics::elimination`], together with the
//! lengths of the cables that are driven by them, eq. (7). The load factor may be an unknown, too:
//! the step is then at right angles to a given direction ([`crate::statics::path`]).

use whipcord_numerics::{Equations, NewtonOptions, Pose, Reuse, Vec3, newton};

use super::base_sweep::BaseSweep;
use super::gap::Gap;
use super::loaded::Trajectory;
use super::problem::Problem;
use super::sensitivity::{Column, Sensitivity, Tensions, Unknowns};
use super::state::{Direction, State, weight};
use super::step_lanes::StepLanes;
use super::target::Target;
use crate::budget::Meter;
use crate::derivatives::StepGap;
use crate::section::{Fault, SectionFault, step_tolerance};
use crate::statics::command::Command;
use crate::statics::elimination::{Change, Elimination, Size};
use crate::statics::grid::Grid;
use crate::statics::loads::AppliedLoads;
use crate::statics::outcome::Open;
use crate::statics::path::state::{Part as _, PartChange as _};
use crate::statics::path::{self, pattern};
use crate::statics::scales::Scales;
use crate::statics::shared_unknowns::{Cables, SharedUnknowns};
use crate::statics::trace::Trace;

/// The rod as a chain of steps, each with its own start.
#[derive(Clone, Debug, Default)]
pub(super) struct Chain {
    pub state: State,
    /// Tensions in N of all cables at each shooting node in turn, where friction makes them vary; else none.
    pub varying: Vec<f64>,
    pub(super) kept: State,
    pub(super) gaps: Vec<Gap>,
    size: Size,
    /// Of the end of each step by rotation and cut at its start and what all share.
    columns: Vec<Column>,
    /// `∂ℓᵢ` of each step by rotation and cut at its start and what all share.
    length_rows: Vec<f64>,
    pub(super) step: Direction,
    pub(super) elimination: Elimination,
    pub(super) sensitivity: Sensitivity,
    shared: SharedUnknowns,
    base_sweep: BaseSweep,
}

/// What the chain is solved for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task<'a> {
    pub grid: &'a Grid,
    pub loads: &'a AppliedLoads,
    pub commands: &'a [Command],
    /// Length of the backbone in m.
    pub length: f64,
    /// Greatest gap that counts as closed, relative to 1 rad and the scales of moment, force and
    /// length.
    pub tolerance: f64,
    pub meter: &'a Meter,
}

pub(super) type Step<'a> = path::Step<'a, Change>;

impl<'a> Task<'a> {
    /// The chain of a problem whose loads are gathered.
    pub fn of(problem: &Problem<'a>, loads: &'a AppliedLoads) -> Self {
        Self {
            grid: problem.grid,
            loads,
            commands: problem.commands,
            length: problem.length,
            tolerance: problem.tolerance,
            meter: problem.meter,
        }
    }
}

const NEWTON: NewtonOptions = NewtonOptions {
    tolerance: 0.0,
    iterations: 40,
    least_fraction: 1.0 / 64.0,
    decrease: 1e-4,
    rounding: 1e-9,
    reuse: None,
    trusted: 0,
};

/// From the base, tangents serve as long as a step leaves a tenth of the gaps: the rule that carries them is no better.
const TANGENTS: Reuse = Reuse { at_start: false, near: 0.1, ratio: 0.1 };

/// How the linear system of a step is solved.
#[derive(Clone, Copy)]
enum LinearSolve<'a> {
    /// By elimination from the base, with what all steps share.
    Elimination(Step<'a>),
    /// By columns that the moment at the base drives: where loads are weak, cables have their tensions and nothing follows.
    FromBase,
}

/// A chain whose gaps are closed.
struct Shooting<'a> {
    chain: &'a mut Chain,
    task: &'a Task<'a>,
    by: LinearSolve<'a>,
    trajectory: &'a mut Trajectory,
    trace: &'a mut Trace,
}

impl Equations for Shooting<'_> {
    type Fault = Fault;

    fn residual(&mut self) -> Result<f64, Fault> {
        let Self { chain, task, trajectory, .. } = self;
        match self.by {
            LinearSolve::Elimination(_) => chain.shoot(task, trajectory),
            // Its steps need what lanes leave.
            LinearSolve::FromBase => {
                let shot = chain.shoot_in_lanes(task, trajectory);
                shot.ok_or(Fault { kind: SectionFault::Diverged, arc_length: 0.0 })
            }
        }
    }

    fn step(&mut self, fresh: bool) -> Option<f64> {
        let Self { chain, task, .. } = self;
        task.meter.iterate();
        let is_solved = match self.by {
            LinearSolve::FromBase => chain.solve_from_base(task, &self.trajectory.in_lanes, fresh),
            LinearSolve::Elimination(by) => chain.solve_step(task, by, self.trajectory),
        };
        if !is_solved {
            return None;
        }
        core::mem::swap(&mut chain.kept, &mut chain.state);
        Some(1.0)
    }

    fn go(&mut self, fraction: f64) {
        let Chain { state, kept, step, .. } = &mut *self.chain;
        state.step_from(kept, fraction, step);
    }

    fn has_ended(&self) -> bool {
        self.trajectory.steps_left == 0 || self.task.meter.has_ended()
    }

    fn note(&mut self, iteration: usize, residual: f64, fraction: f64) {
        let State { load, tensions, .. } = &self.chain.state;
        self.trace.iteration(iteration, *load, residual, fraction, tensions);
    }
}

impl Chain {
    /// Newton's method from `self.state`, where it also ends: at its load, or across a direction.
    /// Returns the iterations and the greatest gap left. Gives up when the shot has no steps left. The shot ends with the strains and samples
    /// of the answer.
    pub fn newton(
        &mut self,
        task: &Task<'_>,
        across: Option<&Direction>,
        trajectory: &mut Trajectory,
        trace: &mut Trace,
    ) -> Result<(usize, f64), Open> {
        let by = across.map_or(Step::Close, Step::Across);
        self.solve(task, LinearSolve::Elimination(by), trajectory, trace)
    }

    /// [`Self::newton`] at its load for weak dead loads and cables that are driven by their tensions, where lanes take the steps; the shot has the strains
    /// of the answer, and [`Self::sample`] takes its samples.
    pub fn close_from_base(
        &mut self,
        task: &Task<'_>,
        trajectory: &mut Trajectory,
        trace: &mut Trace,
    ) -> Result<(usize, f64), Open> {
        self.solve(task, LinearSolve::FromBase, trajectory, trace)
    }

    fn solve(
        &mut self,
        task: &Task<'_>,
        by: LinearSolve<'_>,
        trajectory: &mut Trajectory,
        trace: &mut Trace,
    ) -> Result<(usize, f64), Open> {
        let reuse = match by {
            LinearSolve::FromBase => Some(TANGENTS),
            LinearSolve::Elimination(_) => None,
        };
        let options = NewtonOptions { tolerance: task.tolerance, reuse, ..NEWTON };
        let solved = newton(&mut Shooting { chain: self, task, by, trajectory, trace }, &options)?;
        Ok((solved.iterations, solved.residual))
    }

    /// The linear step of a closed chain that [`path::Step::Along`] or [`path::Step::Probe`] ask for; `None` where
    /// the system is singular.
    pub fn direction(
        &mut self,
        task: &Task<'_>,
        by: Step<'_>,
        trajectory: &mut Trajectory,
    ) -> Option<Direction> {
        self.shoot(task, trajectory).ok()?;
        self.solve_step(task, by, trajectory).then(|| self.step.clone())
    }

    /// Whether the determinant of the linearised problem at this load is negative. The chain is
    /// closed.
    pub fn is_determinant_negative(
        &mut self,
        task: &Task<'_>,
        trajectory: &mut Trajectory,
    ) -> Option<bool> {
        self.shoot(task, trajectory).ok()?;
        self.solve_step(task, Step::Close, trajectory)
            .then_some(self.elimination.is_negative() != self.shared.is_negative())
    }

    /// How the steps end beyond the nodes that they should meet, in the base frame.
    pub fn gaps(&self) -> impl Iterator<Item = StepGap> + '_ {
        self.gaps
            .iter()
            .zip(self.state.nodes.windows(2))
            .map(|(gap, nodes)| StepGap::new(gap.change, nodes[1].rotation, nodes[1].moment))
    }

    /// Frames at the ends of all steps of a closed chain.
    pub fn poses(&self, poses: &mut Vec<Pose>) {
        poses.clear();
        let nodes = &self.state.nodes;
        let mut position = Vec3::ZERO;
        for (node, gap) in nodes.iter().zip(&self.gaps) {
            poses.push(Pose { position, rotation: node.rotation });
            position += gap.end.position;
        }
        if let Some(last) = nodes.last() {
            poses.push(Pose { position, rotation: last.rotation });
        }
    }

    /// Shoots every step from its node; the greatest gap.
    pub fn shoot(&mut self, task: &Task<'_>, trajectory: &mut Trajectory) -> Result<f64, Fault> {
        let Some(greatest) = self.shoot_in_lanes(task, trajectory) else {
            return self.shoot_through(task, trajectory, true, |_| false);
        };
        self.sample(task, trajectory)?;
        Ok(greatest)
    }

    /// [`Self::shoot`] without samples; `None` where lanes do not take the steps.
    pub fn shoot_in_lanes(&mut self, task: &Task<'_>, trajectory: &mut Trajectory) -> Option<f64> {
        let scales = Scales::of(task.grid, task.length);
        let mut gaps = core::mem::take(&mut self.gaps);
        let (at, nodes) = ((task.grid, &scales), &self.state.nodes);
        let greatest = trajectory.shoot_steps(at, task.loads, &self.target(task), nodes, &mut gaps);
        self.gaps = gaps;
        let greatest = greatest?;
        task.meter.integrate(task.grid.len());
        Some(greatest.max(self.lengths_left(task, trajectory, &scales)))
    }

    /// Takes the samples of the last shot, unless it has them.
    pub fn sample(&self, task: &Task<'_>, trajectory: &mut Trajectory) -> Result<(), Fault> {
        if !trajectory.samples.is_empty() {
            return Ok(());
        }
        trajectory.sample_steps(task.grid, &self.target(task))
    }

    /// What the steps are shot at.
    fn target(&self, task: &Task<'_>) -> Target<'_> {
        let State { tensions: even, load, .. } = &self.state;
        let (tensions, per_node) = match self.varying.is_empty() {
            true => (even, 0),
            false => (&self.varying, even.len()),
        };
        Target {
            tensions,
            per_node,
            base_moment: Vec3::ZERO,
            follower_force: Vec3::ZERO,
            load: *load,
            sample: true,
            step_tolerance: step_tolerance(task.tolerance),
        }
    }

    /// What the commands of lengths leave open.
    fn lengths_left(&self, task: &Task<'_>, trajectory: &mut Trajectory, scales: &Scales) -> f64 {
        let mut greatest: f64 = 0.0;
        if task.commands.iter().any(Command::is_length) {
            trajectory.measure(task.grid);
            for (i, command) in task.commands.iter().enumerate() {
                let left = command.complementarity_residual(
                    i,
                    &self.state.tensions,
                    &trajectory.lengths,
                    scales.of_cables(),
                );
                greatest = if left.is_nan() { f64::INFINITY } else { greatest.max(left) };
            }
        }
        greatest
    }

    /// [`Chain::shoot`], with these nodes put to where the steps before them end; not the last one, whose gap is the condition at
    /// the tip. [`Trajectory::samples`], which [`Self::linearise`] needs, are taken where asked for.
    pub fn shoot_through(
        &mut self,
        task: &Task<'_>,
        trajectory: &mut Trajectory,
        sample: bool,
        is_free: impl Fn(usize) -> bool,
    ) -> Result<f64, Fault> {
        let scales = Scales::of(task.grid, task.length);
        task.meter.integrate(task.grid.len());
        trajectory.samples.clear();
        self.gaps.clear();
        let mut greatest: f64 = 0.0;
        for k in 0..task.grid.len() {
            let (start, next) = (self.state.nodes[k], self.state.nodes[k + 1]);
            let moment = start.rotation.rotate(start.moment);
            let target = Target { follower_force: start.force, sample, ..self.target(task) };
            let (pose, cut) =
                trajectory.shoot_step(task.grid, task.loads, &target, k, start.rotation, moment)?;
            let mut gap = Gap::of((task.loads, self.state.load), k, pose, cut, &next);
            if k + 1 < task.grid.len() && is_free(k + 1) {
                self.state.nodes[k + 1] = next.stepped(1.0, &gap.change);
                gap.change = Change::default();
            }
            greatest = greatest.max(gap.size(&next, &scales));
            self.gaps.push(gap);
        }
        Ok(greatest.max(self.lengths_left(task, trajectory, &scales)))
    }

    /// How the end of every step that has been shot depends on its start and on what all share.
    fn linearise(&mut self, task: &Task<'_>, by_load: bool, trajectory: &Trajectory) {
        let by_length = task.commands.iter().any(Command::is_length);
        let by = Unknowns {
            follower_force: task.loads.any_follower_force(),
            load: by_load,
            tensions: Tensions::Even(if by_length { task.commands.len() } else { 0 }),
        };
        let cut = if by.follower_force { 6 } else { 3 };
        self.size = Size { cut, shared: by.count() - 3 - cut };
        self.columns.clear();
        self.length_rows.clear();
        let Self { state, gaps, sensitivity, .. } = self;
        for (k, gap) in gaps.iter().enumerate() {
            let samples = &trajectory.samples[3 * k..3 * k + 3];
            let end = gap.end.rotation;
            sensitivity.transition(task.grid, task.loads, state.load, k, samples, end, by);
            self.columns.extend_from_slice(&sensitivity.columns);
            self.length_rows.extend_from_slice(&sensitivity.lengths);
        }
    }

    /// Solves eq. (10) for the steps that lanes have shot into `self.step`, by the tangents at hand unless they are to be `fresh`; `false` where the
    /// system is singular.
    pub(super) fn solve_from_base(
        &mut self,
        task: &Task<'_>,
        shot: &StepLanes,
        fresh: bool,
    ) -> bool {
        let mut sweep = core::mem::take(&mut self.base_sweep);
        let is_taken = !fresh || sweep.linearise(task.grid, &self.target(task), shot);
        let Self { state, gaps, step, .. } = self;
        let at = (task.grid, task.loads, state.load);
        let is_solved = is_taken && sweep.solve(at, gaps, step);
        step.tensions.clear();
        step.tensions.resize(state.tensions.len(), 0.0);
        self.base_sweep = sweep;
        is_solved
    }

    /// Linearises the steps that have been shot and solves eq. (10), and with it what all steps share, into `self.step`; `false` where the
    /// system is singular.
    pub(super) fn solve_step(
        &mut self,
        task: &Task<'_>,
        by: Step<'_>,
        trajectory: &Trajectory,
    ) -> bool {
        self.linearise(task, by.frees_load(), trajectory);
        let scales = Scales::of(task.grid, task.length);
        let Self { state, gaps, columns, length_rows, step, elimination, shared, size, .. } = self;
        let steps = gaps.len();
        let unknowns = 3 + size.cut + size.shared;
        elimination.start(*size, scales.moment, scales.force);
        for (k, gap) in gaps.iter().enumerate() {
            let gap = match by {
                Step::Close | Step::Across(_) => gap.change,
                Step::Along(_) => Change::default(),
                Step::Probe => Change { moment: scales.moment * pattern(k), ..Change::default() },
            };
            if !elimination.push(&columns[k * unknowns..(k + 1) * unknowns], &gap) {
                return false;
            }
        }
        elimination.answer();
        shared.cables.clear();
        shared.cables.extend(0..size.shared - usize::from(by.frees_load()));
        lengths_by(*size, length_rows, elimination, steps, &mut shared.lengths);
        if let Step::Across(direction) | Step::Along(direction) = by {
            along(direction, task.grid, &scales, elimination, *size, &mut shared.along);
        }
        let (tensions, lengths) = (&state.tensions, &trajectory.lengths);
        let cables = Cables { commands: task.commands, tensions, lengths };
        if !shared.solve(by, &cables, &scales) {
            return false;
        }
        step.nodes.clear();
        for k in 0..=steps {
            let mut change = elimination.change(k, size.shared);
            for (j, &theta) in shared.theta.iter().enumerate() {
                change = change.plus(theta, elimination.change(k, j));
            }
            step.nodes.push(change);
        }
        // The base is clamped, and nothing is left to act at the tip.
        step.nodes[0].turn = Vec3::ZERO;
        (step.nodes[steps].moment, step.nodes[steps].force) = (Vec3::ZERO, Vec3::ZERO);
        let load = usize::from(by.frees_load());
        step.load = if by.frees_load() { shared.theta[0] } else { 0.0 };
        step.tensions.clear();
        step.tensions.extend_from_slice(&shared.theta[load..]);
        step.tensions.resize(state.tensions.len(), 0.0);
        step.load.is_finite()
            && step.nodes.iter().all(Change::is_finite)
            && step.tensions.iter().all(|t| t.is_finite())
    }
}

/// The change of each cable's length with `(θ, 1)`, from those of the steps with what they depend on.
fn lengths_by(
    size: Size,
    rows: &[f64],
    elimination: &Elimination,
    steps: usize,
    lengths: &mut Vec<f64>,
) {
    let Size { cut, shared } = size;
    let (unknowns, wide) = (3 + cut + shared, shared + 1);
    let cables = rows.len() / (steps * unknowns).max(1);
    lengths.clear();
    lengths.resize(cables * wide, 0.0);
    for k in 0..steps {
        for j in 0..wide {
            let change = elimination.change(k, j);
            for i in 0..cables {
                let row = &rows[(k * cables + i) * unknowns..][..unknowns];
                let vector = |i: usize| Vec3::new(row[i], row[i + 1], row[i + 2]);
                let mut sum = vector(0).dot(change.turn) + vector(3).dot(change.moment);
                if cut == 6 {
                    sum += vector(6).dot(change.force);
                }
                if j < shared {
                    sum += row[3 + cut + j];
                }
                lengths[i * wide + j] += sum;
            }
        }
    }
}

/// The product of a direction with what `(θ, 1)` does.
fn along(
    direction: &Direction,
    grid: &Grid,
    scales: &Scales,
    elimination: &Elimination,
    size: Size,
    products: &mut Vec<f64>,
) {
    let shares = |j: usize| match j {
        0 => direction.load,
        _ if j < size.shared => direction.tensions[j - 1] / (scales.force * scales.force),
        _ => 0.0,
    };
    let nodes = |j: usize| -> f64 {
        let nodes = direction.nodes.iter().enumerate();
        let product = |(k, node): (usize, &Change)| {
            weight(grid, k) * node.product(&elimination.change(k, j), scales)
        };
        nodes.map(product).sum()
    };
    products.clear();
    products.extend((0..=size.shared).map(|j| nodes(j) + shares(j)));
}
