//! What a robot is, from what was seen of it: estimates of its parameters with their uncertainty (see
//! `docs/theory/identification.md`, whose equations the code names).
//!
//! An [`Experiment`] is a case and what was seen of the robot in its steps; the robot is the same in all of
//! them. An [`Unknown`] is a number of the robot, which all experiments share, or one of a single case,
//! such as where its base was. [`identify`] finds the unknowns under which a model comes nearest to what was
//! seen, and says how sure they are and which of them the measurements cannot tell apart.
//!
//! `quantity` is what can be estimated, `forward` computes what a model says would be seen, `columns` how that
//! changes by each `method`; `problem` is the least-squares problem, `noise` weighs it; `identify` is the search and `summary` makes its
//! `outcome`; `crate::uncertainty` and `unresolved` say what the
//! estimates are worth; `validation` and `selection` compare what was fitted with what was not.

mod build;
mod check;
mod columns;
mod error;
mod experiment;
mod forward;
mod identify;
mod logarithm;
mod method;
mod noise;
mod outcome;
mod problem;
mod quantity;
mod selection;
mod settings;
mod shared;
mod summary;
mod unresolved;
mod validation;

pub use self::error::{IdentifyError, Misfit, NoAnswer, NoAnswerReason};
pub use self::experiment::{Experiment, Prior, Unknown};
pub use self::identify::identify;
pub use self::outcome::{Estimate, Identified, Noise, Residual, Unstable};
pub use self::quantity::{Quantity, UnknownQuantity};
pub use self::selection::{Compared, compare_models};
pub use self::settings::{Robustness, Settings};
pub use self::shared::{List, ParameterPath, Shared, UnknownGroup};
pub use self::unresolved::{Share, Unresolved};
pub use self::validation::{Fold, Validated, cross_validate};
pub use whipcord_numerics::least_squares::Status;
