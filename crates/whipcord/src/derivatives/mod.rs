//! Exact derivatives of an answer (see `docs/theory/derivatives.md`).
//!
//! The answer solves discrete equations; the implicit function theorem gives its derivative from
//! their linearisation. From the inside out: under loads `replay` goes over the steps once more and
//! linearises every stage, and `forward` combines the stages of a step for several columns at a time
//! (`lanes`); without load the sections of the `quadrature` do, through the steps of `magnus`; `linear`
//! is the choice between them. `elimination` solves the linear problem between base and tip; `partials`
//! says where a parameter enters, with `mass_change` and `spread_change`; `touching` adds what the contacts of an answer push; `adjoint` is the way back through a step and `backward` all of it. `columns` puts together
//! what one source changes, with `along_step` for what lies within a step, `change` is what comes out, `at_place` what is said of one place, put together in `local`. `rod` is what is kept of an
//! answer and `of_answer` makes it; `cables`, `setting`, `node_change`, `effect` and `column` are data of these. Where cables run straight
//! from disk to disk, `spans` makes one map of the steps between two disks and of the cables, each of which is a `chord`. Where cables rub, `strands` are the pieces of them that have
//! tensions of their own, which follow from `sliding_holes`, and `hole_source` says where a parameter enters their holes. `coordinates` has the same of
//! models that have generalised coordinates for a rod, from their `linear_system`. `command_changes` are
//! the changes with commands alone, of a rod, at a fraction of the cost of all derivatives, without load by `tension_motions`; `tip_rates` those of the tip, from its `tension_rates`, in memory that is
//! kept.
//!
//! What is differentiated is the discrete solution, so that derivatives agree with differences of
//! [`crate::cosserat::Cosserat::solve`] on the same steps to rounding, and with those of the rod to its
//! discretisation error. `step_ends`, `plastic_change` and `friction_change` are what friction against bending takes to the next
//! step of actuation. Only what a load does to a rod that has none is compared to solutions of
//! another integrator, that of the loaded rod.

mod adjoint;
mod along_step;
mod at_place;
mod backward;
mod cables;
mod change;
mod chord;
mod column;
mod columns;
mod command_changes;
mod coordinates;
mod effect;
mod elimination;
mod forward;
mod friction_change;
mod hole_source;
mod linear;
mod linear_system;
mod local;
mod magnus;
mod mass_change;
mod node_change;
mod of_answer;
mod open;
mod partials;
mod plastic_change;
mod quadrature;
mod replay;
mod rest_changes;
mod rod;
mod setting;
mod sliding_holes;
mod spans;
mod spread_change;
mod step_ends;
mod stiffness_change;
mod strands;
mod tension_motions;
mod tension_rates;
mod tip_rates;
mod touching;

pub(crate) use self::along_step::Caused;
pub use self::backward::{Cotangent, Gradient};
pub(crate) use self::cables::{Cables, StraightCables};
pub use self::change::{Change, Place};
pub(crate) use self::column::unit_wrench;
pub(crate) use self::command_changes::{CommandedCable, TensionChanges};
pub use self::coordinates::CoordinateDerivatives;
pub(crate) use self::coordinates::{CoordinateCable, SolvedCoordinates};
pub(crate) use self::hole_source::hole_source;
pub(crate) use self::linear_system::{Equations, KnownPlaces, LinearSystem, ParameterChange};
pub(crate) use self::node_change::NodeChange;
pub(crate) use self::of_answer::{AnswerContacts, AnswerOnWay, OpenStrands, SlidingAnswer, Solved};
pub(crate) use self::open::{Motion, OpenChange, StepGap};
pub(crate) use self::plastic_change::plastic_left;
pub(crate) use self::replay::{Answer, Varying};
pub(crate) use self::rest_changes::RestChanges;
pub use self::rod::Derivatives;
pub(crate) use self::rod::NoDerivatives;
pub(crate) use self::sliding_holes::AnswerHoles;
pub(crate) use self::spans::StraightSpan;
pub(crate) use self::strands::{PLACES, Share, Strands};
pub(crate) use self::tension_rates::{DrivenCables, TensionRatesMemory};
pub(crate) use self::tip_rates::{AnswerLists, Driven, TipRatesMemory};
pub(crate) use self::touching::{ContactGain, gravity_change};
pub use crate::statics::hold::Hold;
