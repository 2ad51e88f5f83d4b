//! What models say.

use serde::{Deserialize, Serialize};

use crate::protocol::common::{Pose, Warning};

/// What a model says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "status", rename_all = "snake_case")]
pub enum Answer {
    /// A shape.
    Solved(Box<Solved>),
    /// None, and why.
    Failed {
        /// The model.
        model: String,
        /// Why there is no answer, and what to do.
        message: String,
    },
}

/// A shape that a model found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Solved {
    /// The model.
    pub model: String,
    /// Position at each station in m.
    pub positions: Vec<[f64; 3]>,
    /// How the cross-section is turned at each station.
    pub orientations: Vec<[f64; 4]>,
    /// Between each two stations, as means in the frame of the cross-section: bending about x and y, twist, in 1/m, shear along x and y,
    /// stretch.
    pub strains: Vec<[f64; 6]>,
    /// The moments in N·m of the backbone itself that belong to these strains: bending about x and y, torsion; none where its stiffness
    /// is not known.
    pub moments: Option<Vec<[f64; 3]>>,
    /// What became of each cable.
    pub cables: Vec<CableState>,
    /// Where it touches obstacles.
    pub contacts: Vec<Contact>,
    /// What it exerts on each obstacle that it touches, where the model knows forces.
    pub grasps: Vec<Grasp>,
    /// Where the movable objects are in equilibrium.
    pub objects: Vec<PlacedObject>,
    /// What is left of the equations, relative to their scale.
    pub residual: f64,
    /// Newton iterations.
    pub iterations: usize,
    /// Least eigenvalue of the tangent stiffness relative to the backbone's own.
    pub stability: Option<f64>,
    /// Whether the robot leaves this shape at the slightest disturbance.
    pub unstable: bool,
    /// Time in s that the solve took.
    pub solve_time: f64,
    /// The model whose cable lengths drove this one, where it knows no tensions.
    pub driven_by: Option<String>,
    /// How the tip yields to a force, with the tensions held, where that was asked for.
    pub compliance: Option<Compliance>,
    /// Warnings about the shape, except that it is unstable: [`Self::unstable`] says that.
    pub warnings: Vec<Warning>,
}

/// A movable object in equilibrium.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlacedObject {
    /// The obstacle that it is, by its number in the scene.
    pub obstacle: usize,
    /// Where it is.
    pub pose: Pose,
}

/// What the robot exerts on an obstacle, all contacts together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Grasp {
    /// Number of the obstacle.
    pub obstacle: usize,
    /// How many contacts there are, and how many of them slide.
    pub contacts: usize,
    /// See [`Self::contacts`].
    pub sliding: usize,
    /// Sum of the normal forces in N.
    pub normal_force: f64,
    /// Force on the obstacle in N.
    pub force: [f64; 3],
    /// Moment on the obstacle about the origin of its frame in N·m.
    pub moment: [f64; 3],
    /// How far the contact nearest to sliding is from that: 0 where it slides, 1 where nothing pulls it; none without friction.
    pub slip_margin: Option<f64>,
}

/// What became of a cable.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CableState {
    /// Tension in N; none from a model that knows no forces.
    pub tension: Option<f64>,
    /// Length in m of its path.
    pub length: f64,
    /// Length in m of that path before actuation.
    pub initial_length: f64,
    /// Which shortening in m leads to this shape where it is told: of an elastic cable with what its tension stretches it by.
    pub shortening: f64,
    /// Whether it hangs loose.
    pub slack: bool,
    /// Tension in N between each two disks, where it rubs.
    pub span_tensions: Vec<f64>,
}

/// A point at which the robot touches an obstacle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// The obstacle, by its number in the scene.
    pub obstacle: usize,
    /// Arc length in m of the cross-section that touches.
    pub arc_length: f64,
    /// The point in m.
    pub point: [f64; 3],
    /// Unit normal out of the obstacle.
    pub normal: [f64; 3],
    /// With how much the obstacle pushes, in N.
    pub force: Option<f64>,
    /// With what it rubs, in N, across the normal.
    pub friction: Option<[f64; 3]>,
    /// Whether it sticks there.
    pub sticks: bool,
}

/// An ellipsoid of compliance: what a force of 1 N in any direction moves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "status", rename_all = "snake_case")]
pub enum Compliance {
    /// Its principal axes in the world.
    Known {
        /// In m/N.
        values: [f64; 3],
        /// Unit vectors.
        directions: [[f64; 3]; 3],
    },
    /// There is none, and why.
    Unknown {
        /// Why.
        message: String,
    },
}
