//! Design of cable-driven continuum robots: which holes, routing, pre-bend or taper make the robot take a shape.
//!
//! [`design`] changes what is to be varied of a robot for one or several goals, each part by the method that proves most, and says what is proven.
//! Its parts: [`design_holes`] chooses the hole of each disk for some cables, so that the robot comes nearest to target shapes or brings its tip to a point;
//! without load the choice is proven to be the best of all. [`route_for_curve`] has the routing of one cable that bends a straight rod to a
//! curve, in closed form; [`rest_curvature_for_curve`] the pre-bend, and [`taper_for_curve`] the diameters, with which a robot takes a curve
//! under its loads. This crate opens no files and reads no clocks. The equations are those of `docs/theory/design.md`.

mod budget;
mod cable_by_cable;
mod cable_count;
mod candidates;
mod chebyshev;
mod choices;
mod criteria;
mod criterion;
mod curve;
mod design;
mod error;
mod goal;
mod hole_design;
mod named_curve;
mod pre_bend;
mod problem;
mod refine;
mod residuals;
mod route;
mod shape_search;
mod soft_volume;
mod span_table;
mod swap_search;
mod tail_bound;
mod taper;
mod tip_search;
mod tolerances;
mod unknown;
mod vary;

pub use budget::Ended;
pub use choices::{FixedHole, HoleRules};
pub use criterion::{Criterion, CriterionResult, Quantity, WORKSPACE_RADIUS};
pub use curve::Curve;
pub use design::design;
pub use error::DesignError;
pub use goal::ShapeGoal;
pub use hole_design::{HoleDesign, HoleSearchOptions, Proof, design_holes};
pub use named_curve::{CurveKind, NamedCurve};
pub use pre_bend::{PreBend, rest_curvature_for_curve};
pub use problem::{
    Design, DesignGoal, DesignOptions, Finding, GoalResult, Known, TargetShape, Unconverged, spread,
};
pub use route::{CurveRoute, route_for_curve};
pub use taper::{Taper, taper_for_curve};
pub use tolerances::{Sampled, Tolerances, TolerancesResult, sample_tolerances};
pub use vary::{UnknownVary, Vary};
