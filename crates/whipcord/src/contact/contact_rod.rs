//! What the Cosserat rods among obstacles give: rods that take one step of Newton's method at a time.

use whipcord_numerics::Pose;

use super::dense_output::DenseOutput;
use super::noted::NotedEnd;
use super::refinement::Refinement;
use crate::budget::Meter;
use crate::case::Case;
use crate::derivatives::Derivatives;
use crate::error::SolveError;
use crate::parameter::Parameter;
use crate::robot::Robot;
use crate::solution::Solution;
use crate::statics::friction::Standing;
use crate::statics::grid::Grid;
use crate::statics::options::{Accuracy, Options};
use crate::statics::plastic_curvature::PlasticCurvature;

/// A rod that stands where it is, in equilibrium or not, under loads and wrenches on places of it. Under the wrenches of its
/// contacts alone a robot may buckle though the contacts hold it, so that an equilibrium under given wrenches cannot be asked
/// for: it takes one step of Newton's method at a time, and [`crate::contact`] changes the wrenches along with the shape.
pub(crate) trait ContactRod: Default {
    /// Where it stands, to go back to.
    type Kept: Default;

    /// What a step costs in an iteration, relative to one of a rod whose cables follow its curve.
    const WORK_OF_STEP: f64;

    /// How fine its steps are.
    fn refinement(&mut self) -> &mut Refinement;

    /// Forgets where it stands.
    fn reset(&mut self);

    /// Sets the plastic curvature that the steps of actuation before left; all of the way to the next answer has it.
    fn set_plastic(&mut self, left: &PlasticCurvature);

    /// The plastic curvature that it leaves where it stands, in equilibrium.
    fn plastic_left(&self, robot: &Robot, case: &Case) -> Result<PlasticCurvature, SolveError>;

    /// Looks at a case in which wrenches on the places `pushes`, in m, are among the loads, and stays where it is. It starts from
    /// `warm`, or from the robot without any load or tension.
    fn look(
        &mut self,
        robot: &Robot,
        options: &Options,
        case: &Case,
        places: (&[f64], &[f64]),
        warm: Option<&Solution>,
    ) -> Result<(), SolveError>;

    /// How many steps it has from base to tip.
    fn steps(&self) -> usize;

    /// How many tensions the dense equations of its holes have, where cables rub.
    fn rubbing_tensions(&self) -> usize;

    /// What is left of its equations.
    fn gap(&self) -> f64;

    /// Its frames, in the frame of the base.
    fn shape(&self) -> &DenseOutput;

    /// The frame of a cross-section where it was kept.
    fn pose_before(kept: &Self::Kept, arc_length: f64) -> Pose;

    /// Linearises the equations where it stands, with these places of pushes.
    fn linearise(&mut self, robot: &Robot, case: &Case) -> Result<(), SolveError>;

    /// How the places of pushes move with each component of each of them, by rows, and how with the step that is
    /// left, linearised.
    fn compliance(
        &mut self,
        places: impl Iterator<Item = f64>,
        compliance: &mut Vec<f64>,
        drift: &mut Vec<f64>,
    );

    /// The node of a station or place of a push.
    fn node(&self, arc_length: f64) -> usize;

    /// The derivatives where it stands, under these pushes, by these parameters too; the plastic curvature before changes with each
    /// of them as `history` says.
    fn differentiate(
        &self,
        robot: &Robot,
        case: &Case,
        history: &[PlasticCurvature],
        parameters: &[Parameter],
    ) -> Result<Derivatives, SolveError>;

    /// Its grid.
    fn grid(&self) -> Option<&Grid>;

    /// How the cables stand in their holes where it stands, in equilibrium, where every cable that rubs nowhere is one passage; `None`
    /// before it has stood anywhere.
    fn standing(&self) -> Option<Standing>;

    /// Where it stands, without keeping it.
    fn here(&self) -> Self::Kept;

    /// The derivatives at an equilibrium that was noted, which tell how all that its shape is interpolated from at the stations of this
    /// moves. It stands there then.
    ///
    /// # Errors
    /// [`SolveError::NoDerivatives`] where it is critical.
    fn differentiate_noted(
        &mut self,
        robot: &Robot,
        end: &NotedEnd<'_, Self::Kept>,
        parameters: &[Parameter],
    ) -> Result<Derivatives, SolveError>;

    /// Takes a part of Newton's step, with what changes of the pushes do, or less; the part that it has taken.
    fn advance(&mut self, changes: &[[f64; 6]], part: f64) -> f64;

    /// Whether an even number of directions, mostly none, is unstable while the loads stay as they are.
    fn stands(&mut self) -> bool;

    /// The number of directions in which it leaves an equilibrium while the loads stay as they are, see
    /// [`super::model::Compliant::unstable_alone`].
    fn unstable_directions(&mut self) -> Option<usize>;

    /// Keeps where it stands, which is in equilibrium.
    fn keep(&mut self, kept: &mut Self::Kept);

    /// Whether it stands at an equilibrium with what its holes remember, so that no answer says where it stands.
    fn has_history(&self) -> bool;

    /// Goes back to where it was kept.
    fn go_back(&mut self, kept: &Self::Kept);

    /// Halves the steps if the answer to a case is not yet known to the tolerance; `false` if it is, or if the steps
    /// are given.
    fn refine(&mut self, case: &Case, accuracy: Accuracy) -> Result<bool, SolveError>;

    /// The answer where it stands.
    fn solution(&mut self, case: &Case) -> Result<Option<Solution>, SolveError>;

    /// The answer to a case in which nothing touches, from a neighbouring one or from rest, by what is left of a budget.
    fn solve_free(
        &self,
        robot: &Robot,
        options: &Options,
        from: (&Case, Option<&Solution>),
        meter: &Meter,
    ) -> Result<Solution, SolveError>;
}
