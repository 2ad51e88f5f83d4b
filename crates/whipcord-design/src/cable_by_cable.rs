//! Lists of holes of more cables than can be compared at once: those of one cable after the other, with the lists of the others held.

use whipcord::Robot;

use crate::budget::Budget;
use crate::choices::{Apart, Choices, FixedHole, HoleRules};
use crate::error::DesignError;

/// What is left of a search for the list of one cable.
pub(crate) struct Step {
    pub robot: Robot,
    /// What lists are compared by in m².
    pub merit: f64,
    /// Spans or solves that it took.
    pub effort: usize,
    /// Whether the search came to its end.
    pub is_best: bool,
}

/// What is searched.
pub(crate) struct CableByCable<'a, C> {
    pub cables: &'a [usize],
    pub rules: &'a HoleRules,
    /// Spans or solves that may be spent.
    pub most: usize,
    pub budget: &'a Budget,
    /// The best of some choices, by so much effort.
    pub choose: &'a C,
}

/// A list is better where it costs less by this part.
const BETTER: f64 = 1e-9;

impl<C: Fn(&Robot, &Choices, usize) -> Result<Step, DesignError>> CableByCable<'_, C> {
    /// From the lists of some robots, the same but for these, as far as the rules allow them, and from so many robots whose cables are added one after the other. The best robot, the effort, and
    /// whether no other list of one cable is better.
    pub fn run(&self, robots: &[Robot], added: usize) -> Result<(Robot, usize, bool), DesignError> {
        let mut spent = 0;
        let mut best: Option<Step> = None;
        let mut refusal = None;
        let given = robots.iter().filter(|robot| self.is_allowed(robot)).map(|robot| (robot, None));
        let last = robots.last().into_iter();
        let added = last
            .flat_map(|robot| (0..added.min(2 * self.cables.len())).map(move |k| (robot, Some(k))));
        for (robot, start) in given.chain(added) {
            let begun = match start {
                None => Ok(robot.clone()),
                Some(start) => self.added(robot, start, &mut spent),
            };
            match begun.and_then(|begun| self.improved(begun, &mut spent)) {
                Ok(found) => {
                    if best.as_ref().is_none_or(|best| found.merit < best.merit) {
                        best = Some(found);
                    }
                }
                Err(error) if error.is_cancelled() => return Err(error),
                Err(error) => {
                    refusal.get_or_insert(error);
                }
            }
            if spent >= self.most || self.budget.is_over() {
                break;
            }
        }
        match (best, refusal) {
            (Some(best), _) => Ok((best.robot, spent, best.is_best)),
            (None, Some(error)) => Err(error),
            (None, None) => Err(DesignError::NoChoice { disk: 0 }),
        }
    }

    /// The choices of one cable beside the others.
    fn choices(
        &self,
        robot: &Robot,
        cable: usize,
        later: &[usize],
    ) -> Result<Choices, DesignError> {
        let others = self.cables.iter().copied();
        let held: Vec<usize> =
            others.filter(|other| *other != cable && !later.contains(other)).collect();
        let place = self.cables.iter().position(|of| *of == cable);
        let fixed = self.rules.fixed.iter().filter(|of| Some(of.cable) == place);
        let fixed = fixed.map(|of| FixedHole { cable: 0, ..*of }).collect();
        let rules = HoleRules { fixed, ..self.rules.clone() };
        Choices::beside(robot, &[cable], &rules, Apart { held: &held, later })
    }

    /// Whether the rules allow the lists that the robot has.
    fn is_allowed(&self, robot: &Robot) -> bool {
        self.cables.iter().all(|&cable| {
            let choices = self.choices(robot, cable, &[]);
            choices.is_ok_and(|choices| choices.own_list(robot).is_some())
        })
    }

    /// The robot with the best list of each cable beside those before it, one way or the other round from one of them.
    fn added(&self, robot: &Robot, start: usize, spent: &mut usize) -> Result<Robot, DesignError> {
        let mut order = self.cables.to_vec();
        order.rotate_left(start / 2);
        if start % 2 == 1 {
            order.reverse();
        }
        let mut robot = robot.clone();
        for (place, &cable) in order.iter().enumerate() {
            let choices = self.choices(&robot, cable, &order[place + 1..])?;
            let step = (self.choose)(&robot, &choices, self.most.saturating_sub(*spent).max(1))?;
            *spent += step.effort;
            robot = step.robot;
        }
        Ok(robot)
    }

    /// Whether the budget is spent and there is a robot that was compared.
    fn is_interrupted(&self, best: &Step) -> bool {
        best.merit.is_finite() && self.budget.is_over()
    }

    /// Takes better lists of single cables while there are any.
    fn improved(&self, robot: Robot, spent: &mut usize) -> Result<Step, DesignError> {
        let mut best = Step { robot, merit: f64::INFINITY, effort: 0, is_best: true };
        // How many cables have no better list, one after the other, and whether each of their searches came to its end.
        let mut settled = 0;
        for &cable in self.cables.iter().cycle() {
            let left = self.most.saturating_sub(*spent);
            let is_settled = settled == self.cables.len();
            if is_settled || left == 0 || self.is_interrupted(&best) {
                best.is_best &= is_settled;
                break;
            }
            let choices = self.choices(&best.robot, cable, &[])?;
            let step = (self.choose)(&best.robot, &choices, left)?;
            *spent += step.effort.max(1);
            if step.merit < best.merit * (1.0 - BETTER) {
                // Its own list is the best beside the others as they are.
                settled = 1;
                best = step;
            } else {
                settled += 1;
                best.is_best &= step.is_best;
            }
        }
        Ok(best)
    }
}
