//! Cables that run straight from the hole of one disk to that of the next.

use whipcord_numerics::Vec3;

use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::robot::{Cable, Robot, Routing};

/// A cable's way from the hole of one disk to that of the next, in the frames of the disks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Passage {
    /// Number of the cable.
    pub cable: usize,
    /// Its hole in the disk nearer the base, in m.
    pub near: Vec3,
    /// Its hole in the next disk, in m.
    pub far: Vec3,
}

/// The cables' straight pieces between each two disks, of which cables are anchored at disks only.
pub(crate) fn passages(robot: &Robot, model: ModelKind) -> Result<Vec<Vec<Passage>>, SolveError> {
    let at = &robot.disks().arc_lengths;
    let mut anchors = Vec::with_capacity(robot.cables().len());
    for (i, (cable, route)) in robot.cables().iter().zip(robot.routes()).enumerate() {
        let tolerance = 1e-10 * robot.backbone().length;
        let disk = at.iter().position(|&s| (s - route.end()).abs() <= tolerance);
        let anchor = disk.filter(|&disk| disk > 0).ok_or_else(|| between_disks(model, i, cable))?;
        anchors.push(anchor);
    }
    let of_span = |k: usize| {
        let through =
            |i: usize| Passage { cable: i, near: hole(robot, i, k), far: hole(robot, i, k + 1) };
        (0..anchors.len()).filter(|&i| anchors[i] > k).map(through).collect()
    };
    Ok((0..at.len() - 1).map(of_span).collect())
}

/// Where the cable passes a disk: the hole of its list, whatever course it takes between them.
fn hole(robot: &Robot, cable: usize, disk: usize) -> Vec3 {
    let disks = robot.disks();
    match (&robot.cables()[cable].routing, disks.holes) {
        (Routing::Holes { holes, .. }, Some(count)) => {
            let angle = core::f64::consts::TAU * (holes[disk] as f64 - 1.0) / count as f64;
            let radius = disks.hole_circle_radii[disk];
            Vec3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
        }
        _ => robot.routes()[cable].at(disks.arc_lengths[disk]).offset,
    }
}

fn between_disks(model: ModelKind, cable: usize, of: &Cable) -> SolveError {
    let path = match of.ends_at {
        Some(_) => format!("cables[{cable}].ends_at"),
        None => format!("cables[{cable}]"),
    };
    SolveError::Unsupported {
        model,
        path,
        what: "a cable anchored between two disks",
        advice: "anchor it at a disk, or put a disk where it ends, or use cosserat",
    }
}
