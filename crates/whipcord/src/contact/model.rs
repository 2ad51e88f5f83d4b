//! What a model must do for contact to be solved with it.

use whipcord_numerics::Pose;

use crate::cancel::Cancel;
use crate::case::Case;
use crate::error::SolveError;
use crate::shape::{Solution, Wrench};

/// A dead wrench on one cross-section, base frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Push {
    /// Arc length in m.
    pub arc_length: f64,
    pub wrench: Wrench,
}

/// A model of a robot that responds to wrenches on its cross-sections. All poses, motions and wrenches
/// are in the frame of the base.
pub(crate) trait Compliant {
    /// Arc lengths in m at which the backbone is watched for obstacles: increasing, from base to tip,
    /// those of the disks among them.
    fn watched(&self) -> &[f64];

    /// Length of each cable before actuation in m.
    fn initial_lengths(&self) -> &[f64];

    /// Whether its forces are in N: it knows the robot's stiffness.
    fn knows_forces(&self) -> bool;

    /// What ends the solve from outside.
    fn cancel(&self) -> &Cancel;

    /// What an iteration without contacts costs, relative to one of a rod of 100 steps.
    fn effort(&self) -> f64;

    /// Makes its equations finer where the answer is not yet as accurate as was asked for; `true` where it then
    /// has to be solved again.
    fn refine(&mut self) -> Result<bool, SolveError>;

    /// Goes back to the robot at rest.
    fn reset(&mut self);

    /// Takes a known answer for the last equilibrium.
    fn start_from(&mut self, answer: &Solution);

    /// A force in N (or in the model's own measure, where it knows no stiffness) that changes the shape
    /// markedly: EI/L².
    fn force_scale(&self) -> f64;

    /// Looks at a case without its obstacles, and these wrenches, from where it is, and stays there.
    fn consider(&mut self, case: &Case, pushes: &[Push]) -> Result<(), SolveError>;

    /// How far it is from equilibrium: the largest change of a coordinate that is left, in rad.
    fn unsettled(&self) -> f64;

    /// Pose of a cross-section that is watched, or pushed when the model last looked.
    fn pose(&self, arc_length: f64) -> Pose;

    /// How each pushed cross-section moves with each component of each push, into `compliance` by
    /// rows: the velocity of its centre and its angular velocity by force and moment. Into `drift`, how it
    /// moves to equilibrium while the pushes stay as they are.
    fn compliance(
        &mut self,
        pushes: &[Push],
        compliance: &mut Vec<f64>,
        drift: &mut Vec<f64>,
    ) -> Result<(), SolveError>;

    /// Takes this part of the step to equilibrium under pushes that have changed so since it was asked how it
    /// yields.
    fn advance(&mut self, changes: &[[f64; 6]], part: f64) -> Result<(), SolveError>;

    /// Whether an even number of directions, mostly none, is unstable at the last equilibrium while the
    /// pushes stay as they are.
    fn stands_alone(&mut self) -> bool;

    /// Keeps the last equilibrium, to go back to.
    fn keep(&mut self);

    /// Pose of a cross-section when it was last kept, as nearly as that is known.
    fn pose_before(&self, arc_length: f64) -> Pose;

    /// Goes back to the equilibrium that was kept.
    fn go_back(&mut self);

    /// The last equilibrium as an answer, without its contacts.
    fn solution(&mut self, case: &Case, pushes: &[Push]) -> Result<Solution, SolveError>;
}
