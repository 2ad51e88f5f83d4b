//! The choice among all commands that reach a target.

use whipcord::SolveError;
use whipcord_numerics::{Programme, QuadraticProgramme, SingularValues};

use crate::descent::{Control, Start, Workspace};
use crate::error::InverseError;
use crate::evaluation::Evaluation;
use crate::linear::Linear;
use crate::options::{Preference, ReachOptions};
use crate::search::{Candidate, Search};
use crate::target::Target;

/// The directions of the commands that do not move what a target is for.
#[derive(Clone, Debug)]
pub(crate) struct Redundancy {
    /// Orthonormal, in scaled unknowns, one after the other.
    directions: Vec<f64>,
    unknowns: usize,
}

/// A singular value that is this part of the largest is none.
const RANK: f64 = 1e-6;

impl Redundancy {
    /// `None` where every command moves it.
    pub fn of(
        evaluation: &Evaluation,
        target: &Target,
        lever: f64,
        scales: &[f64],
    ) -> Option<Self> {
        let mut linear = Linear::default();
        target.linearize(
            &evaluation.solution.disks.poses,
            &evaluation.rates.motions,
            lever,
            &mut linear,
        );
        let n = scales.len();
        for row in linear.jacobian.chunks_exact_mut(n) {
            row.iter_mut().zip(scales).for_each(|(j, scale)| *j *= scale);
        }
        let values = SingularValues::of(n, &linear.jacobian);
        let largest = values.values.first().copied().unwrap_or(0.0);
        let directions: Vec<f64> = (0..n)
            .filter(|&k| values.values[k] <= RANK * largest)
            .flat_map(|k| values.direction(k).to_vec())
            .collect();
        (!directions.is_empty()).then_some(Self { directions, unknowns: n })
    }

    /// Each direction by actuators.
    pub fn null_space(&self, scales: &[f64]) -> Vec<Vec<f64>> {
        let scaled = |direction: &[f64]| direction.iter().zip(scales).map(|(z, s)| z * s).collect();
        self.directions.chunks_exact(self.unknowns).map(scaled).collect()
    }
}

/// What is preferred, and from where.
pub(crate) struct Task<'a> {
    pub prefer: Preference,
    /// The commands that changes count from.
    pub start: &'a [f64],
    pub control: &'a Control<'a>,
    /// Steps along the null space.
    pub steps: usize,
    /// A gain of less than this part of what is to be small is the last.
    pub least_gain: f64,
}

/// A step of this size in scaled unknowns is none.
const LEAST_STEP: f64 = 1e-7;

