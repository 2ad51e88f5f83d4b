//! What stands in the robot's way.
//!
//! Every form says of a point how far from its surface it is, with a sign, and which way leads out.
//! `docs/theory/obstacles.md` has the definitions.

mod centreline;
mod mesh;
mod nearest;
mod pipe;
mod solid;
mod superellipsoid;
mod surface;
mod topology;

use std::sync::Arc;

use whipcord_numerics::{Pose, Vec3};

use crate::robot::limits::check_pose;
use crate::robot::{RobotError, limits};

pub use centreline::Bends;
pub use mesh::{Mesh, MeshFile};
pub use pipe::Pipe;
pub use superellipsoid::Superellipsoid;
pub use surface::Surface;

/// A rigid body, fixed in the world, that the robot must not enter.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// What messages and reports call it.
    pub name: String,
    /// Its form, in its own frame.
    pub form: Form,
    /// Where that frame is in the world.
    pub pose: Pose,
    /// Coefficient of Coulomb friction between it and the robot; 0 for none.
    pub friction: f64,
}

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

impl Obstacle {
    /// The surface as a point in the world sees it.
    #[must_use]
    pub fn surface(&self, point: Vec3) -> Surface {
        let local = self.pose.rotation.conjugate().rotate(point - self.pose.position);
        let Surface { distance, normal } = self.form.surface(local);
        Surface { distance, normal: self.pose.rotation.rotate(normal) }
    }

    /// Whether it has friction.
    pub(crate) fn has_friction(&self) -> bool {
        self.friction > 0.0
    }

    pub(crate) fn check(&self) -> Result<(), RobotError> {
        check_pose(&self.pose)?;
        limits::FRICTION.check("friction", self.friction)?;
        let tube = |radius, length| {
            limits::LENGTH.check("radius", radius)?;
            limits::LENGTH.check("length", length)
        };
        match self.form {
            Form::Sphere { radius } => limits::LENGTH.check("radius", radius),
            Form::Capsule { radius, length } | Form::Cylinder { radius, length } => {
                tube(radius, length)
            }
            Form::Box { size } => limits::LENGTH.check_vector("size", size),
            // Valid by construction.
            Form::HalfSpace | Form::Pipe(_) | Form::Superellipsoid(_) | Form::Mesh(_) => Ok(()),
        }
    }
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

    fn surface(&self, point: Vec3) -> Surface {
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
