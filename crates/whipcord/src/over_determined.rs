//! Cable lengths that cannot be had together, met in the least-squares sense.
//!
//! Lengths `ℓᵢ*` contradict each other where no shape of the robot has them all: the lengths of three straight cables on a
//! backbone that does not get shorter have one sum, whatever the shape. What is asked for then is the limit, for `c → 0`, of the least of
//!
//! ```text
//! E + ½ Σ eᵢ²/c        over the shapes,   eᵢ = max(ℓᵢ − ℓᵢ*, 0)                          (7)
//! ```
//!
//! with the energy E of the robot and its loads. Its minimum is the stable equilibrium of the same robot whose cables give by `c` under
//! 1 N, where `eᵢ = c τᵢ`. As `c` falls, `½ Σ eᵢ²` exceeds its least value by no more than `c` times a difference of energies, so that the `eᵢ` tend to the least squares
//! by which the lengths must be missed, and of all shapes that miss them so little the limit has the least energy.
//!
//! The tensions `eᵢ/c` grow beyond any bound, and between disks cables that are straight there would buckle the backbone. So (7) is followed only until the
//! `eᵢ` have a limit, or to the last `c` at which the backbone bears its tensions: the limit is then that of the values of `c` between which it changed least.
//! In the end the lengths `ℓᵢ* + eᵢ` are prescribed to cables that give by next to nothing.

use crate::case::{Case, Shortening};
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::length_miss::LengthMiss;
use crate::model::Model;
use crate::robot::Robot;
use crate::section::section_stiffness;
use crate::solution::Solution;
use crate::statics::command::Command;

/// What the cables give, relative to what the backbone does by bending: at first, and by which factor it falls.
const FIRST: f64 = 0.25;
const RATIO: f64 = 0.5;
const LEVELS: usize = 12;
/// In the end.
const LAST: f64 = 1e-4;
/// The limit is that of the polynomial in `c` through so many of the last values.
const THROUGH: usize = 5;
/// The limit is known when it changes by less than this of its largest entry. Where the robot does not bear the tensions of a smaller `c`, it is the one that
/// changed least, by less than the other.
const CONVERGED: f64 = 1e-4;
const ROUGHLY_CONVERGED: f64 = 0.1;
/// A cable takes part when it misses its length by more than this of the largest miss.
const TAKES_PART: f64 = 1e-2;
/// Greatest miss as a part of the length of the backbone: beyond it the commands are wrong, and no shape is an answer to them.
pub const GREATEST_MISS: f64 = 0.05;

/// Robot and case in place of those whose lengths contradict each other: an answer to them is the least-squares answer.
#[derive(Clone, Debug)]
pub struct Relaxed {
    /// Its cables give by next to nothing.
    pub robot: Robot,
    /// Each cable may miss its length.
    pub case: Case,
    /// By how much in m, for each cable; 0 for those that take no part.
    pub misses: Vec<f64>,
    /// The last answer on the way.
    near: Solution,
}

/// Whether lengths that contradict each other may be why there is no answer.
#[must_use]
pub const fn may_be(error: &SolveError) -> bool {
    matches!(
        error,
        SolveError::ContradictoryLengths { .. }
            | SolveError::UnreachableLength { .. }
            | SolveError::TensionsNotFound
            | SolveError::SectionFolds { .. }
            | SolveError::NotConverged { .. }
            | SolveError::Buckled { .. }
    )
}

/// A limit of the misses, and how much it changed with the last value of `c`.
struct MissLimit {
    change: f64,
    misses: Vec<f64>,
    near: Solution,
}

/// Robot and case that lead to the least-squares answer of a single step. `None` where the lengths do not contradict each other, where one would be missed by more
/// than [`GREATEST_MISS`], and where the misses have no limit that the model finds.
#[must_use]
pub fn relaxed(model: &Model, robot: &Robot, case: &Case) -> Option<Relaxed> {
    let scale = bending_compliance(robot)?;
    let mut last: Option<Solution> = None;
    let (mut known, mut limit) = (Vec::<(f64, Vec<f64>)>::new(), None::<Vec<f64>>);
    let mut best: Option<MissLimit> = None;
    let mut give = FIRST * scale;
    for _ in 0..LEVELS {
        let softened = robot.giving(give);
        let Ok(mut prepared) = model.prepare(&softened, &case.loads) else { break };
        let Ok(solution) = prepared.solve(case, last.as_ref()) else { break };
        if solution.diagnostics.is_unstable() {
            break;
        }
        known.push((give, misses(model, robot, case, &solution)?));
        let next = without_compliance(&known[known.len().saturating_sub(THROUGH)..]);
        if let Some(limit) = limit.filter(|_| known.len() > 2) {
            let moved = next.iter().zip(&limit).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            let change = moved / greatest(&next);
            // Before the backbone buckles between its disks it bends there, and lets the lengths contradict each other less.
            if change.is_finite() && best.as_ref().is_none_or(|best| change < best.change) {
                best = Some(MissLimit { change, misses: next.clone(), near: solution.clone() });
            }
            if change <= CONVERGED {
                break;
            }
        }
        limit = Some(next);
        last = Some(solution);
        give *= RATIO;
    }
    let MissLimit { mut misses, near, .. } =
        best.filter(|best| best.change <= ROUGHLY_CONVERGED)?;
    let most = greatest(&misses);
    misses.iter_mut().filter(|miss| **miss <= TAKES_PART * most).for_each(|miss| *miss = 0.0);
    let several = misses.iter().filter(|miss| **miss > 0.0).count() >= 2;
    if !several || most > GREATEST_MISS * robot.backbone().length {
        return None;
    }
    let mut case = case.clone();
    for ((command, state), miss) in case.commands.iter_mut().zip(&near.cables).zip(&misses) {
        if *miss > 0.0
            && let Some(shortening) = command.shortening
        {
            let shortening = shortening.in_metres(state.initial_length) - miss;
            command.shortening = Some(Shortening::Length(shortening));
        }
    }
    Some(Relaxed { robot: robot.giving(LAST * scale), case, misses, near })
}

