//! The design of a robot for its goals: each part that is varied by the method that proves most, one after the other.

use core::f64::consts::TAU;

use whipcord::section::section_stiffness;
use whipcord::{
    Along, Backbone, Case, Model, ModelKind, Parameter, Robot, Section, Solution, Statics as _,
    Stations,
};

use crate::cable_count;
use crate::chebyshev;
use crate::choices::{FixedHole, HoleRules};
use crate::error::DesignError;
use crate::goal::{self, ShapeGoal, root_mean_square};
use crate::hole_design::{HoleDesign, design_holes};
use crate::pre_bend::rest_curvature_for_curve;
use crate::problem::{
    Design, DesignGoal, DesignOptions, Finding, GoalResult, Known, TargetShape, spread,
};
use crate::refine::{Bounded, RefineOptions, Refined, refine, rest_curvature_at};
use crate::route::{largest_radius, route_for_curve};
use crate::taper::taper_for_curve;
use crate::unknown::{Unknown, least_distance};
use crate::vary::Vary;

/// Changes what is to be varied of a robot, so that it comes nearest to its goals in the weighted mean square of the distances of its disks.
///
/// Holes come first ([`design_holes`]), in turn with the tensions where these are varied too; then a continuous routing, which has a closed form for
/// one cable and a curve; then rest curvature or diameters for a curve; all other continuous quantities by
/// least squares with the exact derivatives of the model, from several starts. What each part is worth is in [`Design::findings`].
///
/// # Errors
/// [`DesignError`].
pub fn design(
    model: &Model,
    robot: &Robot,
    goals: &[DesignGoal],
    vary: &[Vary],
    options: &DesignOptions,
) -> Result<Design, DesignError> {
    if vary.is_empty() {
        return Err(DesignError::NothingVaried);
    }
    if goals.is_empty() {
        return Err(DesignError::NoPoints);
    }
    let shape_goals: Vec<ShapeGoal> =
        goals.iter().map(|of| of.shape_goal(robot)).collect::<Result<_, _>>()?;
    goal::check(robot, &shape_goals)?;
    for of in goals {
        of.case.check(robot)?;
    }
    let before = measured(&model.at(Stations::Disks), robot, &shape_goals);
    let mut work = Work {
        model: model.at(Stations::Disks),
        goals,
        vary: vary.to_vec(),
        options,
        robot: robot.clone(),
        cases: goals.iter().map(|goal| goal.case.clone()).collect(),
        findings: Vec::new(),
        assumed: None,
    };
    work.run()?;
    let Work { model, robot, cases, findings, assumed, .. } = work;
    let goals: Vec<DesignGoal> =
        goals.iter().zip(&cases).map(|(of, case)| with_case(of, case)).collect();
    let shape_goals: Vec<ShapeGoal> =
        goals.iter().map(|of| of.shape_goal(&robot)).collect::<Result<_, _>>()?;
    let mut results = Vec::with_capacity(goals.len());
    for goal in &shape_goals {
        results.push(result(&model, &robot, goal)?);
    }
    let cost = shape_goals.iter().zip(&results);
    let cost = cost.map(|(goal, of)| goal.cost(&of.solution.disks.poses)).sum();
    let all: Vec<f64> = results.iter().flat_map(|of| of.distances.clone()).collect();
    Ok(Design {
        error: root_mean_square(&shape_goals, cost),
        largest: spread(&all)[1],
        model: model.kind(),
        robot,
        goals: results,
        findings,
        assumed_tension: assumed,
        before: before.map(|solutions| {
            let goals = shape_goals.iter().zip(&solutions);
            let all: Vec<f64> = goals.flat_map(|(goal, of)| distances(goal, of)).collect();
            spread(&all)
        }),
    })
}

fn with_case(goal: &DesignGoal, case: &Case) -> DesignGoal {
    DesignGoal { case: case.clone(), ..goal.clone() }
}

fn measured(model: &Model, robot: &Robot, goals: &[ShapeGoal]) -> Option<Vec<Solution>> {
    goals.iter().map(|goal| model.solve(robot, &goal.case).ok()).collect()
}

