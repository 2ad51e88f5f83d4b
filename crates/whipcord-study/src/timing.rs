//! How long something takes.

use std::num::NonZero;
use std::time::{Duration, Instant};

use whipcord::{Cable, Case, Model, Robot, Shape, Solution, SolveError, over_determined};

use crate::statistics::median;

/// A time and how it was measured.
#[derive(Clone, Copy, Debug)]
pub struct Timing {
    /// Median in s.
    pub median: f64,
    /// Repeats it is the median of.
    pub repeats: usize,
}

/// A case solved, and how long it took.
#[derive(Clone, Debug)]
pub struct TimedSolution {
    /// The answer, after the last step where there are several.
    pub solution: Solution,
    /// One cold solve by the model, which is built; of several steps the last one, or the mean of those that are found together.
    pub solve: Timing,
    /// Building the model for the robot, once.
    pub build: Timing,
    /// The answers to all steps, the last one included, and how long each took in s; none where the
    /// case is a single step.
    pub steps: Vec<(Solution, f64)>,
}

/// A solve is repeated this often,
const REPEATS: usize = 101;
/// unless that takes longer.
const BUDGET: Duration = Duration::from_millis(10);
/// What the repeats of a model may take over all cases: the median over so many cases needs no repeats of each.
const BUDGET_OF_ALL: Duration = Duration::from_millis(200);

/// In how many threads so many cases are solved: in one, as it is times that count, unless they are so many that each is timed for a moment.
pub fn threads(cases: usize) -> Option<NonZero<usize>> {
    (budget(cases) == BUDGET).then_some(NonZero::<usize>::MIN)
}

/// How long the time of one model may be measured on one of so many cases.
pub fn budget(cases: usize) -> Duration {
    BUDGET.min(BUDGET_OF_ALL / u32::try_from(cases.max(1)).unwrap_or(u32::MAX))
}

/// Solves a case: a single step from cold, several times for its time's sake; several steps once, each
/// from where the one before left the robot.
///
/// # Errors
/// [`SolveError`] when the model cannot take the robot or the case, or finds no answer, and the number of
/// the step, from 0.
pub fn solve(
    model: &Model,
    robot: &Robot,
    case: &Case,
) -> Result<TimedSolution, (usize, SolveError)> {
    solve_within(BUDGET, model, robot, case)
}

/// As [`solve`], with repeats only as long as this [`budget`] lasts.
///
/// # Errors
/// As [`solve`].
pub fn solve_within(
    budget: Duration,
    model: &Model,
    robot: &Robot,
    case: &Case,
) -> Result<TimedSolution, (usize, SolveError)> {
    let (prepared, build) = measure(budget, REPEATS, || model.prepare(robot, &case.loads));
    let mut prepared = prepared.map_err(|error| (0, error))?;
    let mut steps = Vec::new();
    if !case.before.is_empty() {
        let mut begun = Instant::now();
        prepared.solve_steps(case, |solution| {
            steps.push((solution, begun.elapsed().as_secs_f64()));
            begun = Instant::now();
        })?;
    }
    // Among obstacles a robot whose cables rub has all steps found before the first is told.
    let rubs = robot.cables().iter().any(Cable::has_friction);
    let mut repeats = 1;
    if rubs && !case.obstacles.is_empty() && !case.independent && !steps.is_empty() {
        repeats = steps.len();
        let mean = steps.iter().map(|(_, time)| time).sum::<f64>() / repeats as f64;
        steps.iter_mut().for_each(|(_, time)| *time = mean);
    }
    if let Some((solution, time)) = steps.last() {
        let solve = Timing { median: *time, repeats };
        return Ok(TimedSolution { solution: solution.clone(), solve, build, steps });
    }
    let (solution, solve) = measure(budget, REPEATS, || prepared.solve(case, None));
    let solution = solution.map_err(|error| (0, error))?;
    Ok(TimedSolution { solution, solve, build, steps })
}

/// As [`solve`]; steps whose cable lengths contradict each other have their least-squares answer. With friction, and after
/// a step that has none, there is no such answer.
///
/// # Errors
/// As [`solve`].
pub fn solve_in_least_squares(
    model: &Model,
    robot: &Robot,
    case: &Case,
) -> Result<TimedSolution, (usize, SolveError)> {
    let of_step = |error: &(usize, SolveError)| over_determined::may_be(&error.1);
    let is_unstable = |of: &&Solution| of.diagnostics.is_unstable();
    let found = solve(model, robot, case);
    let is_doubtful = match &found {
        Ok(found) => found.answers().iter().any(is_unstable),
        Err(error) => of_step(error),
    };
    if robot.has_history() || !is_doubtful {
        return found;
    }
    let (prepared, build) = measure(BUDGET, REPEATS, || model.prepare(robot, &case.loads));
    let mut prepared = prepared.map_err(|error| (0, error))?;
    let mut steps: Vec<(Solution, f64)> = Vec::new();
    for (number, step) in case.single_steps().enumerate() {
        let begun = Instant::now();
        let near = steps.last().map(|(solution, _)| solution).filter(|_| !case.independent);
        let solved = over_determined::or(prepared.solve(&step, near), model, robot, &step);
        let solution = solved.map_err(|error| (number, error))?;
        steps.push((solution, begun.elapsed().as_secs_f64()));
    }
    let Some((solution, median)) = steps.last().cloned() else {
        return Err((0, SolveError::TensionsNotFound));
    };
    if case.before.is_empty() {
        steps.clear();
    }
    Ok(TimedSolution { solution, solve: Timing { median, repeats: 1 }, build, steps })
}

