//! What all models have in common, and the choice between them.

use core::ops::RangeInclusive;

use whipcord_numerics::Pose;

use crate::budget::Budget;
use crate::cancel::Cancel;
use crate::case::{Actuation, Case, Loads};
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::kinematics::Local;
use crate::refusal;
use crate::robot::{Cable, Robot, check_on_backbone};
use crate::shape::Solution;
use crate::statics::Statics;
use crate::statics::options::StabilityAnalysis;
use crate::statics::path::branches::{BranchOptions, Branches};
use crate::stations::Stations;
use crate::warm_start::{Status, WarmStart};
use crate::{
    constant_curvature, cosserat, cosserat_disks, four_bar, linkage, piecewise_constant_curvature,
    pseudo_rigid_body,
};

/// What the options of any model give.
macro_rules! of_any_model {
    ($model:expr, $options:ident => $what:expr) => {
        match $model {
            Self::Cosserat($options) | Self::CosseratDisks($options) => $what,
            Self::FourBar($options) => $what,
            Self::ConstantCurvature($options) => $what,
            Self::PiecewiseConstantCurvature($options) => $what,
            Self::PseudoRigidBody($options) => $what,
        }
    };
}

/// What any model of a robot gives.
macro_rules! of_any_prepared {
    ($prepared:expr, $model:ident => $what:expr) => {
        match $prepared {
            Self::Cosserat($model, _) => $what,
            Self::CosseratDisks($model, _) => $what,
            Self::FourBar($model, _) => $what,
            Self::ConstantCurvature($model, _) => $what,
            Self::Linkage($model, _) => $what,
        }
    };
}

/// A model with its options: what solves a case of any robot.
#[derive(Clone, Debug, PartialEq)]
pub enum Model {
    /// Cosserat rod with continuous cables.
    Cosserat(cosserat::Options),
    /// Cosserat rod with cables that run straight from hole to hole.
    CosseratDisks(cosserat_disks::Options),
    /// Four-bar sections.
    FourBar(four_bar::Options),
    /// One arc of a circle from base to tip.
    ConstantCurvature(constant_curvature::Options),
    /// An arc between each two disks, in equilibrium with cables and loads.
    PiecewiseConstantCurvature(piecewise_constant_curvature::Options),
    /// Rigid bodies on springs between each two disks.
    PseudoRigidBody(pseudo_rigid_body::Options),
}

impl Model {
    /// A model with its default options, giving the shape at these stations.
    #[must_use]
    pub fn new(kind: ModelKind, stations: Stations, actuation: Actuation) -> Self {
        macro_rules! options {
            ($model:ident) => {
                $model::Options { stations, actuation, ..Default::default() }
            };
        }
        match kind {
            ModelKind::Cosserat => Self::Cosserat(options!(cosserat)),
            ModelKind::CosseratDisks => Self::CosseratDisks(options!(cosserat_disks)),
            ModelKind::FourBar => Self::FourBar(options!(four_bar)),
            ModelKind::ConstantCurvature => Self::ConstantCurvature(options!(constant_curvature)),
            ModelKind::PiecewiseConstantCurvature => {
                Self::PiecewiseConstantCurvature(options!(piecewise_constant_curvature))
            }
            ModelKind::PseudoRigidBody => Self::PseudoRigidBody(options!(pseudo_rigid_body)),
        }
    }

    /// The same model, giving the shape at other stations.
    #[must_use]
    pub fn at(&self, stations: Stations) -> Self {
        let mut model = self.clone();
        of_any_model!(&mut model, options => options.stations = stations);
        model
    }

    /// The same model, whose solves end when this flag is set.
    #[must_use]
    pub fn cancelled_by(&self, cancel: &Cancel) -> Self {
        let mut model = self.clone();
        of_any_model!(&mut model, options => options.cancel.clone_from(cancel));
        model
    }

    /// The same model, whose solves may spend this much each.
    #[must_use]
    pub const fn with_budget(mut self, budget: Budget) -> Self {
        of_any_model!(&mut self, options => options.budget = budget);
        self
    }

