//! The solves of both Cosserat rods among obstacles.

use super::alone::AloneAnswers;
use super::contact_rod::ContactRod;
use super::free_path::{FreeWay, last_of, or_none_alone, rubbing_or_free, steps_alone};
use super::noted::last_with_derivatives;
use super::rod::{RodAdapter, differentiate_rubbing, on_few_steps_or_more, rub};
use super::steps::{solve, solve_holding};
use crate::budget::Meter;
use crate::case::Case;
use crate::derivatives::Derivatives;
use crate::error::SolveError;
use crate::parameter::Parameter;
use crate::robot::Cable;
use crate::solution::Solution;
use crate::statics::options::Accuracy;
use crate::statics::plastic_curvature::PlasticCurvature;
use crate::statics::plastic_steps::{Differentiated, PlasticRod};

/// Steps from base to tip at least where friction against bending keeps a history at their ends.
const BENDING_FRICTION_STEPS: usize = 20;

/// What it takes of a rod.
pub(crate) trait RodSolves: PlasticRod<Derivatives = Derivatives> {
    type Rod: ContactRod + Clone;

    /// Steps from base to tip at least where cables rub, on which alone it is then solved; `None` where few steps come first.
    const RUBBING_STEPS: Option<usize>;

    fn accuracy(&self) -> Accuracy;

    /// How many steps the loads of a case need.
    fn needed_steps(&self, case: &Case, memory: &mut Self::Workspace) -> usize;

