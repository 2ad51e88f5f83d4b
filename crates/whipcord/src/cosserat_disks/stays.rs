//! Whether the robot stays in an answer: what is sampled of it, and what holds it.

use whipcord_numerics::Pose;

use super::chain::Scales;
use super::friction::{self, Holes};
use super::joint::Chord;
use super::layout::Mesh;
use super::rod::{self, InSpan};
use super::stability::{Equilibrium, Locked};
use super::statics::{Problem, Scratch};
use crate::case::Case;
use crate::cosserat::command::Command;
use crate::shape::Contact;

/// A hole that is so near to letting the cable slide, of its grip, counts as sliding.
const SLIPS: f64 = 1e-6;

/// Stability of the answer in `scratch`, which is on the mesh `answered`, sampled on that of the problem,
/// which may be coarser: `None` under loads that follow the body, which have no energy, and where a cable
/// slides that rubs.
pub(super) fn least_eigenvalue(
    problem: &Problem<'_>,
    answered: &Mesh,
    case: &Case,
    scratch: &mut Scratch,
) -> Option<f64> {
    if scratch.applied.any_follower() {
        return None;
    }
    let Problem { frame, mesh, .. } = *problem;
    let loaded = scratch.applied.any();
    let Scratch { applied_to_sample: applied, unloaded, chain, samples, sampled, .. } =
        &mut *scratch;
    if loaded {
        applied.gather(&mesh.grid, &case.loads, case.base.rotation);
        let turned = |k: usize| chain.nodes[k].rotation;
        let inside = |k: usize| InSpan::at(applied, 1.0, turned(k), mesh.spans[k].start);
        rod::sample(mesh, |k| chain.nodes[k].wrench, |k| Some(inside(k)), samples, sampled);
    } else {
        rod::sample(mesh, |k| unloaded.wrenches[k], |_| None, samples, sampled);
    }
    // The tensions obey eq. (5) with the turns of the answer's own mesh.
    let own = Problem { mesh: answered, ..*problem };
    let turned = problem.holes.map_or_else(Vec::new, |holes| {
        let Scratch { chain, unloaded, .. } = &*scratch;
        if loaded {
            turns(&own, holes, &chain.poses, &chain.chords)
        } else {
            turns(&own, holes, &unloaded.poses, &unloaded.chords)
        }
    });
    let locked = locked(problem, scratch, &turned)?;
    let scale = compliance_scale(problem);
    let chords = if loaded { &scratch.chain.chords } else { &scratch.unloaded.chords };
    let Scratch { stability, samples, pulled, .. } = scratch;
    let at = Equilibrium { frame, mesh, samples, chords, tensions: pulled, scale };
    stability.least_eigenvalue(&at, locked)
}

/// Whether the robot stays in the equilibrium that the chain holds under dead loads and without
/// friction.
pub(super) fn is_stable(problem: &Problem<'_>, scratch: &mut Scratch) -> Option<bool> {
    let Problem { frame, mesh, .. } = *problem;
    let Scratch { chain, stability, .. } = scratch;
    let locked = held_lengths(problem, &chain.tensions);
    let at = Equilibrium {
        frame,
        mesh,
        samples: &chain.samples,
        chords: &chain.chords,
        tensions: &chain.pulled,
        scale: compliance_scale(problem),
    };
    stability.is_stable(&at, locked)
}

/// What keeps its length however the robot moves a little: taut cables that are driven by it and do
/// not rub, and the pieces of those that rub and stick in all their holes, well within eq. (5). `None`
/// where a cable slid in a hole, and where a hole is about to let the cable slide, if only one way: its tensions then change with the
/// turns, and the way it slides with the motion.
fn locked(problem: &Problem<'_>, scratch: &Scratch, turns: &[f64]) -> Option<Locked> {
    let rubs = |cable: usize| problem.holes.is_some_and(|holes| holes.coefficients[cable] > 0.0);
    let mut locked = held_lengths(problem, &scratch.tensions);
    for span in &problem.frame.spans {
        for (i, passage) in span.passages.iter().enumerate() {
            let p = span.first + i;
            if let Some(holes) = problem.holes.filter(|_| rubs(passage.cable))
                && scratch.pulled[p] > 0.0
            {
                let cable = passage.cable;
                let place = holes.of_cable[cable].iter().position(|&of| of == p)?;
                let incoming = match (place.checked_sub(1), problem.commands[cable]) {
                    (Some(before), _) => scratch.pulled[holes.of_cable[cable][before]],
                    (None, Command::Tension(given)) => given,
                    // What winds the cable up holds it, whatever the base hole does.
                    (None, Command::Length { .. }) => scratch.pulled[p],
                };
                let grip = holes.coefficients[cable] * turns[p];
                let held = matches!((place, problem.commands[cable]), (0, Command::Length { .. }));
                let slid = scratch.history.contacts[p] != Contact::Sticks;
                let slips = (scratch.pulled[p] / incoming).ln().abs() >= (1.0 - SLIPS) * grip;
                if !held && (slid || slips) {
                    return None;
                }
                locked.of_passage[p] = Some(locked.compliances.len());
                locked.compliances.push(holes.yielding[p]);
            }
        }
    }
    Some(locked)
}

/// The taut cables that are driven by their length and do not rub.
fn held_lengths(problem: &Problem<'_>, tensions: &[f64]) -> Locked {
    let mut locked = Locked::default();
    let rubs = |cable: usize| problem.holes.is_some_and(|holes| holes.coefficients[cable] > 0.0);
    let mut of_cable = vec![None; problem.commands.len()];
    for (cable, (command, &tension)) in problem.commands.iter().zip(tensions).enumerate() {
        if let Command::Length { compliance, .. } = *command
            && tension > 0.0
            && !rubs(cable)
        {
            of_cable[cable] = Some(locked.compliances.len());
            locked.compliances.push(compliance);
        }
    }
    let passages = problem.frame.spans.iter().flat_map(|span| &span.passages);
    locked.of_passage.extend(passages.map(|passage| of_cable[passage.cable]));
    locked
}

/// `φ` at the near hole of every passage, from the poses at the ends of the steps of the mesh.
pub(super) fn turns(
    problem: &Problem<'_>,
    holes: &Holes,
    poses: &[Pose],
    chords: &[Chord],
) -> Vec<f64> {
    let Problem { frame, mesh, .. } = *problem;
    let spans: Vec<Pose> = mesh.spans.iter().map(|steps| poses[steps.end - 1]).collect();
    friction::turns(frame, holes, &spans, chords)
}

/// By how much a tension of 1 N shortens a cable, in m: its order of magnitude.
pub(super) fn compliance_scale(problem: &Problem<'_>) -> f64 {
    let length = problem.frame.rod.backbone().length;
    let lever = (problem.frame.spans.iter())
        .flat_map(|span| &span.passages)
        .map(|passage| passage.near.norm())
        .fold(1e-3 * length, f64::max);
    let force = Scales::of(problem.frame, problem.mesh).force;
    lever * lever / (force * length)
}
