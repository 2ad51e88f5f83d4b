//! What a robot is, from what was seen of it: estimates of its parameters with their uncertainty (see
//! `docs/theory/identification.md`, whose equations the code names).
//!
//! An [`Experiment`] is a case and what was seen of the robot in its steps; the robot is the same in all of
//! them. An [`Unknown`] is a number of the robot, which all experiments share, or one of a single case,
//! such as where its base was. [`identify`] finds the unknowns under which a model comes nearest to what was
//! seen, and says how sure they are and which of them the measurements cannot tell apart.
//!
//! `quantity` is what can be estimated, `forward` says what a model says would be seen; `evaluation` shares its `pieces` among threads, each
//! with a `solver`; `columns` is how that changes by each `method`; `problem` is the least-squares problem, `noise` weighs it; `identify` is the search, which begins with `fewer_rows`, and `summary` makes its
//! `outcome`; `crate::uncertainty` and `unresolved` say what the
//! estimates are worth; `validation` and `selection` compare what was fitted with what was not.

mod analyses;
mod build;
mod check;
mod coarse;
mod columns;
mod corners;
mod drift;
mod error;
mod evaluation;
mod experiment;
mod fewer_rows;
mod forward;
mod identify;
mod linear;
mod logarithm;
mod method;
mod noise;
mod outcome;
mod parameter_path;
mod pieces;
mod problem;
mod profile;
mod quantity;
mod refused_rows;
mod registered;
mod repeatability;
mod rows;
mod selection;
mod sensitivity;
mod settings;
mod shared;
mod solver;
mod starts;
mod summary;
mod suspects;
mod unresolved;
mod validation;

pub use self::analyses::{Analyses, Asked, analyse};
pub use self::drift::{Drift, drift};
pub use self::error::{IdentifyError, Misfit, NoAnswer, NoAnswerReason};
pub use self::experiment::{Experiment, Prior, RowLabel, Unknown};
pub use self::identify::identify;
pub use self::outcome::{Estimate, Identified, Noise, Residual, Starts, Unstable};
pub use self::parameter_path::{List, ParameterPath, Parts, UnknownGroup};
pub use self::profile::{Profile, profile};
pub use self::quantity::{Quantity, UnknownQuantity};
pub use self::registered::registered;
pub use self::repeatability::{Repeatability, repeatability};
pub use self::rows::{OverDetermined, Row, Skipped, rows};
pub use self::selection::{Compared, Rung, compare_models, ladder};
pub use self::sensitivity::{Worth, best_measurements, sensitivity, worth_by_disk};
pub use self::settings::{Evaluation, Progress, Robustness, Settings};
pub use self::shared::Shared;
pub use self::suspects::{Confirmed, Suspect, single_cable, suspects};
pub use self::unresolved::{Share, Unresolved};
pub use self::validation::{Fold, HeldOut, Validated, cross_validate, hold_out, split};
pub use whipcord_numerics::least_squares::Status;