    /// The same model, with this analysis of the stability of its answers; models without an energy have none.
    #[must_use]
    pub fn with_stability(mut self, analysis: StabilityAnalysis) -> Self {
        match &mut self {
            Self::Cosserat(options) | Self::CosseratDisks(options) => options.stability = analysis,
            Self::PiecewiseConstantCurvature(options) => options.stability = analysis,
            Self::PseudoRigidBody(options) => options.stability = analysis,
            Self::FourBar(options) => options.stability = analysis,
            Self::ConstantCurvature(_) => {}
        }
        self
    }

    /// Tolerances that make sense ([`Self::with_tolerance`]): below the first rounding counts, above the last an answer says nothing.
    pub const TOLERANCES: RangeInclusive<f64> = 1e-13..=0.01;

    /// The same model, to this estimated error of positions and lengths as a part of the length of the backbone
    /// ([`crate::cosserat::Accuracy::Tolerance`]); models whose sections are their discretisation have none to choose.
    #[must_use]
    pub const fn with_tolerance(mut self, tolerance: f64) -> Self {
        if let Self::Cosserat(options) | Self::CosseratDisks(options) = &mut self {
            options.accuracy = cosserat::Accuracy::Tolerance(tolerance);
        }
        self
    }

    /// The same model on at least so many steps from base to tip, whatever their error ([`crate::cosserat::Accuracy::Steps`]); models
    /// whose sections are their discretisation have none to choose.
    #[must_use]
    pub const fn with_steps(mut self, steps: usize) -> Self {
        if let Self::Cosserat(options) | Self::CosseratDisks(options) = &mut self {
            options.accuracy = cosserat::Accuracy::Steps(steps);
        }
        self
    }

    /// Whether the cables of its robots may have friction.
    #[must_use]
    pub const fn has_hole_friction(&self) -> bool {
        match self {
            Self::Cosserat(_)
            | Self::CosseratDisks(_)
            | Self::PiecewiseConstantCurvature(_)
            | Self::PseudoRigidBody(_) => true,
            Self::FourBar(options) => options.has_energy(),
            Self::ConstantCurvature(_) => false,
        }
    }

    /// The flag that ends its solves.
    #[must_use]
    pub const fn cancel(&self) -> &Cancel {
        of_any_model!(self, options => &options.cancel)
    }

    /// Which command of each cable counts.
    #[must_use]
    pub const fn actuation(&self) -> Actuation {
        of_any_model!(self, options => options.actuation)
    }

    /// Which model it is.
    #[must_use]
    pub const fn kind(&self) -> ModelKind {
        match self {
            Self::Cosserat(_) => ModelKind::Cosserat,
            Self::CosseratDisks(_) => ModelKind::CosseratDisks,
            Self::FourBar(_) => ModelKind::FourBar,
            Self::ConstantCurvature(_) => ModelKind::ConstantCurvature,
            Self::PiecewiseConstantCurvature(_) => ModelKind::PiecewiseConstantCurvature,
            Self::PseudoRigidBody(_) => ModelKind::PseudoRigidBody,
        }
    }
}

/// The robot before actuation and load, on a base of this pose, by a Cosserat model. `None` for a robot without section or material, which is known
/// to a geometric model only.
#[must_use]
pub fn at_rest(robot: &Robot, base: Pose, stations: &Stations) -> Option<Solution> {
    let case = Case { base, ..Case::with_tensions(&vec![0.0; robot.cables().len()]) };
    [ModelKind::Cosserat, ModelKind::CosseratDisks].into_iter().find_map(|kind| {
        Model::new(kind, stations.clone(), Actuation::Tension).solve(robot, &case).ok()
    })
}

/// A model built for one robot, with the scratch memory of its solves: what many cases of a robot
/// are solved with.
#[derive(Clone, Debug)]
pub enum Prepared {
    /// Cosserat rod with continuous cables.
    Cosserat(Box<cosserat::Cosserat>, Box<cosserat::Workspace>),
    /// Cosserat rod with cables that run straight from hole to hole.
    CosseratDisks(Box<cosserat_disks::CosseratDisks>, Box<cosserat_disks::Workspace>),
    /// Four-bar sections.
    FourBar(Box<four_bar::FourBar>, Box<four_bar::Workspace>),
    /// One arc of a circle from base to tip.
    ConstantCurvature(
        Box<constant_curvature::ConstantCurvature>,
        Box<constant_curvature::Workspace>,
    ),
    /// Sections of an arc each, or of rigid bodies on springs.
    Linkage(Box<linkage::Linkage>, Box<linkage::Workspace>),
}

