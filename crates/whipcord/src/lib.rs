//! Mechanics of cable-driven continuum robots whose cables are routed in any way.
//!
//! A [`Robot`] says what the robot is, a [`Case`] what is asked of it, and a model
//! ([`cosserat::Cosserat`], [`cosserat_disks::CosseratDisks`], [`four_bar::FourBar`],
//! [`constant_curvature::ConstantCurvature`]) answers with a
//! [`Solution`] or with a [`SolveError`] that says why there is none. SI units throughout; the base frame
//! has its origin at the base of the backbone and z along the backbone's tangent there. Shapes are in the
//! world frame, in which [`Case::base`] says where the base is; without it the two are the same.
//!
//! This crate opens no files and reads no clocks. It starts threads only with the feature `parallel`, and
//! only for [`jobs`] such as those of a [`batch`].

pub mod batch;
mod budget;
mod cable_overlap;
mod cancel;
pub mod case;
pub mod constant_curvature;
pub mod contact;
pub mod cosserat;
pub mod cosserat_disks;
pub mod derivatives;
pub mod differences;
pub mod error;
pub mod format;
pub mod four_bar;
mod grasp;
mod insertion_stop;
pub mod jobs;
pub mod kind;
pub mod kinematics;
mod length_miss;
mod linearization;
pub mod linkage;
pub mod model;
mod motor_state;
pub mod obstacle;
pub mod over_determined;
pub mod parameter;
pub mod piecewise_constant_curvature;
pub mod prepared;
pub mod presets;
pub mod pseudo_rigid_body;
mod refusal;
pub mod robot;
pub mod section;
pub mod shape;
pub mod solution;
mod statics;
pub mod stations;
mod warm_start;
pub mod warning;

pub use budget::Budget;
pub use cable_overlap::CableOverlap;
pub use cancel::Cancel;
pub use case::{
    Actuation, CableCommand, Case, DistributedLoad, LoadFrame, Loads, PointLoad, PointMass,
    Profile, Shortening,
};
pub use error::{Obstruction, SolveError};
pub use grasp::Grasp;
pub use insertion_stop::InsertionStop;
pub use kind::{CommandDerivatives, ModelKind};
pub use length_miss::LengthMiss;
pub use linearization::Linearization;
pub use model::{Differentiable, Model, at_rest};
pub use motor_state::MotorState;
pub use obstacle::{Form, MovableBody, Obstacle};
pub use parameter::{Parameter, StiffnessPart, UnknownParameter};
pub use prepared::Prepared;
pub use presets::ModelPreset;
pub use robot::{
    Along, Backbone, Cable, Disks, Drive, HoleOffset, Interpolation, Material, Motor, MotorCable,
    MotorDynamics, MotorLimits, Problem, RestCurvature, Robot, RobotError, Routing, Section,
    Stiffness,
};
pub use shape::{Shape, Wrench};
pub use solution::{
    CableState, Contact, Diagnostics, InternalState, NoStability, ObjectContact, ObjectState, Part,
    SlipState, Solution,
};
pub use statics::Statics;
pub use statics::friction::{HoleEquation, HoleFriction, HoleMemory, HoleResponse};
pub use statics::options::StabilityAnalysis;
pub use statics::passages::{Passage, passages as straight_passages};
pub use statics::path::branches::{
    BranchOptions, Branches, CriticalKind, CriticalPoint, Equilibrium,
};
pub use stations::Stations;
pub use warm_start::{Status, WarmStart};
pub use warning::Warning;
pub use whipcord_numerics::{Mat3, Pose, Twist, UnitQuaternion, Vec3, equally_spaced};

/// The examples of the page about Rust, so that they keep working.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/rust.md")]
struct Page;
