//! Steps of actuation of the rod whose cables have friction.

use std::borrow::Cow;

use super::friction::{Answer, Friction, FrictionRod, FrictionWorkspace, Level, base_wrench};
use super::prepared::{Cosserat, FOLD_LEVEL, GIVE_UP_LEVEL, Progress, Refined, Workspace};
use super::problem::{Problem, StabilityCheck};
use super::scratch::Scratch;
use super::state::State;
use super::unloaded::SweepOptions;
use super::verdict;
use crate::case::Case;
use crate::contact::RodSolves as _;
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::robot::Cable;
use crate::solution::{NoStability, SlipState, Solution, Verdict};
use crate::statics::friction::{self, Course, History, Holes, PassageResponse as _};
use crate::statics::grid::Grid;
use crate::statics::options::Accuracy;
use crate::statics::outcome::{Failure, Found};
use crate::statics::plastic_steps::PlasticRod as _;
use crate::statics::refinement::change_of_tensions;
use crate::statics::scales::Scales;

/// How often the steps may be halved.
const MAX_REFINEMENTS: usize = 5;
/// Where every cable slides one way along all of its length, halved steps lose all but 1/8 of the error, so that the change is
/// seven times what is left.
const ERROR_RATIO: f64 = 7.0;
/// Where it does not, the place where the sliding ends moves with the grid, and with it the shape by so much of the length, less
/// than what a step of actuation leaves that is divided for its accuracy.
const FRONT_TOLERANCE: f64 = 3e-4;
/// Halved steps lose all but so much of the error of the places where the cables come to rest.
const REST_RATIO: f64 = 4.0;
/// Of all cables together no grid beyond the second has more nodes than this, because the linear system of an iteration is full.
const MOST_NODES: usize = 512;
/// An answer on the last grid is taken if it is known to this part of the length, which it says.
const LAST_TOLERANCE: f64 = 2e-3;

/// How often a step of actuation is found anew with the profile of the tensions that the pass before leaves.
const MOST_PASSES: usize = 3;
/// A profile that changes by less is kept.
const PROFILE_TOLERANCE: f64 = 1e-4;
/// The same where derivatives are asked for.
const PASSES_OF_DERIVATIVES: usize = 10;
const PROFILE_OF_DERIVATIVES: f64 = 1e-11;

impl Cosserat {
    /// Whether a cable has friction.
    pub(crate) fn has_friction(&self) -> bool {
        self.robot.cables().iter().any(Cable::has_friction)
    }

    /// The answer to the last of several steps of actuation, each of which starts where the one before ends; those that were
    /// found in this workspace before are not taken again, unless `anew`.
    pub(super) fn solve_with_friction(
        &self,
        cases: &[Case],
        anew: bool,
        workspace: &mut Workspace,
        solution: &mut Solution,
    ) -> Result<(), SolveError> {
        for case in cases {
            self.accept(case, workspace)?;
        }
        workspace.progress = Progress::default();
        workspace.scratch.open = None;
        if anew {
            workspace.friction.levels.clear();
            workspace.friction.courses.clear();
        }
        workspace.friction.courses.resize(cases.len(), Course::default());
        let Some(last) = cases.last() else { return Ok(()) };
        let Refined { found, grid, error } = match self.options.accuracy {
            Accuracy::Steps(_) => {
                let grid = Cow::Borrowed(&self.grid);
                workspace.progress.level = 0;
                let (found, grid) = self.take_steps(0, grid, cases, false, workspace)?;
                Refined { found, grid, error: None }
            }
            Accuracy::Tolerance(tolerance) => {
                self.refine_with_friction(tolerance, cases, workspace)?
            }
        };
        let friction = self.friction_on(&grid);
        let verdict = self.stability_with_friction(&grid, last, &friction, workspace)?;
        self.write_answer(&grid, last, workspace, (found, error), verdict, solution);
        // Its tensions vary along the cables, which no start tells.
        solution.internal.clear();
        let Workspace { friction: memory, progress, .. } = workspace;
        if let Some(Level { history, plastic, .. }) = memory.levels.get(progress.level) {
            let holes = (&history.tensions[..], &history.slip_states[..]);
            self.write_friction(&grid, &friction, holes, solution);
            let stations = self.layout.stations();
            let left = plastic.last().map(|left| left.at_stations(stations));
            solution.plastic_curvature = left.unwrap_or_default();
        }
        Ok(())
    }

