//! The answers to the rows of a part.

use whipcord::batch::{Batch, BatchError, BatchOptions, Rows, solve_batch};
use whipcord::jobs::share;
use whipcord::{Actuation, Case, Prepared, SolveError};
use whipcord_io::CaseFile;

use crate::error::SweepError;
use crate::outputs::Output;
use crate::plan::{Plan, blank, driven};
use crate::setter::What;

/// The rows of a part.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    pub first: u64,
    pub rows: usize,
    /// Rows × axes, in the units of the axes.
    pub inputs: Vec<f64>,
    pub answers: Answers,
}

/// What became of rows.
#[derive(Clone, Debug, Default)]
pub(crate) struct Answers {
    /// The numbers of each column; NaN in a row without an answer.
    pub columns: Vec<Vec<f64>>,
    /// Of each row whether its equilibrium is stable, where that was asked for and is known; empty where it was not.
    pub stable: Vec<Option<bool>>,
    /// The rows without an answer by their place, ascending, and why they have none.
    pub failures: Vec<(usize, String)>,
}

/// Whether an equilibrium is stable, where that was asked for and is known; or why there is no answer.
type Outcome = Result<Option<bool>, String>;

impl Answers {
    fn set(&mut self, row: usize, outcome: Outcome) {
        match outcome {
            Ok(stable) => {
                if let Some(of_row) = self.stable.get_mut(row) {
                    *of_row = stable;
                }
            }
            Err(why) => self.failures.push((row, why)),
        }
    }
}

impl Plan {
    /// The answers to so many rows from a first one.
    pub(crate) fn solve(&self, (first, count): (u64, u64)) -> Result<Part, SweepError> {
        let width = self.samples.axes().len();
        #[expect(clippy::cast_possible_truncation, reason = "a part fits into memory")]
        let rows = count as usize;
        let mut inputs = Vec::with_capacity(rows * width);
        self.samples.extend(first, count, &mut inputs);
        let stable = if self.columns.has(Output::Stability) { rows } else { 0 };
        let mut answers = Answers {
            columns: vec![vec![f64::NAN; rows]; self.columns.names().len()],
            stable: vec![None; stable],
            failures: Vec::new(),
        };
        if self.reads_file() || self.columns.has(Output::Jacobian) {
            self.row_by_row(&inputs, &mut answers)?;
        } else if let Some(values) = self.tensions(&inputs) {
            let batch = self.batch(Rows::Tensions { values: &values, case: &self.file.case })?;
            self.take(&batch, |row| row, &mut answers);
        } else {
            let (mut cases, mut places) = (Vec::with_capacity(rows), Vec::with_capacity(rows));
            for (row, values) in inputs.chunks_exact(width).enumerate() {
                match self.case(&self.file, values) {
                    Ok(case) => {
                        cases.push(case);
                        places.push(row);
                    }
                    Err(why) => answers.set(row, Err(why)),
                }
            }
            let batch = self.batch(Rows::Cases(&cases))?;
            self.take(&batch, |row| places[row], &mut answers);
            answers.failures.sort_unstable_by_key(|(row, _)| *row);
        }
        Ok(Part { first, rows, inputs, answers })
    }

    /// Takes what a batch has, each row to its place.
    fn take(&self, batch: &Batch, place: impl Fn(usize) -> usize, answers: &mut Answers) {
        self.columns.write(batch, &place, &mut answers.columns);
        for (row, outcome) in batch.outcomes().iter().enumerate() {
            match outcome {
                Ok(solved) => answers.set(place(row), Ok(solved.is_stable())),
                Err(error) => answers.set(place(row), Err(error.to_string())),
            }
        }
    }

