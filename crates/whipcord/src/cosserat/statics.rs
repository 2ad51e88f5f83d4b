//! Static equilibrium on one grid.
//!
//! Without load the sections stand for themselves ([`super::unloaded`], [`crate::statics::lengths`]). Under
//! loads the unknowns are the base moment, the share of follower forces in the base force, and the
//! tensions of the cables whose lengths are prescribed; Newton's method shoots at
//!
//! ```text
//! M(L) = M_tip,   F_follower(L) = F_tip,   min(τᵢ, gᵢ) = 0        g: slackness, eq. (6)        (7)
//! ```
//!
//! from the shape without load, or from a neighbouring answer; where that fails the load is raised
//! by multiple shooting, and past the points where it cannot be, by [`crate::statics::path`].

use whipcord_numerics::{Pose, UnitQuaternion};

use super::chain::Chain;
use super::continuation::{Ended, newton, raise_load, raise_load_at_tensions, refine_chain};
use super::guess::{Guess, guess};
use super::loaded::Trajectory;
use super::newton::{Newton, Point};
use super::path::RodPath;
use super::redundant_cables;
use super::search;
use super::shooting::{Failed, finish, finish_chain, sample, shoot};
use super::stability::{Equilibrium, Stability};
use super::state::{Node, State};
use super::unloaded::Unloaded;
use super::without_load::{set_tensions, start_without_load, without_load};
use crate::budget::Meter;
use crate::case::Loads;
use crate::shape::{NoStability, Verdict, Wrench};
use crate::statics::command::Command;
use crate::statics::grid::Grid;
use crate::statics::lengths::{self, Effort, LengthScratch};
use crate::statics::loads::AppliedLoads;
use crate::statics::options::StabilityAnalysis;
use crate::statics::outcome::{Failure, Found};
use crate::statics::path::next_stable::next_stable;
use crate::statics::quadratic_form::Sample;
use crate::statics::scales::Scales;
use crate::statics::trace::{Stage, Trace};

/// When the stability of an equilibrium decides whether it is the answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StabilityCheck {
    /// Never.
    Off,
    /// Newton's method is trusted on each grid ([`Scratch::unverified`]), and the answer is checked once by who asks
    /// for it.
    AtAnswer,
    /// On each grid.
    EveryGrid,
}

/// What is to be solved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Problem<'a> {
    pub grid: &'a Grid,
    /// Length of the backbone in m.
    pub length: f64,
    /// In the order of the grid.
    pub commands: &'a [Command],
    /// The commands of the case: cables that were let go for the solution are held for its stability.
    pub asked: &'a [Command],
    pub loads: &'a Loads,
    /// How the base is turned in the frame that loads may be given in.
    pub base: UnitQuaternion,
    pub stability: StabilityCheck,
    /// Whether the path is followed past the point where the load cannot be raised.
    pub follow: bool,
    /// Whether it is found out how far cables go that do not go as far as they should.
    pub bracket: bool,
    /// Whether the robot has cables that pull against one another to no effect, see
    /// [`super::redundant_cables`].
    pub redundant_cables: bool,
    /// Residual of eq. (7), relative to the scales of moment and length, at which it is met.
    pub tolerance: f64,
    pub meter: &'a Meter,
}

impl<'a> Problem<'a> {
    /// Whether there is one equilibrium at most: no force acts, so that the strains of a section follow
    /// from its rotation, and the shape from its base.
    pub fn is_only(&self, applied: &AppliedLoads) -> bool {
        applied.only_dead_moments() && !self.commands.iter().any(Command::is_length)
    }

    /// An equilibrium of it whose stability is asked for.
    pub fn equilibrium(
        &self,
        samples: &'a [Sample],
        tensions: &'a [f64],
        lengths: &'a [f64],
        applied: &'a AppliedLoads,
        load: f64,
    ) -> Equilibrium<'a> {
        let Self { grid, asked: commands, .. } = *self;
        Equilibrium { grid, samples, commands, tensions, lengths, applied, load }
    }
}

/// Where the iteration starts: from the robot without load, or from a neighbouring answer.
#[derive(Clone, Debug, Default)]
pub(super) struct Start {
    /// In N, in the order of the grid; none from the robot without load.
    pub tensions: Vec<f64>,
    /// Wrench at the base of a neighbouring answer.
    pub base_wrench: Option<Wrench>,
    /// Whether that answer was stable, so that this one is held to be.
    pub stable: bool,
    /// Whether it took multiple shooting.
    pub on_chain: bool,
    /// Its nodes then, on a grid with half as many steps.
    pub chain: State,
    /// Cables that were let go, see [`super::redundant_cables`].
    pub slackened: Vec<usize>,
}

