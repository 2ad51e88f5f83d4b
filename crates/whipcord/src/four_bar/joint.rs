//! How the upper disk of a section stands on the lower one, under any of the objectives.

use whipcord_numerics::Pose;

use super::as_printed;
use super::bend::Bend;
use super::section::Section;

/// How the upper disk of a section stands on the lower one.
#[derive(Clone, Copy, Debug)]
pub(super) enum Joint {
    /// By the section's coordinates.
    Bend(Bend),
    /// On a rigid link at any angle to the disks.
    Link(Pose),
}

impl Joint {
    /// Pose of the upper disk in the frame of the lower one.
    #[inline]
    pub fn pose(self, section: &Section) -> Pose {
        match self {
            Self::Bend(bend) => bend.pose(section.length, section.chord),
            Self::Link(pose) => pose,
        }
    }

    /// The section's coordinates, straight where there are none.
    pub fn bend(self) -> Bend {
        match self {
            Self::Bend(bend) => bend,
            Self::Link(_) => Bend::STRAIGHT,
        }
    }

    /// Pose of the cross-section at the fraction `t` of the section.
    pub fn pose_at(self, t: f64, section: &Section) -> Pose {
        match self {
            Self::Bend(bend) => bend.pose_at(t, section.length, section.chord),
            Self::Link(pose) => as_printed::part(pose, t),
        }
    }

    /// The cables of the section with their lengths in it.
    pub fn lengths(self, section: &Section) -> impl Iterator<Item = (usize, f64)> + '_ {
        let turn = match self {
            Self::Bend(bend) => bend.turn(),
            Self::Link(_) => Bend::STRAIGHT.turn(),
        };
        section.passages.iter().map(move |passage| {
            let length = match self {
                // To the last bit what the prescribed lengths are computed from.
                Self::Bend(bend) if bend == section.rest => passage.initial,
                Self::Bend(_) => passage.length_only(&turn, section.length, section.chord),
                Self::Link(pose) => as_printed::length(pose, passage),
            };
            (passage.cable, length)
        })
    }
}