impl TimedSolution {
    /// The answers to all steps in order; one where the case is a single step.
    pub fn answers(&self) -> Vec<&Solution> {
        match self.steps.as_slice() {
            [] => vec![&self.solution],
            steps => steps.iter().map(|(solution, _)| solution).collect(),
        }
    }
}

/// Shapes that are further apart than this share of the length are two answers.
const SAME_SHAPE: f64 = 1e-3;

impl TimedSolution {
    /// The shapes of all answers, the last step's being last, at the stations of `model`, which else is
    /// the one that gave them: each is solved for from its answer. `None` in place of one that is not
    /// found there, as where stations that lie closer change the steps of an equilibrium that hardly holds.
    pub fn shapes_at_stations_of(
        &self,
        model: &Model,
        robot: &Robot,
        case: &Case,
    ) -> Vec<Option<Shape>> {
        self.shapes_from(0, model, robot, case)
    }

    /// The last of [`Self::shapes_at_stations_of`]: without history no other step is solved for it.
    pub fn last_shape_at_stations_of(
        &self,
        model: &Model,
        robot: &Robot,
        case: &Case,
    ) -> Option<Shape> {
        let last = self.answers().len() - 1;
        self.shapes_from(last, model, robot, case).pop().flatten()
    }

    /// The shapes of the answers from that of the step `first` on, counted from 0; before them `None` for those of earlier steps, unless all
    /// have to be solved.
    fn shapes_from(
        &self,
        first: usize,
        model: &Model,
        robot: &Robot,
        case: &Case,
    ) -> Vec<Option<Shape>> {
        let answers = self.answers();
        let mut found: Vec<Option<Solution>> = Vec::with_capacity(answers.len());
        if let Ok(mut prepared) = model.prepare(robot, &case.loads) {
            if robot.has_history() && answers.len() > 1 {
                // With friction, an answer is that of all steps before it.
                let _ = prepared.solve_steps(case, |solution| found.push(Some(solution)));
            } else {
                found.resize(first, None);
                let of_steps = case.single_steps().zip(&answers).skip(first);
                found.extend(
                    of_steps.map(|(step, answer)| prepared.solve(&step, Some(answer)).ok()),
                );
            }
        }
        found.resize(answers.len(), None);
        let near = SAME_SHAPE * robot.backbone().length;
        found
            .into_iter()
            .zip(answers)
            .map(|(found, answer)| {
                let same = |f: &Solution| f.disks.distances(&answer.disks).all(|d| d <= near);
                found.filter(same).map(|found| found.shape)
            })
            .collect()
    }
}

/// Runs `work` and measures it. It is repeated up to `most` times, as long as `budget` lasts: a slow
/// solve is measured once.
fn measure<T>(budget: Duration, most: usize, mut work: impl FnMut() -> T) -> (T, Timing) {
    let begun = Instant::now();
    let mut result = work();
    let mut times = vec![begun.elapsed().as_secs_f64()];
    while times.len() < most && begun.elapsed() < budget {
        let start = Instant::now();
        result = work();
        times.push(start.elapsed().as_secs_f64());
    }
    let repeats = times.len();
    (result, Timing { median: median(&mut times), repeats })
}

/// A duration in s, in the unit that suits it.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 1e-3 => format!("{:.1} µs", s * 1e6),
        s if s < 1.0 => format!("{:.2} ms", s * 1e3),
        s => format!("{s:.2} s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_budget_bounds_the_repeats() {
        let mut count = 0;
        let slow = || {
            count += 1;
            std::thread::sleep(Duration::from_millis(5));
        };
        let ((), timing) = measure(Duration::from_millis(1), 100, slow);
        assert_eq!((timing.repeats, count), (1, 1));
        assert!(timing.median >= 5e-3);
        let ((), timing) = measure(Duration::from_secs(1), 7, || ());
        assert_eq!(timing.repeats, 7);
    }

    #[test]
    fn durations_take_a_fitting_unit() {
        let words = [4.04e-6, 0.0123, 10.07].map(duration);
        assert_eq!(words, ["4.0 µs", "12.30 ms", "10.07 s"]);
    }
}
