//! Static equilibrium on one mesh: of the robot without load, under loads, for tensions or lengths.

use whipcord_numerics::{Pose, UnitQuaternion, Vec3};

use super::chain::{Chain, Node, State};
use super::friction;
use super::layout::{Frame, Mesh};
use super::load_continuation::{self, Raise};
use super::rod::Sample;
use super::span::{self, Chord};
use super::stability::{Locked, Stability};
use super::stability_check::Sampled;
use super::unloaded::{self, Unloaded};
use crate::budget::Meter;
use crate::case::Case;
use crate::section::SectionFault;
use crate::section::{BodyWrench, Fault};
use crate::shape::{Solution, Wrench};
use crate::statics::command::Command;
use crate::statics::continuation::PATH_ENDS;
use crate::statics::friction::{FrictionScratch, History, Holes};
use crate::statics::lengths::{self, Effort, Given, LengthScratch, Note, TensionResponse};
use crate::statics::loads::AppliedLoads;
use crate::statics::options::StabilityAnalysis;
use crate::statics::outcome::{Failure, Found};
use crate::statics::trace::Stage;

/// What is to be solved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Problem<'a> {
    pub frame: &'a Frame,
    pub mesh: &'a Mesh,
    /// By cable.
    pub commands: &'a [Command],
    pub tolerance: f64,
    pub meter: &'a Meter,
    /// With hole friction.
    pub holes: Option<&'a Holes>,
    /// Whose loads they are.
    pub case: &'a Case,
    /// Where stability is computed.
    pub sampled: Sampled<'a>,
    /// What is asked of it.
    pub stability: StabilityAnalysis,
}

impl Problem<'_> {
    /// Whether a cable is driven by its length.
    pub fn by_length(&self) -> bool {
        self.commands.iter().any(|command| matches!(command, Command::Length { .. }))
    }

    /// How many disks there are, the base included.
    pub fn disks(&self) -> usize {
        self.frame.spans.len() + 1
    }
}

/// Where the iteration starts.
#[derive(Clone, Copy, Debug)]
pub(super) enum Start<'a> {
    /// From the robot without load.
    Cold,
    /// From the answer that the scratch holds, on a coarser mesh.
    Coarser,
    /// From a neighbouring answer.
    Near(&'a Neighbour),
}

/// A neighbouring answer.
#[derive(Clone, Debug, Default)]
pub(super) struct Neighbour {
    /// By cable, in N.
    tensions: Vec<f64>,
    /// As the base sees them.
    pub disks: Vec<Pose>,
    /// What the base exerts.
    pub base: Option<Wrench>,
    /// Whether it was stable, so that what is near is held to be.
    pub stable: bool,
}

impl Neighbour {
    /// Takes over an answer.
    pub fn set(&mut self, solution: &Solution) {
        let to_base = solution.disks.poses.first().map_or(Pose::IDENTITY, Pose::inverse);
        self.tensions.clear();
        self.tensions.extend(solution.cables.iter().map(|cable| cable.tension.unwrap_or(0.0)));
        self.disks.clear();
        self.disks.extend(solution.disks.poses.iter().map(|pose| to_base * *pose));
        self.base = solution.base_wrench;
        self.stable = !solution.diagnostics.is_unstable();
    }
}

