//! How the tip moves with the commands of the cables, in memory that is kept from one answer to the next: for control loops.
//!
//! The same operations in the same order as [`super::rod::Derivatives`] takes for its actuation Jacobian, to the same bits.

use whipcord_numerics::Twist;

use super::effect::Forcing;
use super::elimination::Elimination;
use super::forward::Maps;
use super::node_change::NodeChange;
use super::of_answer::Solved;
use super::quadrature::Quadrature;
use super::replay::{Answer, Replay};
use super::rod::NoDerivatives;
use crate::shape::Wrench;
use crate::statics::command::Command;
use crate::statics::hold::{Critical, HeldCables, Hold, HoldScratch};

/// The memory, and in it the rates of the last answer.
#[derive(Clone, Debug, Default)]
pub(crate) struct TipRates {
    replay: Replay,
    quadrature: Quadrature,
    maps: Maps,
    elimination: Elimination,
    /// Of the tension at hand.
    nodes: Vec<NodeChange>,
    /// Of the tip with each tension, in the order of the grid.
    tips: Vec<NodeChange>,
    /// Of the length of cable j with the tension of cable i at `[i * cables + j]`.
    lengths: Vec<f64>,
    /// What of them the steps add by themselves.
    own: Vec<f64>,
    held: HeldCables,
    scratch: HoldScratch,
    tensions: Vec<f64>,
}

impl TipRates {
    /// Velocity of the point of the tip and its angular velocity, base frame, for the command of each cable of the robot; of an answer of
    /// a rod with continuous cables without friction and contacts.
    pub fn by_commands(
        &mut self,
        solved: &Solved<'_>,
        out: &mut Vec<Twist>,
    ) -> Result<(), NoDerivatives> {
        let answer = solved.answer();
        self.by_tensions(&answer)?;
        let order = solved.cables.order;
        let cables = order.len();
        let Self { lengths, tips, held, scratch, tensions, .. } = self;
        held.renew(
            cables,
            |i, j| lengths[j * cables + i],
            |place| solved.robot.cable_compliance(order[place], solved.cables.rest_lengths[place]),
            |place| solved.taut[place],
            |place| matches!(solved.commands[place], Command::Length { .. }),
        )?;
        out.clear();
        out.resize(cables, Twist::default());
        for (place, &cable) in order.iter().enumerate() {
            let is_tension = matches!(solved.commands[place], Command::Tension(_));
            let by_tension = &lengths[place * cables..(place + 1) * cables];
            let of_command = (place, is_tension, by_tension);
            held.commanded_into(Hold::Commands, of_command, scratch, tensions);
            let mut change = NodeChange::default();
            for (tip, &tension) in tips.iter().zip(&*tensions) {
                change.add(tension, tip);
            }
            out[cable] = change.twist();
        }
        let is_finite = |twist: &Twist| twist.linear.is_finite() && twist.angular.is_finite();
        if out.iter().all(is_finite) { Ok(()) } else { Err(NoDerivatives::Critical) }
    }

    /// How tip and lengths change with each tension at constant other tensions.
    fn by_tensions(&mut self, answer: &Answer<'_>) -> Result<(), NoDerivatives> {
        let Answer { grid, loads, tensions, poses, starts, .. } = *answer;
        let Self { replay, quadrature, maps, elimination, nodes, tips, lengths, own, .. } = self;
        let (cables, steps) = (tensions.len(), grid.len());
        let nothing = |_: usize, _: usize, _: usize| Forcing::default();
        if loads.any() || !starts.is_empty() {
            replay.run(answer)?;
            maps.compute(&grid.steps, replay, (cables, cables), (cables, 0), &nothing);
        } else {
            quadrature.run(answer)?;
            quadrature.compute(maps, &grid.steps, cables, 0, &nothing);
        }
        elimination.eliminate(maps, |step| loads.follower_in_base(step + 1, &poses[step + 1]))?;
        tips.clear();
        lengths.clear();
        for cable in 0..cables {
            let effect = |k: usize| maps.effects_of(k)[cable];
            elimination.solve(0, effect, |_| Wrench::default(), nodes);
            let first = lengths.len();
            lengths.resize(first + cables, 0.0);
            let of_cable = &mut lengths[first..];
            for (node, by_state) in nodes.iter().zip(maps.length_by_state.chunks(cables)) {
                for (length, [turn, moment, force]) in of_cable.iter_mut().zip(by_state) {
                    *length +=
                        turn.dot(node.turn) + moment.dot(node.moment) + force.dot(node.force);
                }
            }
            own.clear();
            own.resize(cables, 0.0);
            for k in 0..steps {
                own.iter_mut().zip(maps.outputs_of(k, cable)).for_each(|(own, by)| *own += by);
            }
            of_cable.iter_mut().zip(&*own).for_each(|(length, own)| *length += own);
            tips.push(nodes.last().copied().ok_or(Critical)?);
        }
        Ok(())
    }
}
