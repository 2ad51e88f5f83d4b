//! The holes with which a robot comes nearest to target shapes.

use whipcord::{
    Actuation, Cancel, Case, Loads, Model, ModelKind, Robot, Routing, Solution, Statics as _,
    Stations,
};

use crate::budget::Budget;
use crate::cable_by_cable::{CableByCable, Step};
use crate::candidates::with_holes;
use crate::choices::{Choices, HoleRules};
use crate::criteria::Criteria;
use crate::error::DesignError;
use crate::goal::{self, ShapeGoal, root_mean_square};
use crate::shape_search::{Found, ShapeSearch};
use crate::span_table::{SpanTable, is_sequential};
use crate::swap_search::SwapSearch;
use crate::tip_search;

/// How much a search may spend.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HoleSearchOptions {
    /// Spans that branch and bound may look at; without any the best list of a beam search is taken.
    pub nodes: usize,
    /// Solves of each goal where shapes must be solved as a whole.
    pub solves: usize,
    /// Starts of that search.
    pub starts: usize,
}

impl Default for HoleSearchOptions {
    fn default() -> Self {
        Self { nodes: 20_000_000, solves: 20_000, starts: 3 }
    }
}

/// Spans that may be looked at for the list of one of several cables.
const QUICK: usize = 200_000;
/// Starts of a search for one cable after the other, for each start of a search for all.
const STARTS_OF_CABLES: usize = 4;
/// How far the errors of the spans and of the whole robot may be apart, as a part of the length.
const CONSISTENT: f64 = 1e-5;

/// What is known of a design.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Proof {
    /// No list of holes that the rules allow comes nearer, by the model.
    Optimal,
    /// The best of what was found: the spans or solves that may be spent did not suffice for a proof.
    Budget,
    /// The best of what was found: no change of one hole or of two neighbouring ones comes nearer. Under loads, with given lengths, with friction, among
    /// obstacles and in models of continuous cables the shape of a span depends on all holes.
    Local,
    /// The best of what was found: no other list of one cable comes nearer, those of the others held. All lists of so many cables at once are too many to compare.
    InTurn,
}

impl Proof {
    /// In words.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Optimal => {
                "no other list of holes that the rules allow comes nearer with these commands"
            }
            Self::Budget => {
                "the best found within the budget of the search, which may not be the best of all"
            }
            Self::Local => {
                "no change of one hole or of two neighbouring ones comes nearer; it may not be the best of all"
            }
            Self::InTurn => {
                "no other list of one cable comes nearer with those of the others held; the lists of all cables at once, which are too many to compare, may be better"
            }
        }
    }
}

/// A robot with chosen holes.
#[derive(Clone, Debug)]
pub struct HoleDesign {
    /// The robot with these holes.
    pub robot: Robot,
    /// The hole of each disk from 1, for each varied cable.
    pub holes: Vec<Vec<usize>>,
    /// The shape under the case of each goal, from a solve of the whole robot.
    pub solutions: Vec<Solution>,
    /// Disk and distance of each point of each goal in m, of these shapes.
    pub misses: Vec<Vec<(usize, f64)>>,
    /// Weighted root of the mean of the squares of these distances in m.
    pub error: f64,
    /// What lists are compared by in m²: the weighted sum of the squares, and what criteria add to it.
    pub(crate) merit: f64,
    /// What is known of it.
    pub proof: Proof,
    /// The error that no list is below, as far as that is known, in m: that of a list that is proven to be the best.
    pub lower_bound: f64,
    /// Spans or solves that the search took.
    pub effort: usize,
}

/// Chooses the holes of some cables of a robot, so that its disks come nearest to the points of the goals in the mean square, within the rules.
///
/// Without load, by tensions, and in models with straight cables between disks, every span is independent of the others: its shapes are tabulated, and the choice is proven to be
/// the best of all lists by branch and bound, or by meeting in the middle where there is one goal with one point. Else
/// changes of one or two holes are tried from several starts. Where all lists of several cables are too many for a table, or must be solved as a whole, the lists of one cable after the other are chosen in
/// these ways until none comes nearer, which proves nothing. The winner is solved again as a whole robot by the model. Cables that end before the tip get holes up to the tip.
///
/// # Errors
/// [`DesignError`].
pub fn design_holes(
    model: &Model,
    robot: &Robot,
    cables: &[usize],
    goals: &[ShapeGoal],
    rules: &HoleRules,
    options: &HoleSearchOptions,
) -> Result<HoleDesign, DesignError> {
    goal::check_points(goals)?;
    let budget = Budget::new(usize::MAX, Cancel::default());
    search(model, robot, cables, (goals, &budget), (rules, None), (options, Starts::All))
}

