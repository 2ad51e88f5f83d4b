//! What a change of a distributed load does at a section.

use whipcord_numerics::{Mat3, UnitQuaternion, Vec3};

use super::effect::Forcing;
use super::replay::AXES;
use crate::case::{Loads, Profile};
use crate::parameter::Parameter;

/// The change of a distributed load, for a unit of a parameter; none of any other parameter.
#[derive(Clone, Debug, Default)]
pub(super) struct SpreadChange {
    /// By as much as this times `axis`.
    pub pieces: Vec<Ramp>,
    axis: Vec3,
    follower: bool,
    /// Whether it is a moment.
    turns: bool,
}

/// A piece of the backbone on which the change is linear.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ramp {
    /// Arc lengths of its ends in m.
    at: [f64; 2],
    /// The change there.
    value: [f64; 2],
}

impl SpreadChange {
    pub fn new(loads: &Loads, parameter: &Parameter) -> Self {
        let (load, axis, entry, turns) = match *parameter {
            Parameter::LineForce { load, axis } => (load, axis, None, false),
            Parameter::LineMoment { load, axis } => (load, axis, None, true),
            Parameter::LineForceAt { load, entry, axis } => (load, axis, Some(entry), false),
            Parameter::LineMomentAt { load, entry, axis } => (load, axis, Some(entry), true),
            _ => return Self::default(),
        };
        let load = &loads.distributed[load];
        let share = |i: usize| if entry.is_none_or(|entry| entry == i) { 1.0 } else { 0.0 };
        let pieces = match &load.profile {
            Profile::Constant { from, to, .. } => {
                vec![Ramp { at: [*from, *to], value: [1.0; 2] }]
            }
            Profile::Linear { at, .. } => at
                .windows(2)
                .enumerate()
                .map(|(i, ends)| Ramp { at: [ends[0], ends[1]], value: [share(i), share(i + 1)] })
                .collect(),
        };
        Self { pieces, axis: AXES[axis], follower: load.follower, turns }
    }

    /// Adds what acts at a section; `inside` is a place in the same step, `turn` that from the frame of
    /// the dead loads to that of the base, and `rotation` that of the section.
    pub fn act(
        &self,
        out: &mut Forcing,
        turn: UnitQuaternion,
        s: f64,
        inside: f64,
        rotation: &Mat3,
    ) {
        if self.pieces.is_empty() {
            return;
        }
        let axis = if self.follower { *rotation * self.axis } else { turn.rotate(self.axis) };
        let holds = |ramp: &&Ramp| ramp.at[0] < inside && inside < ramp.at[1];
        let here = self.pieces.iter().find(holds).map_or(0.0, |ramp| ramp.value_at(s));
        match (self.turns, self.follower) {
            (true, _) => out.torque -= here * axis,
            (false, true) => out.rate -= here * axis,
            (false, false) => {
                out.force += self.pieces.iter().map(|ramp| ramp.beyond(s)).sum::<f64>() * axis;
            }
        }
    }
}

impl Ramp {
    fn value_at(&self, s: f64) -> f64 {
        let ([from, to], [a, b]) = (self.at, self.value);
        a + (s - from) / (to - from) * (b - a)
    }

    /// The integral over what lies beyond an arc length.
    fn beyond(&self, s: f64) -> f64 {
        let from = s.clamp(self.at[0], self.at[1]);
        0.5 * (self.at[1] - from) * (self.value_at(from) + self.value[1])
    }
}
