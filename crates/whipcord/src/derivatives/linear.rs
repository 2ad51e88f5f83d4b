//! The sections at which an answer is linearised: the stages of the shot under load, or the nodes of
//! the quadrature without.

use whipcord_numerics::{BUTCHER_5, GAUSS_3, Mat3, Vec3};

use super::adjoint::stage_pulls;
use super::effect::Forcing;
use super::elimination::StepPull;
use super::forward::Maps;
use super::quadrature::{POINTS, Quadrature};
use super::replay::{Answer, Replay, Stage, TurnOutput};
use super::spans::{Spans, StraightSpan};
use super::strands::Strands;
use crate::section::Fault;
use crate::section::{BodyWrench, Crossing, Strain};
use crate::statics::grid::{Grid, Node, Step};
use crate::statics::hold::Critical;
use crate::statics::runge_kutta::{NODE_OF_STAGE, STAGES};

/// A linearised answer.
#[derive(Clone, Debug)]
pub(super) enum Linear {
    Trajectory(Replay),
    Unloaded(Quadrature),
    /// Under cables that run straight between the disks.
    Spans(Box<Spans>),
}

impl Linear {
    /// An answer under loads, or with starts of its own for every step, or one without; with cables straight between
    /// disks where spans are given, with the nodes of the grid that are asked for.
    pub fn of(
        answer: &Answer<'_>,
        spans: Option<(&[StraightSpan<'_>], &[usize])>,
    ) -> Result<Self, Fault> {
        if let Some((straight, nodes)) = spans {
            let mut spans = Box::<Spans>::default();
            // The sections of the rod have no cables in them.
            let rod = Answer { tensions: &[], ..*answer };
            spans.run(&rod, &mut straight.iter().cloned(), answer.tensions, nodes)?;
            Ok(Self::Spans(spans))
        } else if answer.loads.any() || !answer.starts.is_empty() {
            let mut replay = Replay::default();
            replay.run(answer)?;
            Ok(Self::Trajectory(replay))
        } else {
            let mut quadrature = Quadrature::default();
            quadrature.run(answer)?;
            Ok(Self::Unloaded(quadrature))
        }
    }

    /// The spans, where cables run straight between disks.
    pub fn spans(&self) -> Option<&Spans> {
        match self {
            Self::Spans(spans) => Some(spans),
            Self::Trajectory(_) | Self::Unloaded(_) => None,
        }
    }

    /// Sections within a step.
    pub fn per_step(&self) -> usize {
        match self {
            Self::Trajectory(_) | Self::Spans(_) => STAGES,
            Self::Unloaded(_) => POINTS,
        }
    }

    /// Where in a step of length 1 a section of it lies, and its weight.
    pub fn place(&self, i: usize) -> (f64, f64) {
        match self {
            Self::Trajectory(_) | Self::Spans(_) => (BUTCHER_5.c[i], BUTCHER_5.b[i]),
            Self::Unloaded(_) => (GAUSS_3.nodes[i], GAUSS_3.weights[i]),
        }
    }

    /// At which place of the shooting grid, or near it, a section of a step lies.
    pub fn shooting_place(&self, i: usize) -> usize {
        match self {
            Self::Trajectory(_) | Self::Spans(_) => NODE_OF_STAGE[i],
            Self::Unloaded(_) => 0,
        }
    }

    /// A section of a step on the grid.
    pub fn node<'g>(
        &self,
        grid: &'g Grid,
        k: usize,
        i: usize,
        active: usize,
    ) -> (&'g Node, &'g [Crossing]) {
        match self {
            Self::Trajectory(_) | Self::Spans(_) => grid.shooting.at(k, NODE_OF_STAGE[i], active),
            Self::Unloaded(_) => grid.gauss.at(k, i, active),
        }
    }

    /// The strain of a section, by its number along the rod.
    pub fn strain(&self, at: usize) -> Strain {
        match self {
            Self::Trajectory(replay) => replay.stages[at].strain,
            Self::Spans(spans) => spans.replay.stages[at].strain,
            Self::Unloaded(quadrature) => quadrature.points[at].strain,
        }
    }

    /// How a section is turned.
    pub fn rotation(&self, at: usize) -> Mat3 {
        match self {
            Self::Trajectory(replay) => replay.stages[at].rotation,
            Self::Spans(spans) => spans.replay.stages[at].rotation,
            Self::Unloaded(quadrature) => quadrature.rotation(at),
        }
    }

    /// What unit tensions exert at a section, and the stretch of each cable.
    pub fn pulls(&self, at: usize, cables: usize, active: usize) -> &[(BodyWrench, f64)] {
        let all = match self {
            Self::Trajectory(replay) => &replay.pulls,
            Self::Unloaded(quadrature) => &quadrature.pulls,
            Self::Spans(_) => return &[],
        };
        &all[at * cables..at * cables + active]
    }

    /// The outputs of step `k` that hang on one of its sections beside those that are integrated.
    pub fn turns_at(&self, k: usize, i: usize) -> &[TurnOutput] {
        match self {
            Self::Trajectory(replay) => replay.turns_at(k, i),
            Self::Unloaded(_) | Self::Spans(_) => &[],
        }
    }

    /// The section just behind a node, and at the tip in front of it.
    pub fn at_node(&self, node: usize) -> &Stage {
        match self {
            Self::Trajectory(replay) => &replay.stages[STAGES * node],
            Self::Spans(spans) => &spans.replay.stages[STAGES * node],
            Self::Unloaded(quadrature) => &quadrature.nodes[node],
        }
    }

    /// What unit tensions exert there.
    pub fn pulls_at_node(&self, node: usize, cables: usize, active: usize) -> &[(BodyWrench, f64)] {
        match self {
            Self::Trajectory(replay) => replay.pulls_at(STAGES * node, cables, active),
            Self::Unloaded(quadrature) => &quadrature.node_pulls[node * cables..][..active],
            Self::Spans(_) => &[],
        }
    }

    /// The maps of every step, see [`Maps::compute`], or of every span, see [`Spans::compute`].
    ///
    /// # Errors
    /// [`Critical`] where a span is about to buckle by itself.
    pub fn maps(
        &mut self,
        grid: &Grid,
        (strands, more): (&Strands, usize),
        forcing: &dyn Fn(usize, usize, usize) -> Forcing,
        holes: &dyn Fn(usize, usize, usize) -> [Vec3; 2],
    ) -> Result<Maps, Critical> {
        let (cables, rows) = (strands.cables(), strands.rows());
        let mut maps = Maps::default();
        match self {
            Self::Trajectory(replay) => {
                let inputs = (strands.inputs(), more);
                maps.compute(&grid.steps, replay, (cables, rows), inputs, forcing);
            }
            Self::Unloaded(quadrature) => {
                quadrature.compute(&mut maps, &grid.steps, cables, more, forcing);
            }
            Self::Spans(spans) => {
                spans.compute(grid, (cables, more, rows), (forcing, holes), &mut maps)?;
            }
        }
        Ok(maps)
    }

    /// Sensitivities of one scalar to the forcing of every section within the steps, where the outputs of a step, by its number and
    /// theirs, are worth this; none of spans, see [`Spans::worth`].
    pub fn pull_back(
        &self,
        steps: &[Step],
        pulls: &[StepPull],
        (cables, rows): (usize, &dyn Fn(usize, usize) -> f64),
        out: &mut Vec<Forcing>,
    ) {
        match self {
            Self::Trajectory(replay) => stage_pulls(steps, replay, pulls, (cables, rows), out),
            Self::Unloaded(quadrature) => {
                // Without friction each row is the length of a cable, in all steps.
                let lengths: Vec<f64> = (0..cables).map(|cable| rows(0, cable)).collect();
                quadrature.stage_pulls(steps, pulls, &lengths, out);
            }
            Self::Spans(_) => out.clear(),
        }
    }
}
