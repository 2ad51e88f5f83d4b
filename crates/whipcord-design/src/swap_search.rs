//! A list of holes that no change of one hole, or of two neighbouring ones, makes better: where shapes must be solved as a whole.

use whipcord::{Model, Robot, SolveError};

use crate::budget::Budget;
use crate::candidates::costs;
use crate::choices::Choices;
use crate::criteria::Criteria;
use crate::error::DesignError;
use crate::goal::ShapeGoal;
use crate::shape_search::Found;

/// What is searched.
pub(crate) struct SwapSearch<'a> {
    pub model: &'a Model,
    pub robot: &'a Robot,
    pub choices: &'a Choices,
    pub goals: &'a [ShapeGoal],
    /// What counts beside the goals.
    pub criteria: Option<&'a Criteria>,
    /// Solves that may be spent on each goal.
    pub most_solves: usize,
    pub budget: &'a Budget,
}

/// Where criteria are estimated first, so many of the best lists by the estimate are tried.
const EXACT: usize = 4;
/// Changes of two holes that are compared before the best of them is taken.
const PART: usize = 128;

/// Solves that each list takes under each goal.
fn effort(criteria: Option<&Criteria>) -> usize {
    1 + criteria.map_or(0, Criteria::effort)
}

impl SwapSearch<'_> {
    /// The best of what is found from each start, proven where no change of it helps.
    pub fn run(&self, starts: &[Vec<usize>]) -> Result<Found, DesignError> {
        let mut spent = 0;
        let mut best: Option<Found> = None;
        let mut refusal: Option<SolveError> = None;
        // The nearest first, as the budget may not suffice for all.
        let (firsts, reason) = self.costs(starts, f64::INFINITY, &mut spent)?;
        refusal = refusal.or(reason);
        let mut order: Vec<usize> = (0..starts.len()).collect();
        order.sort_by(|a, b| firsts[*a].total_cmp(&firsts[*b]));
        for start in order {
            let found = self.descend(starts[start].clone(), firsts[start], &mut spent)?;
            if best.as_ref().is_none_or(|best| found.cost < best.cost) {
                best = Some(found);
            }
            if spent >= self.most_solves || self.budget.is_over() {
                break;
            }
        }
        match (best.filter(|best| best.cost.is_finite()), refusal) {
            (Some(best), _) => Ok(Found { nodes: spent, ..best }),
            (None, Some(error)) => Err(DesignError::NoAnswer(error)),
            (None, None) => Err(DesignError::NoChoice { disk: 0 }),
        }
    }

    fn costs(
        &self,
        lists: &[Vec<usize>],
        known: f64,
        spent: &mut usize,
    ) -> Result<(Vec<f64>, Option<SolveError>), DesignError> {
        self.costs_by(self.criteria, lists, known, spent)
    }

    fn costs_by(
        &self,
        criteria: Option<&Criteria>,
        lists: &[Vec<usize>],
        known: f64,
        spent: &mut usize,
    ) -> Result<(Vec<f64>, Option<SolveError>), DesignError> {
        *spent += lists.len() * effort(criteria);
        let by = (known, self.budget);
        costs(self.model, self.robot, self.choices, (self.goals, criteria), lists, by)
    }

    /// Takes the best change of one hole while there is one that helps, then one of two neighbouring holes.
    fn descend(
        &self,
        mut list: Vec<usize>,
        mut cost: f64,
        spent: &mut usize,
    ) -> Result<Found, DesignError> {
        let estimate = self.criteria.and_then(Criteria::estimate);
        // Whether every change was tried of the list that is left.
        let mut is_local = false;
        while !is_local && *spent < self.most_solves && !self.budget.is_over() {
            let mut is_better = false;
            let mut is_complete = true;
            for width in [1, 2] {
                let compared_by = estimate.as_ref().or(self.criteria);
                let room = self.most_solves.saturating_sub(*spent) / effort(compared_by);
                let mut changed: Vec<Vec<usize>> =
                    self.changed(&list, width).take(room + 1).collect();
                is_complete &= changed.len() <= room;
                changed.truncate(room);
                if let Some(estimate) = &estimate
                    && changed.len() > EXACT
                {
                    let (estimated, _) =
                        self.costs_by(Some(estimate), &changed, f64::INFINITY, spent)?;
                    let mut order: Vec<usize> = (0..changed.len()).collect();
                    order.sort_by(|a, b| estimated[*a].total_cmp(&estimated[*b]));
                    changed = order[..EXACT].iter().map(|of| changed[*of].clone()).collect();
                    is_complete = false;
                }
                // Of changes of two holes there are many: the first part of them that has a better list is enough to go on.
                let part = if width == 1 { changed.len() } else { PART };
                for changed in changed.chunks(part.max(1)) {
                    let (costs, _) = self.costs(changed, cost, spent)?;
                    let best = costs.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1));
                    if let Some((number, &lower)) = best
                        && lower < cost * (1.0 - 1e-9)
                    {
                        (cost, is_better) = (lower, true);
                        list.clone_from(&changed[number]);
                        break;
                    }
                    if self.budget.is_over() {
                        is_complete = false;
                        break;
                    }
                }
                if is_better {
                    break;
                }
            }
            is_local = !is_better && is_complete;
            if !is_better {
                break;
            }
        }
        Ok(Found { list, cost, is_proven: is_local, least: 0.0, nodes: 0 })
    }

    /// The lists with other combinations at so many neighbouring disks that the rules allow.
    fn changed<'a>(
        &'a self,
        list: &'a [usize],
        width: usize,
    ) -> impl Iterator<Item = Vec<usize>> + 'a {
        let places = 0..(list.len() + 1).saturating_sub(width);
        places.flat_map(move |first| {
            let second = if width > 1 { self.choices.at(first + 1) } else { &[][..] };
            self.choices.at(first).iter().flat_map(move |&a| {
                let seconds: Vec<Option<usize>> = match width {
                    1 => vec![None],
                    _ => second.iter().copied().map(Some).collect(),
                };
                seconds.into_iter().filter_map(move |b| {
                    let mut changed = list.to_vec();
                    changed[first] = a;
                    if let Some(b) = b {
                        changed[first + 1] = b;
                    }
                    let is_new = a != list[first] && b.is_none_or(|b| b != list[first + 1]);
                    (is_new && self.choices.allows_list(&changed)).then_some(changed)
                })
            })
        })
    }
}