impl Model {
    /// The model of a robot whose cases have loads at the places of `loads`.
    ///
    /// # Errors
    /// [`SolveError`] when the model cannot take the robot.
    pub fn prepare(&self, robot: &Robot, loads: &Loads) -> Result<Prepared, SolveError> {
        Ok(match self {
            Self::Cosserat(options) => {
                let model = cosserat::Cosserat::new(robot, loads, options)?;
                Prepared::Cosserat(Box::new(model), Box::default())
            }
            Self::CosseratDisks(options) => {
                let model = cosserat_disks::CosseratDisks::new(robot, loads, options)?;
                Prepared::CosseratDisks(Box::new(model), Box::default())
            }
            Self::FourBar(options) => {
                let model = four_bar::FourBar::new(robot, options)?;
                Prepared::FourBar(Box::new(model), Box::default())
            }
            Self::ConstantCurvature(options) => {
                let model = constant_curvature::ConstantCurvature::new(robot, options)?;
                Prepared::ConstantCurvature(Box::new(model), Box::default())
            }
            Self::PiecewiseConstantCurvature(options) => {
                let model = piecewise_constant_curvature::build(robot, options)?;
                Prepared::Linkage(Box::new(model), Box::default())
            }
            Self::PseudoRigidBody(options) => {
                let model = pseudo_rigid_body::build(robot, options)?;
                Prepared::Linkage(Box::new(model), Box::default())
            }
        })
    }
}

