//! What least squares make small: distances of disks, cables beyond the rims, and criteria.

mod criteria_rates;
mod fit_tensions;

use std::borrow::Cow;

use whipcord::derivatives::Place;
use whipcord::differences::differentiate;
use whipcord::{
    Case, Linearization, Model, Parameter, Prepared, Robot, Solution, SolveError,
    StabilityAnalysis, Statics as _, Vec3,
};
use whipcord_numerics::least_squares::{
    NoResiduals, Options, Residuals, Status, Workspace, minimise,
};

use crate::budget::Budget;
use crate::chebyshev;
use crate::criteria::{Criteria, Terms};
use crate::error::DesignError;
use crate::goal::ShapeGoal;
use crate::problem::DesignGoal;
use crate::unknown::{Unknown, applied, parameters};

/// An unknown with its start and bounds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounded {
    pub unknown: Unknown,
    pub start: f64,
    pub range: [f64; 2],
    /// Between which values other starts lie.
    pub starts: [f64; 2],
}

/// How a refinement is controlled.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RefineOptions<'a> {
    pub starts: usize,
    pub iterations: usize,
    pub seed: u64,
    /// How far from the axis a cable may be in m.
    pub rim: f64,
    /// What counts beside the distances.
    pub criteria: Option<&'a Criteria>,
    /// The goals where disks vary and some are curves: a disk that moves along the backbone is wanted elsewhere on the curve.
    pub on_curves: Option<&'a [DesignGoal]>,
    /// What may be spent; the first residuals are those of an answer in any case.
    pub budget: &'a Budget,
}

/// The first penalty of a cable beyond the rim, by its distance from there as a part of the rim: small, because the way along a rim is a circle, and a
/// steep penalty allows only small steps along it.
const FIRST_RIM_PENALTY: f64 = 1.0;
/// How far beyond the rim, as a part of it, a cable may be that is drawn in as a whole afterwards.
const RIM: f64 = 1e-4;
/// Rounds of the method of multipliers, the penalty of a violation in the first, and by how much it grows where violations hardly fall.
const ROUNDS: usize = 12;
const FIRST_PENALTY: f64 = 10.0;
const STEEPER: f64 = 5.0;

/// Solves that a derivative by differences takes.
const SOLVES_OF_A_DIFFERENCE: usize = 4;

/// A problem of least squares from one start.
pub(crate) struct Problem<'a> {
    model: Model,
    robot: &'a Robot,
    goals: &'a [ShapeGoal],
    cases: Vec<Case>,
    unknowns: Vec<Unknown>,
    steps: Vec<f64>,
    parameters: Vec<Parameter>,
    rim: f64,
    length: f64,
    criteria: Option<&'a Criteria>,
    /// The same with solves that end where the time of the design is over.
    stopped: Option<Criteria>,
    budget: &'a Budget,
    on_curves: Option<&'a [DesignGoal]>,
    /// Of each constraint its multiplier by the penalty, in the method of multipliers, and the penalty.
    shifts: Vec<f64>,
    penalty: f64,
    /// The same of each station of cables that are held within the rim.
    rim_shifts: Vec<f64>,
    rim_penalty: f64,
    /// How many objectives and constraints there are.
    terms: [usize; 2],
    /// The answers at the last unknowns, which the next ones start from.
    answers: Vec<Option<Solution>>,
    /// What the residuals were asked for last, ready to be differentiated.
    last: Option<Moved>,
    /// Cables with a course of so many nodes.
    courses: Vec<(usize, usize)>,
    /// Whether the residuals of the present minimisation were asked for.
    is_begun: bool,
}

/// How a minimisation ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// No small change is better.
    Converged,
    /// The steps were spent.
    Steps,
    /// No step is better, however short, though the derivatives promise it.
    Stalled,
    /// The model has no answer beyond.
    Refused,
    /// A constraint could not be kept.
    Constraints,
    /// The budget was spent.
    Budget,
}

/// The robot and the cases with some values of the unknowns, and a model of each that is ready to be solved.
struct Moved {
    robot: Robot,
    cases: Vec<Case>,
    prepared: Vec<Prepared>,
}

