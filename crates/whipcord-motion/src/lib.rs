//! Dynamics of cable-driven continuum robots: the motion of the Cosserat rod with its cables.
//!
//! A [`Simulation`] is made of a [`Robot`](whipcord::Robot), a [`Case`](whipcord::Case) and [`MotionOptions`], and taken forward step by step
//! under [`Commands`]. SI units throughout. The equations are those of `docs/theory/motion.md`, whose numbers the code cites.
//!
//! This crate opens no files, reads no clocks and starts no threads.

mod accurate;
mod adjoint;
mod analysis;
mod backward;
mod block;
mod by_shape;
mod cable_work;
mod chords;
mod coefficients;
mod commands;
mod complementarity;
mod conserving;
mod contact;
mod contact_rows;
mod contacts;
mod course;
mod cross_section;
mod drives;
mod element;
mod elimination;
mod energy;
mod equilibrium;
mod error;
mod forward;
mod free_base;
mod friction;
mod gradient;
mod hole_rows;
mod impact;
mod iteration;
mod lengths;
mod linear;
mod loads;
mod mesh;
mod modes;
mod node_loads;
mod one_stage;
mod options;
mod part;
mod part_length;
mod parts;
mod pose;
mod pull;
mod rod;
mod scheme;
mod simulation;
mod stage;
mod start;
mod state;
mod surroundings;
mod tangent;
mod trajectory;
mod unilateral;

pub use adjoint::Factors;
pub use commands::{CableDrive, Commands};
pub use course::Course;
pub use error::MotionError;
pub use gradient::{Gradient, Record, Seed};
pub use linear::Linearized;
pub use modes::Mode;
pub use options::{
    BaseMotion, Damping, Drag, Initial, LoadCourse, Method, MotionOptions, Start, StartRates,
};
pub use simulation::Simulation;
pub use state::{CableMotion, EnergyBalance, MotorMotion, State, StepDiagnostics};
pub use trajectory::Trajectory;