/// From which lists single changes are tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Starts {
    /// The best without loads, and lists straight on.
    All,
    /// The one that the robot has.
    Own,
}

/// As [`design_holes`], with criteria beside the goals. A list that is proven to be the nearest stays proven if it keeps all constraints and no objective hangs on
/// the holes; else changes are tried from it.
pub(crate) fn search(
    model: &Model,
    robot: &Robot,
    cables: &[usize],
    (goals, budget): (&[ShapeGoal], &Budget),
    (rules, criteria): (&HoleRules, Option<&Criteria>),
    (options, from): (&HoleSearchOptions, Starts),
) -> Result<HoleDesign, DesignError> {
    goal::check(robot, goals)?;
    let asked = Asked {
        model: model.at(Stations::Disks),
        cables,
        goals,
        cases: goals.iter().map(|goal| goal.case.clone()).collect(),
        criteria: criteria.filter(|criteria| !criteria.is_empty()),
        budget,
    };
    let choices = match Choices::new(robot, cables, rules) {
        Ok(choices) => Some(choices),
        Err(DesignError::TooManySpans { .. }) if cables.len() > 1 => None,
        Err(error) => return Err(error),
    };
    if let Some(choices) =
        choices.as_ref().filter(|_| cables.len() == 1 || asked.is_tabulated(robot))
    {
        match asked.chosen(robot, choices, (options, from)) {
            Err(DesignError::TooManySpans { .. }) if cables.len() > 1 => {}
            at_once => return at_once,
        }
    }
    let found = asked.one_by_one(robot, choices.as_ref(), rules, (options, from))?;
    match choices {
        Some(choices) if !asked.is_tabulated(robot) => asked.together(found, &choices, options),
        _ => Ok(found),
    }
}

/// What holes are chosen for.
struct Asked<'a> {
    model: Model,
    cables: &'a [usize],
    goals: &'a [ShapeGoal],
    cases: Vec<Case>,
    criteria: Option<&'a Criteria>,
    budget: &'a Budget,
}