/// Memory of a solve, and the answer it ends with.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch {
    /// Frames at the ends of all steps, the base first.
    pub poses: Vec<Pose>,
    /// By cable, in N and m.
    pub tensions: Vec<f64>,
    pub lengths: Vec<f64>,
    pub base_wrench: Wrench,
    /// The state of hole friction.
    pub(super) history: History<Vec<Node>>,
    /// Whether the last answer from cold is an equilibrium that the robot leaves, and no stable one was found.
    pub(super) unstable: bool,
    /// What the iterate leaves open at which the budget was spent; it is then in the place of the answer.
    pub(super) open: Option<Effort>,
    /// The state of the holes in the iteration.
    pub(super) friction: FrictionScratch,
    /// The substeps of the step of actuation, from 0 to 1; empty where they are not known.
    pub(super) schedule: Vec<f64>,
    pub(super) applied: AppliedLoads,
    pub(super) unloaded: Unloaded,
    pub(super) chain: Chain,
    /// Tension of every passage.
    pub(super) pulled: Vec<f64>,
    pub(super) stability: Stability,
    pub(super) samples: Vec<Sample>,
    pub(super) sampled: Vec<Pose>,
    pub(super) sampled_chords: Vec<Chord>,
    pub(super) applied_to_sample: AppliedLoads,
    pub(super) groups: Vec<usize>,
    /// What is held at its length, for stability; and how the disks are turned.
    pub(super) locked: Locked,
    pub(super) turned: Vec<UnitQuaternion>,
    length_by_tension: Vec<f64>,
    length_scratch: LengthScratch,
    /// The tensions where a search for lengths begins.
    first_tensions: Vec<f64>,
}

impl Scratch {
    /// What acts in the rod of the answer just beyond the disks, as [`crate::derivatives`] takes it.
    pub fn starts(&self, frame: &Frame, mesh: &Mesh) -> Vec<Option<Wrench>> {
        if self.applied.any() {
            return self.chain.starts(frame, mesh, &self.applied);
        }
        let Self { unloaded, pulled, poses, .. } = self;
        let mut starts = vec![None; mesh.grid.len()];
        for ((span, steps), wrench) in frame.spans.iter().zip(&mesh.spans).zip(&unloaded.wrenches) {
            let disk = poses[steps.start].rotation;
            let mut wrench = *wrench;
            let mut put = |node: usize, wrench: BodyWrench| {
                let position = match node - steps.start {
                    0 => Vec3::ZERO,
                    _ => unloaded.poses[node - 1].position,
                };
                let moment = wrench.angular - position.cross(wrench.linear);
                starts[node] =
                    Some(Wrench { force: disk.rotate(wrench.linear), moment: disk.rotate(moment) });
            };
            put(steps.start, wrench);
            for anchor in mesh.anchors_of(span) {
                let p = span.first + anchor.passage;
                let near = span.passages[anchor.passage].near;
                wrench = wrench + span::unit_pull(near, &unloaded.chords[p]) * pulled[p];
                put(anchor.node, wrench);
            }
        }
        starts
    }
}

/// Solves the problem under the loads that `scratch.applied` has gathered; the answer is left in
/// `scratch`.
pub(super) fn solve(
    problem: &Problem<'_>,
    start: Start<'_>,
    scratch: &mut Scratch,
) -> Result<Found, Failure> {
    scratch.unstable = false;
    if let Some(holes) = problem.holes {
        return friction::solve(problem, holes, matches!(start, Start::Coarser), scratch);
    }
    let cables = problem.commands.len();
    if !matches!(start, Start::Coarser) {
        scratch.tensions.clear();
        scratch.tensions.resize(cables, 0.0);
    }
    group(problem, scratch);
    if let Start::Near(neighbour) = start {
        for (tension, &given) in scratch.tensions.iter_mut().zip(&neighbour.tensions) {
            *tension = given.max(0.0);
        }
    }
    set_tensions(problem, scratch);
    if scratch.applied.any() {
        return load_continuation::solve(problem, start, scratch);
    }
    let mut rod = Rod::new(problem, scratch);
    if matches!(start, Start::Coarser) {
        rod.from = unloaded::From::Coarser;
    }
    let mut tensions = core::mem::take(&mut rod.scratch.tensions);
    let effort = rod.converge(&mut tensions)?;
    let found = rod.finish(tensions, Found::with(effort));
    if matches!(start, Start::Coarser) || problem.stability == StabilityAnalysis::Off {
        return Ok(found);
    }
    Ok(Found { lost_at: load_continuation::tensions_lost_at(problem, scratch), ..found })
}