/// The least-squares answer to a single step whose lengths contradict each other, with what each cable that takes part misses
/// ([`Diagnostics::length_misses`](crate::Diagnostics::length_misses)): a stable equilibrium whose misses are those of the limit. The tensions of these
/// cables are not determined, as they pull against each other, and are left out.
///
/// `None` where [`relaxed`] finds nothing, where the shape is not known to be stable, or where it misses the lengths by other amounts.
#[must_use]
pub fn solve(model: &Model, robot: &Robot, case: &Case) -> Option<Solution> {
    let Relaxed { robot: softened, case: relaxed, misses: limit, near } =
        relaxed(model, robot, case)?;
    let mut prepared = model.prepare(&softened, &relaxed.loads).ok()?;
    let mut solution = prepared.solve(&relaxed, Some(&near)).ok()?;
    // Eq. (6) of an arc is convex: what meets its conditions is its minimum.
    let is_convex = model.kind() == ModelKind::ConstantCurvature;
    if solution.diagnostics.stable != Some(true) && !is_convex {
        return None;
    }
    let missed = misses(model, robot, case, &solution)?;
    let most = greatest(&limit);
    let off = missed.iter().zip(&limit).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    if off > ROUGHLY_CONVERGED * most {
        return None;
    }
    solution.diagnostics.length_misses.clear();
    for ((state, excess), limit) in solution.cables.iter_mut().zip(missed).zip(limit) {
        if limit > 0.0 {
            state.tension = None;
            state.slack = false;
            solution
                .diagnostics
                .length_misses
                .push(LengthMiss { cable: state.name.clone(), excess });
        }
    }
    Some(solution)
}

/// What a solve found, or [`solve`] where it failed or found a shape that the robot leaves, and lengths that contradict each other may be why: cables that pull against each other by
/// all that it takes to have their lengths make a shape unstable, too.
///
/// # Errors
/// The error of the solve, where there is no least-squares answer.
pub fn or(
    found: Result<Solution, SolveError>,
    model: &Model,
    robot: &Robot,
    case: &Case,
) -> Result<Solution, SolveError> {
    let is_doubtful = match &found {
        Ok(solution) => solution.diagnostics.is_unstable(),
        Err(error) => may_be(error),
    };
    match is_doubtful.then(|| solve(model, robot, case)).flatten() {
        Some(solution) => Ok(solution),
        None => found,
    }
}

/// What the polynomials in `c` through these misses of the cables are at `c = 0` (Neville), not negative.
fn without_compliance(known: &[(f64, Vec<f64>)]) -> Vec<f64> {
    let cables = known.first().map_or(0, |(_, misses)| misses.len());
    let of_cable = |cable: usize| {
        let mut values: Vec<f64> = known.iter().map(|(_, misses)| misses[cable]).collect();
        for width in 1..values.len() {
            for i in 0..values.len() - width {
                let (a, b) = (known[i].0, known[i + width].0);
                values[i] = (a * values[i + 1] - b * values[i]) / (a - b);
            }
        }
        values.first().map_or(0.0, |value| value.max(0.0))
    };
    (0..cables).map(of_cable).collect()
}

/// How much in m each cable that does not stretch is longer than prescribed; `None` where a cable has no command.
fn misses(model: &Model, robot: &Robot, case: &Case, solution: &Solution) -> Option<Vec<f64>> {
    let of = |(i, state): (usize, &crate::solution::CableState)| {
        let initial = state.initial_length;
        let command = Command::of(model.kind(), robot, i, case, model.actuation(), initial).ok()?;
        Some(match command {
            Command::Length { target, compliance: 0.0 } => (state.length - target).max(0.0),
            _ => 0.0,
        })
    };
    solution.cables.iter().enumerate().map(of).collect()
}

fn greatest(misses: &[f64]) -> f64 {
    misses.iter().fold(0.0, |greatest, miss| miss.max(greatest))
}

/// What a tension of 1 N takes off the length of a cable by bending the backbone, in m: `r² L/EI` with the mean distance r of the cables from the axis at the
/// base.
fn bending_compliance(robot: &Robot) -> Option<f64> {
    let length = robot.backbone().length;
    let stiffness = section_stiffness(robot, 0.0, 0.5 * length).ok()?;
    let bending = 0.5 * (stiffness[3][3] + stiffness[4][4]);
    let routes = robot.routes();
    let squares: f64 = routes
        .iter()
        .map(|route| {
            let at = route.at(0.0).offset;
            at.x * at.x + at.y * at.y
        })
        .sum();
    let compliance = squares / routes.len() as f64 * length / bending;
    (compliance.is_finite() && compliance > 0.0).then_some(compliance)
}
