//! Answers with their derivatives, of any model that has them.

use whipcord_numerics::Twist;

use crate::case::Case;
use crate::derivatives::{
    Change, CoordinateDerivatives, Cotangent, Derivatives, Gradient, Hold, Place,
};
use crate::error::SolveError;
use crate::four_bar;
use crate::kind::ModelKind;
use crate::kinematics::{ComplianceUnknown, Local, Matrix6, OneSided};
use crate::model::Model;
use crate::parameter::Parameter;
use crate::prepared::Prepared;
use crate::robot::Robot;
use crate::solution::Solution;
use crate::statics::options::StabilityAnalysis;
use crate::statics::plastic_steps::PlasticRod as _;

/// The derivatives of one answer, of whatever model: by commands, tensions, loads at any place and parameters, with tensions
/// held, lengths locked or commands kept, forward and in reverse, and among the contacts that hold the answer.
///
/// Motions and wrenches are in the frame of the base; see [`Derivatives`].
///
/// ```
/// use whipcord::derivatives::{Hold, Place};
/// use whipcord::{Actuation, Backbone, Cable, Case, Disks, Loads, Material, Robot, Routing, Section};
/// use whipcord::{Model, ModelKind, Parameter, Stations};
///
/// let material =
///     Material { young_modulus: Some(1.1e9), poisson_ratio: Some(0.3), ..Default::default() };
/// let backbone = Backbone { section: Some(Section::circle(0.003)), material, ..Backbone::new(0.18) };
/// let cable = Cable::new("pull", Routing::Straight { angle: 0.0, radius: 0.008 });
/// let robot = Robot::new(backbone, Disks::equally_spaced(0.18, 10, 0.008), vec![cable])?;
/// let case = Case::with_tensions(&[3.0]);
/// for kind in [ModelKind::CosseratDisks, ModelKind::PiecewiseConstantCurvature, ModelKind::PseudoRigidBody] {
///     let model = Model::new(kind, Stations::default(), Actuation::Natural);
///     let mut model = model.prepare(&robot, &Loads::default())?;
///     let solution = model.solve(&case, None)?;
///     let derivatives = model.linearize(&case, &solution, &[Parameter::YoungModulus])?;
///     // Twice as stiff is as half as much tension.
///     let by_tension = derivatives.command(0).twist(Place::Tip).linear.x * 3.0;
///     let by_modulus = derivatives.parameter(0, Hold::Commands).twist(Place::Tip).linear.x * 1.1e9;
///     assert!((by_tension + by_modulus).abs() < 1e-3 * by_tension);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub enum Linearization {
    /// Of a Cosserat rod.
    Rod(Box<Derivatives>),
    /// Of a model that has generalised coordinates for a rod.
    Coordinates(Box<CoordinateDerivatives>),
}

/// Asks whichever it is.
macro_rules! ask {
    ($self:ident . $method:ident ( $($argument:expr),* )) => {
        match $self {
            Self::Rod(derivatives) => derivatives.$method($($argument),*),
            Self::Coordinates(derivatives) => derivatives.$method($($argument),*),
        }
    };
}

impl Linearization {
    /// How the answer changes with the command of a cable: its tension in N where that drives it,
    /// else its shortening in m. All other commands are held. A cable that is slack moves nothing.
    ///
    /// # Panics
    /// When the robot has no cable of this number.
    #[must_use]
    pub fn command(&self, cable: usize) -> Change {
        ask!(self.command(cable))
    }

    /// [`Self::command`] of every cable.
    #[must_use]
    pub fn commands(&self) -> Vec<Change> {
        ask!(self.commands())
    }

    /// How the answer changes where the command of a cable is changed by as much in all steps of the case ([`Self::command`] changes it
    /// in the last). They differ where cables or obstacles rub, which remember the steps before. What friction against bending keeps of these
    /// is taken as it is.
    ///
    /// # Panics
    /// When the robot has no cable of this number.
    #[must_use]
    pub fn offset(&self, cable: usize) -> Change {
        ask!(self.offset(cable))
    }

    /// How the answer changes with the tension of a cable in N, all other tensions held.
    ///
    /// # Panics
    /// When the robot has no cable of this number.
    #[must_use]
    pub fn tension(&self, cable: usize) -> Change {
        ask!(self.tension(cable))
    }