impl<'a> Problem<'a> {
    pub fn new(
        model: &Model,
        robot: &'a Robot,
        goals: &'a [ShapeGoal],
        unknowns: &[Bounded],
        options: &RefineOptions<'a>,
    ) -> Result<Self, DesignError> {
        let list: Vec<Unknown> = unknowns.iter().map(|of| of.unknown).collect();
        let mut courses = Vec::new();
        for unknown in &list {
            if let Unknown::Course { cable, nodes, .. } = *unknown
                && !courses.contains(&(cable, nodes))
            {
                courses.push((cable, nodes));
            }
        }
        let step = |of: &Bounded| 1e-4 * (of.starts[1] - of.starts[0]).abs().max(1e-9);
        let mut problem = Self {
            model: model.clone().with_stability(StabilityAnalysis::Off),
            robot,
            goals,
            cases: goals.iter().map(|goal| goal.case.clone()).collect(),
            parameters: parameters(&list),
            unknowns: list,
            steps: unknowns.iter().map(step).collect(),
            rim: options.rim,
            length: robot.backbone().length,
            criteria: options.criteria.filter(|criteria| !criteria.is_empty()),
            stopped: None,
            budget: options.budget,
            on_curves: options.on_curves,
            shifts: Vec::new(),
            penalty: FIRST_PENALTY,
            rim_shifts: vec![0.0; courses.iter().map(|(_, nodes)| Self::stations(*nodes)).sum()],
            rim_penalty: FIRST_RIM_PENALTY,
            terms: [0; 2],
            answers: vec![None; goals.len()],
            last: None,
            courses,
            is_begun: false,
        };
        if let Some(criteria) = problem.criteria {
            problem.stopped = Some(criteria.until(options.budget.stop()));
            let start: Vec<f64> =
                unknowns.iter().map(|of| of.start.clamp(of.range[0], of.range[1])).collect();
            let terms = problem.terms(&start)?;
            problem.terms = [terms.objectives.len(), terms.violations.len()];
            problem.shifts = vec![0.0; terms.violations.len()];
        }
        Ok(problem)
    }

    /// Minimises from some values by the method of multipliers of Powell and of Hestenes and leaves the best in them; how that ended.
    pub fn constrained(
        &mut self,
        values: &mut [f64],
        minimiser: &Options,
    ) -> Result<Ending, NoResiduals<DesignError>> {
        let mut before = [f64::INFINITY; 2];
        let mut workspace = Workspace::default();
        for round in 0..ROUNDS {
            self.is_begun = false;
            let outcome = minimise(self, values, minimiser, &mut workspace)?;
            if !outcome.status.is_converged() && self.budget.is_over() {
                // Whether constraints are kept is asked of the design that is left.
                return Ok(Ending::Budget);
            }
            let terms = self.terms(values).map_err(NoResiduals::Refused)?;
            let beyond = self.beyond(values);
            let worst = [
                terms.worst_violation(),
                beyond.iter().copied().fold(f64::NEG_INFINITY, f64::max) - RIM,
            ];
            let is_kept = worst.iter().all(|worst| *worst <= 0.0);
            if is_kept {
                return Ok(match outcome.status {
                    Status::IterationLimit => Ending::Steps,
                    Status::Stalled => Ending::Stalled,
                    Status::Refused => Ending::Refused,
                    Status::Gradient | Status::Step | Status::Cost => Ending::Converged,
                });
            }
            if round + 1 == ROUNDS {
                break;
            }
            if self.budget.is_over() {
                return Ok(Ending::Budget);
            }
            let kinds = [
                (&mut self.shifts, &terms.violations, &mut self.penalty),
                (&mut self.rim_shifts, &beyond, &mut self.rim_penalty),
            ];
            for (kind, (shifts, violations, penalty)) in kinds.into_iter().enumerate() {
                for (shift, violation) in shifts.iter_mut().zip(violations) {
                    *shift = (*shift + violation).max(0.0);
                }
                if worst[kind] > 0.3 * before[kind] {
                    *penalty *= STEEPER;
                    shifts.iter_mut().for_each(|shift| *shift /= STEEPER);
                }
                before[kind] = worst[kind].max(0.0);
            }
        }
        Ok(Ending::Constraints)
    }

