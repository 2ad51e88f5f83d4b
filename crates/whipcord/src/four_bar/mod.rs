//! The geometric model of Mahapatra, Ashwin and Ghosal: one four-bar section between each two
//! disks, bent as little as the prescribed lengths of the cables allow.
//!
//! `docs/theory/four-bar.md` derives the equations whose numbers stand in the code.

mod as_printed;
mod bend;
mod contact;
mod contact_response;
mod derivatives;
mod joint;
mod length;
mod linearization;
mod local;
mod measure;
mod one_cable;
mod options;
mod plane;
mod refusal;
mod section;
mod several;
mod solve;
#[cfg(test)]
mod tests;

pub use derivatives::Derivatives;
pub(crate) use local::solve_at;
pub use options::{Chord, Conflicts, LengthRule, Objective, Options, UnknownOption};
pub use solve::Workspace;

use crate::budget::Budget;
use crate::cancel::Cancel;
use crate::case::Case;
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::robot::Robot;
use crate::shape::Solution;
use crate::warm_start::{Status, WarmStart};

use section::Section;

/// The four-bar model of one robot.
///
/// It is purely geometric: driven by how much each cable is shortened, blind to loads and to
/// friction (which changes tensions, not prescribed lengths), and without forces in its answer,
/// but for the tensions that the strain-energy objective yields. Cables only pull: one that is
/// prescribed to be longer than its path is slack. Under the length rule `free` every other cable
/// has the prescribed length to 10⁻⁸ of the backbone's, or the solve is refused; when the lengths that
/// another rule gives a section contradict each other by little,
/// the answer is the least-squares one, and [`Diagnostics::residual`](crate::Diagnostics::residual)
/// is the largest difference from a prescribed length, relative to the length of the backbone.
///
/// ```
/// use whipcord::four_bar::{FourBar, Options, Workspace};
/// use whipcord::{Backbone, Cable, Case, Disks, Robot, Routing, Shortening};
///
/// // One section of 20 mm, a straight cable at 8 mm, shortened by 1 mm.
/// let cable = Cable::new("pull", Routing::Straight { angle: 0.0, radius: 0.008 });
/// let disks = Disks::equally_spaced(0.02, 2, 0.008);
/// let robot = Robot::new(Backbone::new(0.02), disks, vec![cable])?;
/// let model = FourBar::new(&robot, &Options::default())?;
/// let case = Case::with_shortenings(&[Shortening::Length(0.001)]);
/// let solution = model.solve(&case, None, &mut Workspace::default())?;
/// let bend = solution.shape.tip().rotation.log().norm();
/// assert!((bend - 2.0 * f64::asin(0.001 / 0.016)).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct FourBar {
    robot: Robot,
    options: Options,
    sections: Vec<Section>,
    /// Initial length of each cable in m.
    initial_lengths: Vec<f64>,
    /// Number of sections each cable passes.
    passages: Vec<usize>,
    /// Tension in N of a multiplier of 1 rad²/m, eq. (10), where it is known.
    tension_scale: Option<f64>,
    /// Arc lengths of the stations in m.
    stations: Vec<f64>,
}

impl FourBar {
    /// The model of a robot.
    ///
    /// # Errors
    /// [`SolveError::Unsupported`] for what a geometric model cannot take (elastic cables, tension as the
    /// command, and more with the objective `as-printed`), and
    /// [`SolveError::Missing`] when the strain-energy objective finds no Poisson's ratio.
    pub fn new(robot: &Robot, options: &Options) -> Result<Self, SolveError> {
        refusal::robot(robot, options)?;
        let sections = section::sections(robot, options.objective, options.chord)?;
        let mut initial_lengths = vec![0.0; robot.cables().len()];
        let mut passages = vec![0; robot.cables().len()];
        for passage in sections.iter().flat_map(|section| &section.passages) {
            initial_lengths[passage.cable] += passage.initial;
            passages[passage.cable] += 1;
        }
        let tension_scale = if options.objective == Objective::StrainEnergy {
            let reference = section::reference_stiffness(robot)?;
            let stiffness = section::modulus(robot).zip(reference).map(|(e, i)| e * i);
            stiffness.map(|stiffness| stiffness / (2.0 * robot.backbone().length))
        } else {
            None
        };
        Ok(Self {
            robot: robot.clone(),
            options: options.clone(),
            sections,
            initial_lengths,
            passages,
            tension_scale,
            stations: options.stations.arc_lengths(robot),
        })
    }

    /// The robot this model was built for.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    pub(crate) const fn set_budget(&mut self, budget: Budget) {
        self.options.budget = budget;
    }

    pub(crate) fn cancel_mut(&mut self) -> &mut Cancel {
        &mut self.options.cancel
    }

    /// Arc lengths of the stations in m.
    #[must_use]
    pub fn stations(&self) -> &[f64] {
        &self.stations
    }

    /// The shape under a case. It starts from its own guess, which is close; a warm start changes
    /// nothing, but for the contacts with obstacles that it has.
    ///
    /// # Errors
    /// [`SolveError::Unsupported`] for loads, [`SolveError::Missing`] for a cable without a
    /// shortening, [`SolveError::SectionOutOfReach`], [`SolveError::UnreachableLength`] (length
    /// rule `free`) and [`SolveError::CablesConflict`] for lengths that cannot be had,
    /// [`SolveError::NoLever`] for a cable through the centre of a section,
    /// [`SolveError::Invalid`] for a case that does not fit the robot.
    pub fn solve(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> Result<Solution, SolveError> {
        let mut solution = Solution::empty(ModelKind::FourBar);
        self.solve_into(case, warm_start.into(), workspace, &mut solution).map(|_| solution)
    }

    /// [`Self::solve`] into memory that is at hand: without obstacles and after the first call nothing is allocated where at most
    /// one cable passes each section.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub fn solve_into(
        &self,
        case: &Case,
        from: WarmStart<'_>,
        workspace: &mut Workspace,
        solution: &mut Solution,
    ) -> Result<Status, SolveError> {
        let outcome = if case.obstacles.is_empty() {
            self.solve_and_tell(case, workspace, solution).map(|_| ())
        } else {
            let solved = self.solve_in_contact(case, from.given(solution), workspace);
            solved.map(|found| *solution = found)
        };
        workspace.several.meter.checked(outcome).map(|()| Status::Converged)
    }
}
