//! Robots that keep clear of all obstacles on the way to their answer: it is that without obstacles.

use whipcord_numerics::Vec3;

use super::homotopy::Homotopy;
use super::model::is_near;
use super::scene::{DistanceBound, Scene};
use super::step_length::{SHORTENED, STRIDE, rounded};
use crate::budget::Meter;
use crate::case::Case;
use crate::error::{Obstruction, SolveError};
use crate::robot::Robot;
use crate::solution::Solution;

/// The most shapes on the way that are looked at.
const MOST_SHAPES: usize = 32;
/// The least step on the way.
const LEAST_STEP: f64 = 0.02;
/// Clearance that counts as none, as a part of the length: more than coarse steps and interpolation between them miss.
const MARGIN: f64 = 1e-3;

/// What a robot does without obstacles.
#[allow(clippy::large_enum_variant, reason = "one to a solve, taken apart where it is returned")]
pub(crate) enum FreeWay {
    /// Balls around its cross-sections stay clear of all obstacles on the way to this answer.
    Clear(Solution),
    /// They might not. Among obstacles this part of the way is the first step.
    Unclear {
        first_step: f64,
        /// What came of the case without obstacles, where it was solved.
        alone: Option<Result<Solution, SolveError>>,
    },
}

/// Nothing is known of the way.
const UNKNOWN: FreeWay = FreeWay::Unclear { first_step: 1.0, alone: None };
/// The least first step.
const LEAST_FIRST_STEP: f64 = 0.05;

/// A model that is solved without obstacles.
pub(crate) trait Unobstructed {
    /// Arc lengths in m at which the robot is watched, from base to tip.
    fn watched(&self) -> &[f64];

    /// Length of each cable before actuation in m.
    fn initial_lengths(&self) -> &[f64];

    /// What the solve has spent.
    fn meter(&mut self) -> &mut Meter;

    /// The answer to a case without obstacles, and the centres of the watched cross-sections in the frame of the base.
    fn solve(
        &mut self,
        case: &Case,
        from: Option<&Solution>,
        centres: &mut Vec<Vec3>,
    ) -> Result<Solution, SolveError>;

    /// Those centres alone, as coarse steps have them.
    fn look(&mut self, case: &Case, centres: &mut Vec<Vec3>) -> Result<(), SolveError>;

    /// Those of the robot at rest, which is what this case asks for.
    fn look_at_rest(&mut self, rest: &Case, centres: &mut Vec<Vec3>) -> Result<(), SolveError> {
        self.look(rest, centres)
    }
}

/// The answer to a case with obstacles, where balls around the cross-sections stay clear of them from rest, or from a
/// known answer without contacts, to it. Half of the budget is kept for contacts.
pub(crate) fn solve_free(
    model: &mut impl Unobstructed,
    robot: &Robot,
    case: &Case,
    warm_start: Option<&Solution>,
) -> Result<FreeWay, SolveError> {
    let budget = model.meter().hold_back_half();
    let way = look_for_free(model, robot, case, warm_start);
    model.meter().allow(budget);
    way
}

fn look_for_free(
    model: &mut impl Unobstructed,
    robot: &Robot,
    case: &Case,
    warm_start: Option<&Solution>,
) -> Result<FreeWay, SolveError> {
    let can_move = case.obstacles.iter().any(|obstacle| obstacle.movable.is_some());
    let has_history = !case.before.is_empty() && case.has_rubbing_obstacles();
    if can_move || has_history || warm_start.is_some_and(|answer| !answer.contacts.is_empty()) {
        return Ok(UNKNOWN);
    }
    let from = warm_start.filter(|answer| answer.cables.len() == case.commands.len());
    let homotopy = match from {
        Some(answer) => Homotopy::from_answer(answer, case),
        None => Homotopy::from_rest(case),
    };
    let initial = model.initial_lengths().to_vec();
    let clearance = Clearance::new(robot, case, model.watched());
    let mut start = Vec::new();
    let here = homotopy.at(0.0, &initial);
    let looked = match from {
        Some(_) => model.look(&here, &mut start),
        None => model.look_at_rest(&here, &mut start),
    };
    if !known(looked)? || !clearance.is_clear(&start) {
        return Ok(UNKNOWN);
    }
    let mut end = Vec::new();
    let answer = match model.solve(&homotopy.at(1.0, &initial), warm_start, &mut end) {
        Ok(answer) => answer,
        Err(error @ SolveError::Cancelled { .. }) => return Err(error),
        Err(error) => return Ok(FreeWay::Unclear { first_step: 1.0, alone: Some(Err(error)) }),
    };
    let diagnostics = &answer.diagnostics;
    if diagnostics.is_unstable() || diagnostics.stability_lost_at.is_some() {
        return Ok(FreeWay::Unclear { first_step: 1.0, alone: Some(Ok(answer)) });
    }
    let unclear = |answer: Solution, shape: &[Vec3], part: f64| {
        let mut first_step = clearance.first_step(&start, shape, part);
        if case.has_rubbing_obstacles() {
            first_step = rounded(0.0, first_step);
        }
        Ok(FreeWay::Unclear { first_step, alone: Some(Ok(answer)) })
    };
    if !clearance.is_clear(&end) {
        return unclear(answer, &end, 1.0);
    }
    // Shapes farther on the way, the next one last.
    let (mut here, mut ahead, mut shapes) = ((0.0, start.clone()), vec![(1.0, end)], 0);
    while let Some((way, centres)) = ahead.last() {
        if clearance.covers(&here.1, centres) {
            let Some(next) = ahead.pop() else { break };
            here = next;
            continue;
        }
        let middle = 0.5 * (here.0 + way);
        shapes += 1;
        if way - here.0 < LEAST_STEP || shapes > MOST_SHAPES {
            return unclear(answer, &ahead[0].1, 1.0);
        }
        let mut between = Vec::new();
        if !known(model.look(&homotopy.at(middle, &initial), &mut between))? {
            return unclear(answer, &ahead[0].1, 1.0);
        }
        if !clearance.is_clear(&between) {
            return unclear(answer, &between, middle);
        }
        ahead.push((middle, between));
    }
    Ok(FreeWay::Clear(answer))
}