impl Prepared {
    /// The robot the model was built for.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        of_any_prepared!(self, model => model.robot())
    }

    /// Arc lengths of the stations in m.
    #[must_use]
    pub fn stations(&self) -> &[f64] {
        of_any_prepared!(self, model => model.stations())
    }

    /// Lets this flag end the next solves, instead of the one before.
    pub fn set_cancel(&mut self, cancel: &Cancel) {
        of_any_prepared!(self, model => model.set_cancel(cancel));
    }

    /// Lets the next solves spend this much each, instead of what the options of the model say.
    pub fn set_budget(&mut self, budget: Budget) {
        of_any_prepared!(self, model => model.set_budget(budget));
    }

    /// Whether it can take loads at the places of these.
    #[must_use]
    pub fn takes_places_of(&self, loads: &Loads) -> bool {
        match self {
            Self::Cosserat(model, _) => model.takes_places_of(loads),
            Self::CosseratDisks(model, _) => model.takes_places_of(loads),
            Self::FourBar(..) | Self::ConstantCurvature(..) | Self::Linkage(..) => true,
        }
    }

    /// The shape under a case, starting from the solution of a neighbouring one when given.
    ///
    /// # Errors
    /// [`SolveError`] when the model cannot take the case or finds no answer.
    pub fn solve(
        &mut self,
        case: &Case,
        warm_start: Option<&Solution>,
    ) -> Result<Solution, SolveError> {
        match self {
            Self::Cosserat(model, workspace) => model.solve(case, warm_start, workspace),
            Self::CosseratDisks(model, workspace) => model.solve(case, warm_start, workspace),
            Self::FourBar(model, workspace) => model.solve(case, warm_start, workspace),
            Self::ConstantCurvature(model, workspace) => model.solve(case, workspace),
            Self::Linkage(model, workspace) => model.solve(case, warm_start, workspace),
        }
    }

    /// Whether it is proven that the robot has one equilibrium only under a case, so that whatever a solve starts from leads to the same answer:
    /// where a Cosserat rod without friction and obstacles bears dead forces that are weak for its stiffness, eq. (16) of its page, or no load. Of cables that are driven by their
    /// lengths `greatest` are the tensions in N, by cables of the robot, up to which there is one equilibrium; those of others do not count. `false` is no statement.
    ///
    /// # Errors
    /// [`SolveError`] when the model cannot take the case.
    pub fn has_one_equilibrium(
        &mut self,
        case: &Case,
        greatest: &[f64],
    ) -> Result<bool, SolveError> {
        match self {
            Self::Cosserat(model, workspace) => {
                model.has_one_equilibrium(case, greatest, workspace)
            }
            _ => Ok(false),
        }
    }

    /// [`Self::solve`] for a controller: into a solution that is at hand, from the answer of the cycle before
    /// ([`WarmStart::Output`]), and within a budget ([`Self::set_budget`]) with the best shape so far where that is spent. After the
    /// first call nothing is allocated by a solve without obstacles and hole friction that needs no search for tensions or
    /// continuation; what is, the pages of the models say. Cables are in the order of the robot.
    ///
    /// ```
    /// # use whipcord::{Backbone, Cable, Case, Disks, Material, Robot, Routing, Section};
    /// use whipcord::{Actuation, Model, ModelKind, Solution, Stations, Status, WarmStart};
    ///
    /// # let material = Material { young_modulus: Some(1.1e9), poisson_ratio: Some(0.3), ..Default::default() };
    /// # let backbone = Backbone { section: Some(Section::circle(0.003)), material, ..Backbone::new(0.18) };
    /// # let cable = Cable::new("pull", Routing::Straight { angle: 0.0, radius: 0.008 });
    /// # let robot = Robot::new(backbone, Disks::equally_spaced(0.18, 10, 0.008), vec![cable])?;
    /// let mut case = Case::with_tensions(&[3.0]);
    /// case.loads.tip_force.x = 0.1;
    /// let model = Model::new(ModelKind::Cosserat, Stations::default(), Actuation::Natural);
    /// let mut model = model.prepare(&robot, &case.loads)?;
    /// let mut solution = Solution::empty(ModelKind::Cosserat);
    /// for cycle in 0..100 {
    ///     case.commands[0].tension = Some(3.0 + 0.01 * f64::from(cycle));
    ///     let from = if cycle == 0 { WarmStart::None } else { WarmStart::Output };
    ///     let status = model.solve_into(&case, from, &mut solution)?;
    ///     assert_eq!(status, Status::Converged);
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`Self::solve`]; [`SolveError::BudgetSpent`] where the budget is spent before there is a shape. The solution then
    /// holds what it held, or a part of an answer.
    pub fn solve_into(
        &mut self,
        case: &Case,
        from: WarmStart<'_>,
        solution: &mut Solution,
    ) -> Result<Status, SolveError> {
        match self {
            Self::Cosserat(model, workspace) => model.solve_into(case, from, workspace, solution),
            Self::CosseratDisks(model, workspace) => {
                model.solve_into(case, from, workspace, solution)
            }
            Self::FourBar(model, workspace) => model.solve_into(case, from, workspace, solution),
            Self::ConstantCurvature(model, workspace) => {
                model.solve_into(case, workspace, solution)
            }
            Self::Linkage(model, workspace) => model.solve_into(case, from, workspace, solution),
        }
    }

    /// All equilibria under the load of a case that lie on the path from no load, past its limit
    /// points, and on the branches off it: by every model of an equilibrium under loads. Cables keep their commands on
    /// the way. Of a case in several steps they are those of the last.
    ///
    /// ```
    /// use whipcord::{
    ///     Actuation, Backbone, BranchOptions, Case, Disks, Loads, Material, Model, ModelKind, Robot,
    ///     Section, Stations, Vec3,
    /// };
    ///
    /// let backbone = Backbone {
    ///     section: Some(Section::circle(0.003)),
    ///     material: Material {
    ///         young_modulus: Some(1.1e9),
    ///         poisson_ratio: Some(0.3),
    ///         ..Default::default()
    ///     },
    ///     ..Backbone::new(0.18)
    /// };
    /// let rod = Robot::new(backbone, Disks::equally_spaced(0.18, 10, 0.008), vec![])?;
    /// // Half as much again as what buckles the rod.
    /// let loads = Loads { tip_force: Vec3::new(0.0, 0.0, -0.5), ..Loads::default() };
    /// let case = Case { loads, ..Case::default() };
    /// for kind in [ModelKind::Cosserat, ModelKind::PiecewiseConstantCurvature] {
    ///     let model = Model::new(kind, Stations::Disks, Actuation::Natural);
    ///     let found =
    ///         model.prepare(&rod, &case.loads)?.branches(&case, &BranchOptions::default())?;
    ///     let stable: Vec<_> = found.equilibria.iter().map(|e| e.stable).collect();
    ///     // Straight, and bent to either side.
    ///     assert_eq!(stable, [Some(false), Some(true), Some(true)]);
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SolveError::Unsupported`] for a model without loads, with hole friction and among obstacles. Else
    /// [`SolveError`] when there is no shape without load to start from, or when an equilibrium is
    /// lost on finer steps.
    pub fn branches(
        &mut self,
        case: &Case,
        options: &BranchOptions,
    ) -> Result<Branches, SolveError> {
        match self {
            Self::Cosserat(model, workspace) => model.branches(case, options, workspace),
            Self::CosseratDisks(model, workspace) => model.branches(case, options, workspace),
            Self::Linkage(model, workspace) => model.branches(case, options, workspace),
            Self::FourBar(model, workspace) => model.branches(case, options, workspace),
            Self::ConstantCurvature(..) => Err(refusal::branches(ModelKind::ConstantCurvature)),
        }
    }

    /// The answers to all steps of a case in order, each from where the one before left the robot, or from cold where the steps
    /// are independent: those to each of [`Case::steps`]. `each` gets them as they come.
    ///
    /// # Errors
    /// The number of the first step without an answer, from 0, and why it has none.
    pub fn solve_steps(
        &mut self,
        case: &Case,
        mut each: impl FnMut(Solution),
    ) -> Result<(), (usize, SolveError)> {
        if case.independent {
            for (n, step) in case.single_steps().enumerate() {
                each(self.solve(&step, None).map_err(|error| (n, error))?);
            }
            return Ok(());
        }
        match self {
            Self::Cosserat(model, workspace) => {
                return model.solve_steps(case, workspace, each);
            }
            Self::CosseratDisks(model, workspace) => {
                return model.solve_steps(case, workspace, each);
            }
            Self::Linkage(model, workspace) if model.has_friction() || model.keeps_history() => {
                return model.solve_steps(case, workspace, each);
            }
            Self::FourBar(model, workspace) if model.has_memory() => {
                return model.solve_steps(case, workspace, each);
            }
            _ => {}
        }
        let mut last = None;
        for (n, step) in case.single_steps().enumerate() {
            let solution = self.solve(&step, last.as_ref()).map_err(|error| (n, error))?;
            each(last.insert(solution).clone());
        }
        Ok(())
    }

    /// The answers to all steps of a case from cold, in order; one for a case without steps.
    ///
    /// # Errors
    /// As [`Self::solve_steps`].
    pub fn solve_all(&mut self, case: &Case) -> Result<Vec<Solution>, (usize, SolveError)> {
        if case.before.is_empty() {
            let solution = self.solve(case, None).map_err(|error| (0, error))?;
            return Ok(vec![solution]);
        }
        let mut all = Vec::with_capacity(case.before.len() + 1);
        self.solve_steps(case, |solution| all.push(solution))?;
        Ok(all)
    }

    /// The answer to a case from cold, after all its steps.
    ///
    /// # Errors
    /// As [`Self::solve_steps`].
    pub fn solve_to_the_end(&mut self, case: &Case) -> Result<Solution, (usize, SolveError)> {
        let mut last = None;
        if !case.before.is_empty() && !case.independent {
            self.solve_steps(case, |solution| last = Some(solution))?;
        }
        last.map_or_else(|| self.solve(case, None).map_err(|error| (0, error)), Ok)
    }
}

impl Statics for Model {
    fn solve(&self, robot: &Robot, case: &Case) -> Result<Solution, SolveError> {
        self.prepare(robot, &case.loads)?.solve(case, None)
    }
}

/// A model that gives the Jacobian and the compliance of a place, exactly ([`Local::method`]). A geometric model, or one
/// that takes no loads, gives the Jacobian alone
/// ([`Local::compliances`]). Of other quantities [`crate::differences`] differentiates any
/// [`Statics`].
pub trait Differentiable: Statics {
    /// The answer, and its derivatives at an arc length in m. A case in several steps
    /// ([`Case::before`]) is followed through them by the model that has exact derivatives.
    ///
    /// # Errors
    /// As [`Statics::solve`]; [`SolveError::Invalid`] for a place that is not on the backbone,
    /// [`SolveError::Unsupported`] among obstacles of the geometric models, and
    /// [`SolveError::NoDerivatives`] where the robot is about to buckle.
    fn solve_at(
        &self,
        robot: &Robot,
        case: &Case,
        arc_length: f64,
    ) -> Result<(Solution, Local), SolveError> {
        self.solve_at_from(robot, case, arc_length, None)
    }

    /// [`Self::solve_at`], starting from a solution of this case or a neighbouring one when given: of several equilibria
    /// it is then the one beside that. The steps before the last are those that led to it. A model that has one
    /// answer to a case starts from nowhere.
    ///
    /// # Errors
    /// As [`Self::solve_at`].
    fn solve_at_from(
        &self,
        robot: &Robot,
        case: &Case,
        arc_length: f64,
        warm_start: Option<&Solution>,
    ) -> Result<(Solution, Local), SolveError>;
}

impl Differentiable for Model {
    fn solve_at_from(
        &self,
        robot: &Robot,
        case: &Case,
        arc_length: f64,
        warm_start: Option<&Solution>,
    ) -> Result<(Solution, Local), SolveError> {
        check_on_backbone("arc length of the place", arc_length, robot.backbone().length)?;
        self.cancel().checked(self.local_at(robot, case, arc_length, warm_start))
    }
}

impl Model {
    fn local_at(
        &self,
        robot: &Robot,
        case: &Case,
        arc_length: f64,
        warm_start: Option<&Solution>,
    ) -> Result<(Solution, Local), SolveError> {
        let model = match self {
            Self::Cosserat(_)
            | Self::CosseratDisks(_)
            | Self::PiecewiseConstantCurvature(_)
            | Self::PseudoRigidBody(_) => self.at(Stations::At(vec![arc_length])),
            Self::FourBar(options) => {
                match four_bar::FourBar::new(robot, options)?.has_linearization() {
                    true => self.at(Stations::At(vec![arc_length])),
                    false => return four_bar::solve_at(options, robot, case, arc_length),
                }
            }
            Self::ConstantCurvature(options) => {
                let model = constant_curvature::ConstantCurvature::new(robot, options)?;
                return model.solve_at(case, arc_length, &mut Default::default());
            }
        };
        let mut prepared = model.prepare(robot, &case.loads)?;
        let slides = self.has_hole_friction() && robot.cables().iter().any(Cable::has_friction);
        if slides || robot.has_bending_friction() {
            // No solution tells the steps before it: all of them are taken anew.
            let (solution, derivatives) = prepared.solve_with_derivatives(case, None, &[])?;
            let local = derivatives.at(crate::derivatives::Place::Station(0))?;
            return Ok((solution, local));
        }
        let mut left = warm_start.cloned();
        let before = if left.is_some() || case.independent { 0 } else { case.before.len() };
        for step in case.single_steps().take(before) {
            left = Some(prepared.solve(&step, left.as_ref())?);
        }
        let last = Case { before: Vec::new(), ..case.clone() };
        let chain = match &mut prepared {
            Prepared::Linkage(model, workspace) => Some((&**model, &mut **workspace)),
            Prepared::FourBar(model, workspace) => model.chain(workspace),
            _ => None,
        };
        if let Some((chain, workspace)) = chain.filter(|_| case.obstacles.is_empty()) {
            return chain.solve_at(&last, arc_length, left.as_ref(), workspace);
        }
        let (solution, derivatives) = prepared.solve_with_derivatives(&last, left.as_ref(), &[])?;
        let local = derivatives.at(crate::derivatives::Place::Station(0))?;
        Ok((solution, local))
    }
}
