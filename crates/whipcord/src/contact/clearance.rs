//! Disks that fit a pipe without clearance.

use super::model::Compliant;
use super::path::PathTracker;
use crate::error::Obstruction;
use crate::obstacle::Form;
use crate::solution::Part;

/// Disks with less clearance in a pipe than this part of the length wedge where they tilt.
const WEDGES: f64 = 1e-6;
/// So much clearance does not wedge them.
const CLEARANCE: f64 = 1e-5;

impl<M: Compliant> PathTracker<'_, M> {
    /// A disk that fits a pipe without clearance: where contact tilts it, the ellipse that its rim looks like along the pipe touches at the ends of its
    /// long axis only, and nothing there balances a force along the short one.
    pub(super) fn without_clearance(&self) -> Option<Obstruction> {
        let mut tight: Option<(usize, &str, f64)> = None;
        for pair in self.pairs.near.iter().filter(|pair| pair.force > 0.0) {
            let obstacle = self.scene.get(pair.obstacle);
            let (Form::Pipe(pipe), Part::Disk(disk)) = (&obstacle.form, pair.member.part) else {
                continue;
            };
            let clearance = pipe.radius() - pair.member.body.reach();
            let least = tight.map_or(WEDGES * self.length, |(.., least)| least);
            if (-WEDGES * self.length..least).contains(&clearance) {
                tight = Some((disk, &obstacle.name, clearance));
            }
        }
        let (disk, obstacle, clearance) = tight?;
        let enough = CLEARANCE * self.length;
        let (obstacle, clearance) = (obstacle.to_owned(), clearance.max(0.0));
        Some(Obstruction::NoClearance { obstacle, disk, clearance, enough })
    }
}