    /// How the answer changes with a parameter, by its number in the list that was asked for.
    ///
    /// # Panics
    /// When no parameter has this number.
    #[must_use]
    pub fn parameter(&self, index: usize, hold: Hold) -> Change {
        ask!(self.parameter(index, hold))
    }

    /// How the answer changes with a component of a dead wrench at a place, base frame: force in N
    /// along x, y, z, then moment in N·m about x, y, z.
    ///
    /// # Panics
    /// When there is no such station or disk, or the component is none of 0 to 5.
    #[must_use]
    pub fn wrench(&self, at: Place, component: usize, hold: Hold) -> Change {
        ask!(self.wrench(at, component, hold))
    }

    /// The actuation Jacobian of a place: for the command of each cable ([`Self::command`]) the
    /// velocity of the place's point and its angular velocity, base frame.
    ///
    /// # Panics
    /// When there is no such station or disk.
    #[must_use]
    pub fn actuation_jacobian(&self, at: Place) -> Vec<Twist> {
        ask!(self.actuation_jacobian(at))
    }

    /// The Jacobian of a place by the tensions of all cables in N, whatever drives them.
    ///
    /// # Panics
    /// When there is no such station or disk.
    #[must_use]
    pub fn tension_jacobian(&self, at: Place) -> Vec<Twist> {
        ask!(self.tension_jacobian(at))
    }

    /// How the length of each cable changes with the command of each, in m by N of tension or m of
    /// shortening: by rows of lengths.
    #[must_use]
    pub fn length_by_command(&self) -> Vec<Vec<f64>> {
        ask!(self.length_by_command())
    }

    /// How the lengths of the cables change with their tensions in m/N, all others held: by rows of
    /// lengths. Symmetric and not positive under dead forces.
    #[must_use]
    pub fn length_by_tension(&self) -> Vec<Vec<f64>> {
        ask!(self.length_by_tension())
    }

    /// The compliance of a place: its motion under a dead wrench that is applied to it.
    ///
    /// # Errors
    /// [`SolveError::NoDerivatives`] where the robot is so near to buckling that it is not finite.
    ///
    /// # Panics
    /// When there is no such station or disk.
    pub fn compliance(&self, at: Place, hold: Hold) -> Result<Matrix6, SolveError> {
        ask!(self.compliance(at, hold))
    }

    /// The stiffness of a place, the inverse of its compliance; `None` where it cannot move in every
    /// direction, as at the base.
    ///
    /// # Errors
    /// As [`Self::compliance`].
    ///
    /// # Panics
    /// When there is no such station or disk.
    pub fn stiffness(&self, at: Place, hold: Hold) -> Result<Option<Matrix6>, SolveError> {
        ask!(self.stiffness(at, hold))
    }

    /// All that is to be said of one place.
    ///
    /// # Errors
    /// As [`Self::compliance`].
    ///
    /// # Panics
    /// When there is no such station or disk.
    pub fn at(&self, place: Place) -> Result<Local, SolveError> {
        ask!(self.at(place))
    }

    /// The gradient of a scalar by every command, parameter and dead wrench, from its sensitivity to
    /// the answer: one sweep, whatever the number of parameters. `hold` is what is held when a
    /// parameter or a wrench changes.
    ///
    /// # Panics
    /// When the cotangent names a station or disk that there is not.
    #[must_use]
    pub fn pull_back(&self, cotangent: &Cotangent, hold: Hold) -> Gradient {
        ask!(self.pull_back(cotangent, hold))
    }

    /// Whether a contact of the answer is about to open or to close, to stick or to slide, or was at an equilibrium on the way that the
    /// answer remembers: it has one-sided derivatives there, and these are the derivatives of the side that the answer is on.
    #[must_use]
    pub const fn is_contact_about_to_change(&self) -> bool {
        ask!(self.is_contact_about_to_change())
    }

    /// Whether a cable with friction is about to slide in a hole where it sticks, or has only begun to slide: the answer has one-sided derivatives
    /// there, and these are the derivatives of the case that the answer is in.
    #[must_use]
    pub fn is_hole_about_to_change(&self) -> bool {
        ask!(self.is_hole_about_to_change())
    }

    /// Whether a cable of given length is about to go slack or to become taut: the answer has one-sided derivatives there, and these are the
    /// derivatives of the side that the answer is on. Cables that rub in their holes do not count.
    #[must_use]
    pub const fn is_cable_about_to_change(&self) -> bool {
        ask!(self.is_cable_about_to_change())
    }

