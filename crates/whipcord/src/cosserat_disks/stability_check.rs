//! The stability check of an answer: its sampled sections, and the cables that hold it.

use super::chain::Chain;
use super::chord::Chord;
use super::layout::{Frame, Mesh};
use super::problem::Problem;
use super::problem::Sampled;
use super::rod::{self, InSpan};
use super::scratch::Scratch;
use super::stability::{Equilibrium, Locked, Stability};
use super::workspace::Workspace;
use crate::section::BodyWrench;
use crate::solution::{Diagnostics, NoStability, Verdict};
use crate::statics::command::Command;
use crate::statics::friction::{Holes, Slides};
use crate::statics::options::StabilityAnalysis;
use crate::statics::self_stress::is_idle;

/// Stability of the answer in `scratch`, which is on the mesh of the problem, or why it is not known: loads that
/// follow the body have no energy, and a cable that slides in a hole has no potential. The least eigenvalue is computed
/// where it is asked for, and where it decides.
pub(super) fn stability(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
) -> Result<Verdict, NoStability> {
    let mut locked = core::mem::take(&mut scratch.locked);
    let verdict = verdict(problem, scratch, &mut locked);
    scratch.locked = locked;
    verdict
}

fn verdict(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    locked: &mut Locked,
) -> Result<Verdict, NoStability> {
    if problem.stability == StabilityAnalysis::Off {
        return Err(NoStability::NotAsked);
    }
    if scratch.applied.any_follower() {
        return Err(NoStability::Followers);
    }
    let loaded = scratch.applied.any();
    held_lengths(&Driven::of(problem), &scratch.tensions, &scratch.lengths, locked);
    if let Some(holes) = problem.holes {
        let Scratch { friction, history, .. } = &*scratch;
        let lock = |p: usize, compliance: f64| {
            locked.of_passage[p] = Some(locked.compliances.len());
            locked.compliances.push(compliance);
            locked.idle.push(false);
        };
        let locks = holes.lock(problem.commands, &friction.at.turns, history, lock);
        locks.map_err(|Slides| NoStability::Sliding)?;
    }
    let locked = &*locked;
    let mesh = problem.sampled.mesh(|k| compressed(scratch, loaded, k));
    if problem.stability == StabilityAnalysis::Verdict {
        let is_stable = match loaded {
            true => on_mesh(problem, mesh, loaded, scratch, |stability, at| {
                stability.is_clearly_stable(at, locked)
            }),
            false => is_above_when_held(problem, Diagnostics::NEAR_CRITICAL, locked, scratch),
        };
        if is_stable == Some(true) {
            return Ok(Verdict::STABLE);
        }
    }
    let value = on_mesh(problem, mesh, loaded, scratch, |stability, at| {
        stability.least_eigenvalue(at, locked)
    });
    if value.is_ok_and(|value| value.abs() < NEARLY)
        && let Ok(finest) = problem.frame.mesh(mesh.spans.len(), FINEST)
    {
        let value = on_mesh(problem, &finest, loaded, scratch, |stability, at| {
            stability.least_eigenvalue(at, locked)
        });
        return value.map(Verdict::of_eigenvalue);
    }
    value.map(Verdict::of_eigenvalue)
}

