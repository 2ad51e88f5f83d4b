//! Cables under load that pull against one another to no effect.
//!
//! Where the backbone does not stretch, the lengths of two straight cables opposite one another leave their
//! common tension open, eq. (7) has no single answer, and the least deviation, as by twisting, asks for any
//! tension. Of all answers one with small tensions is meant, as without load. So those cables are made to give
//! a little first, and then as many of them as the others do without, those that pull least, are let go
//! altogether. What is left of their lengths they must have in play.

use super::problem::Problem;
use super::scratch::{Scratch, Start};
use super::statics::solve_independent;
use super::unloaded::SweepOptions;
use super::unloaded::Unloaded;
use super::without_load::start_without_load;
use crate::robot::Robot;
use crate::statics::command::Command;
use crate::statics::grid::Grid;
use crate::statics::outcome::{Failure, Found};
use crate::statics::rank::IndependentCables;
use crate::statics::scales::Scales;

/// A cable pulls independently of others when at least this part of its effect is its own: where the
/// backbone stretches ever so little it does, and where it does not all that is left is rounding.
const OWN: f64 = 1e-12;
/// Of the backbone's length: a cable without load that is this close to its length is no more slack than
/// taut.
const TOUCHES: f64 = 1e-9;
/// What a cable gives at first, in units of L³/EI: a steel wire does so, or more.
const GIVES: f64 = 1e-6;
/// Of the backbone's length, by which the length of a cable that is let go may be missed: a steel cable
/// stretches as much under 20 MPa.
const PLAY: f64 = 1e-4;

/// Whether the backbone does not stretch and some of the robot's cables, none of them elastic, pull to no
/// effect of their own when it is at rest; on any grid, with the cables in this order.
pub(super) fn any(robot: &Robot, grid: &Grid, order: &[usize]) -> bool {
    let cables = order.len();
    let stiff = |&i: &usize| !robot.is_elastic(order[i]);
    let mut free: Vec<usize> = (0..cables).filter(stiff).collect();
    let mut rest = Unloaded::default();
    // Where it does, four straight cables do not depend on one another by pulling in vain.
    !robot.backbone().extensible
        && free.len() > 1
        && rest
            .sweep(
                grid,
                &vec![0.0; cables],
                SweepOptions { derivatives: true, ..SweepOptions::EXACT },
            )
            .is_ok()
        && IndependentCables::default().retain(
            &mut free,
            OWN,
            |_| 0.0,
            cables,
            |i, j| rest.length_by_tension[i * cables + j],
        )
}

/// [`super::statics::solve`] of a robot that has such cables, under loads that are gathered.
pub(super) fn solve(
    problem: &Problem<'_>,
    start: &Start,
    scratch: &mut Scratch,
) -> Result<Found, Failure> {
    if !start.slackened.is_empty()
        && let Ok(found) = without(problem, &start.slackened, start, scratch)
    {
        return Ok(found);
    }
    scratch.tensions.resize(problem.commands.len(), 0.0);
    // Where there is no answer without load, one under load may do without those cables.
    let mut touching = match start_without_load(problem, scratch) {
        Ok(()) => touching(problem, scratch),
        Err(_) => Vec::new(),
    };
    let Some(effect) = dependent(problem, scratch, &touching) else {
        return solve_independent(problem, start, scratch);
    };
    let scales = Scales::of(problem.grid, problem.length);
    let give = GIVES * problem.length / scales.force;
    let mut soft = problem.commands.to_vec();
    for &i in &touching {
        if let Command::Length { compliance, .. } = &mut soft[i] {
            *compliance += give;
        }
    }
    let given = Problem { commands: &soft, ..*problem };
    let first = solve_independent(&given, start, scratch)?;
    let all = touching.clone();
    let (tensions, cables) = (scratch.tensions.clone(), soft.len());
    IndependentCables::default().retain(
        &mut touching,
        OWN,
        |i| tensions[i],
        cables,
        |i, j| effect[i * cables + j],
    );
    let slackened: Vec<usize> = all.into_iter().filter(|i| !touching.contains(i)).collect();
    let mut from = Start::default();
    scratch.keep_start(&mut from);
    without(problem, &slackened, &from, scratch).map(|found| found.after(&first))
}

/// The answer without some of the cables, if they have the play for it.
fn without(
    problem: &Problem<'_>,
    slackened: &[usize],
    start: &Start,
    scratch: &mut Scratch,
) -> Result<Found, Failure> {
    let mut commands = problem.commands.to_vec();
    for &i in slackened {
        commands[i] = Command::Tension(0.0);
    }
    let found = solve_independent(&Problem { commands: &commands, ..*problem }, start, scratch)?;
    let mut misses = vec![0.0; commands.len()];
    for &i in slackened {
        let short = -problem.commands[i].slackness(0.0, scratch.lengths[i]);
        if short > PLAY * problem.length {
            misses[i] = short;
        }
    }
    if misses.iter().any(|&miss| miss > 0.0) {
        return Err(Failure::Contradictory { misses });
    }
    scratch.slackened = slackened.to_vec();
    Ok(found)
}

/// Cables driven by their length that have just that without load.
fn touching(problem: &Problem<'_>, scratch: &Scratch) -> Vec<usize> {
    let contacts = |&i: &usize| match problem.commands[i] {
        Command::Length { compliance: 0.0, .. } => {
            let length = scratch.unloaded.lengths[i];
            let slack = problem.commands[i].slackness(scratch.tensions[i], length);
            slack.abs() <= TOUCHES * problem.length
        }
        _ => false,
    };
    (0..problem.commands.len()).filter(contacts).collect()
}

/// What the tensions do to the lengths without load, where some of these cables pull to no effect of their
/// own.
fn dependent(problem: &Problem<'_>, scratch: &Scratch, touching: &[usize]) -> Option<Vec<f64>> {
    let cables = problem.commands.len();
    let Scratch { unloaded, tensions, .. } = scratch;
    let mut free = touching.to_vec();
    (free.len() > 1).then(|| unloaded.length_by_tension.clone()).filter(|effect| {
        let effect = |i: usize, j: usize| effect[i * cables + j];
        IndependentCables::default().retain(&mut free, OWN, |i| tensions[i], cables, effect)
    })
}
