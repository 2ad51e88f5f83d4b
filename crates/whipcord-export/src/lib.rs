//! Robots for other programs: MJCF for `MuJoCo`, URDF, VTK for `ParaView`, glTF and STEP.
//!
//! MJCF and URDF share a chain of rigid bodies, the other formats share curves and surfaces of the solved shape. Nothing
//! is written here: [`export`] gives the bytes of files, and in words what is not in them.

mod answers;
mod chain;
mod drawing;
mod error;
mod files;
mod format;
mod gltf;
mod guides;
mod job;
mod mjcf;
mod nodal;
mod places;
mod section_force;
mod step;
mod urdf;
mod vtk;
mod xml;

pub use error::ExportError;
pub use files::{Exported, ExportedFile};
pub use format::{Format, export};
pub use job::Job;
