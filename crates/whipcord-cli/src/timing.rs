//! How long something takes.

use std::time::{Duration, Instant};

use whipcord::{Case, Model, Robot, Solution, SolveError};

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
    /// The answer.
    pub solution: Solution,
    /// One cold solve by the model, which is built.
    pub solve: Timing,
    /// Building the model for the robot, once.
    pub build: Timing,
}

/// A solve is repeated this often,
const REPEATS: usize = 101;
/// unless that takes longer.
const BUDGET: Duration = Duration::from_millis(10);

/// Solves a case from cold, several times for its time's sake.
///
/// # Errors
/// [`SolveError`] when the model cannot take the robot or the case, or finds no answer.
pub fn solve(model: &Model, robot: &Robot, case: &Case) -> Result<TimedSolution, SolveError> {
    let (prepared, build) = measure(BUDGET, REPEATS, || model.prepare(robot, &case.loads));
    let mut prepared = prepared?;
    let (solution, solve) = measure(BUDGET, REPEATS, || prepared.solve(case, None));
    Ok(TimedSolution { solution: solution?, solve, build })
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
