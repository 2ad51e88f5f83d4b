//! Static equilibrium on one mesh: of the robot without load, under loads, for tensions or lengths.

use whipcord_numerics::Pose;

use super::chain::{Chain, Open, Scales, Task};
use super::friction::{self, History, Holes};
use super::layout::{Frame, Mesh};
use super::rod::Sample;
use super::stability::Stability;
use super::unloaded::Unloaded;
use crate::cosserat::command::Command;
use crate::cosserat::lengths::{self, Effort, Given, LengthFault, LengthScratch, Responds};
use crate::cosserat::loads::AppliedLoads;
use crate::cosserat::outcome::{Failure, Found};
use crate::cosserat::section::SectionFault;
use crate::cosserat::unloaded::Fault;
use crate::shape::Wrench;

/// What is to be solved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Problem<'a> {
    pub frame: &'a Frame,
    pub mesh: &'a Mesh,
    /// By cable.
    pub commands: &'a [Command],
    pub tolerance: f64,
    /// Where a cable rubs.
    pub holes: Option<&'a Holes>,
}

/// Where the iteration starts.
#[derive(Clone, Debug)]
pub(super) enum Start {
    /// From the robot without load.
    Cold,
    /// From a neighbouring answer: tensions by cable, disks, and what the base exerts.
    From { tensions: Vec<f64>, disks: Vec<Pose>, base: Option<Wrench> },
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
    /// What the holes remember, where a cable rubs.
    pub(super) history: History,
    pub(super) applied: AppliedLoads,
    pub(super) unloaded: Unloaded,
    pub(super) chain: Chain,
    /// Tension of every passage.
    pub(super) pulled: Vec<f64>,
    stability: Stability,
    samples: Vec<Sample>,
    groups: Vec<usize>,
    length_by_tension: Vec<f64>,
    length_scratch: LengthScratch,
}

/// The load is raised by at least this fraction, or the path is given up.
const LEAST_LOAD_STEP: f64 = 1.0 / 4096.0;
const FIRST_LOAD_STEP: f64 = 0.25;
const SHORT_ITERATION: usize = 5;
const PATH_ENDS: &str = "no equilibrium near it was found at more load, as at a snap-through: apply less load, or lead the robot there by other tensions first";
const CONTRADICTORY: &str =
    "the cable lengths contradict one another: prescribe fewer of them, or check them";

/// Solves the problem under the loads that `scratch.applied` has gathered; the answer is left in
/// `scratch`.
pub(super) fn solve(
    problem: &Problem<'_>,
    start: &Start,
    scratch: &mut Scratch,
) -> Result<Found, Failure> {
    if let Some(holes) = problem.holes {
        return with_friction(problem, holes, scratch);
    }
    let cables = problem.commands.len();
    scratch.tensions.clear();
    scratch.tensions.resize(cables, 0.0);
    scratch.groups.clear();
    let passages = problem.frame.spans.iter().flat_map(|span| &span.passages);
    scratch.groups.extend(passages.map(|passage| passage.cable));
    if let Start::From { tensions, .. } = start {
        for (tension, &given) in scratch.tensions.iter_mut().zip(tensions) {
            *tension = given.max(0.0);
        }
    }
    for (tension, command) in scratch.tensions.iter_mut().zip(problem.commands) {
        if let Command::Tension(given) = *command {
            *tension = given;
        }
    }
    let by_length = problem.commands.iter().any(|c| matches!(c, Command::Length { .. }));
    let mut tensions = scratch.tensions.clone();
    let mut rod = Rod::new(problem, scratch, cables);
    if let Start::From { disks, base: Some(base), .. } = start
        && rod.scratch.applied.any()
    {
        rod.start_from(&tensions, disks, *base);
    }
    if !by_length {
        rod.equilibrium(&tensions, false)?;
        let (iterations, residual) = (rod.iterations, rod.residual);
        return Ok(rod.finish(tensions, Found::with(Effort { iterations, residual })));
    }
    let given = Given {
        length: problem.frame.rod.backbone().length,
        commands: problem.commands,
        bracket: true,
    };
    let mut memory = core::mem::take(&mut rod.scratch.length_scratch);
    let solved = lengths::solve(&given, &mut tensions, &mut rod, &mut memory);
    rod.scratch.length_scratch = memory;
    match solved {
        Ok(effort) => {
            let effort = Effort {
                iterations: effort.iterations + rod.iterations,
                residual: effort.residual.max(rod.residual),
            };
            Ok(rod.finish(tensions, Found::with(effort)))
        }
        Err(LengthFault::Section(fault)) => Err(rod.failure(fault, &tensions)),
        Err(LengthFault::Unreachable { cable, length }) => {
            Err(Failure::Unreachable { cable, length })
        }
        Err(LengthFault::Stalled { residual }) => Err(Failure::NotConverged {
            iterations: rod.iterations,
            residual,
            last_load: 0.0,
            advice: CONTRADICTORY,
        }),
    }
}