/// Each passage has the tension of its cable.
fn group(problem: &Problem<'_>, scratch: &mut Scratch) {
    scratch.groups.clear();
    let passages = problem.frame.spans.iter().flat_map(|span| &span.passages);
    scratch.groups.extend(passages.map(|passage| passage.cable));
}

/// Puts the given tensions in their place.
fn set_tensions(problem: &Problem<'_>, scratch: &mut Scratch) {
    for (tension, command) in scratch.tensions.iter_mut().zip(problem.commands) {
        if let Command::Tension(given) = *command {
            *tension = given;
        }
    }
}

/// The robot without load as the start of a path under the loads that `scratch.applied` has gathered; `None` where
/// there is no load. Without friction.
pub(super) fn start_of_path(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
) -> Result<Option<State>, Failure> {
    scratch.unstable = false;
    scratch.tensions.clear();
    scratch.tensions.resize(problem.commands.len(), 0.0);
    group(problem, scratch);
    set_tensions(problem, scratch);
    load_continuation::start_without_load(problem, scratch)?;
    let Chain { nodes, tensions, .. } = &scratch.chain;
    let state = State { nodes: nodes.clone(), tensions: tensions.clone(), load: 0.0 };
    Ok(scratch.applied.any().then_some(state))
}

/// The robot as what answers tensions with a shape.
pub(super) struct Rod<'a> {
    problem: &'a Problem<'a>,
    scratch: &'a mut Scratch,
    /// What a sweep without load starts from.
    from: unloaded::From,
    /// Whether the loads count.
    loaded: bool,
    /// Whether the chain holds an equilibrium under all of the load.
    closed: bool,
    last_load: f64,
    iterations: usize,
    residual: f64,
}

impl<'a> Rod<'a> {
    pub fn new(problem: &'a Problem<'a>, scratch: &'a mut Scratch) -> Self {
        let (last_load, residual) = (0.0, 0.0);
        let from = unloaded::From::Nothing;
        let loaded = scratch.applied.any();
        let (closed, iterations) = (false, 0);
        Self { problem, scratch, from, loaded, closed, last_load, iterations, residual }
    }

    /// The robot as it would be without the loads.
    pub fn without_load(problem: &'a Problem<'a>, scratch: &'a mut Scratch) -> Self {
        Self { loaded: false, ..Self::new(problem, scratch) }
    }

    /// Finds the chain at these tensions from the robot without load.
    pub fn settle(&mut self, tensions: &[f64]) -> Result<(), Failure> {
        self.respond_with(tensions, false, false).map_err(|fault| self.failure(fault, tensions))?;
        let Problem { frame, mesh, .. } = *self.problem;
        let Scratch { chain, groups, unloaded, .. } = &mut *self.scratch;
        if !self.loaded {
            chain.pull(groups, tensions);
            chain.start(frame, mesh, &unloaded.wrenches, &unloaded.poses);
        }
        Ok(())
    }

    fn expand(&mut self, tensions: &[f64]) {
        let Scratch { pulled, groups, .. } = &mut *self.scratch;
        pulled.clear();
        pulled.extend(groups.iter().map(|&cable| tensions[cable]));
    }

    /// Finds the robot under its commands: at these tensions, or at those that its lengths need.
    pub fn converge(&mut self, tensions: &mut [f64]) -> Result<Effort, Failure> {
        if !self.problem.by_length() {
            return match self.respond_with(tensions, true, false) {
                Ok(()) => Ok(Effort { iterations: self.iterations, residual: self.residual }),
                Err(fault) => Err(self.failure(fault, tensions)),
            };
        }
        let commands = self.problem.commands;
        let meter = self.problem.meter;
        let length = self.problem.frame.rod.backbone().length;
        let given = Given { length, commands, bracket: true, meter };
        let mut start = core::mem::take(&mut self.scratch.first_tensions);
        start.clear();
        start.extend_from_slice(tensions);
        let mut memory = core::mem::take(&mut self.scratch.length_scratch);
        let mut solved = lengths::attempt(&given, tensions, self, &mut memory);
        if solved.is_err() {
            if let Some(effort) = self.together(&start, tensions) {
                (self.scratch.length_scratch, self.scratch.first_tensions) = (memory, start);
                return Ok(effort);
            }
            tensions.copy_from_slice(&start);
            solved = lengths::solve(&given, tensions, self, &mut memory);
        }
        (self.scratch.length_scratch, self.scratch.first_tensions) = (memory, start);
        solved.map_err(|fault| fault.failure(|fault| self.failure(fault, tensions)))
    }