    pub(super) fn friction_on(&self, grid: &Grid) -> Friction {
        Friction::new(&self.robot, grid, &self.layout.order, &self.layout.rest_lengths)
    }

    /// Halves the steps until the answer to the last step of actuation changes no more.
    fn refine_with_friction(
        &self,
        tolerance: f64,
        cases: &[Case],
        workspace: &mut Workspace,
    ) -> Result<Refined<'_>, SolveError> {
        let length = self.robot.backbone().length;
        let tolerance = tolerance * length;
        let (mut error, mut steps) = (f64::INFINITY, 0);
        // Of the places where the cables come to rest, on the last grid that found them.
        let mut rest_error: Option<f64> = None;
        let mut coarser: Option<(Found, Cow<'_, Grid>)> = None;
        let mut failed = None;
        let is_known = |error: f64| error <= LAST_TOLERANCE * length;
        let Some(last) = cases.last() else { return Err(SolveError::NoDerivatives) };
        let first = cases
            .iter()
            .map(|case| self.first_level(case, workspace))
            .max()
            .unwrap_or(0)
            .min(MAX_REFINEMENTS);
        let nodes = |level: usize| {
            self.grid(level).map(|grid| self.friction_on(&grid).nodes.count()).unwrap_or(usize::MAX)
        };
        let first = (0..=first).rev().find(|&level| 2 * nodes(level) <= MOST_NODES).unwrap_or(0);
        for level in first..=MAX_REFINEMENTS.max(first + 1) {
            if workspace.meter.has_ended() {
                failed = Some(workspace.meter.end());
                break;
            }
            if level > first + 1 && nodes(level) > MOST_NODES {
                break;
            }
            let grid = self.grid(level)?;
            workspace.progress.level = level;
            let keeps_rest = rest_error.is_some_and(|error| error <= FRONT_TOLERANCE * length);
            let taken = self.take_steps(level, grid, cases, keeps_rest, workspace);
            let (mut found, grid) = match taken {
                Err(failure) => {
                    let last_level = match failure {
                        SolveError::NotConverged { .. } | SolveError::SectionFolds { .. } => {
                            GIVE_UP_LEVEL
                        }
                        SolveError::UnreachableLength { .. } => FOLD_LEVEL,
                        _ => 0,
                    };
                    let has_ended = workspace.meter.has_ended();
                    if has_ended && is_known(error) {
                        // What the coarser grid has is known well enough.
                        self.put_answer(coarser.as_ref(), level - 1, last, workspace)?;
                        break;
                    }
                    if level >= last_level || has_ended {
                        return Err(failure);
                    }
                    (coarser, failed, rest_error) = (None, Some(failure), None);
                    continue;
                }
                Ok(taken) => taken,
            };
            if let Some((earlier, _)) = &coarser {
                found = found.after(earlier);
                let change = self.change_with_friction(&grid, workspace);
                let answer = workspace.friction.levels[level].answers.last();
                let one_way = answer.is_some_and(|answer| self.slides_one_way(&grid, answer));
                let bound =
                    if one_way { tolerance } else { tolerance.max(FRONT_TOLERANCE * length) };
                error = if one_way { change / ERROR_RATIO } else { change };
                match rest_error {
                    Some(rest_error) if keeps_rest && !one_way => error = error.max(rest_error),
                    Some(_) if keeps_rest => {}
                    _ => rest_error = Some(change / REST_RATIO),
                }
                if error <= bound {
                    return Ok(Refined { found, grid, error: Some(error) });
                }
            }
            workspace.keep_coarse(&grid);
            workspace.friction.coarse_tensions.clone_from(&workspace.scratch.tensions);
            steps = grid.len();
            coarser = Some((found, grid));
        }
        match coarser {
            Some((found, grid)) if is_known(error) => {
                Ok(Refined { found, grid, error: Some(error) })
            }
            _ => Err(failed.unwrap_or(SolveError::StepsTooCoarse { error, tolerance, steps })),
        }
    }

