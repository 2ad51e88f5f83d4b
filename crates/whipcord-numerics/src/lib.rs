//! Small dense blocks, rotations, interpolation and solvers for rod mechanics.
//!
//! Nothing here knows of robots or files. The hot paths are written out in 3×3 blocks: they need
//! no allocation, and they do not depend on how a general matrix library is vectorised by the
//! compiler of whoever builds this crate.

mod arcsine;
mod bounded;
mod continuation;
mod dense;
mod differences;
mod dot;
mod golden_section;
mod jet;
pub mod lanes;
pub mod least_squares;
mod magnus;
mod mat3;
mod newton;
mod orthogonal;
mod polynomial;
mod pose;
mod quadratic_programme;
mod quadrature;
mod quaternion;
pub mod random;
mod rank_one;
mod replaced_rows;
mod runge_kutta;
mod small_inverse;
mod spacing;
mod student;
mod sym3;
mod vec3;

pub use arcsine::asin_ratio;
pub use bounded::BoundedQuadratic;
pub use continuation::{ContinuationSteps, Ended, Missed, continuation};
pub use dense::{DenseLu, Singular, symmetric_eigen, symmetric_eigenvalues};
pub use differences::derivative;
pub use dot::dot;
pub use golden_section::golden_section;
pub use jet::Jet;
pub use magnus::magnus_6;
pub use mat3::{Ldlt3, Mat3};
pub use newton::{Equations, NewtonOptions, Reuse, Solved, Unsolved, newton};
pub use orthogonal::SingularValues;
pub use polynomial::{CubicError, PiecewiseCubic};
pub use pose::{Pose, Twist};
pub use quadratic_programme::{Constraint, NoMinimum, Programme, QuadraticProgramme};
pub use quadrature::{GAUSS_2, GAUSS_3, GAUSS_5, GaussRule, integral};
pub use quaternion::UnitQuaternion;
pub use rank_one::rank_one_terms;
pub use replaced_rows::{Factors, ReplacedRows};
pub use runge_kutta::{BUTCHER_5, ExplicitTableau, weighted_sum};
pub use small_inverse::SmallInverse;
pub use spacing::equally_spaced;
pub use student::student_quantile;
pub use sym3::Sym3;
pub use vec3::Vec3;