    /// Lengths without load, for tensions and shape together. Where a span bears more than it buckles
    /// under, its straight path goes on, but the lengths are no longer those of a least energy, which is what
    /// [`lengths::solve`] takes them for. From `start`, and else with all lengths brought there from
    /// rest.
    fn together(&mut self, start: &[f64], tensions: &mut [f64]) -> Option<Effort> {
        if self.loaded || self.scratch.applied.any() {
            return None;
        }
        let Problem { frame, mesh, commands, .. } = *self.problem;
        let raise = Raise { problem: self.problem, commands, derivatives: false };
        let mut closed = None;
        if self.respond_with(start, true, false).is_ok() {
            let Scratch { chain, groups, unloaded, .. } = &mut *self.scratch;
            chain.pull(groups, start);
            chain.start(frame, mesh, &unloaded.wrenches, &unloaded.poses);
            closed = raise.newton(self.scratch, 1.0, false).ok();
        }
        let effort = closed.or_else(|| raise.all(self.scratch, false).ok())?;
        let Scratch { chain, unloaded, .. } = &mut *self.scratch;
        tensions.copy_from_slice(&chain.tensions);
        unloaded.adopt(chain, frame);
        self.from = unloaded::From::Neighbour;
        self.respond_with(tensions, true, false).ok()?;
        Some(effort)
    }

    fn respond_with(
        &mut self,
        tensions: &[f64],
        warm: bool,
        derivatives: bool,
    ) -> Result<(), Fault> {
        self.expand(tensions);
        if !self.loaded {
            let Problem { frame, mesh, meter, .. } = *self.problem;
            let Scratch { unloaded, pulled, .. } = &mut *self.scratch;
            use unloaded::From;
            let from = if warm || self.from == From::Coarser { self.from } else { From::Nothing };
            let swept = unloaded.sweep(frame, mesh, pulled, from, derivatives);
            // Each iteration of a span goes over its steps.
            meter
                .integrate(unloaded.iterations.max(1) * mesh.grid.len() / frame.spans.len().max(1));
            if swept.is_err() {
                self.last_load = unloaded.reached;
            }
            if swept.is_err() || self.from == From::Nothing {
                self.from = From::Neighbour;
            }
            swept?;
            self.iterations = 0;
        } else {
            self.under_load(tensions, warm, derivatives)?;
        }
        self.gather(tensions.len(), derivatives);
        Ok(())
    }

    /// Under loads: from the chain as it stands, from the robot without load, or raising the load.
    fn under_load(&mut self, tensions: &[f64], warm: bool, derivatives: bool) -> Result<(), Fault> {
        let Scratch { chain, groups, .. } = &mut *self.scratch;
        chain.pull(groups, tensions);
        let raise = Raise { problem: self.problem, commands: &[], derivatives };
        if self.closed && warm {
            self.scratch.chain.trace.stage = Stage::Warm;
            match raise.newton(self.scratch, 1.0, false) {
                Ok(effort) => {
                    self.iterations += effort.iterations;
                    self.residual = effort.residual;
                    return Ok(());
                }
                Err(_) => self.closed = false,
            }
        }
        if !self.closed {
            let Problem { frame, mesh, .. } = *self.problem;
            let Scratch { unloaded, pulled, chain, .. } = &mut *self.scratch;
            unloaded.sweep(frame, mesh, pulled, unloaded::From::Nothing, false)?;
            chain.start(frame, mesh, &unloaded.wrenches, &unloaded.poses);
            let raised = raise.load(self.scratch);
            self.closed = raised.is_ok();
            let effort = raised.map_err(|ended| {
                (self.last_load, self.residual) = (ended.load, ended.residual);
                ended.fault
            })?;
            self.iterations += effort.iterations;
            self.residual = effort.residual;
        }
        Ok(())
    }