/// Stability of the answer in `scratch`: `None` under loads that follow the body, which have no
/// energy, with friction, and where lengths are held that the tensions alone would not hold.
pub(super) fn least_eigenvalue(problem: &Problem<'_>, scratch: &mut Scratch) -> Option<f64> {
    if scratch.applied.any_follower() || problem.holes.is_some() {
        return None;
    }
    let Scratch { applied, unloaded, chain, stability, samples, pulled, .. } = scratch;
    let (samples, chords) = if applied.any() {
        (&chain.samples, &chain.chords)
    } else {
        unloaded.sample(problem.mesh, samples);
        (&*samples, &unloaded.chords)
    };
    let least = stability.least_eigenvalue(problem.frame, problem.mesh, samples, chords, pulled)?;
    let held = problem.commands.iter().any(|c| matches!(c, Command::Length { .. }));
    (least >= 0.0 || !held).then_some(least)
}

/// One step of actuation on from what the holes remember.
fn with_friction(
    problem: &Problem<'_>,
    holes: &Holes,
    scratch: &mut Scratch,
) -> Result<Found, Failure> {
    scratch.groups.clear();
    scratch.groups.extend(0..problem.frame.passages);
    let mut history = core::mem::take(&mut scratch.history);
    let mut rod = Rod::new(problem, scratch, problem.frame.passages);
    let found = friction::step(&mut rod, holes, problem.commands, &mut history)?;
    let lengths = rod.scratch.lengths.clone();
    let found = rod.finish(history.base.clone(), found);
    scratch.lengths.clear();
    let of_cable = |passages: &Vec<usize>| passages.iter().map(|&p| lengths[p]).sum::<f64>();
    scratch.lengths.extend(holes.of_cable.iter().map(of_cable));
    scratch.history = history;
    Ok(found)
}

/// The robot as what answers tensions with a shape.
pub(super) struct Rod<'a> {
    problem: &'a Problem<'a>,
    scratch: &'a mut Scratch,
    /// How many tensions there are: one for each cable, or for each passage.
    count: usize,
    /// Whether the chain holds an equilibrium under all of the load.
    closed: bool,
    last_load: f64,
    iterations: usize,
    residual: f64,
}

impl<'a> Rod<'a> {
    fn new(problem: &'a Problem<'a>, scratch: &'a mut Scratch, count: usize) -> Self {
        let (last_load, residual) = (0.0, 0.0);
        Self { problem, scratch, count, closed: false, last_load, iterations: 0, residual }
    }

    /// Of the backbone, in m.
    pub fn length(&self) -> f64 {
        self.problem.frame.rod.backbone().length
    }

    /// By how much a tension of 1 N shortens a cable, in m: its order of magnitude.
    pub fn compliance_scale(&self) -> f64 {
        let length = self.length();
        let lever = (self.problem.frame.spans.iter())
            .flat_map(|span| &span.passages)
            .map(|passage| passage.near.norm())
            .fold(1e-3 * length, f64::max);
        let force = Scales::of(self.problem.frame, self.problem.mesh).force;
        lever * lever / (force * length)
    }

    /// `φ` at the near hole of every passage.
    pub fn turns(&self, holes: &Holes) -> Vec<f64> {
        let Problem { frame, mesh, .. } = *self.problem;
        let Scratch { applied, chain, unloaded, .. } = &*self.scratch;
        let (poses, chords) = if applied.any() {
            (&chain.poses, &chain.chords)
        } else {
            (&unloaded.poses, &unloaded.chords)
        };
        let spans: Vec<Pose> = mesh.spans.iter().map(|steps| poses[steps.end - 1]).collect();
        friction::turns(frame, holes, &spans, chords)
    }

    fn expand(&mut self, tensions: &[f64]) {
        let Scratch { pulled, groups, .. } = &mut *self.scratch;
        pulled.clear();
        pulled.extend(groups.iter().map(|&cable| tensions[cable]));
    }

    fn start_from(&mut self, tensions: &[f64], disks: &[Pose], base: Wrench) {
        if disks.len() != self.problem.frame.spans.len() + 1 {
            return;
        }
        self.expand(tensions);
        let Scratch { applied, chain, pulled, .. } = &mut *self.scratch;
        let task = task(self.problem, applied, pulled, (&[], 0), 1.0);
        chain.start_from(&task, disks, base);
        self.closed = true;
    }

