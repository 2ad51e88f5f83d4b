//! What a survey of a workspace finds.

use whipcord::Vec3;
use whipcord::kinematics::Dexterity;

use crate::limit::Limit;

/// A voxel that the tip can be brought into.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Its number along each axis of the world; the voxel of the number 0 begins at 0.
    pub index: [i32; 3],
    /// Where the tip is in it, in m.
    pub tip: Vec3,
    /// The direction of the backbone there.
    pub axis: Vec3,
    /// The commands that bring it there, by [`InverseSolver::actuators`](crate::InverseSolver::actuators).
    pub commands: Vec<f64>,
    /// Whether the tip can be brought to the centre of the voxel.
    pub is_full: bool,
    /// How well the commands move the tip there.
    pub dexterity: Dexterity,
    /// Least and greatest stiffness of the tip in N/m against a force, the commands held; `None` where the model knows no loads.
    pub stiffness: Option<[f64; 2]>,
}

/// A point of the boundary of a workspace, and what holds the tip back there.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundaryPoint {
    /// In m.
    pub tip: Vec3,
    /// Outward, of unit length.
    pub normal: Vec3,
    /// The limits that are met; none where the directions of all commands lie in the boundary.
    pub limits: Vec<Limit>,
}
