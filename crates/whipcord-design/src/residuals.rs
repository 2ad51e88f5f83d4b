//! What least squares make small: distances of disks, cables beyond the rims, and criteria.

use whipcord::differences::differentiate;
use whipcord::{
    Case, Linearization, Model, Parameter, Robot, Solution, SolveError, Statics as _, Vec3,
};
use whipcord_numerics::least_squares::{NoResiduals, Options, Residuals, Workspace, minimise};

use crate::chebyshev;
use crate::criteria::{Criteria, Terms};
use crate::error::DesignError;
use crate::goal::ShapeGoal;
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
}

/// What a cable beyond the rim costs: so many lengths of the backbone for each radius beyond it.
const BEYOND: f64 = 10.0;
/// Rounds of the method of multipliers, the penalty of a violation in the first, and by how much it grows where violations hardly fall.
const ROUNDS: usize = 12;
const FIRST_PENALTY: f64 = 10.0;
const STEEPER: f64 = 5.0;

/// A problem of least squares from one start.
pub(crate) struct Problem<'a> {
    model: &'a Model,
    robot: &'a Robot,
    goals: &'a [ShapeGoal],
    cases: Vec<Case>,
    unknowns: Vec<Unknown>,
    steps: Vec<f64>,
    parameters: Vec<Parameter>,
    rim: f64,
    length: f64,
    criteria: Option<&'a Criteria>,
    /// Of each constraint its multiplier by the penalty, in the method of multipliers, and the penalty.
    shifts: Vec<f64>,
    penalty: f64,
    /// How many objectives and constraints there are.
    terms: [usize; 2],
    /// The answers at the last unknowns, which the next ones start from.
    answers: Vec<Option<Solution>>,
    /// Cables with a course of so many nodes.
    courses: Vec<(usize, usize)>,
}

impl<'a> Problem<'a> {
    pub fn new(
        model: &'a Model,
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
            model,
            robot,
            goals,
            cases: goals.iter().map(|goal| goal.case.clone()).collect(),
            parameters: parameters(&list),
            unknowns: list,
            steps: unknowns.iter().map(step).collect(),
            rim: options.rim,
            length: robot.backbone().length,
            criteria: options.criteria.filter(|criteria| !criteria.is_empty()),
            shifts: Vec::new(),
            penalty: FIRST_PENALTY,
            terms: [0; 2],
            answers: vec![None; goals.len()],
            courses,
        };
        if problem.criteria.is_some() {
            let start: Vec<f64> =
                unknowns.iter().map(|of| of.start.clamp(of.range[0], of.range[1])).collect();
            let terms = problem.terms(&start)?;
            problem.terms = [terms.objectives.len(), terms.violations.len()];
            problem.shifts = vec![0.0; terms.violations.len()];
        }
        Ok(problem)
    }

    /// Minimises from some values by the method of multipliers of Powell and of Hestenes and leaves the best in them; whether that converged.
    pub fn constrained(
        &mut self,
        values: &mut [f64],
        minimiser: &Options,
    ) -> Result<bool, NoResiduals<DesignError>> {
        let mut before = f64::INFINITY;
        for round in 0..ROUNDS {
            let outcome = minimise(self, values, minimiser, &mut Workspace::default())?;
            let is_converged = outcome.status.is_converged();
            if self.shifts.is_empty() {
                return Ok(is_converged);
            }
            let terms = self.terms(values).map_err(NoResiduals::Refused)?;
            let worst = terms.worst_violation();
            if worst <= 0.0 || round + 1 == ROUNDS {
                return Ok(is_converged && worst <= 0.0);
            }
            for (shift, violation) in self.shifts.iter_mut().zip(&terms.violations) {
                *shift = (*shift + violation).max(0.0);
            }
            if worst > 0.3 * before {
                self.penalty *= STEEPER;
                self.shifts.iter_mut().for_each(|shift| *shift /= STEEPER);
            }
            before = worst;
        }
        Ok(false)
    }

    /// What the criteria make of these unknowns.
    fn terms(&mut self, values: &[f64]) -> Result<Terms, DesignError> {
        let Some(criteria) = self.criteria else { return Ok(Terms::default()) };
        let solutions = self.solved(values)?;
        let (robot, cases) = applied(self.robot, &self.cases, &self.unknowns, values)?;
        criteria.terms(&robot, &cases, &solutions)
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

    fn solved(&mut self, values: &[f64]) -> Result<Vec<Solution>, DesignError> {
        let (robot, cases) = applied(self.robot, &self.cases, &self.unknowns, values)?;
        let mut solutions = Vec::with_capacity(cases.len());
        for (case, answer) in cases.iter().zip(&self.answers) {
            let mut prepared = self.model.prepare(&robot, &case.loads)?;
            let solution = prepared.solve(case, answer.as_ref());
            // A neighbouring answer may mislead where an unknown has changed much.
            let solution = match solution {
                Err(_) if answer.is_some() => prepared.solve(case, None),
                solution => solution,
            };
            solutions.push(solution?);
        }
        Ok(solutions)
    }

    /// What starts are compared by, in m².
    pub fn cost(&mut self, values: &[f64]) -> Option<f64> {
        let solutions = self.solved(values).ok()?;
        let goals = self.goals.iter().zip(&solutions);
        let cost = goals.map(|(goal, solution)| goal.cost(&solution.disks.poses)).sum::<f64>();
        let Some(criteria) = self.criteria else { return Some(cost) };
        let (robot, cases) = applied(self.robot, &self.cases, &self.unknowns, values).ok()?;
        Some(cost + criteria.cost(&robot, &cases, &solutions).ok()?)
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
        let difference = differentiate(moved, self.steps[unknown])?;
        Ok(self.goals[goal].points.iter().map(|(disk, _)| difference.disks[*disk].linear).collect())
    }
}

