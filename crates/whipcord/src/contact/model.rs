//! What a model must do for contact to be solved with it.

use whipcord_numerics::{Pose, Vec3};

use crate::budget::Meter;
use crate::case::{Case, PointLoad};
use crate::error::SolveError;
use crate::shape::Wrench;
use crate::solution::Solution;

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

    /// Tangents of the backbone before and behind the watched place of this number, where it may have a corner there;
    /// such a place lies between two others.
    fn corner(&self, _place: usize) -> Option<[Vec3; 2]> {
        None
    }

    /// Length of each cable before actuation in m.
    fn initial_lengths(&self) -> &[f64];

    /// Whether its forces are in N: it knows the robot's stiffness.
    fn knows_forces(&self) -> bool;

    /// What the solve has spent of what its user lets it, and what ends it from outside.
    fn meter(&self) -> &Meter;

    /// What an iteration without contacts costs, relative to one of a rod of 100 steps.
    fn effort(&self) -> f64;

    /// What a solve may spend over the whole way, in iterations of a rod of 100 steps without contacts: each takes about a
    /// millisecond at most.
    fn budget(&self) -> f64 {
        3500.0
    }

    /// What it may spend once the way has led to the answer, and on another way from the other side.
    fn renewed_budget(&self) -> f64 {
        0.5 * self.budget()
    }

    /// What it may spend on the way into pipes, before the way to the answer: with it refusals take less than two seconds.
    fn insertion_budget(&self) -> f64 {
        INSERTION_BUDGET
    }

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

    /// Goes to the equilibrium without pushes that a search from rest finds, where steps from where it is lead to none: whether there is one. It
    /// stays where it is otherwise.
    fn search_alone(&mut self, _case: &Case) -> bool {
        false
    }

    /// How far it is from equilibrium: the largest change of a coordinate that is left, in rad.
    fn residual(&self) -> f64;

    /// Pose of a cross-section that is watched, or pushed when the model last looked.
    fn pose(&self, arc_length: f64) -> Pose;

    /// Centre of the watched place of this number.
    fn centre(&self, place: usize) -> Vec3 {
        self.pose(self.watched()[place]).position
    }

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
    /// yields, or less where that would be too far at once; the part that it has taken.
    fn advance(&mut self, changes: &[[f64; 6]], part: f64) -> Result<f64, SolveError>;

    /// Whether an even number of directions, mostly none, is unstable at the last equilibrium while the
    /// pushes stay as they are.
    fn stands_alone(&mut self) -> bool;

    /// The number of directions in which it leaves the last equilibrium while the pushes stay as they are, where dead moments count by the
    /// symmetric part of their tangent: half of one follows. `None` where that is not defined, under loads that have no potential and with
    /// friction, or not known.
    fn unstable_alone(&mut self) -> Option<usize>;

    /// Whether anything has touched a robot whose cables rub in their holes at an equilibrium that was kept.
    fn has_touched(&self) -> bool {
        true
    }

    /// Keeps the last equilibrium, to go back to.
    fn keep(&mut self);

    /// Pose of a cross-section when it was last kept, as nearly as that is known.
    fn pose_before(&self, arc_length: f64) -> Pose;

    /// Goes back to the equilibrium that was kept.
    fn go_back(&mut self);

    /// The answer to a case without obstacles.
    fn solve_free(&mut self, case: &Case) -> Result<Solution, SolveError>;

    /// The last equilibrium as an answer, without its contacts.
    fn solution(&mut self, case: &Case, pushes: &[Push]) -> Result<Solution, SolveError>;
}

/// What models of sections may spend on the way into pipes.
const INSERTION_BUDGET: f64 = 4500.0;

/// The case with the pushes as point loads.
pub(crate) fn with_pushes(case: &Case, pushes: &[Push]) -> Case {
    let mut case = case.clone();
    let turn = case.loads.to_base(case.base.rotation).conjugate();
    case.loads.points.extend(pushes.iter().map(|push| PointLoad {
        at: push.arc_length,
        force: turn.rotate(push.wrench.force),
        moment: turn.rotate(push.wrench.moment),
        follower: false,
    }));
    case
}

/// Shapes that are no farther apart than this, as a part of the length, are one.
const SAME_SHAPE: f64 = 1e-4;
/// The same where cables rub.
const NEAR_SHAPE: f64 = 1e-2;

/// Whether an answer without obstacles is the one that was kept clear of them: of several equilibria it may be another.
pub(crate) fn is_same_shape(free: &Solution, kept_clear: &Solution) -> bool {
    are_within(free, kept_clear, SAME_SHAPE)
}

/// The same of robots whose cables rub: the steps on the way among obstacles are coarser.
pub(crate) fn is_near(free: &Solution, kept_clear: &Solution) -> bool {
    are_within(free, kept_clear, NEAR_SHAPE)
}

fn are_within(free: &Solution, kept_clear: &Solution, part: f64) -> bool {
    let length = kept_clear.disks.arc_length.last().copied().unwrap_or(0.0);
    free.disks.distances(&kept_clear.disks).fold(0.0, f64::max) <= part * length
}
