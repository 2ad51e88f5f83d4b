//! The sections just in front of the ends of the steps: where friction against bending keeps its history beside those just
//! behind the nodes.

use super::linear::Linear;
use super::quadrature::POINTS;
use super::replay::{Answer, Stage};
use crate::section::{BodyWrench, Fault, Strain, Tangent, equilibrium};
use crate::shape::Wrench;
use crate::statics::grid::{Grid, SHOOTING_NODES};
use crate::statics::runge_kutta::STAGES;

/// The place of [`SHOOTING_NODES`] at the end of a step.
const LAST_NODE: usize = SHOOTING_NODES.len() - 1;

/// The sections just in front of the ends of all steps.
#[derive(Clone, Debug, Default)]
pub(super) struct StepEnds {
    stages: Vec<Stage>,
    /// What unit tensions exert there, and the stretch of each cable; by steps, then cables.
    pulls: Vec<(BodyWrench, f64)>,
    cables: usize,
}

impl StepEnds {
    /// Of an answer that is gone over.
    pub fn new(linear: &Linear, answer: &Answer<'_>, grid: &Grid) -> Result<Self, Fault> {
        // Cables that run straight are in no section of the rod.
        let cables = if linear.spans().is_some() { 0 } else { answer.tensions.len() };
        let mut ends = Self { cables, ..Self::default() };
        ends.pulls.resize(grid.len() * cables, Default::default());
        for (k, step) in grid.steps.iter().enumerate() {
            let (wrench, arriving, mut strain) = match linear {
                Linear::Trajectory(replay) => replay.arriving(k),
                Linear::Spans(spans) => spans.replay.arriving(k),
                Linear::Unloaded(quadrature) => {
                    let strain = quadrature.points[POINTS * k + POINTS - 1].strain;
                    (BodyWrench::default(), Wrench::default(), strain)
                }
            };
            let (at, crossings) = grid.shooting.at(k, LAST_NODE, step.active);
            let active = match cables {
                0 => &[],
                _ => answer.tensions_at(k, LAST_NODE, step.active),
            };
            let section = &at.section;
            let fault = |kind| Fault { kind, arc_length: step.start + step.length };
            equilibrium(section, crossings, active, wrench, &mut strain).map_err(fault)?;
            let tangent = Tangent::at(section, crossings, active, &strain).map_err(fault)?;
            for (pull, crossing) in ends.pulls[k * cables..].iter_mut().zip(crossings) {
                *pull = crossing.pull(&strain);
            }
            ends.stages.push(Stage {
                strain,
                rotation: answer.poses[k + 1].rotation.to_matrix(),
                force: arriving.force,
                moment: arriving.moment,
                compliance: tangent.compliance(),
                ..Stage::default()
            });
        }
        Ok(ends)
    }

    /// The section in front of the end of step `k`.
    pub fn stage(&self, k: usize) -> &Stage {
        &self.stages[k]
    }

    /// What unit tensions exert there, and the stretch of each cable.
    pub fn pulls(&self, k: usize, active: usize) -> &[(BodyWrench, f64)] {
        &self.pulls[k * self.cables..k * self.cables + active]
    }

    /// The strains just behind the start and just in front of the end of each step.
    pub fn strains(&self, linear: &Linear) -> Vec<[Strain; 2]> {
        let of = |(k, stage): (usize, &Stage)| [linear.at_node(k).strain, stage.strain];
        self.stages.iter().enumerate().map(of).collect()
    }
}

impl super::replay::Replay {
    /// What arrives at the end of a step, in the frame there and in the base frame, and a strain that is near.
    fn arriving(&self, k: usize) -> (BodyWrench, Wrench, Strain) {
        let ends = &self.ends[k];
        let arriving = Wrench { force: ends.force, moment: ends.moment };
        (ends.wrench_in_body(), arriving, self.stages[STAGES * k + STAGES - 1].strain)
    }
}
