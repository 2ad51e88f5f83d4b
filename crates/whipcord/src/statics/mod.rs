//! What the statics of all models share.
//!
//! | module | content |
//! |---|---|
//! | `options` | discretisation and actuation of a rod |
//! | `command` | actuation of a cable: its tension or its length |
//! | `lengths`, `length_problem`, `length_newton`, `length_step` | tensions that give prescribed cable lengths, eq. (6) |
//! | `infeasible_lengths` | lengths that exclude one another |
//! | `rank` | redundant cables |
//! | `active_set` | which cables are taut at the end of a Newton step, eq. (13) |
//! | `perturbation` | stable equilibria on branches off the load path, by dead moments that are taken away again |
//! | `self_stress` | which cables at their lengths without tension constrain the rod |
//! | `grid`, `refinement` | integration steps, and the error that they leave |
//! | `section_runs`, `turned_sections`, `section_table`, `one_cable_table`, `step_table`, `lanes` | sections that are solved side by side, and how |
//! | `loads`, `strength` | loads at the nodes of a grid, and how strong they are for the rod |
//! | `convexity` | loads so weak that there is one equilibrium, eq. (16) |
//! | `runge_kutta` | state and stages of the integration of a rod under loads |
//! | `scales` | units of residuals |
//! | `elimination` | the linear system of multiple shooting, eq. (10) |
//! | `shared_unknowns` | tensions and load factor that all parts share, eq. (8) |
//! | `continuation` | step sizes of load continuation |
//! | `path` | equilibrium paths by arc length, limit points and branches |
//! | `quadratic_form`, `eigenvalue` | the second variation of the energy, and its least eigenvalue |
//! | `passages` | cables straight between disks |
//! | `friction` | friction of cables at their holes |
//! | `plastic_curvature` | what friction against bending holds along the backbone |
//! | `hold` | tensions that keep cables at their lengths, eq. (d4) |
//! | `local` | Jacobians and compliances of a place |
//! | `outcome`, `trace` | how a solve ended, and the record of its iterations |

pub(crate) mod active_set;
pub(crate) mod command;
pub(crate) mod continuation;
pub(crate) mod convexity;
pub(crate) mod eigenvalue;
pub(crate) mod elimination;
pub(crate) mod friction;
pub(crate) mod grid;
pub(crate) mod hold;
mod infeasible_lengths;
pub(crate) mod lanes;
mod length_newton;
mod length_problem;
mod length_step;
pub(crate) mod lengths;
pub(crate) mod loads;
pub(crate) mod local;
pub(crate) mod one_cable_table;
pub(crate) mod options;
pub(crate) mod outcome;
pub(crate) mod passages;
pub(crate) mod path;
pub(crate) mod perturbation;
pub(crate) mod plastic_curvature;
pub(crate) mod plastic_steps;
pub(crate) mod quadratic_form;
pub(crate) mod rank;
pub(crate) mod refinement;
pub(crate) mod runge_kutta;
pub(crate) mod scales;
pub(crate) mod section_runs;
pub(crate) mod section_table;
pub(crate) mod self_stress;
pub(crate) mod shared_unknowns;
pub(crate) mod step_table;
pub(crate) mod strength;
pub(crate) mod trace;
pub(crate) mod turned_sections;

use crate::case::Case;
use crate::error::SolveError;
use crate::robot::Robot;
use crate::solution::Solution;

/// Solves one case of one robot from cold. To solve many cases of a robot, build the model once
/// ([`Model::prepare`](crate::Model::prepare)).
pub trait Statics {
    /// The shape the robot takes.
    ///
    /// # Errors
    /// [`SolveError`] when the model cannot take the robot or the case, or finds no answer.
    fn solve(&self, robot: &Robot, case: &Case) -> Result<Solution, SolveError>;
}