    pub const fn cases(&self) -> &[Case] {
        self.cases.as_slice()
    }

    /// How far beyond the rim each station of the varied cables is, as a part of the rim; negative within.
    fn beyond(&self, values: &[f64]) -> Vec<f64> {
        let offsets =
            self.courses.iter().flat_map(|(cable, nodes)| self.offsets(values, *cable, *nodes));
        offsets.map(|[x, y]| x.hypot(y) / self.rim - 1.0).collect()
    }

    /// What the criteria make of these unknowns.
    fn terms(&mut self, values: &[f64]) -> Result<Terms, DesignError> {
        let Some(criteria) = self.criteria else { return Ok(Terms::default()) };
        if criteria.are_of_commands(&self.cases) {
            let (robot, cases) = applied(self.robot, &self.cases, &self.unknowns, values)?;
            return criteria.terms(&robot, &cases, &[]);
        }
        let mut moved = self.prepared(values)?;
        let solutions = self.solved(&mut moved)?;
        criteria.terms(&moved.robot, &moved.cases, &solutions)
    }

    /// Residuals of criteria: objectives, then constraints that are violated or were.
    fn of_criteria(&self, terms: &Terms) -> Vec<f64> {
        let root = self.penalty.sqrt();
        let violated = terms.violations.iter().zip(&self.shifts);
        let violated = violated.map(|(of, shift)| root * (of + shift).max(0.0));
        terms.objectives.iter().copied().chain(violated).collect()
    }

    pub fn points(&self) -> usize {
        self.goals.iter().map(|goal| goal.points.len()).sum()
    }

    /// Stations at which a course is held within the rim.
    const fn stations(nodes: usize) -> usize {
        4 * nodes
    }

    fn course(&self, values: &[f64], cable: usize, nodes: usize) -> [Vec<f64>; 2] {
        let mut course = [vec![0.0; nodes], vec![0.0; nodes]];
        for (unknown, value) in self.unknowns.iter().zip(values) {
            if let Unknown::Course { cable: of, axis, node, .. } = *unknown
                && of == cable
            {
                course[axis][node] = *value;
            }
        }
        course.map(|values| chebyshev::powers(&values, self.length))
    }

    /// The place of a cable at the stations at which it is held within the rim.
    fn offsets(&self, values: &[f64], cable: usize, nodes: usize) -> Vec<[f64; 2]> {
        let course = self.course(values, cable, nodes);
        let count = Self::stations(nodes);
        whipcord::equally_spaced(0.0, self.length, count)
            .map(|s| [chebyshev::value(&course[0], s), chebyshev::value(&course[1], s)])
            .collect()
    }