/// What is asked of the answer sampled on a mesh.
fn on_mesh<T>(
    problem: &Problem<'_>,
    mesh: &Mesh,
    loaded: bool,
    scratch: &mut Scratch,
    ask: impl FnOnce(&mut Stability, &Equilibrium<'_>) -> T,
) -> T {
    sample(problem, mesh, 1.0, loaded, scratch);
    let scale = problem.frame.compliance(problem.mesh);
    scratch.turned.clear();
    scratch.turned.extend(scratch.chain.nodes.iter().map(|node| node.rotation));
    let chords = if loaded { &scratch.chain.chords } else { &scratch.unloaded.chords };
    let Scratch { stability, samples, pulled, turned, applied_to_sample: applied, .. } = scratch;
    let moments = (loaded && applied.any_dead_moment()).then_some((&*applied, &turned[..]));
    let (frame, tensions) = (problem.frame, &pulled[..]);
    ask(stability, &Equilibrium { frame, mesh, samples, chords, tensions, scale, moments })
}

/// Whether the equilibrium is stable that the chain holds under this part of its dead loads and without
/// friction.
pub(super) fn is_stable(problem: &Problem<'_>, load: f64, scratch: &mut Scratch) -> Option<bool> {
    is_above(problem, -Diagnostics::NEUTRAL, load, scratch)
}

/// Whether the chain holds an equilibrium under all of the load that is stable as far as a coarse mesh can tell: a
/// round rod that has buckled is neutral about its axis.
pub(super) fn is_nearly_stable(problem: &Problem<'_>, scratch: &mut Scratch) -> Option<bool> {
    is_above(problem, -NEARLY, 1.0, scratch)
}

fn is_above(problem: &Problem<'_>, bound: f64, load: f64, scratch: &mut Scratch) -> Option<bool> {
    let mut locked = core::mem::take(&mut scratch.locked);
    let Scratch { chain, .. } = &*scratch;
    held_lengths(&Driven::of(problem), &chain.tensions, &chain.lengths, &mut locked);
    let above = is_above_with(problem, bound, load, scratch, &locked);
    scratch.locked = locked;
    above
}

/// The same with these cables held.
fn is_above_with(
    problem: &Problem<'_>,
    bound: f64,
    load: f64,
    scratch: &mut Scratch,
    locked: &Locked,
) -> Option<bool> {
    let Problem { frame, mesh, .. } = *problem;
    let scale = problem.frame.compliance(problem.mesh);
    let fine = problem.sampled.mesh(|k| compressed(scratch, true, k));
    let own_is_fine = mesh.grid.len() >= fine.grid.len();
    let Scratch { chain, stability, .. } = &mut *scratch;
    let at = Equilibrium {
        frame,
        mesh,
        samples: &chain.samples,
        chords: &chain.chords,
        tensions: &chain.pulled,
        scale,
        moments: None,
    };
    if own_is_fine {
        return stability.is_above(bound, &at, locked);
    }
    if !is_compressed(mesh, |k| chain.nodes[k].wrench)
        && stability.is_above(CLEARLY, &at, locked)?
    {
        return Some(true);
    }
    sample(problem, fine, load, true, scratch);
    let Scratch { chain, stability, samples, .. } = scratch;
    let (chords, tensions) = (&chain.chords[..], &chain.pulled[..]);
    let at = Equilibrium { frame, mesh: fine, samples, chords, tensions, scale, moments: None };
    stability.is_above(bound, &at, locked)
}

/// The number of directions in which the equilibrium is unstable that the chain holds under this part of its dead loads
/// and without friction; always on steps as fine as these, so that it does not change with them along a path.
pub(super) fn unstable_directions(
    problem: &Problem<'_>,
    load: f64,
    scratch: &mut Scratch,
) -> Option<usize> {
    let Problem { frame, mesh, .. } = *problem;
    let scale = problem.frame.compliance(problem.mesh);
    let fine = problem.sampled.fine;
    let mut locked = core::mem::take(&mut scratch.locked);
    let Chain { tensions, lengths, .. } = &scratch.chain;
    held_lengths(&Driven::of(problem), tensions, lengths, &mut locked);
    let own_is_fine = mesh.grid.len() >= fine.grid.len();
    if !own_is_fine {
        sample(problem, fine, load, true, scratch);
    }
    let Scratch { chain, stability, samples, .. } = scratch;
    let (mesh, samples) = if own_is_fine { (mesh, &chain.samples) } else { (fine, &*samples) };
    let (chords, tensions) = (&chain.chords[..], &chain.pulled[..]);
    let at = Equilibrium { frame, mesh, samples, chords, tensions, scale, moments: None };
    let below = stability.below(-Diagnostics::NEUTRAL, &at, &locked);
    scratch.locked = locked;
    below
}

/// The same of a chain without friction on a mesh of its own, which was measured under dead loads that the workspace has
/// gathered. Dead moments count by the symmetric part of their tangent.
pub(super) fn unstable_directions_of(
    (frame, mesh): (&Frame, &Mesh),
    chain: &Chain,
    workspace: &mut Workspace,
) -> Option<usize> {
    let Workspace { scratch, commands, .. } = workspace;
    let Scratch { stability, locked, .. } = scratch;
    let Chain { samples, chords, pulled: tensions, .. } = chain;
    held_lengths(&Driven { frame, commands, holes: None }, &chain.tensions, &chain.lengths, locked);
    let scale = frame.compliance(mesh);
    let at = Equilibrium { frame, mesh, samples, chords, tensions, scale, moments: None };
    stability.below(-Diagnostics::NEUTRAL, &at, locked)
}

/// Whether the equilibrium without load that was found last is stable, as far as its spans may buckle
/// under their cables: whether no eigenvalue is less than a bound.
pub(super) fn is_above_without_load(
    problem: &Problem<'_>,
    bound: f64,
    scratch: &mut Scratch,
) -> Option<bool> {
    let Scratch { unloaded, groups, pulled, lengths, .. } = &mut *scratch;
    // Before anything is allocated.
    if !may_buckle(problem.mesh, |k| unloaded.wrenches[k]) {
        return Some(true);
    }
    let mut tensions = vec![0.0; problem.commands.len()];
    for (&tension, &group) in pulled.iter().zip(&*groups) {
        tensions[group] = tension;
    }
    let mut locked = Locked::default();
    held_lengths(&Driven::of(problem), &tensions, lengths, &mut locked);
    is_above_when_held(problem, bound, &locked, scratch)
}

/// The same with these cables held.
fn is_above_when_held(
    problem: &Problem<'_>,
    bound: f64,
    locked: &Locked,
    scratch: &mut Scratch,
) -> Option<bool> {
    if !may_buckle(problem.mesh, |k| scratch.unloaded.wrenches[k]) {
        return Some(true);
    }
    let scale = problem.frame.compliance(problem.mesh);
    let mut above = |mesh: &Mesh, bound: f64| {
        sample(problem, mesh, 0.0, false, scratch);
        let Scratch { unloaded, stability, samples, pulled, .. } = &mut *scratch;
        let (frame, chords, tensions) = (problem.frame, &unloaded.chords[..], &pulled[..]);
        let at = Equilibrium { frame, mesh, samples, chords, tensions, scale, moments: None };
        stability.is_above(bound, &at, locked)
    };
    if above(problem.sampled.fine, CLEARLY)? {
        return Some(true);
    }
    let finest = problem.frame.mesh(problem.mesh.spans.len(), FINEST).ok()?;
    above(&finest, bound)
}

/// A span whose elements bear this much, in units of EI/h², has too few of them: a span that buckles under a
/// central cable bears `π²/16` with four.
const COMPRESSED: f64 = 0.63;
/// An eigenvalue no greater than this may have another sign on a finer mesh.
const NEARLY: f64 = 1e-3;
/// Such a one is computed with spans halved so often: a half wave in a span is then known to 1e-7.
const FINEST: usize = 5;
/// An equilibrium with no eigenvalue below this on a coarse mesh is stable on a fine one.
const CLEARLY: f64 = 0.05;
/// A span that bears less than this, in units of EI/ℓ², does not buckle under its cables.
const BEARS: f64 = 2.0;

/// Whether an element of a span bears so much of what would buckle it that more elements are needed.
fn is_compressed(mesh: &Mesh, wrench: impl Fn(usize) -> BodyWrench) -> bool {
    mesh.spans.iter().enumerate().any(|(k, steps)| {
        let steps = steps.clone();
        let longest = steps.map(|step| mesh.grid.steps[step].length).fold(0.0, f64::max);
        borne(mesh, k, &wrench(k), longest) > COMPRESSED
    })
}

/// Whether a span may buckle under its cables alone.
fn may_buckle(mesh: &Mesh, wrench: impl Fn(usize) -> BodyWrench) -> bool {
    mesh.spans.iter().enumerate().any(|(k, steps)| {
        let length = steps.clone().map(|step| mesh.grid.steps[step].length).sum();
        borne(mesh, k, &wrench(k), length) > BEARS
    })
}

/// The compression and the twisting moment at the start of span `k`, in units of what EI/h² and 2 EI/h are.
fn borne(mesh: &Mesh, k: usize, wrench: &BodyWrench, length: f64) -> f64 {
    let (node, _) = mesh.grid.shooting.at(mesh.spans[k].start, 0, 0);
    let bending = node.section.stiffness.bending;
    let stiffness = bending.x.min(bending.y);
    let twist = 0.5 * wrench.angular.z * length / stiffness;
    -wrench.linear.z * length * length / stiffness + twist * twist
}

/// What the rod of span `k` bears at its start.
fn compressed(scratch: &Scratch, loaded: bool, k: usize) -> BodyWrench {
    if loaded { scratch.chain.nodes[k].wrench } else { scratch.unloaded.wrenches[k] }
}

/// Samples the answer, or the chain under this part of the load, on a mesh.
fn sample(problem: &Problem<'_>, mesh: &Mesh, load: f64, loaded: bool, scratch: &mut Scratch) {
    let Scratch {
        applied_to_sample: applied,
        unloaded,
        chain,
        pulled,
        samples,
        sampled,
        sampled_chords: chords,
        ..
    } = scratch;
    let at = (problem.frame, mesh);
    chords.resize(problem.frame.passages, Chord::default());
    if loaded {
        applied.gather(&mesh.grid, &problem.case.loads, problem.case.base.rotation);
        let turned = |k: usize| chain.nodes[k].rotation;
        let inside = |k: usize| InSpan::at(applied, load, turned(k), mesh.spans[k].start);
        let wrench = |k: usize| chain.nodes[k].wrench;
        let inside = |k: usize| Some(inside(k));
        rod::sample(at, &chain.pulled, chords, wrench, inside, samples, sampled);
    } else {
        let wrench = |k: usize| unloaded.wrenches[k];
        rod::sample(at, pulled, chords, wrench, |_| None, samples, sampled);
    }
}

/// The cables of a robot and what drives them.
struct Driven<'a> {
    frame: &'a Frame,
    commands: &'a [Command],
    holes: Option<&'a Holes>,
}