    /// Whether friction against bending is about to slide or to stick, in a joint of a model of sections or at a section of a rod, as where a
    /// command is repeated: the answer has one-sided derivatives there, and these are the derivatives of the side that the answer is on.
    #[must_use]
    pub const fn is_bending_about_to_change(&self) -> bool {
        ask!(self.is_bending_about_to_change())
    }

    /// What is about to change at the answer, of these four.
    #[must_use]
    pub fn one_sided(&self) -> OneSided {
        ask!(self.one_sided())
    }

    /// Whether the lengths that are held depend on each other, as those of two antagonists do on a backbone that keeps its length. Their
    /// tensions are then not determined: the least change of them is taken. A change of lengths that contradicts others, such as the command
    /// of one antagonist alone, counts by the part that does not contradict them; the shape is the one that cables tend to which hardly stretch.
    /// Cables that rub in their holes do not count.
    #[must_use]
    pub fn are_lengths_dependent(&self, hold: Hold) -> bool {
        ask!(self.are_lengths_dependent(hold))
    }

    /// Notes what the answer says of its cables.
    fn noting(mut self, solution: &Solution) -> Self {
        match &mut self {
            Self::Rod(derivatives) => derivatives.note_cables(solution),
            Self::Coordinates(derivatives) => derivatives.note_cables(solution),
        }
        self
    }
}

fn of_coordinates(of: Option<CoordinateDerivatives>) -> Option<Linearization> {
    of.map(|of| Linearization::Coordinates(Box::new(of)))
}

impl Model {
    /// Whether it differentiates its answers exactly by commands, loads and parameters
    /// ([`Prepared::linearize`]).
    #[must_use]
    pub fn has_derivatives(&self, robot: &Robot) -> bool {
        match self {
            Self::Cosserat(_)
            | Self::CosseratDisks(_)
            | Self::PiecewiseConstantCurvature(_)
            | Self::PseudoRigidBody(_) => true,
            Self::FourBar(options) => {
                four_bar::FourBar::new(robot, options).is_ok_and(|model| model.has_linearization())
            }
            Self::ConstantCurvature(_) => false,
        }
    }
}

impl Prepared {
    /// The answer to the last step of a case, with its derivatives by tensions or lengths, by loads at any place, and by these
    /// parameters; from a neighbouring solution when given. Among obstacles that rub, derivatives from rest by commands and parameters are
    /// those of the way to the answer; from a neighbouring solution, and by loads at a place, those of the motion that goes on from there.
    ///
    /// # Errors
    /// As [`Self::solve`]; [`SolveError::Unsupported`] where the model has no exact derivatives
    /// ([`Model::has_derivatives`]), [`SolveError::Invalid`] for a parameter that robot and case do not have,
    /// and [`SolveError::NoDerivatives`] where the robot is about to buckle.
    pub fn solve_with_derivatives(
        &mut self,
        case: &Case,
        warm_start: Option<&Solution>,
        parameters: &[Parameter],
    ) -> Result<(Solution, Linearization), SolveError> {
        let found = match self {
            Self::Cosserat(model, workspace) => model
                .solve_with_derivatives(case, warm_start, parameters, workspace)
                .map(|(solution, of)| (solution, Linearization::Rod(Box::new(of)))),
            Self::CosseratDisks(model, workspace) => model
                .solve_with_derivatives(case, warm_start, parameters, workspace)
                .map(|(solution, of)| (solution, Linearization::Rod(Box::new(of)))),
            Self::Linkage(model, workspace) => model
                .solve_with_derivatives(case, warm_start, parameters, workspace)
                .map(|(solution, of)| (solution, Linearization::Coordinates(Box::new(of)))),
            Self::FourBar(model, workspace) => model
                .solve_and_linearize(case, warm_start, parameters, workspace)
                .map(|(solution, of)| (solution, Linearization::Coordinates(Box::new(of)))),
            Self::ConstantCurvature(..) => Err(SolveError::Unsupported {
                model: ModelKind::ConstantCurvature,
                path: "a request for derivatives by loads and parameters".to_owned(),
                what: ComplianceUnknown::NoLoads.reason(),
                advice: ComplianceUnknown::NoLoads.advice(),
            }),
        };
        found.map(|(solution, of)| {
            let of = of.noting(&solution);
            (solution, of)
        })
    }

