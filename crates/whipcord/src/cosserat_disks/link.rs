//! One linearised span of the chain: what it passes on to the next disk.

use whipcord_numerics::{Pose, UnitQuaternion, Vec3};

use super::chain::Task;
use super::joint::{self, Answer, Chord, Factors};
use super::rod::{self, By, InSpan, Sample};
use crate::cosserat::elimination::Change;
use crate::cosserat::section::BodyWrench;

/// A linearised span.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Link {
    /// By the six components of `w`, and by the direction of the dead loads.
    pub by: [Answer; 9],
    pub factors: Factors,
    /// What is left of eq. (3).
    pub residual: BodyWrench,
    /// `N`, and `Q`.
    pub total_force: Vec3,
    pub turn: UnitQuaternion,
    /// Sum of the followers inside the span, disk frame.
    pub followers: Vec3,
    pub gap: Change,
    /// Moment applied to the far disk, in its frame, and follower force there.
    pub applied: Vec3,
    pub follower: Vec3,
}

/// What a span is asked: changes at its start.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Push {
    pub turn: Vec3,
    pub moment: Vec3,
    pub force: Vec3,
    /// Of the cables' share in eq. (3), and of the total moment at the far disk.
    pub pull: BodyWrench,
    pub far: Vec3,
    /// How much of what is left of eq. (3) is closed.
    pub close: f64,
}

impl Link {
    /// The change of `w` and what arrives at the next disk when the start changes.
    pub fn pass(&self, rotation: UnitQuaternion, push: &Push) -> (BodyWrench, Change) {
        let Push { turn, moment, force, pull, far, close } = *push;
        let by_turn = |of: fn(&Answer) -> Vec3| -> Vec3 {
            (0..3).fold(Vec3::ZERO, |sum, c| sum + of(&self.by[6 + c]) * turn[c])
        };
        let total = self.total_force.cross(turn) + rotation.conjugate().rotate(force);
        let right = BodyWrench {
            linear: total - pull.linear - by_turn(|a| a.pull.linear) - self.residual.linear * close,
            angular: moment
                - pull.angular
                - by_turn(|a| a.pull.angular)
                - self.residual.angular * close,
        };
        let change = self.factors.solve(right);
        let all = |of: fn(&Answer) -> Vec3| -> Vec3 {
            (0..3).fold(by_turn(of), |sum, c| {
                sum + of(&self.by[c]) * change.linear[c] + of(&self.by[3 + c]) * change.angular[c]
            })
        };
        let turned = self.turn.conjugate().rotate(turn) + all(|a| a.turn);
        let moment = all(|a| a.moment) + far - self.applied.cross(turned);
        let end = rotation * self.turn;
        let force = force - rotation.rotate(turn.cross(self.followers))
            + rotation.rotate(all(|a| a.force))
            - end.rotate(turned.cross(end.conjugate().rotate(self.follower)));
        (change, Change { turn: turned, moment, force })
    }
}

/// The answers to the six components of `w` and to the direction of the dead loads.
pub(super) fn answers(
    task: &Task<'_>,
    k: usize,
    samples: &[Sample],
    chords: &[Chord],
    pose: &Pose,
    inside: &InSpan<'_>,
    rows: &mut [f64],
) -> [Answer; 9] {
    let axes = [Vec3::X, Vec3::Y, Vec3::Z];
    let span = &task.frame.spans[k];
    let cables = span.passages.len();
    let tensions = &task.tensions[span.first..span.first + cables];
    let steps = &task.mesh.spans[k];
    let loaded = samples.iter().any(|sample| sample.dead != Vec3::ZERO)
        || (steps.start + 1..steps.end).any(|place| task.loads.moment(place) != Vec3::ZERO)
        || steps.clone().any(|k| task.loads.line(k).is_some());
    core::array::from_fn(|c| {
        let row = &mut rows[c * cables..(c + 1) * cables];
        let by = match c {
            0..3 => {
                // A change of the force reaches into the followers' share, not only the rod's own.
                By::Force(axes[c])
            }
            3..6 => By::Moment(axes[c - 3]),
            _ if !loaded => {
                row.fill(0.0);
                return Answer::default();
            }
            _ => By::Turn(axes[c - 6]),
        };
        let mut variation =
            rod::linearise(&task.mesh.grid, steps.clone(), samples, Some(inside), by);
        if let By::Force(force) = by {
            variation.force -= force;
        }
        joint::answer(span, pose, chords, tensions, &variation, row)
    })
}
