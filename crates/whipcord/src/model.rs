//! What all models have in common, and the choice between them.

use core::ops::RangeInclusive;

use whipcord_numerics::Pose;

use crate::budget::Budget;
use crate::cancel::Cancel;
use crate::case::{Actuation, Case, Loads};
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::kinematics::Local;
use crate::prepared::Prepared;
use crate::robot::{Robot, check_on_backbone};
use crate::solution::Solution;
use crate::statics::Statics;
use crate::statics::options::StabilityAnalysis;
use crate::stations::Stations;
use crate::{
    constant_curvature, cosserat, cosserat_disks, four_bar, piecewise_constant_curvature,
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
        if case.obstacles.is_empty() && !robot.has_history() {
            let left = prepared.lead_to_last(case, warm_start)?;
            let chain = match &mut prepared {
                Prepared::Linkage(model, workspace) => Some((&**model, &mut **workspace)),
                Prepared::FourBar(model, workspace) => model.chain(workspace),
                _ => None,
            };
            if let Some((chain, workspace)) = chain {
                let last = Case { before: Vec::new(), ..case.clone() };
                return chain.solve_at(&last, arc_length, left.as_ref(), workspace);
            }
        }
        let (solution, derivatives) =
            prepared.solve_last_with_derivatives(case, warm_start, &[])?;
        let local = derivatives.at(crate::derivatives::Place::Station(0))?;
        Ok((solution, local))
    }
}
