//! One file for each verb. A verb returns its text for standard output, so that nothing stands there
//! when it fails.

pub mod bench;
pub mod camera;
pub mod check;
pub mod compare;
pub mod completions;
pub mod design;
mod design_report;
pub mod examples;
pub mod export;
pub mod fit;
pub mod man;
pub mod measure;
pub mod measure_stereo;
pub mod modes;
pub mod new;
pub mod overlay;
pub mod reach;
mod reach_path;
mod reach_picture;
mod reach_words;
pub mod schema;
pub mod score;
pub mod simulate;
mod simulate_picture;
pub mod solve;
pub mod stiffness;
pub mod sweep;
pub mod view;
pub mod workspace;
