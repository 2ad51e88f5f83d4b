//! The sections just inside both ends of each step: where friction against bending keeps its history.

use super::of_answer::Solved;
use super::quadrature::POINTS;
use super::replay::{Answer, Replay};
use crate::section::{BodyWrench, Fault, Strain, equilibrium};
use crate::statics::grid::{Grid, SHOOTING_NODES};
use crate::statics::runge_kutta::STAGES;

/// The place of [`SHOOTING_NODES`] at the end of a step.
const LAST_NODE: usize = SHOOTING_NODES.len() - 1;

/// The strains just inside both ends of each step of an answer.
pub(crate) fn strains_at_step_ends(solved: &Solved<'_>) -> Result<Vec<[Strain; 2]>, Fault> {
    let Solved { grid, loads, tensions, cables, starts, .. } = *solved;
    let straight = cables.straight.is_some();
    if !straight && !loads.any() && starts.is_empty() {
        let mut strains = Vec::with_capacity(grid.len());
        for k in 0..grid.len() {
            let near = solved.strains[POINTS * k];
            let far = solved.strains[POINTS * k + POINTS - 1];
            let none = BodyWrench::default();
            strains.push([
                section(grid, tensions, k, 0, none, near)?,
                section(grid, tensions, k, LAST_NODE, none, far)?,
            ]);
        }
        return Ok(strains);
    }
    let mut replay = Replay::default();
    let tensions = if straight { &[] } else { tensions };
    replay.run(&Answer { tensions, ..solved.answer() })?;
    let ends = |k: usize| {
        let wrench = replay.ends[k].wrench_in_body();
        let guess = replay.stages[STAGES * k + STAGES - 1].strain;
        let end = section(grid, tensions, k, LAST_NODE, wrench, guess)?;
        Ok([replay.stages[STAGES * k].strain, end])
    };
    (0..grid.len()).map(ends).collect()
}

fn section(
    grid: &Grid,
    tensions: &[f64],
    k: usize,
    node: usize,
    wrench: BodyWrench,
    mut strain: Strain,
) -> Result<Strain, Fault> {
    let step = &grid.steps[k];
    let (at, crossings) = grid.shooting.at(k, node, step.active);
    let arc_length = step.start + SHOOTING_NODES[node] * step.length;
    equilibrium(&at.section, crossings, &tensions[..step.active], wrench, &mut strain)
        .map_err(|kind| Fault { kind, arc_length })?;
    Ok(strain)
}
