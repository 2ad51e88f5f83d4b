//! Design of cable-driven continuum robots: which holes, routing, pre-bend or taper make the robot take a shape.
//!
//! [`design_holes`] chooses the hole of each disk for some cables, so that the robot comes nearest to target shapes or brings its tip to a point;
//! without load the choice is proven to be the best of all. [`route_for_curve`] has the routing of one cable that bends a straight rod to a
//! curve, in closed form; [`rest_curvature_for_curve`] the pre-bend, and [`taper_for_curve`] the diameters, with which a robot takes a curve
//! under its loads. This crate opens no files and reads no clocks. The equations are those of `docs/theory/design.md`.

mod candidates;
mod choices;
mod curve;
mod error;
mod goal;
mod hole_design;
mod pre_bend;
mod route;
mod shape_search;
mod span_table;
mod swap_search;
mod taper;
mod tip_search;

pub use choices::{FixedHole, HoleRules};
pub use curve::Curve;
pub use error::DesignError;
pub use goal::ShapeGoal;
pub use hole_design::{HoleDesign, HoleSearchOptions, Proof, design_holes};
pub use pre_bend::{PreBend, rest_curvature_for_curve};
pub use route::{CurveRoute, route_for_curve};
pub use taper::{Taper, taper_for_curve};
