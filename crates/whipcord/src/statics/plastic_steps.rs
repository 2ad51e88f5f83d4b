//! Steps of actuation of a rod whose backbone has friction against bending.
//!
//! In every step the plastic curvature that the steps before left is given, and the rod is a nonlinear elastic one
//! ([`crate::section`]); what it leaves itself is the start of the next step.

use super::friction::{Carried, Carrying, Place, SubstepEnd, Trail};
use super::plastic_curvature::PlasticCurvature;
use crate::budget::{Budget, Meter};
use crate::cancel::Cancel;
use crate::case::Case;
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::parameter::Parameter;
use crate::robot::Robot;
use crate::solution::Solution;

/// Derivatives of a step, the plastic curvature that it leaves, and how this changes with each parameter.
pub(crate) type Differentiated<D> = (D, PlasticCurvature, Vec<PlasticCurvature>);

/// How what friction remembers changes from step to step of actuation, on one grid.
#[derive(Clone, Debug, Default)]
pub(crate) struct Remembering {
    /// In the holes.
    holes: Carrying,
    /// Along the backbone.
    bends: RememberedBends,
}

impl Remembering {
    /// [`Carrying::go`], with what friction against bending remembers.
    pub fn go<S, D>(
        &mut self,
        trail: &Trail<S>,
        kept: usize,
        mut differentiate: impl FnMut(
            &mut RememberedBends,
            &SubstepEnd<S>,
            Option<&[Carried]>,
            Place,
        ) -> Result<(D, Option<Vec<Carried>>), SolveError>,
    ) -> Result<D, SolveError> {
        let Self { holes, bends } = self;
        holes.go(trail, kept, |end, carried, place| differentiate(bends, end, carried, place))
    }
}

/// How the plastic curvature that each step leaves changes with each parameter.
#[derive(Clone, Debug, Default)]
pub(crate) struct RememberedBends(Vec<Vec<PlasticCurvature>>);

impl RememberedBends {
    /// How the plastic curvature changes that a step of a robot starts from, with each parameter; none where it keeps none.
    ///
    /// # Errors
    /// [`SolveError::NoDerivativesOfRest`] where that is not known of the step before.
    pub fn before(&self, robot: &Robot, step: usize) -> Result<&[PlasticCurvature], SolveError> {
        match step.checked_sub(1).filter(|_| robot.has_bending_friction()) {
            None => Ok(&[]),
            Some(before) => {
                self.0.get(before).map(Vec::as_slice).ok_or(SolveError::NoDerivativesOfRest)
            }
        }
    }

    /// Notes the same of that which it leaves.
    pub fn note(&mut self, step: usize, changes: Vec<PlasticCurvature>) {
        self.0.truncate(step);
        self.0.push(changes);
    }
}

/// A rod that is solved from a plastic curvature that is given.
pub(crate) trait PlasticRod: Clone {
    /// The model that it is of.
    const KIND: ModelKind;
    /// Its memory.
    type Workspace;
    /// The derivatives of an answer.
    type Derivatives;

    fn robot(&self) -> &Robot;

    /// What ends a solve from outside, and its budget.
    fn limits(&self) -> (&Cancel, Budget);

    fn meter(workspace: &mut Self::Workspace) -> &mut Meter;

    /// One step of actuation from the plastic curvature that was set: its answer and the plastic curvature that it leaves.
    fn take_step(
        &self,
        step: &Case,
        from: Option<&Solution>,
        workspace: &mut Self::Workspace,
        solution: &mut Solution,
    ) -> Result<PlasticCurvature, SolveError>;

    /// The same with its derivatives, from how the plastic curvature changes with each parameter.
    fn differentiate_step(
        &self,
        step: &Case,
        from: (Option<&Solution>, &[PlasticCurvature]),
        parameters: &[Parameter],
        workspace: &mut Self::Workspace,
        solution: &mut Solution,
    ) -> Result<Differentiated<Self::Derivatives>, SolveError>;

    /// Sets the plastic curvature that a step of actuation left.
    fn set_plastic(&mut self, left: PlasticCurvature);

    /// Starts the count of a solve.
    fn start_meter(&self, workspace: &mut Self::Workspace) {
        let (cancel, budget) = self.limits();
        Self::meter(workspace).start(cancel, budget);
    }

    /// The answer to the last of the steps of a case, from the robot at rest through all of them.
    fn solve_with_bending_friction(
        &self,
        case: &Case,
        workspace: &mut Self::Workspace,
        solution: &mut Solution,
    ) -> Result<(), SolveError> {
        case.check(self.robot())?;
        let mut rod = self.clone();
        let mut last: Option<Solution> = None;
        for step in case.leading_steps() {
            let mut answer = Solution::empty(Self::KIND);
            let left = rod.take_step(&step, last.as_ref(), workspace, &mut answer)?;
            rod.set_plastic(left);
            last = Some(answer);
        }
        if let Some(answer) = last {
            *solution = answer;
        }
        Ok(())
    }

    /// The answers to all steps of a case in order.
    fn solve_steps_with_bending_friction(
        &self,
        case: &Case,
        workspace: &mut Self::Workspace,
        mut each: impl FnMut(Solution),
    ) -> Result<(), (usize, SolveError)> {
        let mut rod = self.clone();
        let mut last: Option<Solution> = None;
        for (n, step) in case.single_steps().enumerate() {
            self.start_meter(workspace);
            let mut answer = Solution::empty(Self::KIND);
            let taken = rod.take_step(&step, last.as_ref(), workspace, &mut answer);
            let left = Self::meter(workspace).checked(taken).map_err(|error| (n, error))?;
            rod.set_plastic(left);
            each(last.insert(answer).clone());
        }
        Ok(())
    }

    /// [`Self::differentiate_with_bending_friction`] as a solve of its own.
    fn differentiate_steps(
        &self,
        case: &Case,
        parameters: &[Parameter],
        workspace: &mut Self::Workspace,
        each: impl FnMut(Solution, Self::Derivatives),
    ) -> Result<(), (usize, SolveError)> {
        self.start_meter(workspace);
        self.differentiate_with_bending_friction(case, parameters, workspace, each)
    }

    /// The answers to all steps of a case in order, with their derivatives by these parameters through all steps before.
    ///
    /// # Errors
    /// The number of the first step without them, from 0, and why.
    fn differentiate_with_bending_friction(
        &self,
        case: &Case,
        parameters: &[Parameter],
        workspace: &mut Self::Workspace,
        mut each: impl FnMut(Solution, Self::Derivatives),
    ) -> Result<(), (usize, SolveError)> {
        case.check(self.robot()).map_err(|error| (0, error.into()))?;
        let mut rod = self.clone();
        let mut history: Vec<PlasticCurvature> = Vec::new();
        let mut last: Option<Solution> = None;
        for (n, step) in case.leading_steps().enumerate() {
            let mut solution = Solution::empty(Self::KIND);
            let from = (last.as_ref(), &history[..]);
            let taken = rod.differentiate_step(&step, from, parameters, workspace, &mut solution);
            let (derivatives, left, changes) = taken.map_err(|error| (n, error))?;
            history = changes;
            rod.set_plastic(left);
            each(last.insert(solution).clone(), derivatives);
        }
        Ok(())
    }
}