impl Start {
    /// From the robot without load, in the memory that it has.
    pub fn forget(&mut self) {
        self.tensions.clear();
        self.slackened.clear();
        (self.base_wrench, self.stable, self.on_chain) = (None, false, false);
    }
}

/// Memory of a solve, and the answer it ends with.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch {
    /// Frames at the ends of all steps.
    pub poses: Vec<Pose>,
    /// Tensions in N and lengths in m, in the order of the grid.
    pub tensions: Vec<f64>,
    pub lengths: Vec<f64>,
    pub base_wrench: Wrench,
    pub(super) unloaded: Unloaded,
    pub(super) applied: AppliedLoads,
    pub(super) guess: Guess,
    pub(super) trajectory: Trajectory,
    pub(super) newton: Newton,
    pub(super) chain: Chain,
    pub(super) stability: Stability,
    pub(super) length_scratch: LengthScratch,
    pub trace: Trace,
    /// Cables that were let go, see [`super::redundant_cables`].
    pub(super) slackened: Vec<usize>,
    /// Whether the answer is that of the chain, which single shooting would miss.
    pub(super) on_chain: bool,
    /// Whether the samples of the last shot are those of the answer.
    pub(super) sampled: bool,
    /// Whether the answer is stable, as far as that was asked for.
    pub(super) stable: bool,
    /// Whether an equilibrium was accepted whose stability was not checked, see [`StabilityCheck::AtAnswer`].
    pub(super) unverified: bool,
    /// Whether branches off the path are left alone.
    pub(super) stays_on_path: bool,
    /// What the iterate leaves open at which the budget was spent; it is then in the place of the answer.
    pub(super) open: Option<Effort>,
}

impl Scratch {
    /// Moment, and force of the followers, in the base frame at the start of each step, of an answer
    /// that single shooting would miss.
    pub fn chain_starts(&self) -> Vec<Option<Wrench>> {
        let start =
            |node: &Node| Wrench { force: node.force, moment: node.rotation.rotate(node.moment) };
        let nodes = self.chain.state.nodes.iter().filter(|_| self.on_chain);
        nodes.map(|node| Some(start(node))).collect()
    }

    /// Keeps the answer as the start of another solve.
    pub fn keep_start(&self, start: &mut Start) {
        start.tensions.clone_from(&self.tensions);
        (start.base_wrench, start.stable) = (Some(self.base_wrench), self.stable);
        start.on_chain = self.on_chain;
        if self.on_chain {
            start.chain.copy_from(&self.chain.state);
        }
        start.slackened.clone_from(&self.slackened);
    }
}

/// Solves the problem; the answer is left in `scratch`.
pub(super) fn solve(
    problem: &Problem<'_>,
    start: &Start,
    scratch: &mut Scratch,
) -> Result<Found, Failure> {
    scratch.applied.gather(problem.grid, problem.loads, problem.base);
    scratch.slackened.clear();
    if problem.redundant_cables && scratch.applied.any() {
        redundant_cables::solve(problem, start, scratch)
    } else {
        solve_independent(problem, start, scratch)
    }
}