    /// Finds the equilibrium under these tensions by cable.
    fn equilibrium(&mut self, tensions: &[f64], derivatives: bool) -> Result<(), Failure> {
        self.respond_with(tensions, true, derivatives)
            .map_err(|fault| self.failure(fault, tensions))
    }

    fn respond_with(
        &mut self,
        tensions: &[f64],
        warm: bool,
        derivatives: bool,
    ) -> Result<(), Fault> {
        self.expand(tensions);
        if !self.scratch.applied.any() {
            let Problem { frame, mesh, .. } = *self.problem;
            let Scratch { unloaded, pulled, .. } = &mut *self.scratch;
            unloaded.sweep(frame, mesh, pulled, warm, derivatives)?;
            self.iterations = 0;
        } else {
            self.loaded(warm, derivatives)?;
        }
        self.gather(tensions.len(), derivatives);
        Ok(())
    }

    /// Under loads: from the chain as it stands, from the robot without load, or raising the load.
    fn loaded(&mut self, warm: bool, derivatives: bool) -> Result<(), Fault> {
        let Problem { frame, mesh, .. } = *self.problem;
        let groups = if derivatives { self.scratch.groups.clone() } else { Vec::new() };
        if warm && self.closed && self.close(1.0, &groups).is_ok() {
            return Ok(());
        }
        self.closed = false;
        self.last_load = 0.0;
        let Scratch { unloaded, pulled, chain, .. } = &mut *self.scratch;
        unloaded.sweep(frame, mesh, pulled, false, false)?;
        chain.start(frame, mesh, &unloaded.wrenches, &unloaded.poses);
        let rest = chain.nodes.clone();
        if self.close(1.0, &groups).is_ok() {
            self.closed = true;
            return Ok(());
        }
        let (mut here, mut load, mut step) = (rest, 0.0, FIRST_LOAD_STEP);
        loop {
            let next = f64::min(load + step, 1.0);
            self.scratch.chain.nodes.clone_from(&here);
            match self.close(next, &groups) {
                Ok(_) if next >= 1.0 => {
                    self.closed = true;
                    return Ok(());
                }
                Ok(iterations) => {
                    here.clone_from(&self.scratch.chain.nodes);
                    load = next;
                    self.last_load = load;
                    if iterations <= SHORT_ITERATION {
                        step *= 2.0;
                    }
                }
                Err(open) => {
                    step *= 0.5;
                    if step < LEAST_LOAD_STEP {
                        self.residual = if open.gap.is_finite() { open.gap } else { 1.0 };
                        let none = Fault { kind: SectionFault::Diverged, arc_length: 0.0 };
                        return Err(open.fault.unwrap_or(none));
                    }
                }
            }
        }
    }

    fn close(&mut self, load: f64, groups: &[usize]) -> Result<usize, Open> {
        let Scratch { applied, chain, pulled, .. } = &mut *self.scratch;
        let task = task(self.problem, applied, pulled, (groups, self.count), load);
        let closed = chain.close(&task);
        let (iterations, gap) = match &closed {
            Ok((iterations, gap)) => (*iterations, *gap),
            Err(open) => (open.iterations, open.gap),
        };
        self.iterations += iterations;
        self.residual = gap;
        closed.map(|(iterations, _)| iterations)
    }

    /// Lengths and derivatives of the cables from those of the passages.
    fn gather(&mut self, cables: usize, derivatives: bool) {
        let loaded = self.scratch.applied.any();
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
        let Problem { mesh, .. } = *self.problem;
        let loaded = self.scratch.applied.any();
        let scratch = self.scratch;
        let relative = if loaded { &scratch.chain.poses } else { &scratch.unloaded.poses };
        scratch.poses.clear();
        scratch.poses.push(Pose::IDENTITY);
        let mut disk = Pose::IDENTITY;
        for steps in &mesh.spans {
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
        scratch.tensions = tensions;
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

fn task<'a>(
    problem: &Problem<'a>,
    loads: &'a AppliedLoads,
    tensions: &'a [f64],
    (groups, group_count): (&'a [usize], usize),
    load: f64,
) -> Task<'a> {
    Task {
        frame: problem.frame,
        mesh: problem.mesh,
        loads,
        tensions,
        load,
        groups,
        group_count,
        tolerance: problem.tolerance,
    }
}

impl Responds for Rod<'_> {
    fn respond(&mut self, tensions: &[f64], warm: bool) -> Result<(), Fault> {
        self.respond_with(tensions, warm, true)
    }

    fn lengths(&self) -> &[f64] {
        &self.scratch.lengths
    }

    fn length_by_tension(&self) -> &[f64] {
        &self.scratch.length_by_tension
    }
}