    /// The values with courses that go beyond the rim drawn in as a whole.
    pub fn within_rim(&self, values: &[f64]) -> Vec<f64> {
        let mut values = values.to_vec();
        for &(cable, nodes) in &self.courses {
            let offsets = self.offsets(&values, cable, nodes);
            let farthest = offsets.iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max);
            if farthest > self.rim {
                for (unknown, value) in self.unknowns.iter().zip(&mut values) {
                    if matches!(unknown, Unknown::Course { cable: of, .. } if *of == cable) {
                        *value *= self.rim / farthest;
                    }
                }
            }
        }
        values
    }

    /// The robot and the cases with these values, ready to be solved.
    fn prepared(&mut self, values: &[f64]) -> Result<Moved, DesignError> {
        let (robot, cases) = applied(self.robot, &self.cases, &self.unknowns, values)?;
        // Tensions leave the robot as it is.
        let is_kept = self.unknowns.iter().all(|of| matches!(of, Unknown::Tension { .. }));
        if is_kept && let Some(last) = self.last.take() {
            return Ok(Moved { cases, ..last });
        }
        let prepare = |case: &Case| self.model.prepare(&robot, &case.loads);
        let prepared = cases.iter().map(prepare).collect::<Result<Vec<_>, _>>()?;
        Ok(Moved { robot, cases, prepared })
    }

    fn solved(&self, moved: &mut Moved) -> Result<Vec<Solution>, DesignError> {
        let mut solutions = Vec::with_capacity(moved.cases.len());
        let models = moved.prepared.iter_mut().zip(&moved.cases);
        for ((model, case), answer) in models.zip(&self.answers) {
            let solution = model.solve(case, answer.as_ref());
            // A neighbouring answer may mislead where an unknown has changed much.
            let solution = match solution {
                Err(_) if answer.is_some() => model.solve(case, None),
                solution => solution,
            };
            solutions.push(solution?);
        }
        let of_criteria = self.criteria.map_or(0, Criteria::effort);
        self.budget.spend(solutions.len() + of_criteria);
        Ok(solutions)
    }

    /// What starts are compared by, in m²; `None` where the model has no answer without a neighbouring one to start from, as near a fold.
    pub fn cost(&mut self, values: &[f64]) -> Option<f64> {
        self.answers.fill(None);
        let mut moved = self.prepared(values).ok()?;
        let solutions = self.solved(&mut moved).ok()?;
        let goals = self.wanted(&moved.robot).ok()?;
        let goals = goals.iter().zip(&solutions);
        let cost = goals.map(|(goal, solution)| goal.cost(&solution.disks.poses)).sum::<f64>();
        let Some(criteria) = self.criteria else { return Some(cost) };
        let more = criteria.cost(&moved.robot, &moved.cases, &solutions, f64::INFINITY).ok()?;
        Some(cost + more)
    }

    fn by_difference(
        &self,
        values: &[f64],
        unknown: usize,
        goal: usize,
    ) -> Result<Vec<Vec3>, DesignError> {
        let moved = |by: f64| -> Result<Solution, SolveError> {
            let mut values = values.to_vec();
            values[unknown] += by;
            let (robot, cases) = applied(self.robot, &self.cases, &self.unknowns, &values)?;
            self.model.solve(&robot, &cases[goal])
        };
        if self.budget.is_over() {
            return Err(DesignError::Ended);
        }
        self.budget.spend(SOLVES_OF_A_DIFFERENCE);
        let step = self.steps[unknown];
        let difference = differentiate(moved, step)?;
        let points = &self.goals[goal].points;
        let mut rates: Vec<Vec3> =
            points.iter().map(|(disk, _)| difference.disks[*disk].linear).collect();
        if let (Some(goals), Unknown::DiskPosition { .. }) =
            (self.on_curves, self.unknowns[unknown])
        {
            let side = |by: f64| -> Result<Vec<(usize, Vec3)>, DesignError> {
                let mut values = values.to_vec();
                values[unknown] += by;
                let (robot, _) = applied(self.robot, &self.cases, &self.unknowns, &values)?;
                goals[goal].points(&robot)
            };
            let (from, to) = (side(-step)?, side(step)?);
            for (rate, ((_, from), (_, to))) in rates.iter_mut().zip(from.iter().zip(&to)) {
                *rate -= (*to - *from) * (0.5 / step);
            }
        }
        Ok(rates)
    }

    /// The goals with the places that the disks of a robot are wanted at.
    fn wanted(&self, robot: &Robot) -> Result<Cow<'a, [ShapeGoal]>, DesignError> {
        let Some(goals) = self.on_curves else { return Ok(Cow::Borrowed(self.goals)) };
        let goals = goals.iter().map(|goal| goal.shape_goal(robot));
        Ok(Cow::Owned(goals.collect::<Result<_, _>>()?))
    }
}

