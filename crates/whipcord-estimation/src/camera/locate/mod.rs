//! Where a camera is, from points of the world that it has seen: eq. (l1) to (l9) of
//! `docs/theory/cameras.md`.

mod error;
mod refine;
mod rig;
mod sighting;
mod single;
mod start;
mod uncertainty;

pub use error::LocateError;
pub(super) use refine::{Freedoms, InImage};
pub use rig::{LocatedRig, locate_rig};
pub use sighting::{Alternative, Sighting};
pub use single::{Located, locate, locate_orthographic};
pub(super) use start::{Cloud, plane_columns};
pub use uncertainty::{PoseUncertainty, pose_deviations};
