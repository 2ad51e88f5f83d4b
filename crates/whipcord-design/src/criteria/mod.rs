//! Criteria of a robot and its cases: values, objectives as residuals, and how far constraints are violated.

mod clearance;
mod rates;
mod stiffness;
mod workspace;

use whipcord::{
    Actuation, Cancel, Case, Model, ModelKind, Robot, Solution, StabilityAnalysis, Statics as _,
    Stations,
};

use crate::criterion::{Criterion, CriterionResult, Quantity};
use crate::error::DesignError;

/// Commands of a workspace, and of an estimate by which robots are compared first.
const COMMANDS: usize = 1_000;
const FEW_COMMANDS: usize = 60;
/// So many commands take as long as a solve of a whole shape, in lanes and for the tip alone.
const COMMANDS_OF_A_SOLVE: usize = 50;
/// A volume before the design that is smaller than this part of the cube of the length counts as this.
const LEAST_VOLUME: f64 = 1e-6;
/// Constraints are aimed at with this much to spare, as a part of what counts as a violation of one.
const SPARE: f64 = 1e-4;
/// What a violation costs in a search that compares lists, as a multiple of its square.
const PENALTY: f64 = 1e4;

/// The criteria of a design, with what their objectives are relative to.
#[derive(Clone, Debug)]
pub(crate) struct Criteria {
    list: Vec<Criterion>,
    model: Model,
    /// Commands of a workspace.
    commands: usize,
    /// Least and greatest command of each cable: tensions in N, or shortenings in m.
    pub ranges: Vec<[f64; 2]>,
    /// Of each criterion the value of the robot that the design begins with, over all cases.
    before: Vec<Option<f64>>,
    /// Of each criterion that counts relative to it: compliance in m/N, volume in m³.
    scales: Vec<f64>,
}

/// What criteria make of a robot: residuals of objectives, and by how much constraints are violated, both without unit. Positive violations are violations.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Terms {
    pub objectives: Vec<f64>,
    pub violations: Vec<f64>,
}

impl Default for Criteria {
    fn default() -> Self {
        let model = Model::new(ModelKind::Cosserat, Stations::Disks, Actuation::Natural);
        let (list, ranges, before, scales) = Default::default();
        Self { list, model, commands: COMMANDS, ranges, before, scales }
    }
}

impl Criteria {
    /// Checks the criteria and takes the values of the robot as it is.
    pub fn new(
        list: &[Criterion],
        model: &Model,
        robot: &Robot,
        cases: &[Case],
        ranges: Vec<[f64; 2]>,
    ) -> Result<Self, DesignError> {
        for criterion in list {
            check(criterion, robot, cases)?;
        }
        let model = model.at(Stations::Disks).with_stability(StabilityAnalysis::Off);
        let mut criteria = Self {
            list: list.to_vec(),
            model,
            commands: COMMANDS,
            ranges,
            before: Vec::new(),
            scales: Vec::new(),
        };
        let solutions: Option<Vec<Solution>> =
            cases.iter().map(|case| criteria.model.solve(robot, case).ok()).collect();
        for criterion in list {
            let value = match &solutions {
                None => None,
                Some(solutions) => match criteria.values(criterion, robot, cases, solutions) {
                    Ok(values) => Some(worst(criterion, &values)),
                    // Of no answer there is no value; what the model refuses, it refuses of the design as well.
                    Err(DesignError::Criterion { what }) => {
                        return Err(DesignError::Criterion { what });
                    }
                    Err(_) => None,
                },
            };
            let length = robot.backbone().length;
            let scale = match criterion.quantity {
                Quantity::Tension => {
                    criteria.ranges.iter().map(|range| range[1]).fold(f64::MIN_POSITIVE, f64::max)
                }
                Quantity::Clearance => length,
                Quantity::Stiffness { .. } => value.filter(|value| *value > 0.0).unwrap_or(1.0),
                Quantity::Workspace => value.unwrap_or(0.0).max(LEAST_VOLUME * length.powi(3)),
            };
            criteria.before.push(value);
            criteria.scales.push(scale);
        }
        Ok(criteria)
    }

    /// Whether there are none.
    pub const fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Whether some of them are objectives.
    pub fn has_objectives(&self) -> bool {
        self.list.iter().any(|of| of.weight.is_some())
    }

    /// Whether only tensions count: with given tensions nothing else changes them.
    pub fn are_of_tensions(&self) -> bool {
        self.list.iter().all(|of| matches!(of.quantity, Quantity::Tension))
    }

    /// Whether commands alone decide on the values, so that no answers are needed for them.
    pub fn are_of_commands(&self, cases: &[Case]) -> bool {
        self.are_of_tensions() && cases.iter().all(by_tension)
    }

