//! Inverse problems of cable-driven continuum robots: which commands bring the robot to a point, a pose or a shape.
//!
//! An [`InverseSolver`] is built once for a model, a robot and a case, whose loads, obstacles and steps before count, and
//! answers for any number of targets ([`InverseSolver::reach`]). An answer says whether the target is reached, and which limits hold it back
//! where it is not. This crate opens no files and reads no clocks.
//!
//! ```
//! use whipcord::{Actuation, Backbone, Cable, Case, Disks, Material, Model, ModelKind, Robot, Routing, Section, Statics, Vec3};
//! use whipcord_inverse::{CableLimits, CommandedBy, InverseSolver, Limits, ReachOptions, ReachStatus, Target};
//!
//! let material = Material { young_modulus: Some(1.1e9), poisson_ratio: Some(0.3), ..Default::default() };
//! let backbone = Backbone { section: Some(Section::circle(0.003)), material, ..Backbone::new(0.18) };
//! let cables = (0..4).map(|k| {
//!     let angle = 1.57 * f64::from(k);
//!     Cable::new(format!("{k}"), Routing::Straight { angle, radius: 0.008 })
//! });
//! let robot = Robot::new(backbone, Disks::equally_spaced(0.18, 10, 0.008), cables.collect())?;
//! let model = Model::new(ModelKind::Cosserat, Default::default(), Actuation::Natural);
//! let limits = Limits::uniform(4, CableLimits { tension: [0.1, 5.0], ..Default::default() });
//! let mut solver = InverseSolver::new(&model, &robot, &Case::default(), &limits, CommandedBy::Case)?;
//! // A point of the shape under 2 N and 1 N.
//! let tip = model.solve(&robot, &Case::with_tensions(&[2.0, 1.0, 0.2, 0.1]))?.disks.poses[9].position;
//! let answer = solver.reach(&Target::Tip(tip), &ReachOptions::default())?;
//! assert_eq!(answer.status, ReachStatus::Reached);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod actuator;
mod antagonists;
mod atlas;
mod cell;
mod certificate;
mod control;
mod corners;
mod derivative_bounds;
mod descent;
mod error;
mod estimator;
mod evaluation;
mod few_steps;
mod foresight;
mod forward;
mod growth;
mod landmarks;
mod limit;
mod limits;
mod linear;
mod options;
mod path;
mod predicted;
mod proof;
mod rate_changes;
mod rates;
mod reach;
mod redundancy;
mod rod_cells;
mod rod_sections;
mod search;
mod secant;
mod second_order_start;
mod solver;
mod surveying;
mod target;
mod taylor;
mod voxel_search;
mod workspace;

pub use actuator::{Actuator, CommandedBy};
pub use atlas::AtlasRows;
pub use cell::{BoundaryPoint, Cell};
pub use certificate::NoProof;
pub use control::{ControlOptions, Controller, Cycle, Estimate};
pub use error::{InverseError, TargetProblem};
pub use estimator::EstimatorOptions;
pub use limit::Limit;
pub use limits::{CableLimits, Limits};
pub use options::{Preference, ReachOptions, ReachStatus};
pub use path::{Followed, Jump, JumpKind, PathPoint};
pub use reach::Reached;
pub use solver::{InverseSolver, SearchRange};
pub use target::{Miss, Target, Tolerance};
pub use workspace::{Workspace, WorkspaceOptions};