fn distances(goal: &ShapeGoal, solution: &Solution) -> Vec<f64> {
    goal.misses(solution).into_iter().map(|(_, distance)| distance).collect()
}

/// How near a robot comes to a goal, by the model and by `cosserat-disks` at a fine resolution.
fn result(model: &Model, robot: &Robot, goal: &ShapeGoal) -> Result<GoalResult, DesignError> {
    let solution = model.solve(robot, &goal.case)?;
    let fine = Model::new(ModelKind::CosseratDisks, Stations::Disks, whipcord::Actuation::Natural)
        .cancelled_by(model.cancel())
        .with_tolerance(FINE);
    let check = robot
        .has_disks()
        .then(|| fine.solve(robot, &goal.case).map(|solution| distances(goal, &solution)));
    Ok(GoalResult {
        case: goal.case.clone(),
        points: goal.points.clone(),
        distances: distances(goal, &solution),
        solution,
        check,
    })
}

/// Estimated error of the fine solve, as a part of the length.
const FINE: f64 = 1e-9;
/// Rounds in which holes and tensions are chosen in turn.
const ROUNDS: usize = 8;
/// Tensions that are tried for one cable before the rounds.
const TENSIONS: u32 = 24;
/// The best of these from which holes and tensions are chosen in turn.
const KEPT: usize = 4;
/// How much nearer a round must come to go on, as a part of the error.
const NEARER: f64 = 1e-4;

struct Work<'a> {
    model: Model,
    goals: &'a [DesignGoal],
    vary: Vec<Vary>,
    options: &'a DesignOptions,
    robot: Robot,
    cases: Vec<Case>,
    findings: Vec<Finding>,
    assumed: Option<[f64; 2]>,
}

