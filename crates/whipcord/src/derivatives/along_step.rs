//! How the sections within a step change: what an interpolation between its ends takes.

use whipcord_numerics::Twist;

use super::column::{Raw, Source};
use super::effect::Forcing;
use super::forward::stage_strains;
use super::linear::Linear;
use super::rod::Derivatives;
use super::sliding_holes::Cause;
use crate::section::Strain;
use crate::statics::hold::Hold;
use crate::statics::runge_kutta::{NODE_OF_STAGE, SAMPLED_STAGES, STAGES};

/// What a cause changes while the commands are held.
pub(crate) struct Caused<'a> {
    of: &'a Derivatives,
    cause: Cause,
    pub(super) changed: Raw,
    /// Of all strands.
    tensions: Vec<f64>,
}

impl Derivatives {
    pub(super) fn caused(&self, cause: Cause) -> Caused<'_> {
        if let Cause::Parameter(p) = cause {
            let (changed, [tensions, _]) =
                self.completing(Source::Parameter(p), Hold::Commands, cause);
            return Caused { of: self, cause, changed, tensions };
        }
        let mut changed = self.remembered(cause);
        let [tensions, _] = self.tensions(Hold::Commands, &changed.lengths, cause);
        for (column, &tension) in self.by_tension.iter().zip(&tensions) {
            changed.add(tension, column);
        }
        Caused { of: self, cause, changed, tensions }
    }
}

impl Caused<'_> {
    /// How a node of the grid moves, one of those that are known where cables run straight between disks.
    pub fn node(&self, node: usize) -> Twist {
        self.changed.nodes[node].twist()
    }

    /// How the strains at the start, in the middle and at the end of a step change, of which the node at the start is known; `None`
    /// of a rod that was not integrated from a wrench.
    pub fn strains(&self, k: usize) -> Option<[Strain; 3]> {
        let Self { of, cause, changed, tensions } = self;
        let (replay, cables) = match &of.linear {
            Linear::Trajectory(replay) => (replay, of.strands.cables()),
            // No cable is in the sections.
            Linear::Spans(spans) => (&spans.replay, 0),
            Linear::Unloaded(_) => return None,
        };
        let step = &of.steps[k];
        let forcing = |i: usize| {
            let at = STAGES * k + i;
            let mut forcing = match cause {
                Cause::Parameter(p) => of.partials[*p].forcing(at),
                _ => Forcing::default(),
            };
            let pulls = replay.pulls_at(at, cables, step.active.min(cables));
            for (cable, (pull, _)) in pulls.iter().enumerate() {
                let tension = of.strands.tension((k, cable), NODE_OF_STAGE[i], tensions);
                forcing.force_balance += tension * pull.linear;
                forcing.moment_balance += tension * pull.angular;
            }
            forcing
        };
        let start = &changed.nodes[k];
        let start = [start.turn, start.moment, start.force];
        let strains = stage_strains(step, replay, (k, of.maps.rows), start, forcing);
        Some(SAMPLED_STAGES.map(|i| strains[i]))
    }
}
