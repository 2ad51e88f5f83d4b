//! Disks that fit a pipe without clearance.

use whipcord_numerics::Vec3;

use super::model::Compliant;
use super::path::PathTracker;
use crate::error::Obstruction;
use crate::obstacle::{Form, Obstacle};

/// Disks with less clearance in a pipe than this part of the length wedge where they tilt.
const WEDGES: f64 = 1e-6;
/// So much clearance does not wedge them.
const CLEARANCE: f64 = 1e-5;

impl<M: Compliant> PathTracker<'_, M> {
    /// A disk that fits a pipe without clearance: where contact tilts it, the ellipse that its rim looks like along the pipe touches at the ends of its
    /// long axis only, and nothing there balances a force along the short one.
    pub(super) fn without_clearance(&self) -> Option<Obstruction> {
        let inside = |at: Vec3, obstacle: &Obstacle| match &obstacle.form {
            Form::Pipe(pipe) if obstacle.surface(at).distance > 0.5 * pipe.radius() => {
                Some(pipe.radius())
            }
            _ => None,
        };
        let mut tight: Option<(usize, &str, f64)> = None;
        for member in &self.pairs.disks {
            let centre = self.model.pose(member.arc_length).position;
            for (_, obstacle) in self.scene.iter() {
                let Some(radius) = inside(centre, obstacle) else { continue };
                let (clearance, disk) = (radius - member.body.reach(), member.part.disk()?);
                if clearance < tight.map_or(WEDGES * self.length, |(.., least)| least) {
                    tight = Some((disk, &obstacle.name, clearance));
                }
            }
        }
        let (disk, obstacle, clearance) = tight?;
        let enough = CLEARANCE * self.length;
        let (obstacle, clearance) = (obstacle.to_owned(), clearance.max(0.0));
        Some(Obstruction::NoClearance { obstacle, disk, clearance, enough })
    }
}
