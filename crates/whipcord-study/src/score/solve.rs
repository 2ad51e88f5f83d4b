//! The answers of the models to all measured rows, in pieces that may be solved in any order.

use std::ops::Range;

use whipcord::{
    Actuation, Cancel, Case, LengthMiss, Model, ModelKind, Pose, Prepared, Robot, Solution,
    SolveError, Stations, over_determined,
};
use whipcord_estimation::observation::in_space;
use whipcord_io::CaseFile;

use crate::failure::refuses;

/// Rows that are solved one after the other by one model that is built once.
const ROWS: usize = 16;
/// Rows without an answer after which a robot with friction is not followed further: each asks for all rows before it again.
const MOST_FAILED: usize = 20;

/// A file, and where and when its robot was measured.
#[derive(Clone, Debug)]
pub struct Subject<'a> {
    /// What the file says.
    pub file: &'a CaseFile,
    /// Arc lengths of all that was measured, increasing.
    pub stations: Vec<f64>,
    /// The rows, from 0, in which something was measured, increasing.
    pub rows: Vec<usize>,
}

/// Rows of one file for one model.
#[derive(Clone, Debug)]
pub struct Job {
    /// Number of the file.
    pub file: usize,
    /// The model.
    pub model: ModelKind,
    /// Which of [`Subject::rows`].
    rows: Range<usize>,
}

/// What a model says of one row: frames at the stations, and whether the equilibrium is unstable.
#[derive(Clone, Debug)]
pub struct SolvedRow {
    /// At [`Subject::stations`].
    pub poses: Vec<Pose>,
    /// Whether the robot leaves this shape.
    pub unstable: bool,
    /// Cables whose lengths contradict each other, and what each misses in the least-squares answer.
    pub misses: Vec<LengthMiss>,
}

/// Why a row has no answer.
#[derive(Clone, Debug, PartialEq)]
pub enum Unsolved {
    /// The model has none.
    Failed(SolveError),
    /// Too many rows before it have none.
    NotReached,
}

/// Rows, from 0, with what a model says of each.
pub type Answers = Vec<(usize, Result<SolvedRow, Unsolved>)>;

impl<'a> Subject<'a> {
    /// Of a file.
    #[must_use]
    pub fn new(file: &'a CaseFile) -> Self {
        let disks = file.robot.disks();
        let measured = file.measured.iter();
        let seen = || measured.clone().flat_map(|measured| in_space(&measured.observations));
        let turned = || measured.clone().flat_map(|measured| &measured.rotations);
        let places = seen().map(|(seen, _)| seen.place).chain(turned().map(|of| of.place));
        let mut stations: Vec<f64> = places.map(|place| place.arc_length(disks)).collect();
        stations.sort_by(f64::total_cmp);
        stations.dedup();
        let steps = seen().map(|(seen, _)| seen.step).chain(turned().map(|of| of.step));
        let mut rows: Vec<usize> = steps.collect();
        rows.sort_unstable();
        rows.dedup();
        Self { file, stations, rows }
    }

    /// The disks, from 0, at which everything was measured; `None` where something was measured between disks.
    fn disks(&self) -> Option<Vec<usize>> {
        let at = &self.file.robot.disks().arc_lengths;
        self.stations.iter().map(|station| at.iter().position(|s| s == station)).collect()
    }

    /// Whether the answer to a row depends on the rows before it.
    fn is_in_order(&self) -> bool {
        !self.file.case.before.is_empty() && !self.file.case.independent
    }
}

