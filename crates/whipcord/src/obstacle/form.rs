//! The forms of obstacles.

use std::sync::Arc;

use whipcord_numerics::Vec3;

use super::mesh::Mesh;
use super::pipe::Pipe;
use super::solid;
use super::superellipsoid::Superellipsoid;
use super::surface::Surface;

/// The form of an obstacle, in the obstacle's frame.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// All that lies below the plane z = 0: a floor, or a wall.
    HalfSpace,
    /// A ball around the origin.
    Sphere {
        /// In m.
        radius: f64,
    },
    /// All that lies within a radius of a segment of the z axis whose middle is the origin.
    Capsule {
        /// In m.
        radius: f64,
        /// Length of the segment in m: from tip to tip it is longer by twice the radius.
        length: f64,
    },
    /// A box whose middle is the origin and whose edges go along the axes.
    Box {
        /// Lengths of the edges in m.
        size: Vec3,
    },
    /// A solid cylinder about the z axis whose middle is the origin.
    Cylinder {
        /// In m.
        radius: f64,
        /// In m.
        length: f64,
    },
    /// A bore that the robot is inside of.
    Pipe(Pipe),
    /// A superellipsoid: a ball, an ellipsoid, a box with rounded edges, and what lies between.
    Superellipsoid(Superellipsoid),
    /// A body that triangles enclose.
    Mesh(Arc<Mesh>),
}

impl Form {
    /// The name in robot files.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::HalfSpace => "half-space",
            Self::Sphere { .. } => "sphere",
            Self::Capsule { .. } => "capsule",
            Self::Box { .. } => "box",
            Self::Cylinder { .. } => "cylinder",
            Self::Pipe(_) => "pipe",
            Self::Superellipsoid(_) => "superellipsoid",
            Self::Mesh(_) => "mesh",
        }
    }

    pub(super) fn surface(&self, point: Vec3) -> Surface {
        match self {
            Self::HalfSpace => Surface { distance: point.z, normal: Vec3::Z },
            &Self::Sphere { radius } => solid::ball(radius, point),
            &Self::Capsule { radius, length } => solid::capsule(radius, length, point),
            &Self::Box { size } => solid::cuboid(size, point),
            &Self::Cylinder { radius, length } => solid::cylinder(radius, length, point),
            Self::Pipe(pipe) => pipe.surface(point),
            Self::Superellipsoid(body) => body.surface(point),
            Self::Mesh(mesh) => mesh.surface(point),
        }
    }
}