    /// The answer to the last step of a case, and how it changes with the command of each cable ([`Linearization::command`]): of a Cosserat rod at a
    /// fraction of the cost of [`Self::solve_with_derivatives`], but under loads with a relative error that is that of a method of order 4 on the
    /// steps of the answer, and without strains. For iterations that correct themselves, such as those of inverse problems: the residual under loads that is
    /// `corrected` by the changes, as [`crate::cosserat::Cosserat::solve_with_command_changes`] says, saves integrations; 0 where it is not to be.
    ///
    /// # Errors
    /// As [`Self::solve_with_derivatives`].
    pub fn solve_with_command_changes(
        &mut self,
        case: &Case,
        warm_start: Option<&Solution>,
        corrected: f64,
    ) -> Result<(Solution, Vec<Change>), SolveError> {
        if let Self::Cosserat(model, workspace) = self {
            return model.solve_with_command_changes(case, warm_start, corrected, workspace);
        }
        let (solution, derivatives) = self.solve_with_derivatives(case, warm_start, &[])?;
        Ok((solution, derivatives.commands()))
    }

    /// The answers to all steps of a case in order, each from where the one before left the robot ([`Self::solve_steps`]), and to
    /// those for which `asks` says so, by their number from 0, with their derivatives. `each` gets them as they come. Where the answer
    /// depends on the steps before, so do the derivatives by parameters; those by commands are by the commands of the step alone.
    ///
    /// # Errors
    /// The number of the first step without an answer, from 0, and why it has none, as [`Self::solve_with_derivatives`].
    pub fn solve_steps_with_derivatives(
        &mut self,
        case: &Case,
        parameters: &[Parameter],
        asks: impl Fn(usize) -> bool,
        mut each: impl FnMut(Solution, Option<Linearization>),
    ) -> Result<(), (usize, SolveError)> {
        if case.independent {
            for (n, step) in case.single_steps().enumerate() {
                let failed = |error| (n, error);
                if asks(n) {
                    let found = self.solve_with_derivatives(&step, None, parameters);
                    let (solution, derivatives) = found.map_err(failed)?;
                    each(solution, Some(derivatives));
                } else {
                    each(self.solve(&step, None).map_err(failed)?, None);
                }
            }
            return Ok(());
        }
        let of_rod = |of: Option<_>| of.map(|of| Linearization::Rod(Box::new(of)));
        // Of answers among obstacles that rub the way to them is differentiated.
        let follows_way = case.differentiates_way(self.robot());
        match self {
            Self::Cosserat(model, workspace) if model.bends_in_steps() => {
                let mut step = 0;
                return model.differentiate_steps(case, parameters, workspace, |solution, of| {
                    each(solution, asks(step).then(|| Linearization::Rod(Box::new(of))));
                    step += 1;
                });
            }
            Self::CosseratDisks(model, workspace) if model.bends_in_steps() => {
                let mut step = 0;
                return model.differentiate_steps(case, parameters, workspace, |solution, of| {
                    each(solution, asks(step).then(|| Linearization::Rod(Box::new(of))));
                    step += 1;
                });
            }
            Self::Cosserat(model, workspace) if model.has_friction() || follows_way => {
                return model.slide_with_derivatives(
                    case,
                    parameters,
                    asks,
                    workspace,
                    |(solution, of)| each(solution, of_rod(of)),
                );
            }
            Self::CosseratDisks(model, workspace) if model.has_friction() || follows_way => {
                return model.solve_steps_with_derivatives(
                    case,
                    parameters,
                    asks,
                    workspace,
                    |(solution, of)| each(solution, of_rod(of)),
                );
            }
            Self::Linkage(model, workspace)
                if model.has_friction() || model.keeps_history() || follows_way =>
            {
                return model.solve_steps_with_derivatives(
                    case,
                    parameters,
                    asks,
                    workspace,
                    |(solution, of)| each(solution, of_coordinates(of)),
                );
            }
            Self::FourBar(model, workspace) => {
                let remembers = model.has_memory() || follows_way;
                if let Some((chain, workspace)) = model.chain(workspace).filter(|_| remembers) {
                    return chain.solve_steps_with_derivatives(
                        case,
                        parameters,
                        asks,
                        workspace,
                        |(solution, of)| each(solution, of_coordinates(of)),
                    );
                }
            }
            _ => {}
        }
        let mut last: Option<Solution> = None;
        for (n, step) in case.single_steps().enumerate() {
            let (solution, of) = match asks(n) {
                true => self
                    .solve_with_derivatives(&step, last.as_ref(), parameters)
                    .map(|(solution, of)| (solution, Some(of))),
                false => self.solve(&step, last.as_ref()).map(|solution| (solution, None)),
            }
            .map_err(|error| (n, error))?;
            each(last.insert(solution).clone(), of);
        }
        Ok(())
    }