impl<'a> Driven<'a> {
    fn of(problem: &Problem<'a>) -> Self {
        let Problem { frame, commands, holes, .. } = *problem;
        Self { frame, commands, holes }
    }
}

/// The cables that are driven by their length, are taut or at that length without tension, and do not rub.
fn held_lengths(cables: &Driven<'_>, tensions: &[f64], lengths: &[f64], locked: &mut Locked) {
    let Driven { frame, commands, holes } = *cables;
    locked.clear(commands.len());
    let has_friction = |cable: usize| holes.is_some_and(|holes| holes.coefficients[cable] > 0.0);
    let end = frame.rod.backbone().length;
    for (cable, (command, &tension)) in commands.iter().zip(tensions).enumerate() {
        if let Command::Length { compliance, .. } = *command
            && !has_friction(cable)
        {
            let slack = command.slackness(tension, lengths[cable]);
            let idle = tension <= 0.0;
            if !idle || is_idle(compliance, slack, end) {
                locked.of_cable[cable] = Some(locked.compliances.len());
                locked.compliances.push(compliance);
                locked.idle.push(idle);
            }
        }
    }
    let passages = frame.spans.iter().flat_map(|span| &span.passages);
    let Locked { of_cable, of_passage, .. } = locked;
    of_passage.extend(passages.map(|passage| of_cable[passage.cable]));
}

impl<'a> Sampled<'a> {
    /// The mesh for spans whose rods bear these wrenches at their start.
    fn mesh(&self, wrench: impl Fn(usize) -> BodyWrench) -> &'a Mesh {
        if is_compressed(self.usual, wrench) { self.fine } else { self.usual }
    }
}
