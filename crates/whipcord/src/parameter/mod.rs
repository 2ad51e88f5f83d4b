//! Quantities of a robot and a case that an answer can be differentiated by.

mod path;
mod quantity;
mod route_change;
mod scale;
mod section_change;
mod value;

pub use path::UnknownParameter;
pub use path::numbered;
pub use quantity::{Parameter, StiffnessPart};
pub(crate) use route_change::RouteChange;