    /// Puts the workspace to the answer to the last step of actuation, on the grid where that was found.
    fn put_answer(
        &self,
        coarser: Option<&(Found, Cow<'_, Grid>)>,
        level: usize,
        case: &Case,
        workspace: &mut Workspace,
    ) -> Result<(), SolveError> {
        let Some((_, grid)) = coarser else { return Ok(()) };
        self.accept(case, workspace)?;
        let Workspace { scratch, commands, meter, friction: memory, progress, .. } = workspace;
        let FrictionWorkspace { levels, response, at, .. } = memory;
        let Some(Level { history, answers, .. }) = levels.get(level) else { return Ok(()) };
        let Some(Answer { shape, profile, .. }) = answers.last() else { return Ok(()) };
        progress.level = level;
        scratch.applied.gather(grid, &case.loads, case.base.rotation);
        scratch.trajectory.steps_left = usize::MAX;
        let friction = self.friction_on(grid);
        let problem = self.problem(grid, case, (commands, meter));
        let mut rod = FrictionRod::new(&problem, (&friction, profile), scratch, response);
        rod.set_shape(shape);
        rod.measure(&history.tensions, at).map_err(|_| meter.end())?;
        leave(&friction.holes, &history.base, &at.lengths, scratch);
        Ok(())
    }

    /// Whether every taut cable with friction slides one way along all of its length.
    fn slides_one_way(&self, grid: &Grid, answer: &Answer) -> bool {
        let nodes = self.friction_on(grid).nodes;
        (0..nodes.cables()).filter(|&cable| nodes.steps(cable) > 0).all(|cable| {
            let states = &answer.slip_states[nodes.of_cable(cable)];
            let is_slack = answer.varying[cable] == 0.0;
            is_slack || (states[0] != SlipState::Sticks && states.iter().all(|s| *s == states[0]))
        })
    }

    /// Largest change since the coarser grid of a position or a cable's length in m, and where lengths are given of a
    /// tension as a part of the length.
    fn change_with_friction(&self, grid: &Grid, workspace: &Workspace) -> f64 {
        let Scratch { poses, lengths, tensions, .. } = &workspace.scratch;
        let moved = workspace.coarse.change(grid, poses, lengths);
        let length = self.robot.backbone().length;
        let scales = Scales::of(grid, length);
        let pulled = change_of_tensions(tensions, &workspace.friction.coarse_tensions, &scales);
        moved.max(length * pulled)
    }

    /// The answer to the last step of actuation on one grid, which the workspace then holds, and the grid with the plastic curvature
    /// before that step. It may keep to where the cables come to rest on the coarser grid.
    fn take_steps<'a>(
        &self,
        level: usize,
        mut grid: Cow<'a, Grid>,
        cases: &[Case],
        keeps_rest: bool,
        workspace: &mut Workspace,
    ) -> Result<(Found, Cow<'a, Grid>), SolveError> {
        let friction = self.friction_on(&grid);
        let levels = &mut workspace.friction.levels;
        if levels.len() <= level {
            levels.resize(level + 1, Level::default());
        }
        // Where a step fails the way starts anew.
        let Level { mut history, mut answers, mut plastic } = core::mem::take(&mut levels[level]);
        let coarse = level.checked_sub(1).map(|coarser| levels[coarser].answers.clone());
        if answers.len() > cases.len() {
            (history, answers) = (History::default(), Vec::new());
            plastic.clear();
        }
        if answers.len() == cases.len()
            && let [.., before, _] = &plastic[..]
        {
            grid.to_mut().set_plastic(before);
        }
        if answers.is_empty() && workspace.friction.keeps_trail {
            history = History::with_trail();
        }
        let mut found = Found::default();
        for (n, case) in cases.iter().enumerate().skip(answers.len()) {
            self.accept(case, workspace)?;
            if let Some(left) = plastic.last() {
                grid.to_mut().set_plastic(left);
            }
            let Workspace { scratch, commands, meter, friction: memory, .. } = &mut *workspace;
            scratch.applied.gather(&grid, &case.loads, case.base.rotation);
            scratch.trajectory.steps_left = usize::MAX;
            let problem = self.problem(&grid, case, (commands, meter));
            let guess = coarse.as_ref().and_then(|answers| answers.get(n));
            let guess = guess.filter(|answer| 2 * (answer.shape.nodes.len() - 1) == grid.len());
            let mut course = core::mem::take(&mut memory.courses[n]);
            course.rest = match guess {
                // A step that had no way to go on the coarser grid leaves nothing of it.
                Some(answer) if keeps_rest && course.rest.len() == answer.slip_states.len() => {
                    friction.nodes.halved_rest(&grid, &course.rest, &answer.slip_states)
                }
                _ => Vec::new(),
            };
            let from = (guess, &mut course);
            let stepped = take_step(&problem, &friction, from, &mut history, scratch, memory);
            memory.courses[n] = course;
            let (taken, answer) = stepped.map_err(|failure| self.explain(failure, commands))?;
            found = taken;
            if self.robot.has_bending_friction() {
                let left = self.plastic_left(&grid, &friction, (case, &answer), workspace)?;
                plastic.push(left);
            }
            answers.push(answer);
        }
        workspace.friction.levels[level] = Level { history, answers, plastic };
        Ok((found, grid))
    }

