//! Quantities of a robot and a case that an answer can be differentiated by.

mod motor_change;
mod path;
mod quantity;
mod route_change;
mod scale;
mod section_change;
mod value;

pub(crate) use motor_change::MotorChange;
pub use path::UnknownParameter;
pub use path::numbered;
pub use quantity::{Parameter, StiffnessPart};
pub(crate) use route_change::RouteChange;