impl Residuals for Problem<'_> {
    type Refusal = DesignError;

    fn count(&self) -> usize {
        let beyond: usize = self.courses.iter().map(|(_, nodes)| Self::stations(*nodes)).sum();
        3 * self.points() + beyond + self.terms.iter().sum::<usize>()
    }

    fn residuals(&mut self, unknowns: &[f64], into: &mut [f64]) -> Result<(), DesignError> {
        let is_first = !self.is_begun;
        if !is_first && self.budget.is_over() {
            return Err(DesignError::Ended);
        }
        self.is_begun = true;
        let mut moved = self.prepared(unknowns)?;
        let solutions = self.solved(&mut moved)?;
        let mut row = 0;
        for (goal, solution) in self.wanted(&moved.robot)?.iter().zip(&solutions) {
            let factor = goal.weight.sqrt() / self.length;
            for (disk, point) in &goal.points {
                let off = (solution.disks.poses[*disk].position - *point) * factor;
                into[row..row + 3].copy_from_slice(&off.to_array());
                row += 3;
            }
        }
        let root = self.rim_penalty.sqrt();
        for (beyond, shift) in self.beyond(unknowns).iter().zip(&self.rim_shifts) {
            into[row] = root * (beyond + shift).max(0.0);
            row += 1;
        }
        let criteria = if is_first { self.criteria } else { self.stopped.as_ref() };
        if let Some(criteria) = criteria {
            let terms = criteria.terms(&moved.robot, &moved.cases, &solutions);
            if !is_first && self.budget.stop().is_cancelled() {
                return Err(DesignError::Ended);
            }
            let terms = terms?;
            into[row..].copy_from_slice(&self.of_criteria(&terms));
        }
        self.last = Some(moved);
        self.answers = solutions.into_iter().map(Some).collect();
        Ok(())
    }

    fn jacobian(&mut self, unknowns: &[f64], into: &mut [f64]) -> Result<(), DesignError> {
        if self.budget.is_over() {
            return Err(DesignError::Ended);
        }
        let columns = self.unknowns.len();
        into.fill(0.0);
        // Those of the residuals, which were asked for these unknowns before.
        let mut moved = match self.last.take() {
            Some(last) => last,
            None => self.prepared(unknowns)?,
        };
        let is_exact = self.model.has_derivatives(&moved.robot);
        let mut first = 0;
        for (number, goal) in self.goals.iter().enumerate() {
            let factor = goal.weight.sqrt() / self.length;
            let disks: Vec<Place> =
                goal.points.iter().map(|(disk, _)| Place::Disk(*disk)).collect();
            let derivatives: Option<Linearization> = match is_exact {
                true => {
                    self.budget.spend(1);
                    let (model, case) = (&mut moved.prepared[number], &moved.cases[number]);
                    let warm = self.answers[number].as_ref();
                    Some(model.solve_with_derivatives(case, warm, &self.parameters)?.1)
                }
                false => None,
            };
            for (column, unknown) in self.unknowns.iter().enumerate() {
                let velocities = match &derivatives {
                    Some(derivatives) if unknown.has_derivative() => unknown.velocities(
                        number,
                        &moved.cases[number],
                        self.length,
                        (derivatives, &self.parameters),
                        &disks,
                    ),
                    _ => self.by_difference(unknowns, column, number)?,
                };
                for (point, velocity) in velocities.iter().enumerate() {
                    for (axis, value) in velocity.to_array().into_iter().enumerate() {
                        into[(first + 3 * point + axis) * columns + column] = value * factor;
                    }
                }
            }
            first += 3 * disks.len();
        }
        let root = self.rim_penalty.sqrt();
        let mut station = 0;
        for &(cable, nodes) in &self.courses {
            let offsets = self.offsets(unknowns, cable, nodes);
            let count = Self::stations(nodes);
            let shifts = &self.rim_shifts[station..station + count];
            station += count;
            for (column, unknown) in self.unknowns.iter().enumerate() {
                let Unknown::Course { cable: of, axis, node, .. } = *unknown else { continue };
                if of != cable {
                    continue;
                }
                let shape = chebyshev::of_node(node, nodes, self.length);
                let stations = whipcord::equally_spaced(0.0, self.length, count);
                for (row, (offset, s)) in offsets.iter().zip(stations).enumerate() {
                    let radius = offset[0].hypot(offset[1]);
                    if radius / self.rim - 1.0 + shifts[row] > 0.0 && radius > 0.0 {
                        into[(first + row) * columns + column] =
                            root * offset[axis] / radius * chebyshev::value(&shape, s) / self.rim;
                    }
                }
            }
            first += count;
        }
        if self.criteria.is_some() {
            self.criteria_jacobian(&moved, unknowns, &mut into[first * columns..])?;
        }
        self.last = Some(moved);
        Ok(())
    }
}
