//! The parts of a robot that can touch.

use super::body::Body;
use crate::robot::Robot;
use crate::solution::Part;

/// A part of the robot that can touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Member {
    /// What it is.
    pub part: Part,
    /// Arc length in m of its cross-section.
    pub arc_length: f64,
    /// Its form.
    pub body: Body,
}

/// Thickness of a disk as a part of its radius, where none is given.
const THICKNESS: f64 = 0.1;

impl Member {
    /// The disks beyond the base, which is clamped.
    #[must_use]
    pub fn disks(robot: &Robot) -> Vec<Self> {
        let disks = robot.disks();
        let disk = |k: usize| {
            let arc_length = disks.arc_lengths[k];
            let outer = disks.rim_radius(k).max(backbone_radius(robot, arc_length));
            let body = Body::disk(outer, 0.5 * disks.thickness.unwrap_or(THICKNESS * outer));
            Self { part: Part::Disk(k), arc_length, body }
        };
        (1..disks.count())
            .filter(|_| disks.are_present)
            .map(disk)
            .filter(|member| member.body.reach() > 0.0)
            .collect()
    }

    /// The backbone at an arc length in m.
    #[must_use]
    pub fn backbone(robot: &Robot, arc_length: f64) -> Self {
        let body = Body { flat: 0.0, rounding: backbone_radius(robot, arc_length) };
        Self { part: Part::Backbone, arc_length, body }
    }
}

/// Outer radius in m of the backbone at an arc length in m.
pub(super) fn backbone_radius(robot: &Robot, arc_length: f64) -> f64 {
    robot.backbone().outer_radius_at(robot.disks(), arc_length)
}