/// What came of a solve among obstacles of a robot without history. Where the way ended at no equilibrium, and without obstacles there is no stable one
/// either, the error says so.
pub(crate) fn or_none_alone<T>(
    found: Result<T, SolveError>,
    case: &Case,
    solve_alone: impl FnOnce(&Case) -> Result<Solution, SolveError>,
) -> Result<T, SolveError> {
    let (reached, touching) = match found {
        Err(SolveError::Obstructed {
            reached,
            ref touching,
            why:
                Obstruction::Slips
                | Obstruction::Leaps
                | Obstruction::NotConverged { .. }
                | Obstruction::BudgetSpent { .. },
        }) => (reached, touching.clone()),
        _ => return found,
    };
    let alone = solve_alone(&Case { obstacles: Vec::new(), ..case.clone() });
    let lost_at = match alone {
        Ok(alone) if alone.diagnostics.is_unstable() => alone.diagnostics.stability_lost_at,
        Err(SolveError::Buckled { load, .. }) => Some(load),
        _ => return found,
    };
    Err(SolveError::Obstructed { reached, touching, why: Obstruction::NoneAlone { lost_at } })
}

/// What followed the steps of actuation of a robot whose cables rub in their holes among obstacles: the answers to the first of them, each with whether anything had
/// touched on the way to it, and what became of the others.
pub(crate) type Rubbed<T> = (Vec<(T, bool)>, Result<(), (usize, SolveError)>);

/// Gives the answers of such steps. Where nothing had touched, that without obstacles counts, whose substeps are as fine as they need be; `solve_free` gives
/// these answers to the steps of a case.
pub(crate) fn rubbing_or_free<T>(
    case: &Case,
    (found, followed): Rubbed<T>,
    solution_of: impl Fn(&T) -> &Solution,
    mut each: impl FnMut(T),
    solve_free: impl FnOnce(&Case, &mut dyn FnMut(T)) -> Result<(), (usize, SolveError)>,
) -> Result<(), (usize, SolveError)> {
    if let Err((_, SolveError::Cancelled { .. })) = followed {
        // A solve without obstacles would end as soon, at a step that was passed before.
        return followed;
    }
    let untouched = found.iter().take_while(|(_, has_touched)| !has_touched).count();
    let last = untouched.checked_sub(1);
    let steps = last.and_then(|last| match case.independent {
        true => case.single_steps().last(),
        false => case.step(last),
    });
    let mut free = Vec::with_capacity(untouched);
    let alone = steps.map(|steps| Case { obstacles: Vec::new(), ..steps });
    let solved = alone.map_or(Ok(()), |alone| solve_free(&alone, &mut |answer| free.push(answer)));
    let is_cancelled = matches!(solved, Err((_, SolveError::Cancelled { .. })));
    let known = if is_cancelled { free.len() } else { found.len() };
    let mut free = free.into_iter();
    for (solution, _) in found.into_iter().take(known) {
        let is_same = |free: &T| is_near(solution_of(free), solution_of(&solution));
        each(free.next().filter(is_same).unwrap_or(solution));
    }
    if is_cancelled { solved } else { followed }
}

