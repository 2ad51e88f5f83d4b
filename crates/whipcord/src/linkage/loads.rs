//! The loads of a case, gathered at the disks.
//!
//! What is spread along a section falls to the disks at its ends by the law of the lever: force and
//! moment of a straight section are kept.

use whipcord_numerics::{GAUSS_3, UnitQuaternion, Vec3};

use super::layout::Section;
use crate::case::{Loads, Piece};
use crate::cosserat::loads::check;
use crate::error::SolveError;
use crate::model::ModelKind;
use crate::robot::Robot;
use crate::shape::Wrench;

/// What is applied to each disk.
#[derive(Clone, Debug, Default)]
pub(super) struct DiskLoads {
    /// In the frame of the base.
    pub dead: Vec<Wrench>,
    /// In the frame of the disk.
    pub followers: Vec<Wrench>,
    pub any: bool,
}

/// Refuses loads that act between disks, and gravity on a backbone of unknown mass.
pub(super) fn refuse(robot: &Robot, model: ModelKind, loads: &Loads) -> Result<(), SolveError> {
    check(robot, loads).map_err(|error| error.of(model))?;
    let between = |path: String, what| SolveError::Unsupported {
        model,
        path,
        what,
        advice: "loads act on its disks: put a disk there, or use cosserat-disks",
    };
    for (i, point) in loads.points.iter().enumerate() {
        let acts = point.force != Vec3::ZERO || point.moment != Vec3::ZERO;
        if acts && disk_at(robot, point.at).is_none() {
            return Err(between(format!("loads.point[{i}].at"), "a load between two disks"));
        }
    }
    for (i, mass) in loads.masses.iter().enumerate() {
        let weighs = mass.mass > 0.0 && loads.gravity.is_some_and(|g| g != Vec3::ZERO);
        if weighs && disk_at(robot, mass.at).is_none() {
            return Err(between(format!("loads.mass[{i}].at"), "a mass between two disks"));
        }
    }
    Ok(())
}

fn disk_at(robot: &Robot, arc_length: f64) -> Option<usize> {
    let near = 1e-9 * robot.backbone().length;
    robot.disks().arc_lengths.iter().position(|s| (s - arc_length).abs() <= near)
}

impl DiskLoads {
    /// Gathers loads that have not been refused; `base` is how the base is turned in their frame.
    pub fn gather(
        &mut self,
        robot: &Robot,
        sections: &[Section],
        loads: &Loads,
        base: UnitQuaternion,
    ) {
        let count = sections.len() + 1;
        for list in [&mut self.dead, &mut self.followers] {
            list.clear();
            list.resize(count, Wrench::default());
        }
        self.any = !loads.is_none();
        if !self.any {
            return;
        }
        let turn = loads.to_base(base);
        let Self { dead, followers, .. } = self;
        let mut apply = |disk: usize, force: Vec3, moment: Vec3, follower: bool| {
            let (at, turn) = if follower {
                (&mut followers[disk], UnitQuaternion::IDENTITY)
            } else {
                (&mut dead[disk], turn)
            };
            at.force += turn.rotate(force);
            at.moment += turn.rotate(moment);
        };
        apply(count - 1, loads.tip_force, loads.tip_moment, loads.tip_follower);
        for point in &loads.points {
            if let Some(disk) = disk_at(robot, point.at) {
                apply(disk, point.force, point.moment, point.follower);
            }
        }
        if let Some(gravity) = loads.gravity {
            let mut weigh = |disk: usize, mass: f64| apply(disk, gravity * mass, Vec3::ZERO, false);
            for mass in &loads.masses {
                if let Some(disk) = disk_at(robot, mass.at) {
                    weigh(disk, mass.mass);
                }
            }
            for (k, section) in sections.iter().enumerate() {
                weigh(k, section.mass[0]);
                weigh(k + 1, section.mass[1] + robot.disks().mass);
            }
        }
        let at = &robot.disks().arc_lengths;
        for load in &loads.distributed {
            for piece in load.profile.pieces() {
                for k in 0..sections.len() {
                    let [near, far] = shared(&piece, at[k], at[k + 1]);
                    apply(k, near.force, near.moment, load.follower);
                    apply(k + 1, far.force, far.moment, load.follower);
                }
            }
        }
        // What is applied to the clamped base bends nothing.
        (dead[0], followers[0]) = (Wrench::default(), Wrench::default());
    }
}

/// What of a piece of a profile falls to the disks at these two arc lengths.
fn shared(piece: &Piece, near: f64, far: f64) -> [Wrench; 2] {
    let [start, end] = piece.at;
    let (from, to) = (start.max(near), end.min(far));
    let mut ends = [Wrench::default(); 2];
    if to <= from {
        return ends;
    }
    for (t, weight) in GAUSS_3.nodes.iter().zip(GAUSS_3.weights) {
        let s = from + t * (to - from);
        let (along, lever) = ((s - start) / (end - start), (s - near) / (far - near));
        for (wrench, share) in ends.iter_mut().zip([1.0 - lever, lever]) {
            let amount = weight * (to - from) * share;
            let between = |[a, b]: [Vec3; 2]| a + (b - a) * along;
            wrench.force += between(piece.force) * amount;
            wrench.moment += between(piece.moment) * amount;
        }
    }
    ends
}