    /// Stability of the answer in the workspace: known where no cable with friction pulls.
    fn stability_with_friction(
        &self,
        grid: &Grid,
        case: &Case,
        friction: &Friction,
        workspace: &mut Workspace,
    ) -> Result<Result<Verdict, NoStability>, SolveError> {
        let Workspace { scratch, commands, meter, .. } = workspace;
        let problem = self.problem(grid, case, (commands, meter));
        let pulls =
            |(cable, &tension): (usize, &f64)| tension > 0.0 && friction.nodes.steps(cable) > 0;
        if problem.stability != StabilityCheck::Off
            && scratch.tensions.iter().enumerate().any(pulls)
        {
            return Ok(Err(NoStability::Sliding));
        }
        let Scratch { unloaded, tensions, applied, .. } = scratch;
        if !applied.any() && unloaded.sweep(grid, tensions, SweepOptions::EXACT).is_err() {
            return Ok(Err(NoStability::Undetermined));
        }
        verdict::stability(&problem, self.options.stability, scratch)
            .map_err(|failure| self.explain(failure, commands))
    }

    /// Writes tensions and slip of the cables with friction.
    pub(super) fn write_friction(
        &self,
        grid: &Grid,
        friction: &Friction,
        (tensions, slip_states): (&[f64], &[SlipState]),
        solution: &mut Solution,
    ) {
        for (place, &cable) in self.layout.order.iter().enumerate() {
            let state = &mut solution.cables[cable];
            let steps = friction.nodes.steps(place);
            if steps == 0 {
                continue;
            }
            let (spans, states) = (&mut state.span_tensions, &mut state.slip_states);
            let mut ends: Vec<usize> =
                grid.disks.iter().copied().filter(|&k| k < steps).chain([steps]).collect();
            if ends[0] > 0 {
                ends.insert(0, 0);
            }
            for pair in ends.windows(2) {
                let of = |k: usize| tensions[friction.nodes.at(place, k)];
                let length = |k: usize| grid.steps[k].length;
                let mean = (pair[0]..pair[1]).map(|k| length(k) * of(k)).sum::<f64>();
                spans.push(mean / (pair[0]..pair[1]).map(length).sum::<f64>());
                states.push(slip_states[friction.nodes.at(place, pair[0])]);
            }
        }
    }