    /// Lengths and derivatives of the cables from those of the passages.
    fn gather(&mut self, cables: usize, derivatives: bool) {
        let loaded = self.loaded;
        let Scratch { unloaded, chain, groups, lengths, length_by_tension, .. } =
            &mut *self.scratch;
        let chords = if loaded { &chain.chords } else { &unloaded.chords };
        lengths.clear();
        lengths.resize(cables, 0.0);
        for (chord, &cable) in chords.iter().zip(&*groups) {
            lengths[cable] += chord.length;
        }
        if !derivatives {
            return;
        }
        if loaded {
            length_by_tension.clone_from(&chain.length_by_tension);
            return;
        }
        length_by_tension.clear();
        length_by_tension.resize(cables * cables, 0.0);
        let mut rest = &unloaded.length_by_tension[..];
        for span in &self.problem.frame.spans {
            let of = &groups[span.first..span.first + span.passages.len()];
            for &i in of {
                for &j in of {
                    length_by_tension[i * cables + j] += rest[0];
                    rest = &rest[1..];
                }
            }
        }
    }

    /// Copies the answer out.
    fn finish(self, tensions: Vec<f64>, found: Found) -> Found {
        copy_out(self.problem, self.scratch);
        self.scratch.tensions = tensions;
        found
    }

    pub fn failure(&self, fault: Fault, tensions: &[f64]) -> Failure {
        let of_cable = |cable: usize| {
            let spans = self.problem.frame.spans.iter().flat_map(|span| &span.passages);
            let own = spans.zip(&self.scratch.groups).filter(|(p, _)| p.cable == cable);
            own.map(|(_, &group)| tensions[group]).fold(0.0, f64::max)
        };
        match fault.kind {
            SectionFault::Folded { cable } => Failure::Folds {
                cable,
                arc_length: fault.arc_length,
                tension: of_cable(cable),
                last_load: self.last_load,
            },
            SectionFault::Diverged => Failure::NotConverged {
                iterations: self.iterations,
                residual: self.residual,
                last_load: self.last_load,
                advice: PATH_ENDS,
            },
        }
    }
}

/// Frames from base to tip and what the base bears, from the spans of the answer.
pub(super) fn copy_out(problem: &Problem<'_>, scratch: &mut Scratch) {
    let loaded = scratch.applied.any();
    let relative = if loaded { &scratch.chain.poses } else { &scratch.unloaded.poses };
    scratch.poses.clear();
    scratch.poses.push(Pose::IDENTITY);
    let mut disk = Pose::IDENTITY;
    for steps in &problem.mesh.spans {
        for k in steps.clone() {
            scratch.poses.push(disk * relative[k]);
        }
        disk = disk * relative[steps.end - 1];
    }
    scratch.base_wrench = match scratch.chain.nodes.first() {
        Some(node) if loaded => {
            Wrench { force: scratch.applied.base_force() + node.force, moment: node.moment }
        }
        _ => Wrench::default(),
    };
}

impl TensionResponse for Rod<'_> {
    fn respond(&mut self, tensions: &[f64], warm: bool) -> Result<(), Fault> {
        self.respond_with(tensions, warm, true)
    }

    fn lengths(&self) -> &[f64] {
        &self.scratch.lengths
    }

    fn length_by_tension(&self) -> &[f64] {
        &self.scratch.length_by_tension
    }

    fn note(&mut self, note: &Note, tensions: &[f64]) {
        let load = if self.loaded { 1.0 } else { 0.0 };
        let trace = &mut self.scratch.chain.trace;
        trace.steps = self.problem.mesh.grid.len();
        trace.of_lengths(load, note, tensions);
    }
}
