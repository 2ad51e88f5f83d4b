//! Extents of cross-sections and stiffness of a backbone, as warnings need them.

use crate::robot::{Disks, Robot, Section};

/// Half extents in m of a cross-section and of its bore.
#[derive(Clone, Copy, Debug)]
pub(super) enum Extent {
    /// Outer and inner radius.
    Round(f64, f64),
    /// Half of width and height.
    Rectangle(f64, f64),
}

impl Extent {
    pub(super) fn at(section: &Section, disks: &Disks, arc_length: f64) -> Self {
        match section {
            Section::Round { outer, inner } => {
                Self::Round(0.5 * outer.at(disks, arc_length), 0.5 * inner.at(disks, arc_length))
            }
            Section::Rectangle { width, height } => Self::Rectangle(
                0.5 * width.at(disks, arc_length),
                0.5 * height.at(disks, arc_length),
            ),
        }
    }

    /// Greatest extent of the section in m.
    pub(super) fn thickness(self) -> f64 {
        match self {
            Self::Round(outer, _) => 2.0 * outer,
            Self::Rectangle(a, b) => 2.0 * a.max(b),
        }
    }

    /// How far its material reaches from the axis towards a point that lies in it; `None` for a point outside
    /// the material.
    pub(super) fn reach_around(self, x: f64, y: f64) -> Option<f64> {
        // A hole that touches the surface is on it, not inside.
        const INSIDE: f64 = 1.0 - 1e-9;
        let distance = x.hypot(y);
        match self {
            Self::Round(outer, inner) => {
                (distance < INSIDE * outer && distance * INSIDE >= inner).then_some(outer)
            }
            Self::Rectangle(a, b) => {
                if x.abs() >= INSIDE * a || y.abs() >= INSIDE * b {
                    return None;
                }
                let share = (x.abs() / a).max(y.abs() / b);
                Some(if share > 0.0 { distance / share } else { a.min(b) })
            }
        }
    }
}

/// Arc lengths in m between which everything about the cross-sections is linear.
pub(super) fn places(robot: &Robot) -> Vec<f64> {
    let length = robot.backbone().length;
    let mut places = robot.disks().arc_lengths.clone();
    places.extend(robot.backbone().places().into_iter().filter(|s| (0.0..=length).contains(s)));
    places.sort_by(f64::total_cmp);
    places.dedup();
    places
}

/// Least of the two bending stiffnesses in N·m² at its stiffest place; `None` where it is not known.
pub(super) fn bending_stiffness(robot: &Robot) -> Option<f64> {
    let (backbone, disks) = (robot.backbone(), robot.disks());
    let factor = |s: f64| backbone.segment_at(s).map_or(1.0, |(_, segment)| segment.bending_factor);
    let at = |s: f64| match &backbone.stiffness {
        Some(stiffness) => {
            let k = stiffness.at_end(disks, s, s);
            Some(factor(s) * k[3][3].min(k[4][4]))
        }
        None => {
            let section = backbone.section_at(disks, s)?;
            let modulus = backbone.material.young_modulus?;
            Some(factor(s) * modulus * section.second_moment_x.min(section.second_moment_y))
        }
    };
    places(robot).into_iter().map(at).try_fold(0.0_f64, |most, ei| Some(most.max(ei?)))
}

/// Whether the backbone is a soft body, in which cables run in channels.
pub(super) fn is_soft(robot: &Robot) -> bool {
    robot.backbone().material.young_modulus.is_some_and(|modulus| modulus <= super::kinds::SOFT)
}