    /// The answer to the last step of a case with its derivatives, from a neighbouring answer where one is given, else from rest through all
    /// steps. A robot that remembers these takes them anew whatever is given, as no answer tells them.
    ///
    /// # Errors
    /// As [`Self::solve_with_derivatives`].
    pub fn solve_last_with_derivatives(
        &mut self,
        case: &Case,
        warm_start: Option<&Solution>,
        parameters: &[Parameter],
    ) -> Result<(Solution, Linearization), SolveError> {
        let follows_way = warm_start.is_none() && case.has_rubbing_obstacles();
        if self.robot().has_history() || follows_way {
            return self.solve_with_derivatives(case, None, parameters);
        }
        let left = self.lead_to_last(case, warm_start)?;
        let last = Case { before: Vec::new(), ..case.clone() };
        self.solve_with_derivatives(&last, left.as_ref(), parameters)
    }

    /// Where the last step of a case begins: at the answer that is given, or at that to the step before.
    pub(crate) fn lead_to_last(
        &mut self,
        case: &Case,
        warm_start: Option<&Solution>,
    ) -> Result<Option<Solution>, SolveError> {
        let mut left = warm_start.cloned();
        let before = if left.is_some() || case.independent { 0 } else { case.before.len() };
        for step in case.single_steps().take(before) {
            left = Some(self.solve(&step, left.as_ref())?);
        }
        Ok(left)
    }

    /// The derivatives of the answer to a case, from that answer: the model is not built anew, and of the solve only the
    /// iteration is left that finds the answer again. Of a solution that is no answer to the case they are those of the
    /// equilibrium near it.
    ///
    /// # Errors
    /// As [`Self::solve_with_derivatives`].
    pub fn linearize(
        &mut self,
        case: &Case,
        solution: &Solution,
        parameters: &[Parameter],
    ) -> Result<Linearization, SolveError> {
        self.without_stability(|prepared| {
            prepared
                .solve_with_derivatives(case, Some(solution), parameters)
                .map(|(_, linearization)| linearization)
        })
    }

    /// The motion of the tip, base frame, with the command of each cable at the answer to a case: the actuation Jacobian of
    /// [`Self::linearize`]. Without friction and obstacles nothing is allocated for it once the model has its memory, but by `four-bar`.
    ///
    /// # Errors
    /// As [`Self::linearize`].
    pub fn tip_by_commands(
        &mut self,
        case: &Case,
        solution: &Solution,
        out: &mut Vec<Twist>,
    ) -> Result<(), SolveError> {
        let is_free = case.obstacles.is_empty() && !self.robot().has_history();
        self.without_stability(|prepared| match prepared {
            Self::Cosserat(model, workspace) if is_free => {
                model.tip_by_commands(case, solution, workspace, out)
            }
            Self::CosseratDisks(model, workspace) if is_free => {
                model.tip_by_commands(case, solution, workspace, out)
            }
            Self::Linkage(model, workspace) if is_free => {
                model.tip_by_commands(case, solution, workspace, out)
            }
            prepared => {
                let (_, of) = prepared.solve_with_derivatives(case, Some(solution), &[])?;
                out.clear();
                out.extend(of.actuation_jacobian(Place::Tip));
                Ok(())
            }
        })
    }

    /// Does something without looking at the stability of answers: it is known of the solution at hand, or not asked for.
    fn without_stability<T>(&mut self, act: impl FnOnce(&mut Self) -> T) -> T {
        let asked =
            self.stability_mut().map(|asked| core::mem::replace(asked, StabilityAnalysis::Off));
        let done = act(self);
        if let (Some(stability), Some(asked)) = (self.stability_mut(), asked) {
            *stability = asked;
        }
        done
    }

    /// What is asked of the stability of answers; `None` of models that know nothing of it.
    fn stability_mut(&mut self) -> Option<&mut StabilityAnalysis> {
        match self {
            Self::Cosserat(model, _) => Some(model.stability_mut()),
            Self::CosseratDisks(model, _) => Some(model.stability_mut()),
            Self::Linkage(model, _) => Some(model.stability_mut()),
            Self::FourBar(model, _) => model.stability_mut(),
            Self::ConstantCurvature(..) => None,
        }
    }
}
