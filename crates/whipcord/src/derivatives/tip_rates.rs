//! How the tip moves with the commands of the cables, in memory that is kept from one answer to the next: for control loops.
//!
//! The same operations as [`super::rod::Derivatives`] takes for its actuation Jacobian; where cables run along the rod in the same order, to the
//! same bits.

use whipcord_numerics::{Twist, Vec3};

use super::effect::Forcing;
use super::elimination::Elimination;
use super::forward::Maps;
use super::node_change::NodeChange;
use super::quadrature::Quadrature;
use super::replay::{Answer, Replay};
use super::rod::NoDerivatives;
use super::spans::{Spans, StraightSpan};
use super::tension_rates::{DrivenCables, TensionRates};
use crate::shape::Wrench;
use crate::solution::Solution;
use crate::statics::hold::Critical;

/// An answer of a rod without friction and contacts, and what drives its cables, in the order of the grid.
pub(crate) struct Driven<'a> {
    pub cables: DrivenCables<'a>,
    pub answer: Answer<'a>,
}

/// The memory, and in it the rates of the last answer.
#[derive(Clone, Debug, Default)]
pub(crate) struct TipRates {
    replay: Replay,
    quadrature: Quadrature,
    /// Where cables run straight between disks.
    spans: Spans,
    maps: Maps,
    elimination: Elimination,
    /// Of the tension at hand.
    nodes: Vec<NodeChange>,
    rates: TensionRates,
    /// What the steps add to the lengths by themselves.
    own: Vec<f64>,
}

/// What a model keeps for the rates of the tip.
#[derive(Clone, Debug, Default)]
pub(crate) struct TipRatesMemory {
    pub rates: TipRates,
    /// The answer, found again.
    pub answer: Option<Solution>,
    pub lists: AnswerLists,
    /// The cables in the order of the grid, where the model keeps none.
    pub order: Vec<usize>,
}

/// Lists that are made of an answer to differentiate it.
#[derive(Clone, Debug, Default)]
pub(crate) struct AnswerLists {
    /// Which cables are taut.
    pub taut: Vec<bool>,
    /// As [`Answer::starts`].
    pub starts: Vec<Option<Wrench>>,
}

impl AnswerLists {
    /// Cables under tension are taut.
    pub fn set_taut(&mut self, tensions: &[f64]) {
        self.taut.clear();
        self.taut.extend(tensions.iter().map(|&tension| tension > 0.0));
    }
}

impl TipRates {
    /// Velocity of the point of the tip and its angular velocity, base frame, for the command of each cable of the robot; with the spans where cables run
    /// straight between disks.
    pub fn by_commands(
        &mut self,
        driven: &Driven<'_>,
        spans: Option<&mut dyn Iterator<Item = StraightSpan<'_>>>,
        out: &mut Vec<Twist>,
    ) -> Result<(), NoDerivatives> {
        self.by_tensions(&driven.answer, spans)?;
        Ok(self.rates.by_commands(driven.cables, out)?)
    }

    /// How tip and lengths change with each tension at constant other tensions.
    fn by_tensions(
        &mut self,
        answer: &Answer<'_>,
        straight: Option<&mut dyn Iterator<Item = StraightSpan<'_>>>,
    ) -> Result<(), NoDerivatives> {
        let Answer { grid, loads, tensions, poses, starts, .. } = *answer;
        let Self { replay, quadrature, spans, maps, elimination, nodes, rates, own } = self;
        let cables = tensions.len();
        let nothing = |_: usize, _: usize, _: usize| Forcing::default();
        let are_straight = straight.is_some();
        if let Some(straight) = straight {
            // The sections of the rod have no cables in them.
            let rod = Answer { tensions: &[], ..*answer };
            spans.run(&rod, straight, tensions, &[])?;
            let still = |_: usize, _: usize, _: usize| [Vec3::ZERO; 2];
            spans.compute(grid, (cables, 0, cables), (&nothing, &still), maps)?;
        } else if loads.any() || !starts.is_empty() {
            replay.run(answer)?;
            maps.compute(&grid.steps, replay, (cables, cables), (cables, 0), &nothing);
        } else {
            quadrature.run(answer)?;
            quadrature.compute(maps, &grid.steps, cables, 0, &nothing);
        }
        let count = maps.steps.len();
        elimination.eliminate(maps, |step| {
            let node = if are_straight { spans.far_disk(step) } else { step + 1 };
            loads.follower_in_base(node, &poses[node])
        })?;
        rates.clear();
        for cable in 0..cables {
            let effect = |k: usize| maps.effects_of(k)[cable];
            elimination.solve(0, effect, |_| Wrench::default(), nodes);
            let tip = nodes.last().ok_or(Critical)?.twist();
            let of_cable = rates.push(tip, cables);
            for (node, by_state) in nodes.iter().zip(maps.length_by_state.chunks(cables)) {
                for (length, [turn, moment, force]) in of_cable.iter_mut().zip(by_state) {
                    *length +=
                        turn.dot(node.turn) + moment.dot(node.moment) + force.dot(node.force);
                }
            }
            own.clear();
            own.resize(cables, 0.0);
            for k in 0..count {
                own.iter_mut().zip(maps.outputs_of(k, cable)).for_each(|(own, by)| *own += by);
            }
            of_cable.iter_mut().zip(&*own).for_each(|(length, own)| *length += own);
        }
        Ok(())
    }
}