impl Problem<'_> {
    /// Derivatives of the residuals of criteria, by central differences: volumes, clearances and compliances have no others.
    fn criteria_by_differences(
        &mut self,
        unknowns: &[f64],
        into: &mut [f64],
    ) -> Result<(), DesignError> {
        let columns = unknowns.len();
        for column in 0..columns {
            let step = self.steps[column];
            let mut side = |by: f64| -> Result<Vec<f64>, DesignError> {
                let mut moved = unknowns.to_vec();
                moved[column] += by;
                let terms = self.terms(&moved)?;
                Ok(self.of_criteria(&terms))
            };
            // At a bound that is one of physics, such as no tension, there is but one side.
            let (from, to, width) = match (side(-step), side(step)) {
                (Ok(from), Ok(to)) => (from, to, 2.0 * step),
                (Err(_), Ok(to)) => (side(0.0)?, to, step),
                (Ok(from), Err(_)) => (from, side(0.0)?, step),
                (Err(error), Err(_)) => return Err(error),
            };
            for (row, (from, to)) in from.iter().zip(&to).enumerate() {
                into[row * columns + column] = (to - from) / width;
            }
        }
        Ok(())
    }
}

impl Residuals for Problem<'_> {
    type Refusal = DesignError;

    fn count(&self) -> usize {
        let beyond: usize = self.courses.iter().map(|(_, nodes)| Self::stations(*nodes)).sum();
        3 * self.points() + beyond + self.terms.iter().sum::<usize>()
    }

    fn residuals(&mut self, unknowns: &[f64], into: &mut [f64]) -> Result<(), DesignError> {
        let solutions = self.solved(unknowns)?;
        let mut row = 0;
        for (goal, solution) in self.goals.iter().zip(&solutions) {
            let factor = goal.weight.sqrt() / self.length;
            for (disk, point) in &goal.points {
                let off = (solution.disks.poses[*disk].position - *point) * factor;
                into[row..row + 3].copy_from_slice(&off.to_array());
                row += 3;
            }
        }
        for &(cable, nodes) in &self.courses {
            for [x, y] in self.offsets(unknowns, cable, nodes) {
                into[row] = BEYOND * (x.hypot(y) / self.rim - 1.0).max(0.0);
                row += 1;
            }
        }
        if let Some(criteria) = self.criteria {
            let (robot, cases) = applied(self.robot, &self.cases, &self.unknowns, unknowns)?;
            let terms = criteria.terms(&robot, &cases, &solutions)?;
            into[row..].copy_from_slice(&self.of_criteria(&terms));
        }
        self.answers = solutions.into_iter().map(Some).collect();
        Ok(())
    }

    fn jacobian(&mut self, unknowns: &[f64], into: &mut [f64]) -> Result<(), DesignError> {
        let columns = self.unknowns.len();
        into.fill(0.0);
        let (robot, cases) = applied(self.robot, &self.cases, &self.unknowns, unknowns)?;
        let is_exact = self.model.has_derivatives(&robot);
        let mut first = 0;
        for (number, goal) in self.goals.iter().enumerate() {
            let factor = goal.weight.sqrt() / self.length;
            let disks: Vec<usize> = goal.points.iter().map(|(disk, _)| *disk).collect();
            let derivatives: Option<Linearization> = match is_exact {
                true => {
                    let case = &cases[number];
                    let mut prepared = self.model.prepare(&robot, &case.loads)?;
                    let warm = self.answers[number].as_ref();
                    Some(prepared.solve_with_derivatives(case, warm, &self.parameters)?.1)
                }
                false => None,
            };
            for (column, unknown) in self.unknowns.iter().enumerate() {
                let velocities = match &derivatives {
                    Some(derivatives) if unknown.has_derivative() => unknown.velocities(
                        number,
                        &cases[number],
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
        for &(cable, nodes) in &self.courses {
            let offsets = self.offsets(unknowns, cable, nodes);
            let count = Self::stations(nodes);
            for (column, unknown) in self.unknowns.iter().enumerate() {
                let Unknown::Course { cable: of, axis, node, .. } = *unknown else { continue };
                if of != cable {
                    continue;
                }
                let mut unit = vec![0.0; nodes];
                unit[node] = 1.0;
                let shape = chebyshev::powers(&unit, self.length);
                let stations = whipcord::equally_spaced(0.0, self.length, count);
                for (row, (offset, s)) in offsets.iter().zip(stations).enumerate() {
                    let radius = offset[0].hypot(offset[1]);
                    if radius > self.rim {
                        into[(first + row) * columns + column] =
                            BEYOND * offset[axis] / radius * chebyshev::value(&shape, s) / self.rim;
                    }
                }
            }
            first += count;
        }
        if self.criteria.is_some() {
            self.criteria_by_differences(unknowns, &mut into[first * columns..])?;
        }
        Ok(())
    }
}