/// The answers to all steps of a case without obstacles of a robot that remembers none of them, those that are asked for by their number from 0
/// with their derivatives, as `solve` finds them.
pub(crate) fn steps_alone<D>(
    case: &Case,
    asks: &dyn Fn(usize) -> bool,
    mut each: impl FnMut((Solution, Option<D>)),
    mut solve: impl FnMut(&Case, bool) -> Result<(Solution, Option<D>), SolveError>,
) -> Result<(), (usize, SolveError)> {
    let alone = Case { obstacles: Vec::new(), ..case.clone() };
    for (n, step) in alone.leading_steps().enumerate() {
        each(solve(&step, asks(n)).map_err(|error| (n, error))?);
    }
    Ok(())
}

/// The last answer of a solve of several steps.
pub(crate) fn last_of(
    solve: impl FnOnce(&mut dyn FnMut(Solution)) -> Result<(), (usize, SolveError)>,
) -> Result<Solution, SolveError> {
    let mut last = Err(SolveError::NoDerivatives);
    solve(&mut |solution| last = Ok(solution)).map_err(|(_, error)| error)?;
    last
}

/// Whether a shape is known; an error where the solve was ended from outside.
fn known(looked: Result<(), SolveError>) -> Result<bool, SolveError> {
    match looked {
        Ok(()) => Ok(true),
        Err(error @ SolveError::Cancelled { .. }) => Err(error),
        Err(_) => Ok(false),
    }
}

/// How far the balls around the watched cross-sections are from the obstacles.
struct Clearance {
    scene: Scene,
    length: f64,
    /// Between each watched place and the next in m; nothing beyond the tip.
    spacing: Vec<f64>,
    /// Radii in m of the balls that backbone and disks fit in.
    reach: Vec<f64>,
}

impl Clearance {
    fn new(robot: &Robot, case: &Case, watched: &[f64]) -> Self {
        let (backbone, disks) = (robot.backbone(), robot.disks());
        let of_place = |&s: &f64| {
            let at_disk = |&k: &usize| (disks.arc_lengths[k] - s).abs() <= 1e-9 * backbone.length;
            let disk = (1..disks.count()).filter(|_| disks.are_present).find(at_disk);
            let rim = disk.map_or(0.0, |k| disks.rim_radius(k));
            backbone.outer_radius_at(disks, s).max(rim)
        };
        Self {
            scene: Scene::new(case),
            length: backbone.length,
            spacing: watched.windows(2).map(|ends| ends[1] - ends[0]).chain([0.0]).collect(),
            reach: watched.iter().map(of_place).collect(),
        }
    }

    /// Whether nothing touches, between the watched places either: along the backbone a distance changes by no more than
    /// the way. The base is clamped and does not count.
    fn is_clear(&self, centres: &[Vec3]) -> bool {
        let margin = MARGIN * self.length;
        self.scene.iter().all(|(_, obstacle)| {
            let mut distance = DistanceBound::new(obstacle);
            let mut before = f64::INFINITY;
            (1..centres.len()).all(|k| {
                // A gap of more than both intervals beside it is enough, however near its neighbours are.
                let enough = margin.max(self.spacing[k - 1]).max(self.spacing[k]);
                let bound = distance.least(centres[k]) - self.reach[k];
                let is_far = bound > enough;
                let here =
                    if is_far { bound } else { distance.measure(centres[k]) - self.reach[k] };
                let is_clear = is_far || here > margin && before + here > self.spacing[k - 1];
                before = here;
                is_clear
            })
        })
    }

    /// The part of the way on which no cross-section moves too far at once, nor comes to touch, if it moves in a straight line to this shape,
    /// which is found after a part of the way; no more than that part.
    fn first_step(&self, start: &[Vec3], shape: &[Vec3], part: f64) -> f64 {
        let ways = start.iter().zip(shape).map(|(start, end)| (*end - *start).norm());
        let farthest = ways.fold(0.0, f64::max);
        let stride = SHORTENED * STRIDE * self.length / farthest;
        let mut touch = f64::INFINITY;
        for (_, obstacle) in self.scene.iter() {
            let mut distance = DistanceBound::new(obstacle);
            for (k, (start, end)) in start.iter().zip(shape).enumerate().skip(1) {
                if distance.least(*end) > self.reach[k] {
                    continue;
                }
                let [before, after] = [start, end].map(|at| distance.measure(*at) - self.reach[k]);
                if after < 0.0 && before > 0.0 {
                    touch = touch.min(before / (before - after));
                }
            }
        }
        (part * stride.min(touch).min(1.0)).max(LEAST_FIRST_STEP)
    }