    /// The rod with so many steps at least, whose solve a meter counts.
    fn adapter<'a>(
        &'a self,
        steps: usize,
        meter: &'a Meter,
    ) -> Result<RodAdapter<'a, Self::Rod>, SolveError>;

    /// The shape of a robot that keeps clear of the obstacles of a checked case.
    fn find_clear(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        memory: &mut Self::Workspace,
    ) -> Result<FreeWay, SolveError>;

    /// The answer to a case without obstacles of a robot without history, by what is left of the budget.
    fn solve_alone(
        &self,
        case: &Case,
        memory: &mut Self::Workspace,
    ) -> Result<Solution, SolveError>;

    /// The answers to all steps of actuation of a case without obstacles.
    fn solve_steps_alone(
        &self,
        case: &Case,
        memory: &mut Self::Workspace,
        each: &mut dyn FnMut(Solution),
    ) -> Result<(), (usize, SolveError)>;

    /// The same of a robot whose cables rub, those that are asked for by their number from 0 with their derivatives.
    fn differentiate_steps_alone(
        &self,
        of: (&Case, &[Parameter]),
        asks: &dyn Fn(usize) -> bool,
        memory: &mut Self::Workspace,
        each: &mut dyn FnMut((Solution, Option<Derivatives>)),
    ) -> Result<(), (usize, SolveError)>;

    /// The plastic curvature that was set.
    fn plastic(&self) -> Option<&PlasticCurvature>;

    /// The answer to a case without obstacles with its derivatives, from a neighbouring answer when given.
    fn differentiate_alone(
        &self,
        case: &Case,
        near: Option<&Solution>,
        parameters: &[Parameter],
        memory: &mut Self::Workspace,
    ) -> Result<(Solution, Derivatives), SolveError>;

    /// The shape among the obstacles of a case: without them where the robot keeps clear of them.
    fn solve_among_obstacles(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        memory: &mut Self::Workspace,
    ) -> Result<Solution, SolveError> {
        if self.rubs() {
            return last_of(|each| self.rub_among_obstacles(case, memory, each));
        }
        self.check_among_obstacles(case)?;
        let (first_step, found) = match self.find_clear(case, warm_start, memory)? {
            FreeWay::Clear(solution) => return Ok(solution),
            FreeWay::Unclear { first_step, alone } => (first_step, alone),
        };
        // Near a warm start there may be another than from rest.
        let alone = AloneAnswers::knowing(case, found.filter(|_| warm_start.is_none()));
        let needed = self.needed_steps(case, memory);
        let meter = &*Self::meter(memory);
        let found = on_few_steps_or_more(self.accuracy(), needed, |steps| {
            let mut adapter = self.adapter(steps, meter)?.sharing(&alone);
            solve(&mut adapter, self.robot(), (case, first_step), warm_start)
        });
        or_none_alone(found, case, |case| alone.answer(case, || self.solve_alone(case, memory)))
    }

    /// With friction of the cables: the answers to all steps of actuation, from rest on.
    fn rub_among_obstacles(
        &self,
        case: &Case,
        memory: &mut Self::Workspace,
        each: impl FnMut(Solution),
    ) -> Result<(), (usize, SolveError)> {
        self.check_among_obstacles(case).map_err(|error| (0, error))?;
        let mut found = Vec::new();
        let followed = self.on_steps(case, memory, |steps, meter| {
            found.clear();
            let mut adapter = self.adapter(steps, meter).map_err(|error| (0, error))?;
            rub(&mut adapter, case, |of_step| found.push(of_step))
        });
        let found = (found, followed);
        rubbing_or_free(
            case,
            found,
            |of| of,
            each,
            |alone, each| self.solve_steps_alone(alone, memory, each),
        )
    }

    /// The answer to a case without obstacles of a robot whose cables do not rub, with its derivatives by these parameters where they are asked for.
    fn alone(
        &self,
        (case, near): (&Case, Option<&Solution>),
        asked: Option<&[Parameter]>,
        memory: &mut Self::Workspace,
    ) -> Result<(Solution, Option<Derivatives>), SolveError> {
        let Some(parameters) = asked else { return Ok((self.solve_alone(case, memory)?, None)) };
        let (solution, of) = self.differentiate_alone(case, near, parameters, memory)?;
        Ok((solution, Some(of)))
    }

    /// The same where cables or obstacles rub, those that are asked for by their number from 0 with their derivatives.
    fn rub_with_derivatives(
        &self,
        (case, parameters): (&Case, &[Parameter]),
        asks: &dyn Fn(usize) -> bool,
        memory: &mut Self::Workspace,
        each: impl FnMut((Solution, Option<Derivatives>)),
    ) -> Result<(), (usize, SolveError)> {
        self.check_among_obstacles(case).map_err(|error| (0, error))?;
        let mut first_step = 1.0;
        if !self.rubs() && case.leading_steps().nth(1).is_none() {
            match self.find_clear(case, None, memory).map_err(|error| (0, error))? {
                FreeWay::Clear(solution) => {
                    return steps_alone(case, asks, each, |step, asked| {
                        self.alone((step, Some(&solution)), asked.then_some(parameters), memory)
                    });
                }
                FreeWay::Unclear { first_step: first, .. } => first_step = first,
            }
        }
        let mut found = Vec::new();
        let followed = self.on_steps(case, memory, |steps, meter| {
            let adapter = self.adapter(steps, meter).map_err(|error| (0, error))?;
            let mut adapter = adapter.with_stations().taking_notes();
            let of = (case, first_step, parameters);
            differentiate_rubbing(&mut adapter, of, asks, &mut found)
        });
        rubbing_or_free(
            case,
            (found, followed),
            |(of, _)| of,
            each,
            |alone, each| {
                if self.rubs() {
                    let of = (alone, parameters);
                    return self.differentiate_steps_alone(of, asks, memory, each);
                }
                steps_alone(alone, asks, each, |step, asked| {
                    self.alone((step, None), asked.then_some(parameters), memory)
                })
            },
        )
    }

    /// The answer to a case among obstacles, with its derivatives and the contacts that hold it.
    fn differentiate_among_obstacles(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        parameters: &[Parameter],
        memory: &mut Self::Workspace,
    ) -> Result<(Solution, Derivatives), SolveError> {
        if self.rubs() || (warm_start.is_none() && case.differentiates_way(self.robot())) {
            let of = (case, parameters);
            return last_with_derivatives(case, |asks, each| {
                self.rub_with_derivatives(of, asks, memory, each)
            });
        }
        self.check_among_obstacles(case)?;
        let (first_step, found) = match self.find_clear(case, warm_start, memory)? {
            FreeWay::Clear(solution) => {
                let alone = Case { obstacles: Vec::new(), ..case.clone() };
                return self.differentiate_alone(&alone, Some(&solution), parameters, memory);
            }
            FreeWay::Unclear { first_step, alone } => (first_step, alone),
        };
        let alone = AloneAnswers::knowing(case, found.filter(|_| warm_start.is_none()));
        let needed = self.needed_steps(case, memory);
        let meter = &*Self::meter(memory);
        on_few_steps_or_more(self.accuracy(), needed, |steps| {
            let mut adapter = self.adapter(steps, meter)?.with_stations().sharing(&alone);
            let (solution, holding) =
                solve_holding(&mut adapter, self.robot(), (case, first_step), warm_start)?;
            Ok((solution, adapter.differentiate(&holding, &[], parameters)?))
        })
    }

    /// One step of actuation of a backbone with friction against bending, and the plastic curvature that it leaves.
    fn take_step_among_obstacles(
        &self,
        step: &Case,
        from: Option<&Solution>,
        memory: &mut Self::Workspace,
    ) -> Result<(Solution, PlasticCurvature), SolveError> {
        self.check_among_obstacles(step)?;
        let first_step = match self.find_clear(step, from, memory)? {
            FreeWay::Clear(_) => {
                // Other shapes were looked at since: it is found once more, as without obstacles.
                let alone = Case { obstacles: Vec::new(), ..step.clone() };
                let mut solution = Solution::empty(Self::KIND);
                let left = self.take_step(&alone, from, memory, &mut solution)?;
                return Ok((solution, left));
            }
            FreeWay::Unclear { first_step, .. } => first_step,
        };
        let needed = self.needed_steps(step, memory).max(BENDING_FRICTION_STEPS);
        let meter = &*Self::meter(memory);
        let found = on_few_steps_or_more(self.accuracy(), needed, |steps| {
            let mut adapter = self.adapter(steps, meter)?.with_plastic(self.plastic());
            let solution = solve(&mut adapter, self.robot(), (step, first_step), from)?;
            Ok((solution, adapter.plastic_left()?))
        });
        or_none_alone(found, step, |alone| {
            let mut solution = Solution::empty(Self::KIND);
            self.take_step(alone, None, memory, &mut solution).map(|_| solution)
        })
    }

    /// The same with its derivatives, where the plastic curvature before changes with each parameter as `history` says, and how that which it
    /// leaves changes.
    fn differentiate_step_among_obstacles(
        &self,
        (step, from): (&Case, Option<&Solution>),
        (history, parameters): (&[PlasticCurvature], &[Parameter]),
        memory: &mut Self::Workspace,
    ) -> Result<(Solution, Differentiated<Derivatives>), SolveError> {
        self.check_among_obstacles(step)?;
        let first_step = match self.find_clear(step, from, memory)? {
            FreeWay::Clear(_) => {
                let alone = Case { obstacles: Vec::new(), ..step.clone() };
                let mut solution = Solution::empty(Self::KIND);
                let from = (from, history);
                let found =
                    self.differentiate_step(&alone, from, parameters, memory, &mut solution)?;
                return Ok((solution, found));
            }
            FreeWay::Unclear { first_step, .. } => first_step,
        };
        let needed = self.needed_steps(step, memory).max(BENDING_FRICTION_STEPS);
        let meter = &*Self::meter(memory);
        on_few_steps_or_more(self.accuracy(), needed, |steps| {
            let mut adapter =
                self.adapter(steps, meter)?.with_plastic(self.plastic()).with_stations();
            let (solution, holding) =
                solve_holding(&mut adapter, self.robot(), (step, first_step), from)?;
            let derivatives = adapter.differentiate(&holding, history, parameters)?;
            let grid = adapter.grid().ok_or(SolveError::NoDerivatives)?;
            let (left, changes) = derivatives.plastic_left(self.robot(), grid);
            Ok((solution, (derivatives, left, changes)))
        })
    }

    /// Whether a cable rubs.
    fn rubs(&self) -> bool {
        self.robot().cables().iter().any(Cable::has_friction)
    }

    fn check_among_obstacles(&self, case: &Case) -> Result<(), SolveError> {
        case.check(self.robot())?;
        Ok(())
    }

    /// Follows the steps of actuation of a robot whose cables or obstacles rub, on as many steps as it takes. The error is that of the step of
    /// actuation with this number.
    fn on_steps(
        &self,
        case: &Case,
        memory: &mut Self::Workspace,
        mut follow: impl FnMut(usize, &Meter) -> Result<(), (usize, SolveError)>,
    ) -> Result<(), (usize, SolveError)> {
        let least = if self.robot().has_bending_friction() { BENDING_FRICTION_STEPS } else { 0 };
        let needed = self.needed_steps(case, memory).max(least);
        let meter = &*Self::meter(memory);
        if let Some(least) = Self::RUBBING_STEPS.filter(|_| self.rubs()) {
            return follow(needed.max(least), meter);
        }
        let mut number = 0;
        let followed = on_few_steps_or_more(self.accuracy(), needed, |steps| {
            follow(steps, meter).map_err(|(n, error)| {
                number = n;
                error
            })
        });
        followed.map_err(|error| (number, error))
    }
}
