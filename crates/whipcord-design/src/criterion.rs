//! What a design is to achieve beside its targets: objectives with weights, and hard constraints.

use core::fmt;

use whipcord::Vec3;

/// A quantity of a robot and its cases.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Quantity {
    /// Tensions of all cables under all targets in N. An objective makes their squares small; a constraint limits the greatest.
    Tension,
    /// Least distance in m of backbone and disks from the obstacles of the cases, for the shapes without contact: negative where such a shape would penetrate. An
    /// objective makes it large; a constraint limits it from below.
    Clearance,
    /// Stiffness of a disk in N/m: a force on its centre by how far it moves, under each target with the commands held. An objective makes it large; a constraint
    /// limits it from below.
    Stiffness {
        /// Number of the disk, from 0.
        disk: usize,
        /// Of the force and of the motion in the world, of unit length; `None` for the direction with the least stiffness.
        direction: Option<Vec3>,
    },
    /// Volume in m³ of what is within [`WORKSPACE_RADIUS`] lengths of places of the tip, with commands all over their limits. An objective makes it large; a
    /// constraint limits it from below.
    Workspace,
}

/// Of the balls round places of the tip that a workspace consists of, as a part of the length of the backbone.
pub const WORKSPACE_RADIUS: f64 = 0.04;

impl Quantity {
    /// The names of the quantities.
    pub const NAMES: [&str; 4] = ["tension", "clearance", "stiffness", "workspace"];

    /// Its name.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Tension => "tension",
            Self::Clearance => "clearance",
            Self::Stiffness { .. } => "stiffness",
            Self::Workspace => "workspace",
        }
    }

    /// Whether a constraint limits it from above; the others are limited from below.
    #[must_use]
    pub const fn is_limited_above(&self) -> bool {
        matches!(self, Self::Tension)
    }

    /// Unit of its values.
    #[must_use]
    pub const fn unit(&self) -> &'static str {
        match self {
            Self::Tension => "N",
            Self::Clearance => "m",
            Self::Stiffness { .. } => "N/m",
            Self::Workspace => "m^3",
        }
    }
}

/// An objective, a hard constraint, or both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Criterion {
    /// Of what.
    pub quantity: Quantity,
    /// How much the objective counts beside the squares of the distances from the targets, these as parts of the length of the backbone; `None` for a
    /// constraint alone. Objectives are relative: of a tension to its greatest, of a clearance to the length, of compliance and volume to those of
    /// the robot that the design begins with.
    pub weight: Option<f64>,
    /// What a constraint limits the quantity by, from above or below ([`Quantity::is_limited_above`]); `None` for an objective alone.
    pub limit: Option<f64>,
}

impl Criterion {
    /// Whether a value is within the limit.
    #[must_use]
    pub fn is_met_by(&self, value: f64) -> bool {
        self.limit.is_none_or(|limit| match self.quantity.is_limited_above() {
            true => value <= limit,
            false => value >= limit,
        })
    }
}

impl fmt::Display for Criterion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.quantity.name())?;
        if let Quantity::Stiffness { disk, direction } = self.quantity {
            write!(f, " of disk {}", disk + 1)?;
            if let Some(Vec3 { x, y, z }) = direction {
                write!(f, " along ({x:.3}, {y:.3}, {z:.3})")?;
            }
        }
        Ok(())
    }
}

/// What a design makes of a criterion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CriterionResult {
    /// The criterion.
    pub criterion: Criterion,
    /// Of all targets the value that is farthest from what is wanted: the greatest tension, else the least value.
    pub value: f64,
    /// The same of the robot that the design began with, where that has an answer.
    pub before: Option<f64>,
}

impl CriterionResult {
    /// Whether the value is within the limit.
    #[must_use]
    pub fn is_met(&self) -> bool {
        self.criterion.is_met_by(self.value)
    }
}