    /// The same by an estimate of the workspace from few commands, where that is a criterion.
    pub fn estimate(&self) -> Option<Self> {
        let is_estimated = self.list.iter().any(|of| matches!(of.quantity, Quantity::Workspace));
        is_estimated.then(|| Self { commands: FEW_COMMANDS, ..self.clone() })
    }

    /// The same with solves that a flag ends: what comes of them then is of no use.
    pub fn until(&self, stop: &Cancel) -> Self {
        Self { model: self.model.cancelled_by(stop), ..self.clone() }
    }

    /// How many solves the values of a robot are worth, beside those of its shapes.
    pub fn effort(&self) -> usize {
        self.list.iter().map(|criterion| self.effort_of(criterion)).sum()
    }

    /// How many solves of whole shapes the values of a criterion are worth.
    const fn effort_of(&self, criterion: &Criterion) -> usize {
        match criterion.quantity {
            Quantity::Tension => 0,
            Quantity::Clearance => 1,
            Quantity::Stiffness { .. } => 3,
            Quantity::Workspace => self.commands.div_ceil(COMMANDS_OF_A_SOLVE),
        }
    }

    /// The greatest tension that is allowed in N, where one is.
    pub fn greatest_tension(&self) -> Option<f64> {
        let limits = self.list.iter().filter(|of| matches!(of.quantity, Quantity::Tension));
        limits.filter_map(|of| of.limit).reduce(f64::min)
    }

    /// Values of a criterion: of each case, and of each place that counts by itself.
    fn values(
        &self,
        criterion: &Criterion,
        robot: &Robot,
        cases: &[Case],
        solutions: &[Solution],
    ) -> Result<Vec<f64>, DesignError> {
        let mut values = Vec::new();
        match criterion.quantity {
            Quantity::Tension => {
                for (number, case) in cases.iter().enumerate() {
                    let answered = |cable: usize| solutions.get(number)?.cables.get(cable)?.tension;
                    let tensions = case.commands.iter().enumerate();
                    let tensions = tensions
                        .map(|(cable, command)| command.tension.or_else(|| answered(cable)));
                    values.extend(tensions.map(|tension| tension.unwrap_or(0.0)));
                }
            }
            Quantity::Clearance => {
                for case in cases.iter().filter(|case| !case.obstacles.is_empty()) {
                    values.extend(self.clearances(robot, case)?);
                }
            }
            Quantity::Stiffness { disk, direction } => {
                for case in cases {
                    values.push(self.stiffness(robot, case, disk, direction)?);
                }
            }
            Quantity::Workspace => values.push(self.volume(robot, &cases[0])?),
        }
        Ok(values)
    }

    /// Residuals of the objectives and violations of the constraints.
    pub fn terms(
        &self,
        robot: &Robot,
        cases: &[Case],
        solutions: &[Solution],
    ) -> Result<Terms, DesignError> {
        let mut terms = Terms::default();
        for number in 0..self.list.len() {
            let of = self.terms_of(number, robot, cases, solutions)?;
            terms.objectives.extend(of.objectives);
            terms.violations.extend(of.violations);
        }
        Ok(terms)
    }

    /// Those of one criterion.
    fn terms_of(
        &self,
        number: usize,
        robot: &Robot,
        cases: &[Case],
        solutions: &[Solution],
    ) -> Result<Terms, DesignError> {
        let (criterion, scale) = (&self.list[number], self.scales[number]);
        let mut terms = Terms::default();
        let values = self.values(criterion, robot, cases, solutions)?;
        let count = values.len().max(1) as f64;
        if let Some(weight) = criterion.weight {
            let factor = weight.sqrt();
            match criterion.quantity {
                Quantity::Tension => {
                    let factor = factor / (scale * count.sqrt());
                    terms.objectives.extend(values.iter().map(|value| value * factor));
                }
                Quantity::Clearance => {
                    let least = worst(criterion, &values);
                    terms.objectives.push(factor * (1.0 - least / scale).max(0.0));
                }
                Quantity::Stiffness { .. } => {
                    let relative = |value: &f64| factor * scale / (value * count.sqrt());
                    terms.objectives.extend(values.iter().map(relative));
                }
                Quantity::Workspace => {
                    let relative = |value: &f64| factor * 2.0 * scale / (scale + value);
                    terms.objectives.extend(values.iter().map(relative));
                }
            }
        }
        if let Some(limit) = criterion.limit {
            terms.violations.extend(values.iter().map(|value| {
                SPARE
                    + match criterion.quantity {
                        Quantity::Tension => value / limit.max(1e-12 * scale) - 1.0,
                        Quantity::Clearance => (limit - value) / scale,
                        // By the compliance, which is smoother.
                        Quantity::Stiffness { .. } => limit / value - 1.0,
                        Quantity::Workspace => 1.0 - value / limit,
                    }
            }));
        }
        if terms.objectives.iter().chain(&terms.violations).all(|value| value.is_finite()) {
            return Ok(terms);
        }
        Err(DesignError::Criterion {
            what: "a criterion has no finite value: a disk that is asked for its stiffness does not move, or a cable has no tension".to_owned(),
        })
    }

