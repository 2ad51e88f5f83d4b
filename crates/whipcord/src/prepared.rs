//! Models built for one robot, which many of its cases are solved with.

use crate::budget::Budget;
use crate::cancel::Cancel;
use crate::case::{Case, Loads};
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::refusal;
use crate::robot::Robot;
use crate::solution::Solution;
use crate::statics::path::branches::{BranchOptions, Branches};
use crate::warm_start::{Status, WarmStart};
use crate::{constant_curvature, cosserat, cosserat_disks, four_bar, linkage};

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
    /// where a Cosserat rod without friction and obstacles bears dead loads that are weak for its stiffness, eq. (16) of its page, or no load. Of cables that are driven by their
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