impl Search<'_> {
    /// A better one of the commands that reach the target: steps of a quadratic programme in the null space of the target, each followed
    /// by a restoration of the target. `None` where none is better.
    ///
    /// Where answers depend on their commands alone the steps are those of the trials, and only what they lead to is solved from rest. If that is no
    /// answer, or if answers depend on more, each step is.
    ///
    /// # Errors
    /// [`InverseError::Solve`] where a solve was cancelled.
    pub fn improve(
        &mut self,
        from: &Candidate,
        task: &Task<'_>,
        workspace: &mut Workspace,
        options: &ReachOptions,
    ) -> Result<Option<Candidate>, InverseError> {
        let before = self.value(from, task);
        if self.is_smooth() {
            let trial =
                |search: &mut Self, start: Start<'_, Evaluation>, memory: &mut Workspace| {
                    search.restored(start, task.control, memory)
                };
            let Some(found) = self.descend_null_space(from, task, workspace, options, trial)?
            else {
                return Ok(None);
            };
            let start = Start::Known(&found.unknowns, &found.evaluation);
            match self.attempt(start, task.control, workspace, options) {
                Ok(answer) if answer.is_reached && self.value(&answer, task) < before => {
                    return Ok(Some(answer));
                }
                Err(error @ SolveError::Cancelled { .. }) => return Err(error.into()),
                _ => {}
            }
        }
        let solved = |search: &mut Self, start: Start<'_, Evaluation>, memory: &mut Workspace| {
            search.attempt(start, task.control, memory, options)
        };
        self.descend_null_space(from, task, workspace, options, solved)
    }

    /// The steps of [`Self::improve`], each restored as told. `None` where none is better.
    fn descend_null_space(
        &mut self,
        from: &Candidate,
        task: &Task<'_>,
        workspace: &mut Workspace,
        options: &ReachOptions,
        restore: impl Fn(
            &mut Self,
            Start<'_, Evaluation>,
            &mut Workspace,
        ) -> Result<Candidate, SolveError>,
    ) -> Result<Option<Candidate>, InverseError> {
        let scales = task.control.scales;
        let mut best = from.clone();
        let mut is_better = false;
        let mut radius = 1.0;
        let spent = self.forward.solves;
        for _ in 0..task.steps {
            let allowed = options.solves / 2;
            if self.forward.solves - spent > allowed {
                break;
            }
            let Some(along) = self.along_null_space(&best, task, radius) else { break };
            let size =
                along.iter().zip(scales).fold(0.0, |a: f64, (d, scale)| a.max((d / scale).abs()));
            let moved: Vec<f64> = best.unknowns.iter().zip(&along).map(|(x, d)| x + d).collect();
            let start = Start::From(&moved, (&best.unknowns, &best.evaluation));
            let next = match restore(self, start, workspace) {
                Ok(next) => next,
                Err(error @ SolveError::Cancelled { .. }) => return Err(error.into()),
                Err(_) => {
                    radius = 0.3 * size;
                    continue;
                }
            };
            let (before, after) = (self.value(&best, task), self.value(&next, task));
            if next.is_reached && after < before - 1e-10 * before.abs() {
                let gain = before - after;
                best = next;
                is_better = true;
                radius = (2.0 * radius).min(2.0);
                if gain < task.least_gain * before.abs() {
                    break;
                }
            } else {
                radius = 0.3 * size;
            }
        }
        Ok(is_better.then_some(best))
    }

    /// The step along the null space to what is preferred, no longer than a radius in scales; `None` where there is none to take.
    pub fn along_null_space(
        &self,
        from: &Candidate,
        task: &Task<'_>,
        radius: f64,
    ) -> Option<Vec<f64>> {
        if task.prefer == Preference::First {
            return None;
        }
        let scales = task.control.scales;
        let n = scales.len();
        let redundancy = Redundancy::of(&from.evaluation, self.target, self.lever, scales)?;
        let model = self.objective(from, task, &redundancy, radius);
        let mut step = Vec::new();
        QuadraticProgramme::default().minimise(&model.programme(), &mut step).ok()?;
        let along = &step[..model.directions];
        if along.iter().fold(0.0, |a: f64, y| a.max(y.abs())) < LEAST_STEP {
            return None;
        }
        let change = |k: usize| {
            let parts = along.iter().enumerate();
            parts.map(|(d, y)| y * redundancy.directions[d * n + k]).sum::<f64>() * scales[k]
        };
        Some((0..n).map(change).collect())
    }

    /// What the preference makes small.
    fn value(&self, candidate: &Candidate, task: &Task<'_>) -> f64 {
        match task.prefer {
            Preference::First => 0.0,
            Preference::LeastTension => {
                let square = |(tension, shortening): (&Option<f64>, &f64)| {
                    tension.map_or(shortening * shortening, |tension| tension * tension)
                };
                let evaluation = &candidate.evaluation;
                evaluation.tensions.iter().zip(&evaluation.shortenings).map(square).sum()
            }
            Preference::LeastChange => candidate
                .unknowns
                .iter()
                .zip(task.start)
                .zip(task.control.scales)
                .map(|((x, start), scale)| ((x - start) / scale).powi(2))
                .sum(),
            Preference::MostClearance => {
                -self.constraints.least_clearance(&candidate.evaluation.solution).unwrap_or(0.0)
            }
        }
    }

    /// The quadratic model of the preference in the null space, with the bounds and constraints as rows.
    fn objective(
        &self,
        at: &Candidate,
        task: &Task<'_>,
        redundancy: &Redundancy,
        radius: f64,
    ) -> Model {
        let scales = task.control.scales;
        let n = scales.len();
        let z = &redundancy.directions;
        let count = z.len() / n;
        let evaluation = &at.evaluation;
        // Linear forms whose squares are summed: value and rates by scaled unknowns.
        let mut squares: Vec<(f64, Vec<f64>)> = Vec::new();
        let rates = |rates: &[Vec<f64>], cable: usize| -> Vec<f64> {
            rates.iter().zip(scales).map(|(of, scale)| of[cable] * scale).collect()
        };
        match task.prefer {
            Preference::First | Preference::MostClearance => {}
            Preference::LeastTension => {
                for (cable, tension) in evaluation.tensions.iter().enumerate() {
                    squares.push(match tension {
                        Some(tension) => (*tension, rates(&evaluation.rates.tension_rates, cable)),
                        None => (
                            evaluation.shortenings[cable],
                            rates(&evaluation.rates.shortening_rates, cable),
                        ),
                    });
                }
            }
            Preference::LeastChange => {
                for k in 0..n {
                    let mut row = vec![0.0; n];
                    row[k] = 1.0;
                    squares.push(((at.unknowns[k] - task.start[k]) / scales[k], row));
                }
            }
        }
        let clears = task.prefer == Preference::MostClearance;
        let size = count + usize::from(clears);
        let onto = |row: &[f64]| -> Vec<f64> {
            let dot = |d: &[f64]| d.iter().zip(row).map(|(z, r)| z * r).sum();
            let mut projected: Vec<f64> = z.chunks_exact(n).map(dot).collect();
            projected.resize(size, 0.0);
            projected
        };
        let mut matrix = vec![0.0; size * size];
        let mut gradient = vec![0.0; size];
        for (value, row) in &squares {
            let projected = onto(row);
            for (a, pa) in projected.iter().enumerate() {
                gradient[a] += value * pa;
                for (b, pb) in projected.iter().enumerate() {
                    matrix[a * size + b] += pa * pb;
                }
            }
        }
        let trace: f64 = (0..size).map(|a| matrix[a * size + a]).sum();
        let floor = if trace > 0.0 { 1e-9 * trace } else { 1e-6 };
        for a in 0..size {
            matrix[a * size + a] += floor;
        }
        let mut rows = Vec::new();
        let mut limits = Vec::new();
        for (k, (x, [least, greatest])) in at.unknowns.iter().zip(task.control.bounds).enumerate() {
            let mut unit = vec![0.0; n];
            unit[k] = 1.0;
            let row = onto(&unit);
            rows.extend(&row);
            limits.push((greatest - x) / scales[k]);
            rows.extend(row.iter().map(|r| -r));
            limits.push((x - least) / scales[k]);
        }
        let mut linear = Linear::default();
        let first = self.target.places().len();
        self.constraints.linearize(self.forward.robot(), evaluation, first, &mut linear);
        let clearances = if clears { self.constraints.places().len() } else { 0 };
        let from = linear.slack.len() - clearances;
        for (number, (row, slack)) in linear.rows.chunks_exact(n).zip(&linear.slack).enumerate() {
            let scaled: Vec<f64> = row.iter().zip(scales).map(|(r, s)| r * s).collect();
            let mut row = onto(&scaled);
            if number >= from {
                // The least clearance t: t + rate ≤ slack.
                row[count] = 1.0;
            }
            rows.extend(row);
            limits.push(*slack);
        }
        let mut lower = vec![-radius; size];
        let mut upper = vec![radius; size];
        if clears {
            gradient[count] = -1.0;
            lower[count] = f64::NEG_INFINITY;
            upper[count] = f64::INFINITY;
        }
        Model { directions: count, matrix, gradient, lower, upper, rows, limits }
    }
}

/// A quadratic model of a preference.
struct Model {
    directions: usize,
    matrix: Vec<f64>,
    gradient: Vec<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    rows: Vec<f64>,
    limits: Vec<f64>,
}

impl Model {
    fn programme(&self) -> Programme<'_> {
        Programme {
            matrix: &self.matrix,
            gradient: &self.gradient,
            lower: &self.lower,
            upper: &self.upper,
            rows: &self.rows,
            limits: &self.limits,
        }
    }
}