impl Asked<'_> {
    /// Whether shapes are products of spans, and nothing but them decides.
    fn is_tabulated(&self, robot: &Robot) -> bool {
        let has_points = self.goals.iter().any(|goal| !goal.points.is_empty());
        let hangs_on_shapes =
            |criteria: &Criteria| criteria.has_objectives() && !criteria.are_of_tensions();
        has_points
            && is_sequential(&self.model, robot, self.goals)
            && !self.criteria.is_some_and(hangs_on_shapes)
    }

    /// The best of some choices, as far as that is found.
    fn chosen(
        &self,
        robot: &Robot,
        choices: &Choices,
        (options, from): (&HoleSearchOptions, Starts),
    ) -> Result<HoleDesign, DesignError> {
        let Self { model, goals, cases, criteria, budget, .. } = self;
        let criteria = *criteria;
        if let Some(disk) = choices.dead_end() {
            return Err(DesignError::NoChoice { disk });
        }
        let mut found = None;
        if self.is_tabulated(robot) {
            let nearest = match sequential(model, robot, choices, (goals, budget), options) {
                // Without a table the given list, or one that the rules allow, is all that is known.
                Err(DesignError::Ended) => None,
                nearest => Some(nearest?),
            };
            found = nearest.map(|of| {
                let proof = if of.is_proven { Proof::Optimal } else { Proof::Budget };
                (of, proof)
            });
            if let (Some((nearest, _)), Some(criteria)) = (&found, criteria) {
                let robot = with_holes(robot, choices, &nearest.list)?;
                let solutions = cases.iter().map(|case| model.solve(&robot, case));
                let solutions = solutions.collect::<Result<Vec<_>, _>>()?;
                if criteria.terms(&robot, cases, &solutions)?.worst_violation() > 0.0 {
                    found = None;
                }
            }
        }
        let (found, proof) = match found {
            Some(found) => found,
            None => {
                let search = SwapSearch {
                    model,
                    robot,
                    choices,
                    goals,
                    criteria,
                    most_solves: options.solves,
                    budget,
                };
                let own = (from == Starts::Own).then(|| choices.own_list(robot)).flatten();
                let starts = match own {
                    Some(own) => vec![own],
                    None => starts(robot, choices, (goals, budget), options),
                };
                let found = search.run(&starts)?;
                let proof = if found.is_proven { Proof::Local } else { Proof::Budget };
                (found, proof)
            }
        };
        self.measured(with_holes(robot, choices, &found.list)?, &found, proof)
    }

    /// A robot with chosen holes, and what is known of it.
    fn measured(
        &self,
        robot: Robot,
        found: &Found,
        proof: Proof,
    ) -> Result<HoleDesign, DesignError> {
        let Self { model, goals, cases, criteria, cables, .. } = self;
        let solutions = goals
            .iter()
            .map(|goal| model.solve(&robot, &goal.case))
            .collect::<Result<Vec<_>, _>>()?;
        let costs = goals.iter().zip(&solutions);
        let cost = costs.map(|(goal, solution)| goal.cost(&solution.disks.poses)).sum::<f64>();
        let merit = match criteria {
            None => cost,
            Some(criteria) => cost + criteria.cost(&robot, cases, &solutions, f64::INFINITY)?,
        };
        let error = root_mean_square(goals, cost);
        // The proof holds for the robot only if its shape is the product of the spans.
        let off = (error - root_mean_square(goals, found.cost)).abs();
        let is_consistent = off <= CONSISTENT * robot.backbone().length;
        let of_cable = |cable: &usize| match &robot.cables()[*cable].routing {
            Routing::Holes { holes, .. } => holes.clone(),
            _ => Vec::new(),
        };
        Ok(HoleDesign {
            holes: cables.iter().map(of_cable).collect(),
            misses: goals.iter().zip(&solutions).map(|(goal, of)| goal.misses(of)).collect(),
            error,
            merit,
            robot,
            solutions,
            proof: match proof {
                Proof::Optimal if !is_consistent => Proof::Budget,
                proof => proof,
            },
            lower_bound: match is_consistent {
                true => root_mean_square(goals, found.least).min(error),
                false => 0.0,
            },
            effort: found.nodes,
        })
    }

    /// The lists of one cable after the other, those of the others held.
    fn one_by_one(
        &self,
        robot: &Robot,
        choices: Option<&Choices>,
        rules: &HoleRules,
        (options, from): (&HoleSearchOptions, Starts),
    ) -> Result<HoleDesign, DesignError> {
        let most = if self.is_tabulated(robot) { options.nodes } else { options.solves };
        let own = HoleSearchOptions { nodes: options.nodes.min(QUICK), starts: 1, ..*options };
        let choose = |robot: &Robot, choices: &Choices, left: usize| {
            let own = HoleSearchOptions { solves: own.solves.min(left), ..own };
            let found = self.chosen(robot, choices, (&own, Starts::Own))?;
            Ok(Step {
                merit: found.merit,
                effort: found.effort,
                is_best: matches!(found.proof, Proof::Optimal | Proof::Local),
                robot: found.robot,
            })
        };
        let mut robots = vec![robot.clone()];
        let mut added = 0;
        if from == Starts::All {
            // Each is done in a moment, beside a search for all at once.
            added = STARTS_OF_CABLES * options.starts;
            if let Some(choices) = choices.filter(|_| !self.is_tabulated(robot)) {
                let all = starts(robot, choices, (self.goals, self.budget), options);
                for list in all.iter().take(1) {
                    robots.insert(0, with_holes(robot, choices, list)?);
                }
            }
        }
        let search =
            CableByCable { cables: self.cables, rules, most, budget: self.budget, choose: &choose };
        let (robot, effort, is_best) = search.run(&robots, added)?;
        let proof = if is_best { Proof::InTurn } else { Proof::Budget };
        let found =
            Found { list: Vec::new(), cost: 0.0, is_proven: false, least: 0.0, nodes: effort };
        self.measured(robot, &found, proof)
    }

    /// Changes of several cables at once, as far as the solves that are left suffice for all of one disk.
    fn together(
        &self,
        found: HoleDesign,
        choices: &Choices,
        options: &HoleSearchOptions,
    ) -> Result<HoleDesign, DesignError> {
        let left = options.solves.saturating_sub(found.effort);
        if left < choices.count * found.robot.disks().count() || self.budget.is_over() {
            return Ok(found);
        }
        let options = HoleSearchOptions { solves: left, ..*options };
        let mut better = self.chosen(&found.robot, choices, (&options, Starts::Own))?;
        better.effort += found.effort;
        if better.proof == Proof::Budget
            && found.proof == Proof::InTurn
            && better.merit >= found.merit
        {
            better.proof = Proof::InTurn;
        }
        Ok(better)
    }
}

