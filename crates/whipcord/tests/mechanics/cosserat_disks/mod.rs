//! The Cosserat rod with cables straight from hole to hole: to run one module,
//! `cargo test -p whipcord --test mechanics cosserat_disks::MODULE::`.

mod anchors;
mod compliance;
mod friction;
pub mod friction_study;
mod loads;
mod reference;
mod stability;
mod statics;
mod strong_pull;
mod study;