    /// Whether the free balls around each centre before and after cover its way, eq. (7).
    fn covers(&self, before: &[Vec3], after: &[Vec3]) -> bool {
        let margin = MARGIN * self.length;
        let ways = || before.iter().zip(after).map(|(before, after)| (*after - *before).norm());
        ways().all(|way| way <= STRIDE * self.length)
            && self.scene.iter().all(|(_, obstacle)| {
                let mut distances = [DistanceBound::new(obstacle); 2];
                ways().zip(before.iter().zip(after)).all(|(way, (before, after))| {
                    let points = [*before, *after];
                    let room = |distances: &[DistanceBound<'_>; 2]| {
                        distances[0].least(points[0]) + distances[1].least(points[1])
                    };
                    way <= margin || room(&distances) >= way || {
                        let measured = [0, 1].map(|i| distances[i].measure(points[i]));
                        measured[0] + measured[1] >= way
                    }
                })
            })
    }
}

#[cfg(test)]
mod tests {
    use whipcord_numerics::{Pose, UnitQuaternion};

    use super::*;
    use crate::obstacle::{Form, Obstacle};
    use crate::robot::{Backbone, Cable, Disks, Routing};

    /// A ball of 0.1 m with its surface so far beside the tip of a straight robot of 1 m.
    fn first_step(gap: f64, way: f64, part: f64) -> (f64, f64) {
        let cable = Cable::new("0", Routing::Straight { angle: 0.0, radius: 0.01 });
        let disks = Disks::equally_spaced(1.0, 4, 0.01);
        let robot = Robot::new(Backbone::new(1.0), disks, vec![cable]).unwrap();
        let position = Vec3::new(gap + 0.1, 0.0, 1.0);
        let ball = Obstacle {
            name: "ball".to_owned(),
            form: Form::Sphere { radius: 0.1 },
            pose: Pose { position, rotation: UnitQuaternion::IDENTITY },
            friction: 0.0,
            movable: None,
        };
        let case = Case { obstacles: vec![ball], ..Case::with_tensions(&[1.0]) };
        let clearance = Clearance::new(&robot, &case, &[0.0, 0.5, 1.0]);
        let start = [0.0, 0.5, 1.0].map(|z| Vec3::new(0.0, 0.0, z));
        let end = [start[0], start[1], start[2] + Vec3::new(way, 0.0, 0.0)];
        (clearance.first_step(&start, &end, part), clearance.reach[2])
    }

    /// What ends a solve ends those without obstacles too, and these are of steps that were passed before.
    #[test]
    fn a_solve_that_is_cancelled_names_the_step_that_it_had_reached() {
        let step = |tension: f64| Case::with_tensions(&[tension]).commands;
        let case = Case { before: vec![step(1.0), step(2.0)], ..Case::with_tensions(&[3.0]) };
        let answer = || Solution::empty(crate::ModelKind::Cosserat);
        let end = |error: SolveError| {
            let found = vec![(answer(), false), (answer(), false)];
            let (mut given, mut solved) = (0, Vec::new());
            let told = rubbing_or_free(
                &case,
                (found, Err((2, error))),
                |solution| solution,
                |_| given += 1,
                |alone, each| {
                    solved.push(alone.before.len() + 1);
                    each(answer());
                    Err((1, SolveError::Cancelled { last_load: None }))
                },
            );
            (told, given, solved)
        };
        let cancelled = SolveError::Cancelled { last_load: Some(0.25) };
        assert_eq!(end(cancelled.clone()), (Err((2, cancelled)), 0, Vec::new()));
        // Cancelled later: the steps without obstacles, solved once for all.
        let cancelled = Err((1, SolveError::Cancelled { last_load: None }));
        assert_eq!(end(SolveError::TensionsNotFound), (cancelled, 1, vec![2]));
    }

    #[test]
    fn the_first_step_ends_where_the_robot_touches_or_goes_too_far() {
        assert_eq!(first_step(1.0, 0.0, 1.0).0, 1.0);
        assert_eq!(first_step(1.0, 0.2, 1.0).0, 1.0);
        assert_eq!(first_step(1.0, 0.2, 0.5).0, 0.5);
        assert!((first_step(1.0, 0.5, 1.0).0 - 0.45).abs() < 1e-12);
        let (step, reach) = first_step(0.04, 0.08, 0.5);
        assert!((step - 0.5 * (0.04 - reach) / 0.08).abs() < 1e-12);
        let (step, reach) = first_step(0.011, 0.2, 0.5);
        assert!(reach > 0.005 && step == LEAST_FIRST_STEP, "{reach}, {step}");
        // Where it touches from the start nothing is known.
        assert_eq!(first_step(-0.01, 0.2, 1.0).0, 1.0);
    }
}