/// The best list of all by the table of spans.
fn sequential(
    model: &Model,
    robot: &Robot,
    choices: &Choices,
    (goals, budget): (&[ShapeGoal], &Budget),
    options: &HoleSearchOptions,
) -> Result<Found, DesignError> {
    let table = SpanTable::new(model, robot, choices, (goals, budget))?;
    let disks = robot.disks().count();
    let points = || goals.iter().flat_map(|goal| &goal.points);
    let last = points().map(|(disk, _)| disk + 1).max().unwrap_or(disks);
    let mut found = match goals {
        [goal] if goal.points.len() == 1 && last > 1 => {
            tip_search::nearest(choices, &table, last - 1, goal.points[0].1).map(|found| Found {
                cost: found.cost * goal.weight,
                least: found.least * goal.weight,
                ..found
            })
        }
        _ => None,
    };
    if found.is_none() {
        found = ShapeSearch::new(choices, &table, (goals, budget), last).run(options.nodes);
    }
    let mut found = found.ok_or(DesignError::NoChoice { disk: last - 1 })?;
    // What is behind the last point is free: as straight on as the rules allow.
    while found.list.len() < disks {
        let disk = found.list.len();
        let from = found.list[disk - 1];
        let jump = |next: usize| -> usize {
            let places = 0..choices.cables.len();
            places
                .map(|place| {
                    choices
                        .jump(choices.hole(from, place), choices.hole(next, place))
                        .unsigned_abs()
                })
                .sum()
        };
        let next = choices.after(from, disk).min_by_key(|&next| jump(next));
        found.list.push(next.ok_or(DesignError::NoChoice { disk })?);
    }
    Ok(found)
}

/// Lists to start from: the best without loads where that is known, the one that the robot has where the rules allow it, then lists straight on.
fn starts(
    robot: &Robot,
    choices: &Choices,
    (goals, budget): (&[ShapeGoal], &Budget),
    options: &HoleSearchOptions,
) -> Vec<Vec<usize>> {
    let model = Model::new(ModelKind::CosseratDisks, Stations::Disks, Actuation::Tension);
    let free: Vec<ShapeGoal> = goals
        .iter()
        .map(|goal| {
            let mut goal = goal.clone();
            goal.case.loads = Loads::default();
            goal.case.obstacles.clear();
            goal.case.before.clear();
            goal
        })
        .collect();
    let mut starts = Vec::new();
    let has_points = goals.iter().any(|goal| !goal.points.is_empty());
    if has_points && is_sequential(&model, robot, &free) {
        starts.extend(
            sequential(&model, robot, choices, (&free, budget), options).ok().map(|of| of.list),
        );
    }
    starts.extend(choices.own_list(robot));
    starts.dedup();
    let disks = robot.disks().count();
    let firsts = choices.at(0);
    let wanted = options.starts.max(1);
    for k in 0..wanted {
        if starts.len() >= wanted {
            break;
        }
        // Spread over the combinations.
        let first = firsts[k * firsts.len() / wanted];
        let mut list = vec![first];
        for disk in 1..disks {
            let from = list[disk - 1];
            let straight = choices.after(from, disk).find(|&next| next == from);
            match straight.or_else(|| choices.after(from, disk).next()) {
                Some(next) => list.push(next),
                None => break,
            }
        }
        if list.len() == disks && !starts.contains(&list) {
            starts.push(list);
        }
    }
    starts
}