impl Job {
    /// All that is to be solved.
    #[must_use]
    pub fn all(subjects: &[Subject<'_>], models: &[ModelKind]) -> Vec<Self> {
        let mut jobs = Vec::new();
        for (file, subject) in subjects.iter().enumerate() {
            let count = subject.rows.len();
            for &model in models {
                if subject.is_in_order() {
                    jobs.push(Self { file, model, rows: 0..count });
                    continue;
                }
                for first in (0..count).step_by(ROWS) {
                    jobs.push(Self { file, model, rows: first..(first + ROWS).min(count) });
                }
            }
        }
        jobs
    }

    /// The answers, until the flag is set. Known answers at the disks to all rows are taken where rows are solved by themselves.
    #[must_use]
    pub fn solve(
        &self,
        subject: &Subject<'_>,
        known: Option<&[Solution]>,
        cancel: &Cancel,
    ) -> Answers {
        let rows = &subject.rows[self.rows.clone()];
        let stations = Stations::At(subject.stations.clone());
        let model = Model::new(self.model, stations, Actuation::Natural).cancelled_by(cancel);
        let (robot, case) = (&subject.file.robot, &subject.file.case);
        let known = known.filter(|_| !subject.is_in_order());
        if let Some((known, disks)) = known.zip(subject.disks())
            && known.len() == case.before.len() + 1
            && !known.iter().any(|answer| answer.diagnostics.is_unstable())
        {
            let of = |row: &usize| (*row, Ok(SolvedRow::at_disks(&known[*row], &disks)));
            return rows.iter().map(of).collect();
        }
        let mut prepared = match model.prepare(robot, &case.loads) {
            Ok(prepared) => prepared,
            Err(error) => {
                let all = rows.iter().map(|row| (*row, Err(Unsolved::Failed(error.clone()))));
                return all.collect();
            }
        };
        if !subject.is_in_order() {
            let steps = rows.iter().filter_map(|row| match case.before.len() {
                0 => Some((*row, case.clone())),
                _ => Some((*row, case.independent_step(*row)?)),
            });
            // Where the lengths of one row contradict each other those of the others mostly do, and what finds that is quicker.
            let mut contradict = false;
            let solve = |(row, step): (usize, Case)| {
                let compromise =
                    contradict.then(|| over_determined::solve(&model, robot, &step)).flatten();
                let solved = compromise.map_or_else(
                    || over_determined::or(prepared.solve(&step, None), &model, robot, &step),
                    Ok,
                );
                let misses = |of: &Solution| !of.diagnostics.length_misses.is_empty();
                contradict = solved.as_ref().is_ok_and(misses);
                (row, solved.map(|solution| SolvedRow::of(&solution)).map_err(Unsolved::Failed))
            };
            return steps.map(solve).collect();
        }
        let last = rows.last().copied().unwrap_or(0);
        let mut found = if robot.has_history() {
            with_memory(&mut prepared, case, last)
        } else {
            from_row_to_row(&mut prepared, (&model, robot, case), last)
        };
        rows.iter()
            .map(|row| {
                (
                    *row,
                    found.get_mut(*row).and_then(Option::take).unwrap_or(Err(Unsolved::NotReached)),
                )
            })
            .collect()
    }
}

impl SolvedRow {
    /// Of an answer at these disks.
    fn at_disks(solution: &Solution, disks: &[usize]) -> Self {
        Self {
            poses: disks.iter().map(|disk| solution.disks.poses[*disk]).collect(),
            unstable: solution.diagnostics.is_unstable(),
            misses: solution.diagnostics.length_misses.clone(),
        }
    }

    fn of(solution: &Solution) -> Self {
        Self {
            poses: solution.shape.poses.clone(),
            unstable: solution.diagnostics.is_unstable(),
            misses: solution.diagnostics.length_misses.clone(),
        }
    }
}

type Row = Option<Result<SolvedRow, Unsolved>>;

/// The rows up to `last`, each from the answer to the last one before it that has one, else from cold.
fn from_row_to_row(
    prepared: &mut Prepared,
    (model, robot, case): (&Model, &Robot, &Case),
    last: usize,
) -> Vec<Row> {
    let mut rows = Vec::with_capacity(last + 1);
    let mut before: Option<Solution> = None;
    for step in case.single_steps().take(last + 1) {
        let mut solved = prepared.solve(&step, before.as_ref());
        if before.is_some() && solved.as_ref().is_err_and(|error| !refuses(error)) {
            solved = prepared.solve(&step, None);
        }
        let solved = over_determined::or(solved, model, robot, &step);
        rows.push(Some(match solved {
            Ok(solution) => {
                let row = SolvedRow::of(&solution);
                if solution.diagnostics.length_misses.is_empty() {
                    before = Some(solution);
                }
                Ok(row)
            }
            Err(error) => Err(Unsolved::Failed(error)),
        }));
    }
    rows
}

/// The rows up to `last` of a robot whose cables remember. One without an answer is left out of the history of those after it.
fn with_memory(prepared: &mut Prepared, case: &Case, last: usize) -> Vec<Row> {
    let mut rows: Vec<Row> = vec![None; last + 1];
    let mut kept: Vec<usize> = (0..=last).collect();
    let Some(mut case) = case.step(last) else { return rows };
    let mut failed = 0;
    loop {
        let mut place = 0;
        let outcome = prepared.solve_steps(&case, |solution| {
            rows[kept[place]] = Some(Ok(SolvedRow::of(&solution)));
            place += 1;
        });
        let Err((place, error)) = outcome else { return rows };
        failed += 1;
        let is_final = refuses(&error) || matches!(error, SolveError::Cancelled { .. });
        rows[kept[place]] = Some(Err(Unsolved::Failed(error)));
        if is_final || failed >= MOST_FAILED || kept.len() == 1 {
            return rows;
        }
        let earlier = case.motors.len().saturating_sub(kept.len());
        kept.remove(place);
        if !case.motors.is_empty() {
            case.motors.remove(earlier + place);
        }
        if place < case.before.len() {
            case.before.remove(place);
            if !case.loads_before.is_empty() {
                case.loads_before.remove(place);
            }
        } else if let Some(commands) = case.before.pop() {
            case.commands = commands;
            case.loads = case.loads_before.pop().unwrap_or(case.loads);
        }
    }
}
