//! The equilibrium of one cross-section (design of the total wrench).
//!
//! With `N` and `M` the force and moment that everything beyond a cut exerts on it, in the body
//! frame, the strains `v` (extension and shear) and `u` (curvature and twist) satisfy
//!
//! ```text
//! K_se (v − e₃) + Σ τᵢ tᵢ       = N          (1)
//! K_bt (u − u*) + Σ τᵢ rᵢ × tᵢ  = M          (2)
//! tᵢ = pᵢ′/‖pᵢ′‖,   pᵢ′ = v + u × rᵢ + rᵢ′   (3)
//! ```
//!
//! They are the stationarity conditions of the strictly convex potential
//! `½‖ξ − ξ*‖²_K + Σ τᵢ‖pᵢ′‖ − N·v − M·u`, so there is one answer, and Newton's method with the
//! exact Hessian — the block matrix of the paper's eq. (3) — finds it. All is written in 3×3 blocks.
//!
//! `K` is diagonal, or has terms beside its diagonal (`Coupling`). An axis of `v` may be *held*: the
//! rod does not stretch, or does not shear. Its compliance is zero, its strain stays what it is at
//! rest, and its equation in (1) only says what the reaction is. In the Hessian it has an infinite
//! pivot, whose inverse is the zero that is wanted.

mod bare;
mod bending_friction;
pub(crate) mod block_diagonal;
mod cable_sums;
mod crossed;
mod crossing;
pub(crate) mod equilibrium;
mod fault;
pub(crate) mod lanes;
pub(crate) mod of_robot;
pub(crate) mod one_cable;
mod properties;
mod tangent;
#[cfg(test)]
mod tests;

pub(crate) use bending_friction::{BENDING_AXES, BendingFriction};
pub(crate) use cable_sums::CableGroup;
pub use crossed::CrossedSection;
pub(crate) use crossing::{BodyWrench, Crossing, Strain};
pub(crate) use equilibrium::{equilibrium, equilibrium_within, is_iterated, reach, step_tolerance};
pub(crate) use fault::{FOLDED, Fault, SectionFault};
pub use of_robot::{material_stiffness, section_compliance, section_stiffness};
pub(crate) use properties::{Section, Stiffness};
pub(crate) use tangent::Tangent;
