//! Several cases, each solved by every model that can take it, side by side.

pub mod csv;
pub mod figures;
pub mod report;
pub mod study;
pub mod tables;
