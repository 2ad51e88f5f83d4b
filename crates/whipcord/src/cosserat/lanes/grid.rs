use whipcord_numerics::GAUSS_3;

use super::super::strain_guess::extrapolation;
use super::section::{Guess, Several};
use crate::section::one_cable::Reduced;
use crate::statics::grid::Grid;
use crate::statics::section_runs::WaveStart;
use crate::statics::turned_sections::TurnedSection;

/// One grid, made ready for lanes.
#[derive(Clone, Debug)]
pub(super) struct LaneGrid {
    /// Three to each step.
    pub nodes: Vec<LaneNode>,
    /// Length of each step in m.
    pub steps: Vec<f64>,
    pub rest_excess: Vec<f64>,
    /// Before how many steps a frame is kept, ascending.
    pub kept: Vec<usize>,
    /// The nodes whose sections are solved ahead of all others, in the order in which they are.
    pub solved_ahead: Vec<usize>,
    /// Those whose sections these give.
    pub turned: Vec<TurnedSection>,
    /// How many cables reach through a step: every number that occurs, once.
    pub active: Vec<usize>,
}

/// A Gauss node.
#[derive(Clone, Debug)]
pub(super) struct LaneNode {
    pub section: LaneSection,
    /// Of the quadrature in m.
    pub weight: f64,
    /// Whether the section is that of the node before it ([`crate::statics::grid::Nodes::repeats`]).
    pub repeats: bool,
    /// Whether it is in a run: one of [`LaneGrid::solved_ahead`] or of [`LaneGrid::turned`].
    pub is_in_run: bool,
}

#[derive(Clone, Debug)]
pub(super) enum LaneSection {
    /// With one cable and equally stiff about x and y.
    One(Reduced),
    Several(Several),
}

impl LaneGrid {
    /// `None` where a section's stiffness is not diagonal.
    pub fn new(grid: &Grid, kept: Vec<usize>) -> Option<Self> {
        let mut nodes = Vec::with_capacity(3 * grid.len());
        let mut before: Vec<f64> = Vec::new();
        let waves = || grid.gauss.runs.iter().flat_map(|run| &run.waves);
        let mut in_run: Vec<Option<WaveStart>> = vec![None; 3 * grid.len()];
        for wave in waves() {
            for (&node, start) in wave.nodes.iter().zip(&wave.starts) {
                in_run[node] = Some(*start);
            }
        }
        for (k, step) in grid.steps.iter().enumerate() {
            if k > 0 && grid.steps[k - 1].active != step.active {
                // The strains jump: only the last one is of use.
                before.drain(..before.len().saturating_sub(1));
            }
            for j in 0..3 {
                let (node, crossings) = grid.gauss.at(k, j, step.active);
                let section = if let Some(reduced) = grid.gauss.one_cable.at(3 * k + j) {
                    LaneSection::One(reduced)
                } else {
                    let arc_length = step.start + GAUSS_3.nodes[j] * step.length;
                    let guess = match (in_run[3 * k + j], &before[..]) {
                        (Some(start), _) => Guess::InRun(start),
                        (None, []) => Guess::Rest,
                        (None, [_] | [_, _]) => Guess::Last,
                        (None, &[.., a, b, c]) => {
                            extrapolation([a, b, c], arc_length).map_or(Guess::Last, Guess::Beyond)
                        }
                    };
                    before.push(arc_length);
                    LaneSection::Several(Several::new(&node.section, crossings, guess)?)
                };
                nodes.push(LaneNode {
                    section,
                    weight: GAUSS_3.weights[j] * step.length,
                    repeats: grid.gauss.repeats(k, j),
                    is_in_run: grid.gauss.is_in_run(3 * k + j),
                });
            }
        }
        let mut active: Vec<usize> = grid.steps.iter().map(|step| step.active).collect();
        active.sort_unstable();
        active.dedup();
        Some(Self {
            nodes,
            steps: grid.steps.iter().map(|step| step.length).collect(),
            rest_excess: grid.gauss.rest_excess.clone(),
            kept,
            solved_ahead: waves().flat_map(|wave| wave.nodes.iter().copied()).collect(),
            turned: grid.gauss.runs.iter().flat_map(|run| run.turned.iter().copied()).collect(),
            active,
        })
    }
}