/// Solves the problem, whose loads are gathered, for cables of which each pulls to an effect of its own.
pub(super) fn solve_independent(
    problem: &Problem<'_>,
    start: &Start,
    scratch: &mut Scratch,
) -> Result<Found, Failure> {
    (scratch.trace.stage, scratch.trace.steps) = (Stage::Warm, problem.grid.len());
    (scratch.on_chain, scratch.sampled, scratch.stable) = (false, false, true);
    scratch.tensions.clear();
    scratch.tensions.resize(problem.commands.len(), 0.0);
    for (tension, &given) in scratch.tensions.iter_mut().zip(&start.tensions) {
        *tension = given.max(0.0);
    }
    if !scratch.applied.any() {
        return without_load(problem, scratch);
    }
    let Start { base_wrench: Some(wrench), stable, on_chain, chain, .. } = start else {
        return from_no_load(problem, scratch, None);
    };
    if *on_chain
        && let Some(found) = refine_chain(problem, scratch, chain)
        && (!stable || is_accepted(problem, scratch))
    {
        scratch.stable = *stable;
        return Ok(found);
    }
    (scratch.on_chain, scratch.sampled) = (false, false);
    set_tensions(problem.commands, &mut scratch.tensions);
    scratch.newton.point.base_moment = wrench.moment;
    scratch.newton.point.follower_force = scratch.applied.follower_share(wrench.force);
    scratch.newton.point.tensions.clone_from(&scratch.tensions);
    scratch.trajectory.forget();
    let mut near = None;
    match shoot(problem, scratch, 1.0) {
        Ok(effort) => {
            let found = finish(problem, scratch, effort);
            scratch.stable = *stable;
            if !stable || is_accepted(problem, scratch) {
                return Ok(found);
            }
            near = Some(scratch.newton.point.clone());
        }
        Err(Failed { effort }) if problem.meter.has_ended() => {
            let Effort { iterations, residual } = effort;
            let advice = "the solve was ended";
            return Err(Failure::NotConverged { iterations, residual, last_load: 0.0, advice });
        }
        Err(_) => {}
    }
    from_no_load(problem, scratch, near)
}

/// The rod without load as the start of a path, with the loads gathered; `None` where there is no
/// load.
pub(super) fn start_of_path(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
) -> Result<Option<State>, Failure> {
    scratch.applied.gather(problem.grid, problem.loads, problem.base);
    scratch.trace.steps = problem.grid.len();
    scratch.tensions.clear();
    scratch.tensions.resize(problem.commands.len(), 0.0);
    start_without_load(problem, scratch)?;
    let state = State::unloaded(&scratch.poses, &scratch.tensions);
    Ok(scratch.applied.any().then_some(state))
}

/// All of the load at a point near equilibrium; the answer is left in `scratch`.
pub(super) fn converge(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    near: State,
) -> Result<Found, Failure> {
    start_of_path(problem, scratch)?;
    scratch.chain.state = near;
    scratch.chain.state.load = 1.0;
    scratch.trajectory.seed(problem.grid, &scratch.unloaded.strains);
    match newton(problem, scratch) {
        Ok((iterations, residual)) => {
            Ok(finish_chain(problem, scratch, Effort { iterations, residual }))
        }
        Err(open) => Err(Failure::NotConverged {
            iterations: open.iterations,
            residual: open.gap,
            last_load: 1.0,
            advice: "an equilibrium on coarse steps is lost on finer ones: give more steps",
        }),
    }
}

/// From the rod without load: at once, or raising the load step by step.
/// `near` is an equilibrium that is known but not stable, for where no stable one is found.
fn from_no_load(
    problem: &Problem<'_>,
    scratch: &mut Scratch,
    near: Option<Point>,
) -> Result<Found, Failure> {
    if let Err(failure) = start_without_load(problem, scratch) {
        return from_loose_cables(problem, scratch).ok_or(failure);
    }
    guess(problem, scratch, 1.0);
    scratch.trace.stage = Stage::Cold;
    let strong_followers = scratch.applied.any_follower()
        && scratch.newton.point.is_strong(&Scales::of(problem.grid, problem.length));
    // No energy tells which of several equilibria under followers is meant: it is the one the load
    // leads to.
    let (spent, direct) = if strong_followers {
        (0, near)
    } else {
        match shoot(problem, scratch, 1.0) {
            Ok(effort) => {
                let found = finish(problem, scratch, effort);
                scratch.stable = is_accepted(problem, scratch);
                if scratch.stable {
                    return Ok(found);
                }
                // An unstable equilibrium: the load path may lead to another.
                (effort.iterations, near.or_else(|| Some(scratch.newton.point.clone())))
            }
            Err(failed) => (failed.effort.iterations, near),
        }
    };
    let ended = match raise_load(problem, scratch, spent) {
        Ok(found) => {
            scratch.stable = true;
            return Ok(found);
        }
        Err(ended) => ended,
    };
    let Ended { failure, state, iterations } = ended;
    let Some(state) = state.filter(|_| problem.follow) else { return Err(failure) };
    let stays_on_path = scratch.stays_on_path;
    let mut path = RodPath::new(problem, scratch);
    let beyond = next_stable(&mut path, &state, stays_on_path, iterations);
    let lost_at = beyond.lost_at;
    scratch.stable = beyond.stable.is_some();
    if let Some(state) = beyond.stable {
        scratch.chain.state = state;
        scratch.trajectory.seed(problem.grid, &scratch.unloaded.strains);
        if let Ok((taken, residual)) = newton(problem, scratch) {
            let effort = Effort { iterations: beyond.iterations + taken, residual };
            return Ok(Found { lost_at, ..finish_chain(problem, scratch, effort) });
        }
    }
    if problem.commands.iter().any(|c| matches!(c, Command::Length { .. }))
        && let Some(found) = raise_load_at_tensions(problem, scratch, beyond.iterations)
    {
        scratch.stable = true;
        return Ok(Found { lost_at, ..found });
    }
    if let Some(state) = beyond.unstable
        && let Ok(found) = converge(problem, scratch, state)
    {
        (scratch.stable, scratch.on_chain) = (false, true);
        return Ok(Found { iterations: beyond.iterations + found.iterations, lost_at, ..found });
    }
    if let Some(point) = direct {
        scratch.newton.point = point;
        scratch.trajectory.forget();
        if let Ok(effort) = shoot(problem, scratch, 1.0) {
            scratch.stable = false;
            return Ok(Found { lost_at, ..finish(problem, scratch, effort) });
        }
    }
    if let Some(found) = search::stable_equilibrium(problem, scratch) {
        scratch.stable = true;
        let iterations = beyond.iterations + found.iterations;
        return Ok(Found { iterations, lost_at, ..found });
    }
    Err(match lost_at {
        Some(lost_at) => Failure::Buckled { lost_at, iterations: beyond.iterations },
        None => failure,
    })
}

