//! What is asked of every model: the pose of the base, batches, cables locked in number, and the ends of what quantities may be.

mod base_pose;
mod batch;
mod bending_friction;
mod bending_friction_contact;
mod beyond_buckling;
mod both_frictions;
mod branches;
mod cancelled;
mod capabilities;
#[allow(clippy::print_stdout, reason = "prints the table of docs/theory/critical-loads.md")]
mod critical_loads;
mod driven;
mod equilibrium;
mod gradients;
pub mod hole_friction;
mod hole_offset;
mod independent_steps;
mod limits;
mod locked;
mod motors;
mod over_determined;
mod real_time;
mod surface_strain;