    /// What the criteria add to the cost of a search that compares robots, in m²; of one that adds more than this, at least that much.
    pub fn cost(
        &self,
        robot: &Robot,
        cases: &[Case],
        solutions: &[Solution],
        most: f64,
    ) -> Result<f64, DesignError> {
        let length = robot.backbone().length;
        let mut order: Vec<usize> = (0..self.list.len()).collect();
        order.sort_by_key(|number| self.effort_of(&self.list[*number]));
        let mut cost = 0.0;
        for number in order {
            cost += length * length * self.terms_of(number, robot, cases, solutions)?.cost();
            if cost >= most {
                break;
            }
        }
        Ok(cost)
    }

    /// The values of a robot that was designed.
    pub fn results(
        &self,
        robot: &Robot,
        cases: &[Case],
        solutions: &[Solution],
    ) -> Result<Vec<CriterionResult>, DesignError> {
        let of = |(criterion, before): (&Criterion, &Option<f64>)| {
            let values = self.values(criterion, robot, cases, solutions)?;
            let value = worst(criterion, &values);
            Ok(CriterionResult { criterion: *criterion, value, before: *before })
        };
        self.list.iter().zip(&self.before).map(of).collect()
    }
}

impl Terms {
    /// Squares of objectives, and of violations at a penalty.
    pub fn cost(&self) -> f64 {
        let objectives = self.objectives.iter().map(|of| of * of).sum::<f64>();
        let violated = |of: &f64| of.max(0.0).powi(2);
        objectives + PENALTY * self.violations.iter().map(violated).sum::<f64>()
    }

    /// The greatest violation of a constraint itself, without what is to spare.
    pub fn worst_violation(&self) -> f64 {
        self.violations.iter().map(|of| of - SPARE).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// Whether a case gives tensions.
pub(crate) fn by_tension(case: &Case) -> bool {
    case.commands.iter().all(|command| command.tension.is_some())
}

fn worst(criterion: &Criterion, values: &[f64]) -> f64 {
    let values = values.iter().copied();
    match criterion.quantity.is_limited_above() {
        true => values.fold(0.0, f64::max),
        false => values.fold(f64::INFINITY, f64::min),
    }
}

fn check(criterion: &Criterion, robot: &Robot, cases: &[Case]) -> Result<(), DesignError> {
    let refuse = |what: String| Err(DesignError::Criterion { what });
    let name = criterion.quantity.name();
    if criterion.weight.is_none() && criterion.limit.is_none() {
        return refuse(format!(
            "the criterion {name} is neither an objective nor a constraint: give `weight`, or the limit of a constraint"
        ));
    }
    let is_usable = |value: f64| value > 0.0 && value.is_finite();
    if criterion.weight.is_some_and(|weight| !is_usable(weight)) {
        return refuse(format!("the weight of the criterion {name} must be more than zero"));
    }
    let may_be_zero = matches!(criterion.quantity, Quantity::Clearance);
    if criterion.limit.is_some_and(|limit| !(is_usable(limit) || may_be_zero && limit == 0.0)) {
        return refuse(format!("the limit of the criterion {name} must be more than zero"));
    }
    match criterion.quantity {
        Quantity::Stiffness { disk, direction } => {
            let last = robot.disks().count() - 1;
            if disk == 0 || disk > last {
                return refuse(format!(
                    "a stiffness is that of a disk from 2 to {}, which can move",
                    last + 1
                ));
            }
            if direction.is_some_and(|n| (n.norm() - 1.0).abs() > 1e-9) {
                return refuse("the direction of a stiffness must be of unit length".to_owned());
            }
        }
        Quantity::Clearance if cases.iter().all(|case| case.obstacles.is_empty()) => {
            return refuse(
                "there is nothing to keep clear of: add [[obstacles]], or leave out the criterion clearance"
                    .to_owned(),
            );
        }
        Quantity::Workspace if robot.cables().is_empty() => {
            return refuse("a robot without cables has no workspace".to_owned());
        }
        Quantity::Tension | Quantity::Clearance | Quantity::Workspace => {}
    }
    Ok(())
}
