//! Cables that run straight from the hole of one disk to that of the next.

use whipcord_numerics::Vec3;

use crate::robot::{HoleOffset, Robot, Routing};

/// A cable's way from the hole of one disk to that of the next, in the frames of the disks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Number of the cable.
    pub cable: usize,
    /// Its hole in the disk nearer the base, in m.
    pub near: Vec3,
    /// Where it ends, in the frame of the cross-section there: its hole in the next disk, or its anchor, in m.
    pub far: Vec3,
    /// The part of the span's length at which that is: 1 at the next disk, less at an anchor before it.
    pub reach: f64,
}

impl Passage {
    /// Whether it ends before the next disk.
    #[must_use]
    pub fn is_anchored_inside(&self) -> bool {
        self.reach < 1.0
    }
}

/// An anchor between two disks, on a grid whose steps end there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Anchor {
    /// Its cable's passage, by its number in the span.
    pub passage: usize,
    /// The number of steps before it.
    pub node: usize,
}

/// The cables' straight pieces between each two disks.
#[must_use]
pub fn passages(robot: &Robot) -> Vec<Vec<Passage>> {
    let disks = robot.disks();
    let at = &disks.arc_lengths;
    let tolerance = 1e-10 * robot.backbone().length;
    // The last span of each cable, and the part of it at which it ends.
    let end = |end: f64| match at[1..].iter().position(|&s| (s - end).abs() <= tolerance) {
        Some(span) => (span, 1.0),
        None => disks.locate(end),
    };
    let ends: Vec<(usize, f64)> = robot.routes().iter().map(|route| end(route.end())).collect();
    let of_span = |k: usize| {
        let through = |i: usize| {
            let (last, part) = ends[i];
            let near = hole(robot, i, k);
            if k < last || part == 1.0 {
                return Passage { cable: i, near, far: hole(robot, i, k + 1), reach: 1.0 };
            }
            let route = &robot.routes()[i];
            Passage { cable: i, near, far: route.at(route.end()).offset, reach: part }
        };
        (0..ends.len()).filter(|&i| k <= ends[i].0).map(through).collect()
    };
    (0..at.len() - 1).map(of_span).collect()
}

/// Where the cable passes a disk: the hole of its list, whatever course it takes between them.
fn hole(robot: &Robot, cable: usize, disk: usize) -> Vec3 {
    let disks = robot.disks();
    match (&robot.cables()[cable].routing, disks.holes) {
        (Routing::Holes { holes, .. }, Some(count)) => {
            let HoleOffset { angle, radius } = robot.cables()[cable].hole_offset;
            let angle = core::f64::consts::TAU * (holes[disk] as f64 - 1.0) / count as f64 + angle;
            let radius = disks.hole_circle_radii[disk] + radius;
            Vec3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
        }
        _ => robot.routes()[cable].at(disks.arc_lengths[disk]).offset,
    }
}