    /// The tensions of all cables in all rows, where nothing but tensions varies and every cable has one.
    fn tensions(&self, inputs: &[f64]) -> Option<Vec<f64>> {
        let case = &self.file.case;
        let cables = self.file.robot.cables().len();
        let by_tension = match self.model.actuation() {
            Actuation::Natural => self.model.kind().natural_actuation(),
            given => given,
        };
        if !case.motors.is_empty() || by_tension != Actuation::Tension {
            return None;
        }
        let mut blank = vec![None; cables];
        for (of, command) in blank.iter_mut().zip(&case.commands) {
            *of = command.tension;
        }
        for setter in &self.setters {
            let What::Tension(cable) = setter.what else { return None };
            blank[cable] = Some(0.0);
        }
        let blank = blank.into_iter().collect::<Option<Vec<f64>>>()?;
        let mut values = Vec::with_capacity(inputs.len() / self.setters.len() * cables);
        for row in inputs.chunks_exact(self.setters.len()) {
            let first = values.len();
            values.extend_from_slice(&blank);
            for (setter, value) in self.setters.iter().zip(row) {
                if let What::Tension(cable) = setter.what {
                    values[first + cable] = setter.in_si(*value);
                }
            }
        }
        Some(values)
    }

    /// The case with the values of a row that are commands and loads.
    fn case(&self, file: &CaseFile, values: &[f64]) -> Result<Case, String> {
        let (mut case, mut motors) = blank(file);
        for (setter, value) in self.setters.iter().zip(values) {
            setter.set(*value, &mut case, &mut motors);
        }
        driven(file, case, &motors).map_err(|error| error.to_string())
    }

    fn batch(&self, rows: Rows<'_>) -> Result<Batch, SweepError> {
        Ok(solve_batch(&self.model, &self.file.robot, rows, &BatchOptions::default())?)
    }

    fn row_by_row(&self, inputs: &[f64], answers: &mut Answers) -> Result<(), SweepError> {
        let rows = inputs.chunks_exact(self.samples.axes().len());
        let mut found: Vec<(Vec<f64>, Outcome)> = vec![(Vec::new(), Ok(None)); rows.len()];
        let jobs = rows.zip(&mut found);
        let solved = share(
            jobs,
            None,
            || None,
            |(values, (numbers, outcome)), prepared| {
                *outcome = self.row(values, prepared, numbers);
                !self.model.cancel().is_cancelled()
            },
        );
        solved.map_err(BatchError::from)?;
        for (row, (numbers, outcome)) in found.into_iter().enumerate() {
            if outcome.is_ok() {
                for (column, value) in answers.columns.iter_mut().zip(numbers) {
                    column[row] = value;
                }
            }
            answers.set(row, outcome);
        }
        Ok(())
    }

    /// The numbers of one row, from cold. `prepared` is the model of the file's own robot, made by the first row of a thread.
    fn row(
        &self,
        values: &[f64],
        prepared: &mut Option<Prepared>,
        numbers: &mut Vec<f64>,
    ) -> Outcome {
        let axes = self.samples.axes().iter();
        let keys = axes.zip(&self.setters).zip(values);
        let keys = keys.filter(|((_, setter), _)| setter.what == What::Key);
        let settings: Vec<String> = keys.map(|((axis, _), value)| axis.setting(*value)).collect();
        if settings.is_empty() {
            return self.row_of(&self.file, values, prepared, numbers);
        }
        let file = self.file.with_settings(&settings).map_err(|error| error.to_string())?;
        self.row_of(&file, values, &mut None, numbers)
    }

    /// The same of a file with the keys of the row.
    fn row_of(
        &self,
        file: &CaseFile,
        values: &[f64],
        prepared: &mut Option<Prepared>,
        numbers: &mut Vec<f64>,
    ) -> Outcome {
        let words = |error: SolveError| error.to_string();
        let case = self.case(file, values)?;
        let model = match prepared {
            Some(model) => model,
            none => none.insert(self.model.prepare(&file.robot, &case.loads).map_err(words)?),
        };
        let (solution, rates) = if self.columns.has(Output::Jacobian) {
            let found = model.solve_with_derivatives(&case, None, &[]).map_err(words)?;
            (found.0, Some(found.1))
        } else {
            (model.solve(&case, None).map_err(words)?, None)
        };
        let written = self.columns.push_solution(&case, &solution, rates.as_ref(), numbers);
        written.ok_or(
            "this row has another number of disks or cables than the file, for which the columns are",
        )?;
        Ok(solution.diagnostics.stable)
    }
}