/// Lengths that only the loaded rod can take: from the rod without load whose cables are loose.
fn from_loose_cables(problem: &Problem<'_>, scratch: &mut Scratch) -> Option<Found> {
    lengths::release(problem.commands, &mut scratch.tensions);
    set_tensions(problem.commands, &mut scratch.tensions);
    let Scratch { unloaded, tensions, .. } = scratch;
    unloaded.sweep(problem.grid, tensions, false, false).ok()?;
    scratch.unloaded.integrate(problem.grid, &mut scratch.poses);
    guess(problem, scratch, 1.0);
    let effort = shoot(problem, scratch, 1.0).ok()?;
    let found = finish(problem, scratch, effort);
    scratch.stable = is_accepted(problem, scratch);
    Some(found)
}

/// Whether the equilibrium in `scratch` is the answer on this grid.
fn is_accepted(problem: &Problem<'_>, scratch: &mut Scratch) -> bool {
    if problem.stability == StabilityCheck::AtAnswer {
        scratch.unverified = true;
        return true;
    }
    is_stable(problem, scratch)
}

/// Whether the answer in `scratch` is stable, where that is asked for and defined.
pub(super) fn is_stable(problem: &Problem<'_>, scratch: &mut Scratch) -> bool {
    if problem.stability == StabilityCheck::Off
        || scratch.applied.any_follower()
        || problem.is_only(&scratch.applied)
    {
        return true;
    }
    let sampled = sample(problem, scratch).is_ok();
    let Scratch { stability, trajectory, tensions, lengths, applied, .. } = scratch;
    let at = problem.equilibrium(&trajectory.samples, tensions, lengths, applied, 1.0);
    sampled && stability.is_stable(&at)
}

/// Stability of the answer in `scratch`, see [`super::stability`], or why it is not known.
pub(super) fn stability(
    problem: &Problem<'_>,
    analysis: StabilityAnalysis,
    scratch: &mut Scratch,
) -> Result<Result<Verdict, NoStability>, Failure> {
    if problem.stability == StabilityCheck::Off {
        return Ok(Err(NoStability::NotAsked));
    }
    if !scratch.applied.any() {
        let Scratch { unloaded, tensions, .. } = scratch;
        let least = unloaded.stability(problem.grid, tensions);
        return least
            .map(|least| Ok(Verdict::of_eigenvalue(least)))
            .map_err(|fault| Failure::of_section(fault, tensions, 0.0));
    }
    if scratch.applied.any_follower() {
        return Ok(Err(NoStability::Followers));
    }
    sample(problem, scratch).map_err(|fault| Failure::of_section(fault, &scratch.tensions, 1.0))?;
    let Scratch { stability, trajectory, tensions, lengths, applied, .. } = scratch;
    let at = problem.equilibrium(&trajectory.samples, tensions, lengths, applied, 1.0);
    Ok(stability.verdict(&at, analysis))
}