impl Work<'_> {
    fn run(&mut self) -> Result<(), DesignError> {
        if self.vary.contains(&Vary::Cables) {
            self.number_of_cables()?;
        }
        let holes = self.cables(|of| match of {
            Vary::Holes { cable } => Some(cable),
            _ => None,
        });
        let tensions = self.tensions();
        self.check_tensions(&tensions)?;
        if !holes.is_empty() {
            self.holes(&holes, &tensions)?;
        }
        let mut rest: Vec<Vary> =
            self.vary.iter().copied().filter(|of| !matches!(of, Vary::Holes { .. })).collect();
        if !holes.is_empty() {
            rest.retain(|of| !matches!(of, Vary::Tension { .. }));
        }
        let routings: Vec<usize> = self.cables(|of| match of {
            Vary::Routing { cable } => Some(cable),
            _ => None,
        });
        if let [cable] = routings[..]
            && self.closed_form(cable)?
        {
            rest.retain(|of| !matches!(of, Vary::Routing { .. } | Vary::Tension { .. }));
        }
        if self.on_the_curve(&rest)? {
            return Ok(());
        }
        if !rest.is_empty() {
            self.least_squares(&rest)?;
        }
        Ok(())
    }

    fn cables(&self, pick: impl Fn(Vary) -> Option<usize>) -> Vec<usize> {
        let mut cables: Vec<usize> = Vec::new();
        for cable in self.vary.iter().filter_map(|of| pick(*of)) {
            if !cables.contains(&cable) {
                cables.push(cable);
            }
        }
        cables
    }

    /// Cables whose tensions are varied.
    fn tensions(&self) -> Vec<usize> {
        self.cables(|of| match of {
            Vary::Tension { cable } => Some(cable),
            _ => None,
        })
    }

    /// Tensions can be varied where they are commanded.
    fn check_tensions(&mut self, cables: &[usize]) -> Result<(), DesignError> {
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

    fn shape_goals(&self) -> Result<Vec<ShapeGoal>, DesignError> {
        let goals = self.goals.iter().zip(&self.cases);
        goals.map(|(of, case)| with_case(of, case).shape_goal(&self.robot)).collect()
    }

    fn find(&mut self, what: Vary, known: Known) {
        self.findings.push(Finding { what: what.to_string(), known });
    }

    /// The one goal's curve, where there is one goal and it is a curve.
    fn curve(&self) -> Result<Option<crate::curve::Curve>, DesignError> {
        match self.goals {
            [DesignGoal { target: TargetShape::Curve(named), .. }] => {
                named.curve(self.robot.backbone().length).map(Some)
            }
            _ => Ok(None),
        }
    }

    fn holes(&mut self, cables: &[usize], tensions: &[usize]) -> Result<(), DesignError> {
        let rules = self.rules(cables)?;
        let search = |work: &Self| -> Result<HoleDesign, DesignError> {
            let goals = work.shape_goals()?;
            let search = &work.options.search;
            design_holes(&work.model, &work.robot, cables, &goals, &rules, search)
        };
        // Of each trial the tensions and what the holes make of them.
        let mut trials = vec![(self.cases.clone(), search(self))];
        if let ([cable], [_]) = (tensions, &self.cases[..]) {
            let [least, greatest] = self.tension_range(*cable)?;
            for k in 1..=TENSIONS {
                let part = f64::from(k) / f64::from(TENSIONS);
                let tension = (part * part * greatest).max(least);
                self.cases[0].commands[*cable].tension = Some(tension);
                trials.push((self.cases.clone(), search(self)));
            }
        }
        let mut refusal = None;
        let mut found = Vec::new();
        for (cases, trial) in trials {
            match trial {
                Ok(design) => found.push((cases, design)),
                Err(error) => {
                    refusal.get_or_insert(error);
                }
            }
        }
        found.sort_by(|a, b| a.1.error.total_cmp(&b.1.error));
        found.truncate(if tensions.is_empty() { 1 } else { KEPT });
        let mut best: Option<(Vec<Case>, HoleDesign, Option<Known>)> = None;
        for (cases, design) in found {
            self.cases = cases;
            self.robot = design.robot.clone();
            let ended = self.in_turn(design, tensions, &search)?;
            if best.as_ref().is_none_or(|(_, best, _)| ended.0.error < best.error) {
                best = Some((self.cases.clone(), ended.0, ended.1));
            }
        }
        let Some((cases, best, known)) = best else {
            return Err(refusal.unwrap_or(DesignError::NoPoints));
        };
        (self.cases, self.robot) = (cases, best.robot.clone());
        for cable in cables {
            self.find(Vary::Holes { cable: *cable }, Known::Holes(best.proof));
        }
        for cable in tensions {
            self.find(
                Vary::Tension { cable: *cable },
                known.unwrap_or(Known::LeastSquares { starts: 1, agree: 1 }),
            );
        }
        Ok(())
    }

    /// Tensions and holes in turn, until neither comes nearer.
    fn in_turn(
        &mut self,
        mut best: HoleDesign,
        tensions: &[usize],
        search: &impl Fn(&Self) -> Result<HoleDesign, DesignError>,
    ) -> Result<(HoleDesign, Option<Known>), DesignError> {
        let mut known = None;
        let unknowns: Vec<Vary> = tensions.iter().map(|&cable| Vary::Tension { cable }).collect();
        for _ in 0..ROUNDS {
            if unknowns.is_empty() {
                break;
            }
            let before = best.error;
            let refined = self.refined(&unknowns, 1)?;
            let cases = core::mem::replace(&mut self.cases, refined.cases);
            let next = search(self)?;
            if next.error >= best.error {
                self.cases = cases;
                known.get_or_insert(converged(refined.is_converged, 1, 1));
                break;
            }
            known = Some(converged(refined.is_converged, 1, 1));
            best = next;
            self.robot = best.robot.clone();
            if best.error > before * (1.0 - NEARER) {
                break;
            }
        }
        Ok((best, known))
    }

    /// The rules with the fixed holes of the varied cables, by their places among them.
    fn rules(&self, cables: &[usize]) -> Result<HoleRules, DesignError> {
        let rules = &self.options.rules;
        let fixed = rules.fixed.iter().map(|fixed| {
            let place = cables.iter().position(|cable| *cable == fixed.cable);
            let cable = place.ok_or(DesignError::FixedButNotVaried { cable: fixed.cable })?;
            Ok(FixedHole { cable, ..*fixed })
        });
        Ok(HoleRules { fixed: fixed.collect::<Result<_, DesignError>>()?, ..rules.clone() })
    }

    /// Takes the closed form for a cable where there is one; whether nothing is left to do for it.
    fn closed_form(&mut self, cable: usize) -> Result<bool, DesignError> {
        let Some(curve) = self.curve()? else { return Ok(false) };
        let is_tension_free = self.tensions().contains(&cable);
        let [least, greatest] = self.tension_range(cable)?;
        let given = self.cases[0].commands[cable].tension.unwrap_or(0.0);
        let mut tension = if given > 0.0 { given } else { least.max(0.1 * greatest) };
        if given <= 0.0 && !is_tension_free {
            let name = self.robot.cables()[cable].name.clone();
            return Err(DesignError::NoTension { name });
        }
        for _ in 0..ROUNDS {
            match route_for_curve(&self.robot, cable, &curve, tension) {
                Ok(route) => {
                    self.robot = route.robot;
                    self.cases[0].commands[cable].tension = Some(tension);
                    let case = &self.cases[0];
                    let others = case.commands.iter().enumerate().filter(|(k, _)| *k != cable);
                    let is_alone = others
                        .map(|(_, command)| command)
                        .all(|command| command.tension == Some(0.0));
                    let is_exact = is_alone
                        && case.loads.is_none()
                        && case.obstacles.is_empty()
                        && self.model.kind() == ModelKind::Cosserat;
                    if is_exact {
                        self.find(Vary::Routing { cable }, Known::ClosedForm);
                    }
                    return Ok(is_exact);
                }
                Err(DesignError::NotAttainable { tension: needed, .. })
                    if is_tension_free && 1.02 * needed <= greatest =>
                {
                    tension = 1.02 * needed;
                }
                Err(error @ DesignError::NotAttainable { .. }) => {
                    // Under loads the cable does not have to bend the backbone alone.
                    let is_alone = self.cases[0].loads.is_none() && self.robot.cables().len() == 1;
                    return if is_alone { Err(error) } else { Ok(false) };
                }
                Err(DesignError::Backbone { .. } | DesignError::NotConverged { .. }) => {
                    return Ok(false);
                }
                Err(error) => return Err(error),
            }
        }
        Ok(false)
    }

    /// Rest curvature or diameters for one curve, if nothing else is left; whether that is all.
    fn on_the_curve(&mut self, rest: &[Vary]) -> Result<bool, DesignError> {
        let Some(curve) = self.curve()? else { return Ok(false) };
        let is_rod = matches!(self.model.kind(), ModelKind::Cosserat | ModelKind::CosseratDisks);
        let (model, case, places) = (&self.model, &self.cases[0], self.options.places);
        match rest {
            [Vary::RestCurvature] if is_rod => {
                let bent = rest_curvature_for_curve(model, &self.robot, case, &curve, places)?;
                self.robot = bent.robot;
                self.find(Vary::RestCurvature, Known::Iterated);
                Ok(true)
            }
            [Vary::Diameters] if is_rod => {
                let range = self.diameter_range();
                match taper_for_curve(model, &self.robot, case, &curve, places, range) {
                    Ok(taper) => {
                        self.robot = taper.robot;
                        self.find(Vary::Diameters, Known::Iterated);
                        Ok(true)
                    }
                    // What no taper can do least squares may still come near to.
                    Err(DesignError::Curve { .. } | DesignError::NotConverged { .. }) => Ok(false),
                    Err(error) => Err(error),
                }
            }
            _ => Ok(rest.is_empty()),
        }
    }

    fn diameter(&self) -> f64 {
        let backbone = self.robot.backbone();
        2.0 * backbone.outer_radius_at(self.robot.disks(), 0.5 * backbone.length)
    }

    fn diameter_range(&self) -> [f64; 2] {
        let now = self.diameter();
        self.options.diameters.unwrap_or([0.25 * now, 4.0 * now])
    }

    /// The limits of a tension; where none are given, those that are assumed.
    fn tension_range(&mut self, cable: usize) -> Result<[f64; 2], DesignError> {
        if let Some(Some(limits)) = self.options.tensions.get(cable) {
            return Ok(*limits);
        }
        let range = assumed_tensions(&self.robot, &self.cases)?;
        self.assumed = Some(range);
        Ok(range)
    }

    fn least_squares(&mut self, vary: &[Vary]) -> Result<(), DesignError> {
        let refined = self.refined(vary, self.options.starts)?;
        let known = converged(refined.is_converged, refined.starts, refined.agree);
        self.robot = refined.robot;
        self.cases = refined.cases;
        for of in vary {
            self.find(*of, known);
        }
        Ok(())
    }

    /// What least squares makes of these.
    fn refined(&mut self, vary: &[Vary], starts: usize) -> Result<Refined, DesignError> {
        let mut unknowns = Vec::new();
        for of in vary {
            self.unknowns(*of, &mut unknowns)?;
        }
        let goals = self.shape_goals()?;
        let options = RefineOptions {
            starts,
            iterations: self.options.iterations,
            seed: self.options.seed,
            rim: rim(&self.robot),
        };
        refine(&self.model, &self.robot, &goals, &unknowns, &options)
    }

    /// The numbers of a part, with the robot prepared so that it has them.
    fn unknowns(&mut self, of: Vary, into: &mut Vec<Bounded>) -> Result<(), DesignError> {
        let length = self.robot.backbone().length;
        match of {
            Vary::Holes { .. } | Vary::Cables => {}
            Vary::Tension { cable } => {
                let range = self.tension_range(cable)?;
                for goal in 0..self.cases.len() {
                    let start = self.cases[goal].commands[cable].tension.unwrap_or(0.0);
                    let unknown = Unknown::Tension { goal, cable };
                    // Of no tension the derivatives say nothing where the cable is slack.
                    let start = start.clamp(range[0], range[1]).max(0.01 * range[1]);
                    into.push(Bounded { unknown, start, range, starts: range });
                }
            }
            Vary::Routing { cable } => {
                let known = match &self.robot.cables()[cable].routing {
                    whipcord::Routing::Polynomial { x, y } => x.len().max(y.len()),
                    _ => 0,
                };
                let nodes = known.max(self.options.degree + 1);
                let rim = rim(&self.robot);
                let route = &self.robot.routes()[cable];
                for (node, part) in chebyshev::places(nodes).enumerate() {
                    let offset = route.at((part * length).min(route.end())).offset;
                    for axis in 0..2 {
                        let unknown = Unknown::Course { cable, axis, node, nodes };
                        let range = [-1.5 * rim, 1.5 * rim];
                        into.push(Bounded { unknown, start: offset[axis], range, starts: range });
                    }
                }
                let mut cables = self.robot.cables().to_vec();
                cables[cable].ends_at = None;
                self.rebuild(self.robot.backbone().clone(), cables)?;
            }
            Vary::RestCurvature => {
                let (backbone, unknowns) = rest_curvature_at(&self.robot, self.places(length)?);
                into.extend(unknowns);
                self.rebuild(backbone, self.robot.cables().to_vec())?;
            }
            Vary::Diameters => {
                let Some(Section::Round { inner, .. }) = &self.robot.backbone().section else {
                    let what =
                        "diameters are those of a round backbone: give a diameter and a material";
                    return Err(DesignError::Backbone { what: what.to_owned() });
                };
                if self.robot.backbone().stiffness.is_some() {
                    let what = "the stiffness is given, so that no diameter changes it: take out stiffness";
                    return Err(DesignError::Backbone { what: what.to_owned() });
                }
                let at = self.places(length)?;
                let count = at.len();
                let range = self.diameter_range();
                let start = self.diameter().clamp(range[0], range[1]);
                let outer = Along::At { arc_lengths: at, values: vec![start; count] };
                let section = Some(Section::Round { outer, inner: inner.clone() });
                let backbone = Backbone { section, ..self.robot.backbone().clone() };
                self.rebuild(backbone, self.robot.cables().to_vec())?;
                for entry in 0..count {
                    let unknown = Unknown::Parameter(Parameter::DiameterAt { entry });
                    let starts = [0.7 * start, 1.4 * start];
                    into.push(Bounded { unknown, start, range, starts });
                }
            }
            Vary::DiskPositions => {
                let disks = self.robot.disks();
                let least = least_distance(disks, length);
                #[allow(clippy::cast_precision_loss, reason = "few disks")]
                let pitch = length / (disks.count() - 1) as f64;
                for disk in 1..disks.count() - 1 {
                    #[allow(clippy::cast_precision_loss, reason = "few disks")]
                    let middle = pitch * disk as f64;
                    // Disks that stay within half a pitch keep their order and their least distance.
                    let half = 0.5 * (pitch - least);
                    let range = [middle - half, middle + half];
                    let start = disks.arc_lengths[disk].clamp(range[0], range[1]);
                    let unknown = Unknown::DiskPosition { disk };
                    into.push(Bounded { unknown, start, range, starts: range });
                }
            }
            Vary::Parameter(parameter) => {
                let start = parameter.value(&self.robot, &self.cases[0])?;
                let scale = if start == 0.0 { 1.0 / length } else { start.abs() };
                let (range, starts) = match start > 0.0 {
                    true => ([0.1 * start, 10.0 * start], [0.5 * start, 2.0 * start]),
                    false => {
                        let far = [start - 10.0 * scale, start + 10.0 * scale];
                        (far, [start - scale, start + scale])
                    }
                };
                into.push(Bounded { unknown: Unknown::Parameter(parameter), start, range, starts });
            }
        }
        Ok(())
    }

    /// Arc lengths at which a rest curvature or a diameter is given: where few points are to be met, more places would be free.
    fn places(&self, length: f64) -> Result<Vec<f64>, DesignError> {
        let points = self.goals[0].points(&self.robot)?.len();
        let count = self.options.places.min(points + 1).max(3);
        Ok(whipcord::equally_spaced(0.0, length, count).collect())
    }

    fn rebuild(
        &mut self,
        backbone: Backbone,
        cables: Vec<whipcord::Cable>,
    ) -> Result<(), DesignError> {
        self.robot = Robot::new(backbone, self.robot.disks().clone(), cables)?
            .with_motors(self.robot.motors().to_vec())?;
        Ok(())
    }

    /// Cables as few as the bending moments of the goals allow, with routings and tensions to start from.
    fn number_of_cables(&mut self) -> Result<(), DesignError> {
        let goals = self.shape_goals()?;
        let rim = rim(&self.robot);
        let found = cable_count::found(&self.robot, &self.model, &goals, rim, self.options)?;
        self.find(Vary::Cables, Known::AtLeast { cables: found.rank });
        let count = found.robot.cables().len();
        self.robot = found.robot;
        self.cases = found.cases;
        self.vary.retain(|of| {
            !matches!(
                of,
                Vary::Cables | Vary::Tension { .. } | Vary::Routing { .. } | Vary::Holes { .. }
            )
        });
        for cable in 0..count {
            self.vary.extend([Vary::Routing { cable }, Vary::Tension { cable }]);
        }
        Ok(())
    }
}

const fn converged(is_converged: bool, starts: usize, agree: usize) -> Known {
    match is_converged {
        true => Known::LeastSquares { starts, agree },
        false => Known::Unconverged { starts },
    }
}

/// How far from the axis a cable may be in m: the rims of the disks; of a body without disks its surface.
fn rim(robot: &Robot) -> f64 {
    if robot.has_disks() {
        return largest_radius(robot);
    }
    let length = robot.backbone().length;
    let radius = robot.backbone().outer_radius_at(robot.disks(), 0.5 * length);
    if radius > 0.0 { radius } else { 0.05 * length }
}

/// Tensions from none to twice what is given, or to what bends the backbone by a turn.
fn assumed_tensions(robot: &Robot, cases: &[Case]) -> Result<[f64; 2], DesignError> {
    let length = robot.backbone().length;
    let stiffness = section_stiffness(robot, 0.5 * length, 0.5 * length)?;
    let turn = TAU * stiffness[3][3] / (length * rim(robot));
    let given = cases.iter().flat_map(|case| &case.commands);
    let given = given.filter_map(|command| command.tension).fold(0.0, f64::max);
    Ok([0.0, turn.max(2.0 * given)])
}
