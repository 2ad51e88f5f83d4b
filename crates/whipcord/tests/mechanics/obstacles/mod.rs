//! What stands in the way, and how far off it is.

mod exact;
mod forms;
mod meshes;
mod properties;
