//! From checked tables to the library's types, one reader per table.

mod backbone;
mod base;
mod cables;
mod disks;
mod fit;
mod loads;
mod measured;
mod reference;

pub(crate) use backbone::backbone;
pub(crate) use base::base;
pub(crate) use cables::{cable, command, step};
pub(crate) use disks::disks;
pub(crate) use fit::fit;
pub use fit::{Fit, quantity};
pub(crate) use loads::loads;
pub(crate) use measured::{Extent, read as measured};
pub use measured::{LENGTH_UNITS, Measured, MeasuredDisk, MeasuringCamera, load_markers};
pub use reference::Reference;
pub(crate) use reference::reference;

use whipcord::Vec3;

use crate::check::Fields;

fn vec3(fields: &Fields, name: &str) -> Option<Vec3> {
    fields.vector(name).map(|[x, y, z]| Vec3::new(x, y, z))
}