    /// The answers to all steps of a case in order, each from where the one before left the robot:
    /// those of [`Cosserat::solve`] to each of [`Case::steps`], in time that grows with their number, not with its
    /// square. `each` gets them as they come.
    ///
    /// # Errors
    /// The number of the first step without an answer, from 0, and why it has none.
    pub fn solve_steps(
        &self,
        case: &Case,
        workspace: &mut Workspace,
        mut each: impl FnMut(Solution),
    ) -> Result<(), (usize, SolveError)> {
        if self.bends_in_steps() && !case.independent {
            case.check(&self.robot).map_err(|error| (0, error.into()))?;
            return self.solve_steps_with_bending_friction(case, workspace, each);
        }
        if self.has_friction() && !case.obstacles.is_empty() && !case.independent {
            workspace.meter.start(&self.options.cancel, self.options.budget);
            return self.rub_among_obstacles(case, workspace, each);
        }
        let steps: Vec<Case> = case.single_steps().collect();
        let remembers = self.has_friction() && case.obstacles.is_empty() && !case.independent;
        let mut last: Option<Solution> = None;
        for (n, step) in steps.iter().enumerate() {
            let solved = if case.independent {
                self.solve(step, None, workspace)
            } else if remembers {
                workspace.meter.start(&self.options.cancel, self.options.budget);
                let mut solution = Solution::empty(ModelKind::Cosserat);
                let solved =
                    self.solve_with_friction(&steps[..=n], n == 0, workspace, &mut solution);
                workspace.meter.checked(solved.map(|()| solution))
            } else {
                self.solve(step, last.as_ref(), workspace)
            };
            each(last.insert(solved.map_err(|error| (n, error))?).clone());
        }
        Ok(())
    }
}

/// One step of actuation from where `history` ends; the answer is left in `scratch` as well.
fn take_step(
    problem: &Problem<'_>,
    friction: &Friction,
    (guess, course): (Option<&Answer>, &mut Course<State>),
    history: &mut History<State>,
    scratch: &mut Scratch,
    memory: &mut FrictionWorkspace,
) -> Result<(Found, Answer), Failure> {
    let (grid, cables) = (problem.grid, problem.commands.len());
    let Friction { holes, nodes } = friction;
    scratch.trace.steps = grid.len();
    let fault = |fault| Failure::of_section(fault, &vec![0.0; cables], 0.0);
    scratch.unloaded.sweep(grid, &vec![0.0; cables], SweepOptions::EXACT).map_err(fault)?;
    // Derivatives are those of a profile that has come to rest.
    let (passes, tolerance) = match memory.keeps_trail {
        true => (PASSES_OF_DERIVATIVES, PROFILE_OF_DERIVATIVES),
        false => (MOST_PASSES, PROFILE_TOLERANCE),
    };
    let FrictionWorkspace { scratch: newton, response, at, .. } = memory;
    let mut profile = nodes.flat_profile(grid);
    let mut start = guess.map(|answer| {
        let (tensions, states) = nodes.halved(&answer.slip_states, &answer.varying);
        nodes.set_profile(grid, &tensions, &states, &mut profile);
        (State { load: 1.0, ..answer.shape.halved() }, tensions)
    });
    let before = history.clone();
    let (mut found, mut answer) = (Found::default(), Answer::default());
    for _ in 0..passes {
        *history = before.clone();
        let mut rod = FrictionRod::new(problem, (friction, &profile), scratch, response);
        course.answer = start.take();
        let stepped = friction::step(&mut rod, holes, problem.commands, history, course, newton)?;
        if let Some(shape) = &history.shape {
            rod.set_shape(shape);
        }
        rod.measure(&history.tensions, at)
            .map_err(|fault| rod.failure(fault, &history.tensions))?;
        found = stepped.after(&found);
        let varying = scratch.chain.varying.clone();
        let shape = scratch.chain.state.clone();
        let (tensions, slip_states) = (history.tensions.clone(), history.slip_states.clone());
        let earlier = profile.clone();
        nodes.set_profile(grid, &tensions, &slip_states, &mut profile);
        let change = profile.iter().zip(&earlier).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        start = Some((shape.clone(), tensions));
        answer = Answer { shape, slip_states, varying, profile: earlier };
        if change <= tolerance {
            break;
        }
    }
    leave(holes, &history.base, &at.lengths, scratch);
    Ok((found, answer))
}

/// Leaves the chain as it stands as the answer, with these tensions below the base and these lengths of the passages.
fn leave(holes: &Holes, base: &[f64], of_passages: &[f64], scratch: &mut Scratch) {
    let Scratch { chain, poses, lengths, tensions, .. } = &mut *scratch;
    chain.varying.clear();
    chain.poses(poses);
    holes.cable_lengths(of_passages, lengths);
    tensions.clear();
    tensions.extend_from_slice(base);
    chain.state.tensions.clone_from(tensions);
    scratch.base_wrench = base_wrench(scratch);
    (scratch.on_chain, scratch.side_by_side, scratch.sampled) = (true, false, true);
}
