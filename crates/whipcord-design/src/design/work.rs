//! A design in progress.

use whipcord::{Case, Model, Robot, Statics as _};

use crate::budget::Budget;
use crate::criteria::Criteria;
use crate::curve::Curve;
use crate::error::DesignError;
use crate::goal::ShapeGoal;
use crate::problem::{DesignGoal, DesignOptions, Finding, Known, TargetShape};
use crate::vary::Vary;

/// The robot so far, and what is known of it.
pub(super) struct Work<'a> {
    pub model: Model,
    pub goals: &'a [DesignGoal],
    pub vary: Vec<Vary>,
    pub options: &'a DesignOptions,
    pub budget: &'a Budget,
    pub robot: Robot,
    pub cases: Vec<Case>,
    pub criteria: Criteria,
    pub findings: Vec<Finding>,
    pub assumed: Option<[f64; 2]>,
    /// The error that no other list of holes is below with these tensions, in m.
    pub lower_bound: Option<f64>,
}

impl Work<'_> {
    pub fn cables(&self, pick: impl Fn(Vary) -> Option<usize>) -> Vec<usize> {
        let mut cables: Vec<usize> = Vec::new();
        for cable in self.vary.iter().filter_map(|of| pick(*of)) {
            if !cables.contains(&cable) {
                cables.push(cable);
            }
        }
        cables
    }

    /// Cables whose tensions are varied.
    pub fn tensions(&self) -> Vec<usize> {
        self.cables(|of| match of {
            Vary::Tension { cable } => Some(cable),
            _ => None,
        })
    }

    /// Tensions can be varied where they are commanded.
    pub fn check_tensions(&mut self, cables: &[usize]) -> Result<(), DesignError> {
        for case in &mut self.cases {
            for &cable in cables {
                let command = &mut case.commands[cable];
                if command.shortening.is_some() && command.tension.is_none() {
                    let name = self.robot.cables()[cable].name.clone();
                    return Err(DesignError::DrivenByLength { name });
                }
                command.tension.get_or_insert(0.0);
            }
        }
        Ok(())
    }

    /// Whether all constraints are met and there are no objectives, so that what is nearest to the targets is the best.
    pub fn keeps_criteria(&self) -> Result<bool, DesignError> {
        if self.criteria.is_empty() {
            return Ok(true);
        }
        let solutions = self.cases.iter().map(|case| self.model.solve(&self.robot, case));
        let Ok(solutions) = solutions.collect::<Result<Vec<_>, _>>() else { return Ok(false) };
        let terms = self.criteria.terms(&self.robot, &self.cases, &solutions)?;
        Ok(!self.criteria.has_objectives() && terms.worst_violation() <= 0.0)
    }

    pub fn shape_goals(&self) -> Result<Vec<ShapeGoal>, DesignError> {
        let goals = self.goals.iter().zip(&self.cases);
        goals.map(|(of, case)| with_case(of, case).shape_goal(&self.robot)).collect()
    }

    /// The weighted sum of the squares of the distances in m², where the model has answers.
    pub fn cost(&self) -> Option<f64> {
        let goals = self.shape_goals().ok()?;
        let costs = goals.iter().map(|goal| {
            let solution = self.model.solve(&self.robot, &goal.case).ok()?;
            Some(goal.cost(&solution.disks.poses))
        });
        costs.sum()
    }

    pub fn find(&mut self, what: Vary, known: Known) {
        self.findings.push(Finding { what: what.to_string(), known });
    }

    /// The one goal's curve, where there is one goal and it is a curve.
    pub fn curve(&self) -> Result<Option<Curve>, DesignError> {
        match self.goals {
            [DesignGoal { target: TargetShape::Curve(named), .. }] => {
                named.curve(self.robot.backbone().length).map(Some)
            }
            _ => Ok(None),
        }
    }
}

/// The goal with other commands.
pub(super) fn with_case(goal: &DesignGoal, case: &Case) -> DesignGoal {
    DesignGoal { case: case.clone(), ..goal.clone() }
}
