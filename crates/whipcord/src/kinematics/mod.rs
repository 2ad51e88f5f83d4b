//! What derivatives of any model say of a robot at one place: how it moves with its cables, how it
//! yields to a load.

mod ellipsoid;
mod local;
mod matrix6;

pub use ellipsoid::{Dexterity, PrincipalAxes, dexterity, principal_axes};
pub use local::{
    Compliance, ComplianceUnknown, Compliances, DerivativeMethod, DrivenBy, Local, OneSided,
};
pub use matrix6::Matrix6;
